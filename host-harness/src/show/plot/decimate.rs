//! Reduction of a long trace to what a screen can show.

use super::Series;
use super::axis::is_drawable;

/// A sample: time and value.
pub(super) type Point = (f64, f64);

/// The samples that fall into one column.
#[derive(Clone, Copy)]
struct Column {
    index: f64,
    low: Point,
    high: Point,
    last: Point,
}

impl Column {
    fn new(index: f64, point: Point) -> Self {
        Self { index, low: point, high: point, last: point }
    }

    fn add(&mut self, point: Point) {
        if point.1 < self.low.1 {
            self.low = point;
        }
        if point.1 > self.high.1 {
            self.high = point;
        }
        self.last = point;
    }

    /// Appends the smallest and the largest sample in the order of time.
    fn push_to(&self, line: &mut Vec<Point>) {
        let pair =
            if self.low.0 <= self.high.0 { [self.low, self.high] } else { [self.high, self.low] };
        for point in pair {
            push_new(line, point);
        }
    }
}

/// Appends a point unless the line already ends there.
fn push_new(line: &mut Vec<Point>, point: Point) {
    if line.last() != Some(&point) {
        line.push(point);
    }
}

/// The samples of a series, with what happened between two of them where that goes beyond both.
pub(super) fn with_extremes(time_s: &[f64], series: &Series) -> (Vec<f64>, Vec<f64>) {
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut before: Option<Point> = None;
    for (i, point) in time_s.iter().copied().zip(series.values.iter().copied()).enumerate() {
        if let (Some(last), Some((low, high))) = (before, series.extremes.get(i)) {
            let beyond = [(low, last.1.min(point.1) > *low), (high, last.1.max(point.1) < *high)];
            for (value, share) in beyond.into_iter().zip([1.0 / 3.0, 2.0 / 3.0]) {
                if let (value, true) = value {
                    times.push(last.0 + share * (point.0 - last.0));
                    values.push(*value);
                }
            }
        }
        times.push(point.0);
        values.push(point.1);
        before = Some(point);
    }
    (times, values)
}

/// Reduces a trace to lines that keep the smallest and the largest sample of
/// each column of time; the columns are `column_s` wide, the first one starts at
/// `start_s`. A line ends at missing samples, but not at a gap narrower than a
/// column, which could not be seen.
pub(super) fn decimate(
    time_s: &[f64],
    values: &[f64],
    start_s: f64,
    column_s: f64,
) -> Vec<Vec<Point>> {
    let mut lines = Vec::new();
    let mut line: Vec<Point> = Vec::new();
    let mut column: Option<Column> = None;
    let mut is_gap = false;
    for point in time_s.iter().copied().zip(values.iter().copied()) {
        if !(is_drawable(point.0) && is_drawable(point.1)) {
            is_gap = true;
            continue;
        }
        let index = ((point.0 - start_s) / column_s).floor();
        match &mut column {
            Some(open) if is_gap && point.0 - open.last.0 > column_s => {
                open.push_to(&mut line);
                push_new(&mut line, open.last);
                lines.push(std::mem::take(&mut line));
                line.push(point);
                *open = Column::new(index, point);
            }
            #[expect(clippy::float_cmp, reason = "both are whole numbers")]
            Some(open) if open.index == index => open.add(point),
            Some(open) => {
                open.push_to(&mut line);
                *open = Column::new(index, point);
            }
            None => {
                line.push(point);
                column = Some(Column::new(index, point));
            }
        }
        is_gap = false;
    }
    if let Some(open) = column {
        open.push_to(&mut line);
        push_new(&mut line, open.last);
        lines.push(line);
    }
    lines
}
