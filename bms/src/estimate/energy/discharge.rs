//! A discharge at constant power, from here until empty.

use plant_core::Real;
use plant_core::battery::MappedBattery;
use plant_core::num::{clamp, lag_gain, max, min, sqrt};

use super::{EnergyParams, Left};
use crate::{Estimate, Health};

/// Stretches of charge that it is cut into. Measured on the plant of a Panasonic cell, −10 to 25 °C,
/// 2 to 25 W: with them what it gives is right within 1 % of a full battery; with 16 within 1.5 %,
/// with 48 no better.
const STRETCHES: u32 = 24;

/// A battery that gives a constant power: its equations, stretch by stretch of the charge.
pub(super) struct Discharge<'a> {
    pub battery: &'a MappedBattery,
    pub params: &'a EnergyParams,
    pub power_w: Real,
    pub capacity_ah: Real,
    pub resistance_factor: Real,
    /// It warms itself; otherwise it stays as cold as it is.
    pub warms: bool,
}

/// Longer than any discharge \[s\]: 30 years. At no power it would never end.
const LONGEST_S: Real = 1e9;

/// One instant under the constant power.
#[derive(Clone, Copy)]
struct Instant {
    open_circuit_v: Real,
    /// At the terminals \[V\]; where it cannot give the power, when it gives the most.
    voltage_v: Real,
    /// Below zero where it cannot \[V²\].
    square_v2: Real,
}

impl<'a> Discharge<'a> {
    pub(super) const fn new(
        battery: &'a MappedBattery,
        params: &'a EnergyParams,
        power_w: Real,
        health: &Health,
    ) -> Self {
        Self {
            battery,
            params,
            power_w,
            capacity_ah: health.capacity_ah,
            resistance_factor: health.resistance_factor,
            warms: true,
        }
    }

    /// What it gives until it counts as empty; its surroundings are as warm as it is now.
    ///
    /// Its stretches are short where it begins, while the branches settle and it warms up, and where
    /// it ends, where the curve falls.
    pub(super) fn run(&self, from: &Estimate) -> Left {
        let (curve, known) = (self.battery.open_circuit(), self.battery.params());
        let first_soc = clamp(from.soc, 0.0, 1.0);
        let width = first_soc - self.params.empty_soc;
        let mut left = Left::default();
        if width <= 0.0 {
            return left;
        }
        let (thermal, hysteresis_v) = (&known.thermal, known.hysteresis.half_gap_v);
        let mut hysteresis = from.hysteresis;
        let (mut soc, mut celsius, mut branches_v) =
            (first_soc, from.temperature_c, from.polarisation_v);
        let mut now = self.battery.resistances(soc, celsius);
        let [fast_v, slow_v] = branches_v;
        let open_circuit_v = curve.at(soc);
        let mut before = self.instant(
            open_circuit_v,
            open_circuit_v + hysteresis_v * hysteresis - fast_v - slow_v,
            self.resistance_factor * now.series_ohm,
        );
        if before.voltage_v < self.params.empty_v || before.square_v2 < 0.0 {
            return left;
        }
        let mut heat_w =
            (before.open_circuit_v - before.voltage_v) * self.power_w / before.voltage_v;
        for stretch in 1..=STRETCHES {
            #[allow(clippy::cast_precision_loss, reason = "a few")]
            let along = stretch as Real / STRETCHES as Real;
            let to_soc = first_soc - width * along * along * (3.0 - 2.0 * along);
            let step = soc - to_soc;
            let charge_ah = self.capacity_ah * step;
            let seconds = min(3600.0 * charge_ah * before.voltage_v / self.power_w, LONGEST_S);
            let warmer_k = celsius - from.temperature_c;
            let cooling =
                lag_gain(seconds * thermal.cooling_w_per_k / thermal.heat_capacity_j_per_k);
            let heated_k = |heat_w: Real| {
                let heat_k = seconds * heat_w / thermal.heat_capacity_j_per_k;
                if self.warms { (1.0 - cooling) * (warmer_k + heat_k) - warmer_k } else { 0.0 }
            };
            let after_c = celsius + heated_k(heat_w);
            let then = core::mem::replace(&mut now, self.battery.resistances(to_soc, after_c));
            hysteresis -= lag_gain(known.hysteresis.rate_per_soc * step) * (1.0 + hysteresis);
            let (mut emf_v, mut ohm) =
                (curve.at(to_soc) + hysteresis_v * hysteresis, now.series_ohm);
            let times_s =
                [known.polarisation.time_constant_s, known.second_polarisation.time_constant_s];
            let gains = times_s.map(|time_s| lag_gain(seconds / time_s));
            let mut branches_ohm = [0.0; 2];
            for ((mean_ohm, from_ohm), to_ohm) in
                branches_ohm.iter_mut().zip(then.polarisation_ohm).zip(now.polarisation_ohm)
            {
                *mean_ohm = 0.5 * (from_ohm + to_ohm);
            }
            for ((branch_v, gain), branch_ohm) in branches_v.iter().zip(gains).zip(branches_ohm) {
                emf_v -= (1.0 - gain) * branch_v;
                ohm += gain * branch_ohm;
            }
            let after = self.instant(curve.at(to_soc), emf_v, self.resistance_factor * ohm);
            let share = self.share(before, after);
            let end_v = before.voltage_v + share * (after.voltage_v - before.voltage_v);
            let mut mean_v = 0.5 * (before.voltage_v + end_v);
            if share == 1.0 {
                // The curve bends within it.
                mean_v +=
                    curve.mean(to_soc, soc) - 0.5 * (before.open_circuit_v + after.open_circuit_v);
            }
            left.charge_ah += share * charge_ah;
            left.energy_wh += share * charge_ah * mean_v;
            if share < 1.0 {
                break;
            }
            let current_a = self.power_w / after.voltage_v;
            for ((branch_v, gain), branch_ohm) in branches_v.iter_mut().zip(gains).zip(branches_ohm)
            {
                *branch_v += gain * (self.resistance_factor * branch_ohm * current_a - *branch_v);
            }
            heat_w = (after.open_circuit_v - after.voltage_v) * current_a;
            let over_v = 0.5
                * (before.open_circuit_v - before.voltage_v + after.open_circuit_v
                    - after.voltage_v);
            celsius += heated_k(over_v * self.power_w / mean_v);
            (soc, before) = (to_soc, after);
        }
        left
    }

    /// How far it comes from one instant to the next before it counts as empty: all of it, 1.
    fn share(&self, before: Instant, after: Instant) -> Real {
        let mut share = 1.0;
        if after.voltage_v < self.params.empty_v {
            share = (before.voltage_v - self.params.empty_v) / (before.voltage_v - after.voltage_v);
        }
        if after.square_v2 < 0.0 {
            share = min(before.square_v2 / (before.square_v2 - after.square_v2), share);
        }
        share
    }

    /// With a source of this voltage and resistance \[Ω\] behind the terminals.
    fn instant(&self, open_circuit_v: Real, emf_v: Real, ohm: Real) -> Instant {
        let square_v2 = emf_v * emf_v - 4.0 * ohm * self.power_w;
        let voltage_v = 0.5 * (emf_v + sqrt(max(square_v2, 0.0)));
        Instant { open_circuit_v, voltage_v, square_v2 }
    }
}
