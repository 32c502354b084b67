//! What a powertrain is built from.

use crate::auxiliary::AuxiliaryParams;
use crate::battery::BatteryParams;
use crate::converter::ConverterParams;
use crate::machine::dc::DcMotorParams;
use crate::mechanics::body::BodyParams;
use crate::mechanics::gearbox::GearboxParams;
use crate::mechanics::wheel::WheelParams;

/// Parameters of a powertrain: those of its components.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct PowertrainParams<P = BatteryParams> {
    /// The battery.
    pub battery: P,
    /// What else draws from it.
    #[cfg_attr(feature = "serde", serde(default))]
    pub auxiliary: AuxiliaryParams,
    /// The converter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub converter: ConverterParams,
    /// The motor.
    pub motor: DcMotorParams,
    /// The gearbox.
    pub gearbox: GearboxParams,
    /// The wheels.
    pub wheel: WheelParams,
    /// The body.
    pub body: BodyParams,
}

impl<P: Copy> PowertrainParams<P> {
    /// The same with another battery.
    #[must_use]
    pub const fn with_battery<Q>(self, battery: Q) -> PowertrainParams<Q> {
        PowertrainParams {
            battery,
            auxiliary: self.auxiliary,
            converter: self.converter,
            motor: self.motor,
            gearbox: self.gearbox,
            wheel: self.wheel,
            body: self.body,
        }
    }
}
