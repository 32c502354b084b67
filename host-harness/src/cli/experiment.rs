//! `voltstep experiment`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::show::{self, experiment, files};
use crate::verify::experiment::by_name;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Which one; without a name they are listed
    name: Option<String>,
    /// Folder for summary.json, trace.csv and report.svg [default: out/<name>/]
    #[arg(long, value_name = "DIR", requires = "name")]
    out: Option<PathBuf>,
    /// Print summary.json on standard output instead of the table
    #[arg(long, requires = "name")]
    json: bool,
}

/// Runs an experiment, writes its files and prints its figures; whether all are near enough.
///
/// # Errors
/// No such experiment, a run that diverged, files that cannot be written.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Some(name) = arguments.name else {
        super::print(&experiment::list())?;
        return Ok(true);
    };
    let outcome = by_name(&name)?.run()?;
    let summary = show::json(&outcome)?;
    let folder = arguments.out.unwrap_or_else(|| Path::new("out").join(outcome.name));
    files::write_all(
        &folder,
        &[
            ("summary.json", summary.clone().into_bytes()),
            ("trace.csv", experiment::csv(&outcome)?),
            ("report.svg", experiment::sheet(&outcome)?.into_bytes()),
        ],
    )?;
    super::print(&if arguments.json {
        summary
    } else {
        let (table, folder) = (experiment::render(&outcome), folder.display());
        format!("{table}summary.json, trace.csv and report.svg are in {folder}\n")
    })?;
    Ok(outcome.is_good())
}
