//! `voltstep bms`.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::Args;

use super::out::Out;
use crate::evaluate::campaign;
use crate::show;
use crate::show::report::folder as overview;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Only every so many of the cases
    #[arg(long, value_name = "N", default_value_t = 1)]
    each: usize,
    /// Hours of driving without a fault, in which nothing may trip
    #[arg(long, value_name = "H", default_value_t = 1.0)]
    hours: f64,
    /// Be a pack in real time instead: its CAN messages as lines of `candump` on standard output, those of
    /// a vehicle or charger on standard input
    #[arg(long, conflicts_with_all = ["each", "hours", "out", "json"])]
    serve: bool,
    /// How long to serve [default: until nobody reads]
    #[arg(long, value_name = "S", requires = "serve", default_value_t = f64::INFINITY, hide_default_value = true)]
    seconds: f64,
    /// State of charge at the start of serving, 0..1
    #[arg(long, value_name = "RATIO", requires = "serve", default_value_t = 0.6)]
    soc: f64,
    /// Folder for an overview of the cases, report.html
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON instead of the tables: every case with what became of it
    #[arg(long)]
    json: bool,
}

/// Plants faults in a pack that a BMS drives, and prints what became of them.
///
/// # Errors
/// A figure out of its range.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let Arguments { each, hours, serve, seconds, soc, json, ref out } = *arguments;
    if serve {
        return super::serve::serve(seconds, soc);
    }
    ensure!((1..=1000).contains(&each), "--each {each}: must lie in 1..1000");
    ensure!((0.0..=1000.0).contains(&hours), "--hours {hours}: must lie in 0..1000");
    let out = Out::new(out.clone())?;
    let report = campaign::run(each, hours).context("the pack of the campaign")?;
    let json_text = show::json(&report)?;
    let written = out.publish(|| overview::campaign(&report), &json_text)?;
    let text = if json { json_text } else { show::campaign::render(&report) + &written };
    super::print(&text)?;
    Ok(report.is_good())
}
