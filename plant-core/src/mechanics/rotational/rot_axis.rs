//! A shaft with inertia: what drives it less what it drives turns it, `J·dω/dt = T_in − T_out`,
//! `dθ/dt = ω` \[EPowertrain2025, `RotAxis`\].
//!
//! Tests: below; properties `finite`, `refusal`; case "shaft with inertia".

use super::{angle_rad, turn, turns_per_rad_s};
use crate::error::{ParamError, check, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Accum, Real, sane};
use crate::port::Coast;

/// Parameters of a shaft with inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct RotAxisParams {
    /// Inertia J \[kg·m²\], above zero; a shaft without is an [`Axis`](super::Axis).
    pub inertia_kg_m2: Real,
}

/// A rigid shaft with inertia between two torques, `J·dω/dt = T_in − T_out`, with its angle,
/// discretised for one step: both follow with the new speed, so what enters less what leaves is what
/// is stored, and half of `J·Δω²` beside it.
///
/// In a chain it is its [`coast`](Self::coast).
///
/// ```
/// use plant_core::mechanics::rotational::{RotAxis, RotAxisInput, RotAxisParams, RotAxisState};
/// use plant_core::{Dt, must};
///
/// const SHAFT: RotAxis =
///     must!(RotAxis::new(RotAxisParams { inertia_kg_m2: 0.5 }, must!(Dt::from_s(0.001))));
///
/// let mut state = RotAxisState::default();
/// let mut out = SHAFT.step(&mut state, RotAxisInput { driving_nm: 12.0, load_nm: 10.0 });
/// for _ in 1..1000 {
///     out = SHAFT.step(&mut state, RotAxisInput { driving_nm: 12.0, load_nm: 10.0 });
/// }
/// assert!((out.speed_rad_s - 4.0).abs() < 1e-4); // 2 N·m for 1 s
/// assert!((out.angle_rad - 2.0).abs() < 5e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotAxis {
    inertia_kg_m2: Real,
    rad_s_per_nm: Real,
    inertia_per_h: Real,
    turns_per_rad_s: Real,
}

/// The state of a [`RotAxis`]; at rest and at angle zero by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotAxisState {
    /// Speed \[rad/s\].
    pub speed_rad_s: Accum,
    /// Angle in turns, within 0..1 (1 where an angle just below rounds up to it).
    pub turns: Accum,
}

/// Input of a [`RotAxis`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotAxisInput {
    /// Torque that drives the shaft \[N·m\].
    pub driving_nm: Real,
    /// Torque that the shaft drives \[N·m\].
    pub load_nm: Real,
}

/// Output of one step of a [`RotAxis`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RotAxisOutput {
    /// Speed at the end of the step \[rad/s\].
    pub speed_rad_s: Real,
    /// Angle at the end of the step \[rad\], 0 up to, not including, 2π.
    pub angle_rad: Real,
    /// Power that entered \[W\].
    pub driving_w: Real,
    /// Power that left \[W\].
    pub load_w: Real,
    /// Kinetic energy \[J\].
    pub kinetic_j: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl RotAxis {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] names the field that is out of range.
    pub const fn new(params: RotAxisParams, dt: Dt) -> Result<Self, ParamError> {
        let inertia_kg_m2 = check!(positive("axis.inertia_kg_m2", params.inertia_kg_m2));
        Ok(Self {
            inertia_kg_m2,
            rad_s_per_nm: dt.s() / inertia_kg_m2,
            inertia_per_h: inertia_kg_m2 / dt.s(),
            turns_per_rad_s: turns_per_rad_s(dt),
        })
    }

    /// What it adds to a chain of components: its inertia.
    #[must_use]
    pub const fn coast(&self) -> Coast {
        Coast { inertia_per_h: self.inertia_per_h, viscous: 0.0, coulomb: 0.0 }
    }

    /// Advances by one step.
    #[inline]
    pub fn step(&self, state: &mut RotAxisState, input: RotAxisInput) -> RotAxisOutput {
        let increment_rad_s = self.rad_s_per_nm * (input.driving_nm - input.load_nm);
        let rejected = !(sane(input.driving_nm)
            && sane(input.load_nm)
            && sane(state.speed_rad_s.get() + increment_rad_s));
        let (mut driving_nm, mut load_nm) = (0.0, 0.0);
        if !rejected {
            (driving_nm, load_nm) = (input.driving_nm, input.load_nm);
            state.speed_rad_s.add(increment_rad_s);
            turn(&mut state.turns, state.speed_rad_s.get() * self.turns_per_rad_s);
        }
        let speed_rad_s = state.speed_rad_s.get();
        RotAxisOutput {
            speed_rad_s,
            angle_rad: angle_rad(state.turns.get()),
            driving_w: driving_nm * speed_rad_s,
            load_w: load_nm * speed_rad_s,
            kinetic_j: 0.5 * self.inertia_kg_m2 * speed_rad_s * speed_rad_s,
            rejected,
        }
    }
}

impl_model!(RotAxis, RotAxisState, RotAxisInput, RotAxisOutput);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::num::PI;

    fn shaft(inertia_kg_m2: Real, dt_s: Real) -> RotAxis {
        RotAxis::new(RotAxisParams { inertia_kg_m2 }, Dt::from_s(dt_s).unwrap()).unwrap()
    }

    /// ω = ∫T/J, θ = ∫ω, forwards and backwards.
    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn follows_newtons_law() {
        let (axis, mut s) = (shaft(0.2, 1e-4), RotAxisState::default());
        let mut out = axis.step(&mut s, RotAxisInput { driving_nm: 0.0, load_nm: 0.0 });
        for (driving_nm, load_nm, speed) in [(3.0, 1.0, 10.0), (0.0, 4.0, -10.0), (0.0, 0.0, -10.0)]
        {
            for _ in 0..10_000 {
                out = axis.step(&mut s, RotAxisInput { driving_nm, load_nm });
            }
            assert!((out.speed_rad_s - speed).abs() < 1e-4, "{out:?}");
        }
        // 5 + (10 − 10) − 10 rad in all.
        assert!((out.angle_rad - (-5.0 + 2.0 * PI)).abs() < 2e-3, "{out:?}");
        assert!((out.kinetic_j - 0.5 * 0.2 * 100.0).abs() < 1e-3);
    }

    /// Of what enters and does not leave all is stored, less ½·J·Δω².
    #[test]
    fn energy_is_kept() {
        let (axis, mut s) = (shaft(0.5, 0.01), RotAxisState::default());
        for k in 0..200 {
            let (driving_nm, load_nm) = ([20.0, -7.0, 0.0][k % 3], 3.0);
            let before = s.speed_rad_s.get();
            let before_j = 0.5 * 0.5 * before * before;
            let out = axis.step(&mut s, RotAxisInput { driving_nm, load_nm });
            let increment = out.speed_rad_s - before;
            let numerical_j = 0.5 * 0.5 * increment * increment;
            let given_j = 0.01 * (out.driving_w - out.load_w);
            let off_j = given_j - (out.kinetic_j - before_j) - numerical_j;
            assert!(off_j.abs() < 1e-5 * (1.0 + out.kinetic_j), "{k}: {off_j} {out:?}");
        }
        assert_eq!(axis.coast(), Coast { inertia_per_h: 50.0, viscous: 0.0, coulomb: 0.0 });
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn a_small_torque_still_counts_at_high_speed() {
        let (axis, mut s) = (shaft(100.0, 1e-4), RotAxisState::default());
        s.speed_rad_s = Accum::new(1000.0);
        for _ in 0..1_000_000 {
            axis.step(&mut s, RotAxisInput { driving_nm: 0.1, load_nm: 0.0 });
        }
        assert!((s.speed_rad_s.get() - 1000.1).abs() < 1e-3, "{s:?}");
    }

    #[test]
    fn bad_input_changes_nothing_and_bad_inertia_is_refused() {
        let (axis, mut s) = (shaft(0.1, 0.01), RotAxisState::default());
        axis.step(&mut s, RotAxisInput { driving_nm: 1.0, load_nm: 0.0 });
        let before = s;
        for bad in [Real::NAN, Real::INFINITY, -1e38] {
            for (driving_nm, load_nm) in [(bad, 0.0), (0.0, bad)] {
                let out = axis.step(&mut s, RotAxisInput { driving_nm, load_nm });
                assert!(out.rejected && (out.driving_w, out.load_w) == (0.0, 0.0));
            }
        }
        assert_eq!(s, before);
        let light = shaft(1e-12, 1.0);
        assert!(light.step(&mut s, RotAxisInput { driving_nm: 1e3, load_nm: 0.0 }).rejected);
        for bad in [0.0, -1.0, Real::NAN, Real::INFINITY] {
            let refused =
                RotAxis::new(RotAxisParams { inertia_kg_m2: bad }, Dt::from_s(1.0).unwrap());
            assert_eq!(refused, Err(ParamError::NotPositive("axis.inertia_kg_m2")));
        }
    }
}
