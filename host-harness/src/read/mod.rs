//! What can be read: cycles, trips, cell tests, vehicles, batteries; built in or from a file.
//!
//! [`recognise`] decides what a file is, [`input`] reads what a command names, [`check`] says what is in
//! a file; each other module is one kind of file. Whatever is wrong is an [`error`] with file, line and column.

pub mod battery;
mod builtin;
pub mod cell;
pub mod check;
mod counter;
pub mod cycle;
mod document;
pub mod error;
pub mod input;
pub mod netlist;
pub mod recognise;
pub mod scenario;
mod stamp;
pub(crate) mod table;
pub mod trip;
pub(crate) mod unit;
pub mod vehicle;
