//! What a powertrain is built from.

use super::Powertrain;
use super::drives::{Axles, Drive, DriveParams, Drives, HeatedDriveParams};
use super::ledger::NoLedger;
use crate::auxiliary::AuxiliaryParams;
use crate::battery::{Battery, BatteryParams, MappedBattery, MappedBatteryParams, Pack};
use crate::error::ParamError;
use crate::machine::dc::{DcDrive, DcMotorParams};
use crate::machine::heated::Heated;
use crate::machine::pmsm::{PmsmDrive, PmsmParams};
use crate::mechanics::body::BodyParams;
use crate::mechanics::wheel::WheelParams;
use crate::model::Dt;

/// Parameters of a powertrain: those of its components. `P` are the battery's; `D` those of one
/// drive, or of several: `(D, E)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PowertrainParams<P = BatteryParams, D = DriveParams> {
    /// The battery.
    pub battery: P,
    /// What else draws from it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub auxiliary: AuxiliaryParams,
    /// Converter, machine and gearbox.
    pub drives: D,
    /// The wheels.
    pub wheel: WheelParams,
    /// The body.
    pub body: BodyParams,
}

impl<P: Copy, D: Copy> PowertrainParams<P, D> {
    /// The same with another battery.
    #[must_use]
    pub const fn with_battery<Q>(self, battery: Q) -> PowertrainParams<Q, D> {
        PowertrainParams {
            battery,
            auxiliary: self.auxiliary,
            drives: self.drives,
            wheel: self.wheel,
            body: self.body,
        }
    }

    /// The same with other drives.
    #[must_use]
    pub const fn with_drives<E>(self, drives: E) -> PowertrainParams<P, E> {
        PowertrainParams {
            battery: self.battery,
            auxiliary: self.auxiliary,
            drives,
            wheel: self.wheel,
            body: self.body,
        }
    }
}

/// Parameters of a battery, whichever model it is.
pub trait PackParams: Copy {
    /// The model.
    type Pack: Pack;
    /// Checks the parameters and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    fn pack(self, dt: Dt) -> Result<Self::Pack, ParamError>;
    /// Charge that it holds \[A·h\].
    fn capacity_ah(&self) -> crate::Real;
}

impl PackParams for BatteryParams {
    type Pack = Battery;
    fn pack(self, dt: Dt) -> Result<Battery, ParamError> {
        Battery::new(self, dt)
    }
    fn capacity_ah(&self) -> crate::Real {
        self.capacity_ah
    }
}

impl PackParams for MappedBatteryParams {
    type Pack = MappedBattery;
    fn pack(self, dt: Dt) -> Result<MappedBattery, ParamError> {
        MappedBattery::new(self, dt)
    }
    fn capacity_ah(&self) -> crate::Real {
        self.capacity_ah
    }
}

/// Parameters of one drive, or of several.
pub trait DrivesParams: Copy {
    /// The drives.
    type Drives: Drives;
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Self::Drives>, ParamError>;
}

impl DrivesParams for DriveParams<DcMotorParams> {
    type Drives = Drive<DcDrive>;
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Drive<DcDrive>>, ParamError> {
        self.on(wheel, dt)
    }
}

impl DrivesParams for DriveParams<PmsmParams> {
    type Drives = Drive<PmsmDrive>;
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Drive<PmsmDrive>>, ParamError> {
        self.on(wheel, dt)
    }
}

impl DrivesParams for HeatedDriveParams<DcMotorParams> {
    type Drives = Drive<Heated<DcDrive>>;
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Self::Drives>, ParamError> {
        self.on(wheel, dt)
    }
}

impl DrivesParams for HeatedDriveParams<PmsmParams> {
    type Drives = Drive<Heated<PmsmDrive>>;
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Self::Drives>, ParamError> {
        self.on(wheel, dt)
    }
}

impl<A: DrivesParams, B: DrivesParams> DrivesParams for (A, B) {
    type Drives = (A::Drives, B::Drives);
    fn axles(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Self::Drives>, ParamError> {
        Ok(self.0.axles(wheel, dt)?.and(self.1.axles(wheel, dt)?))
    }
}

/// The plant of some parameters.
type Plant<P, D> = Powertrain<NoLedger, <P as PackParams>::Pack, <D as DrivesParams>::Drives>;

impl<P: PackParams, D: DrivesParams> PowertrainParams<P, D> {
    /// The plant that these parameters describe, for steps of `dt`.
    ///
    /// [`Powertrain::new`] and [`Powertrain::of`] do the same in a constant.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub fn build(self, dt: Dt) -> Result<Plant<P, D>, ParamError> {
        Powertrain::of(self.battery.pack(dt)?, self.drives.axles(self.wheel, dt)?, &self, dt)
    }
}
