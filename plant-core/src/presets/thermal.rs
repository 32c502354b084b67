//! A vehicle whose drive heats up.

use super::{BMW_I3_60AH_CONSTANT, Vehicle};
use crate::battery::BatteryParams;
use crate::converter::ConverterParams;
use crate::machine::dc::DcMotorParams;
use crate::machine::heated::{DriveThermalParams, HeatedPartParams};
use crate::powertrain::{DriveParams, HeatedDriveParams};
use crate::thermal::Conductor;

/// [`BMW_I3_60AH_CONSTANT`] with the losses of its drive as 26 trips of a real car tell them (TU
/// Munich, DOI 10.21227/6jr9-5235), which heat machine and inverter.
///
/// Least squares give 0.041 W/(N·m)², 10.1 W/(N·m) and 1.27e-3 W·s²: behind Kt = 0.27 N·m/A 3.0 mΩ of
/// winding and converter, of which a third is the converter's (estimate), a drop of 2.74 V and that
/// viscous friction.
///
/// | Value | Source |
/// |---|---|
/// | winding warm at 60 °C while these were measured | estimate |
/// | coolant 50 °C | estimate |
/// | machine 12 kJ/K, inverter 4 kJ/K | estimates: a part of some 49 kg, some 5 kg of aluminium |
/// | machine 0.08 K/W, inverter 0.027 K/W | estimates with which 75 kW at 4800 rpm, which BMW gives for 30 minutes, are just not derated |
/// | derated from 140 to 180 °C, from 100 to 125 °C | estimates: insulation of class H, a plate under transistors of 150 °C |
pub const BMW_I3_60AH_THERMAL: Vehicle<BatteryParams, HeatedDriveParams> = Vehicle {
    name: "bmw-i3-60ah-thermal",
    initial_soc: BMW_I3_60AH_CONSTANT.initial_soc,
    powertrain: BMW_I3_60AH_CONSTANT.powertrain.with_drives(HeatedDriveParams {
        drive: DriveParams {
            converter: ConverterParams {
                voltage_drop_v: 2.74,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.converter
            },
            motor: DcMotorParams {
                resistance_ohm: 2e-3,
                viscous_nm_s_per_rad: 1.27e-3,
                ..BMW_I3_60AH_CONSTANT.powertrain.drives.motor
            },
            ..BMW_I3_60AH_CONSTANT.powertrain.drives
        },
        thermal: DriveThermalParams {
            coolant_c: 50.0,
            machine: HeatedPartParams {
                heat_capacity_j_per_k: 12_000.0,
                coolant_k_per_w: 0.08,
                derate_from_c: 140.0,
                derate_to_c: 180.0,
            },
            inverter: HeatedPartParams {
                heat_capacity_j_per_k: 4000.0,
                coolant_k_per_w: 0.027,
                derate_from_c: 100.0,
                derate_to_c: 125.0,
            },
            winding: Conductor { reference_c: 60.0, per_k: 1.0 / 295.0 },
        },
    }),
    driver: BMW_I3_60AH_CONSTANT.driver,
};
