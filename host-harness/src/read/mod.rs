//! What can be read: cycles, trips, cell tests, vehicles, batteries; built in or from a file.

pub mod battery;
mod builtin;
pub mod cell;
pub mod cycle;
mod document;
pub mod error;
pub mod trip;
pub mod vehicle;
