//! The command line of `voltstep identify battery`.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, anyhow, ensure};
use clap::Args;

use crate::identify::{self, NoCapacity, Options};
use crate::read::battery;
use crate::show::progress::Spinner;
use crate::show::{files, identified};

#[derive(Args, Debug)]
pub struct Arguments {
    /// Trip files, or tests of one cell (`time_s,current_a,voltage_v,discharged_ah,…`); a folder
    /// stands for the .csv files in it
    #[arg(required = true, value_name = "FILE|DIR")]
    inputs: Vec<PathBuf>,
    /// Battery file to write [default: none]
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Name of the battery [default: that of the file to write]
    #[arg(long)]
    name: Option<String>,
    /// What it is, in one line
    #[arg(long, default_value = "identified from measurements")]
    description: String,
    /// Where the measurements come from
    #[arg(long, default_value = "own measurements")]
    source: String,
    /// Capacity, where the measurements do not tell it: ampere-hours
    #[arg(long, value_name = "AH")]
    capacity_ah: Option<f64>,
    /// Largest discharge current, which measurements do not tell: amperes
    #[arg(long, value_name = "A", default_value_t = f64::INFINITY)]
    discharge_limit_a: f64,
    /// Largest charge current, which measurements do not tell: amperes
    #[arg(long, value_name = "A", default_value_t = f64::INFINITY)]
    charge_limit_a: f64,
    /// Folds of the cross-validation
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(2..=100))]
    folds: u64,
    /// Seed of the order in which files are dealt to folds
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// Set by Ctrl-C; the work ends at its next step.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Work that is shown, can be interrupted, and writes its result at its end.
pub(super) struct Work(Spinner);

impl Work {
    pub(super) fn new() -> Self {
        // A second handler is refused; the first one does as well.
        let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
        Self(Spinner::new())
    }

    /// Says what is being done, or ends the work.
    pub(super) fn at(&self, stage: &str) -> anyhow::Result<()> {
        ensure!(!INTERRUPTED.load(Ordering::Relaxed), "interrupted; nothing was written");
        self.0.stage(stage);
        Ok(())
    }

    /// Writes a file, whole or not at all.
    pub(super) fn write(&self, path: &Path, text: String) -> anyhow::Result<()> {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        let file = path.file_name().and_then(|n| n.to_str()).context("--out names no file")?;
        self.at("writing")?;
        files::write_all(folder, &[(file, text.into_bytes())])
    }
}

/// The last name of a path: folders say where they lie on one machine.
pub(super) fn last_name(path: &Path) -> Option<String> {
    path.file_name().map(|n| n.to_string_lossy().into_owned())
}

/// Identifies, writes the file where one is wanted, and prints.
///
/// # Errors
/// Bad input, measurements that tell no battery, a file that cannot be written, an interruption:
/// each leaves an earlier file as it was.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    for (name, value) in [
        ("--capacity-ah", arguments.capacity_ah),
        ("--discharge-limit-a", Some(arguments.discharge_limit_a)),
        ("--charge-limit-a", Some(arguments.charge_limit_a)),
    ] {
        ensure!(value.is_none_or(|v| v > 0.0), "{name} must be above 0");
    }
    let options = options(&arguments);
    let work = Work::new();
    let tick = |stage: &str| work.at(stage);
    let found = identify::identify(&arguments.inputs, options, &tick).map_err(with_flag)?;
    let text = found.to_toml();
    // What was found must be a battery.
    battery::parse("the identified battery", text.as_bytes())?;
    if let Some(path) = &arguments.out {
        work.write(path, text)?;
    }
    drop(work);
    let json = arguments.json;
    super::print(&if json { identified::json(&found)? } else { identified::render(&found) })?;
    Ok(true)
}

/// How a capacity is given here.
fn with_flag(error: anyhow::Error) -> anyhow::Error {
    match error.downcast_ref() {
        Some(NoCapacity(measurements)) => anyhow!("{measurements}, or --capacity-ah"),
        None => error,
    }
}

fn options(arguments: &Arguments) -> Options {
    let stem = arguments.out.as_deref().and_then(Path::file_stem).map(|s| s.to_string_lossy());
    let name = arguments.name.clone().or(stem.map(Into::into));
    let name = name.unwrap_or_else(|| "battery".to_owned());
    let mut command = "voltstep identify battery".to_owned();
    for input in arguments.inputs.iter().filter_map(|path| last_name(path)) {
        command += &format!(" {input}");
    }
    if let Some(ah) = arguments.capacity_ah {
        command += &format!(" --capacity-ah {ah}");
    }
    for (flag, limit_a) in [
        ("--discharge-limit-a", arguments.discharge_limit_a),
        ("--charge-limit-a", arguments.charge_limit_a),
    ] {
        if limit_a.is_finite() {
            command += &format!(" {flag} {limit_a}");
        }
    }
    command += &format!(" --folds {} --seed {}", arguments.folds, arguments.seed);
    Options {
        name,
        description: arguments.description.clone(),
        source: arguments.source.clone(),
        command,
        capacity_ah: arguments.capacity_ah,
        discharge_limit_a: arguments.discharge_limit_a,
        charge_limit_a: arguments.charge_limit_a,
        folds: usize::try_from(arguments.folds).unwrap_or(usize::MAX),
        seed: arguments.seed,
    }
}
