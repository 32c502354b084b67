//! The vehicles whose bits are golden, and what of them the page turns.

use plant_core::battery::{Battery, BatteryParams, MappedBatteryParams, OverSoc};
use plant_core::control::driver::TorqueDriver;
use plant_core::machine::pmsm::PmsmParams;
use plant_core::mechanics::body::RoadResistance;
use plant_core::num::SocTable;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{DriveParams, DrivesParams, HeatedDriveParams};
use plant_core::presets::{
    BMW_I3_60AH, BMW_I3_60AH_CONSTANT, BMW_I3_60AH_PMSM, BMW_I3_60AH_THERMAL, EPOWERTRAIN_UDDS,
    TWO_AXLES, Vehicle,
};
use plant_core::{Dt, ParamError};
use voltstep_trace::Rig;

use crate::cycle::Cycle;
use crate::run::{Going, Run};

/// What the page turns: factors on the preset's values, 1 for the preset itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knobs {
    /// On the mass of the body.
    pub mass: f32,
    /// On the drag coefficient.
    pub drag: f32,
    /// On the battery's capacity.
    pub capacity: f32,
    /// On the battery's series resistance, at any state of charge.
    pub resistance: f32,
    /// Temperature \[°C\] of what has one.
    pub temperature_c: f32,
}

/// What a vehicle's values are before they are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Its name.
    pub name: &'static str,
    /// Mass of the body \[kg\].
    pub mass_kg: f32,
    /// Drag coefficient.
    pub drag_coefficient: f32,
    /// Charge that the battery holds \[A·h\].
    pub capacity_ah: f32,
    /// Series resistance at the start \[Ω\], at 25 °C.
    pub resistance_ohm: f32,
    /// What has a temperature, and which \[°C\].
    pub temperature: Option<(&'static str, f32)>,
}

/// A vehicle, whichever battery and drives it has.
pub trait Car {
    /// Its values.
    fn sheet(&self) -> Sheet;
    /// Sets out along a cycle.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    fn set_out(
        &self,
        knobs: Knobs,
        cycle: &'static Cycle,
        dt: Dt,
    ) -> Result<Box<dyn Going>, ParamError>;
}

/// Every vehicle that has golden bits; the first is shown first.
pub const CARS: [&dyn Car; 6] = [
    &BMW_I3_60AH,
    &BMW_I3_60AH_CONSTANT,
    &BMW_I3_60AH_PMSM,
    &BMW_I3_60AH_THERMAL,
    &TWO_AXLES,
    &EPOWERTRAIN_UDDS,
];

/// What of a battery or of drives may have a temperature.
trait Warm {
    /// What it is, and its temperature \[°C\].
    fn temperature(&mut self) -> Option<(&'static str, &mut f32)> {
        None
    }
}

impl Warm for BatteryParams {}
impl<M> Warm for DriveParams<M> {}
impl<A, B> Warm for (A, B) {}

impl Warm for MappedBatteryParams {
    fn temperature(&mut self) -> Option<(&'static str, &mut f32)> {
        Some(("battery", &mut self.thermal.ambient_c))
    }
}

impl<M> Warm for HeatedDriveParams<M> {
    fn temperature(&mut self) -> Option<(&'static str, &mut f32)> {
        Some(("coolant of the drive", &mut self.thermal.coolant_c))
    }
}

/// What the page turns of a battery.
trait Cells: Warm + Copy {
    fn capacity_ah(&mut self) -> &mut f32;
    /// The series resistance at a state of charge \[Ω\].
    fn resistance_ohm(&self, soc: f32) -> f32;
    fn resist(&mut self, factor: f32) -> Result<(), ParamError>;
}

impl Cells for BatteryParams {
    fn capacity_ah(&mut self) -> &mut f32 {
        &mut self.capacity_ah
    }

    fn resistance_ohm(&self, _soc: f32) -> f32 {
        self.series_resistance_ohm
    }

    fn resist(&mut self, factor: f32) -> Result<(), ParamError> {
        self.series_resistance_ohm *= factor;
        Ok(())
    }
}

impl Cells for MappedBatteryParams {
    fn capacity_ah(&mut self) -> &mut f32 {
        &mut self.capacity_ah
    }

    fn resistance_ohm(&self, soc: f32) -> f32 {
        self.series.resistance_ohm.at(soc)
    }

    fn resist(&mut self, factor: f32) -> Result<(), ParamError> {
        match &mut self.series.resistance_ohm {
            OverSoc::Constant(ohm) => *ohm *= factor,
            OverSoc::Table(table) => {
                let ohm = table.values().map(|ohm| ohm * factor);
                *table = SocTable::new("battery.series.resistance_ohm", ohm)?;
            }
        }
        Ok(())
    }
}

fn drag_coefficient(resistance: &mut RoadResistance) -> Option<&mut f32> {
    match resistance {
        RoadResistance::Physical { drag_coefficient, .. } => Some(drag_coefficient),
        RoadResistance::CoastDown { .. } => None,
    }
}

fn sheet<P: Cells, Q: Warm + Copy>(vehicle: &Vehicle<P, Q>) -> Sheet {
    let mut plant = vehicle.powertrain;
    let resistance_ohm = plant.battery.resistance_ohm(vehicle.initial_soc);
    let capacity_ah = *plant.battery.capacity_ah();
    let temperature = plant.battery.temperature().or(plant.drives.temperature());
    Sheet {
        name: vehicle.name,
        mass_kg: plant.body.mass_kg,
        drag_coefficient: drag_coefficient(&mut plant.body.resistance).map_or(f32::NAN, |c| *c),
        capacity_ah,
        resistance_ohm,
        temperature: temperature.map(|(what, celsius)| (what, *celsius)),
    }
}

/// The vehicle with other values; with those of the preset the same bits.
fn turned<P: Cells, Q: Warm + Copy>(
    vehicle: &Vehicle<P, Q>,
    knobs: Knobs,
) -> Result<Vehicle<P, Q>, ParamError> {
    let mut vehicle = *vehicle;
    let plant = &mut vehicle.powertrain;
    plant.body.mass_kg *= knobs.mass;
    if let Some(coefficient) = drag_coefficient(&mut plant.body.resistance) {
        *coefficient *= knobs.drag;
    }
    *plant.battery.capacity_ah() *= knobs.capacity;
    plant.battery.resist(knobs.resistance)?;
    if let Some((_, celsius)) = plant.battery.temperature().or(plant.drives.temperature()) {
        *celsius = knobs.temperature_c;
    }
    Ok(vehicle)
}

/// Cars, and how the rig of one is built that was turned.
macro_rules! cars {
    ($($vehicle:ty: |$turned:ident, $dt:ident| $rig:expr;)+) => {$(
        impl Car for $vehicle {
            fn sheet(&self) -> Sheet {
                sheet(self)
            }

            fn set_out(
                &self,
                knobs: Knobs,
                cycle: &'static Cycle,
                $dt: Dt,
            ) -> Result<Box<dyn Going>, ParamError> {
                let $turned = &turned(self, knobs)?;
                Run::begin($rig?, cycle, $dt)
            }
        }
    )+};
}

cars! {
    Vehicle: |turned, dt| Rig::new(turned, dt);
    Vehicle<MappedBatteryParams>: |turned, dt| Rig::mapped(turned, dt);
    Vehicle<BatteryParams, DriveParams<PmsmParams>>: |turned, dt| composed(turned, dt);
    Vehicle<BatteryParams, HeatedDriveParams>: |turned, dt| composed(turned, dt);
    Vehicle<BatteryParams, (DriveParams<PmsmParams>, DriveParams)>: |turned, dt| composed(turned, dt);
}

/// A vehicle of other drives: its driver asks for a torque.
fn composed<D: DrivesParams>(
    vehicle: &Vehicle<BatteryParams, D>,
    dt: Dt,
) -> Result<Rig<NoLedger, Battery, D::Drives, TorqueDriver>, ParamError> {
    let axles = vehicle.powertrain.drives.axles(vehicle.powertrain.wheel, dt)?;
    Rig::composed(vehicle, axles, dt)
}
