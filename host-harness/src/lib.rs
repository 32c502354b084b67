//! Voltstep on a PC: replays driving cycles and real trips through the plant of `plant-core`.
//!
//! # Map
//! Each module uses only those above it; `show` reads results only.
//!
//! | Module | What it does |
//! |---|---|
//! | [`read`] | what can be read, built in or from a file; what is wrong with a file, and where |
//! | [`simulate`] | a cycle or trip as the plant's inputs, the stepping loops, figures, ours beside what was measured |
//! | [`identify`] | a battery's parameters from measurements |
//! | [`evaluate`] | models and estimators against a folder of real measurements |
//! | [`verify`] | every published experiment and an independent solution, against ours |
//! | `show` | tables, the plot sheet, files that appear whole or not at all |
//! | [`cli`] | the command line of `voltstep` |

#![cfg_attr(test, allow(clippy::cast_precision_loss))]

pub mod cli;
pub mod evaluate;
pub mod identify;
pub mod read;
mod show;
pub mod simulate;
pub mod verify;
