//! Vehicles: built in, or from a file.
//!
//! A file says what `plant_core::presets` says as constants: `data/vehicles/*.toml` are the
//! examples. Whatever is wrong in one is reported with its line and column.

mod conditions;
mod drives;
#[cfg(test)]
mod tests;

pub use conditions::{TripConditions, air_density_kg_m3};
pub use drives::{DriveKind, MOST_DRIVES, VehicleDrives};

use std::fmt;
use std::path::Path;

use plant_core::ParamError;
use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{BatteryParams, MappedBatteryParams};
use plant_core::control::driver::{Driver, DriverParams, TorqueDriver};
use plant_core::converter::ConverterParams;
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::heated::DriveThermalParams;
use plant_core::mechanics::body::BodyParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::mechanics::wheel::WheelParams;
use plant_core::powertrain::{PackParams, PowertrainParams};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, de};

use crate::read::battery;
use crate::read::builtin::{BuiltIn, is_toml};
use crate::read::document::{CHECK_DT, Document};
use crate::read::error::{self, InputError};
use crate::read::recognise::FileKind;
use drives::{DriveTable, PmsmTable, described};

/// Every built-in vehicle.
const BUILT_IN: BuiltIn = BuiltIn {
    kind: FileKind::Vehicle,
    files: &[
        ("bmw-i3-60ah", include_str!("../../data/vehicles/bmw-i3-60ah.toml")),
        ("bmw-i3-60ah-constant", include_str!("../../data/vehicles/bmw-i3-60ah-constant.toml")),
        (
            "bmw-i3-60ah-epowertrain",
            include_str!("../../data/vehicles/bmw-i3-60ah-epowertrain.toml"),
        ),
        ("bmw-i3-60ah-pmsm", include_str!("../../data/vehicles/bmw-i3-60ah-pmsm.toml")),
        ("bmw-i3-60ah-thermal", include_str!("../../data/vehicles/bmw-i3-60ah-thermal.toml")),
        ("epowertrain-udds", include_str!("../../data/vehicles/epowertrain-udds.toml")),
        ("epowertrain-udds-table", include_str!("../../data/vehicles/epowertrain-udds-table.toml")),
        ("two-axles", include_str!("../../data/vehicles/two-axles.toml")),
    ],
};

/// A vehicle's battery, as either model takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one per vehicle")]
pub enum VehicleBattery {
    /// Parameters that are constant.
    Constant(BatteryParams),
    /// Parameters over state of charge and temperature.
    Mapped(MappedBatteryParams),
}

impl VehicleBattery {
    /// Charge that it holds \[A·h\].
    #[must_use]
    pub const fn capacity_ah(&self) -> f32 {
        match self {
            Self::Constant(battery) => battery.capacity_ah,
            Self::Mapped(battery) => battery.capacity_ah,
        }
    }
}

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
    pub powertrain: PowertrainParams<VehicleBattery, VehicleDrives>,
    /// Who drives it.
    pub driver: DriverParams,
    /// How a measured trip acts on it; without, the air and the tyres are those of the parameters.
    pub trips: Option<TripConditions>,
}

/// A vehicle as its file is laid out.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleFile {
    name: String,
    description: String,
    source: String,
    initial_soc: f32,
    battery: BatteryField,
    #[serde(default)]
    auxiliary: AuxiliaryParams,
    converter: Option<ConverterParams>,
    motor: Option<DcMotorParams>,
    pmsm: Option<PmsmTable>,
    gearbox: Option<GearboxParams>,
    thermal: Option<DriveThermalParams>,
    #[serde(default)]
    drive: Vec<DriveTable>,
    wheel: WheelParams,
    body: BodyParams,
    driver: DriverParams,
    trips: Option<TripConditions>,
    /// What stands beside parameters that were identified.
    #[serde(default, rename = "fit")]
    _fit: Option<IgnoredAny>,
    #[serde(default, rename = "standard_error")]
    _standard_error: Option<IgnoredAny>,
}

/// Which battery a vehicle's file says it has.
enum BatteryField {
    /// A built-in one, or a file beside the vehicle's.
    Named(String),
    /// The parameters themselves.
    Inline(Box<BatteryParams>),
}

impl<'de> Deserialize<'de> for BatteryField {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(BatteryVisitor)
    }
}

/// As an untagged variant, but a fault inside the table keeps its place.
struct BatteryVisitor;

impl<'de> Visitor<'de> for BatteryVisitor {
    type Value = BatteryField;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a battery, a .toml file or a table")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<BatteryField, E> {
        Ok(BatteryField::Named(name.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<BatteryField, A::Error> {
        let battery = BatteryParams::deserialize(MapAccessDeserializer::new(table))?;
        Ok(BatteryField::Inline(Box::new(battery)))
    }
}

/// The names of the built-in vehicles.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.names()
}

/// The built-in vehicles.
#[must_use]
pub fn builtin() -> Vec<Vehicle> {
    BUILT_IN.all(parse)
}

/// A built-in vehicle by its name, or one from a file: a path that ends in `.toml` or names a
/// folder.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn load(name_or_path: &str) -> Result<Vehicle, InputError> {
    BUILT_IN.load(name_or_path, parse)
}

/// The text of a vehicle's file, built in or not, and the name that stands for it in messages.
///
/// # Errors
/// As [`load`].
pub fn text(name_or_path: &str) -> Result<(String, String), InputError> {
    BUILT_IN.load(name_or_path, |file, bytes| {
        Ok((file.to_owned(), error::text(file, bytes)?.to_owned()))
    })
}

/// As [`load`], with what the parameters were read from: the text of the vehicle's file and, where it
/// names one, of its battery's, each with what it is.
///
/// # Errors
/// As [`load`].
pub fn load_with_texts(name_or_path: &str) -> Result<(Vehicle, Vec<(String, String)>), InputError> {
    let (file, text) = text(name_or_path)?;
    let vehicle = parse(&file, text.as_bytes())?;
    let table: Option<toml::Table> = toml::from_str(&text).ok();
    let battery = table.and_then(|t| t.get("battery")?.as_str().map(str::to_owned));
    let mut texts = vec![(format!("Vehicle {}", vehicle.name), text)];
    if let Some(name) = battery {
        let text = battery::text(&battery_of(&file, &name))?;
        texts.push((format!("Battery {name}"), text));
    }
    Ok((vehicle, texts))
}

/// A vehicle from the bytes of a file; `file` is for messages.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Vehicle, InputError> {
    let document = Document::parse(file, bytes)?;
    let mut content = document.read::<VehicleFile>()?;
    if !(0.0..=1.0).contains(&content.initial_soc) {
        return Err(document.refusal("initial_soc", "must lie in 0..1"));
    }
    let several = !content.drive.is_empty();
    let drives = described(&document, &mut content)?;
    let vehicle = Vehicle {
        name: content.name,
        description: content.description,
        source: content.source,
        initial_soc: content.initial_soc,
        powertrain: PowertrainParams {
            battery: chosen(&document, file, content.battery)?,
            auxiliary: content.auxiliary,
            drives,
            wheel: content.wheel,
            body: content.body,
        },
        driver: content.driver,
        trips: content.trips,
    };
    if let Some((field, rule)) = vehicle.trips.as_ref().and_then(|t| t.check().err()) {
        return Err(document.refusal(field, rule));
    }
    check(&vehicle).map_err(|(error, drive)| {
        let field = in_file(&document, error.field(), drive.filter(|_| several));
        document.refusal(&field, error.message())
    })?;
    if vehicle.powertrain.drives.one_dc().is_none()
        && matches!(vehicle.driver, DriverParams::Duty(_))
    {
        let rule = "must drive one DC machine; others want `driver.torque`";
        return Err(document.refusal("driver.duty", rule));
    }
    Ok(vehicle)
}

/// A built-in battery, or the file beside a vehicle's.
fn battery_of(vehicle_file: &str, name: &str) -> String {
    if is_toml(name) {
        Path::new(vehicle_file).with_file_name(name).to_string_lossy().into_owned()
    } else {
        name.to_owned()
    }
}

/// The battery that a vehicle's file says it has.
fn chosen(
    document: &Document<'_>,
    vehicle_file: &str,
    field: BatteryField,
) -> Result<VehicleBattery, InputError> {
    let name = match field {
        BatteryField::Inline(battery) => return Ok(VehicleBattery::Constant(*battery)),
        BatteryField::Named(name) => name,
    };
    battery::load(&battery_of(vehicle_file, &name))
        .map(|found| VehicleBattery::Mapped(found.battery))
        .map_err(|error| {
            let place = document.refusal("battery", "cannot be used");
            InputError { message: format!("{}: {error}", place.message), ..place }
        })
}

/// Whether the models take the parameters; else what they refuse, and of which drive.
fn check(vehicle: &Vehicle) -> Result<(), (ParamError, Option<usize>)> {
    let plant = vehicle.powertrain;
    match plant.battery {
        VehicleBattery::Constant(battery) => check_with(vehicle, battery),
        VehicleBattery::Mapped(battery) => check_with(vehicle, battery),
    }
}

fn check_with(
    vehicle: &Vehicle,
    battery: impl PackParams,
) -> Result<(), (ParamError, Option<usize>)> {
    let plant = vehicle.powertrain.with_battery(battery);
    for (n, kind) in plant.drives.as_slice().iter().flatten().enumerate() {
        let built = match kind {
            DriveKind::Dc(drive) => plant.with_drives(*drive).build(CHECK_DT).err(),
            DriveKind::Pmsm(drive) => plant.with_drives(*drive).build(CHECK_DT).err(),
            DriveKind::HeatedDc(drive) => plant.with_drives(*drive).build(CHECK_DT).err(),
            DriveKind::HeatedPmsm(drive) => plant.with_drives(*drive).build(CHECK_DT).err(),
        };
        if let Some(error) = built {
            return Err((error, Some(n)));
        }
    }
    let refused = match (plant.drives.one_dc(), vehicle.driver) {
        (Some(drive), driver) => Driver::new(driver, &plant.with_drives(*drive), CHECK_DT).err(),
        // The plant's sizes do not matter to the check.
        (None, DriverParams::Torque(driver)) => {
            TorqueDriver::fitted(driver, 1.0, 1.0, 1.0, CHECK_DT).err()
        }
        (None, DriverParams::Duty(_)) => None,
    };
    refused.map_or(Ok(()), |error| Err((error, None)))
}

/// A component does not know where it stands in the file: one of several drives, a controller.
fn in_file(document: &Document<'_>, field: &str, drive: Option<usize>) -> String {
    if let Some(n) = drive
        && let Some((component, key)) = field.split_once('.')
    {
        match component {
            "converter" | "motor" | "pmsm" | "gearbox" | "thermal" => {
                return format!("drive.{n}.{field}");
            }
            "drive" => return format!("drive.{n}.{key}"),
            _ => {}
        }
    }
    let Some(key) = field.strip_prefix("pid.") else { return field.to_owned() };
    let places = ["driver.duty", "driver.torque.speed"].map(|table| format!("{table}.{key}"));
    let found = places.into_iter().find(|place| document.locate(place).is_found());
    found.unwrap_or_else(|| field.to_owned())
}
