//! Batteries identified from measurements, with parameters over state of charge and temperature.
//!
//! `data/batteries/*.toml` hold the same values with the figures of their fit; a test keeps the two
//! equal.

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
            (0.2, 348.714),
            (0.25, 354.957),
            (0.3, 360.784),
            (0.35, 365.241),
            (0.4, 368.647),
            (0.45, 370.394),
            (0.5, 371.851),
            (0.55, 374.82),
            (0.6, 377.775),
            (0.65, 381.522),
            (0.7, 385.137),
            (0.75, 387.433),
            (0.8, 389.235),
            (0.85, 391.219),
            (0.9, 393.193),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.2, 0.06488),
                (0.35, 0.06515),
                (0.5, 0.06537),
                (0.65, 0.07333),
                (0.8, 0.07126),
                (0.9, 0.06864),
            ]
        ))),
        activation_k: 3309.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.2, 0.04064),
                (0.35, 0.03896),
                (0.5, 0.02663),
                (0.65, 0.04056),
                (0.8, 0.04013),
                (0.9, 0.03542),
            ]
        ))),
        activation_k: 2820.0,
        time_constant_s: 20.2,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.2, 0.07244),
                (0.35, 0.07006),
                (0.5, 0.05936),
                (0.65, 0.06664),
                (0.8, 0.07286),
                (0.9, 0.07035),
            ]
        ))),
        activation_k: 2688.0,
        time_constant_s: 271.0,
    },
    thermal: ThermalParams::FIXED,
    identified: IdentifiedRange {
        soc_min: 0.21,
        soc_max: 0.88,
        temperature_min_c: 0.0,
        temperature_max_c: 33.0,
    },
};

/// One Panasonic NCR18650PF cell: least squares on the tests of "Panasonic 18650PF Li-ion Battery
/// Data" (P. Kollmeyer, University of Wisconsin-Madison, DOI 10.17632/wykht8y7tg.1).
pub const PANASONIC_NCR18650PF: MappedBatteryParams = MappedBatteryParams {
    capacity_ah: 2.97,
    discharge_limit_a: 25.0,
    charge_limit_a: 12.0,
    refresh_s: 1.0,
    open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
        "battery.open_circuit.table",
        &[
            (0.0, 3.1766),
            (0.03125, 3.2155),
            (0.0625, 3.2544),
            (0.09375, 3.2932),
            (0.125, 3.3314),
            (0.15625, 3.3719),
            (0.1875, 3.4085),
            (0.21875, 3.4466),
            (0.25, 3.4831),
            (0.28125, 3.5142),
            (0.3125, 3.5335),
            (0.34375, 3.5502),
            (0.375, 3.5684),
            (0.40625, 3.5882),
            (0.4375, 3.6041),
            (0.46875, 3.6233),
            (0.5, 3.6466),
            (0.53125, 3.672),
            (0.5625, 3.7017),
            (0.59375, 3.7317),
            (0.625, 3.752),
            (0.65625, 3.7837),
            (0.6875, 3.8242),
            (0.71875, 3.8552),
            (0.75, 3.888),
            (0.78125, 3.9104),
            (0.8125, 3.9455),
            (0.84375, 3.978),
            (0.875, 4.0181),
            (0.90625, 4.0532),
            (0.9375, 4.0887),
            (0.96875, 4.1182),
            (1.0, 4.1491),
        ]
    ))),
    hysteresis: HysteresisParams::NONE,
    series: ResistanceMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.series.resistance_ohm",
            &[
                (0.0, 0.03466),
                (0.05, 0.03466),
                (0.1, 0.03386),
                (0.15, 0.03724),
                (0.2, 0.04428),
                (0.25, 0.03995),
                (0.35, 0.03238),
                (0.5, 0.03146),
                (0.65, 0.03036),
                (0.8, 0.031),
                (1.0, 0.041),
            ]
        ))),
        activation_k: 2315.0,
    },
    polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.polarisation.resistance_ohm",
            &[
                (0.0, 0.16274),
                (0.05, 0.16274),
                (0.1, 0.16285),
                (0.15, 0.05191),
                (0.2, 0.01157),
                (0.25, 0.00201),
                (0.35, 0.00141),
                (0.5, 4e-05),
                (0.65, 0.00061),
                (0.8, 0.00018),
                (1.0, 0.00078),
            ]
        ))),
        activation_k: 10162.0,
        time_constant_s: 8.13,
    },
    second_polarisation: BranchMap {
        resistance_ohm: OverSoc::Table(must!(SocTable::from_points(
            "battery.second_polarisation.resistance_ohm",
            &[
                (0.0, 0.07238),
                (0.05, 0.07238),
                (0.1, 0.07235),
                (0.15, 0.06422),
                (0.2, 0.01685),
                (0.25, 0.03424),
                (0.35, 0.02978),
                (0.5, 0.02052),
                (0.65, 0.01894),
                (0.8, 0.02385),
                (1.0, 0.02396),
            ]
        ))),
        activation_k: 4127.0,
        time_constant_s: 126.7,
    },
    thermal: ThermalParams { heat_capacity_j_per_k: 59.5, cooling_w_per_k: 0.145, ambient_c: 25.0 },
    identified: IdentifiedRange {
        soc_min: 0.15,
        soc_max: 1.0,
        temperature_min_c: -10.0,
        temperature_max_c: 35.0,
    },
};
