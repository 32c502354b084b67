//! How a figure is spread over many rows.

use std::fmt::Write;

use super::page::escaped;
use crate::simulate::statistics::spread;

const WIDTH: f64 = 260.0;
const HEIGHT: f64 = 110.0;
/// Room below for the numbers.
const FOOT: f64 = 20.0;
/// Rows that a column stands for, about, and the most columns.
const ROWS_PER_COLUMN: usize = 3;
const MOST: usize = 24;

/// A figure with its columns, its median and its largest magnitude; none without a value.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of columns and rows"
)]
pub fn html(title: &str, digits: usize, values: impl Iterator<Item = Option<f64>>) -> String {
    let values: Vec<f64> = values.flatten().filter(|v| v.is_finite()).collect();
    let Some(sizes) = spread("", values.iter().map(|v| Some(*v))) else { return String::new() };
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let columns = (values.len() / ROWS_PER_COLUMN).clamp(5, MOST);
    let span = if high > low { high - low } else { 1.0 };
    let mut counts = vec![0_usize; columns];
    for value in &values {
        let place = ((value - low) / span * columns as f64) as usize;
        counts[place.min(columns - 1)] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1);
    let wide = WIDTH / columns as f64;
    let title = escaped(title);
    let mut svg = format!(
        "<figure><svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{title}: {} values from {low:.digits$} to {high:.digits$}\">\n",
        values.len()
    );
    let floor = HEIGHT - FOOT;
    for (i, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let tall = *count as f64 / most as f64 * (floor - 4.0);
        let (x, y) = (i as f64 * wide + 0.5, floor - tall);
        let _ = writeln!(
            svg,
            "<rect class=\"column\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{tall:.1}\"><title>{count}</title></rect>",
            wide - 1.0
        );
    }
    let mut sorted = values.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = f64::midpoint(sorted[(sorted.len() - 1) / 2], sorted[sorted.len() / 2]);
    let at = (middle - low) / span * WIDTH;
    let foot = HEIGHT - 5.0;
    let _ = writeln!(
        svg,
        "<path class=\"line\" d=\"M0 {floor}H{WIDTH}\"/><path class=\"median\" d=\"M{at:.1} {floor}V0\"/>\
         <text class=\"quiet\" x=\"0\" y=\"{foot}\">{}</text>\
         <text class=\"quiet\" x=\"{WIDTH}\" y=\"{foot}\" text-anchor=\"end\">{}</text></svg>",
        minus(low, digits),
        minus(high, digits)
    );
    let signed = if low < 0.0 { "Without sign: median" } else { "Median" };
    let _ = writeln!(
        svg,
        "<figcaption><b>{title}</b><br>{signed} {:.digits$}, 90 % within {:.digits$}, largest {:.digits$}</figcaption></figure>",
        sizes.median, sizes.p90, sizes.max
    );
    svg
}

fn minus(value: f64, digits: usize) -> String {
    format!("{value:.digits$}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::html;

    #[test]
    fn every_value_stands_in_a_column() {
        let values = [-1.0, 0.0, 0.1, 0.2, 9.0, f64::NAN];
        let svg = html("a < b", 1, values.iter().map(|v| Some(*v)).chain([None]));
        let total: usize = (svg.split("<title>").skip(1))
            .map(|rest| rest.split('<').next().unwrap().parse::<usize>().unwrap())
            .sum();
        assert_eq!(total, 5);
        for part in
            ["a &lt; b", "5 values from -1.0 to 9.0", "Without sign: median 0.2", "largest 9.0"]
        {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert!(html("one", 1, [Some(3.0)].into_iter()).contains("Median 3.0"));
        assert_eq!(html("none", 1, [None].into_iter()), "");
    }
}
