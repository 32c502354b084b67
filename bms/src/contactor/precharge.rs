//! Charging the link through a resistor: what is expected, and what tells that it is not so.

use plant_core::error::{above, check, not_negative, positive};
use plant_core::num::{LARGEST, lag_gain, max, min, sane};
use plant_core::{Dt, ParamError, Real};

use super::state::Watch;

/// A short lets the link rise by less than this share of what it lacks.
const SHORT: Real = 0.05;
/// An open resistor lets less than this share of the expected current flow.
const OPEN: Real = 0.3;

/// Parameters of [`PrechargeWatch`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PrechargeParams {
    /// Resistor \[Ω\], above zero.
    pub resistor_ohm: Real,
    /// Capacitance of the link \[F\], above zero; with the resistor two steps at least.
    pub link_f: Real,
    /// By what factor the time constant may be off, above 1. Chosen where unknown: 1.5.
    pub tau_factor: Real,
    /// Noise of the voltage difference between pack and link \[V\], ≥ 0.
    pub noise_v: Real,
    /// Noise of the current \[A\], ≥ 0.
    pub noise_a: Real,
    /// The link is charged when it lacks no more than this \[V\], above zero.
    pub done_v: Real,
    /// Samples in a row before any verdict, 2..100.
    pub count: u8,
    /// From the feedback until current flows, bouncing included \[s\], ≥ 0.
    pub lag_s: Real,
    /// What the resistor may take up at once \[J\], above zero.
    pub budget_j: Real,
    /// What a precharge into a short costs until it is told \[J\], below the budget.
    pub short_j: Real,
    /// Time constant with which it cools down \[s\], above zero.
    pub cooling_s: Real,
}

/// Judges the link while it is charged: what it lacks, pack less link, must fall under
/// `Δv·e^(−t/τ)` with the largest credible τ, stepped as `Δv −= (h/τ)/(1 + h/τ)·Δv`.
///
/// A link that is charged already is told at once, a short, an open resistor and a time constant
/// that is too long as soon as the noise allows. The resistor's heat is that of the measured current;
/// where that is not known, of the largest that can flow.
///
/// ```
/// use voltstep_bms::contactor::{PrechargeInput, PrechargeParams, PrechargeWatch, Watch};
/// use voltstep_bms::{Dt, must};
///
/// const WATCH: PrechargeWatch = must!(PrechargeWatch::new(
///     PrechargeParams {
///         resistor_ohm: 40.0,
///         link_f: 0.00096,
///         tau_factor: 1.5,
///         noise_v: 1.0,
///         noise_a: 0.05,
///         done_v: 4.0,
///         count: 5,
///         lag_s: 0.01,
///         budget_j: 200.0,
///         short_j: 60.0,
///         cooling_s: 30.0,
///     },
///     must!(Dt::from_s(0.001))
/// ));
/// let mut state = WATCH.cold();
/// let (pack_v, mut link_v) = (355.0, 121.0);
/// WATCH.begin(&mut state, pack_v, link_v);
/// let ms = (1..400).find(|_| {
///     let current_a = (pack_v - link_v) / 40.0;
///     link_v += current_a * 0.001 / 0.00096;
///     WATCH.step(&mut state, PrechargeInput { pack_v, link_v, current_a }) == Watch::Done
/// });
/// assert!(ms.is_some_and(|ms| ms < 170));
/// assert!(state.heat_j() < 30.0 && WATCH.ready(&state));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrechargeWatch {
    params: PrechargeParams,
    keep: Real,
    lag: u16,
    cooling_gain: Real,
    dt_s: Real,
}

/// What is measured while the link is charged; NaN where there is no value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PrechargeInput {
    /// Voltage of the pack \[V\].
    pub pack_v: Real,
    /// Voltage of the link \[V\].
    pub link_v: Real,
    /// Current out of the pack \[A\].
    pub current_a: Real,
}

/// The state of a [`PrechargeWatch`]: one precharge, and the resistor's heat, which lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct PrechargeState {
    first_v: Real,
    bound_v: Real,
    since: u16,
    beyond: u8,
    good: u8,
    heat_j: Real,
}

impl PrechargeState {
    /// Heat in the resistor \[J\].
    #[must_use]
    pub const fn heat_j(&self) -> Real {
        self.heat_j
    }
}

impl PrechargeWatch {
    /// Checks the parameters, for a call every `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: PrechargeParams, dt: Dt) -> Result<Self, ParamError> {
        check!(positive("precharge.resistor_ohm", params.resistor_ohm));
        check!(positive("precharge.link_f", params.link_f));
        let tau_s = params.resistor_ohm * params.link_f;
        if tau_s < 2.0 * dt.s() {
            return Err(ParamError::OutOfRange("precharge.link_f"));
        }
        check!(above("precharge.tau_factor", params.tau_factor, 1.0));
        check!(positive("precharge.tau_factor", params.tau_factor));
        check!(not_negative("precharge.noise_v", params.noise_v));
        check!(not_negative("precharge.noise_a", params.noise_a));
        check!(positive("precharge.done_v", params.done_v));
        if params.count < 2 || params.count > 100 {
            return Err(ParamError::OutOfRange("precharge.count"));
        }
        check!(not_negative("precharge.lag_s", params.lag_s));
        let lag = params.lag_s / dt.s() + 0.999;
        if lag >= 65_535.0 {
            return Err(ParamError::OutOfRange("precharge.lag_s"));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let lag = lag as u16;
        check!(positive("precharge.short_j", params.short_j));
        check!(positive("precharge.budget_j", params.budget_j));
        check!(above("precharge.budget_j", params.budget_j, params.short_j));
        check!(positive("precharge.cooling_s", params.cooling_s));
        Ok(Self {
            params,
            keep: 1.0 - lag_gain(dt.s() / (params.tau_factor * tau_s)),
            lag,
            cooling_gain: lag_gain(dt.s() / params.cooling_s),
            dt_s: dt.s(),
        })
    }

    /// A cold resistor.
    #[must_use]
    pub const fn cold(&self) -> PrechargeState {
        self.warmed(0.0)
    }

    /// A resistor with so much heat \[J\], as after a reset.
    #[must_use]
    pub const fn warmed(&self, heat_j: Real) -> PrechargeState {
        let heat_j = if sane(heat_j) { max(0.0, heat_j) } else { self.params.budget_j };
        PrechargeState { first_v: 0.0, bound_v: 0.0, since: 0, beyond: 0, good: 0, heat_j }
    }

    /// Whether the resistor can take one more precharge into a short.
    #[must_use]
    pub const fn ready(&self, state: &PrechargeState) -> bool {
        state.heat_j + self.params.short_j <= self.params.budget_j
    }

    /// The precharge contactor shows closed: from now on current flows.
    pub const fn begin(&self, state: &mut PrechargeState, pack_v: Real, link_v: Real) {
        let missing_v = pack_v - link_v;
        *state =
            PrechargeState { first_v: missing_v, bound_v: missing_v, ..self.warmed(state.heat_j) };
    }

    /// A step without a precharge: the resistor cools down.
    pub const fn cool(&self, state: &mut PrechargeState) {
        state.heat_j -= self.cooling_gain * state.heat_j;
    }

    /// A step of a precharge.
    pub const fn step(&self, state: &mut PrechargeState, input: PrechargeInput) -> Watch {
        let p = &self.params;
        let missing_v = input.pack_v - input.link_v;
        state.since = state.since.saturating_add(1);
        self.warm(state, missing_v, input.current_a);
        if state.since <= self.lag {
            return Watch::Wait;
        }
        state.bound_v *= self.keep;
        let still_a = p.done_v / p.resistor_ohm + p.noise_a;
        let charged = missing_v.abs() <= p.done_v && input.current_a.abs() <= still_a;
        state.good = if charged { state.good + 1 } else { 0 };
        if state.good >= p.count {
            state.good = p.count;
            return Watch::Done;
        }
        // What is not known is not within the bound.
        let within = missing_v <= state.bound_v + max(p.noise_v, p.done_v);
        state.beyond = if within { 0 } else { state.beyond + 1 };
        if state.beyond < p.count {
            return Watch::Wait;
        }
        state.beyond = p.count;
        let expected_a = missing_v.abs() / p.resistor_ohm;
        let flows = input.current_a.abs() > OPEN * expected_a + p.noise_a;
        if !flows {
            Watch::Open
        } else if state.first_v - missing_v < SHORT * state.first_v {
            Watch::Short
        } else {
            Watch::Slow
        }
    }

    const fn warm(&self, state: &mut PrechargeState, missing_v: Real, current_a: Real) {
        self.cool(state);
        let ohm = self.params.resistor_ohm;
        let worst_v = if sane(missing_v) { missing_v } else { state.first_v };
        let flowing_a = if sane(current_a) { current_a } else { worst_v / ohm };
        if sane(flowing_a) {
            let heat_j = state.heat_j + flowing_a * flowing_a * ohm * self.dt_s;
            state.heat_j = min(LARGEST, heat_j);
        }
    }
}
