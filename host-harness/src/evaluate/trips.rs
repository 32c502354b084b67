//! `voltstep validate --trips`: a vehicle against every trip in a folder, the battery alone on
//! measured current and temperature, and the whole vehicle on measured speed.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;
use serde::Serialize;

use super::number;
use super::statistics::{Spread, Summary, spread};
use crate::cli::Mode;
use crate::read::trip::{self, Trip};
use crate::read::vehicle::{self, Vehicle};
use crate::show::table::table;
use crate::simulate::replay::{self, Options};

/// How far one trip in one mode is from its measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The trip.
    pub name: String,
    /// `battery` or `vehicle`.
    pub mode: &'static str,
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
    /// Whether it counts in the summary.
    pub counts: bool,
    /// What the reader should know: quirks of the data, why it does not count.
    pub notes: Vec<String>,
}

/// Every trip of a folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The vehicle's name.
    pub vehicle: String,
    /// The step \[s\].
    pub dt_s: f64,
    /// A row for each trip and mode.
    pub trips: Vec<Row>,
    /// The spreads of the rows that count, by mode.
    pub summary: BTreeMap<&'static str, Summary>,
    /// How long it took, reading included \[s\].
    pub wall_s: f64,
}

/// A figure of a row, by name.
type Figure = (&'static str, fn(&Row) -> Option<f64>);

const FIGURES: [Figure; 7] = [
    ("voltage_rmse_v", |r| Some(r.voltage_rmse_v)),
    ("soc_rmse", |r| Some(r.soc_rmse)),
    ("soc_drop_rel", |r| Some(r.soc_drop_rel)),
    ("current_rmse_a", |r| Some(r.current_rmse_a)),
    ("torque_rmse_nm", |r| r.torque_rmse_nm),
    ("energy_rel", |r| Some(r.energy_rel)),
    ("speed_error_rms_m_s", |r| r.speed_error_rms_m_s),
];
const MODES: [(&str, Mode); 2] = [("battery", Mode::Battery), ("vehicle", Mode::Vehicle)];

/// Runs a vehicle on every trip of a folder, in both modes.
///
/// # Errors
/// A folder without trips, a file that is none, a vehicle that cannot be read, a run that
/// diverged.
pub fn run(folder: &Path, vehicle: &str, dt_ms: f64) -> anyhow::Result<Report> {
    let started = std::time::Instant::now();
    let vehicle = vehicle::load(vehicle)?;
    replay::check_step(dt_ms)?;
    let found: anyhow::Result<Vec<[Row; 2]>> = super::csv_files(folder)?
        .par_iter()
        .map(|path| both_modes(&vehicle, &trip::read(path)?, dt_ms))
        .collect();
    let trips: Vec<Row> = found?.into_iter().flatten().collect();
    let summary = MODES.map(|(mode, _)| (mode, summary(&trips, mode)));
    Ok(Report {
        vehicle: vehicle.name,
        dt_s: dt_ms / 1000.0,
        trips,
        summary: BTreeMap::from(summary),
        wall_s: started.elapsed().as_secs_f64(),
    })
}

fn both_modes(vehicle: &Vehicle, trip: &Trip, dt_ms: f64) -> anyhow::Result<[Row; 2]> {
    let [battery, whole] = MODES;
    let (battery, whole) =
        rayon::join(|| row(vehicle, trip, battery, dt_ms), || row(vehicle, trip, whole, dt_ms));
    Ok([battery?, whole?])
}

fn row(
    vehicle: &Vehicle,
    trip: &Trip,
    (name, mode): (&'static str, Mode),
    dt_ms: f64,
) -> anyhow::Result<Row> {
    let options =
        Options { vehicle: String::new(), mode, dt_ms, ledger: false, show_progress: false };
    let replay = replay::of_trip(vehicle.clone(), trip.clone(), mode, &options)
        .with_context(|| format!("{} in {name} mode", trip.name))?;
    let summary = replay.summary;
    let error = summary.error.context("no comparison")?;
    let unfit = trip.unfit(f64::from(vehicle.powertrain.battery.capacity_ah()));
    let mut notes = summary.notes;
    if !unfit.is_empty() {
        notes.push("left out of the summary".to_owned());
    }
    Ok(Row {
        name: trip.name.clone(),
        mode: name,
        voltage_rmse_v: error.voltage_rmse_v,
        soc_rmse: error.soc_rmse,
        soc_drop_rel: error.soc_drop_rel,
        current_rmse_a: error.current_rmse_a,
        torque_rmse_nm: error.torque_rmse_nm,
        energy_rel: error.energy_rel,
        speed_error_rms_m_s: summary.speed_error_rms_m_s,
        counts: unfit.is_empty(),
        notes,
    })
}

fn summary(trips: &[Row], mode: &str) -> Summary {
    let rows: Vec<&Row> = trips.iter().filter(|r| r.mode == mode && r.counts).collect();
    let spreads: Vec<Spread> = FIGURES
        .iter()
        .filter_map(|(name, pick)| spread(name, rows.iter().map(|r| pick(r))))
        .collect();
    Summary { count: rows.len(), spreads }
}

impl Report {
    /// For a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::new();
        for (mode, _) in MODES {
            let mut rows = table(&[
                mode,
                "voltage [V]",
                "SOC [%]",
                "SOC drop [%]",
                "current [A]",
                "torque [N·m]",
                "energy [%]",
                "speed [m/s]",
            ]);
            for r in self.trips.iter().filter(|r| r.mode == mode) {
                rows.add_row([
                    format!("{}{}", r.name, if r.counts { "" } else { " *" }),
                    number(Some(r.voltage_rmse_v), 2),
                    number(Some(100.0 * r.soc_rmse), 3),
                    format!("{:+.1}", 100.0 * r.soc_drop_rel),
                    number(Some(r.current_rmse_a), 2),
                    number(r.torque_rmse_nm, 1),
                    format!("{:+.1}", 100.0 * r.energy_rel),
                    number(r.speed_error_rms_m_s, 4),
                ]);
            }
            let Some(summary) = self.summary.get(mode) else { continue };
            for (label, pick) in SPREADS {
                let of = |name, factor, digits| {
                    number(summary.get(name).map(|s| factor * pick(s)), digits)
                };
                rows.add_row([
                    format!("{label} of {}", summary.count),
                    of("voltage_rmse_v", 1.0, 2),
                    of("soc_rmse", 100.0, 3),
                    of("soc_drop_rel", 100.0, 1),
                    of("current_rmse_a", 1.0, 2),
                    of("torque_rmse_nm", 1.0, 1),
                    of("energy_rel", 100.0, 1),
                    of("speed_error_rms_m_s", 1.0, 4),
                ]);
            }
            text += &format!("{rows}\n");
        }
        text += "* left out of the summary; RMS of simulated minus measured, drop and energy \
                 relative, their spreads without sign\n";
        for r in self.trips.iter().filter(|r| r.mode == "vehicle") {
            for note in &r.notes {
                text += &format!("{}: {note}\n", r.name);
            }
        }
        let count = self.trips.len() / MODES.len();
        text + &format!(
            "{count} trips, {} in steps of {} ms, in {:.1} s\n",
            self.vehicle,
            1000.0 * self.dt_s,
            self.wall_s
        )
    }

    /// The JSON text, with a line end.
    ///
    /// # Errors
    /// None that is known of.
    pub fn to_json(&self) -> anyhow::Result<String> {
        let mut text = serde_json::to_string_pretty(self).context("writing JSON")?;
        text.push('\n');
        Ok(text)
    }
}

type Pick = (&'static str, fn(&Spread) -> f64);
const SPREADS: [Pick; 3] =
    [("median", |s| s.median), ("90th percentile", |s| s.p90), ("largest", |s| s.max)];
