//! Wheel: from the axle's torque to a force at the road.
//!
//! `v = R·ω`, `F = (T − f_s·ω − J·dω/dt)/R` \[EPowertrain2025, eq. 4.6 and 4.7; the print's
//! `v = 2π·R·ω` is an error that multiplies energy by 2π\]. No slip.
//!
//! Tests: below; properties `finite`, `refusal`; case "gearbox, wheel, auxiliary load".

use crate::error::{ParamError, check, not_negative, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Real, sane};
use crate::port::Coast;

/// Parameters of the wheels of an axle, taken together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct WheelParams {
    /// Rolling radius \[m\], above zero.
    pub radius_m: Real,
    /// Inertia of all wheels that turn with the road \[kg·m²\], ≥ 0.
    pub inertia_kg_m2: Real,
    /// Viscous friction of the bearings \[N·m·s/rad\], ≥ 0.
    pub viscous_nm_s_per_rad: Real,
}

/// Wheels that roll without slip, discretised for one step.
///
/// ```
/// use plant_core::mechanics::wheel::{Wheel, WheelInput, WheelParams};
/// use plant_core::{Dt, must};
///
/// const WHEEL: Wheel = must!(Wheel::new(
///     WheelParams { radius_m: 0.25, inertia_kg_m2: 0.0, viscous_nm_s_per_rad: 0.0 },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut before_m_s = 10.0;
/// let out = WHEEL.step(&mut before_m_s, WheelInput { axle_nm: 500.0, speed_m_s: 10.0 });
/// assert_eq!((out.axle_rad_s, out.force_n), (40.0, 2000.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    pub(crate) per_radius: Real,
    pub(crate) mass_kg: Real,
    pub(crate) viscous_n_s_per_m: Real,
    mass_per_h: Real,
}

/// Input of a [`Wheel`] that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelInput {
    /// Torque of the axle \[N·m\].
    pub axle_nm: Real,
    /// Speed of the road at the end of the step \[m/s\].
    pub speed_m_s: Real,
}

/// The state of a [`Wheel`] that steps on its own: the speed of the road \[m/s\].
pub type WheelState = Real;

/// Output of a [`Wheel`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WheelOutput {
    /// Speed of the axle \[rad/s\].
    pub axle_rad_s: Real,
    /// Force on the vehicle \[N\].
    pub force_n: Real,
    /// Power lost \[W\], never negative.
    pub loss_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Wheel {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: WheelParams, dt: Dt) -> Result<Self, ParamError> {
        let radius_m = check!(positive("wheel.radius_m", params.radius_m));
        let inertia = check!(not_negative("wheel.inertia_kg_m2", params.inertia_kg_m2));
        let viscous =
            check!(not_negative("wheel.viscous_nm_s_per_rad", params.viscous_nm_s_per_rad));
        let mass_kg = inertia / (radius_m * radius_m);
        Ok(Self {
            per_radius: 1.0 / radius_m,
            mass_kg,
            viscous_n_s_per_m: viscous / (radius_m * radius_m),
            mass_per_h: mass_kg / dt.s(),
        })
    }

    /// Speed of the axle at a road speed \[rad/s\].
    #[inline]
    #[must_use]
    pub const fn axle_rad_s(&self, speed_m_s: Real) -> Real {
        self.per_radius * speed_m_s
    }

    /// What resists at the road, given what does at the axle.
    #[must_use]
    pub const fn coast(&self, axle: Coast) -> Coast {
        axle.reflected(self.per_radius).plus(Coast {
            inertia_per_h: self.mass_per_h,
            viscous: self.viscous_n_s_per_m,
            coulomb: 0.0,
        })
    }

    /// Advances by one step on its own, the road's speed imposed.
    #[inline]
    pub fn step(&self, state: &mut WheelState, input: WheelInput) -> WheelOutput {
        let at = |axle_nm: Real, v: Real| {
            let viscous_n = self.viscous_n_s_per_m * v;
            let inertia_n = self.mass_per_h * (v - *state);
            (self.per_radius * axle_nm - viscous_n - inertia_n, viscous_n * v)
        };
        let (mut force_n, mut loss_w) = at(input.axle_nm, input.speed_m_s);
        let finite = force_n.is_finite() && loss_w.is_finite();
        let rejected = !(sane(input.axle_nm) && sane(input.speed_m_s) && finite);
        if rejected {
            loss_w = self.viscous_n_s_per_m * *state * *state;
            force_n = -self.viscous_n_s_per_m * *state;
        } else {
            *state = input.speed_m_s;
        }
        WheelOutput { axle_rad_s: self.axle_rad_s(*state), force_n, loss_w, rejected }
    }
}

impl_model!(Wheel, WheelState, WheelInput, WheelOutput);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const PARAMS: WheelParams =
        WheelParams { radius_m: 0.35, inertia_kg_m2: 1.2, viscous_nm_s_per_rad: 0.05 };

    fn wheel(params: WheelParams) -> Wheel {
        Wheel::new(params, Dt::from_s(0.01).unwrap()).unwrap()
    }

    #[test]
    fn conserves_power_at_constant_speed() {
        let (w, mut s) = (wheel(PARAMS), 20.0);
        let out = w.step(&mut s, WheelInput { axle_nm: 300.0, speed_m_s: 20.0 });
        let balance = 300.0 * out.axle_rad_s - out.force_n * 20.0 - out.loss_w;
        assert!(balance.abs() < 0.01, "{balance}");
        assert!((out.axle_rad_s - 20.0 / 0.35).abs() < 1e-4);
        assert!((out.loss_w - 0.05 * out.axle_rad_s * out.axle_rad_s).abs() < 0.01);
    }

    #[test]
    fn its_coast_says_the_same_as_the_step() {
        let (w, mut s) = (wheel(PARAMS), 20.0);
        let coast = w.coast(Coast { inertia_per_h: 0.0, viscous: 0.0, coulomb: 7.0 });
        let out = w.step(&mut s, WheelInput { axle_nm: 300.0, speed_m_s: 20.1 });
        let by_coast = 300.0 / 0.35 - coast.inertia_per_h * 0.1 - coast.viscous * 20.1;
        assert!((by_coast - out.force_n).abs() < 0.01, "{by_coast} {}", out.force_n);
        assert!((coast.coulomb - 20.0).abs() < 1e-4);
    }

    #[test]
    fn bad_input_changes_nothing() {
        let (w, mut s) = (wheel(PARAMS), 20.0);
        for (axle_nm, speed_m_s) in
            [(Real::NAN, 1.0), (1.0, Real::INFINITY), (1e10, 1.0), (1.0, 1e10)]
        {
            let out = w.step(&mut s, WheelInput { axle_nm, speed_m_s });
            assert!(out.rejected && s == 20.0);
            // It rolls on: only the bearings are felt.
            let viscous_n = 0.05 * 20.0 / (0.35 * 0.35);
            assert!((out.force_n + viscous_n).abs() < 1e-3, "{out:?}");
            assert!((out.loss_w - viscous_n * 20.0).abs() < 1e-2, "{out:?}");
            assert!((out.axle_rad_s - 20.0 / 0.35).abs() < 1e-4);
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |p| Wheel::new(p, Dt::from_s(0.01).unwrap()).unwrap_err();
        for bad in [-1.0, Real::NAN, Real::INFINITY] {
            assert_eq!(
                refused(WheelParams { radius_m: bad, ..PARAMS }),
                ParamError::NotPositive("wheel.radius_m")
            );
            assert_eq!(
                refused(WheelParams { inertia_kg_m2: bad, ..PARAMS }),
                ParamError::Negative("wheel.inertia_kg_m2")
            );
            assert_eq!(
                refused(WheelParams { viscous_nm_s_per_rad: bad, ..PARAMS }),
                ParamError::Negative("wheel.viscous_nm_s_per_rad")
            );
        }
    }
}
