//! `voltstep validate --cells`: a cell against every drive cycle in a folder, on measured current
//! and temperature; and its thermal node on the surroundings alone.

use std::path::Path;

use anyhow::Context;
use plant_core::Dt;
use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryState};
use rayon::prelude::*;
use serde::Serialize;

use crate::read::battery::BatteryFile;
use crate::read::cell::{CellRecord, Kind};
use crate::read::input;
use crate::simulate::statistics::{Spread, Spreads, spread};

/// The built-in cell that is compared where none is named.
pub const DEFAULT_CELL: &str = "panasonic-ncr18650pf";
/// A chamber that differs from the cell by more at the start was not logged right \[K\].
const CHAMBER_K: f64 = 5.0;

/// How far one drive cycle is from its measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellRow {
    /// The file.
    pub name: String,
    /// Temperature of the surroundings \[°C\].
    pub ambient_c: f64,
    /// State of charge at the end, by the bench's counter.
    pub soc_end: f64,
    /// Voltage over the whole cycle \[mV\].
    pub voltage_rmse_mv: f64,
    /// Voltage above 15 % state of charge \[mV\].
    pub voltage_rmse_mv_above_15_soc: Option<f64>,
    /// Voltage above 25 % state of charge \[mV\].
    pub voltage_rmse_mv_above_25_soc: Option<f64>,
    /// Temperature of the cell from the thermal node \[K\]; absent where there is none.
    pub temperature_rmse_k: Option<f64>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// Every drive cycle of a folder.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellsReport {
    /// The cell's name.
    pub cell: String,
    /// The step \[s\].
    pub dt_s: f64,
    /// A row for each drive cycle.
    pub cells: Vec<CellRow>,
    /// The spreads of the rows.
    pub summary: Spreads,
    /// Files that are no drive cycle, and why.
    pub skipped: Vec<String>,
    /// How long it took, reading included \[s\].
    pub wall_s: f64,
}

/// A cell beside its measurement, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellTrace {
    /// Time from the start \[s\].
    pub time_s: Vec<f64>,
    /// Measured current, positive when discharging \[A\].
    pub current_a: Vec<f64>,
    /// Measured and simulated voltage \[V\].
    pub voltage_v: [Vec<f64>; 2],
    /// Measured temperature, and that of the thermal node \[°C\]; the latter empty where there is none.
    pub temperature_c: [Vec<f64>; 2],
    /// State of charge by the bench's counter, 0..1.
    pub soc: Vec<f64>,
}

/// Takes each row with what happened, in any order.
pub type Keep<'a> = &'a (dyn Fn(&CellRow, CellTrace) -> anyhow::Result<()> + Sync);

type Figure = (&'static str, fn(&CellRow) -> Option<f64>);

const FIGURES: [Figure; 4] = [
    ("voltage_rmse_mv", |r| Some(r.voltage_rmse_mv)),
    ("voltage_rmse_mv_above_15_soc", |r| r.voltage_rmse_mv_above_15_soc),
    ("voltage_rmse_mv_above_25_soc", |r| r.voltage_rmse_mv_above_25_soc),
    ("temperature_rmse_k", |r| r.temperature_rmse_k),
];

/// Runs a cell on every drive cycle of a folder, in steps of `dt_s`.
///
/// # Errors
/// A folder without cell files, a file that is none.
pub fn run(folder: &Path, cell: &BatteryFile, dt_s: f64) -> anyhow::Result<CellsReport> {
    run_keeping(folder, cell, dt_s, None)
}

/// As [`run`]; what happened may be kept.
///
/// # Errors
/// As [`run`]; what `keep` refuses.
pub fn run_keeping(
    folder: &Path,
    cell: &BatteryFile,
    dt_s: f64,
    keep: Option<Keep<'_>>,
) -> anyhow::Result<CellsReport> {
    let started = std::time::Instant::now();
    let found: anyhow::Result<Vec<Result<CellRow, String>>> = input::csv_files(folder)?
        .par_iter()
        .map(|path| {
            let record = input::cell(path)?;
            match record.kind(f64::from(cell.battery.capacity_ah)) {
                (Kind::Cycle, _) => {
                    let mut trace = keep.map(|_| CellTrace::default());
                    let row = row(cell, &record, dt_s, trace.as_mut())?;
                    if let (Some(keep), Some(trace)) = (keep, trace) {
                        keep(&row, trace)?;
                    }
                    Ok(Ok(row))
                }
                (_, why) => Ok(Err(format!("{}: {why}", record.name))),
            }
        })
        .collect();
    let (mut cells, mut skipped) = (Vec::new(), Vec::new());
    for one in found? {
        match one {
            Ok(row) => cells.push(row),
            Err(why) => skipped.push(why),
        }
    }
    anyhow::ensure!(!cells.is_empty(), "{}: no drive cycle in it", folder.display());
    let spreads: Vec<Spread> =
        FIGURES.iter().filter_map(|(name, pick)| spread(name, cells.iter().map(pick))).collect();
    let summary = Spreads { count: cells.len(), spreads };
    let wall_s = started.elapsed().as_secs_f64();
    Ok(CellsReport { cell: cell.name.clone(), dt_s, cells, summary, skipped, wall_s })
}

/// A sum of squares over the samples that have both.
#[derive(Default)]
struct Squares {
    sum: f64,
    count: f64,
}

impl Squares {
    fn add(&mut self, difference: f64) {
        if difference.is_finite() {
            self.sum += difference * difference;
            self.count += 1.0;
        }
    }

    fn rms(&self) -> Option<f64> {
        (self.count > 0.0).then(|| (self.sum / self.count).sqrt())
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the model computes in f32")]
fn row(
    cell: &BatteryFile,
    record: &CellRecord,
    dt_s: f64,
    mut trace: Option<&mut CellTrace>,
) -> anyhow::Result<CellRow> {
    let battery = MappedBattery::new(cell.battery, Dt::from_s(dt_s as f32)?)?;
    let capacity_ah = f64::from(cell.battery.capacity_ah);
    let first_c = record.cell_c.first().copied().context("an empty record")?;
    let mut notes = record.notes.clone();
    let fits = |chamber_c: f64| (chamber_c - first_c).abs() <= CHAMBER_K;
    let chamber_c = record.chamber_c.iter().copied().find(|c| c.is_finite());
    let ambient_c = match chamber_c {
        Some(c) if fits(c) => c,
        Some(c) => {
            notes.push(format!(
                "the chamber reads {c} °C and the cell {first_c} °C: the cell's is taken for the \
                 surroundings"
            ));
            first_c
        }
        None => first_c,
    };
    let start_soc = record.soc(0, capacity_ah).clamp(0.0, 1.0) as f32;
    let start = battery.rested_at(start_soc, first_c as f32)?;
    // One follows the measured temperature, the other its own.
    let (mut told, mut alone) = (start, start);
    alone.ambient_c = ambient_c as f32;

    let has_node = cell.battery.thermal.heat_capacity_j_per_k.is_finite();
    let current_a = record.delayed_a(cell.current_delay_s);
    let mut squares = [Squares::default(), Squares::default(), Squares::default()];
    let mut warmth = Squares::default();
    let mut steps = 0;
    let (mut outside, mut refused_c) = (0_usize, 0.0);
    let start_s = record.time_s[0];
    for (i, &amps) in current_a.iter().enumerate().skip(1) {
        let until = ((record.time_s[i] - start_s) / dt_s).round() as i64;
        battery.set_temperature(&mut told, record.cell_c[i] as f32);
        if fits(record.chamber_c[i]) {
            alone.ambient_c = record.chamber_c[i] as f32;
        }
        let feed = |state: &mut MappedBatteryState| {
            battery.step(state, MappedBatteryInput { current_a: amps as f32 })
        };
        let Some(mut out) = (until > steps).then(|| feed(&mut told)) else { continue };
        let mut free = feed(&mut alone);
        for _ in steps + 1..until {
            out = feed(&mut told);
            free = feed(&mut alone);
        }
        steps = until;
        outside += usize::from(out.outside_identified);
        refused_c += f64::from(out.refused_charge_c.abs());
        let off_mv = 1000.0 * (f64::from(out.terminal_v) - record.voltage_v[i]);
        let soc = record.soc(i, capacity_ah);
        for (sum, above) in squares.iter_mut().zip([f64::NEG_INFINITY, 0.15, 0.25]) {
            if soc > above {
                sum.add(off_mv);
            }
        }
        warmth.add(f64::from(free.temperature_c) - record.cell_c[i]);
        if let Some(trace) = trace.as_mut() {
            trace.time_s.push(record.time_s[i] - start_s);
            trace.current_a.push(amps);
            trace.soc.push(soc);
            trace.voltage_v[0].push(record.voltage_v[i]);
            trace.voltage_v[1].push(f64::from(out.terminal_v));
            trace.temperature_c[0].push(record.cell_c[i]);
            if has_node {
                trace.temperature_c[1].push(f64::from(free.temperature_c));
            }
        }
    }
    if outside > 0 {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let share = 100.0 * outside as f64 / record.time_s.len() as f64;
        notes.push(format!("{share:.0} % of the samples lie outside the identified range"));
    }
    if refused_c > 0.0 {
        notes.push("the cell's current limits refused part of the measured current".to_owned());
    }
    Ok(CellRow {
        name: record.name.clone(),
        ambient_c,
        soc_end: record.soc(record.time_s.len() - 1, capacity_ah),
        voltage_rmse_mv: squares[0].rms().context("no sample to compare")?,
        voltage_rmse_mv_above_15_soc: squares[1].rms(),
        voltage_rmse_mv_above_25_soc: squares[2].rms(),
        temperature_rmse_k: if has_node { warmth.rms() } else { None },
        notes,
    })
}
