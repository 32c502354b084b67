//! Results for people: tables, the plot sheet, files that appear whole or not at all.

pub(crate) mod files;
mod plot;
pub(crate) mod sheet;
pub(crate) mod table;
