//! Controllers: from a speed reference to a duty and a brake force.

pub mod driver;
pub mod pid;
