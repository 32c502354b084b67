//! Sources that change once: a step, a ramp.
//!
//! `y = before` until `at_s`, then `after`; `y = start + slope·(t − from)` between two times. What
//! they do is \[EPowertrain2025, `Sources`\]; how they keep time is ours.
//!
//! Tests: below; properties `finite_plant`, `refusal`; case "step, ramp, table, delay, saturation".

use crate::error::{ParamError, above, check, finite, not_negative};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, clamp};

/// The state of a [`Step`] or a [`Ramp`]: the time since the start, which stops after the last
/// event; zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ElapsedState {
    /// Time since the start \[s\].
    pub elapsed_s: Accum,
}

impl ElapsedState {
    /// Time since `event_s`, negative before it \[s\].
    #[inline]
    const fn since_s(self, event_s: Real) -> Real {
        self.elapsed_s.since(Accum::new(event_s))
    }
}

/// Parameters of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct StepParams {
    /// Value before.
    pub before: Real,
    /// Value from `at_s` on.
    pub after: Real,
    /// When it changes \[s\], ≥ 0.
    pub at_s: Real,
}

/// A value that changes once, at the instant nearest to `at_s` (a time such as 0.3 s is no whole
/// number of steps in binary; an exact comparison would come late by one step now and then).
///
/// `step` says the value at the current instant, then moves on by one step.
///
/// ```
/// use plant_core::signal::sources::{ElapsedState, Step, StepParams};
/// use plant_core::{Dt, must};
///
/// const VOLTAGE: Step = must!(Step::new(
///     StepParams { before: 60.0, after: 248.0, at_s: 0.3 },
///     must!(Dt::from_s(0.1)),
/// ));
///
/// let mut state = ElapsedState::default();
/// assert_eq!([(); 5].map(|()| VOLTAGE.step(&mut state, ())), [60.0, 60.0, 60.0, 248.0, 248.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    params: StepParams,
    dt_s: Real,
}

impl Step {
    /// Checks `params`, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: StepParams, dt: Dt) -> Result<Self, ParamError> {
        check!(finite("step.before", params.before));
        check!(finite("step.after", params.after));
        check!(not_negative("step.at_s", params.at_s));
        Ok(Self { params, dt_s: dt.s() })
    }

    /// The value now; then time moves on by one step.
    #[inline]
    pub const fn step(&self, state: &mut ElapsedState, _input: ()) -> Real {
        if state.since_s(self.params.at_s) >= -0.5 * self.dt_s {
            self.params.after
        } else {
            state.elapsed_s.add(self.dt_s);
            self.params.before
        }
    }
}

impl_model!(Step, ElapsedState, (), Real);

/// Parameters of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct RampParams {
    /// Value before `from_s`.
    pub start: Real,
    /// Change per second between `from_s` and `to_s`.
    pub slope_per_s: Real,
    /// When it begins \[s\], ≥ 0.
    pub from_s: Real,
    /// When it ends \[s\], above `from_s`; the value then stays.
    pub to_s: Real,
}

/// A value that changes evenly between two times and holds before and after.
///
/// `step` says the value at the current instant, then moves on by one step.
///
/// ```
/// use plant_core::signal::sources::{ElapsedState, Ramp, RampParams};
/// use plant_core::{Dt, must};
///
/// const SPEED: Ramp = must!(Ramp::new(
///     RampParams { start: 2.0, slope_per_s: 0.5, from_s: 1.0, to_s: 3.0 },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let mut state = ElapsedState::default();
/// assert_eq!([(); 5].map(|()| SPEED.step(&mut state, ())), [2.0, 2.0, 2.5, 3.0, 3.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    params: RampParams,
    dt_s: Real,
}

impl Ramp {
    /// Checks `params`, for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: RampParams, dt: Dt) -> Result<Self, ParamError> {
        check!(finite("ramp.start", params.start));
        check!(finite("ramp.slope_per_s", params.slope_per_s));
        check!(not_negative("ramp.from_s", params.from_s));
        check!(above("ramp.to_s", check!(finite("ramp.to_s", params.to_s)), params.from_s));
        Ok(Self { params, dt_s: dt.s() })
    }

    /// The value now; then time moves on by one step.
    #[inline]
    pub const fn step(&self, state: &mut ElapsedState, _input: ()) -> Real {
        let RampParams { start, slope_per_s, from_s, to_s } = self.params;
        let along_s = clamp(state.since_s(from_s), 0.0, to_s - from_s);
        if state.since_s(to_s) < 0.0 {
            state.elapsed_s.add(self.dt_s);
        }
        start + slope_per_s * along_s
    }
}

impl_model!(Ramp, ElapsedState, (), Real);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const STEP: StepParams = StepParams { before: 1.0, after: 5.0, at_s: 0.3 };
    const RAMP: RampParams = RampParams { start: 2.0, slope_per_s: 10.0, from_s: 0.2, to_s: 0.7 };

    fn dt(dt_s: Real) -> Dt {
        Dt::from_s(dt_s).unwrap()
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn steps_at_the_nearest_instant_whatever_the_binary_says() {
        for (at_s, dt_s, at) in [
            (0.3, 0.1, 3),
            (1.0, 0.01, 100),
            (0.7, 0.001, 700),
            (0.0, 0.1, 0),
            (0.34, 0.1, 3),
            (0.36, 0.1, 4),
            (3600.0, 0.001, 3_600_000),
        ] {
            let step = Step::new(StepParams { at_s, ..STEP }, dt(dt_s)).unwrap();
            let mut s = ElapsedState::default();
            let changed = (0..4_000_000).find(|_| step.step(&mut s, ()) == 5.0).unwrap();
            assert_eq!(changed, at, "{at_s} {dt_s}");
        }
    }

    #[test]
    fn time_stops_after_the_last_event() {
        let (step, mut s) = (Step::new(STEP, dt(0.1)).unwrap(), ElapsedState::default());
        let (ramp, mut r) = (Ramp::new(RAMP, dt(0.1)).unwrap(), ElapsedState::default());
        for _ in 0..100 {
            step.step(&mut s, ());
            ramp.step(&mut r, ());
        }
        assert!(s.elapsed_s.get() < 0.31 && r.elapsed_s.get() < 0.81, "{s:?} {r:?}");
    }

    #[test]
    fn ramps_and_holds() {
        let (ramp, mut s) = (Ramp::new(RAMP, dt(0.05)).unwrap(), ElapsedState::default());
        for i in 0..40 {
            let time_s = i as Real * 0.05;
            let value = 2.0 + 10.0 * (time_s - 0.2).clamp(0.0, 0.5);
            assert!((ramp.step(&mut s, ()) - value).abs() < 1e-5, "{time_s}");
        }
        let last = ramp.step(&mut s, ());
        assert_eq!(last, 2.0 + 10.0 * (0.7 - 0.2));
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn an_hour_does_not_drift() {
        let params = RampParams { start: 0.0, slope_per_s: 1.0, from_s: 3599.0, to_s: 3700.0 };
        let (ramp, mut s) = (Ramp::new(params, dt(1e-3)).unwrap(), ElapsedState::default());
        let mut value = 0.0;
        for _ in 0..=3_600_000 {
            value = ramp.step(&mut s, ());
        }
        assert!((value - 1.0).abs() < 5e-4, "{value}");
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let step = |p| Step::new(p, dt(0.1)).unwrap_err();
        let ramp = |p| Ramp::new(p, dt(0.1)).unwrap_err();
        for bad in [Real::NAN, Real::INFINITY, -1e13] {
            assert_eq!(
                step(StepParams { before: bad, ..STEP }),
                ParamError::NotFinite("step.before")
            );
            assert_eq!(
                step(StepParams { after: bad, ..STEP }),
                ParamError::NotFinite("step.after")
            );
            assert_eq!(step(StepParams { at_s: bad, ..STEP }), ParamError::Negative("step.at_s"));
            assert_eq!(
                ramp(RampParams { start: bad, ..RAMP }),
                ParamError::NotFinite("ramp.start")
            );
            assert_eq!(
                ramp(RampParams { slope_per_s: bad, ..RAMP }),
                ParamError::NotFinite("ramp.slope_per_s")
            );
            assert_eq!(
                ramp(RampParams { from_s: bad, ..RAMP }),
                ParamError::Negative("ramp.from_s")
            );
            assert_eq!(ramp(RampParams { to_s: bad, ..RAMP }), ParamError::NotFinite("ramp.to_s"));
        }
        assert_eq!(ramp(RampParams { to_s: 0.2, ..RAMP }), ParamError::NotAbove("ramp.to_s"));
    }
}
