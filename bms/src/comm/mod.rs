//! What others are told of the pack.

pub mod can;
#[cfg(feature = "smart-battery")]
pub mod smart_battery;
