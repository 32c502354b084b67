//! The bar chart below the panels.

use anyhow::Result;
use plotters::style::RGBColor;

use super::axis::{Range, is_drawable};
use super::canvas::{Align, Canvas, INK};
use super::{BOLD, HEADING_PX, LABEL_PX, RIGHT, SHEET_WIDTH, Sheet, TEXT_LEFT, row_offset, text};

/// Space for the title.
const HEAD: f64 = 30.0;
/// Distance of two bars.
const ROW: f64 = 21.0;
/// Thickness of a bar.
const BAR: f64 = 13.0;
/// Space between a bar and its labels.
const GAP: f64 = 6.0;
/// The most that the names may take.
const NAMES_MOST: f64 = 340.0;

const POSITIVE: RGBColor = RGBColor(0x00, 0x72, 0xB2);
const NEGATIVE: RGBColor = RGBColor(0x56, 0xB4, 0xE9);

/// Space that a chart of `count` bars takes.
pub(super) fn height(count: usize) -> f64 {
    if count == 0 { 0.0 } else { HEAD + row_offset(count, ROW) + GAP }
}

/// Draws the chart from `top` on.
pub(super) fn draw(canvas: &Canvas<'_>, sheet: &Sheet, top: f64) -> Result<()> {
    if sheet.bars.is_empty() {
        return Ok(());
    }
    let unit = text::clean(&sheet.bars_unit);
    let right = SHEET_WIDTH - RIGHT;
    let heading = text::clean(&sheet.bars_title);
    let heading = text::fit(&heading, BOLD * HEADING_PX, right - TEXT_LEFT);
    canvas.bold(&heading, (TEXT_LEFT, top + HEAD / 2.0 - 1.0), HEADING_PX, INK)?;

    let mut rows = Vec::with_capacity(sheet.bars.len());
    let (mut names, mut left_labels, mut right_labels) = (0.0_f64, 0.0_f64, 0.0_f64);
    for bar in &sheet.bars {
        let value = if is_drawable(bar.value) { bar.value } else { 0.0 };
        let name = text::fit(&text::clean(&bar.name), LABEL_PX, NAMES_MOST);
        let number = text::three_digits(bar.value);
        let label = format!("{number} {unit}").trim_end().to_owned();
        names = names.max(text::width(&name, LABEL_PX));
        let room = text::width(&label, LABEL_PX) + GAP;
        if value < 0.0 {
            left_labels = left_labels.max(room);
        } else {
            right_labels = right_labels.max(room);
        }
        rows.push((name, value, label));
    }

    let left = TEXT_LEFT + names + 2.0 * GAP + left_labels;
    let width = (right - right_labels - left).max(0.0);
    let range = Range::from_zero(sheet.bars.iter().map(|bar| bar.value));
    let x_px = |value: f64| left + range.part(value) * width;
    let zero = x_px(0.0);
    for (index, (name, value, label)) in rows.iter().enumerate() {
        let y = top + HEAD + row_offset(index, ROW) + ROW / 2.0;
        let end = x_px(*value);
        let (from, to) = ((zero.min(end), y - BAR / 2.0), (zero.max(end), y + BAR / 2.0));
        let color = if *value < 0.0 { NEGATIVE } else { POSITIVE };
        canvas.block(from, to, color)?;
        canvas.text(name, (TEXT_LEFT, y), LABEL_PX, Align::Start, INK)?;
        let (x, align) =
            if *value < 0.0 { (end - GAP, Align::End) } else { (end + GAP, Align::Start) };
        canvas.text(label, (x, y), LABEL_PX, align, INK)?;
    }
    let bottom = top + HEAD + row_offset(rows.len(), ROW);
    canvas.rule((zero, top + HEAD), (zero, bottom), INK)
}
