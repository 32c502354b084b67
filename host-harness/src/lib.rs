//! Voltstep on a PC: replays driving cycles and real trips through the plant of `plant-core`.
//!
//! # Map
//! | Module | What it does |
//! |---|---|
//! | [`cli`] | the command line of `voltstep` |
//! | [`cycle`], [`trip`], [`cell`], [`vehicle`], [`battery_file`] | what can be read, built in or from a file |
//! | [`input_error`] | what is wrong with a file, and where |
//! | [`synthetic`] | makes the synthetic trip in `data/trips` |
//! | [`route`] | a cycle or a trip as the plant's inputs over time |
//! | [`run`] | the stepping loops: the whole vehicle, the battery alone |
//! | [`compare`] | ours against what was measured |
//! | [`summary`] | the figures of a replay, as JSON |
//! | [`replay`] | all of it, end to end |
//! | [`validate`] | every published experiment and an independent solution, against ours |
//! | [`identify`] | a battery's parameters from measurements |
//! | [`measured`] | a folder of real measurements, against ours |
//! | [`soc`] | the estimators of `voltstep-bms` over measurements |
//!
//! Private: `table` (the summary on a terminal), `sheet` and `plot` (the plot sheet), `output`
//! (files that appear whole or not at all).

#![cfg_attr(test, allow(clippy::cast_precision_loss))]

pub mod battery_file;
pub mod cell;
pub mod cli;
pub mod compare;
pub mod cycle;
pub mod identify;
pub mod input_error;
pub mod measured;
mod output;
mod plot;
pub mod replay;
pub mod route;
pub mod run;
mod sheet;
pub mod soc;
pub mod summary;
pub mod synthetic;
mod table;
pub mod trip;
pub mod validate;
pub mod vehicle;
