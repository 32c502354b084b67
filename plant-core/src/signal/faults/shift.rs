//! Faults that move a value, or let it wait.

use super::{Disturbed, Random};
use crate::error::{ParamError, check, finite, not_negative};
use crate::model::{Dt, Model, impl_model};
use crate::num::{Accum, Real, sane};

/// Parameters of a noise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct NoiseParams {
    /// Its standard deviation, in the unit of the value, ≥ 0.
    pub sd: Real,
    /// From which its random numbers come.
    pub seed: u32,
}

/// White noise: each sample is off by a number of a normal distribution of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    params: NoiseParams,
}

/// The state of a [`Noise`]; [`Noise::start`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoiseState {
    random: Random,
    last: Real,
}

impl Noise {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError::Negative`] names the field that is out of range.
    pub const fn new(params: NoiseParams) -> Result<Self, ParamError> {
        check!(not_negative("noise.sd", params.sd));
        Ok(Self { params })
    }

    /// At the first of its numbers.
    #[must_use]
    pub const fn start(&self) -> NoiseState {
        NoiseState { random: Random::new(self.params.seed), last: 0.0 }
    }

    /// One reading.
    #[inline]
    pub fn step(&self, state: &mut NoiseState, value: Real) -> Disturbed {
        let mut random = state.random;
        let noisy = value + self.params.sd * random.normal();
        let rejected = !(sane(value) && sane(noisy));
        if !rejected {
            *state = NoiseState { random, last: noisy };
        }
        Disturbed { value: state.last, missing: false, rejected }
    }
}

impl_model!(Noise, NoiseState, Real, Disturbed);

/// Parameters of a drift.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DriftParams {
    /// How fast the offset grows, in the unit of the value per second, of either sign.
    pub per_s: Real,
    /// How large it becomes, in the unit of the value, ≥ 0.
    pub largest: Real,
}

/// An offset that grows with time, up to an end.
///
/// ```
/// use plant_core::signal::faults::{Drift, DriftParams, DriftState};
/// use plant_core::{Dt, must};
///
/// const DRIFT: Drift =
///     must!(Drift::new(DriftParams { per_s: -0.5, largest: 2.0 }, must!(Dt::from_s(1.0))));
/// let mut state = DriftState::default();
/// let readings = [10.0; 6].map(|x| DRIFT.step(&mut state, x).value);
/// assert_eq!(readings, [10.0, 9.5, 9.0, 8.5, 8.0, 8.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    per_step: Real,
    largest: Real,
}

/// The state of a [`Drift`]; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DriftState {
    /// The offset so far.
    pub offset: Accum,
    last: Real,
}

impl Drift {
    /// Checks `params`, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: DriftParams, dt: Dt) -> Result<Self, ParamError> {
        let per_s = check!(finite("drift.per_s", params.per_s));
        let largest = check!(not_negative("drift.largest", params.largest));
        Ok(Self { per_step: per_s * dt.s(), largest })
    }

    /// One reading; then the offset grows.
    #[inline]
    pub const fn step(&self, state: &mut DriftState, value: Real) -> Disturbed {
        let drifted = value + state.offset.get();
        let rejected = !(sane(value) && sane(drifted));
        if !rejected {
            state.last = drifted;
            state.offset.add(self.per_step);
            state.offset.clamp(-self.largest, self.largest);
        }
        Disturbed { value: state.last, missing: false, rejected }
    }
}

impl_model!(Drift, DriftState, Real, Disturbed);

/// What comes in is read `N` steps later, `N` at least 1.
///
/// ```
/// use plant_core::must;
/// use plant_core::signal::faults::Delay;
/// # use plant_core::ParamError;
///
/// const LATE: Delay<2> = must!(Delay::new());
/// let mut state = LATE.start(0.0)?;
/// assert_eq!([1.0, 2.0, 3.0, 4.0].map(|x| LATE.step(&mut state, x).value), [0.0, 0.0, 1.0, 2.0]);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay<const N: usize>(());

/// The state of a [`Delay`]; [`Delay::start`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DelayState<const N: usize> {
    waiting: [Real; N],
    oldest: usize,
}

impl<const N: usize> Delay<N> {
    /// Checks that there is a delay.
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] where there is none.
    pub const fn new() -> Result<Self, ParamError> {
        if N == 0 { Err(ParamError::NotPositive("delay.steps")) } else { Ok(Self(())) }
    }

    /// With `value` as what came in before.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] for a bad value.
    pub const fn start(&self, value: Real) -> Result<DelayState<N>, ParamError> {
        Ok(DelayState { waiting: [check!(finite("delay.value", value)); N], oldest: 0 })
    }

    /// One reading.
    #[inline]
    pub fn step(&self, state: &mut DelayState<N>, value: Real) -> Disturbed {
        let rejected = !sane(value);
        // Never outside: it wraps at the length.
        let Some(slot) = state.waiting.get_mut(state.oldest) else {
            return Disturbed { value: 0.0, missing: false, rejected: true };
        };
        let late = *slot;
        if !rejected {
            *slot = value;
            state.oldest = if state.oldest + 1 < N { state.oldest + 1 } else { 0 };
        }
        Disturbed { value: late, missing: false, rejected }
    }
}

impl<const N: usize> Model for Delay<N> {
    type State = DelayState<N>;
    type Input = Real;
    type Output = Disturbed;

    #[inline]
    fn step(&self, state: &mut DelayState<N>, value: Real) -> Disturbed {
        Self::step(self, state, value)
    }
}
