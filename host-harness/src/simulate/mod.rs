//! Runs of the plant over what was read: a [`replay`] takes a cycle or trip as a [`route`], steps
//! it in a [`run`] and sums up in figures. Beside it what several of the modules above need:
//! synthetic data, noise, statistics over many figures.

pub mod circuit;
pub mod columns;
pub mod comparison;
pub mod figures;
pub mod mode;
pub(crate) mod noise;
pub mod progress;
pub mod replay;
pub mod route;
pub mod run;
pub(crate) mod smooth;
pub mod statistics;
pub mod summary;
pub mod synthetic;
