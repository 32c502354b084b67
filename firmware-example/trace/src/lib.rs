#![no_std]
#![forbid(unsafe_code)]
//! One vehicle with its driver, driven along UDDS at 1 kHz, the estimators of its battery beside it,
//! and a hash of every bit of their state after every step; switched circuits, the same. The same code runs in the firmware and in a test on the host.

pub mod circuits;
mod frame;
mod hash;
mod monitor;
mod overruns;
mod rig;
mod run;

pub use frame::{Frame, Words};
pub use hash::Fnv1a;
pub use monitor::{Monitor, MonitorState};
pub use overruns::Overruns;
pub use rig::{Rig, RigState};
pub use run::Run;

use plant_core::Dt;
use plant_core::battery::{Battery, BatteryParams, MappedBattery, MappedBatteryParams};
use plant_core::control::driver::TorqueDriver;
use plant_core::machine::dc::DcDrive;
use plant_core::machine::heated::Heated;
use plant_core::machine::pmsm::{PmsmDrive, PmsmParams};
use plant_core::must;
use plant_core::powertrain::ledger::{EnergyLedger, NoLedger};
use plant_core::powertrain::{Axles, Drive, DriveParams, HeatedDriveParams, PowertrainParams};
use plant_core::presets::{
    BMW_I3_60AH, BMW_I3_60AH_CONSTANT, BMW_I3_60AH_PMSM, BMW_I3_60AH_THERMAL, EPOWERTRAIN_UDDS,
    TWO_AXLES,
};
use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams};

/// The step.
pub const DT: Dt = must!(Dt::from_s(1e-3));

/// Steps per second, and per line of the block hashes.
pub const STEPS_PER_BLOCK: u32 = 1000;

/// UDDS: time \[s\], speed \[m/s\].
#[allow(clippy::unreadable_literal, reason = "made by build.rs")]
pub static CYCLE: &[(f32, f32)] = include!(concat!(env!("OUT_DIR"), "/udds.rs"));

/// Blocks in the cycle: its points are one second apart.
pub const BLOCKS: u32 = 1369;

/// The speed to follow.
pub const REFERENCE: TimeTable<'static> =
    must!(TimeTable::new(TimeTableParams { points: CYCLE, at_end: AtEnd::Hold }, DT));

/// The vehicle of the published state of charge, driven by its PID from speed to duty.
pub const EPOWERTRAIN: Rig<NoLedger> = must!(Rig::new(&EPOWERTRAIN_UDDS, DT));
/// The same with its energy ledger.
pub const EPOWERTRAIN_LEDGER: Rig<EnergyLedger> = EPOWERTRAIN.with_ledger();
/// A physical car, driven by torque, with brake blending and a lossy converter.
pub const BMW_I3: Rig<NoLedger, MappedBattery> = must!(Rig::mapped(&BMW_I3_60AH, DT));
/// The same with its energy ledger.
pub const BMW_I3_LEDGER: Rig<EnergyLedger, MappedBattery> = BMW_I3.with_ledger();
/// The same car with a battery of constant parameters.
pub const BMW_I3_CONSTANT: Rig<NoLedger> = must!(Rig::new(&BMW_I3_60AH_CONSTANT, DT));
/// The same with its energy ledger.
pub const BMW_I3_CONSTANT_LEDGER: Rig<EnergyLedger> = BMW_I3_CONSTANT.with_ledger();

/// A rig whose driver asks its drives for a torque.
pub type Composed<D, L = NoLedger> = Rig<L, Battery, D, TorqueDriver>;
/// A synchronous machine behind, a DC machine in front.
pub type BothAxles = (Drive<PmsmDrive>, Drive);

/// The car with a synchronous machine.
pub const BMW_I3_PMSM: Composed<Drive<PmsmDrive>> =
    must!(Rig::composed(&BMW_I3_60AH_PMSM, PMSM_AXLE, DT));
/// The same with its energy ledger.
pub const BMW_I3_PMSM_LEDGER: Composed<Drive<PmsmDrive>, EnergyLedger> = BMW_I3_PMSM.with_ledger();
/// The car whose drive heats up.
pub const BMW_I3_THERMAL: Composed<Drive<Heated<DcDrive>>> =
    must!(Rig::composed(&BMW_I3_60AH_THERMAL, THERMAL_AXLE, DT));
/// A car with two axles.
pub const TWO_AXLED: Composed<BothAxles> = must!(Rig::composed(&TWO_AXLES, REAR.and(FRONT), DT));
/// The same with its energy ledger.
pub const TWO_AXLED_LEDGER: Composed<BothAxles, EnergyLedger> = TWO_AXLED.with_ledger();

const PMSM_CAR: PowertrainParams<BatteryParams, DriveParams<PmsmParams>> =
    BMW_I3_60AH_PMSM.powertrain;
const PMSM_AXLE: Axles<Drive<PmsmDrive>> = must!(PMSM_CAR.drives.on(PMSM_CAR.wheel, DT));
const THERMAL_CAR: PowertrainParams<BatteryParams, HeatedDriveParams> =
    BMW_I3_60AH_THERMAL.powertrain;
const THERMAL_AXLE: Axles<Drive<Heated<DcDrive>>> =
    must!(THERMAL_CAR.drives.on(THERMAL_CAR.wheel, DT));
const TWO_CAR: PowertrainParams<BatteryParams, (DriveParams<PmsmParams>, DriveParams)> =
    TWO_AXLES.powertrain;
const REAR: Axles<Drive<PmsmDrive>> = must!(TWO_CAR.drives.0.on(TWO_CAR.wheel, DT));
const FRONT: Axles<Drive> = must!(TWO_CAR.drives.1.on(TWO_CAR.wheel, DT));

/// The estimators of the first's battery. Apart from the plant, whose coefficients are few.
pub const EPOWERTRAIN_MONITOR: Monitor =
    must!(Monitor::new(MappedBatteryParams::constant(EPOWERTRAIN_UDDS.powertrain.battery), 550.0));
/// Those of the car's.
pub const BMW_I3_MONITOR: Monitor = must!(Monitor::new(BMW_I3_60AH.powertrain.battery, 370.0));
/// Those of its battery of constant parameters, which the cars of other drives have too.
pub const BMW_I3_CONSTANT_MONITOR: Monitor = must!(Monitor::new(
    MappedBatteryParams::constant(BMW_I3_60AH_CONSTANT.powertrain.battery),
    370.0
));
