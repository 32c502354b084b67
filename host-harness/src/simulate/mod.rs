//! Runs of the plant over what was read.

pub mod comparison;
pub mod replay;
pub mod route;
pub mod run;
pub mod summary;
pub mod synthetic;
