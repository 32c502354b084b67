//! What an estimator says of a battery, and what the others build on.

pub mod cells;
pub mod coulomb;
mod curve;
pub mod ekf;
pub mod energy;
pub mod power;
pub mod series;
pub mod soh;

use plant_core::Real;

/// What is believed to be in a cell, or in a pack as one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation.
    pub soc_sd: Real,
    /// Voltage across the RC branches, the faster first, positive when discharging \[V\].
    pub polarisation_v: [Real; 2],
    /// Where between the curves of discharge (−1) and charge (1) the open-circuit voltage lies.
    pub hysteresis: Real,
    /// What the terminals show above what the model expects \[V\]: its error, as far as it is known.
    pub offset_v: Real,
    /// Temperature \[°C\].
    pub temperature_c: Real,
}

impl Estimate {
    /// A rested battery of which nothing but this is known.
    #[must_use]
    pub const fn rested(soc: Real, soc_sd: Real, temperature_c: Real) -> Self {
        Self {
            soc,
            soc_sd,
            polarisation_v: [0.0; 2],
            hysteresis: 0.0,
            offset_v: 0.0,
            temperature_c,
        }
    }
}
