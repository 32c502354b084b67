//! Drives that a vehicle's file chooses: each one of two kinds, told apart at run time.

use plant_core::machine::dc::DcDrive;
use plant_core::machine::pmsm::PmsmDrive;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{Axles, Drive, DrivesParams, Either};
use plant_core::{Dt, ParamError};

use crate::read::vehicle::DriveKind;

/// A drive of either kind.
pub type AnyDrive = Either<Drive<DcDrive>, Drive<PmsmDrive>>;

/// The drive that a file describes.
///
/// # Errors
/// A parameter that is out of range.
pub fn axle(kind: DriveKind, wheel: WheelParams, dt: Dt) -> Result<Axles<AnyDrive>, ParamError> {
    match kind {
        DriveKind::Dc(params) => Ok(params.axles(wheel, dt)?.map(Either::One)),
        DriveKind::Pmsm(params) => Ok(params.axles(wheel, dt)?.map(Either::Other)),
    }
}
