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
            (0.21875, 354.337),
            (0.25, 357.491),
            (0.28125, 360.498),
            (0.3125, 363.313),
            (0.34375, 365.686),
            (0.375, 367.56),
            (0.40625, 369.139),
            (0.4375, 369.753),
            (0.46875, 370.11),
            (0.5, 371.162),
            (0.53125, 373.576),
            (0.5625, 375.712),
            (0.59375, 377.481),
            (0.625, 379.859),
            (0.65625, 382.132),
            (0.6875, 384.334),
            (0.71875, 386.113),
            (0.75, 387.249),
            (0.78125, 388.268),
            (0.8125, 389.57),
            (0.84375, 390.946),
            (0.875, 392.36),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.25, 0.06517),
                (0.375, 0.06509),
                (0.5, 0.06664),
                (0.65625, 0.07326),
                (0.8125, 0.07097),
            ]
        ))),
        activation_k: 3408.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.25, 0.05474),
                (0.375, 0.07418),
                (0.5, 0.03559),
                (0.65625, 0.07413),
                (0.8125, 0.06424),
            ]
        ))),
        activation_k: 1826.0,
        time_constant_s: 32.64,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.25, 0.1361),
                (0.375, 0.07312),
                (0.5, 0.01458),
                (0.65625, 0.04497),
                (0.8125, 0.03782),
            ]
        ))),
        activation_k: 6012.0,
        time_constant_s: 647.6,
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
            (0.0, 2.8446),
            (0.03125, 3.1363),
            (0.0625, 3.3084),
            (0.09375, 3.3803),
            (0.125, 3.4174),
            (0.15625, 3.4521),
            (0.1875, 3.475),
            (0.21875, 3.4899),
            (0.25, 3.5056),
            (0.28125, 3.532),
            (0.3125, 3.5538),
            (0.34375, 3.5684),
            (0.375, 3.5828),
            (0.40625, 3.5984),
            (0.4375, 3.6158),
            (0.46875, 3.6367),
            (0.5, 3.6585),
            (0.53125, 3.6844),
            (0.5625, 3.7171),
            (0.59375, 3.7484),
            (0.625, 3.7774),
            (0.65625, 3.8091),
            (0.6875, 3.8422),
            (0.71875, 3.8709),
            (0.75, 3.8935),
            (0.78125, 3.9196),
            (0.8125, 3.9497),
            (0.84375, 3.9855),
            (0.875, 4.0278),
            (0.90625, 4.0657),
            (0.9375, 4.097),
            (0.96875, 4.1062),
            (1.0, 4.1489),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.15625, 0.02503),
                (0.203125, 0.03512),
                (0.25, 0.03571),
                (0.375, 0.03148),
                (0.5, 0.03021),
                (0.65625, 0.02959),
                (0.8125, 0.03039),
                (1.0, 0.0365),
            ]
        ))),
        activation_k: 2284.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.15625, 0.06166),
                (0.203125, 0.02538),
                (0.25, 0.005505),
                (0.375, 0.002591),
                (0.5, 0.001342),
                (0.65625, 0.001508),
                (0.8125, 0.001174),
                (1.0, 0.002628),
            ]
        ))),
        activation_k: 6608.0,
        time_constant_s: 4.737,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.15625, 0.1651),
                (0.203125, 0.08175),
                (0.25, 0.04735),
                (0.375, 0.04126),
                (0.5, 0.02114),
                (0.65625, 0.034),
                (0.8125, 0.02673),
                (1.0, 0.03628),
            ]
        ))),
        activation_k: 3834.0,
        time_constant_s: 246.5,
    },
    thermal: ThermalParams {
        heat_capacity_j_per_k: 62.29,
        cooling_w_per_k: 0.1229,
        ambient_c: 24.3,
    },
    identified: IdentifiedRange {
        soc_min: 0.1562,
        soc_max: 1.0,
        temperature_min_c: -10.2,
        temperature_max_c: 33.0,
    },
};
