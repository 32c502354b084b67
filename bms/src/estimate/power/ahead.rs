//! The battery under a constant current, some seconds ahead.
//!
//! The equations are those of [`power`](super). Tests: below, and those of `power`.

use plant_core::battery::{MappedBattery, Resistances};
use plant_core::error::{check, positive};
use plant_core::num::{clamp, lag_gain, max, min};
use plant_core::{ParamError, Real};

use crate::{Estimate, Health};

/// Stretches that a horizon is cut into. Chosen: with them the voltage stays within 10 mV of its limit
/// on the plant (`tests/tests/bms_power.rs`); 4 and 16 pass the unit tests, too, and each costs its
/// share of the time.
const STRETCHES: u32 = 8;

/// In which direction the current flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Discharge,
    Charge,
}

impl Direction {
    /// Of the current; and of the voltage's distance to the limit that it runs towards.
    pub(super) const fn sign(self) -> Real {
        match self {
            Self::Discharge => 1.0,
            Self::Charge => -1.0,
        }
    }
}

/// `e^(−x)` for `x ≥ 0`, in a `const fn`: a rational approximation below 1/16, squared as often as
/// `x` was halved. Within 1e-5 of the value at the start, which is 1.
const fn decay(x: Real) -> Real {
    let (mut small, mut halvings) = (x, 0);
    while small > 0.0625 && halvings < 32 {
        small *= 0.5;
        halvings += 1;
    }
    let square = small * small / 12.0;
    let mut value = (1.0 - 0.5 * small + square) / (1.0 + 0.5 * small + square);
    while halvings > 0 {
        value *= value;
        halvings -= 1;
    }
    value
}

/// A length of time, with how far each branch comes in a stretch of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Horizon {
    seconds: Real,
    stretch_s: Real,
    gains: [Real; 2],
}

impl Horizon {
    pub(super) const fn new(
        field: &'static str,
        seconds: Real,
        battery: &MappedBattery,
    ) -> Result<Self, ParamError> {
        let seconds = check!(positive(field, seconds));
        #[allow(clippy::cast_precision_loss, reason = "a few")]
        let stretch_s = seconds / STRETCHES as Real;
        let known = battery.params();
        Ok(Self {
            seconds,
            stretch_s,
            gains: [
                1.0 - decay(stretch_s / known.polarisation.time_constant_s),
                1.0 - decay(stretch_s / known.second_polarisation.time_constant_s),
            ],
        })
    }

    pub(super) const fn seconds(&self) -> Real {
        self.seconds
    }
}

/// Where the battery stands, and what it takes to go ahead from there.
pub(super) struct Ahead<'a> {
    battery: &'a MappedBattery,
    horizon: &'a Horizon,
    estimate: &'a Estimate,
    resistance_factor: Real,
    soc_per_as: Real,
    sign: Real,
    now: Resistances,
}

/// What a current leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    /// Closest to the limit: the lowest when discharging, the highest when charging \[V\].
    pub closest_v: Real,
    /// The lowest \[V\].
    pub lowest_v: Real,
    /// \[°C\]
    pub hottest_c: Real,
}

impl<'a> Ahead<'a> {
    pub(super) fn new(
        battery: &'a MappedBattery,
        horizon: &'a Horizon,
        estimate: &'a Estimate,
        health: &Health,
        direction: Direction,
    ) -> Self {
        Self {
            battery,
            horizon,
            estimate,
            resistance_factor: health.resistance_factor,
            soc_per_as: 1.0 / (3600.0 * health.capacity_ah),
            sign: direction.sign(),
            now: battery.resistances(estimate.soc, estimate.temperature_c),
        }
    }

    /// Under a constant current \[A\], ≥ 0 in the direction asked for.
    pub(super) fn under(&self, current_a: Real) -> Seen {
        let known = self.battery.params();
        let stretch_s = self.horizon.stretch_s;
        let signed_a = self.sign * current_a;
        let scaled_a = self.resistance_factor * signed_a;
        let soc_step = signed_a * stretch_s * self.soc_per_as;
        let k_per_w = stretch_s / known.thermal.heat_capacity_j_per_k;
        let refresh = known.refresh_s / stretch_s;
        let to_curve = lag_gain(known.hysteresis.rate_per_soc * soc_step.abs());

        let (mut soc, mut celsius) = (self.estimate.soc, self.estimate.temperature_c);
        let (mut branches_v, mut hysteresis) =
            (self.estimate.polarisation_v, self.estimate.hysteresis);
        let mut before = self.now; // the resistances of its start
        let (mut over_v, mut gone) = (0.0, 0.0);
        let mut seen =
            Seen { closest_v: self.sign * Real::MAX, lowest_v: Real::MAX, hottest_c: celsius };
        for stretch in 0..=STRETCHES {
            let mut after = before;
            if stretch > 0 {
                soc -= soc_step;
                let warmer_k = celsius - self.estimate.temperature_c;
                let heat_w = over_v * signed_a - known.thermal.cooling_w_per_k * warmer_k;
                let warming_k = k_per_w * heat_w;
                celsius += warming_k;
                hysteresis += to_curve * (-self.sign - hysteresis);
                // Resistances follow every so often: their age lies between nothing and that. For
                // the temperature, whose rise lowers them, the safe end; for the state of charge,
                // where neither end is, the middle.
                gone += 1.0;
                let late = min(refresh, gone);
                after = self
                    .battery
                    .resistances(soc + 0.5 * late * soc_step, celsius - late * warming_k);
                for (((branch_v, gain), from), to) in branches_v
                    .iter_mut()
                    .zip(self.horizon.gains)
                    .zip(before.polarisation_ohm)
                    .zip(after.polarisation_ohm)
                {
                    *branch_v += gain * (0.5 * (from + to) * scaled_a - *branch_v);
                }
            }
            let [fast_v, slow_v] = branches_v;
            let hysteresis_v = known.hysteresis.half_gap_v * hysteresis;
            over_v = after.series_ohm * scaled_a + fast_v + slow_v - hysteresis_v;
            let open_circuit_v = self.battery.open_circuit().at(clamp(soc, 0.0, 1.0));
            let voltage_v = open_circuit_v - over_v + self.estimate.offset_v;
            seen.closest_v = if self.sign > 0.0 {
                min(voltage_v, seen.closest_v)
            } else {
                max(voltage_v, seen.closest_v)
            };
            seen.lowest_v = min(voltage_v, seen.lowest_v);
            seen.hottest_c = max(celsius, seen.hottest_c);
            before = after;
        }
        seen
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn decays() {
        for x in [0.0, 1e-6, 0.01, 0.06, 0.1, 0.5, 1.0, 3.0, 10.0, 80.0, 1e6, 1e12] {
            let exact = f64::exp(-f64::from(x));
            assert!((f64::from(decay(x)) - exact).abs() < 1e-5, "{x}: {}", decay(x));
        }
    }
}
