//! Drawing primitives in pixels on the SVG backend of `plotters`.

use anyhow::{Result, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Text and axis lines.
pub(super) const INK: RGBColor = RGBColor(0x26, 0x26, 0x26);
/// Secondary text: tick labels, units, key figures.
pub(super) const MUTED: RGBColor = RGBColor(0x59, 0x59, 0x59);
/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(0xE6, 0xE6, 0xE6);
/// The grid line of the value zero.
pub(super) const ZERO: RGBColor = RGBColor(0xB4, 0xB4, 0xB4);

/// Drawing units per pixel. The backend has whole units only; four of them to a
/// pixel give lines of 1.25 px and keep slow traces free of visible steps.
pub(super) const UNITS_PER_PX: f64 = 4.0;

/// `plotters` divides the size of a font by this when it writes the SVG.
const FONT_SIZE_FACTOR: f64 = 1.24;
const FONT: &str = "Helvetica, Arial, 'Liberation Sans', sans-serif";

/// Horizontal alignment of a text at its position.
#[derive(Clone, Copy, Debug)]
pub(super) enum Align {
    /// The text starts there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

/// A position in drawing units.
pub(super) type Units = (i32, i32);

/// A white sheet to draw on; lengths are in pixels unless they are [`Units`].
pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

impl Canvas<'_> {
    /// Makes a sheet, lets `content` draw on it, and gives its SVG text.
    pub(super) fn draw(
        width: f64,
        height: f64,
        content: impl FnOnce(&Canvas<'_>) -> Result<()>,
    ) -> Result<String> {
        let height = height.ceil();
        #[expect(clippy::cast_possible_truncation, reason = "a float to int `as` saturates")]
        #[expect(clippy::cast_sign_loss, reason = "lengths are positive")]
        let size = ((width * UNITS_PER_PX) as u32, (height * UNITS_PER_PX) as u32);
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            area.fill(&WHITE)?;
            let canvas = Canvas { area };
            content(&canvas)?;
            canvas.area.present()?;
        }
        // The view box stays in drawing units. Round joins keep a spike from
        // being drawn longer than it is.
        let units = format!("<svg width=\"{}\" height=\"{}\" ", size.0, size.1);
        let pixels =
            format!("<svg width=\"{width}\" height=\"{height}\" stroke-linejoin=\"round\" ");
        ensure!(svg.starts_with(&units), "unexpected head of the SVG text");
        svg.replace_range(..units.len(), &pixels);
        Ok(svg)
    }

    /// Draws a line through positions in drawing units.
    pub(super) fn path(&self, points: Vec<Units>, color: RGBColor, width_px: f64) -> Result<()> {
        let style = color.stroke_width(units(width_px).unsigned_abs());
        Ok(self.area.draw(&PathElement::new(points, style))?)
    }

    /// Draws a straight line, 1 px wide, on whole pixels.
    pub(super) fn rule(&self, from: (f64, f64), to: (f64, f64), color: RGBColor) -> Result<()> {
        let crisp = |v: f64| units(v.floor() + 0.5);
        let ends = vec![(crisp(from.0), crisp(from.1)), (crisp(to.0), crisp(to.1))];
        self.path(ends, color, 1.0)
    }

    /// Fills a rectangle.
    pub(super) fn block(&self, from: (f64, f64), to: (f64, f64), color: RGBColor) -> Result<()> {
        let corners = [(units(from.0), units(from.1)), (units(to.0), units(to.1))];
        Ok(self.area.draw(&Rectangle::new(corners, color.filled()))?)
    }

    /// Writes a text whose vertical middle is at `at`.
    pub(super) fn text(
        &self,
        text: &str,
        at: (f64, f64),
        size_px: f64,
        align: Align,
        color: RGBColor,
    ) -> Result<()> {
        self.write(text, at, &font(size_px), align, color)
    }

    /// Writes a bold text that starts at `at`.
    pub(super) fn bold(
        &self,
        text: &str,
        at: (f64, f64),
        size_px: f64,
        color: RGBColor,
    ) -> Result<()> {
        self.write(text, at, &font(size_px).style(FontStyle::Bold), Align::Start, color)
    }

    fn write(
        &self,
        text: &str,
        at: (f64, f64),
        font: &FontDesc<'static>,
        align: Align,
        color: RGBColor,
    ) -> Result<()> {
        let horizontal = match align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        let style = font.color(&color).pos(Pos::new(horizontal, VPos::Center));
        Ok(self.area.draw(&Text::new(text, (units(at.0), units(at.1)), style))?)
    }
}

fn font(size_px: f64) -> FontDesc<'static> {
    let size = size_px * UNITS_PER_PX * FONT_SIZE_FACTOR;
    FontDesc::new(FontFamily::Name(FONT), size, FontStyle::Normal)
}

/// Pixels to drawing units.
pub(super) fn units(px: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "a float to int `as` saturates")]
    let units = (px * UNITS_PER_PX).round() as i32;
    units
}
