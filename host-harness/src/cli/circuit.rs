//! `voltstep circuit`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::read::netlist;
use crate::show::{self, circuit, files};
use crate::simulate::circuit::run as simulate;

#[derive(Args, Debug)]
pub struct Arguments {
    /// The circuit: a TOML file such as those in data/circuits/
    file: PathBuf,
    /// Folder for summary.json, trace.csv and report.svg [default: out/<name of the file>/]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print summary.json on standard output instead of the table
    #[arg(long)]
    json: bool,
}

/// Runs a circuit, writes its files and prints its figures; whether every step settled.
///
/// # Errors
/// A file that is not a circuit, a value that it can't take, files that cannot be written.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let netlist = netlist::load(&arguments.file.to_string_lossy())?;
    let stem = arguments.file.file_stem().unwrap_or_default();
    let folder = arguments.out.unwrap_or_else(|| Path::new("out").join(stem));
    files::check(&folder, &FILES)?;
    let outcome = simulate(&netlist)?;
    let summary = show::json(&outcome)?;
    let contents = [
        summary.clone().into_bytes(),
        circuit::csv(&outcome)?,
        circuit::sheet(&netlist, &outcome)?.into_bytes(),
    ];
    files::write_all(&folder, &FILES.into_iter().zip(contents).collect::<Vec<_>>())?;
    super::print(&if arguments.json {
        summary
    } else {
        let (table, folder) = (circuit::render(&netlist, &outcome), folder.display());
        format!("{table}summary.json, trace.csv and report.svg are in {folder}\n")
    })?;
    Ok(outcome.unsettled_steps == 0)
}

/// What is left in the folder.
const FILES: [&str; 3] = ["summary.json", "trace.csv", "report.svg"];
