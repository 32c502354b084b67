//! Controllers: from a speed reference to a duty and a brake force, from a torque to a voltage.

pub mod driver;
pub mod foc;
pub mod pid;
