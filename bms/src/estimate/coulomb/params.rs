//! Parameters of a [`CoulombCounter`](super::CoulombCounter).

use plant_core::Real;
use plant_core::battery::OpenCircuit;

/// Parameters of a [`CoulombCounter`](super::CoulombCounter): a battery and its current sensor.
///
/// Capacity, curve and rest voltage are of the same thing: a cell, or a pack as one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct CoulombParams {
    /// Charge between SOC 0 and 1 \[A·h\], above zero.
    pub capacity_ah: Real,
    /// Its standard deviation \[A·h\], ≥ 0.
    pub capacity_sd_ah: Real,
    /// Share of the charging current that stays in the cell, above 0 and up to 1; 1 where it is
    /// not known.
    #[cfg_attr(feature = "serde", serde(default = "lossless"))]
    pub charge_efficiency: Real,
    /// Standard deviation of the current sensor's constant offset \[A\], ≥ 0.
    pub offset_sd_a: Real,
    /// Standard deviation of its gain, as a ratio, ≥ 0.
    pub gain_sd: Real,
    /// The largest current of either sign that can flow \[A\], above zero. A reading above it is
    /// none, and while there is none, so much may have flowed.
    pub largest_current_a: Real,
    /// Open-circuit voltage over the state of charge.
    pub open_circuit: OpenCircuit,
    /// Standard deviation of a voltage measured at rest from that curve \[V\], above zero: sensor,
    /// hysteresis, what has not relaxed yet, the curve's own error.
    pub rest_voltage_sd_v: Real,
    /// At rest the current's magnitude is at most this \[A\], above zero.
    pub rest_current_a: Real,
    /// How long a rest takes until the voltage is believed \[s\], above zero.
    pub rest_s: Real,
}

#[cfg(feature = "serde")]
const fn lossless() -> Real {
    1.0
}
