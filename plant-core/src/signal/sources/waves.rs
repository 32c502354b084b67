//! Sources that repeat: a sine `y = offset + amplitude·sin(2π·(f·t + phase))`, a square wave (PWM).
//!
//! What they do is \[EPowertrain2025, `Sources`\]; the phase in turns, which does not drift, is
//! ours.
//!
//! Tests: below; properties `finite_plant`, `refusal`; case "sine and square".

use crate::error::{ParamError, check, finite, positive, ratio};
use crate::mechanics::rotational::turn;
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sin_cos_turns, wrap_turns};

/// The state of a [`Sine`] or a [`Square`]: how far its cycle is; at its start by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PhaseState {
    /// Turns since the start, within 0..1 (1 where a value just below rounds up to it).
    pub turns: Accum,
}

/// Parameters of a sine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SineParams {
    /// Half the distance between crest and trough.
    pub amplitude: Real,
    /// Mean value.
    pub offset: Real,
    /// Frequency \[Hz\], above zero.
    pub frequency_hz: Real,
    /// Phase at the start in turns, 0..1: 0.25 starts at the crest.
    pub phase_turns: Real,
}

/// `offset + amplitude·sin(2π·(f·t + phase))`.
///
/// `step` says the value at the current instant, then moves on by one step. The phase is off by
/// at most 1e-7 of the turns made, as `f·h` is rounded once.
///
/// ```
/// use plant_core::signal::sources::{PhaseState, Sine, SineParams};
/// use plant_core::{Dt, must};
///
/// const MAINS: Sine = must!(Sine::new(
///     SineParams { amplitude: 325.0, offset: 0.0, frequency_hz: 50.0, phase_turns: 0.0 },
///     must!(Dt::from_s(0.005)),
/// ));
///
/// let mut state = PhaseState::default();
/// for crest in [0.0, 325.0, 0.0, -325.0] {
///     assert!((MAINS.step(&mut state, ()) - crest).abs() < 1e-3); // a quarter of a turn each
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    amplitude: Real,
    offset: Real,
    phase_turns: Real,
    turns_per_step: Real,
}

impl Sine {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: SineParams, dt: Dt) -> Result<Self, ParamError> {
        Ok(Self {
            amplitude: check!(finite("sine.amplitude", params.amplitude)),
            offset: check!(finite("sine.offset", params.offset)),
            phase_turns: check!(ratio("sine.phase_turns", params.phase_turns)),
            turns_per_step: check!(positive("sine.frequency_hz", params.frequency_hz)) * dt.s(),
        })
    }

    /// The value now; then time moves on by one step.
    #[inline]
    pub fn step(&self, state: &mut PhaseState, _input: ()) -> Real {
        let (sine, _) = sin_cos_turns(state.turns.get() + self.phase_turns);
        turn(&mut state.turns, self.turns_per_step);
        self.offset + self.amplitude * sine
    }
}

impl_model!(Sine, PhaseState, (), Real);

/// Parameters of a square wave.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SquareParams {
    /// Value in the second part of the period.
    pub low: Real,
    /// Value in the first part of the period.
    pub high: Real,
    /// Period \[s\], above zero.
    pub period_s: Real,
    /// Share of the period that is high, 0..1.
    pub on_ratio: Real,
    /// How much of a period has passed at the start, 0..1.
    pub phase_turns: Real,
}

/// A square wave, or pulse-width modulation: `high` for `on_ratio` of each period, then `low`.
///
/// `step` says the value at the current instant, then moves on by one step. An edge shows at the
/// instant nearest to it, so that rounding does not shift edges that fall on an instant. The
/// share that comes out is a whole number of steps: resolve the period well enough.
///
/// ```
/// use plant_core::signal::sources::{PhaseState, Square, SquareParams};
/// use plant_core::{Dt, must};
///
/// const PWM: Square = must!(Square::new(
///     SquareParams { low: 0.0, high: 12.0, period_s: 0.004, on_ratio: 0.25, phase_turns: 0.0 },
///     must!(Dt::from_s(0.001)),
/// ));
///
/// let mut state = PhaseState::default();
/// assert_eq!([(); 5].map(|()| PWM.step(&mut state, ())), [12.0, 0.0, 0.0, 0.0, 12.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    low: Real,
    high: Real,
    on_ratio: Real,
    ahead_turns: Real,
    turns_per_step: Real,
}

impl Square {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: SquareParams, dt: Dt) -> Result<Self, ParamError> {
        let turns_per_step = dt.s() / check!(positive("square.period_s", params.period_s));
        Ok(Self {
            low: check!(finite("square.low", params.low)),
            high: check!(finite("square.high", params.high)),
            on_ratio: check!(ratio("square.on_ratio", params.on_ratio)),
            // Half a step ahead: rounds each edge to the nearest instant.
            ahead_turns: check!(ratio("square.phase_turns", params.phase_turns))
                + 0.5 * turns_per_step,
            turns_per_step,
        })
    }

    /// The value now; then time moves on by one step.
    #[inline]
    pub fn step(&self, state: &mut PhaseState, _input: ()) -> Real {
        let on = wrap_turns(state.turns.get() + self.ahead_turns) < self.on_ratio;
        turn(&mut state.turns, self.turns_per_step);
        if on { self.high } else { self.low }
    }
}

impl_model!(Square, PhaseState, (), Real);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const SINE: SineParams =
        SineParams { amplitude: 3.0, offset: 1.0, frequency_hz: 50.0, phase_turns: 0.1 };
    const SQUARE: SquareParams =
        SquareParams { low: -1.0, high: 2.0, period_s: 1e-3, on_ratio: 0.3, phase_turns: 0.0 };

    fn dt(dt_s: Real) -> Dt {
        Dt::from_s(dt_s).unwrap()
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn says_the_sine_at_the_current_instant() {
        let (sine, mut s) = (Sine::new(SINE, dt(1e-4)).unwrap(), PhaseState::default());
        for i in 0..10_000 {
            let turns = f64::from(i) * 50.0 * 1e-4 + 0.1;
            let value = 1.0 + 3.0 * (turns * core::f64::consts::TAU).sin();
            let obtained = f64::from(sine.step(&mut s, ()));
            assert!((obtained - value).abs() < 1e-4, "{i}: {obtained} against {value}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn an_hour_of_sine_drifts_by_the_rounding_of_its_step_only() {
        let (sine, mut s) = (Sine::new(SINE, dt(1e-3)).unwrap(), PhaseState::default());
        for _ in 0..3_600_000 {
            sine.step(&mut s, ());
        }
        let turns = f64::from(sine.turns_per_step) * 3.6e6;
        assert!((f64::from(s.turns.get()) - turns.fract()).abs() < 1e-6, "{s:?}");
        assert!((turns / 180_000.0 - 1.0).abs() < 1e-7, "{turns}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn every_period_has_its_share_of_high_steps() {
        for (dt_s, period) in [(1e-4, 10_usize), (1e-5, 100)] {
            for on in [0_usize, 1, 3, 5, 7, 9, 10] {
                for phase in [0_usize, 4, 10] {
                    let (on_ratio, phase_turns) = (on as Real * 0.1, phase as Real * 0.1);
                    let params = SquareParams { on_ratio, phase_turns, ..SQUARE };
                    let (square, mut s) =
                        (Square::new(params, dt(dt_s)).unwrap(), PhaseState::default());
                    let wave: Vec<_> =
                        (0..200 * period).map(|_| square.step(&mut s, ()) == 2.0).collect();
                    for (i, high) in wave.iter().enumerate() {
                        let expected = (i + phase * period / 10) % period < on * period / 10;
                        assert_eq!(*high, expected, "{dt_s} {on} {phase}: step {i}");
                    }
                }
            }
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn a_period_that_is_no_whole_number_of_steps_keeps_its_mean() {
        let params = SquareParams { period_s: 7.316_25e-4, ..SQUARE };
        let (square, mut s) = (Square::new(params, dt(1e-4)).unwrap(), PhaseState::default());
        let high = (0..1_000_000).filter(|_| square.step(&mut s, ()) == 2.0).count();
        assert!((high as Real * 1e-6 - 0.3).abs() < 1e-3, "{high}");
    }

    #[test]
    fn steps_longer_than_a_period_stay_in_range() {
        let sine = Sine::new(SineParams { frequency_hz: 1e12, ..SINE }, dt(1e12)).unwrap();
        let square = Square::new(SquareParams { period_s: 1e-12, ..SQUARE }, dt(1e12)).unwrap();
        let (mut s, mut q) = (PhaseState::default(), PhaseState::default());
        for _ in 0..100 {
            assert!((-2.001..4.001).contains(&sine.step(&mut s, ())));
            square.step(&mut q, ());
            assert!((0.0..=1.0).contains(&q.turns.get()));
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let sine = |p| Sine::new(p, dt(0.1)).unwrap_err();
        let square = |p| Square::new(p, dt(0.1)).unwrap_err();
        for bad in [Real::NAN, Real::INFINITY, -1e13] {
            for (params, error) in [
                (SineParams { amplitude: bad, ..SINE }, ParamError::NotFinite("sine.amplitude")),
                (SineParams { offset: bad, ..SINE }, ParamError::NotFinite("sine.offset")),
                (
                    SineParams { frequency_hz: bad, ..SINE },
                    ParamError::NotPositive("sine.frequency_hz"),
                ),
                (
                    SineParams { phase_turns: bad, ..SINE },
                    ParamError::NotARatio("sine.phase_turns"),
                ),
            ] {
                assert_eq!(sine(params), error);
            }
            for (params, error) in [
                (SquareParams { low: bad, ..SQUARE }, ParamError::NotFinite("square.low")),
                (SquareParams { high: bad, ..SQUARE }, ParamError::NotFinite("square.high")),
                (
                    SquareParams { period_s: bad, ..SQUARE },
                    ParamError::NotPositive("square.period_s"),
                ),
                (
                    SquareParams { on_ratio: bad, ..SQUARE },
                    ParamError::NotARatio("square.on_ratio"),
                ),
                (
                    SquareParams { phase_turns: bad, ..SQUARE },
                    ParamError::NotARatio("square.phase_turns"),
                ),
            ] {
                assert_eq!(square(params), error);
            }
        }
    }
}
