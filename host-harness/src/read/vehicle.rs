//! Vehicles: built in, or from a file.
//!
//! A file says what `plant_core::presets` says as constants: `data/vehicles/*.toml` are the
//! examples. Whatever is wrong in one is reported with its line and column.

pub(crate) mod document;
mod fault;
#[cfg(test)]
mod tests;

use std::path::Path;

use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{BatteryParams, MappedBatteryParams};
use plant_core::control::driver::{Driver, DriverParams};
use plant_core::converter::ConverterParams;
use plant_core::machine::dc::DcMotorParams;
use plant_core::mechanics::body::BodyParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{Powertrain, PowertrainParams};
use plant_core::{Dt, ParamError, must};
use serde::Deserialize;

use crate::read::battery;
use crate::read::error::{self, InputError, listed, nearest, shown};
use document::Document;

/// The step for which parameters are checked; which are sound does not depend on it.
const CHECK_DT: Dt = must!(Dt::from_s(0.001));

/// Every built-in vehicle: its name and its file.
const BUILT_IN: [(&str, &str); 4] = [
    ("bmw-i3-60ah", include_str!("../../data/vehicles/bmw-i3-60ah.toml")),
    ("bmw-i3-60ah-epowertrain", include_str!("../../data/vehicles/bmw-i3-60ah-epowertrain.toml")),
    ("epowertrain-udds", include_str!("../../data/vehicles/epowertrain-udds.toml")),
    ("epowertrain-udds-table", include_str!("../../data/vehicles/epowertrain-udds-table.toml")),
];

/// A vehicle with its driver; its parameters are sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Its name.
    pub name: String,
    /// What it is, in one line.
    pub description: String,
    /// Where its values come from.
    pub source: String,
    /// State of charge at the start of a cycle, 0..1.
    pub initial_soc: f32,
    /// The plant.
    pub powertrain: PowertrainParams,
    /// The battery that takes the place of the plant's constant one.
    pub battery_map: Option<MappedBatteryParams>,
    /// Who drives it.
    pub driver: DriverParams,
}

impl Vehicle {
    /// Charge that its battery holds \[A·h\].
    #[must_use]
    pub fn capacity_ah(&self) -> f32 {
        self.battery_map.map_or(self.powertrain.battery.capacity_ah, |map| map.capacity_ah)
    }
}

/// A vehicle as its file is laid out.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleFile {
    name: String,
    description: String,
    source: String,
    initial_soc: f32,
    #[serde(default)]
    battery_map: Option<String>,
    battery: BatteryParams,
    #[serde(default)]
    auxiliary: AuxiliaryParams,
    #[serde(default)]
    converter: ConverterParams,
    motor: DcMotorParams,
    gearbox: GearboxParams,
    wheel: WheelParams,
    body: BodyParams,
    driver: DriverParams,
}

impl From<VehicleFile> for Vehicle {
    fn from(file: VehicleFile) -> Self {
        Self {
            name: file.name,
            description: file.description,
            source: file.source,
            initial_soc: file.initial_soc,
            powertrain: PowertrainParams {
                battery: file.battery,
                auxiliary: file.auxiliary,
                converter: file.converter,
                motor: file.motor,
                gearbox: file.gearbox,
                wheel: file.wheel,
                body: file.body,
            },
            battery_map: None,
            driver: file.driver,
        }
    }
}

/// The names of the built-in vehicles.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.iter().map(|(name, _)| *name)
}

/// The built-in vehicles.
#[must_use]
pub fn builtin() -> Vec<Vehicle> {
    BUILT_IN.iter().filter_map(|(name, text)| parse(name, text.as_bytes()).ok()).collect()
}

/// A built-in vehicle by its name, or one from a file: a path that ends in `.toml` or names a
/// folder.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn load(name_or_path: &str) -> Result<Vehicle, InputError> {
    if let Some((name, text)) = BUILT_IN.iter().find(|(name, _)| *name == name_or_path) {
        return parse(name, text.as_bytes());
    }
    let path = Path::new(name_or_path);
    let is_path = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
        || name_or_path.contains(std::path::is_separator);
    if is_path {
        return parse(name_or_path, &error::read(path)?);
    }
    let near = nearest(name_or_path, names())
        .map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    let message = format!(
        "no such vehicle{near} (built in: {}; or the path of a .toml file)",
        listed(names())
    );
    Err(InputError::of_file(&shown(name_or_path), message))
}

/// A vehicle from the bytes of a file; `file` is for messages.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Vehicle, InputError> {
    let document = Document::parse(file, bytes)?;
    let content = document.read::<VehicleFile>()?;
    let battery_map = content.battery_map.as_deref().map(|name| mapped(file, name)).transpose();
    let battery_map = battery_map.map_err(|error| {
        let place = document.refusal("battery_map", "cannot be used");
        InputError { message: format!("{}: {error}", place.message), ..place }
    })?;
    let vehicle = Vehicle { battery_map, ..Vehicle::from(content) };
    if !(0.0..=1.0).contains(&vehicle.initial_soc) {
        return Err(document.refusal("initial_soc", "must lie in 0..1"));
    }
    check(&vehicle).map_err(|error| {
        let field = in_file(&document, error.field());
        document.refusal(&field, error.message())
    })?;
    Ok(vehicle)
}

/// The battery that a vehicle's file names: built in, or a file beside it.
fn mapped(vehicle_file: &str, name: &str) -> Result<MappedBatteryParams, InputError> {
    let beside = Path::new(vehicle_file).with_file_name(name);
    let is_file = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let found =
        if is_file { battery::load(&beside.to_string_lossy())? } else { battery::load(name)? };
    Ok(found.battery)
}

/// Whether the models take the parameters.
fn check(vehicle: &Vehicle) -> Result<(), ParamError> {
    Powertrain::new(vehicle.powertrain, CHECK_DT)?;
    Driver::new(vehicle.driver, &vehicle.powertrain, CHECK_DT)?;
    Ok(())
}

/// A controller does not know where it stands in the file.
fn in_file(document: &Document<'_>, field: &str) -> String {
    let Some(key) = field.strip_prefix("pid.") else { return field.to_owned() };
    let places = ["driver.duty", "driver.torque.speed"].map(|table| format!("{table}.{key}"));
    let found = places.into_iter().find(|place| document.locate(place).is_found());
    found.unwrap_or_else(|| field.to_owned())
}
