//! What happened: events with a picture of the moment, counts, first and last occurrence, and a store
//! that a power cut cannot corrupt.
//!
//! An entry is [`LENGTH`] bytes, little-endian: sequence number, uptime in milliseconds, row, kind,
//! phase, a byte of zero; in single precision the fields of [`Frame`]; zeros, and the CRC-32C of all
//! that. The layout is ours. Tests: `tests` below.

mod entry;
mod ring;
mod store;

pub use entry::{Entry, EntryError, Frame, Kind, LENGTH};
pub use ring::{KEPT, Log, Occurrences};
pub use store::{LogStore, StoreError};

#[cfg(test)]
mod tests;
