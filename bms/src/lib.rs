#![no_std]
#![forbid(unsafe_code)]
// Tests run on the host and compare with the standard library's functions.
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        clippy::cast_sign_loss
    )
)]
//! What is in a battery, for the microcontroller that manages it: state of charge with its
//! uncertainty, health, energy and power limits, from the battery equations of `plant-core`, in
//! `f32`, bit for bit as on a PC.
//!
//! # Map
//! Each module uses only those above it.
//!
//! | Module | What it does |
//! |---|---|
//! | [`measure`] | what is measured on a pack, with validity and age |
//! | [`estimate`] | what is believed to be in a battery |
//! | [`estimate::ekf`] | state of charge from current and voltage, by a Kalman filter that knows its limits |
//! | [`estimate::coulomb`] | state of charge by counting, put right at rest |
//! | [`estimate::cells`] | state of charge of each cell, from the pack's and the cells' voltages |
//! | [`estimate::soh`] | state of health: resistance and capacity, with their uncertainty |
//! | [`estimate::energy`] | energy and time left |
//! | [`estimate::power`] | state of power: what may be drawn and charged over the next seconds |
//! | [`estimate::series`] | all of them of cells in series, tied together |
//! | [`protect`] | what must not be: limits, plausibility, missing data, as a table of rows |
//! | [`contactor`] | when contactors close and open: a state machine, precharge, a driver of pins |
//! | [`limit`] | what vehicle and charger may draw and feed, and which is heard |
//! | [`balance`] | which cells are bled, and what that takes out of them |
//! | [`log`] | what happened, in memory and on a flash memory |
//! | [`store::record`] | what is worth knowing after a power cut, in two slots |
//! | [`manage`] | the whole BMS as one struct, from one description |
//! | [`comm::can`] | status, limits, cells, faults, log and requests over a CAN bus |
//! | `comm::smart_battery` | the pack as a Smart Battery (feature `smart-battery`) |
//!
//! # Conventions
//! Those of `plant-core`: SI units named in each field, discharge current positive, ratios in 0..1,
//! temperatures in °C. A standard deviation carries the name of what it belongs to and the ending
//! `_sd`. A module's header gives its equations and their source (a key of `docs/src/references.md`
//! in brackets, or that it is ours) and ends with where its tests are.

pub mod balance;
pub mod comm;
pub mod contactor;
pub mod estimate;
pub mod limit;
pub mod log;
pub mod manage;
pub mod measure;
pub mod protect;
pub mod store;

pub use estimate::Estimate;
pub use estimate::cells::{Cells, CellsInput, CellsParams, CellsState};
pub use estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams, CoulombState};
pub use estimate::ekf::{Ekf, EkfInput, EkfOutput, EkfParams, EkfState};
pub use estimate::energy::EnergyGauge;
pub use estimate::power::PowerLimits;
pub use estimate::soh::Health;
pub use manage::{Bms, BmsParams, BmsState, Board, Description};
pub use measure::{Measurements, Reading};
pub use plant_core::{Accum, Dt, ParamError, Real, must};

/// The example of this crate's README, kept compiling.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
