//! `voltstep endurance`.

use std::time::Duration;

use clap::Args;

use crate::show;
use crate::show::progress::Bar;
use crate::verify::endurance;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Years of operation
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=100))]
    years: u32,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Runs and prints; whether the charge balances.
///
/// # Errors
/// Standard output cannot be written.
pub fn run(arguments: Arguments) -> anyhow::Result<bool> {
    let report = endurance::run(arguments.years, &Bar::new(Duration::ZERO))?;
    let text = if arguments.json { show::json(&report)? } else { show::endurance::render(&report) };
    super::print(&text)?;
    Ok(report.is_good())
}
