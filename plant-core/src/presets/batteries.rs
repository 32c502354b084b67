//! Batteries identified from measurements, with parameters over state of charge and temperature.
//!
//! Made from `data/batteries/*.toml` by `cargo run -p voltstep --example make_presets`; those files
//! hold the figures of the fit and the command that made them, and a test keeps the two equal.
#![expect(clippy::unreadable_literal, reason = "as in the files")]

use crate::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap, ThermalParams,
};
use crate::must;
use crate::num::SocTable;

/// The pack of a BMW i3 60 Ah, 96 cells in series: least squares on the trips of "Battery and
/// Heating Data in Real Driving Cycles" (TU Munich, DOI 10.21227/6jr9-5235).
pub const BMW_I3_60AH_PACK: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 61.7,
    discharge_limit_a: 400.0,
    charge_limit_a: 150.0,
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "battery.open_circuit.table",
        &[
            (0.21875, 353.976),
            (0.25, 357.284),
            (0.28125, 359.878),
            (0.3125, 363.413),
            (0.34375, 365.753),
            (0.375, 367.264),
            (0.40625, 369.439),
            (0.4375, 369.486),
            (0.46875, 369.839),
            (0.5, 370.799),
            (0.53125, 373.718),
            (0.5625, 376.042),
            (0.59375, 377.168),
            (0.625, 379.903),
            (0.65625, 381.939),
            (0.6875, 384.198),
            (0.71875, 386.074),
            (0.75, 387.149),
            (0.78125, 388.164),
            (0.8125, 389.49),
            (0.84375, 390.903),
            (0.875, 392.439),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.25, 0.06534),
                (0.375, 0.06537),
                (0.5, 0.06692),
                (0.65625, 0.07342),
                (0.8125, 0.07135),
            ]
        ))),
        activation_k: 3409.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.25, 0.06058),
                (0.375, 0.09005),
                (0.5, 0.04264),
                (0.65625, 0.08771),
                (0.8125, 0.0744),
            ]
        ))),
        activation_k: 1164.0,
        time_constant_s: 37.32,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[(0.25, 0.09385), (0.375, 0.05082), (0.5, 0.0), (0.65625, 0.02251), (0.8125, 0.01764),]
        ))),
        activation_k: 9920.0,
        time_constant_s: 888.8,
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
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "battery.open_circuit.table",
        &[
            (0.0, 2.8071),
            (0.03125, 3.2449),
            (0.0625, 3.3224),
            (0.09375, 3.3647),
            (0.125, 3.3927),
            (0.15625, 3.4718),
            (0.1875, 3.4718),
            (0.21875, 3.4884),
            (0.25, 3.5027),
            (0.28125, 3.5333),
            (0.3125, 3.5554),
            (0.34375, 3.5683),
            (0.375, 3.5833),
            (0.40625, 3.599),
            (0.4375, 3.6149),
            (0.46875, 3.6369),
            (0.5, 3.6585),
            (0.53125, 3.6834),
            (0.5625, 3.719),
            (0.59375, 3.7505),
            (0.625, 3.7786),
            (0.65625, 3.8104),
            (0.6875, 3.8438),
            (0.71875, 3.8729),
            (0.75, 3.8926),
            (0.78125, 3.92),
            (0.8125, 3.95),
            (0.84375, 3.9842),
            (0.875, 4.0286),
            (0.90625, 4.0645),
            (0.9375, 4.1032),
            (0.96875, 4.1032),
            (1.0, 4.1507),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.15625, 0.02951),
                (0.203125, 0.03939),
                (0.25, 0.0372),
                (0.375, 0.03198),
                (0.5, 0.03112),
                (0.65625, 0.03042),
                (0.8125, 0.03124),
                (1.0, 0.03786),
            ]
        ))),
        activation_k: 2186.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.15625, 0.05168),
                (0.203125, 0.01851),
                (0.25, 0.003715),
                (0.375, 0.002015),
                (0.5, 0.0009301),
                (0.65625, 0.001057),
                (0.8125, 0.0008184),
                (1.0, 0.001775),
            ]
        ))),
        activation_k: 7586.0,
        time_constant_s: 5.015,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.15625, 0.1935),
                (0.203125, 0.07697),
                (0.25, 0.04817),
                (0.375, 0.04203),
                (0.5, 0.02076),
                (0.65625, 0.03521),
                (0.8125, 0.02679),
                (1.0, 0.03706),
            ]
        ))),
        activation_k: 3811.0,
        time_constant_s: 244.7,
    },
    thermal: ThermalParams {
        heat_capacity_j_per_k: 62.26,
        cooling_w_per_k: 0.1231,
        ambient_c: 24.3,
    },
    identified: IdentifiedRange {
        soc_min: 0.1562,
        soc_max: 1.0,
        temperature_min_c: -10.2,
        temperature_max_c: 33.0,
    },
};
