//! Batteries identified from measurements, with parameters over state of charge and temperature.
//!
//! Made from `data/batteries/*.toml` by `cargo xtask presets`; those files hold the figures of the
//! fit and the command that made them, and a test keeps the two equal.
#![expect(clippy::unreadable_literal, reason = "as in the files")]

use crate::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap, ThermalParams, VoltageLimits,
};
use crate::must;
use crate::num::SocTable;

/// The pack of a BMW i3 60 Ah, 96 cells in series: least squares on the trips of "Battery and
/// Heating Data in Real Driving Cycles" (TU Munich, DOI 10.21227/6jr9-5235).
pub const BMW_I3_60AH_PACK: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 61.7,
    discharge_limit_a: 400.0,
    charge_limit_a: 150.0,
    voltage_limits: VoltageLimits::NONE,
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "battery.open_circuit.table",
        &[
            (0.21875, 354.031),
            (0.25, 357.239),
            (0.28125, 360.35),
            (0.3125, 363.333),
            (0.34375, 365.757),
            (0.375, 367.611),
            (0.40625, 369.29),
            (0.4375, 369.744),
            (0.46875, 369.988),
            (0.5, 370.959),
            (0.53125, 373.601),
            (0.5625, 375.77),
            (0.59375, 377.418),
            (0.625, 379.907),
            (0.65625, 382.143),
            (0.6875, 384.358),
            (0.71875, 386.141),
            (0.75, 387.246),
            (0.78125, 388.244),
            (0.8125, 389.561),
            (0.84375, 390.939),
            (0.875, 392.372),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.25, 0.06546),
                (0.375, 0.06467),
                (0.5, 0.06683),
                (0.65625, 0.07301),
                (0.8125, 0.07103),
            ]
        ))),
        activation_k: 3417.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.25, 0.05325),
                (0.375, 0.08026),
                (0.5, 0.03299),
                (0.65625, 0.0774),
                (0.8125, 0.06535),
            ]
        ))),
        activation_k: 1701.0,
        time_constant_s: 33.12,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.25, 0.1293),
                (0.375, 0.07248),
                (0.5, 0.01244),
                (0.65625, 0.0441),
                (0.8125, 0.03601),
            ]
        ))),
        activation_k: 6287.0,
        time_constant_s: 672.3,
    },
    thermal: ThermalParams::FIXED,
    identified: IdentifiedRange {
        soc_min: 0.25,
        soc_max: 0.869,
        temperature_min_c: -1.0,
        temperature_max_c: 32.0,
    },
};

/// One Panasonic NCR18650PF cell: least squares on the tests of "Panasonic 18650PF Li-ion Battery
/// Data" (P. Kollmeyer, University of Wisconsin-Madison, DOI 10.17632/wykht8y7tg.1).
pub const PANASONIC_NCR18650PF: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 2.968,
    discharge_limit_a: 25.0,
    charge_limit_a: 12.0,
    voltage_limits: VoltageLimits::NONE,
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "battery.open_circuit.table",
        &[
            (0.0, 2.8363),
            (0.03125, 3.1515),
            (0.0625, 3.3187),
            (0.09375, 3.3781),
            (0.125, 3.4121),
            (0.15625, 3.4506),
            (0.1875, 3.47),
            (0.21875, 3.4874),
            (0.25, 3.506),
            (0.28125, 3.5333),
            (0.3125, 3.5552),
            (0.34375, 3.5691),
            (0.375, 3.5833),
            (0.40625, 3.5987),
            (0.4375, 3.6153),
            (0.46875, 3.6362),
            (0.5, 3.6581),
            (0.53125, 3.6843),
            (0.5625, 3.7185),
            (0.59375, 3.7504),
            (0.625, 3.7792),
            (0.65625, 3.811),
            (0.6875, 3.8436),
            (0.71875, 3.8722),
            (0.75, 3.8936),
            (0.78125, 3.9196),
            (0.8125, 3.9497),
            (0.84375, 3.9853),
            (0.875, 4.0282),
            (0.90625, 4.0659),
            (0.9375, 4.0997),
            (0.96875, 4.1056),
            (1.0, 4.1497),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.15625, 0.0242),
                (0.203125, 0.04075),
                (0.25, 0.03708),
                (0.375, 0.03176),
                (0.5, 0.03101),
                (0.65625, 0.03026),
                (0.8125, 0.03108),
                (1.0, 0.03767),
            ]
        ))),
        activation_k: 2210.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.15625, 0.05982),
                (0.203125, 0.01866),
                (0.25, 0.003851),
                (0.375, 0.002219),
                (0.5, 0.0009897),
                (0.65625, 0.001118),
                (0.8125, 0.0008846),
                (1.0, 0.001899),
            ]
        ))),
        activation_k: 7426.0,
        time_constant_s: 5.194,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.15625, 0.1653),
                (0.203125, 0.0716),
                (0.25, 0.04967),
                (0.375, 0.04213),
                (0.5, 0.02049),
                (0.65625, 0.03571),
                (0.8125, 0.02679),
                (1.0, 0.0372),
            ]
        ))),
        activation_k: 3788.0,
        time_constant_s: 244.7,
    },
    thermal: ThermalParams {
        heat_capacity_j_per_k: 62.25,
        cooling_w_per_k: 0.123,
        ambient_c: 24.3,
    },
    identified: IdentifiedRange {
        soc_min: 0.1562,
        soc_max: 1.0,
        temperature_min_c: -10.2,
        temperature_max_c: 33.0,
    },
};
