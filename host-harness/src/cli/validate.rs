//! `voltstep validate`.

use std::path::PathBuf;

use clap::Args;

use super::out::Out;
use crate::evaluate::{cells, trips};
use crate::read::{battery, vehicle};
use crate::show;
use crate::show::progress::Bar;
use crate::show::report::folder as overview;
use crate::show::report::run::{self as report, Parameters};
use crate::simulate::mode::{Mode, Replayed};
use crate::simulate::replay::{DEFAULT_VEHICLE, Replay};
use crate::verify;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Compare with every trip file in a folder: the battery alone on measured current, and
    /// the whole vehicle
    #[arg(long, value_name = "DIR", conflicts_with = "cells", group = "measured")]
    trips: Option<PathBuf>,
    /// Compare with every drive cycle of a cell in a folder: the battery on measured current
    /// and temperature, its thermal node alone
    #[arg(long, value_name = "DIR", group = "measured")]
    cells: Option<PathBuf>,
    /// For --cells: a built-in battery (see `voltstep list`) or a battery file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = cells::DEFAULT_CELL,
          requires = "cells")]
    cell: String,
    /// For --trips: a built-in vehicle (see `voltstep list`) or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = DEFAULT_VEHICLE,
          requires = "trips")]
    vehicle: String,
    /// For --trips and --cells: length of a step in milliseconds
    #[arg(long, value_name = "MS", default_value_t = 10.0)]
    dt_ms: f64,
    /// For --trips and --cells: folder for an overview, report.html, with a report of each
    #[arg(long, value_name = "DIR", requires = "measured")]
    out: Option<PathBuf>,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// Compares and prints; whether every check passed.
///
/// # Errors
/// Bad input, a run that diverged.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Arguments { trips, cells, cell, vehicle, dt_ms, out, json } = arguments;
    let out = Out::new(out)?;
    if let Some(folder) = trips {
        let (vehicle, texts) = vehicle::load_with_texts(&vehicle)?;
        let parameters = Parameters { vehicle: &vehicle, files: &texts };
        let keep = |replay: &Replay| {
            let mode = match replay.summary.mode {
                Replayed::Battery | Replayed::Profile => Mode::Battery,
                Replayed::Cycle | Replayed::Trip => Mode::Vehicle,
            };
            let name = overview::of_trip(&replay.summary.input, mode);
            out.put(&name, || report::replay(replay, &parameters))
        };
        let report = trips::run_keeping(&folder, &vehicle, super::step_s(dt_ms)?, out.keep(&keep))?;
        let json_text = show::json(&report)?;
        let written = out.publish(|| overview::trips(&report), &json_text)?;
        let text = if json { json_text } else { show::trips::render(&report) + &written };
        super::print(&text)?;
        return Ok(true);
    }
    if let Some(folder) = cells {
        let cell = battery::load(&cell)?;
        let keep = |row: &cells::CellRow, trace| {
            out.put(&overview::of_cell(&row.name), || report::cell(&cell.name, row, trace))
        };
        let report = cells::run_keeping(&folder, &cell, super::step_s(dt_ms)?, out.keep(&keep))?;
        let json_text = show::json(&report)?;
        let written = out.publish(|| overview::cells(&report), &json_text)?;
        let text = if json { json_text } else { show::cells::render(&report) + &written };
        super::print(&text)?;
        return Ok(true);
    }
    let report = verify::run(&Bar::of_cases());
    super::print(&if json { show::json(&report)? } else { show::validation::render(&report) })?;
    Ok(report.is_good())
}
