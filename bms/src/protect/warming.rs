//! How fast the sensors warm up, beyond what the current explains, and whether one falls faster than
//! anything cools.

use plant_core::Real;
use plant_core::num::{lag_gain, max, sane};

use super::derive::{RATE_S, TEMPERATURE_BUDGET_S};
use super::sheet::PackSheet;

/// Cells may warm up this many times faster by their own current than the mean of their largest
/// resistance. Chosen: cells that are not alike, and the reaction's own heat.
const OWN: Real = 3.0;
/// A sensor shows a cell's heat within this \[s\]. Chosen: from the core to the case of a cell.
const SHOWN_S: Real = 60.0;

/// What warming is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WarmingLimits {
    rate_gain: Real,
    shown_gain: Real,
    /// Warming by the square of the pack's current \[K/(s·A²)\].
    own_k_per_s_a2: Real,
    /// Sweeps in which a fall is one.
    sweeps: Real,
}

/// The state of what is watched by [`WarmingLimits`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Warming<const SENSORS: usize> {
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    slow_c: [Real; SENSORS],
    /// Of this sweep so far, the furthest up and down from what is slow \[K\].
    up_k: Real,
    down_k: Real,
    /// What the current of the last ten seconds explains, and what of it a sensor may still show \[K/s\].
    own_k_per_s: Real,
    shown_k_per_s: Real,
    /// Of the last sweep, beyond that \[K/s\].
    pub unexplained_k_per_s: Real,
    /// Sweeps of a fall.
    falls: Real,
}

impl WarmingLimits {
    pub(super) const fn new(sheet: &PackSheet) -> Self {
        let parallel = sheet.layout.parallel as Real;
        Self {
            rate_gain: lag_gain(sheet.sweep_s() / RATE_S),
            shown_gain: lag_gain(sheet.sweep_s() / SHOWN_S),
            own_k_per_s_a2: sheet.cell.k_per_s_a2() / (parallel * parallel),
            sweeps: TEMPERATURE_BUDGET_S / sheet.sweep_s(),
        }
    }
}

impl<const SENSORS: usize> Warming<SENSORS> {
    pub(super) const NEW: Self = Self {
        slow_c: [Real::NAN; SENSORS],
        up_k: 0.0,
        down_k: 0.0,
        own_k_per_s: 0.0,
        shown_k_per_s: 0.0,
        unexplained_k_per_s: 0.0,
        falls: 0.0,
    };

    /// A sensor in its turn.
    pub(super) fn take(&mut self, limits: &WarmingLimits, index: usize, value_c: Option<Real>) {
        if let (Some(value_c), Some(slow_c)) = (value_c, self.slow_c.get_mut(index)) {
            if !sane(*slow_c) {
                *slow_c = value_c;
            }
            let ahead_k = value_c - *slow_c;
            self.up_k = max(ahead_k, self.up_k);
            self.down_k = max(-ahead_k, self.down_k);
            *slow_c += limits.rate_gain * ahead_k;
        }
    }

    /// At the end of a sweep, with the pack's current; `fall_k_per_s`: faster than anything cools.
    pub(super) fn end_sweep(
        &mut self,
        limits: &WarmingLimits,
        current_a: Real,
        fall_k_per_s: Real,
    ) {
        if sane(current_a) {
            let now_k_per_s = limits.own_k_per_s_a2 * current_a * current_a;
            self.own_k_per_s += limits.rate_gain * (now_k_per_s - self.own_k_per_s);
        }
        let fading_k_per_s = (1.0 - limits.shown_gain) * self.shown_k_per_s;
        self.shown_k_per_s = max(self.own_k_per_s, fading_k_per_s);
        self.unexplained_k_per_s = self.up_k / RATE_S - OWN * self.shown_k_per_s;
        let falls = self.down_k > RATE_S * fall_k_per_s;
        self.falls = if falls { self.falls + 1.0 } else { 0.0 };
        (self.up_k, self.down_k) = (0.0, 0.0);
    }

    /// A sensor has fallen faster than anything cools, for as long as a temperature is judged.
    pub(super) fn falls(&self, limits: &WarmingLimits) -> bool {
        self.falls > limits.sweeps
    }
}
