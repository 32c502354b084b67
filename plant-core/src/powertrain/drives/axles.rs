//! A machine with its converter and its gearbox, and drives on one road.

use crate::converter::ConverterParams;
use crate::error::{ParamError, check, positive};
use crate::machine::dc::{DcDrive, DcMotor, DcMotorParams};
use crate::machine::pmsm::{Pmsm, PmsmDrive, PmsmParams};
use crate::mechanics::gearbox::{Gearbox, GearboxParams};
use crate::mechanics::wheel::{Wheel, WheelParams};
use crate::model::Dt;
use crate::num::Real;
use crate::port::Coast;

/// Parameters of a drive; `M` are those of its machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DriveParams<M = DcMotorParams> {
    /// The converter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub converter: ConverterParams,
    /// The machine.
    pub motor: M,
    /// The gearbox.
    pub gearbox: GearboxParams,
    /// Bandwidth of the ideal current loop behind [`Gates::Torque`](crate::converter::Gates::Torque) \[1/s\], above zero.
    #[cfg_attr(feature = "serde", serde(default = "default_torque_rate"))]
    pub torque_rate_per_s: Real,
    /// Of a driver's demand this drive takes its share, in proportion to those of the others, above
    /// zero.
    #[cfg_attr(feature = "serde", serde(default = "default_share"))]
    pub torque_share: Real,
}

/// Of a current loop as drives have it: 80 Hz \[1/s\].
pub const TORQUE_RATE_PER_S: Real = 500.0;

#[cfg(feature = "serde")]
fn default_torque_rate() -> Real {
    TORQUE_RATE_PER_S
}

#[cfg(feature = "serde")]
fn default_share() -> Real {
    1.0
}

impl<M> DriveParams<M> {
    /// A machine behind an ideal converter and a gearbox.
    #[must_use]
    pub const fn new(motor: M, gearbox: GearboxParams) -> Self {
        Self {
            converter: ConverterParams::IDEAL,
            motor,
            gearbox,
            torque_rate_per_s: TORQUE_RATE_PER_S,
            torque_share: 1.0,
        }
    }
}

/// A machine with its converter and its gearbox at the road, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<M = DcDrive> {
    pub(super) machine: M,
    /// Loss of the gears as friction at the road, per force.
    pub(super) gear_loss: Real,
    pub(super) torque_share: Real,
}

/// Drives on one road with what they add to all that moves and rubs there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axles<D> {
    pub(in crate::powertrain) drives: D,
    /// At the shaft of the wheels.
    pub(in crate::powertrain) coast: Coast,
    pub(in crate::powertrain) has_gear_loss: bool,
    /// Losses of the converters that do not depend on their load \[W\].
    pub(in crate::powertrain) constant_loss_w: Real,
    /// Turns of the first motor (rad) per metre of road.
    pub(super) motor_rad_per_m: Real,
}

impl<D: Copy> Axles<D> {
    /// These drives and others on the same road.
    #[must_use]
    pub const fn and<E: Copy>(self, others: Axles<E>) -> Axles<(D, E)> {
        Axles {
            drives: (self.drives, others.drives),
            coast: self.coast.plus(others.coast),
            has_gear_loss: self.has_gear_loss || others.has_gear_loss,
            constant_loss_w: self.constant_loss_w + others.constant_loss_w,
            motor_rad_per_m: self.motor_rad_per_m,
        }
    }
}

impl<D> Axles<D> {
    /// Turns of the first motor (rad) per metre of road, as
    /// [`Drives::motor_rad_per_m`](super::Drives::motor_rad_per_m) says, but for constants too.
    #[must_use]
    pub const fn motor_rad_per_m(&self) -> Real {
        self.motor_rad_per_m
    }

    /// The same axles, their drives told apart otherwise, as where a file says which there are.
    #[must_use]
    pub fn map<E>(self, drives: impl FnOnce(D) -> E) -> Axles<E> {
        Axles {
            drives: drives(self.drives),
            coast: self.coast,
            has_gear_loss: self.has_gear_loss,
            constant_loss_w: self.constant_loss_w,
            motor_rad_per_m: self.motor_rad_per_m,
        }
    }
}

/// What a drive is made of beside its machine.
struct Chain {
    converter: ConverterParams,
    gearbox: Gearbox,
    /// Motor turns (rad) per metre of road.
    motor_rad_per_m: Real,
}

impl Chain {
    const fn new(
        converter: ConverterParams,
        gearbox: GearboxParams,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let gearbox = check!(Gearbox::new(gearbox, dt));
        let wheel = check!(Wheel::new(wheel, dt));
        Ok(Self { converter, gearbox, motor_rad_per_m: gearbox.ratio * wheel.per_radius })
    }

    const fn axles<M: Copy>(
        &self,
        machine: M,
        shaft: Coast,
        torque_share: Real,
    ) -> Axles<Drive<M>> {
        let gear_loss = self.gearbox.loss_ratio() / self.gearbox.ratio;
        Axles {
            drives: Drive { machine, gear_loss, torque_share },
            coast: self.gearbox.coast(shaft),
            has_gear_loss: self.gearbox.loss_ratio() > 0.0,
            constant_loss_w: self.converter.constant_loss_w,
            motor_rad_per_m: self.motor_rad_per_m,
        }
    }
}

impl DriveParams<DcMotorParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Drive<DcDrive>>, ParamError> {
        let chain = check!(Chain::new(self.converter, self.gearbox, wheel, dt));
        let rate = check!(positive("drive.torque_rate_per_s", self.torque_rate_per_s));
        let motor = check!(DcMotor::new(self.motor, dt));
        let machine =
            check!(DcDrive::new(&self.motor, self.converter, rate, chain.motor_rad_per_m, dt));
        let share = check!(positive("drive.torque_share", self.torque_share));
        Ok(chain.axles(machine, motor.coast(), share))
    }
}

impl DriveParams<PmsmParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(
        self,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Axles<Drive<PmsmDrive>>, ParamError> {
        let chain = check!(Chain::new(self.converter, self.gearbox, wheel, dt));
        let rate = check!(positive("drive.torque_rate_per_s", self.torque_rate_per_s));
        let share = check!(positive("drive.torque_share", self.torque_share));
        let motor = check!(Pmsm::new(self.motor, dt));
        let ratio = chain.motor_rad_per_m;
        let machine = check!(PmsmDrive::new(&self.motor, self.converter, rate, ratio, dt));
        Ok(chain.axles(machine, motor.coast(), share))
    }
}
