//! The command line of `voltstep`.

use std::io::{ErrorKind, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::{Parser, Subcommand, ValueEnum};

use crate::evaluate::{self, estimators};
use crate::read::error::on_one_line;
use crate::simulate::replay::{self, Options};
use crate::verify;

mod identify;

/// EV powertrain plant: replays driving cycles and real trips.
#[derive(Debug, Parser)]
#[command(name = "voltstep", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Replay a driving cycle or a measured trip, and write summary, trace and plots
    Replay {
        /// A built-in cycle (see `voltstep list`), a cycle file (`time_s,speed_m_s`) or a trip file
        input: String,
        /// A built-in vehicle (see `voltstep list`) or a vehicle file
        #[arg(long, value_name = "NAME|FILE.toml", default_value = replay::DEFAULT_VEHICLE)]
        vehicle: String,
        /// For a trip: the whole vehicle on measured speed, height and auxiliary power, or the
        /// battery alone on measured current
        #[arg(long, value_enum, default_value_t = Mode::Vehicle)]
        mode: Mode,
        /// Length of a step in milliseconds
        #[arg(long, value_name = "MS", default_value_t = 1.0, allow_negative_numbers = true)]
        dt_ms: f64,
        /// Folder for summary.json, trace.csv and report.svg [default: out/<name>/]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Print summary.json on standard output instead of the table
        #[arg(long)]
        json: bool,
        /// Run without the energy ledger, which is faster
        #[arg(long)]
        no_ledger: bool,
    },
    /// Check every published experiment, and an independent solution of the same equations,
    /// against what the models give; exit code 1 where a check fails. Or, with --trips or --cells,
    /// compare the models with every measurement in a folder
    Validate {
        /// Compare with every trip file in a folder: the battery alone on measured current, and
        /// the whole vehicle
        #[arg(long, value_name = "DIR", conflicts_with = "cells")]
        trips: Option<PathBuf>,
        /// Compare with every drive cycle of a cell in a folder: the battery on measured current
        /// and temperature, its thermal node alone
        #[arg(long, value_name = "DIR")]
        cells: Option<PathBuf>,
        /// For --cells: a built-in battery (see `voltstep list`) or a battery file
        #[arg(long, value_name = "NAME|FILE.toml", default_value = evaluate::cells::DEFAULT_CELL,
              requires = "cells")]
        cell: String,
        /// For --trips: a built-in vehicle (see `voltstep list`) or a vehicle file
        #[arg(long, value_name = "NAME|FILE.toml", default_value = replay::DEFAULT_VEHICLE,
              requires = "trips")]
        vehicle: String,
        /// For --trips and --cells: length of a step in milliseconds
        #[arg(long, value_name = "MS", default_value_t = 10.0)]
        dt_ms: f64,
        /// Print JSON instead of the table
        #[arg(long)]
        json: bool,
    },
    /// Run a state-of-charge estimator over measured cell tests or trips and compare it with the
    /// charge that was counted; with --matrix exit code 1 where its standard deviation is not honest.
    /// --matrix without files simulates batteries with which something is wrong
    Soc {
        /// Cell tests, trip files, or folders of them
        #[arg(required_unless_present = "matrix", value_name = "FILE|DIR", value_parser = estimators::check_path)]
        files: Vec<PathBuf>,
        /// A built-in battery (see `voltstep list`) or a battery file [default: the cell for cell
        /// tests, the car's pack for trips]
        #[arg(long, value_name = "NAME|FILE.toml")]
        cell: Option<String>,
        /// The estimator
        #[arg(long, value_enum, default_value_t = estimators::Estimator::Ekf)]
        estimator: estimators::Estimator,
        /// How wrong the state of charge is that the estimator is told at the start, 0..1; taken
        /// away where the sum leaves 0..1
        #[arg(long, value_name = "RATIO", default_value_t = 0.0, allow_negative_numbers = true)]
        initial_soc_error: f64,
        /// Added to every measured current
        #[arg(long, value_name = "A", default_value_t = 0.0, allow_negative_numbers = true)]
        current_bias_a: f64,
        /// Samples per second
        #[arg(long, value_name = "HZ", default_value_t = 10.0)]
        rate_hz: f64,
        /// Run the standard set of wrong starts, biases, noise, resistances and capacities
        #[arg(long, conflicts_with_all = ["initial_soc_error", "current_bias_a"])]
        matrix: bool,
        /// Print JSON instead of the table
        #[arg(long)]
        json: bool,
    },
    /// Find a model's parameters from measurements, each with its standard error
    Identify {
        #[command(subcommand)]
        what: Identify,
    },
    /// Print what the length of a step costs in accuracy, as a Markdown table
    Steps,
    /// Run a battery through ten years of driving and charging in steps of 1 s; exit code 1 where
    /// the charge does not balance
    Endurance {
        /// Years of operation
        #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100))]
        years: u32,
        /// Print JSON instead of text
        #[arg(long)]
        json: bool,
    },
    /// List the built-in cycles, vehicles and batteries
    List,
}

#[derive(Debug, Subcommand)]
enum Identify {
    /// A battery from trips (of its pack) or from tests of a cell: slow sweep, pulses, drive cycles
    Battery(identify::Arguments),
}

/// What of a trip is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// The whole vehicle on measured speed, height and auxiliary power.
    Vehicle,
    /// The battery alone on measured current.
    Battery,
}

/// Runs the command; errors go to standard error in one line and end with exit code 2, a check
/// that failed with exit code 1.
#[must_use]
pub fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("voltstep: {}", on_one_line(&format!("{error:#}")));
            ExitCode::from(2)
        }
    }
}

/// Whether everything that was checked is good.
fn run(command: Command) -> anyhow::Result<bool> {
    match command {
        Command::Replay { input, vehicle, mode, dt_ms, out, json, no_ledger } => {
            let options = Options { vehicle, mode, dt_ms, ledger: !no_ledger, show_progress: true };
            let replay = replay::replay(&input, &options)?;
            let folder = replay::write(&replay, out)?;
            if json {
                print(&replay.summary.to_json()?)?;
            } else {
                let table = crate::show::table::render(&replay.summary);
                let folder = folder.display();
                print(&format!(
                    "{table}\nsummary.json, trace.csv and report.svg are in {folder}\n"
                ))?;
            }
            Ok(true)
        }
        Command::Validate { trips: Some(folder), vehicle, dt_ms, json, .. } => {
            let report = evaluate::trips::run(&folder, &vehicle, dt_ms)?;
            print(&if json { report.to_json()? } else { report.table() })?;
            Ok(true)
        }
        Command::Validate { cells: Some(folder), cell, dt_ms, json, .. } => {
            let report = evaluate::cells::run(&folder, &cell, dt_ms)?;
            print(&if json { report.to_json()? } else { report.table() })?;
            Ok(true)
        }
        Command::Validate { json, .. } => {
            let report = verify::run(true);
            print(&if json { report.to_json()? } else { report.table() })?;
            Ok(report.is_good())
        }
        Command::Soc { files, matrix: true, json, .. } if files.is_empty() => {
            let report = estimators::honesty::Report::of(estimators::honesty::SEEDS);
            print(&if json { report.to_json()? } else { report.table() })?;
            Ok(report.is_honest())
        }
        Command::Soc {
            files,
            cell,
            estimator,
            initial_soc_error,
            current_bias_a,
            rate_hz,
            matrix,
            json,
        } => {
            let cases = if matrix {
                estimators::Case::MATRIX.to_vec()
            } else {
                vec![estimators::Case::wrong(initial_soc_error, current_bias_a)?]
            };
            let report =
                estimators::run(&files, &estimators::Options { cell, estimator, rate_hz, cases })?;
            print(&if json { report.to_json()? } else { report.table() })?;
            Ok(!matrix || report.is_honest())
        }
        Command::Endurance { years, json } => {
            let report = verify::endurance::run(years, true)?;
            print(&if json { report.to_json()? } else { report.text() })?;
            Ok(report.is_good())
        }
        Command::Identify { what: Identify::Battery(arguments) } => {
            print(&identify::run(arguments)?)?;
            Ok(true)
        }
        Command::Steps => {
            print(&verify::step_sizes()?)?;
            Ok(true)
        }
        Command::List => {
            print(&crate::show::table::list())?;
            Ok(true)
        }
    }
}

/// Prints on standard output. A reader that has seen enough (`| head`) is no error.
fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(e).context("writing to standard output"),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
