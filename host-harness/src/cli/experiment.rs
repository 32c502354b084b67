//! `voltstep experiment`.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::show::report::run as report;
use crate::show::{self, experiment, files, plot};
use crate::verify::experiment::by_name;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Which one; without a name they are listed
    name: Option<String>,
    /// Folder for report.html, report.svg, summary.json and trace.csv [default: out/<name>/]
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
    let experiment = by_name(&name)?;
    let folder = arguments.out.unwrap_or_else(|| Path::new("out").join(experiment.name));
    files::check(&folder, &super::REPORT)?;
    let outcome = experiment.run()?;
    let summary = show::json(&outcome)?;
    let contents = [
        report::experiment(&outcome)?,
        plot::render(&experiment::sheet(&outcome))?.into_bytes(),
        summary.clone().into_bytes(),
        experiment::csv(&outcome)?,
    ];
    files::write_all(&folder, &super::REPORT.into_iter().zip(contents).collect::<Vec<_>>())?;
    super::print(&if arguments.json {
        summary
    } else {
        experiment::render(&outcome) + &super::left_in(&folder)
    })?;
    Ok(outcome.is_good())
}
