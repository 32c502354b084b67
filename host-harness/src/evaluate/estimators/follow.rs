//! An estimator over measurements whose state of charge nobody knows.

use anyhow::ensure;

use super::{Case, Estimator, samples};
use crate::read::battery::BatteryFile;
use crate::read::cell::CellRecord;
use crate::read::input::Measurement;

/// What an estimator is told, and how it samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// State of charge at the start, 0..1.
    pub soc: f64,
    /// Its standard deviation.
    pub soc_sd: f64,
    /// Whether the battery has rested.
    pub rested: bool,
    /// Samples per second.
    pub rate_hz: f64,
    /// By how much the measured current leads the measured voltage \[s\].
    pub current_delay_s: f64,
}

/// What an estimator said after each sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// Time of the measurement \[s\].
    pub time_s: Vec<f64>,
    /// State of charge, 0..1.
    pub soc: Vec<f64>,
    /// Its standard deviation.
    pub soc_sd: Vec<f64>,
    /// Whether measurement and model contradict each other.
    pub contradicted: Vec<bool>,
}

/// Runs an estimator over current, voltage and temperature; no other column is used.
///
/// # Errors
/// A start that is out of range, a record that is shorter than two samples.
pub fn follow(
    battery: &BatteryFile,
    record: CellRecord,
    estimator: Estimator,
    start: Start,
) -> anyhow::Result<Followed> {
    let Start { soc, soc_sd, rested, rate_hz, current_delay_s } = start;
    ensure!((0.0..=1.0).contains(&soc), "initial_soc must lie in 0..1, found {soc}");
    ensure!(soc_sd > 0.0 && soc_sd <= 1.0, "initial_soc_sd must lie in 0..1, found {soc_sd}");
    ensure!((0.01..=1000.0).contains(&rate_hz), "rate_hz must lie in 0.01..1000, found {rate_hz}");
    ensure!(
        (0.0..=10.0).contains(&current_delay_s),
        "current_delay_s must lie in 0..10, found {current_delay_s}"
    );
    let start_s = record.time_s.first().copied().unwrap_or_default();
    let capacity_ah = f64::from(battery.battery.capacity_ah);
    let measured = Measurement::Cell(CellRecord { discharged_ah: Vec::new(), ..record });
    let mut samples = samples::sampled(&measured, 1.0 / rate_hz, current_delay_s, capacity_ah)?;
    samples.starts_rested = rested;
    let points = estimator.points(battery, &samples, &Case::RIGHT, (soc, soc_sd))?;
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let time_s = (1..=points.len()).map(|k| start_s + k as f64 * samples.dt_s).collect();
    Ok(Followed {
        time_s,
        soc: points.iter().map(|p| p.soc).collect(),
        soc_sd: points.iter().map(|p| p.sd).collect(),
        contradicted: points.iter().map(|p| p.contradicted).collect(),
    })
}
