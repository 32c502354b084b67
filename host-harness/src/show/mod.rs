//! Results for people and programs: tables on a terminal, JSON, the trace and the plot sheet of a
//! replay, progress, files that appear whole or not at all. Nothing here computes a result; only
//! `cli` uses it.

pub(crate) mod campaign;
pub(crate) mod cells;
pub(crate) mod check;
pub(crate) mod circuit;
pub(crate) mod endurance;
pub(crate) mod estimators;
pub(crate) mod experiment;
pub(crate) mod files;
pub(crate) mod honesty;
pub(crate) mod identified;
pub(crate) mod plot;
pub(crate) mod progress;
pub(crate) mod report;
pub(crate) mod rewind;
pub(crate) mod scenario;
pub(crate) mod sheet;
pub(crate) mod summary;
pub(crate) mod table;
pub(crate) mod trace;
pub(crate) mod trips;
pub(crate) mod validation;
pub(crate) mod vehicle_identified;

use anyhow::Context;
use serde::Serialize;

/// A result as JSON, with a line end.
///
/// # Errors
/// None that is known of.
pub(crate) fn json(result: &impl Serialize) -> anyhow::Result<String> {
    let mut text = serde_json::to_string_pretty(result).context("writing JSON")?;
    text.push('\n');
    Ok(text)
}
