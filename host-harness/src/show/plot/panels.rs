//! The time traces.

use anyhow::Result;
use plotters::style::RGBColor;

use super::axis::{Range, Tick, is_drawable, ticks};
use super::canvas::{Align, Canvas, GRID, INK, MUTED, Units, ZERO, units};
use super::decimate::{Point, decimate, with_extremes};
use super::text;
use super::{BOLD, HEADING_PX, Kind, LABEL_PX, LEFT, Panel, RIGHT, SHEET_WIDTH, Series, Sheet};
use super::{TEXT_LEFT, row_offset};

/// From the top of one panel to that of the next.
const PANEL: f64 = 190.0;
/// Space above the plot area, for title and legend.
const HEAD: f64 = 28.0;
/// Height of the plot area.
const PLOT: f64 = 144.0;
/// Space below the last panel for the labels of the time axis.
const FOOT: f64 = 46.0;
const PLOT_WIDTH: f64 = SHEET_WIDTH - LEFT - RIGHT;

/// Length of a line sample in the legend, and the spaces around it.
const SWATCH: f64 = 22.0;
const SWATCH_GAP: f64 = 6.0;
const ENTRY_GAP: f64 = 20.0;

/// What all traces together may take in the file, in bytes. Where they would
/// take more, the columns they are reduced to get wider.
const TRACE_BYTES: usize = 400_000;
const BYTES_PER_POINT: usize = 10;
const BYTES_PER_LINE: usize = 90;

/// Space that `count` panels take.
pub(super) fn height(count: usize) -> f64 {
    if count == 0 { 0.0 } else { row_offset(count, PANEL) + FOOT }
}

/// Draws the panels from `top` on.
pub(super) fn draw(canvas: &Canvas<'_>, sheet: &Sheet, top: f64) -> Result<()> {
    let range = Range::of_times(sheet.time_s.iter().copied());
    let axis = TimeAxis::new(range);
    let frames: Vec<Frame> = (0..sheet.panels.len())
        .zip(&sheet.panels)
        .map(|(index, panel)| {
            let values = panel.series.iter().flat_map(|s| {
                let beyond = s.extremes.iter().flat_map(|(low, high)| [*low, *high]);
                s.values.iter().copied().chain(beyond)
            });
            let y = Range::of_values(values);
            Frame { top: top + row_offset(index, PANEL) + HEAD, x: range, y }
        })
        .collect();
    let traces = traces(sheet, &frames);
    for (index, ((panel, frame), traces)) in
        sheet.panels.iter().zip(&frames).zip(traces).enumerate()
    {
        draw_grid(canvas, frame, &axis)?;
        draw_head(canvas, panel, frame.top - HEAD / 2.0 - 2.0)?;
        let styles = styles(panel);
        let mut order: Vec<_> = traces.into_iter().zip(styles).zip(&panel.series).collect();
        order.sort_by_key(|(_, series)| series.kind);
        for ((lines, style), _) in order {
            for line in lines {
                canvas.path(line, style.color, style.width)?;
            }
        }
        draw_axis_lines(canvas, frame)?;
        if index + 1 == sheet.panels.len() {
            axis.draw_labels(canvas, frame)?;
        }
    }
    Ok(())
}

/// A plot area and the ranges of its axes.
struct Frame {
    top: f64,
    x: Range,
    y: Range,
}

impl Frame {
    fn bottom(&self) -> f64 {
        self.top + PLOT
    }

    fn x_px(&self, time_s: f64) -> f64 {
        LEFT + self.x.part(time_s) * PLOT_WIDTH
    }

    fn y_px(&self, value: f64) -> f64 {
        self.bottom() - self.y.part(value) * PLOT
    }

    /// A line in drawing units. Points inside a level stretch are left out; a
    /// single sample becomes a dot.
    fn place(&self, line: &[Point]) -> Vec<Units> {
        let mut placed: Vec<Units> = Vec::with_capacity(line.len());
        for (time_s, value) in line {
            let point = (units(self.x_px(*time_s)), units(self.y_px(*value)));
            if let [.., before, last] = placed.as_mut_slice()
                && before.1 == last.1
                && last.1 == point.1
                && before.0 <= last.0
                && last.0 <= point.0
            {
                *last = point;
            } else if placed.last() != Some(&point) {
                placed.push(point);
            }
        }
        if let [(x, y)] = placed[..] {
            let half = units(0.75);
            placed = vec![(x - half, y), (x + half, y)];
        }
        placed
    }
}

/// The lines of every series of every panel, small enough for the file.
fn traces(sheet: &Sheet, frames: &[Frame]) -> Vec<Vec<Vec<Vec<Units>>>> {
    let mut columns = PLOT_WIDTH;
    loop {
        let traces: Vec<Vec<Vec<Vec<Units>>>> = sheet
            .panels
            .iter()
            .zip(frames)
            .map(|(panel, frame)| {
                let column_s = frame.x.span() / columns;
                let lines = |series: &Series| {
                    let (time_s, values) = with_extremes(&sheet.time_s, series);
                    decimate(&time_s, &values, frame.x.low, column_s)
                        .iter()
                        .map(|line| frame.place(line))
                        .collect()
                };
                panel.series.iter().map(lines).collect()
            })
            .collect();
        let bytes: usize = traces
            .iter()
            .flatten()
            .flatten()
            .map(|line| BYTES_PER_LINE + BYTES_PER_POINT * line.len())
            .sum();
        if bytes <= TRACE_BYTES || columns < 16.0 {
            return traces;
        }
        columns /= 1.5;
    }
}

/// Colour and width of a line.
#[derive(Clone, Copy)]
struct Style {
    color: RGBColor,
    width: f64,
}

/// The style of each series: by kind, and by order within a kind. The colours
/// are those of Okabe and Ito, which colour-blind readers can tell apart. What
/// lies behind is wider, so that it shows where two lines coincide.
fn styles(panel: &Panel) -> Vec<Style> {
    const BLUES: [u32; 3] = [0x00_72B2, 0x00_9E73, 0x56_B4E9];
    const ORANGES: [u32; 3] = [0xE6_9F00, 0xD5_5E00, 0xCC_79A7];
    const GREYS: [u32; 3] = [0xB4_B4B4, 0x82_8282, 0xD2_D2D2];
    let mut used = [0_usize; 3];
    let mut styles = Vec::new();
    for series in &panel.series {
        let (slot, colors, width) = match series.kind {
            Kind::Reference => (0, GREYS, 3.0),
            Kind::Measured => (1, ORANGES, 3.0),
            Kind::Simulated => (2, BLUES, 1.25),
        };
        let [_, r, g, b] = colors[used[slot] % colors.len()].to_be_bytes();
        used[slot] += 1;
        styles.push(Style { color: RGBColor(r, g, b), width });
    }
    styles
}

/// Title and unit on the left, the legend on the right.
fn draw_head(canvas: &Canvas<'_>, panel: &Panel, y: f64) -> Result<()> {
    let right = SHEET_WIDTH - RIGHT;
    let most = (right - TEXT_LEFT) * 0.7 / row_offset(panel.series.len().max(1), 1.0);
    let names: Vec<String> = panel
        .series
        .iter()
        .map(|series| {
            let name = text::clean(&series.name);
            let name = if series.values.iter().any(|v| is_drawable(*v)) {
                name
            } else {
                format!("{name} (no data)")
            };
            text::fit(&name, LABEL_PX, most - SWATCH - SWATCH_GAP - ENTRY_GAP)
        })
        .collect();
    let entry = |name: &String| SWATCH + SWATCH_GAP + text::width(name, LABEL_PX) + ENTRY_GAP;
    let mut x = right + ENTRY_GAP - names.iter().map(entry).sum::<f64>();

    let unit = text::clean(&panel.unit);
    let unit = if unit.is_empty() { unit } else { format!(" ({unit})") };
    let room = x - ENTRY_GAP - TEXT_LEFT - text::width(&unit, BOLD * HEADING_PX);
    let title = text::fit(&text::clean(&panel.title), BOLD * HEADING_PX, room);
    canvas.bold(&format!("{title}{unit}"), (TEXT_LEFT, y), HEADING_PX, INK)?;

    for (name, style) in names.iter().zip(styles(panel)) {
        let (from, to, middle) = (units(x), units(x + SWATCH), units(y));
        canvas.path(vec![(from, middle), (to, middle)], style.color, style.width.max(2.0))?;
        canvas.text(name, (x + SWATCH + SWATCH_GAP, y), LABEL_PX, Align::Start, INK)?;
        x += entry(name);
    }
    Ok(())
}

fn draw_grid(canvas: &Canvas<'_>, frame: &Frame, axis: &TimeAxis) -> Result<()> {
    let right = LEFT + PLOT_WIDTH;
    for (time, _) in &axis.ticks {
        let x = frame.x_px(time * axis.unit_s);
        canvas.rule((x, frame.top), (x, frame.bottom()), GRID)?;
    }
    for (value, label) in ticks(frame.y, 6.0) {
        let y = frame.y_px(value);
        let color = if value == 0.0 { ZERO } else { GRID };
        canvas.rule((LEFT, y), (right, y), color)?;
        canvas.text(&label, (LEFT - 8.0, y), LABEL_PX, Align::End, MUTED)?;
    }
    Ok(())
}

fn draw_axis_lines(canvas: &Canvas<'_>, frame: &Frame) -> Result<()> {
    let corner = (LEFT, frame.bottom());
    canvas.rule((LEFT, frame.top), corner, INK)?;
    canvas.rule(corner, (LEFT + PLOT_WIDTH, frame.bottom()), INK)
}

/// The shared axis, in seconds up to an hour and in minutes beyond.
struct TimeAxis {
    unit: &'static str,
    unit_s: f64,
    ticks: Vec<Tick>,
}

impl TimeAxis {
    fn new(range: Range) -> Self {
        let (unit, unit_s) = if range.span() > 3600.0 { ("min", 60.0) } else { ("s", 1.0) };
        let shown = Range { low: range.low / unit_s, high: range.high / unit_s };
        Self { unit, unit_s, ticks: ticks(shown, 12.0) }
    }

    fn draw_labels(&self, canvas: &Canvas<'_>, frame: &Frame) -> Result<()> {
        let bottom = frame.bottom();
        for (time, label) in &self.ticks {
            let x = frame.x_px(time * self.unit_s);
            canvas.rule((x, bottom), (x, bottom + 4.0), INK)?;
            canvas.text(label, (x, bottom + 14.0), LABEL_PX, Align::Middle, MUTED)?;
        }
        let title = format!("Time ({})", self.unit);
        let at = (LEFT + PLOT_WIDTH / 2.0, bottom + 33.0);
        canvas.text(&title, at, LABEL_PX, Align::Middle, INK)
    }
}
