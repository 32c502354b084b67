//! `voltstep rewind`.

use std::fs;
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;

use crate::evaluate::rewind::{self, Change};
use crate::show;

#[derive(Args, Debug)]
pub struct Arguments {
    /// A recording, as `voltstep_bms::manage::recorder` writes it
    log: PathBuf,
    /// What to change beside it, as often as wanted: of a row (`CellVoltage(High,Msl).threshold-=0.02`;
    /// threshold, hysteresis, count, delay, heal) or of the pack's description
    /// (`sheet.actuators.break_a=200`)
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<Change>,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Runs a recording again.
///
/// # Errors
/// The file cannot be read, is no recording, or a change is refused.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let Arguments { log, set, json } = arguments;
    let name = || log.display().to_string();
    let bytes = fs::read(log).with_context(name)?;
    let report = rewind::rewind(&bytes, set).with_context(name)?;
    super::print(&if *json { show::json(&report)? } else { show::rewind::render(&report, set) })?;
    Ok(report.same)
}
