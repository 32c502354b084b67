//! Energy and time left.
//!
//! `E = Q·(s − e)·V` with `V = (U + √(U² − 4·R·P))/2`: a discharge at constant power with the mean
//! open-circuit voltage U and the mean resistance R of the window, which is ours. Names are those
//! of \[SmartBattery1998\] where it has one.
//!
//! Tests: `tests` below, against the plant.

use plant_core::battery::{MappedBattery, OverSoc, ResistanceMap};
use plant_core::error::{above, check, not_negative, positive, ratio};
use plant_core::num::{clamp, lag_gain, max, min, sane, sqrt};
use plant_core::{Accum, Dt, ParamError, Real};

use crate::{Estimate, Health};

/// Seconds of the rolling average of current and power: the minute of \[SmartBattery1998\].
const AVERAGE_S: Real = 60.0;
/// Halvings of the usable window: down to a thousandth of a per cent (`2⁻¹⁶`).
const HALVINGS: u32 = 16;

/// Parameters of an [`EnergyGauge`]: what counts as empty and as full.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct EnergyParams {
    /// State of charge at which it counts as empty, 0..1.
    pub empty_soc: Real,
    /// State of charge at which it counts as full, above `empty_soc`, up to 1.
    pub full_soc: Real,
    /// Voltage at the terminals at which it counts as empty, too \[V\], ≥ 0; 0 for none.
    pub empty_v: Real,
    /// A current below this is none, for the times \[A\], above zero.
    pub least_a: Real,
}

/// How much is left, and for how long.
///
/// A discharge at constant power P from the state of charge s down to e, in which the current
/// settles the RC branches (they are minutes, a discharge is more), gives at the terminals
/// `E = Q·(s − e)·V`, where V solves `P = V·I`, `V = U − R·I`: U the mean of the open-circuit
/// voltage and R that of all resistances over the window, both in closed form from their tables;
/// `V = (U + √(U² − 4·R·P))/2`. e is where the battery counts as empty: at `empty_soc`, or where
/// under P the voltage meets `empty_v`, found by bisection in 16
/// steps, a branch's voltage being late by its time constant. It is as warm as now until
/// the end, and warms itself in truth: in the cold it gives more than this says.
///
/// ```
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use plant_core::{MappedBattery, must};
/// use voltstep_bms::estimate::energy::{EnergyGauge, EnergyParams};
/// use voltstep_bms::{Dt, Estimate, Health};
///
/// const DT: Dt = must!(Dt::from_s(1.0));
/// const CELL: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));
/// const PARAMS: EnergyParams =
///     EnergyParams { empty_soc: 0.05, full_soc: 1.0, empty_v: 2.8, least_a: 0.01 };
/// const GAUGE: EnergyGauge = must!(EnergyGauge::new(PARAMS, &CELL, DT));
///
/// let estimate = Estimate::rested(0.8, 0.01, 25.0);
/// let health = Health::as_new(&CELL);
/// let gently = GAUGE.left(1.0, &estimate, &health);
/// let hard = GAUGE.left(10.0, &estimate, &health);
/// assert!((6.0..9.0).contains(&gently.energy_wh));
/// assert!(hard.energy_wh < gently.energy_wh); // more of it turns into heat
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyGauge<'b> {
    battery: &'b MappedBattery,
    params: EnergyParams,
    average_gain: Real,
}

/// The rolling averages of an [`EnergyGauge`]; at rest by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EnergyState {
    /// Current \[A\], positive when discharging.
    pub average_a: Accum,
    /// Power at the terminals \[W\], positive when discharging.
    pub average_w: Accum,
}

/// Input of one step of an [`EnergyGauge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyInput {
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
    /// Voltage at the terminals \[V\].
    pub voltage_v: Real,
}

/// What can be taken from here at a constant power.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Left {
    /// Charge \[A·h\].
    pub charge_ah: Real,
    /// Energy at the terminals \[W·h\].
    pub energy_wh: Real,
}

/// Output of an [`EnergyGauge`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EnergyReport {
    /// Charge left until empty \[A·h\], at the average power where it is discharged, else at that
    /// of a five-hour discharge (`RemainingCapacity` in mA·h).
    pub remaining_capacity_ah: Real,
    /// Energy left until empty, at the terminals, likewise \[W·h\] (`RemainingCapacity` in
    /// 10 mW·h).
    pub remaining_energy_wh: Real,
    /// Charge from full until empty, at the same power \[A·h\] (`FullChargeCapacity` in mA·h).
    pub full_charge_capacity_ah: Real,
    /// Energy from full until empty, at the same power \[W·h\] (`FullChargeCapacity` in 10 mW·h).
    pub full_charge_energy_wh: Real,
    /// Remaining capacity over full-charge capacity, 0..1 (`RelativeStateOfCharge`).
    pub relative_state_of_charge: Real,
    /// Remaining capacity over that of the battery when new, which may exceed 1
    /// (`AbsoluteStateOfCharge`).
    pub absolute_state_of_charge: Real,
    /// Remaining energy over full-charge energy, 0..1.
    pub state_of_energy: Real,
    /// Standard deviation of the remaining energy \[W·h\]: of the state of charge and of the
    /// capacity.
    pub remaining_energy_sd_wh: Real,
    /// Time until empty at the average power of the last minute \[s\] (`AverageTimeToEmpty`);
    /// nothing where it is not discharged.
    pub average_time_to_empty_s: Option<Real>,
    /// Time until full at the average current of the last minute \[s\] (`AverageTimeToFull`);
    /// nothing where it is not charged.
    pub average_time_to_full_s: Option<Real>,
}

impl<'b> EnergyGauge<'b> {
    /// Checks `params` and discretises them for steps of `dt`, for a `battery` whose own step does
    /// not matter here.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(
        params: EnergyParams,
        battery: &'b MappedBattery,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        check!(ratio("energy.empty_soc", params.empty_soc));
        check!(ratio("energy.full_soc", params.full_soc));
        check!(above("energy.full_soc", params.full_soc, params.empty_soc));
        check!(not_negative("energy.empty_v", params.empty_v));
        check!(positive("energy.least_a", params.least_a));
        Ok(Self { battery, params, average_gain: lag_gain(dt.s() / AVERAGE_S) })
    }

    /// Its parameters.
    #[must_use]
    pub const fn params(&self) -> &EnergyParams {
        &self.params
    }

    /// Averages current and power. What is not finite or absurd is left out, and said so by
    /// `false`.
    #[inline]
    pub fn step(&self, state: &mut EnergyState, input: EnergyInput) -> bool {
        let power_w = input.voltage_v * input.current_a;
        let sound = sane(input.current_a) && sane(power_w);
        if sound {
            state.average_a.add(self.average_gain * (input.current_a - state.average_a.get()));
            state.average_w.add(self.average_gain * (power_w - state.average_w.get()));
        }
        sound
    }

    /// What is left, in a slow part. Nothing where the estimate is not finite.
    #[must_use]
    pub fn report(
        &self,
        state: &EnergyState,
        estimate: &Estimate,
        health: &Health,
    ) -> Option<EnergyReport> {
        let sound = sane(
            estimate.soc.abs()
                + estimate.soc_sd.abs()
                + estimate.temperature_c.abs()
                + health.capacity_sd_ah.abs(),
        ) && sane(health.capacity_ah)
            && sane(health.resistance_factor)
            && health.capacity_ah > 0.0
            && health.resistance_factor > 0.0;
        if !sound {
            return None;
        }
        let average_a = state.average_a.get();
        let discharging = average_a >= self.params.least_a;
        let power_w =
            if discharging { max(state.average_w.get(), 0.0) } else { self.five_hours_w(health) };
        let now = self.left(power_w, estimate, health);
        let full_soc = self.params.full_soc;
        let full = self.left(power_w, &Estimate { soc: full_soc, ..*estimate }, health);

        // A little more charge is a little more at the voltage of now.
        let soc = clamp(estimate.soc, 0.0, 1.0);
        let soc_wh = health.capacity_ah * self.battery.open_circuit().at(soc) * estimate.soc_sd;
        let capacity_wh = now.energy_wh * health.capacity_sd_ah / health.capacity_ah;
        let missing_ah = health.capacity_ah * max(0.0, full_soc - estimate.soc);
        Some(EnergyReport {
            remaining_capacity_ah: now.charge_ah,
            remaining_energy_wh: now.energy_wh,
            full_charge_capacity_ah: full.charge_ah,
            full_charge_energy_wh: full.energy_wh,
            relative_state_of_charge: share(now.charge_ah, full.charge_ah),
            absolute_state_of_charge: now.charge_ah / self.battery.params().capacity_ah,
            state_of_energy: share(now.energy_wh, full.energy_wh),
            remaining_energy_sd_wh: sqrt(soc_wh * soc_wh + capacity_wh * capacity_wh),
            average_time_to_empty_s: (discharging && power_w > 0.0)
                .then(|| 3600.0 * now.energy_wh / power_w),
            average_time_to_full_s: (average_a <= -self.params.least_a)
                .then(|| 3600.0 * missing_ah / -average_a),
        })
    }

    /// What can be taken from the state of charge of `estimate` down to empty at a constant power
    /// \[W\], ≥ 0; nothing where the battery cannot give it.
    #[must_use]
    pub fn left(&self, power_w: Real, estimate: &Estimate, health: &Health) -> Left {
        let map = Averages::new(self.battery, estimate.temperature_c, health.resistance_factor);
        let soc = clamp(estimate.soc, 0.0, 1.0);
        let empty_soc = self.empty_soc(&map, power_w, soc, health.capacity_ah);
        let open_circuit_v = self.battery.open_circuit().mean(empty_soc, soc);
        let ohm = map.mean_ohm(empty_soc, soc);
        let square = open_circuit_v * open_circuit_v - 4.0 * ohm * power_w;
        if !(square >= 0.0 && soc > empty_soc) {
            return Left::default();
        }
        let charge_ah = health.capacity_ah * (soc - empty_soc);
        Left { charge_ah, energy_wh: charge_ah * 0.5 * (open_circuit_v + sqrt(square)) }
    }

    /// Where a discharge at constant power from `soc` ends.
    fn empty_soc(&self, map: &Averages, power_w: Real, soc: Real, capacity_ah: Real) -> Real {
        let empty_v = self.params.empty_v;
        let (mut low, mut high) = (self.params.empty_soc, soc);
        if empty_v <= 0.0 {
            return low;
        }
        let current_a = power_w / empty_v;
        let soc_per_s = current_a / (3600.0 * capacity_ah);
        let gives = |soc| {
            let drop_v = map.ohm(soc, soc_per_s) * current_a;
            self.battery.open_circuit().at(soc) - drop_v >= empty_v
        };
        if low >= high || gives(low) {
            return low;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if gives(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// The power at which a full battery lasts five hours.
    fn five_hours_w(&self, health: &Health) -> Real {
        let EnergyParams { empty_soc, full_soc, .. } = self.params;
        0.2 * health.capacity_ah
            * (full_soc - empty_soc)
            * self.battery.open_circuit().mean(empty_soc, full_soc)
    }
}

fn share(part: Real, whole: Real) -> Real {
    if whole > 0.0 { min(part / whole, 1.0) } else { 0.0 }
}

/// The resistances at one temperature: the exponentials are taken once.
struct Averages<'b> {
    tables: [&'b OverSoc; 3],
    factors: [Real; 3],
    late_s: [Real; 3],
    soc_min: Real,
    soc_max: Real,
}

impl<'b> Averages<'b> {
    fn new(battery: &'b MappedBattery, temperature_c: Real, resistance_factor: Real) -> Self {
        let known = battery.params();
        let celsius = known.identified.nearest_c(temperature_c);
        let factor = |activation_k| {
            let one = ResistanceMap { resistance_ohm: OverSoc::Constant(1.0), activation_k };
            resistance_factor * one.at(0.0, celsius)
        };
        Self {
            tables: [
                &known.series.resistance_ohm,
                &known.polarisation.resistance_ohm,
                &known.second_polarisation.resistance_ohm,
            ],
            factors: [
                factor(known.series.activation_k),
                factor(known.polarisation.activation_k),
                factor(known.second_polarisation.activation_k),
            ],
            late_s: [
                0.0,
                known.polarisation.time_constant_s,
                known.second_polarisation.time_constant_s,
            ],
            soc_min: known.identified.soc_min,
            soc_max: known.identified.soc_max,
        }
    }

    /// All in series \[Ω\], where the state of charge falls by `soc_per_s`: a branch lags behind
    /// its resistance by its time constant.
    fn ohm(&self, soc: Real, soc_per_s: Real) -> Real {
        let mut sum = 0.0;
        for ((table, factor), late_s) in self.tables.iter().zip(self.factors).zip(self.late_s) {
            let seen = clamp(soc + soc_per_s * late_s, self.soc_min, self.soc_max);
            sum += factor * table.at(seen);
        }
        sum
    }

    /// Their mean between two states of charge \[Ω\]; the ends of the identified range hold
    /// beyond it.
    fn mean_ohm(&self, from: Real, to: Real) -> Real {
        let (low, high) =
            (clamp(from, self.soc_min, self.soc_max), clamp(to, self.soc_min, self.soc_max));
        let mut inside = 0.0;
        for (table, factor) in self.tables.iter().zip(self.factors) {
            inside += factor
                * match table {
                    OverSoc::Constant(ohm) => *ohm,
                    OverSoc::Table(table) => table.mean(low, high),
                };
        }
        let width = to - from;
        if width > 0.0 {
            let below = min(self.soc_min, to) - min(self.soc_min, from);
            let beyond = max(self.soc_max, to) - max(self.soc_max, from);
            (inside * (high - low) + below * self.ohm(0.0, 0.0) + beyond * self.ohm(1.0, 0.0))
                / width
        } else {
            inside
        }
    }
}

#[cfg(test)]
mod tests;
