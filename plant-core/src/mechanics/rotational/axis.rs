//! The angle of a shaft, `dθ/dt = ω`.
//!
//! The relation is that of \[EPowertrain2025, `RotAxis`\], without its inertia ([`RotAxis`](super::RotAxis)
//! has it); the angle in turns is ours.
//!
//! Tests: below; property `finite`; case "load on a shaft".

use crate::model::{Dt, impl_model};
use crate::num::{Accum, PI, Real, sane, wrap_turns};

/// A rigid shaft: passes speed and torque on and keeps the angle, `dθ/dt = ω`.
///
/// The angle is counted in turns and wrapped without losing what the sum keeps back, so a shaft
/// that turns for hours stays as exact as its speed and step are in `Real` (1e-7 of the turns
/// made).
///
/// ```
/// use plant_core::mechanics::rotational::{Axis, AxisInput, AxisState};
/// use plant_core::{Dt, must};
///
/// const SHAFT: Axis = Axis::new(must!(Dt::from_s(0.001)));
///
/// let mut state = AxisState::default();
/// let mut out = SHAFT.step(&mut state, AxisInput { speed_rad_s: 7.0, torque_nm: 3.0 });
/// for _ in 1..1000 {
///     out = SHAFT.step(&mut state, AxisInput { speed_rad_s: 7.0, torque_nm: 3.0 });
/// }
/// assert!((out.angle_rad - (7.0 - 6.283_185)).abs() < 1e-5); // one turn and a bit after 1 s
/// assert_eq!(out.power_w, 21.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    turns_per_rad_s: Real,
}

/// The state of an [`Axis`]; at angle zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisState {
    /// Angle in turns, within 0..1 (1 where an angle just below rounds up to it).
    pub turns: Accum,
}

/// Input of an [`Axis`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisInput {
    /// Speed over the step \[rad/s\].
    pub speed_rad_s: Real,
    /// Torque that the shaft carries \[N·m\].
    pub torque_nm: Real,
}

/// Output of one step of an [`Axis`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisOutput {
    /// Angle at the end of the step \[rad\], 0 up to, not including, 2π.
    pub angle_rad: Real,
    /// Speed \[rad/s\].
    pub speed_rad_s: Real,
    /// Torque \[N·m\].
    pub torque_nm: Real,
    /// Power that the shaft carries \[W\].
    pub power_w: Real,
    /// An input was not finite or absurd: the state is unchanged and nothing is passed on.
    pub rejected: bool,
}

impl Axis {
    /// Discretises for steps of `dt`. There is nothing to check.
    #[must_use]
    pub const fn new(dt: Dt) -> Self {
        Self { turns_per_rad_s: turns_per_rad_s(dt) }
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut AxisState, input: AxisInput) -> AxisOutput {
        let rejected = !(sane(input.speed_rad_s) && sane(input.torque_nm));
        let (mut speed_rad_s, mut torque_nm) = (0.0, 0.0);
        if !rejected {
            (speed_rad_s, torque_nm) = (input.speed_rad_s, input.torque_nm);
            turn(&mut state.turns, speed_rad_s * self.turns_per_rad_s);
        }
        AxisOutput {
            angle_rad: angle_rad(state.turns.get()),
            speed_rad_s,
            torque_nm,
            power_w: torque_nm * speed_rad_s,
            rejected,
        }
    }
}

impl_model!(Axis, AxisState, AxisInput, AxisOutput);

/// Turns made in one step at 1 rad/s.
pub(crate) const fn turns_per_rad_s(dt: Dt) -> Real {
    dt.s() / (2.0 * PI)
}

/// An angle in turns as an angle in rad, 0 up to, not including, 2π.
#[inline]
pub(crate) fn angle_rad(turns: Real) -> Real {
    2.0 * PI * wrap_turns(turns)
}

/// Turns an angle in 0..1 by `increment` turns and brings it back into 0..1, with all that the
/// sum has kept back.
#[inline]
pub(crate) fn turn(turns: &mut Accum, increment: Real) {
    // Whole turns do not matter; what is below one turn stays as it is, to the last bit.
    turns.add(if increment.abs() < 1.0 { increment } else { wrap_turns(increment) });
    let whole = if turns.since(Accum::new(1.0)) >= 0.0 {
        -1.0
    } else if turns.since(Accum::new(0.0)) < 0.0 {
        1.0
    } else {
        return;
    };
    let mut wrapped = Accum::new(whole);
    wrapped.add_sum(*turns);
    *turns = wrapped;
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn dt(dt_s: Real) -> Dt {
        Dt::from_s(dt_s).unwrap()
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn a_shaft_keeps_its_angle_for_an_hour() {
        let (axis, mut s) = (Axis::new(dt(1e-3)), AxisState::default());
        let input = AxisInput { speed_rad_s: 123.4, torque_nm: 2.0 };
        let increment = f64::from(input.speed_rad_s * axis.turns_per_rad_s);
        let mut out = axis.step(&mut s, input);
        for _ in 1..3_600_000 {
            out = axis.step(&mut s, input);
            assert!((0.0..2.0 * PI).contains(&out.angle_rad));
        }
        let turns = (increment * 3.6e6).fract();
        assert!((f64::from(s.turns.get()) - turns).abs() < 1e-5, "{s:?} against {turns}");
        assert!((f64::from(out.angle_rad) - turns * core::f64::consts::TAU).abs() < 1e-4);
        assert_eq!((out.torque_nm, out.speed_rad_s), (2.0, 123.4));
        assert!((out.power_w - 246.8).abs() < 1e-4);
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn turning_back_undoes_every_turn() {
        for increment in [1e-10, 0.37, 0.999_999_9, 17.3, 5e8] {
            let mut turns = Accum::new(0.0);
            for step in [-increment, increment, increment, -increment] {
                for _ in 0..10_000 {
                    turn(&mut turns, step);
                    assert!((0.0..=1.0).contains(&turns.get()), "{increment}: {turns:?}");
                }
            }
            let off = turns.get() - crate::num::floor(turns.get() + 0.5);
            // Above one turn an increment has its own rounding.
            let tolerance = if increment < 1.0 { 1e-10 } else { 1e-2 };
            assert!(off.abs() < tolerance, "{increment}: {turns:?}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn a_slow_shaft_does_not_stick_on_either_side_of_zero() {
        let mut turns = Accum::new(0.5);
        for _ in 0..100_000 {
            turn(&mut turns, -1e-9);
        }
        assert!((turns.get() - 0.4999).abs() < 1e-7, "{turns:?}");
        let mut turns = Accum::new(0.0);
        for _ in 0..100_000 {
            turn(&mut turns, -1e-9);
        }
        assert!((turns.get() - 0.9999).abs() < 1e-7, "{turns:?}");
    }

    #[test]
    fn a_bad_speed_does_not_turn_the_shaft() {
        let (axis, mut s) = (Axis::new(dt(1e-3)), AxisState::default());
        axis.step(&mut s, AxisInput { speed_rad_s: 5.0, torque_nm: 0.0 });
        let before = s;
        for bad in [Real::NAN, Real::INFINITY, -1e38] {
            for (speed_rad_s, torque_nm) in [(bad, 1.0), (1.0, bad)] {
                let out = axis.step(&mut s, AxisInput { speed_rad_s, torque_nm });
                assert!(out.rejected && out.power_w == 0.0 && out.angle_rad > 0.0);
            }
        }
        assert_eq!(s, before);
    }
}
