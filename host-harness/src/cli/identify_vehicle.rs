//! The command line of `voltstep identify vehicle`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::identify::{Work, last_name};
use crate::identify::{VehicleOptions, identify_vehicle};
use crate::show;
use crate::simulate::replay::DEFAULT_VEHICLE;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Trip files; a folder stands for the .csv files in it
    #[arg(required = true, value_name = "FILE|DIR")]
    inputs: Vec<PathBuf>,
    /// The vehicle that gives what trips do not tell (battery, gear ratio, wheels, motor constant,
    /// driver): a built-in one (see `voltstep list`) or a vehicle file
    #[arg(long, value_name = "NAME|FILE.toml", default_value = DEFAULT_VEHICLE)]
    vehicle: String,
    /// Vehicle file to write [default: none]
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Name of the vehicle [default: that of the file to write]
    #[arg(long)]
    name: Option<String>,
    /// Print JSON instead of the tables
    #[arg(long)]
    json: bool,
}

/// Identifies, writes the file where one is wanted, and prints.
///
/// # Errors
/// Bad input, trips that tell no vehicle, a file that cannot be written, an interruption: each
/// leaves an earlier file as it was.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let stem = arguments.out.as_deref().and_then(Path::file_stem).map(|s| s.to_string_lossy());
    let name = arguments.name.clone().or(stem.map(Into::into));
    let inputs: Vec<_> = arguments.inputs.iter().filter_map(|path| last_name(path)).collect();
    let template = last_name(Path::new(&arguments.vehicle)).unwrap_or_default();
    let options = VehicleOptions {
        name: name.unwrap_or_else(|| "identified".to_owned()),
        command: format!("voltstep identify vehicle {} --vehicle {template}", inputs.join(" ")),
        template: arguments.vehicle.clone(),
    };
    let work = Work::new();
    let found = identify_vehicle(&arguments.inputs, options, &|stage: &str| work.at(stage))?;
    if let Some(path) = &arguments.out {
        work.write(path, found.toml.clone())?;
    }
    drop(work);
    let json = arguments.json;
    super::print(&if json {
        show::json(&found)?
    } else {
        show::vehicle_identified::render(&found)
    })?;
    Ok(true)
}
