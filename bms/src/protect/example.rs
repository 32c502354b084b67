//! A pack to try things with.

use super::sheet::{
    Actuators, CellSheet, Currents, Layout, PackSheet, Sensing, Sensor, VoltageWindow,
};
use crate::estimate::power::TemperatureWindow;

/// A pack of 14 groups of 20 cells of the size 21700, with plausible sensors. Chosen for examples and
/// tests: take the figures of your own data sheets.
pub const EXAMPLE: PackSheet = PackSheet {
    cell: CellSheet {
        voltage: VoltageWindow {
            deep_v: 2.0,
            absolute_min_v: 2.5,
            operating_min_v: 2.8,
            operating_max_v: 4.2,
            absolute_max_v: 4.25,
        },
        discharge: Currents { continuous_a: 7.0, ten_seconds_a: 14.0 },
        charge: Currents { continuous_a: 2.5, ten_seconds_a: 5.0 },
        discharge_window: TemperatureWindow {
            none_below_c: -20.0,
            all_from_c: -10.0,
            all_to_c: 45.0,
            none_above_c: 60.0,
        },
        charge_window: TemperatureWindow {
            none_below_c: 0.0,
            all_from_c: 10.0,
            all_to_c: 45.0,
            none_above_c: 55.0,
        },
        capacity_ah: 5.0,
        resistance_ohm: 0.06,
        heat_capacity_j_per_k: 65.0,
    },
    layout: Layout { series: 14, parallel: 20 },
    sensing: Sensing {
        cell_v: Sensor {
            error: 0.002,
            noise_sd: 0.0005,
            resolution: 0.0001,
            period_s: 0.02,
            lowest: 0.0,
            highest: 5.0,
        },
        temperature_c: Sensor {
            error: 1.0,
            noise_sd: 0.05,
            resolution: 0.1,
            period_s: 0.1,
            lowest: -40.0,
            highest: 125.0,
        },
        current_a: Sensor {
            error: 2.0,
            noise_sd: 0.3,
            resolution: 0.05,
            period_s: 0.001,
            lowest: -600.0,
            highest: 600.0,
        },
        pack_v: Sensor {
            error: 0.2,
            noise_sd: 0.02,
            resolution: 0.01,
            period_s: 0.002,
            lowest: 0.0,
            highest: 80.0,
        },
        link_v: Sensor {
            error: 0.2,
            noise_sd: 0.02,
            resolution: 0.01,
            period_s: 0.002,
            lowest: -5.0,
            highest: 80.0,
        },
    },
    actuators: Actuators { open_s: 0.02, wait_s: 0.05, break_a: 200.0 },
    tick_s: 0.001,
    sweep_ticks: 20,
};
