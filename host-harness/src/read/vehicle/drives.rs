//! The drives of a vehicle, as its file lays them out: one at the top, or a list.

use std::sync::Mutex;

use plant_core::converter::ConverterParams;
use plant_core::machine::dc::DcMotorParams;
use plant_core::machine::flux::{Flux, FluxAxis, FluxMap, LinearFlux};
use plant_core::machine::heated::DriveThermalParams;
use plant_core::machine::pmsm::PmsmParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::{DriveParams, HeatedDriveParams};
use serde::Deserialize;

use super::VehicleFile;
use crate::read::document::Document;
use crate::read::error::InputError;

/// A drive, whichever machine it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveKind {
    /// A DC machine.
    Dc(DriveParams),
    /// A permanent-magnet synchronous machine.
    Pmsm(DriveParams<PmsmParams>),
    /// A DC machine that heats up with its converter.
    HeatedDc(HeatedDriveParams),
    /// A synchronous machine that heats up with its inverter.
    HeatedPmsm(HeatedDriveParams<PmsmParams>),
}

/// The most drives that a file may describe.
pub const MOST_DRIVES: usize = 4;

/// The drives of a vehicle, at least one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleDrives([Option<DriveKind>; MOST_DRIVES]);

impl VehicleDrives {
    /// In their order; those that are there come first.
    #[must_use]
    pub const fn as_slice(&self) -> &[Option<DriveKind>; MOST_DRIVES] {
        &self.0
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.iter().flatten().count()
    }

    /// The one of a vehicle that has one, with a DC machine without temperatures.
    #[must_use]
    pub const fn one_dc(&self) -> Option<&DriveParams> {
        match &self.0 {
            [Some(DriveKind::Dc(drive)), None, ..] => Some(drive),
            _ => None,
        }
    }
}

impl From<(DriveParams<PmsmParams>, DriveParams)> for VehicleDrives {
    fn from((one, two): (DriveParams<PmsmParams>, DriveParams)) -> Self {
        Self([Some(DriveKind::Pmsm(one)), Some(DriveKind::Dc(two)), None, None])
    }
}

impl From<DriveParams<PmsmParams>> for VehicleDrives {
    fn from(drive: DriveParams<PmsmParams>) -> Self {
        Self::from(DriveKind::Pmsm(drive))
    }
}

impl From<DriveParams> for VehicleDrives {
    fn from(drive: DriveParams) -> Self {
        Self::from(DriveKind::Dc(drive))
    }
}

impl From<HeatedDriveParams> for VehicleDrives {
    fn from(drive: HeatedDriveParams) -> Self {
        Self::from(DriveKind::HeatedDc(drive))
    }
}

impl From<DriveKind> for VehicleDrives {
    fn from(drive: DriveKind) -> Self {
        Self([Some(drive), None, None, None])
    }
}

/// One of several drives as a file lays it out.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveTable {
    #[serde(default)]
    converter: ConverterParams,
    motor: Option<DcMotorParams>,
    pmsm: Option<PmsmTable>,
    gearbox: GearboxParams,
    thermal: Option<DriveThermalParams>,
    torque_rate_per_s: Option<f32>,
    torque_share: Option<f32>,
}

impl DriveTable {
    /// The drive, or what is wrong with its machine.
    fn kind(self) -> Result<DriveKind, &'static str> {
        fn with<M>(table: &DriveTable, motor: M) -> DriveParams<M> {
            let params = DriveParams::new(motor, table.gearbox);
            DriveParams {
                converter: table.converter,
                torque_rate_per_s: table.torque_rate_per_s.unwrap_or(params.torque_rate_per_s),
                torque_share: table.torque_share.unwrap_or(params.torque_share),
                ..params
            }
        }
        match (self.motor, &self.pmsm, self.thermal) {
            (Some(motor), None, None) => Ok(DriveKind::Dc(with(&self, motor))),
            (Some(motor), None, Some(thermal)) => {
                Ok(DriveKind::HeatedDc(HeatedDriveParams { drive: with(&self, motor), thermal }))
            }
            (None, Some(pmsm), None) => Ok(DriveKind::Pmsm(with(&self, pmsm.params()))),
            (None, Some(pmsm), Some(thermal)) => {
                let drive = with(&self, pmsm.params());
                Ok(DriveKind::HeatedPmsm(HeatedDriveParams { drive, thermal }))
            }
            (None, None, _) => Err("is missing, and there is no `pmsm`"),
            (Some(_), Some(_), _) => Err("stands beside a `pmsm`: only one of both may"),
        }
    }
}

/// A synchronous machine as a file lays it out: [`PmsmParams`], whose map of fluxes borrows its table.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PmsmTable {
    flux: FluxTable,
    resistance_ohm: f32,
    resistance_per_k: f32,
    pole_pairs: u16,
    iron_s: f32,
    inertia_kg_m2: f32,
    viscous_nm_s_per_rad: f32,
    coulomb_nm: f32,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum FluxTable {
    Linear(LinearFlux),
    Map(MapTable),
}

/// Fluxes on a grid of currents, that of the q axis running fastest.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MapTable {
    d: AxisTable,
    q: AxisTable,
    flux_wb: Vec<[f32; 2]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisTable {
    start_a: f32,
    step_a: f32,
    points: u16,
}

impl PmsmTable {
    fn params(&self) -> PmsmParams {
        PmsmParams {
            flux: match &self.flux {
                FluxTable::Linear(linear) => Flux::Linear(*linear),
                FluxTable::Map(MapTable { d, q, flux_wb }) => {
                    Flux::Map(FluxMap { d: d.axis(), q: q.axis(), flux_wb: kept(flux_wb) })
                }
            },
            resistance_ohm: self.resistance_ohm,
            resistance_per_k: self.resistance_per_k,
            pole_pairs: self.pole_pairs,
            iron_s: self.iron_s,
            inertia_kg_m2: self.inertia_kg_m2,
            viscous_nm_s_per_rad: self.viscous_nm_s_per_rad,
            coulomb_nm: self.coulomb_nm,
        }
    }
}

impl AxisTable {
    const fn axis(&self) -> FluxAxis {
        FluxAxis { start_a: self.start_a, step_a: self.step_a, points: self.points }
    }
}

/// A machine borrows its map for ever: each different table is kept once.
fn kept(table: &[[f32; 2]]) -> &'static [[f32; 2]] {
    static TABLES: Mutex<Vec<&'static [[f32; 2]]>> = Mutex::new(Vec::new());
    let bits = |table: &[[f32; 2]]| table.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
    let mut tables = TABLES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let wanted = bits(table);
    if let Some(found) = tables.iter().find(|known| bits(known) == wanted) {
        return found;
    }
    let table: &'static [[f32; 2]] = Box::leak(table.into());
    tables.push(table);
    table
}

/// The drives that a vehicle's file describes: one at the top, or a list.
pub(super) fn described(
    document: &Document<'_>,
    content: &mut VehicleFile,
) -> Result<VehicleDrives, InputError> {
    let tops = [
        ("converter", content.converter.is_some()),
        ("motor", content.motor.is_some()),
        ("pmsm", content.pmsm.is_some()),
        ("gearbox", content.gearbox.is_some()),
        ("thermal", content.thermal.is_some()),
    ];
    let mut tables = std::mem::take(&mut content.drive);
    let several = !tables.is_empty();
    if several {
        if let Some((key, _)) = tops.iter().find(|(_, there)| *there) {
            return Err(document.refusal(key, "belongs into each of the tables [[drive]]"));
        }
    } else {
        let Some(gearbox) = content.gearbox else {
            return Err(document.refusal("gearbox", "is missing, and there is no table [[drive]]"));
        };
        tables.push(DriveTable {
            converter: content.converter.unwrap_or_default(),
            motor: content.motor,
            pmsm: content.pmsm.take(),
            gearbox,
            thermal: content.thermal,
            torque_rate_per_s: None,
            torque_share: None,
        });
    }
    if tables.len() > MOST_DRIVES {
        return Err(document.refusal("drive", &format!("may stand {MOST_DRIVES} times at most")));
    }
    let mut found = [None; MOST_DRIVES];
    for (n, (place, table)) in found.iter_mut().zip(tables).enumerate() {
        let at = if several { format!("drive.{n}") } else { "motor".to_owned() };
        *place = Some(table.kind().map_err(|what| document.refusal(&at, what))?);
    }
    Ok(VehicleDrives(found))
}
