//! What can be read: cycles, trips, cell tests, vehicles, batteries; built in or from a file.

pub mod battery;
pub mod cell;
pub mod cycle;
pub mod error;
pub mod trip;
pub mod vehicle;
