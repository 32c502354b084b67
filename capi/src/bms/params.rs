//! The description of a pack as C sees it: what its data sheets say, and how alike its cells are.

use crate::estimators::{VoltstepCellParams, VoltstepTemperatureWindow};

/// Cells in series that a BMS may have at most. How many a library is built for is chosen by the
/// environment variable `VOLTSTEP_BMS_CELLS` when building; 18 without it.
pub const VOLTSTEP_BMS_CELLS_MAX: usize = 18;

/// Temperatures that a BMS may have at most. How many a library is built for is chosen by the
/// environment variable `VOLTSTEP_BMS_SENSORS` when building; 4 without it.
pub const VOLTSTEP_BMS_SENSORS_MAX: usize = 8;

/// Wires between so many cells and the front end.
pub const VOLTSTEP_BMS_WIRES_MAX: usize = 19;
const _: () = assert!(VOLTSTEP_BMS_WIRES_MAX == VOLTSTEP_BMS_CELLS_MAX + 1);

/// Voltages of a cell in V, rising.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsVoltages {
    /// Below this, not to be charged again without a look at the cell; above zero.
    pub deep_v: f32,
    /// The absolute minimum of the data sheet.
    pub absolute_min_v: f32,
    /// Where discharging ends.
    pub operating_min_v: f32,
    /// Where charging ends.
    pub operating_max_v: f32,
    /// The absolute maximum of the data sheet.
    pub absolute_max_v: f32,
}

/// Currents of a cell in one direction in A.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsCurrents {
    /// Continuous; above zero.
    pub continuous_a: f32,
    /// For ten seconds; above the continuous one.
    pub ten_seconds_a: f32,
}

/// A cell in the terms of its data sheet.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsCellSheet {
    /// Its voltages.
    pub voltage: VoltstepBmsVoltages,
    /// Its currents when discharging.
    pub discharge: VoltstepBmsCurrents,
    /// Its currents when charging.
    pub charge: VoltstepBmsCurrents,
    /// Temperatures at which it may be discharged, each above the one before; `none_below_c` and
    /// `none_above_c` are the absolute limits, the others those of operation.
    pub discharge_window: VoltstepTemperatureWindow,
    /// Temperatures at which it may be charged, likewise.
    pub charge_window: VoltstepTemperatureWindow,
    /// Capacity in A h; above zero.
    pub capacity_ah: f32,
    /// The largest resistance within its life and its windows in ohm; above zero.
    pub resistance_ohm: f32,
    /// Heat capacity in J/K; above zero.
    pub heat_capacity_j_per_k: f32,
}

/// How many cells.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsLayout {
    /// In series: the number that the library is built for.
    pub series: u16,
    /// In parallel; at least 1.
    pub parallel: u16,
}

/// A kind of sensor; its unit is that of the quantity.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsSensor {
    /// How far a value may be off, offset and gain together; zero or above.
    pub error: f32,
    /// Standard deviation of its noise; zero or above.
    pub noise_sd: f32,
    /// What one step of its converter means; above zero.
    pub resolution: f32,
    /// Time between two values in s; above zero.
    pub period_s: f32,
    /// The lowest value that it can show.
    pub lowest: f32,
    /// The highest value that it can show, above the lowest. What lies outside is no value but a
    /// sentinel, or in another unit.
    pub highest: f32,
}

/// The sensors.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsSensing {
    /// Of the cells' voltages in V.
    pub cell_v: VoltstepBmsSensor,
    /// Of temperatures in degC.
    pub temperature_c: VoltstepBmsSensor,
    /// Of the pack's current in A.
    pub current_a: VoltstepBmsSensor,
    /// Of the pack's voltage in V.
    pub pack_v: VoltstepBmsSensor,
    /// Of the voltage behind the contactors in V.
    pub link_v: VoltstepBmsSensor,
}

/// What opens the circuit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsActuators {
    /// From the command until the contactor is open in s; above zero.
    pub open_s: f32,
    /// How long an opening for safety waits for a smaller current in s; zero or above.
    pub wait_s: f32,
    /// The largest current that a contactor breaks without harm in A; above zero.
    pub break_a: f32,
}

/// All that the rows of protection are derived from.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsSheet {
    /// One cell.
    pub cell: VoltstepBmsCellSheet,
    /// How many of them.
    pub layout: VoltstepBmsLayout,
    /// What measures them.
    pub sensing: VoltstepBmsSensing,
    /// What protects them.
    pub actuators: VoltstepBmsActuators,
    /// Time between two calls in s, 0.0001..0.005.
    pub tick_s: f32,
    /// Calls in which every cell and every temperature is looked at once; at least 1, together at most
    /// 25 ms.
    pub sweep_ticks: u16,
}

/// How alike the cells are.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsAlike {
    /// Series resistance of a new cell at 25 degC in ohm; above zero.
    pub resistance_ohm: f32,
    /// Standard deviation of the cells' resistances, a ratio; above zero.
    pub resistance_sd: f32,
    /// Standard deviation of their capacities, a ratio 0..1.
    pub capacity_sd: f32,
    /// Standard deviation of their states of charge at the start, a ratio; above 0, up to 1.
    pub soc_sd: f32,
    /// How far one wanders from the others in a day, as a state of charge, 0..1.
    pub drift_sd_per_day: f32,
}

/// Precharge of the link.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsPrecharge {
    /// Resistor in ohm; above zero.
    pub resistor_ohm: f32,
    /// Capacitance of the link in F; above zero; with the resistor two steps at least.
    pub link_f: f32,
    /// By what factor the time constant may be off; above 1.
    pub tau_factor: f32,
    /// Noise of the voltage difference between pack and link in V; zero or above.
    pub noise_v: f32,
    /// Noise of the current in A; zero or above.
    pub noise_a: f32,
    /// The link is charged when it lacks no more than this, in V; above zero.
    pub done_v: f32,
    /// Samples in a row before any verdict, 2..100.
    pub count: u8,
    /// From the feedback until current flows, bouncing included, in s; zero or above.
    pub lag_s: f32,
    /// What the resistor may take up at once in J; above zero.
    pub budget_j: f32,
    /// What a precharge into a short costs until it is told in J; below the budget.
    pub short_j: f32,
    /// Time constant with which it cools down in s; above zero.
    pub cooling_s: f32,
}

/// How long the contactors may take.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsContactors {
    /// Until everything was seen after a reset in s; above zero.
    pub start_limit_s: f32,
    /// With minus closed alone, to see whether the link rises, in s; above zero.
    pub settle_s: f32,
    /// Until a contactor shows closed in s; above `settle_s`.
    pub close_limit_s: f32,
    /// Until the link is charged in s; above zero.
    pub precharge_limit_s: f32,
    /// Until a contactor shows open in s; above zero.
    pub open_limit_s: f32,
    /// For a current that can be broken, where there is time, in s; at least `hard_limit_s`.
    pub shed_limit_s: f32,
    /// For such a current at a safety limit in s; above zero.
    pub hard_limit_s: f32,
    /// For the link to fall in s; above zero.
    pub weld_limit_s: f32,
    /// Before the next try in s; above zero.
    pub cooldown_s: f32,
    /// Tries of a precharge that are allowed to fail while one request stands, 1..10.
    pub tries: u8,
}

/// What bleeds cells.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsBalancing {
    /// Resistor across a cell in ohm; above zero.
    pub bleed_ohm: f32,
    /// The most channels at once; at least 1.
    pub channels: u16,
    /// No bleeding with the board warmer than this, in degC.
    pub board_max_c: f32,
}

/// All that a BMS is made from. Start from `voltstep_bms_params_typical`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepBmsParams {
    /// `VOLTSTEP_ABI`.
    pub abi: u32,
    /// Temperatures: the number that the library is built for.
    pub sensors: u32,
    /// Cell, layout, sensors and contactors, in the terms of their data sheets.
    pub sheet: VoltstepBmsSheet,
    /// The map of one cell, as `voltstep identify battery` finds it.
    pub cell: VoltstepCellParams,
    /// How alike the cells are.
    pub alike: VoltstepBmsAlike,
    /// Standard deviation of the pack's current sensor's offset in A; zero or above.
    pub current_offset_sd_a: f32,
    /// Standard deviation of its gain, a ratio 0..1.
    pub current_gain_sd: f32,
    /// How late voltages may be for the current in s; zero or above.
    pub skew_s: f32,
    /// Time between two samples of the filter in s, 0.05..0.25, a whole part of a second and a whole
    /// number of ticks.
    pub sample_s: f32,
    /// What counts as a rest in s; above zero.
    pub rest_s: f32,
    /// What counts as empty, a ratio 0..1.
    pub empty_soc: f32,
    /// Precharge of the link.
    pub precharge: VoltstepBmsPrecharge,
    /// How long contactors may take.
    pub contactors: VoltstepBmsContactors,
    /// What bleeds cells.
    pub balancing: VoltstepBmsBalancing,
}
