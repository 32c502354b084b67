//! Between a source and a model: a delay `y[n] = x[n−1]`, a saturation `y = min(max(x, low), high)`
//! \[EPowertrain2025, `SignalRouting`; its lower default limit, −1e-6, is an error of the print\].
//!
//! Tests: below; properties `finite_plant`, `refusal`; case "step, ramp, table, delay, saturation".

use crate::error::{ParamError, above, check, finite};
use crate::model::impl_model;
use crate::num::{Real, clamp, sane};

/// Parameters of a delay by one step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct UnitDelayParams {
    /// What comes out at the first step.
    pub initial: Real,
}

/// A delay by one step: `y[n] = x[n−1]`.
///
/// ```
/// use plant_core::must;
/// use plant_core::signal::sources::{UnitDelay, UnitDelayParams, UnitDelayState};
///
/// const DELAY: UnitDelay = must!(UnitDelay::new(UnitDelayParams { initial: 0.0 }));
///
/// let mut state = UnitDelayState::default();
/// assert_eq!([1.0, 2.0, 3.0].map(|x| DELAY.step(&mut state, x).value), [0.0, 1.0, 2.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitDelay {
    params: UnitDelayParams,
}

/// The state of a [`UnitDelay`]; nothing has come in yet by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnitDelayState {
    /// The last value that came in.
    pub last: Option<Real>,
}

/// Output of one step of a [`UnitDelay`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnitDelayOutput {
    /// What came in one step before.
    pub value: Real,
    /// The input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl UnitDelay {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] for a bad initial value.
    pub const fn new(params: UnitDelayParams) -> Result<Self, ParamError> {
        check!(finite("delay.initial", params.initial));
        Ok(Self { params })
    }

    /// Takes `input` in and gives the one before out.
    #[inline]
    pub const fn step(&self, state: &mut UnitDelayState, input: Real) -> UnitDelayOutput {
        let value = match state.last {
            Some(last) => last,
            None => self.params.initial,
        };
        let rejected = !sane(input);
        if !rejected {
            state.last = Some(input);
        }
        UnitDelayOutput { value, rejected }
    }
}

impl_model!(UnitDelay, UnitDelayState, Real, UnitDelayOutput);

/// Parameters of a saturation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SaturationParams {
    /// Smallest value that gets through.
    pub low: Real,
    /// Largest value that gets through, above `low`.
    pub high: Real,
}

/// A value held between two limits. It has no state of its own and no time in it.
///
/// ```
/// use plant_core::must;
/// use plant_core::signal::sources::{Saturation, SaturationParams};
///
/// const DUTY: Saturation = must!(Saturation::new(SaturationParams { low: -1.0, high: 1.0 }));
///
/// let out = DUTY.step(&mut (), 1.7);
/// assert!(out.value == 1.0 && out.saturated);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation {
    params: SaturationParams,
}

/// Output of a [`Saturation`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SaturationOutput {
    /// The value within the limits.
    pub value: Real,
    /// A limit took hold.
    pub saturated: bool,
    /// The input was not finite or absurd; the value is what zero would give.
    pub rejected: bool,
}

impl Saturation {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: SaturationParams) -> Result<Self, ParamError> {
        let low = check!(finite("saturation.low", params.low));
        check!(above("saturation.high", check!(finite("saturation.high", params.high)), low));
        Ok(Self { params })
    }

    /// Holds `input` within the limits.
    #[inline]
    #[must_use]
    pub const fn step(&self, _state: &mut (), input: Real) -> SaturationOutput {
        let rejected = !sane(input);
        let wanted = if rejected { 0.0 } else { input };
        let SaturationParams { low, high } = self.params;
        SaturationOutput {
            value: clamp(wanted, low, high),
            saturated: wanted < low || wanted > high,
            rejected,
        }
    }
}

impl_model!(Saturation, (), Real, SaturationOutput);

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: SaturationParams = SaturationParams { low: -1.0, high: 4.0 };

    #[test]
    fn delays_by_one_step() {
        let delay = UnitDelay::new(UnitDelayParams { initial: 9.0 }).unwrap();
        let mut s = UnitDelayState::default();
        let mut expected = 9.0;
        for x in [1.0, -2.0, 0.0, 7.5] {
            let out = delay.step(&mut s, x);
            assert_eq!(out, UnitDelayOutput { value: expected, rejected: false });
            expected = x;
        }
    }

    #[test]
    fn saturates_and_says_so() {
        let limits = Saturation::new(LIMITS).unwrap();
        for (x, value, saturated) in
            [(-3.0, -1.0, true), (-1.0, -1.0, false), (0.5, 0.5, false), (4.1, 4.0, true)]
        {
            let out = limits.step(&mut (), x);
            assert_eq!(out, SaturationOutput { value, saturated, rejected: false });
        }
    }

    #[test]
    fn bad_input_changes_nothing() {
        let delay = UnitDelay::new(UnitDelayParams { initial: 9.0 }).unwrap();
        let mut s = UnitDelayState { last: Some(3.0) };
        let limits = Saturation::new(SaturationParams { low: 1.0, high: 4.0 }).unwrap();
        for bad in [Real::NAN, Real::INFINITY, -1e38] {
            let out = delay.step(&mut s, bad);
            assert_eq!(out, UnitDelayOutput { value: 3.0, rejected: true });
            assert_eq!(s.last, Some(3.0));
            let out = limits.step(&mut (), bad);
            assert!(out.rejected && out.value == 1.0);
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        for bad in [Real::NAN, Real::INFINITY, -1e13] {
            assert_eq!(
                UnitDelay::new(UnitDelayParams { initial: bad }).unwrap_err(),
                ParamError::NotFinite("delay.initial")
            );
            assert_eq!(
                Saturation::new(SaturationParams { low: bad, ..LIMITS }).unwrap_err(),
                ParamError::NotFinite("saturation.low")
            );
            assert_eq!(
                Saturation::new(SaturationParams { high: bad, ..LIMITS }).unwrap_err(),
                ParamError::NotFinite("saturation.high")
            );
        }
        assert_eq!(
            Saturation::new(SaturationParams { low: 4.0, ..LIMITS }).unwrap_err(),
            ParamError::NotAbove("saturation.high")
        );
    }
}
