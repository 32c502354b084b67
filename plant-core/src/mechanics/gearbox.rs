//! Gearbox: a ratio, an efficiency, an inertia.
//!
//! `ω_motor = ratio·ω_wheel`, `T_wheel = ratio·T_motor` \[EPowertrain2025, `Gearbox`, its
//! N = 1/ratio\], less the loss and the inertia, which are ours. The loss acts as Coulomb friction
//! `(1 − η)·ratio·|T_motor|`, so that it opposes the motion whichever direction the power flows in.
//!
//! Tests: below; properties `finite`, `refusal`; case "gearbox, wheel, auxiliary load".

use crate::error::{ParamError, check, efficiency, not_negative, positive};
use crate::model::{Dt, impl_model};
use crate::num::{Real, sane};
use crate::port::Coast;

/// Parameters of a gearbox.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct GearboxParams {
    /// Motor turns per wheel turn, above zero.
    pub ratio: Real,
    /// Share η of the motor's torque that gets through, above 0 and up to 1. Backwards, the share of
    /// the wheel's is `1/(2 − η)`: the friction is the same.
    pub efficiency: Real,
    /// Inertia of the gears, as felt at the motor's side \[kg·m²\], ≥ 0.
    pub inertia_kg_m2: Real,
}

impl GearboxParams {
    /// Direct drive.
    pub const NONE: Self = Self { ratio: 1.0, efficiency: 1.0, inertia_kg_m2: 0.0 };
}

/// A rigid gearbox, discretised for one step.
///
/// ```
/// use plant_core::mechanics::gearbox::{Gearbox, GearboxInput, GearboxParams};
/// use plant_core::{Dt, must};
///
/// const GEARBOX: Gearbox = must!(Gearbox::new(
///     GearboxParams { ratio: 10.0, efficiency: 0.95, inertia_kg_m2: 0.0 },
///     must!(Dt::from_s(0.01)),
/// ));
///
/// let mut before_rad_s = 50.0;
/// let input = GearboxInput { motor_nm: 20.0, wheel_rad_s: 50.0 };
/// let out = GEARBOX.step(&mut before_rad_s, input);
/// assert_eq!(out.motor_rad_s, 500.0);
/// assert!((out.wheel_nm - 190.0).abs() < 1e-3);
/// assert!((out.loss_w - 0.05 * 20.0 * 500.0).abs() < 0.01); // 5 % of 10 kW
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gearbox {
    pub(crate) ratio: Real,
    ratio_squared: Real,
    pub(crate) loss_ratio: Real,
    pub(crate) inertia_kg_m2: Real,
    inertia_per_h: Real,
}

/// Input of a [`Gearbox`] that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GearboxInput {
    /// Torque of the motor's shaft \[N·m\].
    pub motor_nm: Real,
    /// Speed of the wheel's shaft at the end of the step \[rad/s\].
    pub wheel_rad_s: Real,
}

/// The state of a [`Gearbox`] that steps on its own: the speed of the wheel's shaft \[rad/s\].
pub type GearboxState = Real;

/// Output of a [`Gearbox`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GearboxOutput {
    /// Speed of the motor's shaft \[rad/s\].
    pub motor_rad_s: Real,
    /// Torque left at the wheel's shaft \[N·m\].
    pub wheel_nm: Real,
    /// Power lost \[W\], never negative.
    pub loss_w: Real,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Gearbox {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: GearboxParams, dt: Dt) -> Result<Self, ParamError> {
        let ratio = check!(positive("gearbox.ratio", params.ratio));
        let efficiency = check!(efficiency("gearbox.efficiency", params.efficiency));
        let inertia_kg_m2 = check!(not_negative("gearbox.inertia_kg_m2", params.inertia_kg_m2));
        Ok(Self {
            ratio,
            ratio_squared: ratio * ratio,
            loss_ratio: (1.0 - efficiency) * ratio,
            inertia_kg_m2,
            inertia_per_h: inertia_kg_m2 / dt.s(),
        })
    }

    /// What resists at the wheel's shaft, given what does at the motor's.
    #[must_use]
    pub const fn coast(&self, motor: Coast) -> Coast {
        let gears = Coast { inertia_per_h: self.inertia_per_h, viscous: 0.0, coulomb: 0.0 };
        motor.plus(gears).reflected(self.ratio)
    }

    /// The loss as friction at the wheel's shaft, per torque of the motor's.
    #[must_use]
    pub const fn loss_ratio(&self) -> Real {
        self.loss_ratio
    }

    /// Advances by one step on its own, the wheel's speed imposed.
    #[inline]
    pub fn step(&self, state: &mut GearboxState, input: GearboxInput) -> GearboxOutput {
        let inertia_nm = self.ratio_squared * (self.inertia_per_h * (input.wheel_rad_s - *state));
        let rejected = !(sane(input.motor_nm) && sane(input.wheel_rad_s) && inertia_nm.is_finite());
        let (motor_nm, wheel_rad_s) =
            if rejected { (0.0, *state) } else { (input.motor_nm, input.wheel_rad_s) };
        let inertia_nm = if rejected { 0.0 } else { inertia_nm };
        let loss_nm = self.loss_ratio * motor_nm.abs() * crate::num::sign(wheel_rad_s);
        *state = wheel_rad_s;
        GearboxOutput {
            motor_rad_s: self.ratio * wheel_rad_s,
            wheel_nm: self.ratio * motor_nm - loss_nm - inertia_nm,
            loss_w: loss_nm * wheel_rad_s,
            rejected,
        }
    }
}

impl_model!(Gearbox, GearboxState, GearboxInput, GearboxOutput);

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const PARAMS: GearboxParams =
        GearboxParams { ratio: 9.665, efficiency: 0.97, inertia_kg_m2: 0.002 };

    fn gearbox(params: GearboxParams) -> Gearbox {
        Gearbox::new(params, Dt::from_s(0.01).unwrap()).unwrap()
    }

    #[test]
    fn trades_speed_for_torque_and_loses_its_share_both_ways() {
        let g = gearbox(PARAMS);
        for (motor_nm, wheel) in [(100.0, 50.0), (-100.0, 50.0), (100.0, -50.0)] {
            let mut s = wheel;
            let out = g.step(&mut s, GearboxInput { motor_nm, wheel_rad_s: wheel });
            let power_in = motor_nm * out.motor_rad_s;
            assert!((out.motor_rad_s - 9.665 * wheel).abs() < 1e-3);
            assert!((out.loss_w - 0.03 * power_in.abs()).abs() < 1e-1, "{}", out.loss_w);
            assert!((power_in - out.wheel_nm * wheel - out.loss_w).abs() < 0.1);
        }
    }

    #[test]
    fn it_loses_nothing_at_standstill() {
        let out = gearbox(PARAMS).step(&mut 0.0, GearboxInput { motor_nm: 9.0, wheel_rad_s: 0.0 });
        assert_eq!((out.wheel_nm, out.loss_w), (9.665 * 9.0, 0.0));
    }

    #[test]
    fn its_inertia_is_felt_when_it_speeds_up() {
        let (g, mut s) = (gearbox(GearboxParams { efficiency: 1.0, ..PARAMS }), 0.0);
        let out = g.step(&mut s, GearboxInput { motor_nm: 0.0, wheel_rad_s: 1.0 });
        assert!((out.wheel_nm + 0.002 * 9.665 * 9.665 / 0.01).abs() < 1e-3);
        assert_eq!(s, 1.0);
    }

    #[test]
    fn its_coast_says_the_same_as_the_step() {
        let (g, mut s) = (gearbox(PARAMS), 20.0);
        let coast = g.coast(Coast { inertia_per_h: 0.1, viscous: 0.01, coulomb: 0.3 });
        let out = g.step(&mut s, GearboxInput { motor_nm: 80.0, wheel_rad_s: 20.5 });
        let by_coast = 9.665 * 80.0
            - (coast.inertia_per_h - 0.1 * 9.665 * 9.665) * 0.5
            - g.loss_ratio() * 80.0;
        assert!((by_coast - out.wheel_nm).abs() < 1e-2, "{by_coast} {}", out.wheel_nm);
        assert!((coast.viscous - 0.01 * 9.665 * 9.665).abs() < 1e-5);
        assert!((coast.coulomb - 0.3 * 9.665).abs() < 1e-5);
    }

    #[test]
    fn bad_input_changes_nothing() {
        let (g, mut s) = (gearbox(PARAMS), 20.0);
        for (motor_nm, wheel_rad_s) in [(Real::NAN, 1.0), (1.0, 1e38)] {
            let out = g.step(&mut s, GearboxInput { motor_nm, wheel_rad_s });
            assert!(out.rejected && out.wheel_nm == 0.0 && s == 20.0);
            assert_eq!((out.motor_rad_s, out.loss_w), (9.665 * 20.0, 0.0));
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |p| Gearbox::new(p, Dt::from_s(0.01).unwrap()).unwrap_err();
        for bad in [0.0, -1.0, Real::NAN] {
            assert_eq!(
                refused(GearboxParams { ratio: bad, ..PARAMS }),
                ParamError::NotPositive("gearbox.ratio")
            );
            assert_eq!(
                refused(GearboxParams { efficiency: bad, ..PARAMS }),
                ParamError::NotAnEfficiency("gearbox.efficiency")
            );
        }
        assert_eq!(
            refused(GearboxParams { inertia_kg_m2: -1.0, ..PARAMS }),
            ParamError::Negative("gearbox.inertia_kg_m2")
        );
    }
}
