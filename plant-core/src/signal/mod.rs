//! Inputs over time, what a sensor makes of a value, and what goes wrong with it.

pub mod faults;
pub mod sensors;
pub mod sources;
