//! Inputs over time, and what a sensor makes of a value.

pub mod sensors;
pub mod sources;
