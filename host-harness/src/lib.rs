//! Voltstep on a PC: replays driving cycles and real trips through the plant of `plant-core`.
//!
//! # Map
//! Each module uses only those above it; [`identify`], [`evaluate`] and [`verify`] do not use each
//! other. `show` and `cli` are behind the default feature `command`: without it the rest needs no
//! crate for a command line, tables or plots.
//!
//! | Module | What it does |
//! |---|---|
//! | [`read`] | what can be read, built in or from a file; what is wrong with a file, and where |
//! | [`simulate`] | a cycle or trip as the plant's inputs, the stepping loops, figures, ours beside what was measured |
//! | [`identify`] | the parameters of a battery or a vehicle from measurements |
//! | [`evaluate`] | models and estimators against a folder of real measurements |
//! | [`verify`] | every published experiment and an independent solution, against ours |
//! | `show` | results as tables, JSON, plot sheet and files that appear whole or not at all |
//! | `cli` | the command line of `voltstep` |

#![cfg_attr(test, allow(clippy::cast_precision_loss))]

#[cfg(feature = "command")]
pub mod cli;
pub mod evaluate;
pub mod identify;
pub mod read;
#[cfg(feature = "command")]
mod show;
pub mod simulate;
pub mod verify;
