//! `voltstep bms`.

use std::net::SocketAddr;
use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::Args;

use super::out::Out;
use super::serve::{On, serve};
use crate::evaluate::campaign;
use crate::read::scenario;
use crate::show;
use crate::show::report::folder as overview;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Drive this scenario instead: a cycle or a charger, a place to start from, faults
    #[arg(conflicts_with_all = ["each", "hours", "serve", "out"])]
    scenario: Option<PathBuf>,
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
    /// Serve whoever connects to this address of this machine instead of standard input and output;
    /// port 0 takes any that is free; the address is printed
    #[arg(long, value_name = "127.0.0.1:PORT", requires = "serve")]
    listen: Option<SocketAddr>,
    /// Serve this interface of `SocketCAN` (`vcan0`)
    #[cfg(target_os = "linux")]
    #[arg(long, value_name = "INTERFACE", requires = "serve", conflicts_with = "listen")]
    can: Option<String>,
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
/// A figure out of its range; a scenario that cannot be read.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let Arguments {
        scenario, each, hours, serve: serving, listen, seconds, soc, json, out, ..
    } = arguments;
    let (each, hours, json) = (*each, *hours, *json);
    if let Some(path) = scenario {
        let judged = campaign::scenario::judge(&scenario::load(path)?)?;
        super::print(&if json { show::json(&judged)? } else { show::scenario::render(&judged) })?;
        return Ok(judged.is_good());
    }
    if *serving {
        let on = listen.map_or(On::Standard, On::Tcp);
        #[cfg(target_os = "linux")]
        let on = arguments.can.clone().map_or(on, On::Can);
        return serve(&on, *seconds, *soc);
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
