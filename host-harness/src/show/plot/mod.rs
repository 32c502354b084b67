//! The plot sheet of one replay: stacked time traces above a bar chart of the
//! energy terms, drawn as a single SVG text.
//!
//! The drawing is a pure function of the [`Sheet`]: same input, same bytes.
//! Coordinates are rounded to a quarter of a pixel, and every trace is reduced
//! to the smallest and the largest sample of each pixel column, so that a replay
//! of any length gives a small file in which no peak is lost.

mod axis;
mod bars;
mod canvas;
mod decimate;
mod panels;
#[cfg(test)]
mod tests;
mod text;

use anyhow::{Result, ensure};

use canvas::{Align, Canvas, INK, MUTED};

/// Width of the sheet in pixels.
const SHEET_WIDTH: f64 = 1200.0;
/// Space left of the plot areas, where the tick labels stand.
const LEFT: f64 = 72.0;
/// Space right of the plot areas.
const RIGHT: f64 = 28.0;
/// Left edge of everything that is text: the titles and the names of the bars.
const TEXT_LEFT: f64 = 24.0;
/// Space above the title and below the last element.
const EDGE: f64 = 20.0;
/// Size of the sheet's title.
const TITLE_PX: f64 = 20.0;
/// Size of the key figures below the title.
const SUBTITLE_PX: f64 = 13.0;
/// Size of panel titles.
const HEADING_PX: f64 = 13.0;
/// Size of legends, tick labels, and bar labels.
const LABEL_PX: f64 = 12.0;

/// How much wider bold type is.
const BOLD: f64 = 1.16;

/// Where the values of a trace come from; decides how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// What was asked for: a wide light grey line behind the others.
    Reference,
    /// A recorded signal: orange, behind the simulated one.
    Measured,
    /// A result of the plant model: blue, in front.
    Simulated,
}

/// One trace of a panel.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// Name in the legend.
    pub(crate) name: String,
    /// One value per entry of [`Sheet::time_s`], or none at all. The line breaks
    /// at values that are not finite.
    pub(crate) values: Vec<f64>,
    /// Origin of the values.
    pub(crate) kind: Kind,
    /// Lowest and highest of what happened since the value before, one pair for each value; none
    /// where the values are all there is.
    pub(crate) extremes: Vec<(f64, f64)>,
}

impl Series {
    /// A line through values that are all there is.
    pub(crate) fn new(name: &str, kind: Kind, values: Vec<f64>) -> Self {
        Self { name: name.to_owned(), values, kind, extremes: Vec::new() }
    }
}

/// One plot area with its own vertical axis; all panels share the time axis.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// The quantity.
    pub(crate) title: String,
    /// Its unit; may be empty.
    pub(crate) unit: String,
    /// The traces.
    pub(crate) series: Vec<Series>,
}

/// One bar of the chart below the panels.
#[derive(Clone, Debug)]
pub(crate) struct Bar {
    /// Name left of the bar.
    pub(crate) name: String,
    /// Length of the bar, in [`Sheet::bars_unit`]; may be negative.
    pub(crate) value: f64,
}

/// Everything that is on the sheet.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    /// Headline.
    pub(crate) title: String,
    /// Key figures, one line each; long lines are wrapped.
    pub(crate) subtitle: Vec<String>,
    /// Sample times in s, shared by all series.
    pub(crate) time_s: Vec<f64>,
    /// The panels, from top to bottom.
    pub(crate) panels: Vec<Panel>,
    /// Title of the bar chart.
    pub(crate) bars_title: String,
    /// Unit of the bars.
    pub(crate) bars_unit: String,
    /// The bars, from top to bottom; the chart is left out when there are none.
    pub(crate) bars: Vec<Bar>,
}

/// Draws the sheet and gives the text of the SVG file.
///
/// # Errors
///
/// Fails when a series has neither as many values as there are sample times nor
/// no values at all.
pub(crate) fn render(sheet: &Sheet) -> Result<String> {
    for panel in &sheet.panels {
        for series in &panel.series {
            ensure!(
                series.extremes.is_empty() || series.extremes.len() == series.values.len(),
                "series `{}` of panel `{}` has {} extremes for {} values",
                series.name,
                panel.title,
                series.extremes.len(),
                series.values.len(),
            );
            ensure!(
                series.values.is_empty() || series.values.len() == sheet.time_s.len(),
                "series `{}` of panel `{}` has {} values for {} sample times",
                series.name,
                panel.title,
                series.values.len(),
                sheet.time_s.len(),
            );
        }
    }

    let text_width = SHEET_WIDTH - TEXT_LEFT - RIGHT;
    let subtitle: Vec<String> = sheet
        .subtitle
        .iter()
        .flat_map(|line| text::wrap(&text::clean(line), SUBTITLE_PX, text_width))
        .collect();
    let subtitle_step = SUBTITLE_PX * 1.45;
    let panels_top = EDGE + TITLE_PX * 1.5 + row_offset(subtitle.len(), subtitle_step) + 10.0;
    let bars_top = panels_top + panels::height(sheet.panels.len());
    let height = bars_top + bars::height(sheet.bars.len()) + EDGE;

    Canvas::draw(SHEET_WIDTH, height, |canvas| {
        let title = text::fit(&text::clean(&sheet.title), BOLD * TITLE_PX, text_width);
        let at = (TEXT_LEFT, EDGE + TITLE_PX / 2.0);
        canvas.bold(&title, at, TITLE_PX, INK)?;
        let first = EDGE + TITLE_PX * 1.5 + SUBTITLE_PX / 2.0;
        for (index, line) in subtitle.iter().enumerate() {
            let at = (TEXT_LEFT, first + row_offset(index, subtitle_step));
            canvas.text(line, at, SUBTITLE_PX, Align::Start, MUTED)?;
        }
        panels::draw(canvas, sheet, panels_top)?;
        bars::draw(canvas, sheet, bars_top)
    })
}

/// Offset of row `index` of rows that are `step` apart.
fn row_offset(index: usize, step: f64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a sheet has few rows")]
    let index = index as f64;
    index * step
}
