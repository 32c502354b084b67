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
//! | Module | What it does |
//! |---|---|
//! | [`energy`] | energy and time left |
//! | [`estimate`] | what is believed to be in a battery |
//! | [`power`] | state of power: what may be drawn and charged over the next seconds |
//! | `smart_battery` | the pack as a Smart Battery (feature `smart-battery`) |
//! | [`soh`] | state of health: resistance and capacity, with their uncertainty |
//!
//! # Conventions
//! Those of `plant-core`: SI units named in each field, discharge current positive, ratios in 0..1,
//! temperatures in °C. A standard deviation carries the name of what it belongs to and the ending
//! `_sd`.

pub mod energy;
pub mod estimate;
pub mod power;
#[cfg(feature = "smart-battery")]
pub mod smart_battery;
pub mod soh;

pub use estimate::Estimate;
pub use plant_core::{Accum, Dt, ParamError, Real};
pub use soh::Health;
