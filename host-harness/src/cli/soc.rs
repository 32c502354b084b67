//! `voltstep soc`.

use std::path::{Path, PathBuf};

use anyhow::ensure;
use clap::Args;

use super::out::Out;
use crate::evaluate::estimators::{self, Case, Estimator, EstimatorRun, Options, honesty};
use crate::show;
use crate::show::report::{folder as overview, run as report};

#[derive(Args, Debug)]
pub struct Arguments {
    /// Cell tests, trip files, or folders of them
    #[arg(required_unless_present = "matrix", value_name = "FILE|DIR", value_parser = check_path)]
    files: Vec<PathBuf>,
    /// A built-in battery (see `voltstep list`) or a battery file [default: the cell for cell
    /// tests, the car's pack for trips]
    #[arg(long, value_name = "NAME|FILE.toml")]
    cell: Option<String>,
    /// The estimator
    #[arg(long, value_enum, default_value_t = Estimator::Ekf)]
    estimator: Estimator,
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
    /// Folder for an overview, report.html, with a report of each run
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON instead of the table
    #[arg(long)]
    json: bool,
}

/// Runs an estimator and prints; with the standard set, whether it was honest.
///
/// # Errors
/// Bad input, a figure out of its range.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let Arguments { files, cell, estimator, rate_hz, matrix, json, .. } = arguments;
    let Arguments { initial_soc_error, current_bias_a, out, .. } = arguments;
    ensure!(
        (-1.0..=1.0).contains(&initial_soc_error),
        "--initial-soc-error {initial_soc_error}: must lie in -1..1"
    );
    ensure!(current_bias_a.is_finite(), "--current-bias-a {current_bias_a}: must be finite");
    ensure!((0.01..=1000.0).contains(&rate_hz), "--rate-hz {rate_hz}: must lie in 0.01..1000");
    let out = Out::new(out)?;
    if files.is_empty() {
        let report = honesty::Report::of(honesty::SEEDS);
        let json_text = show::json(&report)?;
        let written = out.publish(|| overview::honesty(&report), &json_text)?;
        let text = if json { json_text } else { show::honesty::render(&report) + &written };
        super::print(&text)?;
        return Ok(report.is_honest());
    }
    let cases = if matrix {
        Case::MATRIX.to_vec()
    } else {
        vec![Case::wrong(initial_soc_error, current_bias_a)]
    };
    let keep = |place, run: &EstimatorRun, trace| {
        out.put(&overview::of_run(place, &run.name), || report::estimator(run, trace))
    };
    let options = Options { cell, estimator, rate_hz, cases };
    let report = estimators::run_keeping(&files, &options, out.keep(&keep))?;
    let json_text = show::json(&report)?;
    let written = out.publish(|| overview::estimators(&report), &json_text)?;
    let text = if json { json_text } else { show::estimators::render(&report) + &written };
    super::print(&text)?;
    Ok(!matrix || report.is_honest())
}

/// A path that is there.
fn check_path(path: &str) -> Result<PathBuf, String> {
    let path = Path::new(path);
    if path.exists() { Ok(path.to_owned()) } else { Err("no such file or folder".to_owned()) }
}
