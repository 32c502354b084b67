//! Drives that a vehicle's file chooses: each one of four kinds, told apart at run time.

use plant_core::machine::dc::DcDrive;
use plant_core::machine::heated::Heated;
use plant_core::machine::pmsm::PmsmDrive;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{Axles, Drive, DrivesParams, Either};
use plant_core::{Dt, ParamError};

use crate::read::vehicle::DriveKind;

/// A drive of any kind: as it is, or with temperatures.
pub type AnyDrive = Either<
    Either<Drive<DcDrive>, Drive<PmsmDrive>>,
    Either<Drive<Heated<DcDrive>>, Drive<Heated<PmsmDrive>>>,
>;

/// The drive that a file describes.
///
/// # Errors
/// A parameter that is out of range.
pub fn axle(kind: DriveKind, wheel: WheelParams, dt: Dt) -> Result<Axles<AnyDrive>, ParamError> {
    match kind {
        DriveKind::Dc(params) => {
            Ok(params.axles(wheel, dt)?.map(|drive| Either::One(Either::One(drive))))
        }
        DriveKind::Pmsm(params) => {
            Ok(params.axles(wheel, dt)?.map(|drive| Either::One(Either::Other(drive))))
        }
        DriveKind::HeatedDc(params) => {
            Ok(params.axles(wheel, dt)?.map(|drive| Either::Other(Either::One(drive))))
        }
        DriveKind::HeatedPmsm(params) => {
            Ok(params.axles(wheel, dt)?.map(|drive| Either::Other(Either::Other(drive))))
        }
    }
}
