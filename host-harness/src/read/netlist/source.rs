//! What drives a source, in keys that carry its unit.

use super::shape::{Pulse, Wave};

/// A path and the rule that is broken there.
pub(super) type Broken = (String, String);

/// What an element of one unit may be driven by: exactly one of five shapes.
macro_rules! source {
    (
        $unit:ident, $constant:literal, $offset:literal, $amplitude:literal, $before:literal,
        $after:literal, $low:literal, $high:literal, $value:literal
    ) => {
        pub(super) mod $unit {
            use super::{Broken, Pulse, Wave};
            use serde::Deserialize;

            #[derive(Deserialize)]
            #[serde(deny_unknown_fields)]
            pub struct Source {
                pub from: String,
                pub to: String,
                #[serde(rename = $constant)]
                constant: Option<f64>,
                sine: Option<Sine>,
                step: Option<Step>,
                square: Option<Square>,
                table: Option<Table>,
            }

            #[derive(Deserialize)]
            #[serde(deny_unknown_fields)]
            struct Sine {
                #[serde(rename = $offset, default)]
                offset: f64,
                #[serde(rename = $amplitude)]
                amplitude: f64,
                frequency_hz: f64,
                #[serde(default)]
                phase_deg: f64,
            }

            #[derive(Deserialize)]
            #[serde(deny_unknown_fields)]
            struct Step {
                #[serde(rename = $before)]
                before: f64,
                #[serde(rename = $after)]
                after: f64,
                at_s: f64,
            }

            #[derive(Deserialize)]
            #[serde(deny_unknown_fields)]
            struct Square {
                #[serde(rename = $low)]
                low: f64,
                #[serde(rename = $high)]
                high: f64,
                period_s: f64,
                on_s: f64,
                #[serde(default)]
                delay_s: f64,
            }

            #[derive(Deserialize)]
            #[serde(deny_unknown_fields)]
            struct Table {
                time_s: Vec<f64>,
                #[serde(rename = $value)]
                value: Vec<f64>,
            }

            impl Source {
                pub fn wave(&self, path: &str) -> Result<Wave, Broken> {
                    let broken = |key: &str, rule: &str| Err((format!("{path}{key}"), rule.into()));
                    let (mut found, mut key) = (Vec::new(), "");
                    if let Some(value) = self.constant {
                        key = concat!(".", $constant);
                        found.push(Wave::Constant(value));
                    }
                    if let Some(Sine { offset, amplitude, frequency_hz, phase_deg }) = self.sine {
                        key = ".sine";
                        found.push(Wave::Sine { offset, amplitude, frequency_hz, phase_deg });
                    }
                    if let Some(Step { before, after, at_s }) = self.step {
                        key = ".step";
                        found.push(Wave::Step { before, after, at_s });
                    }
                    if let Some(Square { low, high, period_s, on_s, delay_s }) = self.square {
                        key = ".square";
                        let pulse = Pulse { period_s, on_s, delay_s };
                        if let Some((field, rule)) = pulse.fault() {
                            return broken(&format!(".square.{field}"), rule);
                        }
                        found.push(Wave::Square { low, high, pulse });
                    }
                    if let Some(Table { time_s, value }) = &self.table {
                        key = ".table";
                        if time_s.len() != value.len() {
                            return broken(".table.time_s", "must have a value for each time");
                        }
                        found.push(Wave::Table(
                            time_s.iter().copied().zip(value.iter().copied()).collect(),
                        ));
                    }
                    match (found.pop(), found.is_empty()) {
                        (Some(wave), true) if wave.is_sound() => Ok(wave),
                        (Some(_), true) => broken(key, "must be finite, with times that rise"),
                        _ => broken(
                            "",
                            concat!(
                                "must have one of `",
                                $constant,
                                "`, `sine`, `step`, `square`, `table`"
                            ),
                        ),
                    }
                }
            }
        }
    };
}

source!(
    volt,
    "dc_v",
    "offset_v",
    "amplitude_v",
    "before_v",
    "after_v",
    "low_v",
    "high_v",
    "value_v"
);
source!(
    ampere,
    "dc_a",
    "offset_a",
    "amplitude_a",
    "before_a",
    "after_a",
    "low_a",
    "high_a",
    "value_a"
);
source!(
    ohm,
    "constant_ohm",
    "offset_ohm",
    "amplitude_ohm",
    "before_ohm",
    "after_ohm",
    "low_ohm",
    "high_ohm",
    "value_ohm"
);
source!(
    farad,
    "constant_farad",
    "offset_farad",
    "amplitude_farad",
    "before_farad",
    "after_farad",
    "low_farad",
    "high_farad",
    "value_farad"
);
