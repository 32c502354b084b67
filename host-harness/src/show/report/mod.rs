//! `report.html`: what a run came to as one file that opens anywhere, without a network.
//!
//! | Module | What it does |
//! |---|---|
//! | `page` | the page around everything; text that is only text, tables |
//! | `data` | the numbers of the plots |
//! | `ledger` | where the energy went, as a flow and as a table |
//! | `parameters` | a parameter file as a table with its sources |
//! | `histogram` | how a figure is spread over many rows |
//! | [`run`] | one of a folder's runs, a replay, an experiment |
//! | [`folder`] | the overview of a folder of measurements or of many cases, with links to each |
//!
//! The script and the style are `report.js` and `report.css`, the plots are drawn by the library in
//! `uplot/`. Same run, same bytes.

mod data;
pub(crate) mod folder;
mod histogram;
mod ledger;
mod page;
mod parameters;
pub(crate) mod run;
