//! What outlives a power cut.

pub mod record;
