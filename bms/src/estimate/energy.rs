//! Energy and time left.
//!
//! `E = Σ Q·Δs·V` with `V = (U + √(U² − 4·R·P))/2`: a discharge at constant power, stretch by
//! stretch, in which the battery warms itself; which is ours. Names are those of
//! \[SmartBattery1998\] where it has one.
//!
//! Tests: `tests` below, against the plant.

mod discharge;

use plant_core::battery::MappedBattery;
use plant_core::error::{above, check, not_negative, positive, ratio};
use plant_core::num::{clamp, lag_gain, max, min, sane, sqrt};
use plant_core::{Accum, Dt, ParamError, Real};

use crate::{Estimate, Health};
use discharge::Discharge;

/// Seconds of the rolling average of current and power: the minute of \[SmartBattery1998\].
const AVERAGE_S: Real = 60.0;
/// Discharges that a report takes, and so the calls of [`EnergyGauge::walk`].
pub const DISCHARGES: usize = 5;

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
/// A discharge at constant power P from the state of charge s down to e is cut into 24 stretches of
/// charge. In each the branches go on towards what the current makes of them, `v += g·(R·I − v)`; so
/// its end is a source of the voltage U and the resistance R, at whose terminals `P = V·I`,
/// `V = U − R·I` hold, that is `V = (U + √(U² − 4·R·P))/2`. The heat of the current warms the battery,
/// `C·ΔT = Δt·((OCV − V)·I − k·(T − T_a))`, and what is warmer has less resistance; its surroundings
/// `T_a` are taken to be as warm as it is now. e is where it counts as empty: at `empty_soc`, or where
/// under P the voltage meets `empty_v`.
///
/// How much it warms up nobody knows: half of what that gives is in the standard deviation, as is
/// what the resistances' own makes of it.
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
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Left {
    /// Charge \[A·h\].
    pub charge_ah: Real,
    /// Energy at the terminals \[W·h\].
    pub energy_wh: Real,
}

/// How far [`EnergyGauge::walk`] has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyWalk {
    next: usize,
    left: [Left; DISCHARGES],
}

impl EnergyWalk {
    /// Before the first call.
    pub const START: Self =
        Self { next: 0, left: [Left { charge_ah: 0.0, energy_wh: 0.0 }; DISCHARGES] };
}

impl Default for EnergyWalk {
    fn default() -> Self {
        Self::START
    }
}

/// Output of an [`EnergyGauge`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Standard deviation of the remaining energy \[W·h\]: of the state of charge, of capacity and
    /// resistance, and of what the battery's own warmth gives.
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
        let mut walk = EnergyWalk::START;
        for _ in 0..DISCHARGES - 1 {
            self.walk(&mut walk, state, estimate, health);
        }
        self.walk(&mut walk, state, estimate, health)
    }

    /// One discharge at a time, for a processor with other things to do: five calls, and the report
    /// is there, from the estimates of these calls. Nothing until then, and where the last estimate is
    /// not finite.
    pub fn walk(
        &self,
        walk: &mut EnergyWalk,
        state: &EnergyState,
        estimate: &Estimate,
        health: &Health,
    ) -> Option<EnergyReport> {
        let [fast_v, slow_v] = estimate.polarisation_v;
        let sound = sane(
            estimate.soc.abs()
                + estimate.soc_sd.abs()
                + estimate.temperature_c.abs()
                + estimate.hysteresis.abs()
                + fast_v.abs()
                + slow_v.abs()
                + health.resistance_factor_sd.abs()
                + health.capacity_sd_ah.abs(),
        ) && sane(health.capacity_ah)
            && sane(health.resistance_factor)
            && health.capacity_ah > 0.0
            && health.resistance_factor > 0.0;
        if !sound {
            *walk = EnergyWalk::START;
            return None;
        }
        let average_a = state.average_a.get();
        let discharging = average_a >= self.params.least_a;
        let power_w =
            if discharging { max(state.average_w.get(), 0.0) } else { self.five_hours_w(health) };
        let Health { resistance_factor, resistance_factor_sd, .. } = *health;
        let usual = Discharge::new(self.battery, &self.params, power_w, health);
        let (discharge, from) = match walk.next {
            0 => (usual, *estimate),
            1 => (usual, Estimate { soc: self.params.full_soc, ..*estimate }),
            2 => (Discharge { warms: false, ..usual }, *estimate),
            3 => {
                let factor = resistance_factor + resistance_factor_sd;
                (Discharge { resistance_factor: factor, ..usual }, *estimate)
            }
            _ => {
                let factor = max(resistance_factor - resistance_factor_sd, 0.0);
                (Discharge { resistance_factor: factor, ..usual }, *estimate)
            }
        };
        if let Some(left) = walk.left.get_mut(walk.next) {
            *left = discharge.run(&from);
        }
        walk.next += 1;
        if walk.next < DISCHARGES {
            return None;
        }
        let [now, full, cold, less, more] = walk.left;
        *walk = EnergyWalk::START;

        // A little more charge is a little more at the voltage of now.
        let soc = clamp(estimate.soc, 0.0, 1.0);
        let soc_wh = health.capacity_ah * self.battery.open_circuit().at(soc) * estimate.soc_sd;
        let capacity_wh = now.energy_wh * health.capacity_sd_ah / health.capacity_ah;
        let warming_wh = 0.5 * (now.energy_wh - cold.energy_wh);
        let resistance_wh =
            max((more.energy_wh - now.energy_wh).abs(), (now.energy_wh - less.energy_wh).abs());
        let variance_wh2 = soc_wh * soc_wh
            + capacity_wh * capacity_wh
            + warming_wh * warming_wh
            + resistance_wh * resistance_wh;
        let full_soc = self.params.full_soc;
        let missing_ah = health.capacity_ah * max(0.0, full_soc - estimate.soc);
        Some(EnergyReport {
            remaining_capacity_ah: now.charge_ah,
            remaining_energy_wh: now.energy_wh,
            full_charge_capacity_ah: full.charge_ah,
            full_charge_energy_wh: full.energy_wh,
            relative_state_of_charge: share(now.charge_ah, full.charge_ah),
            absolute_state_of_charge: now.charge_ah / self.battery.params().capacity_ah,
            state_of_energy: share(now.energy_wh, full.energy_wh),
            remaining_energy_sd_wh: sqrt(variance_wh2),
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
        Discharge::new(self.battery, &self.params, power_w, health).run(estimate)
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

#[cfg(test)]
mod tests;
