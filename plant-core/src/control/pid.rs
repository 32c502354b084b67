//! PID controller: dead zone, output limits, anti-windup, smoothing.
//!
//! `e = ref − in`, `raw = K·e + D·de/dt + ∫I·e dt`; within the dead zone the target is 0, beyond a
//! limit the limit, else `raw`; the output follows the target, `d out/dt = Smt·(target − out)`
//! \[EPowertrain2025, eq. 4.21 to 4.29\]. The filter of the derivative, the derivative of the
//! measurement and the directional anti-windup are ours.
//!
//! A sampled controller: it sees the state at the start of the step. The integral carries its gain,
//! so gains can change without a bump.
//!
//! Tests: `tests` below; properties `finite`, `refusal`; order of convergence in
//! `tests/tests/order.rs`; case "PID".

use crate::error::{ParamError, above, check, finite, limit, not_negative};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, LARGEST, LARGEST_PARAM, Real, clamp, lag_gain, max, min, sane, sound};

/// How far what was applied may lie from the output before it counts as saturated
/// ([`Pid::feed_back`]): this share of half the span of the limits, or this much where there are
/// none. More than the step of a timer with 100 counts, so that a rounded duty is no saturation.
pub const FEEDBACK_TOLERANCE: Real = 1.0 / 64.0;

/// Parameters of a PID controller. `Default` is that of the reference system, but for the
/// anti-windup: K 1, no I, no D, no dead zone, no limits, smoothing 1e6 1/s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct PidParams {
    /// Proportional gain, finite.
    pub proportional: Real,
    /// Integral gain \[1/s\], ≥ 0.
    pub integral_per_s: Real,
    /// Derivative gain \[s\], ≥ 0.
    pub derivative_s: Real,
    /// Time constant that smooths the derivative \[s\], ≥ 0; 0 for none.
    pub derivative_filter_s: Real,
    /// What the derivative is taken of.
    pub derivative_of: DerivativeOf,
    /// Below this magnitude the raw output counts as zero, ≥ 0; 0 for no dead zone.
    pub dead_zone: Real,
    /// Lowest output; −infinity for none but that of any value, −1e9.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited::below"))]
    pub output_min: Real,
    /// Highest output, above the lowest; infinity for none but that of any value, 1e9.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub output_max: Real,
    /// Rate at which the output follows its target \[1/s\], above zero; infinity for at once.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub smoothing_per_s: Real,
    /// What the integral does in saturation.
    pub anti_windup: AntiWindup,
}

impl Default for PidParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl PidParams {
    /// The default, as a constant.
    pub const DEFAULT: Self = Self {
        proportional: 1.0,
        integral_per_s: 0.0,
        derivative_s: 0.0,
        derivative_filter_s: 0.0,
        derivative_of: DerivativeOf::Error,
        dead_zone: 0.0,
        output_min: -Real::INFINITY,
        output_max: Real::INFINITY,
        smoothing_per_s: 1e6,
        anti_windup: AntiWindup::Directional,
    };
}

/// What the derivative is taken of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum DerivativeOf {
    /// Of the error: a step of the reference kicks.
    #[default]
    Error,
    /// Of the measurement: it does not.
    Measurement,
}

/// What the integral does in saturation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum AntiWindup {
    /// It stands still \[EPowertrain2025, eq. 4.21 to 4.29\].
    Freeze,
    /// It may move back out of saturation, and counts saturation further down the loop too
    /// ([`Pid::feed_back`]).
    #[default]
    Directional,
}

/// A PID controller, discretised for one step.
///
/// ```
/// use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
/// use plant_core::{Dt, must};
///
/// const PI: Pid = must!(Pid::new(
///     PidParams { proportional: 0.5, integral_per_s: 1.0, ..PidParams::DEFAULT },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let (mut state, mut level) = (PidState::default(), 0.0);
/// for _ in 0..2000 {
///     let out = PI.step(&mut state, PidInput { reference: 3.0, measurement: level });
///     level += 0.01 * (out.output - level); // a lag of 1 s
/// }
/// assert!((level - 3.0).abs() < 1e-3); // the integral leaves no error
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid {
    params: PidParams,
    integral_gain: Real,
    derivative_gain: Real,
    derivative_k: Real,
    smoothing_k: Real,
    feedback_tolerance: Real,
}

/// The state of a [`Pid`]; fresh by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PidState {
    integral: Accum,
    output: Accum,
    /// What the derivative is taken of, at the last step; none at the first.
    last: Option<Real>,
    /// Smoothed difference per step.
    difference: Accum,
    /// In which direction something further down the loop was saturated: its sign. Until the next
    /// step.
    excess: Real,
}

impl PidState {
    /// What the integral part contributes.
    #[must_use]
    pub const fn integral(&self) -> Real {
        self.integral.get()
    }

    /// The output of the last step.
    #[must_use]
    pub const fn output(&self) -> Real {
        self.output.get()
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

/// Input of a [`Pid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidInput {
    /// What the measurement should be.
    pub reference: Real,
    /// What it is.
    pub measurement: Real,
}

/// Output of one step of a [`Pid`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PidOutput {
    /// The output.
    pub output: Real,
    /// The output that it would have without limits, dead zone and smoothing.
    pub raw: Real,
    /// The raw output lies at or beyond a limit.
    pub saturated: bool,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Pid {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(mut params: PidParams, dt: Dt) -> Result<Self, ParamError> {
        check!(finite("pid.proportional", params.proportional));
        let filter_s = check!(not_negative("pid.derivative_filter_s", params.derivative_filter_s));
        check!(not_negative("pid.dead_zone", params.dead_zone));
        check!(above("pid.output_min", Real::INFINITY, params.output_min));
        check!(above("pid.output_max", params.output_max, params.output_min));
        let integral = check!(not_negative("pid.integral_per_s", params.integral_per_s));
        let derivative_s = check!(not_negative("pid.derivative_s", params.derivative_s));
        let smoothing = check!(limit("pid.smoothing_per_s", params.smoothing_per_s));
        // What no value may exceed saturates as a limit does, so that no integral becomes infinite.
        params.output_min = max(params.output_min, -LARGEST);
        params.output_max = min(params.output_max, LARGEST);
        let half_span = 0.5 * (params.output_max - params.output_min);
        let unit = if half_span < 0.5 * LARGEST { half_span } else { 1.0 };
        Ok(Self {
            params,
            feedback_tolerance: FEEDBACK_TOLERANCE * unit,
            integral_gain: integral * dt.s(),
            derivative_gain: derivative_s / dt.s(),
            derivative_k: if filter_s > 0.0 { lag_gain(dt.s() / filter_s) } else { 1.0 },
            smoothing_k: if smoothing < LARGEST_PARAM { lag_gain(dt.s() * smoothing) } else { 1.0 },
        })
    }

    const fn derivative_of(&self, input: PidInput) -> Real {
        match self.params.derivative_of {
            DerivativeOf::Error => input.reference - input.measurement,
            DerivativeOf::Measurement => -input.measurement,
        }
    }

    /// Sets the state so that the next step continues from `output`, held within the limits,
    /// without a bump.
    pub const fn preload(&self, state: &mut PidState, output: Real, input: PidInput) {
        let asked = sane(output);
        let output = clamp(output, self.params.output_min, self.params.output_max);
        let error = input.reference - input.measurement;
        let integral = output - self.params.proportional * error;
        let magnitude = input.reference.abs() + input.measurement.abs();
        if asked && sound(magnitude) && sane(integral) {
            *state = PidState {
                integral: Accum::new(integral),
                output: Accum::new(output),
                last: Some(self.derivative_of(input)),
                difference: Accum::new(0.0),
                excess: 0.0,
            };
        }
    }

    /// Tells the next step what became of the last output further down the loop (a duty that a
    /// battery limit held back, say), so that the integral does not wind up against it. What lies
    /// within [`FEEDBACK_TOLERANCE`] was only rounded.
    #[inline]
    pub const fn feed_back(&self, state: &mut PidState, applied: Real) {
        let excess = state.output.get() - applied;
        if sane(applied) && self.is_directional() {
            state.excess = if excess.abs() > self.feedback_tolerance { excess } else { 0.0 };
        }
    }

    /// Tells the next step only in which direction something further down the loop is saturated:
    /// 1 up, −1 down, 0 not.
    #[inline]
    pub const fn saturate(&self, state: &mut PidState, direction: Real) {
        if self.is_directional() {
            state.excess = direction;
        }
    }

    /// Advances by one step.
    #[inline(always)]
    pub fn step(&self, state: &mut PidState, input: PidInput) -> PidOutput {
        self.advance(state, input, state.excess, 0.0)
    }

    /// Advances by one step after being told what became of the last output, and whether anything
    /// held it back; a bad `applied` counts as bad input.
    #[inline(always)]
    pub(crate) fn step_fed_back(
        &self,
        state: &mut PidState,
        input: PidInput,
        applied: Real,
        limited: bool,
    ) -> PidOutput {
        let told = limited && self.is_directional();
        let excess = if told { state.output.get() - applied } else { 0.0 };
        self.advance(state, input, excess, applied)
    }

    #[inline(always)]
    fn advance(
        &self,
        state: &mut PidState,
        input: PidInput,
        excess: Real,
        applied: Real,
    ) -> PidOutput {
        let p = &self.params;
        if !sound(input.reference.abs() + input.measurement.abs() + applied.abs()) {
            let output = state.output.get();
            return PidOutput { output, raw: output, saturated: false, rejected: true };
        }
        let raw = self.follow(state, input, excess);
        let saturated = raw >= p.output_max || raw <= p.output_min;
        PidOutput { output: state.output.get(), raw, saturated, rejected: false }
    }

    /// The output of a step whose input is known to be sound.
    #[inline(always)]
    pub(crate) fn step_sound(&self, state: &mut PidState, input: PidInput) -> Real {
        self.follow(state, input, state.excess);
        state.output.get()
    }

    /// Moves the state by one step; what the output would be without limits.
    #[inline(always)]
    fn follow(&self, state: &mut PidState, input: PidInput, excess: Real) -> Real {
        let p = &self.params;
        let error = input.reference - input.measurement;
        state.excess = 0.0;
        let mut raw = p.proportional * error + state.integral.get();
        if self.derivative_gain > 0.0 {
            let now = self.derivative_of(input);
            let last = match state.last {
                Some(last) => last,
                None => now,
            };
            state.last = Some(now);
            state.difference.add(self.derivative_k * (now - last - state.difference.get()));
            raw += self.derivative_gain * state.difference.get();
        }
        let increment = self.integral_gain * error;
        let free = raw < p.output_max && raw > p.output_min && raw.abs() >= p.dead_zone;
        let target = if free && excess == 0.0 {
            state.integral.add(increment);
            raw
        } else {
            self.held_target(state, raw, increment, excess)
        };
        if self.smoothing_k < 1.0 {
            state.output.add(self.smoothing_k * (target - state.output.get()));
        } else {
            state.output = Accum::new(target);
        }
        raw
    }

    const fn is_directional(&self) -> bool {
        matches!(self.params.anti_windup, AntiWindup::Directional)
    }

    /// The target within the dead zone or in saturation, here or further down the loop.
    #[cold]
    fn held_target(&self, state: &mut PidState, raw: Real, increment: Real, excess: Real) -> Real {
        let p = &self.params;
        if raw.abs() < p.dead_zone {
            return clamp(0.0, p.output_min, p.output_max);
        }
        let (high, low) = (raw >= p.output_max, raw <= p.output_min);
        // What has grown absurd may shrink in any case.
        let runs = if self.is_directional() || raw.abs() >= LARGEST {
            let (high, low) = (high || excess > 0.0, low || excess < 0.0);
            !(high && increment > 0.0 || low && increment < 0.0)
        } else {
            !(high || low)
        };
        if runs {
            state.integral.add(increment);
        }
        clamp(raw, p.output_min, p.output_max)
    }
}

impl_model!(Pid, PidState, PidInput, PidOutput);

#[cfg(test)]
mod tests;
