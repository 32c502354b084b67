//! A battery whose resistances depend on state of charge and temperature, with two RC branches,
//! hysteresis and a thermal node.
//!
//! `V = OCV(s) + M·h − R0(s, T)·I − v1 − v2`, `τk·dvk/dt = Rk(s, T)·I − vk` \[ChenRinconMora2006,
//! eq. 1 and fig. 2, with resistances over the temperature\]; hysteresis \[Plett2004Part2\] and
//! heat \[Bernardi1985\] as `map` says. A constant τk where R varies is ours.
//!
//! Tests: `tests` below; property `mapped`; cases "battery with maps", "UDDS, bmw-i3-60ah with its
//! battery map".

mod state;

pub use state::{MappedBatteryInput, MappedBatteryOutput, MappedBatteryState, Resistances};

use super::limits::Ends;
use super::map::{COLDEST_C, HOTTEST_C, MappedBatteryParams, is_possible, temperature};
use super::{CurrentLimits, OpenCircuit, SOC_MARGIN};
use crate::error::{ParamError, check, ratio};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, LARGEST, Real, clamp, lag_gain, max, min, sane, sign};
use crate::port::Source;

/// A battery with parameters over state of charge and temperature, discretised for one step.
///
/// With discharge current positive, `s` the state of charge and `T` the temperature:
/// `V = OCV(s) + M·h − R0(s, T)·I − v1 − v2`, `τk·dvk/dt = Rk(s, T)·I − vk` \[ChenRinconMora2006,
/// eq. 1 and fig. 2, with resistances over the temperature\]. The open-circuit voltage and
/// the hysteresis are taken at the old state, the rest implicitly, so within one step the battery
/// is a [`Source`].
///
/// Resistances and temperature change slowly: every [`refresh_s`](MappedBatteryParams::refresh_s)
/// they follow, in between a step costs little more than that of [`Battery`](super::Battery).
///
/// ```
/// use plant_core::battery::{MappedBattery, MappedBatteryInput};
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use plant_core::{Dt, ParamError, must};
///
/// const CELL: MappedBattery =
///     must!(MappedBattery::new(PANASONIC_NCR18650PF, must!(Dt::from_s(0.1))));
///
/// let (mut warm, mut cold) = (CELL.rested_at(0.6, 25.0)?, CELL.rested_at(0.6, 0.0)?);
/// let load = MappedBatteryInput { current_a: 3.0 };
/// let (at_25_c, at_0_c) = (CELL.step(&mut warm, load), CELL.step(&mut cold, load));
/// assert!(at_0_c.terminal_v < at_25_c.terminal_v); // resistance rises in the cold
/// assert_eq!(at_0_c.soc, at_25_c.soc);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MappedBattery {
    pub(super) params: MappedBatteryParams,
    gains: [Real; 2],
    pub(super) soc_per_a: Real,
    a_per_soc: Real,
    pub(super) capacity_c: Real,
    pub(super) dt_s: Real,
    pub(super) refresh_steps: u32,
    /// K per J of heat over one refresh, and the share of the difference to the surroundings that
    /// is lost in it.
    warming_k_per_j: Real,
    cooling_gain: Real,
    pub(super) ends: Ends,
}

impl MappedBattery {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: MappedBatteryParams, dt: Dt) -> Result<Self, ParamError> {
        let params = check!(params.checked());
        let capacity_c = 3600.0 * params.capacity_ah;
        let steps = params.refresh_s / dt.s();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "held in 1..2^31 first"
        )]
        let refresh_steps = clamp(steps + 0.5, 1.0, 2_147_483_648.0) as u32;
        let refresh_s = length_s(refresh_steps, dt.s());
        let capacity_j_per_k = params.thermal.heat_capacity_j_per_k;
        let cooling_gain = gain(refresh_s / capacity_j_per_k * params.thermal.cooling_w_per_k);
        let mut limited = params;
        // No limit still keeps absurd currents out.
        limited.discharge_limit_a = min(params.discharge_limit_a, LARGEST);
        limited.charge_limit_a = min(params.charge_limit_a, LARGEST);
        Ok(Self {
            params: limited,
            gains: [
                gain(dt.s() / params.polarisation.time_constant_s),
                gain(dt.s() / params.second_polarisation.time_constant_s),
            ],
            soc_per_a: dt.s() / capacity_c,
            a_per_soc: capacity_c / dt.s(),
            capacity_c,
            dt_s: dt.s(),
            refresh_steps,
            warming_k_per_j: (1.0 - cooling_gain) / capacity_j_per_k,
            cooling_gain,
            ends: Ends::new(
                capacity_c,
                CurrentLimits {
                    discharge_a: limited.discharge_limit_a,
                    charge_a: limited.charge_limit_a,
                },
                params.voltage_limits,
                dt,
            ),
        })
    }

    /// A rested battery at `soc` and at the temperature of its surroundings.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] outside 0..1.
    pub fn rested(&self, soc: Real) -> Result<MappedBatteryState, ParamError> {
        self.rested_at(soc, self.params.thermal.ambient_c)
    }

    /// A rested battery at `soc` whose temperature and surroundings are at `temperature_c`.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] for a state of charge outside 0..1,
    /// [`ParamError::OutOfRange`] for a temperature outside −100..200 °C.
    pub fn rested_at(
        &self,
        soc: Real,
        temperature_c: Real,
    ) -> Result<MappedBatteryState, ParamError> {
        let soc = ratio("soc", soc)?;
        let temperature_c = temperature("temperature_c", temperature_c)?;
        let mut state = MappedBatteryState {
            soc: Accum::new(soc),
            polarisation_v: [Accum::new(0.0); 2],
            hysteresis: Accum::new(0.0),
            temperature_c: Accum::new(temperature_c),
            ambient_c: temperature_c,
            surroundings_c: temperature_c,
            heat_j: 0.0,
            now: Resistances::default(),
            source_ohm: 0.0,
            steps_left: self.refresh_steps,
            outside: false,
        };
        self.follow(&mut state, 1.0);
        Ok(state)
    }

    /// How often resistances and temperature follow, a whole number of steps \[s\].
    pub(super) const fn refresh_s(&self) -> Real {
        length_s(self.refresh_steps, self.dt_s)
    }

    /// Its parameters.
    #[must_use]
    pub const fn params(&self) -> &MappedBatteryParams {
        &self.params
    }

    /// The resistances at a state of charge and a temperature; outside the identified range,
    /// those of its nearest end.
    #[must_use]
    pub fn resistances(&self, soc: Real, temperature_c: Real) -> Resistances {
        let range = &self.params.identified;
        let soc = clamp(soc, range.soc_min, range.soc_max);
        let celsius = range.nearest_c(temperature_c);
        Resistances {
            series_ohm: self.params.series.at(soc, celsius),
            polarisation_ohm: [
                self.params.polarisation.at(soc, celsius),
                self.params.second_polarisation.at(soc, celsius),
            ],
        }
    }

    /// Sets a measured temperature \[°C\]: the resistances follow at once. Says whether it did: one
    /// outside −100..200 °C (kelvins, say), or not a number, changes nothing.
    pub fn set_temperature(&self, state: &mut MappedBatteryState, temperature_c: Real) -> bool {
        let taken = is_possible(temperature_c);
        if taken {
            state.temperature_c = Accum::new(temperature_c);
            self.follow(state, 1.0);
        }
        taken
    }

    /// What the terminals offer over the next step, and the open-circuit voltage in it \[V\].
    #[inline]
    #[must_use]
    pub fn offer(&self, state: &MappedBatteryState) -> (Source, Real) {
        let open_circuit_v = self.params.open_circuit.at(state.soc.get());
        let emf_v = open_circuit_v + self.hysteresis_v(state) - self.held_v(state);
        (Source { emf_v, resistance_ohm: state.source_ohm }, open_circuit_v)
    }

    /// What the branches hold after a step without current \[V\].
    #[inline]
    const fn held_v(&self, state: &MappedBatteryState) -> Real {
        let [fast_v, slow_v] = &state.polarisation_v;
        (fast_v.get() - self.gains[0] * fast_v.get())
            + (slow_v.get() - self.gains[1] * slow_v.get())
    }

    /// What hysteresis adds to the open-circuit voltage \[V\].
    #[inline]
    pub(super) const fn hysteresis_v(&self, state: &MappedBatteryState) -> Real {
        self.params.hysteresis.half_gap_v * state.hysteresis.get()
    }

    /// The currents that the battery allows over the next step.
    #[inline]
    #[must_use]
    pub fn limits(&self, state: &MappedBatteryState) -> CurrentLimits {
        let soc = state.soc.get();
        let limits = CurrentLimits {
            discharge_a: min(self.params.discharge_limit_a, max(soc, 0.0) * self.a_per_soc),
            charge_a: min(self.params.charge_limit_a, max(1.0 - soc, 0.0) * self.a_per_soc),
        };
        if self.ends.cut_off() {
            let held_v = self.held_v(state) - self.hysteresis_v(state);
            limits.within(self.at_voltages(soc, held_v, state.source_ohm))
        } else {
            limits
        }
    }

    /// What the voltages leave where the branches hold `held_v` without current.
    #[cold]
    #[inline(never)]
    fn at_voltages(&self, soc: Real, held_v: Real, resistance_ohm: Real) -> CurrentLimits {
        let emf_v = self.params.open_circuit.at(soc) - held_v;
        self.ends.at_voltages(Source { emf_v, resistance_ohm })
    }

    /// The state after one step under `current_a`, whatever the limits say.
    #[inline]
    #[must_use]
    pub fn next(&self, state: &MappedBatteryState, current_a: Real) -> MappedBatteryState {
        self.next_by(state, current_a, current_a * self.soc_per_a)
    }

    /// The same where the state of charge falls by `soc_drop`: in a cell of another capacity.
    #[inline(always)]
    pub(super) fn next_by(
        &self,
        state: &MappedBatteryState,
        current_a: Real,
        soc_drop: Real,
    ) -> MappedBatteryState {
        let mut next = *state;
        let mut overpotential_v = state.now.series_ohm * current_a - self.hysteresis_v(state);
        for ((voltage_v, gain), ohm) in
            next.polarisation_v.iter_mut().zip(self.gains).zip(state.now.polarisation_ohm)
        {
            voltage_v.add(gain * (ohm * current_a - voltage_v.get()));
            overpotential_v += voltage_v.get();
        }
        next.soc.add(-soc_drop);
        if self.params.hysteresis.half_gap_v > 0.0 {
            let share = self.hysteresis_share(soc_drop);
            next.hysteresis.add(share * (-sign(current_a) - next.hysteresis.get()));
        }
        next.heat_j += overpotential_v * current_a * self.dt_s;
        next
    }

    /// The same, as a coupled plant keeps them: towards full, and towards empty, they fade with the
    /// charge that is left to go, over 0.1 s.
    #[inline]
    #[must_use]
    pub fn faded(&self, state: &MappedBatteryState) -> CurrentLimits {
        self.limits(state).within(self.ends.faded(state.soc.get()))
    }

    /// Whether a step under `current_a`, and under `least_a` once the windings have settled, that
    /// leads to `next` keeps every limit, as [`faded`](Self::faded) gives them, clear of the ends of
    /// charge.
    #[inline]
    #[must_use]
    pub fn allows(&self, current_a: Real, least_a: Real, next: &MappedBatteryState) -> bool {
        current_a <= self.params.discharge_limit_a
            && least_a >= -self.params.charge_limit_a
            && (self.ends.are_far(next.soc.get()) || {
                let [fast_v, slow_v] = next.polarisation_v;
                let branches_ohm = next.source_ohm - next.now.series_ohm;
                let held_v = fast_v.get() + slow_v.get() - branches_ohm * current_a;
                let (soc, hysteresis) = (next.soc.get(), next.hysteresis.get());
                self.ends_allow(current_a, least_a, soc, hysteresis, held_v, next.source_ohm)
            })
    }

    /// Numbers and not a state: to hand that over would have every step keep it in memory.
    #[cold]
    #[inline(never)]
    fn ends_allow(
        &self,
        current_a: Real,
        least_a: Real,
        next_soc: Real,
        next_hysteresis: Real,
        held_v: Real,
        source_ohm: Real,
    ) -> bool {
        if self.ends.are_near(next_soc) {
            return false;
        }
        let soc_drop = current_a * self.soc_per_a;
        let soc = next_soc + soc_drop;
        let mut limits = self.ends.faded(soc);
        if self.ends.cut_off() {
            // Hysteresis acts as it was before the step; where it may have been anything, the answer
            // is no, and the limits themselves are looked at.
            let share = self.hysteresis_share(soc_drop);
            let hysteresis = (next_hysteresis + share * sign(current_a)) / (1.0 - share);
            let held_v = held_v - self.params.hysteresis.half_gap_v * hysteresis;
            limits = limits.within(self.at_voltages(soc, held_v, source_ohm));
        }
        current_a <= limits.discharge_a && -least_a <= limits.charge_a
    }

    /// How far a change of the state of charge moves the hysteresis.
    #[inline(always)]
    const fn hysteresis_share(&self, soc_drop: Real) -> Real {
        lag_gain(self.params.hysteresis.rate_per_soc * soc_drop.abs())
    }

    /// Books one step under `current_a`, which [`limits`](Self::limits) allow. Returns what was
    /// charged beyond full all the same, or, negative, drawn beyond empty \[C\]: it is lost.
    #[inline]
    pub fn settle(&self, state: &mut MappedBatteryState, current_a: Real) -> Real {
        *state = self.next(state, current_a);
        let reached = state.soc;
        state.soc.clamp(0.0, 1.0);
        self.capacity_c * reached.since(state.soc)
    }

    /// Counts a step; when it is time, temperature and resistances follow.
    #[inline]
    pub fn refresh(&self, state: &mut MappedBatteryState) {
        state.steps_left -= u32::from(state.steps_left > 0);
        if state.steps_left == 0 {
            self.warm(state);
        }
    }

    #[cold]
    #[inline(never)]
    fn warm(&self, state: &mut MappedBatteryState) {
        Self::look_around(state);
        let above_k = state.temperature_c.get() - state.surroundings_c;
        let increment_k = self.warming_k_per_j * state.heat_j - self.cooling_gain * above_k;
        Self::warm_by(state, increment_k);
        state.steps_left = self.refresh_steps;
        self.follow(state, 1.0);
    }

    /// Takes the temperature of the surroundings, and a temperature where there was none.
    pub(super) fn look_around(state: &mut MappedBatteryState) {
        if is_possible(state.ambient_c) {
            state.surroundings_c = state.ambient_c;
        }
        if state.temperature_c.get().is_nan() {
            state.temperature_c = Accum::new(state.surroundings_c);
        }
    }

    /// What the heat since the last refresh came to.
    pub(super) fn warm_by(state: &mut MappedBatteryState, increment_k: Real) {
        // Held where any battery has long burnt: the exponential stays finite.
        let celsius = state.temperature_c.get() + increment_k;
        if is_possible(celsius) {
            state.temperature_c.add(increment_k);
        } else {
            state.temperature_c = Accum::new(clamp(celsius, COLDEST_C, HOTTEST_C));
        }
        state.heat_j = 0.0;
    }

    /// Brings the resistances up to state of charge and temperature; `ratio` is that of a cell with
    /// other resistances.
    pub(super) fn follow(&self, state: &mut MappedBatteryState, ratio: Real) {
        let (soc, celsius) = (state.soc.get(), state.temperature_c.get());
        let Resistances { series_ohm, polarisation_ohm: [fast, slow] } =
            self.resistances(soc, celsius);
        state.now = Resistances {
            series_ohm: ratio * series_ohm,
            polarisation_ohm: [ratio * fast, ratio * slow],
        };
        let [fast, slow] = state.now.polarisation_ohm;
        state.source_ohm = state.now.series_ohm + self.gains[0] * fast + self.gains[1] * slow;
        // Held at an end of what is possible, it is no temperature that parameters are known for.
        let held = celsius <= COLDEST_C || celsius >= HOTTEST_C;
        state.outside = held || !self.params.identified.holds(soc, celsius);
    }

    /// The open-circuit curve.
    #[must_use]
    pub const fn open_circuit(&self) -> &OpenCircuit {
        &self.params.open_circuit
    }

    /// Advances by one step under an imposed current. What the limits or the state of charge do
    /// not allow is refused and reported.
    #[inline]
    pub fn step(
        &self,
        state: &mut MappedBatteryState,
        input: MappedBatteryInput,
    ) -> MappedBatteryOutput {
        let (source, open_circuit_v) = self.offer(state);
        let limits = self.limits(state);
        let mut wanted_a = input.current_a;
        let mut current_a = clamp(wanted_a, -limits.charge_a, limits.discharge_a);
        let mut next = *state;
        self.settle(&mut next, current_a);
        let rejected = !(sane(wanted_a) && sane(next.magnitude()));
        if rejected {
            (wanted_a, current_a) = (0.0, 0.0);
        } else {
            *state = next;
            self.refresh(state);
        }
        let terminal_v = source.voltage_v(current_a);
        MappedBatteryOutput {
            soc: state.soc.get(),
            terminal_v,
            open_circuit_v,
            current_a,
            refused_charge_c: (wanted_a - current_a) * self.soc_per_a * self.capacity_c,
            heat_w: (open_circuit_v - terminal_v) * current_a,
            temperature_c: state.temperature_c.get(),
            depleted: state.soc.get() <= SOC_MARGIN,
            full: state.soc.get() >= 1.0 - SOC_MARGIN,
            outside_identified: state.outside,
            rejected,
        }
    }
}

#[cfg_attr(
    not(feature = "twin-f64"),
    expect(clippy::cast_precision_loss, reason = "a length of time")
)]
const fn length_s(steps: u32, dt_s: Real) -> Real {
    steps as Real * dt_s
}

/// The gain of an implicit lag; 1 where the quotient overflows.
const fn gain(steps: Real) -> Real {
    let k = lag_gain(steps);
    if k <= 1.0 { k } else { 1.0 }
}

impl_model!(MappedBattery, MappedBatteryState, MappedBatteryInput, MappedBatteryOutput);

#[cfg(test)]
mod tests;
