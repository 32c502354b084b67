//! The numbers of the plots, small enough for a page: every sample in 16 bits, its extremes exact.

use anyhow::Context;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::show::plot::{Kind, Series, Sheet};

/// So many steps lie between the lowest and the highest value.
const STEPS: u16 = 65_534;
/// The code of a sample that is missing.
const MISSING: u16 = u16::MAX;
/// Times that are off a regular grid by less than this share of its step are on it.
const REGULAR: f64 = 1e-6;

#[derive(Serialize)]
struct Plots {
    time: Times,
    panels: Vec<Panel>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Times {
    Regular {
        start: f64,
        every: f64,
        count: usize,
    },
    /// Doubles, little-endian, in Base64.
    Any {
        all: String,
    },
}

#[derive(Serialize)]
struct Panel {
    unit: String,
    lines: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    name: String,
    role: &'static str,
    values: Packed,
    #[serde(skip_serializing_if = "Option::is_none")]
    lowest: Option<Packed>,
    #[serde(skip_serializing_if = "Option::is_none")]
    highest: Option<Packed>,
}

/// Values as steps between two of them, little-endian, in Base64.
#[derive(Serialize)]
struct Packed {
    low: f64,
    high: f64,
    codes: String,
}

/// The plots as JSON that may stand in a script element.
pub fn json(sheet: &Sheet) -> anyhow::Result<String> {
    let line = |series: &Series| {
        let end = |pick: fn(&(f64, f64)) -> f64| {
            let values: Vec<f64> = series.extremes.iter().map(pick).collect();
            (!values.is_empty()).then(|| packed(&values))
        };
        Line {
            name: series.name.clone(),
            role: match series.kind {
                Kind::Reference => "reference",
                Kind::Measured => "measured",
                Kind::Simulated => "simulated",
            },
            values: packed(&series.values),
            lowest: end(|e| e.0),
            highest: end(|e| e.1),
        }
    };
    let panels = sheet.panels.iter().map(|panel| Panel {
        unit: panel.unit.clone(),
        // A line without a value cannot be drawn.
        lines: panel.series.iter().filter(|s| !s.values.is_empty()).map(line).collect(),
    });
    let plots = Plots { time: times(&sheet.time_s), panels: panels.collect() };
    // No tag can begin within the text.
    Ok(serde_json::to_string(&plots).context("writing the plots")?.replace('<', "\\u003c"))
}

fn times(time_s: &[f64]) -> Times {
    let count = time_s.len();
    if let [start, .., last] = *time_s {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let every = (last - start) / (count - 1) as f64;
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let at = |i: usize| start + i as f64 * every;
        if time_s.iter().enumerate().all(|(i, t)| (t - at(i)).abs() <= REGULAR * every) {
            return Times::Regular { start, every, count };
        }
    }
    let bytes: Vec<u8> = time_s.iter().flat_map(|t| t.to_le_bytes()).collect();
    Times::Any { all: STANDARD.encode(bytes) }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "0..STEPS, by the range"
)]
fn packed(values: &[f64]) -> Packed {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
    let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
    let per_step = if high > low { f64::from(STEPS) / (high - low) } else { 0.0 };
    let code = |value: f64| match value {
        v if v.is_finite() => ((v - low) * per_step).round() as u16,
        _ => MISSING,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|v| code(*v).to_le_bytes()).collect();
    Packed { low, high, codes: STANDARD.encode(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(codes: &Packed) -> Vec<f64> {
        let bytes = STANDARD.decode(&codes.codes).unwrap();
        bytes
            .chunks(2)
            .map(|pair| match u16::from_le_bytes([pair[0], pair[1]]) {
                MISSING => f64::NAN,
                STEPS => codes.high,
                k => codes.low + f64::from(k) * (codes.high - codes.low) / f64::from(STEPS),
            })
            .collect()
    }

    #[test]
    fn values_come_back_and_extremes_exactly() {
        let values = [0.1, -839.3, f64::NAN, 1043.7, 0.0, f64::INFINITY, 632.0];
        let back = decoded(&packed(&values));
        let half_step = (1043.7 + 839.3) / f64::from(STEPS) / 2.0;
        for (value, back) in values.iter().zip(&back) {
            if value.is_finite() {
                assert!((value - back).abs() <= half_step * 1.001, "{value} {back}");
            } else {
                assert!(back.is_nan());
            }
        }
        assert_eq!((back[1], back[3]), (-839.3, 1043.7));
        for level in [vec![5.0; 3], vec![f64::NAN; 3]] {
            let back = decoded(&packed(&level));
            assert!(back.iter().zip(&level).all(|(a, b)| a.to_bits() == b.to_bits()), "{back:?}");
        }
    }

    #[test]
    fn only_regular_times_are_told_as_a_step() {
        let regular: Vec<f64> = (0..1000).map(|i| 3.0 + f64::from(i) * 0.1).collect();
        let Times::Regular { start, every, count } = times(&regular) else { panic!("regular") };
        assert!((start, count) == (3.0, 1000) && (every - 0.1).abs() < 1e-12);
        let mut one_off = regular;
        one_off[500] += 1e-3;
        let Times::Any { all } = times(&one_off) else { panic!("not regular") };
        let bytes = STANDARD.decode(all).unwrap();
        let back: Vec<f64> =
            bytes.chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(back, one_off);
    }
}
