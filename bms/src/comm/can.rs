//! What goes over a CAN bus, by the trait `Frame` of the crate `embedded-can`: any driver that speaks
//! it will do.
//!
//! | Message | Identifier | Period \[ms\] | What |
//! |---|--:|--:|---|
//! | [`Status`] | 0x510 | 10 | phase, cause, state of charge; alive counter and checksum |
//! | [`Pack`] | 0x511 | 10 | voltages and current; alive counter and checksum |
//! | [`encode_limits`] | 0x512 | 100 | what may be drawn and fed, and why; alive counter and checksum |
//! | [`CellExtremes`] | 0x513 | 100 | lowest and highest cell, which, how many are missing |
//! | [`TemperatureExtremes`] | 0x514 | 100 | the same of temperatures |
//! | [`CellGroup`] | 0x515 | 1000 a set | all cells, four to a frame |
//! | [`FaultPage`] | 0x516 | 100 a set | every row that has tripped or is latched |
//! | [`log_parts`] | 0x517 | asked | an entry of the log, ten frames |
//! | [`Command`], vehicle | 0x520 | 20, in | what the vehicle asks for; alive counter and checksum |
//! | [`Command`], charger | 0x521 | 100, in | the same of a charger |
//! | [`LogRequest`] | 0x522 | asked, in | which entry of the log |
//!
//! All signals are unsigned and little-endian. One that can be missing has a bit of its own that says
//! whether it is there; a missing one has all bits set besides, and all bits set are refused. What
//! lies beyond a signal's range is sent as the nearest value inside; limits are rounded down. On our
//! side a missing value is NaN.
//!
//! `data/voltstep.dbc` and `data/inverter.dbc` say the same to tools; a test holds the code against
//! them. [`inverter`] is a second map, for inverters of stationary batteries.
//!
//! The layout is ours. Tests: `tests` below.

mod cells;
mod faults;
mod field;
mod guard;
pub mod inverter;
mod readout;
mod request;
mod state;

pub use cells::{CELLS_IN_A_GROUP, CellExtremes, CellGroup, TemperatureExtremes};
pub use faults::{FAULT_PAGES, FaultPage};
pub use field::{Message, alive_after};
pub use readout::{LogReader, LogRequest, NO_ENTRY, PARTS, log_parts};
pub use request::{CHARGER, Command, REQUEST, RequestWatch, RequestWatchState};
pub use state::{Pack, Status, decode_limits, encode_limits};

#[cfg(test)]
mod tests;
