//! What others are told of the pack.

#[cfg(feature = "smart-battery")]
pub mod smart_battery;
