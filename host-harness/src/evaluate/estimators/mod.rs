//! `voltstep soc`: the state-of-charge estimators of `voltstep-bms` over measurements.

mod case;
mod figures;
pub mod honesty;
mod report;
mod samples;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::ValueEnum;
use rayon::prelude::*;

pub use case::Case;
pub use figures::Figures;
pub use report::{Report, Run};

use crate::evaluate;
use crate::read::battery::{self, BatteryFile};
use crate::read::cell::Kind;
use samples::Measured;

/// The built-in battery for trips.
const DEFAULT_PACK: &str = "bmw-i3-60ah";
/// At least this share of the samples must hold the truth within three standard deviations.
pub const HONEST: f64 = 0.95;

/// Which estimator runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Estimator {
    /// Counts the charge.
    Coulomb,
    /// Kalman filter on current and voltage.
    Ekf,
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

/// Runs an estimator over every file, and every drive cycle of every folder.
///
/// # Errors
/// A file that cannot be read, a battery that is none, a rate that is out of range.
pub fn run(paths: &[PathBuf], options: &Options) -> anyhow::Result<Report> {
    anyhow::ensure!(
        (0.01..=1000.0).contains(&options.rate_hz),
        "--rate-hz {}: must lie in 0.01..1000",
        options.rate_hz
    );
    let named = options.cell.as_deref().map(battery::load).transpose()?;
    let builtin = [evaluate::cells::DEFAULT_CELL, DEFAULT_PACK].map(battery::load);
    let [cell, pack] = builtin;
    let (cell, pack) = (cell?, pack?);
    let mut skipped = Vec::new();
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            for file in evaluate::csv_files(path)? {
                found.push((file, true));
            }
        } else {
            found.push((path.clone(), false));
        }
    }
    let read: anyhow::Result<Vec<(Measured, bool)>> =
        found.par_iter().map(|(path, of_folder)| Ok((samples::read(path)?, *of_folder))).collect();
    let mut jobs = Vec::new();
    for (measured, of_folder) in read? {
        let battery =
            named.as_ref().unwrap_or(if measured.is_trip() { &pack } else { &cell }).clone();
        let why = match &measured {
            Measured::Cell(record) if of_folder => {
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
    let runs: anyhow::Result<Vec<Vec<Run>>> =
        jobs.par_iter().map(|(battery, measured)| one(battery, measured, options)).collect();
    Ok(Report {
        estimator: options.estimator,
        rate_hz: options.rate_hz,
        runs: runs?.into_iter().flatten().collect(),
        skipped,
    })
}

/// Every case over one measurement.
fn one(battery: &BatteryFile, measured: &Measured, options: &Options) -> anyhow::Result<Vec<Run>> {
    let capacity_ah = f64::from(battery.battery.capacity_ah);
    let samples = measured.sampled(1.0 / options.rate_hz, battery.current_delay_s, capacity_ah)?;
    options
        .cases
        .par_iter()
        .map(|case| {
            let points = match options.estimator {
                Estimator::Ekf => case::ekf(battery, &samples, case)?,
                Estimator::Coulomb => case::coulomb(battery, &samples, case)?,
            };
            let figures = Figures::of(&points, samples.dt_s)
                .with_context(|| format!("{}: no state of charge to compare with", samples.name))?;
            let soc = samples.soc.iter().copied().filter(|s| s.is_finite());
            let (low, high) = soc.fold((f64::MAX, f64::MIN), |(l, h), s| (l.min(s), h.max(s)));
            Ok(Run {
                name: samples.name.clone(),
                battery: battery.name.clone(),
                case: *case,
                soc_span: high - low,
                figures,
                notes: samples.notes.clone(),
            })
        })
        .collect()
}

/// Whether a path could be a measurement.
///
/// # Errors
/// A path that is not there.
pub fn check_path(path: &str) -> Result<PathBuf, String> {
    let path = Path::new(path);
    if path.exists() { Ok(path.to_owned()) } else { Err("no such file or folder".to_owned()) }
}
