//! The trace of a replay as CSV.

use crate::read::trip::Trip;
use crate::simulate::columns::{columns, measured};
use crate::simulate::run::Run;

/// The trace as CSV; on trips with the measured values beside ours. A missing one is empty.
pub fn csv(run: &Run, trip: Option<&Trip>) -> anyhow::Result<Vec<u8>> {
    let measured = trip.map(measured).unwrap_or_default();
    let mut writer = csv::Writer::from_writer(Vec::new());
    let columns: Vec<_> = columns(run).collect();
    writer.write_record(columns.iter().map(|c| c.0).chain(measured.iter().map(|m| m.0)))?;
    for (i, row) in run.trace.iter().enumerate() {
        // Six significant digits at least, and no noise of the conversion from f32.
        let ours = columns.iter().map(|c| number(c.1(row)));
        let theirs = measured.iter().map(|m| number(m.1.get(i).copied().unwrap_or(f64::NAN)));
        writer.write_record(ours.chain(theirs))?;
    }
    writer.into_inner().map_err(|e| anyhow::anyhow!("writing the trace: {e}"))
}

/// A number as short as single precision allows; none where it is not finite.
#[expect(clippy::cast_possible_truncation, reason = "single precision is what was computed")]
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    // As f32 the shortest text that reads back the same.
    let value = value as f32;
    let text = value.to_string();
    if text.len() > 12 { format!("{value:e}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        for value in [0.0, 0.1, 389.25, -12.5, 1e-7, 123_456.7, -3.456_789e-4, 1e-30, 1e30] {
            let text = number(value);
            let back: f64 = text.parse().unwrap();
            assert!((back - value).abs() <= 1e-6 * value.abs(), "{value}: {text}");
        }
        assert_eq!(number(f64::NAN), "");
    }
}
