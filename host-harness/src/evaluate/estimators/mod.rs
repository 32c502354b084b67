//! `voltstep soc`: the state-of-charge estimators of `voltstep-bms` over measurements.

mod case;
mod figures;
pub mod follow;
pub mod honesty;
mod report;
mod samples;

use std::path::PathBuf;

use anyhow::Context;
use rayon::prelude::*;
use serde::Serialize;

pub use case::Case;
pub use figures::Figures;
pub use report::{EstimatorReport, EstimatorRun};

use crate::evaluate::cells::DEFAULT_CELL;
use crate::read::battery::{self, BatteryFile};
use crate::read::cell::{CellRecord, Kind};
use crate::read::input::{self, Measurement};

/// The built-in battery for trips.
const DEFAULT_PACK: &str = "bmw-i3-60ah";
/// At least this share of the samples must hold the truth within three standard deviations.
pub const HONEST: f64 = 0.95;

/// Which estimator runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "command", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Estimator {
    /// Counts the charge.
    Coulomb,
    /// Kalman filter on current and voltage.
    Ekf,
}

impl Estimator {
    /// What it says after each sample, from a state of charge and its standard deviation.
    fn points(
        self,
        battery: &BatteryFile,
        samples: &samples::Samples,
        case: &Case,
        start: (f64, f64),
    ) -> anyhow::Result<Vec<case::Point>> {
        match self {
            Self::Ekf => case::ekf(battery, samples, case, start),
            Self::Coulomb => case::coulomb(battery, samples, case, start),
        }
    }
}

/// What runs, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// A built-in battery or a file; none for the one that fits the kind of measurement.
    pub cell: Option<String>,
    /// The estimator.
    pub estimator: Estimator,
    /// Samples per second.
    pub rate_hz: f64,
    /// What is made wrong: one case, or the standard set.
    pub cases: Vec<Case>,
}

/// An estimator beside the charge that was counted, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatorTrace {
    /// Time from the start \[s\].
    pub time_s: Vec<f64>,
    /// State of charge: counted, estimated, 0..1.
    pub soc: [Vec<f64>; 2],
    /// The estimator's standard deviation.
    pub sd: Vec<f64>,
    /// Current, positive when discharging \[A\].
    pub current_a: Vec<f64>,
    /// Voltage \[V\].
    pub voltage_v: Vec<f64>,
}

/// Takes each run, by its place in the report, with what happened, in any order.
pub type Keep<'a> = &'a (dyn Fn(usize, &EstimatorRun, EstimatorTrace) -> anyhow::Result<()> + Sync);

/// Runs an estimator over every file, and every drive cycle of every folder.
///
/// # Errors
/// A file that cannot be read, a battery that is none, a rate that is out of range.
pub fn run(paths: &[PathBuf], options: &Options) -> anyhow::Result<EstimatorReport> {
    run_keeping(paths, options, None)
}

/// As [`run`]; what happened may be kept.
///
/// # Errors
/// As [`run`]; what `keep` refuses.
pub fn run_keeping(
    paths: &[PathBuf],
    options: &Options,
    keep: Option<Keep<'_>>,
) -> anyhow::Result<EstimatorReport> {
    let named = options.cell.as_deref().map(battery::load).transpose()?;
    let builtin = [DEFAULT_CELL, DEFAULT_PACK].map(battery::load);
    let [cell, pack] = builtin;
    let (cell, pack) = (cell?, pack?);
    let mut skipped = Vec::new();
    let read: anyhow::Result<Vec<(Measurement, bool)>> = input::files(paths)?
        .par_iter()
        .map(|(path, of_folder)| Ok((input::measurement(path)?, *of_folder)))
        .collect();
    let mut jobs = Vec::new();
    for (measured, of_folder) in read? {
        let usual = match &measured {
            Measurement::Trip(_) => &pack,
            Measurement::Cell(_) => &cell,
        };
        let battery = named.as_ref().unwrap_or(usual).clone();
        let why = match &measured {
            Measurement::Cell(record) if of_folder => {
                match record.kind(f64::from(battery.battery.capacity_ah)) {
                    (Kind::Cycle, _) => None,
                    (_, why) => Some(format!("{}: {why}", record.name)),
                }
            }
            _ => None,
        };
        match why {
            Some(why) => skipped.push(why),
            None => jobs.push((battery, measured)),
        }
    }
    anyhow::ensure!(!jobs.is_empty(), "no drive cycle and no trip in what was named");
    let runs: anyhow::Result<Vec<Vec<EstimatorRun>>> = (jobs.par_iter().enumerate())
        .map(|(job, (battery, measured))| {
            one(battery, measured, options, |case, run, trace| {
                keep.map_or(Ok(()), |keep| keep(job * options.cases.len() + case, run, trace()))
            })
        })
        .collect();
    Ok(EstimatorReport {
        estimator: options.estimator,
        rate_hz: options.rate_hz,
        runs: runs?.into_iter().flatten().collect(),
        skipped,
    })
}

/// A rested cell whose voltage is off by this share of what the battery spans is another one.
const OTHER_CELL: f64 = 0.15;
/// It rests below this share of the capacity an hour.
const RESTS: f64 = 0.05;

/// That a test is of another cell than the battery, by its first sample and its charge, in words.
#[expect(clippy::cast_possible_truncation, reason = "the model computes in f32")]
fn other_cell(battery: &BatteryFile, record: &CellRecord) -> Option<String> {
    let capacity_ah = f64::from(battery.battery.capacity_ah);
    let at = |soc: f64| f64::from(battery.battery.open_circuit.at(soc.clamp(0.0, 1.0) as f32));
    let (first_v, first_a) = (*record.voltage_v.first()?, *record.current_a.first()?);
    let soc = record.soc(0, capacity_ah);
    let off_v = (first_v - at(soc)).abs();
    if first_a.abs() <= RESTS * capacity_ah && off_v > OTHER_CELL * (at(1.0) - at(0.0)) {
        return Some(format!(
            "the rested cell has {first_v:.3} V at {:.0} %, where `{}` has {:.3} V: another cell, or \
             not full where the counter is 0 (--cell names the battery)",
            100.0 * soc,
            battery.name,
            at(soc)
        ));
    }
    let most_ah = record.discharged_ah.iter().copied().fold(0.0, f64::max);
    (most_ah > (1.0 + OTHER_CELL) * capacity_ah).then(|| {
        format!(
            "{most_ah:.2} A·h were discharged, and `{}` has {capacity_ah:.2} A·h: another cell (--cell \
             names the battery)",
            battery.name
        )
    })
}

/// Every case over one measurement.
fn one(
    battery: &BatteryFile,
    measured: &Measurement,
    options: &Options,
    keep: impl Fn(usize, &EstimatorRun, &dyn Fn() -> EstimatorTrace) -> anyhow::Result<()> + Sync,
) -> anyhow::Result<Vec<EstimatorRun>> {
    let capacity_ah = f64::from(battery.battery.capacity_ah);
    let mut samples =
        samples::sampled(measured, 1.0 / options.rate_hz, battery.current_delay_s, capacity_ah)?;
    if let Measurement::Cell(record) = measured {
        samples.notes.extend(other_cell(battery, record));
    }
    options
        .cases
        .par_iter()
        .enumerate()
        .map(|(number, case)| {
            let points = options.estimator.points(battery, &samples, case, case.start(&samples))?;
            let figures = Figures::of(&points, samples.dt_s)
                .with_context(|| format!("{}: no state of charge to compare with", samples.name))?;
            let soc = samples.soc.iter().copied().filter(|s| s.is_finite());
            let (low, high) = soc.fold((f64::MAX, f64::MIN), |(l, h), s| (l.min(s), h.max(s)));
            let run = EstimatorRun {
                name: samples.name.clone(),
                battery: battery.name.clone(),
                case: *case,
                soc_span: high - low,
                figures,
                notes: samples.notes.clone(),
                reference_doubtful: samples.reference_doubtful,
            };
            keep(number, &run, &|| traced(&samples, &points))?;
            Ok(run)
        })
        .collect()
}

fn traced(samples: &samples::Samples, points: &[case::Point]) -> EstimatorTrace {
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let time_s = (0..points.len()).map(|i| i as f64 * samples.dt_s).collect();
    EstimatorTrace {
        time_s,
        soc: [samples.soc.clone(), points.iter().map(|p| p.soc).collect()],
        sd: points.iter().map(|p| p.sd).collect(),
        current_a: samples.current_a.clone(),
        voltage_v: samples.voltage_v.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_the_wrong_cell() {
        let battery = battery::load(DEFAULT_CELL).unwrap();
        let record = |voltage_v: f64, discharged_ah: f64| CellRecord {
            time_s: vec![0.0, 1.0],
            current_a: vec![0.0; 2],
            voltage_v: vec![voltage_v; 2],
            discharged_ah: vec![0.0, discharged_ah],
            ..CellRecord::default()
        };
        assert_eq!(other_cell(&battery, &record(4.17, 2.8)), None);
        let said = other_cell(&battery, &record(3.4, 1.0)).unwrap();
        assert!(said.starts_with("the rested cell has 3.400 V at 100 %"), "{said}");
        let said = other_cell(&battery, &record(4.17, 30.0)).unwrap();
        assert!(said.starts_with("30.00 A·h were discharged"), "{said}");
    }
}
