//! A drive that heats up.

use super::{Axles, Drive, DriveParams};
use crate::error::{ParamError, check};
use crate::machine::dc::{DcDrive, DcMotor, DcMotorParams};
use crate::machine::heated::{DriveThermalParams, Heated};
use crate::machine::pmsm::{Pmsm, PmsmDrive, PmsmParams};
use crate::mechanics::wheel::WheelParams;
use crate::model::Dt;
use crate::num::Real;
use crate::port::Coast;

/// Parameters of a drive whose losses heat machine and inverter; `M` are those of its machine.
///
/// ```
/// use plant_core::machine::heated::{DriveThermalParams, HeatedPartParams};
/// use plant_core::powertrain::{Drives, HeatedDriveParams, PowertrainInput};
/// use plant_core::thermal::Conductor;
/// use plant_core::{Dt, ParamError, presets};
///
/// let car = presets::BMW_I3_60AH_CONSTANT.powertrain;
/// let part = HeatedPartParams {
///     heat_capacity_j_per_k: 10e3,
///     coolant_k_per_w: 0.02,
///     derate_from_c: 120.0,
///     derate_to_c: 150.0,
/// };
/// let thermal = DriveThermalParams {
///     coolant_c: 40.0,
///     machine: part,
///     inverter: part,
///     winding: Conductor::COPPER,
/// };
/// let plant = car
///     .with_drives(HeatedDriveParams { drive: car.drives, thermal })
///     .build(Dt::from_s(1e-3)?)?;
/// let mut state = plant.at_rest(0.8)?;
/// let mut out = plant.step(&mut state, PowertrainInput::default());
/// for _ in 0..10_000 {
///     out = plant.step(&mut state, PowertrainInput::with(plant.drives().command(150.0)));
/// }
/// let warm = out.drives.temperatures;
/// assert!(warm.machine_c > 41.0 && warm.inverter_c > 40.5 && warm.left == 1.0);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct HeatedDriveParams<M = DcMotorParams> {
    /// The drive.
    pub drive: DriveParams<M>,
    /// How it heats up.
    pub thermal: DriveThermalParams,
}

impl<M: Copy> HeatedDriveParams<M> {
    /// The drive with its machine heated.
    const fn heated<K: Copy>(
        &self,
        bare: Axles<Drive<K>>,
        winding_ohm: Real,
        shaft: Coast,
        dt: Dt,
    ) -> Result<Axles<Drive<Heated<K>>>, ParamError> {
        let Drive { machine, gear_loss, torque_share } = bare.drives;
        let (thermal, converter) = (&self.thermal, self.drive.converter);
        let ratio = bare.motor_rad_per_m;
        let machine =
            check!(Heated::new(machine, thermal, winding_ohm, converter, shaft, ratio, dt));
        Ok(Axles {
            drives: Drive { machine, gear_loss, torque_share },
            coast: bare.coast,
            has_gear_loss: bare.has_gear_loss,
            constant_loss_w: bare.constant_loss_w,
            motor_rad_per_m: bare.motor_rad_per_m,
        })
    }
}

impl HeatedDriveParams<DcMotorParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(
        self,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Axles<Drive<Heated<DcDrive>>>, ParamError> {
        let bare = check!(self.drive.on(wheel, dt));
        let shaft = check!(DcMotor::new(self.drive.motor, dt)).coast();
        self.heated(bare, self.drive.motor.resistance_ohm, shaft, dt)
    }
}

impl HeatedDriveParams<PmsmParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(
        self,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Axles<Drive<Heated<PmsmDrive>>>, ParamError> {
        let bare = check!(self.drive.on(wheel, dt));
        let shaft = check!(Pmsm::new(self.drive.motor, dt)).coast();
        self.heated(bare, self.drive.motor.resistance_ohm, shaft, dt)
    }
}
