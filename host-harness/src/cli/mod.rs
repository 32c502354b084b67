//! The command line of `voltstep`, a module for each command: it owns its arguments, calls what is
//! below and prints. Ranges of arguments, exit codes, progress on a terminal and interruptions are
//! settled here.

use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use clap::{Parser, Subcommand};

use crate::read::error::on_one_line;

mod bms;
mod check;
mod circuit;
mod endurance;
mod experiment;
mod identify;
mod identify_vehicle;
mod list;
mod out;
mod replay;
mod rewind;
mod serve;
mod soc;
mod steps;
mod validate;

/// The longest step that makes sense for a vehicle \[ms\].
const LONGEST_STEP_MS: f64 = 1000.0;
/// The shortest: below, single-precision time has no meaning \[ms\].
const SHORTEST_STEP_MS: f64 = 1e-4;

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
    Replay(replay::Arguments),
    /// Check every published experiment, and an independent solution of the same equations,
    /// against what the models give; exit code 1 where a check fails. Or, with --trips or --cells,
    /// compare the models with every measurement in a folder
    Validate(validate::Arguments),
    /// Say what files are: columns and their units, sampling, gaps, ranges, what looks wrong, and what can
    /// be done with them; exit code 1 where one cannot be trusted as it is
    Check(check::Arguments),
    /// Run an experiment of the reference system, and write its figures, trace and plots; exit code
    /// 1 where a figure is off. Without a name: list them
    Experiment(experiment::Arguments),
    /// Run a circuit from a file, switch by switch, and write summary, trace and plots; exit code 1
    /// where a step did not settle
    Circuit(circuit::Arguments),
    /// Run a state-of-charge estimator over measured cell tests or trips and compare it with the
    /// charge that was counted; with --matrix exit code 1 where its standard deviation is not honest.
    /// --matrix without files simulates batteries with which something is wrong
    Soc(soc::Arguments),
    /// Plant faults of sensors, contactors, cells and vehicle in a simulated pack that a BMS manages, and
    /// judge by the true cells what became of them; exit code 1 where a cell is harmed first, a fault is
    /// missed, or something trips without one
    Bms(bms::Arguments),
    /// Run a recording of a BMS again, to the same bits and, with --set, beside it with another
    /// threshold or parameter: would it have tripped? Exit code 1 where the bits differ
    Rewind(rewind::Arguments),
    /// Find a model's parameters from measurements, each with its standard error
    Identify {
        #[command(subcommand)]
        what: Identify,
    },
    /// Print what the length of a step costs in accuracy, as a Markdown table
    Steps,
    /// Run a battery through ten years of driving and charging in steps of 1 s; exit code 1 where
    /// the charge does not balance
    Endurance(endurance::Arguments),
    /// List the built-in cycles, vehicles and batteries
    List,
}

#[derive(Debug, Subcommand)]
enum Identify {
    /// A battery from trips (of its pack) or from tests of a cell: slow sweep, pulses, drive cycles
    Battery(identify::Arguments),
    /// A vehicle from trips with measured torque: mass, what resists it over temperature and
    /// distance, losses, regeneration
    Vehicle(identify_vehicle::Arguments),
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
        Command::Replay(arguments) => replay::run(arguments),
        Command::Validate(arguments) => validate::run(arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Experiment(arguments) => experiment::run(arguments),
        Command::Circuit(arguments) => circuit::run(arguments),
        Command::Soc(arguments) => soc::run(arguments),
        Command::Bms(arguments) => bms::run(&arguments),
        Command::Rewind(arguments) => rewind::run(&arguments),
        Command::Identify { what: Identify::Battery(arguments) } => identify::run(arguments),
        Command::Identify { what: Identify::Vehicle(arguments) } => {
            identify_vehicle::run(&arguments)
        }
        Command::Steps => steps::run(),
        Command::Endurance(arguments) => endurance::run(arguments),
        Command::List => list::run(),
    }
}

/// A step that makes sense, in seconds.
fn step_s(dt_ms: f64) -> anyhow::Result<f64> {
    ensure!(
        (SHORTEST_STEP_MS..=LONGEST_STEP_MS).contains(&dt_ms),
        "--dt-ms must lie in {SHORTEST_STEP_MS}..{LONGEST_STEP_MS}, not {dt_ms}"
    );
    Ok(dt_ms / 1000.0)
}

/// What a replay and an experiment leave in a folder.
const REPORT: [&str; 4] = ["report.html", "report.svg", "summary.json", "trace.csv"];

/// Where that is.
fn left_in(folder: &Path) -> String {
    let [html, svg, json, csv] = REPORT;
    format!("{html}, {svg}, {json} and {csv} are in {}\n", folder.display())
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
