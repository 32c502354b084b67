//! `voltstep validate --trips`: a vehicle against every trip in a folder, the battery alone on
//! measured current and temperature, and the whole vehicle on measured speed.

use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;
use serde::Serialize;

use crate::read::input;
use crate::read::trip::Trip;
use crate::read::vehicle::Vehicle;
use crate::simulate::mode::Mode;
use crate::simulate::progress::Unseen;
use crate::simulate::replay::{self, Options, Replay};
use crate::simulate::statistics::{Spread, Spreads, spread};

/// How far one trip in one mode is from its measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TripRow {
    /// The trip.
    pub name: String,
    /// What of it was replayed.
    pub mode: Mode,
    /// Battery voltage \[V\].
    pub voltage_rmse_v: f64,
    /// State of charge, 0..1.
    pub soc_rmse: f64,
    /// Drop of the state of charge, relative to the measured one.
    pub soc_drop_rel: f64,
    /// Battery current \[A\].
    pub current_rmse_a: f64,
    /// Motor torque \[N·m\]; absent in battery mode.
    pub torque_rmse_nm: Option<f64>,
    /// Net energy at the battery, relative to the measured one.
    pub energy_rel: f64,
    /// Speed against the measured one \[m/s\]; absent in battery mode.
    pub speed_error_rms_m_s: Option<f64>,
    /// Whether it counts in the summary: whether the measurement can be trusted, by rules that do
    /// not look at the figures of this row.
    pub counts: bool,
    /// What the reader should know: quirks of the data, what was repaired, why it does not count.
    pub notes: Vec<String>,
}

/// Every trip of a folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TripsReport {
    /// The vehicle's name.
    pub vehicle: String,
    /// The step \[s\].
    pub dt_s: f64,
    /// A row for each trip and mode.
    pub trips: Vec<TripRow>,
    /// The spreads of the rows that count, by mode.
    pub summary: SpreadsByMode,
    /// The spreads of all rows, by mode.
    pub summary_of_all: SpreadsByMode,
    /// How long it took, reading included \[s\].
    pub wall_s: f64,
}

/// The spreads of the rows of each mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpreadsByMode {
    /// The battery alone.
    pub battery: Spreads,
    /// The whole vehicle.
    pub vehicle: Spreads,
}

/// A figure of a row, by name.
type Figure = (&'static str, fn(&TripRow) -> Option<f64>);

const FIGURES: [Figure; 7] = [
    ("voltage_rmse_v", |r| Some(r.voltage_rmse_v)),
    ("soc_rmse", |r| Some(r.soc_rmse)),
    ("soc_drop_rel", |r| Some(r.soc_drop_rel)),
    ("current_rmse_a", |r| Some(r.current_rmse_a)),
    ("torque_rmse_nm", |r| r.torque_rmse_nm),
    ("energy_rel", |r| Some(r.energy_rel)),
    ("speed_error_rms_m_s", |r| r.speed_error_rms_m_s),
];

/// Takes each finished replay, with its energy ledger, in any order.
pub type Keep<'a> = &'a (dyn Fn(&Replay) -> anyhow::Result<()> + Sync);

/// Runs a vehicle on every trip of a folder, in both modes, in steps of `dt_s`.
///
/// # Errors
/// A folder without trips, a file that is none, a run that diverged.
pub fn run(folder: &Path, vehicle: &Vehicle, dt_s: f64) -> anyhow::Result<TripsReport> {
    run_keeping(folder, vehicle, dt_s, None)
}

/// As [`run`]; each replay may be kept.
///
/// # Errors
/// As [`run`]; what `keep` refuses.
pub fn run_keeping(
    folder: &Path,
    vehicle: &Vehicle,
    dt_s: f64,
    keep: Option<Keep<'_>>,
) -> anyhow::Result<TripsReport> {
    let started = std::time::Instant::now();
    let found: anyhow::Result<Vec<[TripRow; 2]>> = input::csv_files(folder)?
        .par_iter()
        .map(|path| both_modes(vehicle, &input::trip(path)?, dt_s, keep))
        .collect();
    let trips: Vec<TripRow> = found?.into_iter().flatten().collect();
    let summary = by_mode(&trips, |r| r.counts);
    let summary_of_all = by_mode(&trips, |_| true);
    Ok(TripsReport {
        vehicle: vehicle.name.clone(),
        dt_s,
        trips,
        summary,
        summary_of_all,
        wall_s: started.elapsed().as_secs_f64(),
    })
}

fn both_modes(
    vehicle: &Vehicle,
    trip: &Trip,
    dt_s: f64,
    keep: Option<Keep<'_>>,
) -> anyhow::Result<[TripRow; 2]> {
    let (battery, whole) = rayon::join(
        || row(vehicle, trip, Mode::Battery, dt_s, keep),
        || row(vehicle, trip, Mode::Vehicle, dt_s, keep),
    );
    Ok([battery?, whole?])
}

fn row(
    vehicle: &Vehicle,
    trip: &Trip,
    mode: Mode,
    dt_s: f64,
    keep: Option<Keep<'_>>,
) -> anyhow::Result<TripRow> {
    let options = Options { mode, dt_s, ledger: keep.is_some() };
    let replay = replay::of_trip(vehicle.clone(), trip.clone(), options, &Unseen)
        .with_context(|| format!("{} in {} mode", trip.name, mode.name()))?;
    if let Some(keep) = keep {
        keep(&replay)?;
    }
    let summary = replay.summary;
    let error = summary.error.context("no comparison")?;
    let marked = trip.marked(f64::from(vehicle.powertrain.battery.capacity_ah()));
    let mut notes = summary.notes;
    if !marked.is_empty() {
        notes.push("marked: counts only in the summary of all".to_owned());
    }
    Ok(TripRow {
        name: trip.name.clone(),
        mode,
        voltage_rmse_v: error.voltage_rmse_v,
        soc_rmse: error.soc_rmse,
        soc_drop_rel: error.soc_drop_rel,
        current_rmse_a: error.current_rmse_a,
        torque_rmse_nm: error.torque_rmse_nm,
        energy_rel: error.energy_rel,
        speed_error_rms_m_s: summary.speed_error_rms_m_s,
        counts: marked.is_empty(),
        notes,
    })
}

/// The rows that count, by mode.
fn by_mode(trips: &[TripRow], counts: fn(&TripRow) -> bool) -> SpreadsByMode {
    let spreads = |mode: Mode| {
        let rows: Vec<&TripRow> = trips.iter().filter(|r| r.mode == mode && counts(r)).collect();
        let spreads: Vec<Spread> = FIGURES
            .iter()
            .filter_map(|(name, pick)| spread(name, rows.iter().map(|r| pick(r))))
            .collect();
        Spreads { count: rows.len(), spreads }
    };
    SpreadsByMode { battery: spreads(Mode::Battery), vehicle: spreads(Mode::Vehicle) }
}
