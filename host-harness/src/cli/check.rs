//! `voltstep check`.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;

use crate::read::{check, vehicle};
use crate::show;
use crate::simulate::replay::DEFAULT_VEHICLE;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Cycles, trips, tests of a cell, vehicles, batteries, circuits, scenarios, recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The vehicle whose battery a trip is compared with: a built-in one or a file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = DEFAULT_VEHICLE)]
    vehicle: String,
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
}

/// Says what files are; whether all of them can be trusted as they are.
///
/// # Errors
/// A file that cannot be read, or is nothing that is known.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let Arguments { files, vehicle, json } = arguments;
    let capacity_ah = vehicle::load(vehicle)?.powertrain.battery.capacity_ah();
    let found = files
        .iter()
        .map(|file| check::check(file, f64::from(capacity_ah)))
        .collect::<anyhow::Result<Vec<_>>>()?;
    super::print(&if *json {
        show::json(&found).context("what was found")?
    } else {
        found.iter().map(show::check::render).collect::<Vec<_>>().join("\n")
    })?;
    Ok(found.iter().all(|file| file.doubts.is_empty()))
}
