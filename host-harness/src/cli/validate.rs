//! `voltstep validate`.

use std::path::PathBuf;

use clap::Args;

use crate::evaluate::{cells, trips};
use crate::read::{battery, vehicle};
use crate::show;
use crate::show::progress::Bar;
use crate::simulate::replay::DEFAULT_VEHICLE;
use crate::verify;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Compare with every trip file in a folder: the battery alone on measured current, and
    /// the whole vehicle
    #[arg(long, value_name = "DIR", conflicts_with = "cells")]
    trips: Option<PathBuf>,
    /// Compare with every drive cycle of a cell in a folder: the battery on measured current
    /// and temperature, its thermal node alone
    #[arg(long, value_name = "DIR")]
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
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// Compares and prints; whether every check passed.
///
/// # Errors
/// Bad input, a run that diverged.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Arguments { trips, cells, cell, vehicle, dt_ms, json } = arguments;
    if let Some(folder) = trips {
        let vehicle = vehicle::load(&vehicle)?;
        let report = trips::run(&folder, &vehicle, super::step_s(dt_ms)?)?;
        super::print(&if json { show::json(&report)? } else { show::trips::render(&report) })?;
        return Ok(true);
    }
    if let Some(folder) = cells {
        let cell = battery::load(&cell)?;
        let report = cells::run(&folder, &cell, super::step_s(dt_ms)?)?;
        super::print(&if json { show::json(&report)? } else { show::cells::render(&report) })?;
        return Ok(true);
    }
    let report = verify::run(&Bar::of_cases());
    super::print(&if json { show::json(&report)? } else { show::validation::render(&report) })?;
    Ok(report.is_good())
}
