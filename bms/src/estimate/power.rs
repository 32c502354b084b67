//! State of power: what may be drawn and charged over the next seconds.
//!
//! The largest current whose voltage, temperature and state of charge keep their limits under the
//! battery's own equations, `v += (1 − e^(−t/τ))·(R·I − v)` stretch by stretch \[Plett2004Power,
//! section III\]; that resistances, heat and hysteresis follow along is ours.
//!
//! Tests: `tests` below; on the plant in `tests/tests/bms_power.rs`.

mod ahead;
mod weakest;
mod window;

pub use weakest::{SLICES_OF_CELLS, SeriesCells};
pub use window::TemperatureWindow;

use plant_core::battery::{MappedBattery, temperature_factor};
use plant_core::error::{above, check, finite, not_negative, positive, ratio};
use plant_core::num::{LARGEST, clamp, max, min, sane};
use plant_core::{ParamError, Real};

use crate::{Estimate, Health};
use ahead::{Ahead, Direction, Horizon, Seen};

/// How many lengths of time a [`PowerLimits`] looks ahead.
pub const HORIZONS: usize = 3;
/// The usual ones \[s\]. Chosen: the pulses of data sheets are 2 to 30 s long.
pub const HORIZONS_S: [Real; HORIZONS] = [2.0, 10.0, 30.0];
/// Refinements of a current; a few are enough where the battery is close to linear. Chosen: with 4
/// some of the currents in `tests/tests/bms_power.rs` are less than 95 % of the largest, with 8 a
/// call takes up to 40,000 instructions.
const ROUNDS: u32 = 5;
/// A current is good enough when the voltage comes as close to its limit as this share of it.
/// Chosen: 0.05 mV of a cell, below what a sensor resolves.
const CLOSE_ENOUGH: Real = 2e-5;

/// At constant power less flows early on than at constant current and the battery warms up less:
/// measured in the cold over 30 s, up to 12 mV, which this covers.
const POWER_SHARE: Real = 0.996;

/// Parameters of [`PowerLimits`]: the limits kept beside the battery's largest currents.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PowerParams {
    /// Lowest voltage at the terminals \[V\], above zero.
    pub voltage_min_v: Real,
    /// Highest voltage at the terminals \[V\], above the lowest.
    pub voltage_max_v: Real,
    /// Lowest state of charge, 0..1.
    pub soc_min: Real,
    /// Highest state of charge, above the lowest, up to 1.
    pub soc_max: Real,
    /// How many standard deviations of the state of charge and of the resistance to stay away from
    /// every limit, ≥ 0: a limit is kept with the probability that a Gaussian gives, 97.7 % for 2,
    /// 99.9 % for 3. The voltage of now is known, so a state of charge that is off counts as a curve
    /// that bends elsewhere.
    pub margin_sds: Real,
    /// How long the currents must hold \[s\], above zero and rising; [`HORIZONS_S`] are usual.
    pub horizons_s: [Real; HORIZONS],
    /// Temperatures at which it may be discharged.
    pub discharge_window: TemperatureWindow,
    /// Temperatures at which it may be charged.
    pub charge_window: TemperatureWindow,
}

/// The largest currents and powers that keep every limit for the next seconds.
///
/// The battery's own equations are taken ahead under a constant current, in eight stretches, each
/// in closed form: `v += (1 − e^(−t/τ))·(R·I − v)`, R the mean of both ends. State of charge,
/// hysteresis, temperature, and with them resistances and open-circuit voltage, follow from stretch
/// to stretch. The largest current whose voltage and temperature stay within their limits at the
/// start and at the end of every stretch is found between zero and what the other limits allow, by
/// the rule of false position \[DowellJarratt1971, the "Illinois" form\] in at most 5 rounds;
/// what it settles for is on the safe side. \[Plett2004Power, section III\] bisects.
/// A longer horizon allows no more than a shorter one, whose stretches see what comes soon.
///
/// The surroundings are taken to be as warm as the battery is now. On the plant with the parameters
/// of a Panasonic cell, −10 to 40 °C, 5 to 100 % SOC, polarised at random, the voltage goes at most
/// 10 mV beyond its limit, in constant current or constant power, and the current is at least 95 %
/// of the largest that the plant stands, where that empties it in less than twenty hours.
///
/// It takes up to seven looks ahead for each horizon and direction, up to 4,000 instructions each: a
/// matter for once a second, not for every step. [`walk`](PowerLimits::walk) does one horizon and
/// direction a call, [`walk_of_cells`](PowerLimits::walk_of_cells) less than that.
///
/// ```
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use plant_core::{MappedBattery, must};
/// use voltstep_bms::estimate::power::{
///     HORIZONS_S, PowerLimits, PowerParams, TemperatureWindow,
/// };
/// use voltstep_bms::{Dt, Estimate, Health};
///
/// const CELL: MappedBattery =
///     must!(MappedBattery::new(PANASONIC_NCR18650PF, must!(Dt::from_s(1.0))));
/// const WINDOW: TemperatureWindow = TemperatureWindow {
///     none_below_c: -20.0,
///     all_from_c: -10.0,
///     all_to_c: 45.0,
///     none_above_c: 60.0,
/// };
/// const PARAMS: PowerParams = PowerParams {
///     voltage_min_v: 2.5,
///     voltage_max_v: 4.2,
///     soc_min: 0.05,
///     soc_max: 0.98,
///     margin_sds: 2.0,
///     horizons_s: HORIZONS_S,
///     discharge_window: WINDOW,
///     charge_window: WINDOW,
/// };
/// const LIMITS: PowerLimits = must!(PowerLimits::new(PARAMS, &CELL));
///
/// let at = |temperature_c| Estimate::rested(0.3, 0.01, temperature_c);
/// let health = Health::as_new(&CELL);
/// let ([short, _, long], [cold, ..]) =
///     (LIMITS.ahead(&at(25.0), &health), LIMITS.ahead(&at(-5.0), &health));
/// assert!(long.discharge.power_w <= short.discharge.power_w);
/// assert!(cold.discharge.power_w < short.discharge.power_w); // the voltage falls further
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerLimits<'b> {
    battery: &'b MappedBattery,
    params: PowerParams,
    horizons: [Horizon; HORIZONS],
}

/// What kept a current from being larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BoundBy {
    /// The largest current of the battery.
    Current,
    /// The voltage at the terminals.
    Voltage,
    /// The state of charge.
    Soc,
    /// The temperature, now or as the current raises it.
    Temperature,
    /// The estimate was not finite or absurd: nothing is allowed.
    Unknown,
}

/// What may be drawn, or charged.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Allowance {
    /// Constant current \[A\], ≥ 0 in either direction.
    pub current_a: Real,
    /// Constant power \[W\], ≥ 0 in either direction: 99.6 % of the current at its lowest voltage, so that
    /// no instant at this power takes more than the current.
    pub power_w: Real,
    /// The voltage closest to its limit that this current leads to \[V\].
    pub voltage_v: Real,
    /// What kept it from being larger.
    pub bound_by: BoundBy,
}

impl Allowance {
    const NONE: Self =
        Self { current_a: 0.0, power_w: 0.0, voltage_v: 0.0, bound_by: BoundBy::Unknown };
    const ANY: Self = Self {
        current_a: LARGEST,
        power_w: Real::INFINITY,
        voltage_v: 0.0,
        bound_by: BoundBy::Current,
    };
}

/// What is allowed over one horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PowerAhead {
    /// How long it holds \[s\].
    pub horizon_s: Real,
    /// Discharging.
    pub discharge: Allowance,
    /// Charging.
    pub charge: Allowance,
}

/// How far [`PowerLimits::walk`] or [`PowerLimits::walk_of_cells`] has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct PowerWalk {
    next: usize,
    /// Of cells in series, which is looked at.
    candidate: usize,
    discharge: Allowance,
    charge: Allowance,
    found: [PowerAhead; HORIZONS],
}

impl PowerWalk {
    /// Before the first call.
    pub const START: Self = Self {
        next: 0,
        candidate: 0,
        discharge: Allowance::ANY,
        charge: Allowance::ANY,
        found: [PowerAhead { horizon_s: 0.0, discharge: Allowance::NONE, charge: Allowance::NONE };
            HORIZONS],
    };
}

impl Default for PowerWalk {
    fn default() -> Self {
        Self::START
    }
}

impl<'b> PowerLimits<'b> {
    /// Checks `params`, for a `battery` whose own step does not matter here.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PowerParams, battery: &'b MappedBattery) -> Result<Self, ParamError> {
        check!(positive("power.voltage_min_v", params.voltage_min_v));
        check!(finite("power.voltage_max_v", params.voltage_max_v));
        check!(above("power.voltage_max_v", params.voltage_max_v, params.voltage_min_v));
        check!(ratio("power.soc_min", params.soc_min));
        check!(ratio("power.soc_max", params.soc_max));
        check!(above("power.soc_max", params.soc_max, params.soc_min));
        check!(not_negative("power.margin_sds", params.margin_sds));
        check!(params.discharge_window.checked([
            "power.discharge_window.none_below_c",
            "power.discharge_window.all_from_c",
            "power.discharge_window.all_to_c",
            "power.discharge_window.none_above_c",
        ]));
        check!(params.charge_window.checked([
            "power.charge_window.none_below_c",
            "power.charge_window.all_from_c",
            "power.charge_window.all_to_c",
            "power.charge_window.none_above_c",
        ]));
        let [a, b, c] = params.horizons_s;
        check!(above("power.horizons_s", b, a));
        check!(above("power.horizons_s", c, b));
        let horizons = [
            check!(Horizon::new("power.horizons_s", a, battery)),
            check!(Horizon::new("power.horizons_s", b, battery)),
            check!(Horizon::new("power.horizons_s", c, battery)),
        ];
        Ok(Self { battery, params, horizons })
    }

    /// What is allowed from now on. Without a finite estimate, nothing.
    #[must_use]
    pub fn ahead(&self, estimate: &Estimate, health: &Health) -> [PowerAhead; HORIZONS] {
        // What holds for long holds for short: where the battery warms up, the voltage may be
        // closest to its limit long before the end.
        let (mut discharge, mut charge) = (Allowance::ANY, Allowance::ANY);
        self.horizons.map(|horizon| {
            discharge = self.allow(&horizon, Direction::Discharge, discharge, estimate, health);
            charge = self.allow(&horizon, Direction::Charge, charge, estimate, health);
            PowerAhead { horizon_s: horizon.seconds(), discharge, charge }
        })
    }

    /// One horizon and direction at a time, for a processor with other things to do: six calls,
    /// and the answer is there, from the estimates of these calls.
    pub fn walk(
        &self,
        state: &mut PowerWalk,
        estimate: &Estimate,
        health: &Health,
    ) -> Option<[PowerAhead; HORIZONS]> {
        let index = state.next / 2;
        let Some((horizon, found)) = self.horizons.get(index).zip(state.found.get_mut(index))
        else {
            *state = PowerWalk::START;
            return None;
        };
        found.horizon_s = horizon.seconds();
        if state.next.is_multiple_of(2) {
            state.discharge =
                self.allow(horizon, Direction::Discharge, state.discharge, estimate, health);
            found.discharge = state.discharge;
        } else {
            state.charge = self.allow(horizon, Direction::Charge, state.charge, estimate, health);
            found.charge = state.charge;
        }
        state.next += 1;
        if state.next < 2 * HORIZONS {
            return None;
        }
        let found = state.found;
        *state = PowerWalk::START;
        Some(found)
    }

    /// Where the battery may stand that gives least, with the voltage that it has now.
    fn at_worst(
        &self,
        direction: Direction,
        estimate: &Estimate,
        health: &Health,
    ) -> (Estimate, Health) {
        let sds = self.params.margin_sds;
        let curve = self.battery.open_circuit();
        let soc = clamp(estimate.soc - direction.sign() * sds * estimate.soc_sd, 0.0, 1.0);
        let now = clamp(estimate.soc, 0.0, 1.0);
        let offset_v = estimate.offset_v + (curve.at(now) - curve.at(soc));
        let mut resistance_factor = health.resistance_factor + sds * health.resistance_factor_sd;
        if sds > 0.0 {
            // The resistance need not be highest where the voltage is lowest.
            let known = self.battery.params();
            let celsius = known.identified.nearest_c(estimate.temperature_c);
            let series = temperature_factor(known.series.activation_k, celsius);
            let fast = temperature_factor(known.polarisation.activation_k, celsius);
            let slow = temperature_factor(known.second_polarisation.activation_k, celsius);
            let total_ohm = |soc| {
                let soc = clamp(soc, known.identified.soc_min, known.identified.soc_max);
                series * known.series.resistance_ohm.at(soc)
                    + fast * known.polarisation.resistance_ohm.at(soc)
                    + slow * known.second_polarisation.resistance_ohm.at(soc)
            };
            let here_ohm = total_ohm(soc);
            let other = 2.0 * now - soc;
            let highest_ohm = max(here_ohm, max(total_ohm(now), total_ohm(other)));
            if here_ohm > 0.0 {
                resistance_factor *= highest_ohm / here_ohm;
            }
        }
        let soc = if sds > 0.0 { soc } else { estimate.soc };
        (Estimate { soc, offset_v, ..*estimate }, Health { resistance_factor, ..*health })
    }

    /// What is allowed over one horizon in one direction.
    fn allow(
        &self,
        horizon: &Horizon,
        direction: Direction,
        shorter: Allowance,
        estimate: &Estimate,
        health: &Health,
    ) -> Allowance {
        let (limits, known) = (&self.params, self.battery.params());
        let [fast_v, slow_v] = estimate.polarisation_v;
        let magnitude = estimate.soc.abs()
            + estimate.soc_sd.abs()
            + estimate.hysteresis.abs()
            + estimate.offset_v.abs()
            + fast_v.abs()
            + slow_v.abs()
            + estimate.temperature_c.abs()
            + health.capacity_ah
            + health.resistance_factor
            + health.resistance_factor_sd.abs();
        if !(sane(magnitude) && health.capacity_ah > 0.0 && health.resistance_factor > 0.0) {
            return Allowance::NONE;
        }
        let margin = limits.margin_sds * estimate.soc_sd;
        let (largest_a, window, soc_room, limit_v) = match direction {
            Direction::Discharge => (
                known.discharge_limit_a,
                &limits.discharge_window,
                estimate.soc - margin - limits.soc_min,
                limits.voltage_min_v,
            ),
            Direction::Charge => (
                known.charge_limit_a,
                &limits.charge_window,
                limits.soc_max - margin - estimate.soc,
                limits.voltage_max_v,
            ),
        };
        let derated_a = largest_a * window.share(estimate.temperature_c);
        let left_a = max(0.0, soc_room) * 3600.0 * health.capacity_ah / horizon.seconds();
        let mut most = (largest_a, BoundBy::Current);
        for bound in [
            (derated_a, BoundBy::Temperature),
            (left_a, BoundBy::Soc),
            (shorter.current_a, shorter.bound_by),
        ] {
            if bound.0 < most.0 {
                most = bound;
            }
        }

        let (estimate, health) = self.at_worst(direction, estimate, health);
        let ahead = Ahead::new(self.battery, horizon, &estimate, &health, direction);
        let look = |current_a: Real| {
            let seen = ahead.under(current_a);
            let room_v = direction.sign() * (seen.closest_v - limit_v);
            let room_k = window.none_above_c - seen.hottest_c;
            // A kelvin weighs as a volt does: in the end only the sign matters.
            if room_k < room_v {
                Look { current_a, room: room_k, seen, bound_by: BoundBy::Temperature }
            } else {
                Look { current_a, room: room_v, seen, bound_by: BoundBy::Voltage }
            }
        };
        let (most_a, bound_by) = most;
        let mut found = look(most_a);
        if found.room >= 0.0 {
            found.bound_by = bound_by;
        } else {
            found = between(look, look(0.0), found, CLOSE_ENOUGH * limit_v);
        }
        let Look { current_a, seen, bound_by, .. } = found;
        Allowance {
            current_a,
            power_w: max(0.0, min(POWER_SHARE * current_a * seen.lowest_v, shorter.power_w)),
            voltage_v: seen.closest_v,
            bound_by,
        }
    }
}

/// What a current leads to, and the room that it leaves to the limit that it comes closest to.
#[derive(Clone, Copy)]
struct Look {
    current_a: Real,
    room: Real,
    seen: Seen,
    bound_by: BoundBy,
}

/// The largest current that leaves room, between one that may and one that does not: false
/// position, the weight of an end that stays put halved.
fn between(look: impl Fn(Real) -> Look, low: Look, high: Look, close_enough: Real) -> Look {
    let mut best = Look { bound_by: high.bound_by, ..low };
    // Where there is little room to begin with, a small share of it.
    let close_enough = min(close_enough, 0.01 * low.room);
    let (mut high_a, mut low_weight, mut high_weight) = (high.current_a, low.room, high.room);
    for _ in 0..ROUNDS {
        if best.room <= close_enough {
            break;
        }
        let share = low_weight / (low_weight - high_weight);
        // Never quite to an end; the middle where the quotient is none.
        let share = if share > 0.0 && share < 1.0 { clamp(share, 0.01, 0.99) } else { 0.5 };
        let next = look(best.current_a + share * (high_a - best.current_a));
        if next.room >= 0.0 {
            best = Look { bound_by: best.bound_by, ..next };
            low_weight = next.room;
            high_weight *= 0.5;
        } else {
            (high_a, high_weight) = (next.current_a, next.room);
            best.bound_by = next.bound_by;
            low_weight *= 0.5;
        }
    }
    best
}

#[cfg(test)]
mod tests;
