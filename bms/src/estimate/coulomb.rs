//! State of charge by counting charge, put right by the open-circuit voltage at rest.
//!
//! `SOC = SOC₀ − ∫ I dt / Q` with discharge current positive, charging current times its efficiency
//! \[Plett2015, ch. 2\]. The errors of the count, and when a rest puts it right, are ours: the
//! errors of a count are not noise, an offset stays the same offset. So each grows in proportion to
//! its cause, and they join as independent of each other. With `t` the time and `q` the charge
//! since the count was last put right, as state of charge:
//! `sd² = sd₀² + (σ_offset·t/Q)² + (σ_gain·∫|dq|)² + (σ_Q/Q·q)² + (I_max·t_missed/Q)² + Σ b²`, and
//! never more than that of a state of charge that may be anything. A gap of up to a second is bridged
//! by the mean of its neighbours and adds `b² = (I_max·t/Q)²·t/(5 s)`, as its error is another one from
//! gap to gap; what is missed for longer is `t_missed`. A capacity that was learnt takes the place of
//! the declared one.
//!
//! Tests: `tests` below; `tests/tests/bms_pack/coulomb.rs` and `finite.rs`; measured cells and
//! trips in `voltstep soc --estimator coulomb`.

mod book;
mod params;

pub use params::CoulombParams;

use plant_core::battery::OpenCircuit;
use plant_core::error::{efficiency, not_negative, positive};
use plant_core::num::{clamp, max, min, sane, sqrt};
use plant_core::{Accum, Dt, Model, ParamError, Real, check};

use crate::estimate::curve::rising;

/// Counts charge, and knows how wrong the count may be.
///
/// Two parts, so that the fast one stays small: [`step`](Self::step) at every sample of the
/// current, [`review`](Self::review) about once a second, which brings state of charge and uncertainty up to
/// date and looks for a rest. What flows to and fro between two reviews cancels before efficiency
/// and gain apply to it.
///
/// ```
/// use plant_core::battery::OpenCircuit;
/// use plant_core::must;
/// use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams};
/// use voltstep_bms::{Dt, ParamError};
///
/// const COUNTER: CoulombCounter = must!(CoulombCounter::new(
///     CoulombParams {
///         capacity_ah: 2.9,
///         capacity_sd_ah: 0.06,
///         charge_efficiency: 1.0,
///         offset_sd_a: 0.01,
///         gain_sd: 0.003,
///         largest_current_a: 30.0,
///         open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
///         rest_voltage_sd_v: 0.01,
///         rest_current_a: 0.02,
///         rest_s: 1800.0,
///     },
///     must!(Dt::from_s(0.1)),
/// ));
///
/// let mut state = COUNTER.rested(3.9); // the car stood overnight
/// for _ in 0..600 {
///     for _ in 0..10 {
///         COUNTER.step(&mut state, CoulombInput { current_a: 2.9 });
///     }
///     COUNTER.review(&mut state, 3.7);
/// }
/// let now = COUNTER.review(&mut state, 3.7);
/// assert!((now.soc - (0.75 - 600.0 / 3600.0)).abs() < 1e-4);
/// assert!((0.008..0.012).contains(&now.soc_sd));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombCounter {
    capacity_ah: Real,
    largest_current_a: Real,
    /// SOC per A over one step.
    soc_per_a: Real,
    dt_s: Real,
    charge_loss: Real,
    /// Of the offset, as SOC per second.
    offset_sd_per_s: Real,
    gain_sd: Real,
    /// Of the capacity, as a ratio.
    capacity_sd: Real,
    open_circuit: OpenCircuit,
    rest_voltage_sd_v: Real,
    rest_current_a: Real,
    rest_s: Real,
}

/// The state of a [`CoulombCounter`]. The default knows nothing: half full, as uncertain as a
/// state of charge can be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct CoulombState {
    /// Since the last review: the sum of the currents but the last, and the last with what that sum
    /// has rounded away \[A\]; steps, and those of them without a reading. A sum that is compensated
    /// one sample later keeps the last sample at no cost.
    earlier_a: Real,
    last_a: Real,
    steps: u32,
    missed_steps: u32,
    /// The capacity of the parameters over that of now, and what is not known of it, as a ratio,
    /// where something was learnt.
    per_capacity: Real,
    capacity_sd: Option<Real>,
    /// State of charge at the last review.
    soc: Accum,
    /// Since the count was put right: its standard deviation then, the time, and as SOC the charge
    /// taken out, the charge moved in either direction, and what may have flowed unseen.
    anchor_sd: Real,
    counted_s: Accum,
    taken_soc: Accum,
    moved_soc: Accum,
    unseen_soc: Accum,
    /// Variance of what flowed in single missing samples.
    bridged_variance: Real,
    rested_s: Accum,
    /// What of that was missed \[s\]; before the last review, all was.
    rest_missed_s: Real,
    saw_nothing: bool,
}

/// Input of one step of a [`CoulombCounter`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombInput {
    /// Measured current, positive when discharging \[A\]; NaN where there is no usable reading.
    pub current_a: Real,
}

/// Output of a review of a [`CoulombCounter`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CoulombOutput {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation.
    pub soc_sd: Real,
    /// A reading was missing or above the largest current since the last review: the count was
    /// held, and the uncertainty grew.
    pub current_missing: bool,
    /// The count was put right from the voltage at rest.
    pub anchored: bool,
    /// At rest, but the voltage lies so far outside the curve that it was not used.
    pub voltage_implausible: bool,
}

/// Variance of a state of charge that may be anything in 0..1 with the same probability.
const UNKNOWN_VARIANCE: Real = 1.0 / 12.0;
/// Its square root.
const UNKNOWN_SD: Real = 0.288_675_13;

impl CoulombState {
    const fn anchored(soc: Real, soc_sd: Real) -> Self {
        Self {
            earlier_a: 0.0,
            last_a: 0.0,
            steps: 0,
            missed_steps: 0,
            per_capacity: 1.0,
            capacity_sd: None,
            soc: Accum::new(soc),
            anchor_sd: soc_sd,
            counted_s: Accum::new(0.0),
            taken_soc: Accum::new(0.0),
            moved_soc: Accum::new(0.0),
            unseen_soc: Accum::new(0.0),
            bridged_variance: 0.0,
            rested_s: Accum::new(0.0),
            rest_missed_s: 0.0,
            saw_nothing: false,
        }
    }

    /// The sum of the currents since the last review \[A\].
    #[inline]
    const fn net_a(&self) -> Real {
        self.earlier_a + self.last_a
    }

    /// Nothing is known.
    pub const UNKNOWN: Self = Self::anchored(0.5, UNKNOWN_SD);

    /// Starts from a state of charge and its standard deviation, as a stored record gives them:
    /// [`UNKNOWN`](Self::UNKNOWN) where one of them is not a ratio in 0..1.
    #[must_use]
    pub fn known(soc: Real, soc_sd: Real) -> Self {
        let (ratios, most) = (0.0..=1.0, most_sd(soc));
        if ratios.contains(&soc) && ratios.contains(&soc_sd) {
            Self::anchored(soc, min(soc_sd, most))
        } else {
            Self::UNKNOWN
        }
    }
}

impl Default for CoulombState {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

/// How far `soc` lies from a truth that may be anything in 0..1, root mean square.
fn most_sd(soc: Real) -> Real {
    sqrt(UNKNOWN_VARIANCE + (soc - 0.5) * (soc - 0.5))
}

/// Standard deviations to either side within which a voltage at rest is read. Chosen: 0.3 % of
/// what is normally distributed lies outside.
const SPAN_SD: Real = 3.0;

impl CoulombCounter {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the field and the rule that it broke.
    pub const fn new(params: CoulombParams, dt: Dt) -> Result<Self, ParamError> {
        let capacity_ah = check!(positive("coulomb.capacity_ah", params.capacity_ah));
        let capacity_sd_ah = check!(not_negative("coulomb.capacity_sd_ah", params.capacity_sd_ah));
        let charge_efficiency =
            check!(efficiency("coulomb.charge_efficiency", params.charge_efficiency));
        let offset_sd_a = check!(not_negative("coulomb.offset_sd_a", params.offset_sd_a));
        let rest_voltage_sd_v =
            check!(positive("coulomb.rest_voltage_sd_v", params.rest_voltage_sd_v));
        let capacity_c = 3600.0 * capacity_ah;
        Ok(Self {
            capacity_ah,
            largest_current_a: check!(positive(
                "coulomb.largest_current_a",
                params.largest_current_a
            )),
            soc_per_a: dt.s() / capacity_c,
            dt_s: dt.s(),
            charge_loss: 1.0 - charge_efficiency,
            offset_sd_per_s: offset_sd_a / capacity_c,
            gain_sd: check!(not_negative("coulomb.gain_sd", params.gain_sd)),
            capacity_sd: capacity_sd_ah / capacity_ah,
            open_circuit: check!(rising("coulomb.open_circuit", params.open_circuit)),
            rest_voltage_sd_v,
            rest_current_a: check!(positive("coulomb.rest_current_a", params.rest_current_a)),
            rest_s: check!(positive("coulomb.rest_s", params.rest_s)),
        })
    }

    /// Starts from the voltage of a battery that has rested long enough \[V\];
    /// [`UNKNOWN`](CoulombState::UNKNOWN) where it says nothing.
    #[must_use]
    pub fn rested(&self, voltage_v: Real) -> CoulombState {
        match self.read_rest(voltage_v) {
            Some((soc, soc_sd)) => CoulombState::known(soc, soc_sd),
            None => CoulombState::UNKNOWN,
        }
    }

    /// Counts one sample of the current. The rest is left to [`review`](Self::review).
    #[inline]
    pub const fn step(&self, state: &mut CoulombState, input: CoulombInput) {
        state.steps = state.steps.wrapping_add(1);
        if input.current_a.abs() <= self.largest_current_a {
            let net_a = state.net_a();
            let lost_a = (net_a - state.earlier_a) - state.last_a;
            (state.earlier_a, state.last_a) = (net_a, input.current_a - lost_a);
        } else {
            state.missed_steps = state.missed_steps.wrapping_add(1);
        }
    }

    /// The state of charge now, between reviews too.
    #[inline]
    #[must_use]
    pub fn soc(&self, state: &CoulombState) -> Real {
        clamp(state.soc.get() - self.taken_soc(state), 0.0, 1.0)
    }

    /// Charge taken out since the last review, as SOC.
    #[inline]
    fn taken_soc(&self, state: &CoulombState) -> Real {
        let net_a = state.net_a();
        let soc_per_a = self.soc_per_a * state.per_capacity;
        clamp((net_a + self.charge_loss * max(-net_a, 0.0)) * soc_per_a, -1.0, 1.0)
    }

    /// Takes stock: books what was counted since the last review, and puts the count right where
    /// the battery has rested and `voltage_v` \[V\] (NaN where there is no usable reading) knows
    /// better. To be called about once a second, with less than 2³² steps in between.
    ///
    /// The voltage is used where its standard deviation as state of charge is below that of the
    /// count, so never where the curve is flat; or where the two contradict each other.
    pub fn review(&self, state: &mut CoulombState, voltage_v: Real) -> CoulombOutput {
        let current_missing = state.missed_steps > 0;
        let resting = self.book(state);
        if !resting {
            (state.rested_s, state.rest_missed_s) = (Accum::new(0.0), 0.0);
        }
        let (mut anchored, mut voltage_implausible) = (false, false);
        if resting && state.rested_s.get() >= self.rest_s && sane(voltage_v) {
            let soc_sd = self.soc_sd(state);
            match self.read_rest(voltage_v) {
                Some((rest_soc, rest_sd)) => {
                    let apart = (rest_soc - state.soc.get()).abs();
                    anchored = rest_sd < soc_sd || apart > SPAN_SD * (rest_sd + soc_sd);
                    if anchored {
                        *state = CoulombState {
                            per_capacity: state.per_capacity,
                            capacity_sd: state.capacity_sd,
                            ..CoulombState::known(rest_soc, rest_sd)
                        };
                    }
                }
                None => voltage_implausible = true,
            }
        }
        CoulombOutput {
            soc: state.soc.get(),
            soc_sd: self.soc_sd(state),
            current_missing,
            anchored,
            voltage_implausible,
        }
    }

    /// The standard deviation of the state of charge, as of the last review.
    #[must_use]
    pub fn soc_sd(&self, state: &CoulombState) -> Real {
        let mut variance = 0.0;
        for sd in [
            state.anchor_sd,
            self.offset_sd_per_s * state.counted_s.get(),
            self.gain_sd * state.moved_soc.get(),
            state.capacity_sd.unwrap_or(self.capacity_sd) * state.taken_soc.get(),
            state.unseen_soc.get(),
            sqrt(state.bridged_variance),
        ] {
            variance += sd * sd;
        }
        let off_middle = state.soc.get() - 0.5;
        sqrt(min(variance, UNKNOWN_VARIANCE + off_middle * off_middle))
    }

    /// State of charge of a rested voltage, and its standard deviation; `None` where the voltage
    /// lies outside the curve by more than three standard deviations.
    ///
    /// `voltage_sd/slope`, with the flattest slope over one and over three standard deviations to
    /// either side, so that a steep stretch does not deny the plateau beside it.
    fn read_rest(&self, voltage_v: Real) -> Option<(Real, Real)> {
        let sd_v = self.rest_voltage_sd_v;
        let (empty_v, full_v) = (self.open_circuit.at(0.0), self.open_circuit.at(1.0));
        if !(voltage_v >= empty_v - SPAN_SD * sd_v && voltage_v <= full_v + SPAN_SD * sd_v) {
            return None;
        }
        let voltage_v = clamp(voltage_v, empty_v, full_v);
        let soc = self.open_circuit.soc_at(voltage_v);
        let mut soc_sd = 0.0;
        for away in [1.0, -1.0, SPAN_SD, -SPAN_SD] {
            let reached = self.open_circuit.soc_at(voltage_v + away * sd_v);
            soc_sd = max((reached - soc) / away, soc_sd);
        }
        Some((soc, soc_sd))
    }
}

/// A count as a number: exact up to 2²⁴, to seven digits beyond.
#[allow(clippy::cast_precision_loss, reason = "seven digits are enough of a time")]
const fn real(count: u32) -> Real {
    count as Real
}

impl Model for CoulombCounter {
    type State = CoulombState;
    type Input = CoulombInput;
    type Output = ();

    #[inline]
    fn step(&self, state: &mut CoulombState, input: CoulombInput) {
        Self::step(self, state, input);
    }
}

#[cfg(test)]
mod tests;
