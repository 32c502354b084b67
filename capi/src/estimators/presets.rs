//! Parameters that come with the library, as the estimators take them.

use plant_core::presets::PANASONIC_NCR18650PF as PANASONIC;
use voltstep_bms::estimate::cells::{CellResistanceParams, CellsParams};
use voltstep_bms::estimate::coulomb::CoulombParams;
use voltstep_bms::estimate::ekf::{EkfParams, Uncertainty};
use voltstep_bms::estimate::energy::EnergyParams;
use voltstep_bms::estimate::power::{HORIZONS_S, PowerParams, TemperatureWindow};
use voltstep_bms::estimate::soh::{CapacityParams, ResistanceParams};

/// The parameters of every estimator.
#[derive(Clone, Copy, Debug)]
pub struct EstimatorParams {
    /// Of the filter, with those of the cell.
    pub filter: EkfParams,
    /// Of the counter.
    pub counter: CoulombParams,
    /// Of the cells in series.
    pub cells: CellsParams,
    /// Of their resistances.
    pub cell_resistances: CellResistanceParams,
    /// Of the resistance of the mean.
    pub resistance: ResistanceParams,
    /// Of the capacity.
    pub capacity: CapacityParams,
    /// Of the state of power.
    pub power: PowerParams,
    /// Of the energy left.
    pub energy: EnergyParams,
}

/// The voltage of the Panasonic cell at half charge \[V\].
const NOMINAL_V: f32 = 3.65;
const KNOWN: Uncertainty = Uncertainty::typical(NOMINAL_V, PANASONIC.capacity_ah);
/// Of its data sheet: charge from 0 to 45 °C, discharge from −20 to 60 °C; all of it 10 K within.
const DISCHARGE: TemperatureWindow = TemperatureWindow {
    none_below_c: -20.0,
    all_from_c: -10.0,
    all_to_c: 50.0,
    none_above_c: 60.0,
};
const CHARGE: TemperatureWindow =
    TemperatureWindow { none_below_c: 0.0, all_from_c: 10.0, all_to_c: 35.0, none_above_c: 45.0 };

impl EstimatorParams {
    /// A Panasonic NCR18650PF with the sensors of a production car: the filter's
    /// [`EkfParams::typical`], and the others to match. Chosen: 1 mV and 2 mV of a cell's noise and
    /// offset, cells alike to 10 % of 30 mΩ and 2 % of the capacity.
    pub const PANASONIC_NCR18650PF: Self = Self {
        filter: EkfParams::typical(PANASONIC, NOMINAL_V),
        counter: CoulombParams {
            capacity_ah: PANASONIC.capacity_ah,
            capacity_sd_ah: KNOWN.capacity_sd * PANASONIC.capacity_ah,
            charge_efficiency: 1.0,
            offset_sd_a: KNOWN.current_offset_sd_a,
            gain_sd: 0.005,
            largest_current_a: 2.0 * PANASONIC.discharge_limit_a,
            open_circuit: PANASONIC.open_circuit,
            rest_voltage_sd_v: KNOWN.open_circuit_sd_v,
            rest_current_a: 0.03,
            rest_s: 1800.0,
        },
        cells: CellsParams {
            open_circuit: PANASONIC.open_circuit,
            noise_sd_v: 0.001,
            offset_sd_v: 0.002,
            resistance_sd_ohm: 0.003,
            capacity_sd: 0.02,
            soc_sd: 0.02,
            drift_sd_per_day: 0.001,
            pack_soc_sd_max: 0.1,
            voltage_min_v: 2.0,
            voltage_max_v: 4.5,
        },
        cell_resistances: CellResistanceParams {
            resistance_ohm: 0.03,
            spread_sd: 0.1,
            noise_sd_v: 0.001,
            least_step_a: 0.5,
            memory_steps: 500.0,
        },
        resistance: ResistanceParams {
            voltage_sd_v: 0.001,
            current_sd_a: 0.01,
            least_step_a: 0.5,
            memory_steps: 500.0,
            initial_sd: 0.5,
            skew_s: 0.0,
        },
        capacity: CapacityParams {
            nominal_ah: PANASONIC.capacity_ah,
            nominal_sd_ah: 0.15 * PANASONIC.capacity_ah,
            current_noise_sd_a: 0.01,
            current_offset_sd_a: KNOWN.current_offset_sd_a,
            current_gain_sd: 0.005,
            least_soc_change: 0.2,
            least_soc_change_sds: 10.0,
            memory_pairs: 50.0,
        },
        power: PowerParams {
            voltage_min_v: 2.5,
            voltage_max_v: 4.2,
            soc_min: 0.05,
            soc_max: 0.98,
            margin_sds: 2.0,
            horizons_s: HORIZONS_S,
            discharge_window: DISCHARGE,
            charge_window: CHARGE,
        },
        energy: EnergyParams { empty_soc: 0.05, full_soc: 1.0, empty_v: 2.5, least_a: 0.01 },
    };
}
