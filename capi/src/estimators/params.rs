//! The parameters of the estimators as C sees them: of a cell, or of a pack as one.

use crate::params::VOLTSTEP_SOC_POINTS;

/// Lengths of time that the power limits look ahead.
pub const VOLTSTEP_HORIZONS: usize = 3;

/// Parameter sets of cells that come with the library, with the estimators' own to match.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepCellPreset {
    /// Panasonic NCR18650PF, identified from drive cycles; sensors of a production car.
    PanasonicNcr18650Pf = 0,
}

/// A resistance over state of charge and temperature:
/// `ohm(soc) * exp(activation_k * (1/T - 1/298.15 K))`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepResistanceMap {
    /// At 25 degC and state of charge i/64, in ohm; zero or above.
    pub ohm: [f32; VOLTSTEP_SOC_POINTS],
    /// Activation temperature in K, 0..20000; 0 for no dependence on temperature.
    pub activation_k: f32,
}

/// A cell, or a pack as one: resistances over state of charge and temperature, two RC branches,
/// hysteresis, a thermal node.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCellParams {
    /// Charge between state of charge 0 and 1, in A h; above zero.
    pub capacity_ah: f32,
    /// Largest discharge current in A; above zero, infinity for none.
    pub discharge_limit_a: f32,
    /// Largest charge current in A; above zero, infinity for none.
    pub charge_limit_a: f32,
    /// How often resistances follow state of charge and temperature, in s; above zero.
    pub refresh_s: f32,
    /// Open-circuit voltage at state of charge i/64, in V; zero or above, must not fall.
    pub open_circuit_v: [f32; VOLTSTEP_SOC_POINTS],
    /// Half the gap between the curves of charge and discharge, in V; zero or above.
    pub hysteresis_half_gap_v: f32,
    /// How fast a change of the state of charge moves from one curve to the other, a ratio; zero or
    /// above.
    pub hysteresis_rate_per_soc: f32,
    /// Series resistance.
    pub series: VoltstepResistanceMap,
    /// Resistance of the faster RC branch.
    pub polarisation: VoltstepResistanceMap,
    /// Its time constant in s; above zero.
    pub polarisation_time_constant_s: f32,
    /// Resistance of the slower RC branch; zeros for no such branch.
    pub second_polarisation: VoltstepResistanceMap,
    /// Its time constant in s; above zero.
    pub second_polarisation_time_constant_s: f32,
    /// Heat capacity in J/K; above zero, infinity: the temperature stays as it is.
    pub heat_capacity_j_per_k: f32,
    /// Cooling to the surroundings in W/K; zero or above.
    pub cooling_w_per_k: f32,
    /// Temperature of the surroundings in degC, -100..200.
    pub ambient_c: f32,
    /// Lowest state of charge at which all this was identified, a ratio 0..1.
    pub identified_soc_min: f32,
    /// Highest such state of charge, above the lowest, up to 1.
    pub identified_soc_max: f32,
    /// Lowest temperature at which all this was identified, in degC, -100..200.
    pub identified_temperature_min_c: f32,
    /// Highest such temperature in degC, not below the lowest, up to 200.
    pub identified_temperature_max_c: f32,
}

/// The filter: how well cell and sensors are known, as standard deviations of what stays wrong, not
/// of noise.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepFilterParams {
    /// Of the open-circuit curve, in V; above zero.
    pub open_circuit_sd_v: f32,
    /// Of all resistances at 25 degC, as a ratio to them; zero or above.
    pub resistance_sd: f32,
    /// Of their activation temperature, in K; zero or above.
    pub activation_sd_k: f32,
    /// Of the capacity, as a ratio to it; zero or above.
    pub capacity_sd: f32,
    /// Of the current sensor's offset, in A; zero or above.
    pub current_offset_sd_a: f32,
    /// Of the current that flows while nothing is measured, the contactors open, in A; zero or
    /// above.
    pub standby_sd_a: f32,
    /// Of one voltage sample, noise and resolution, in V; above zero.
    pub voltage_sd_v: f32,
    /// Of the polarisation at a start that is not rested, in V; zero or above.
    pub polarisation_sd_v: f32,
    /// The change of the state of charge after which the curve's error is another one, a ratio;
    /// above 0, up to 1.
    pub correlation_soc: f32,
    /// How many times larger the model's error is outside the identified range; 1 or above.
    pub outside_factor: f32,
    /// Where the open-circuit curve rises by less than this, in V per unit of state of charge, the
    /// voltage does not correct; zero or above.
    pub flat_v_per_soc: f32,
    /// The standard deviation below which the state of charge counts as known, a ratio; above 0, up
    /// to 1.
    pub converged_sd: f32,
    /// The standard deviation of the current that flows while none is measured, in A; above zero,
    /// infinity: the state of charge is unknown after any gap.
    pub unseen_current_a: f32,
}

/// The coulomb counter: its sensor, and when a rest puts it right.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCounterParams {
    /// Standard deviation of the cell's capacity, in A h; zero or above.
    pub capacity_sd_ah: f32,
    /// Share of the charging current that stays in the cell; above 0, up to 1.
    pub charge_efficiency: f32,
    /// Standard deviation of the sensor's constant offset, in A; zero or above.
    pub offset_sd_a: f32,
    /// Standard deviation of its gain, a ratio; zero or above.
    pub gain_sd: f32,
    /// The largest current of either sign that can flow, in A; above zero. A reading above is none.
    pub largest_current_a: f32,
    /// Standard deviation of a rested voltage from the open-circuit curve, in V; above zero.
    pub rest_voltage_sd_v: f32,
    /// At rest the current's magnitude is at most this, in A; above zero.
    pub rest_current_a: f32,
    /// How long a rest takes until its voltage is believed, in s; above zero.
    pub rest_s: f32,
}

/// How alike the cells in series are, and how well their voltages are measured.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCellsParams {
    /// Standard deviation of the noise of a cell's voltage, in V, 1e-6..1.
    pub noise_sd_v: f32,
    /// Standard deviation of what stays between its voltage and the curve, in V, 0..1.
    pub offset_sd_v: f32,
    /// Standard deviation of the cells' resistances, polarisation included, in ohm, 0..1.
    pub resistance_sd_ohm: f32,
    /// Standard deviation of their capacities, a ratio 0..1.
    pub capacity_sd: f32,
    /// Standard deviation of their states of charge at the start, a ratio; above 0, up to 1.
    pub soc_sd: f32,
    /// How far a cell wanders from the others in a day, as a standard deviation of the state of
    /// charge, 0..1.
    pub drift_sd_per_day: f32,
    /// While the mean's own standard deviation is above this ratio, the cells are held; 0..1.
    pub pack_soc_sd_max: f32,
    /// Lowest voltage that a cell can have, in V, within +-100; a reading below is none.
    pub voltage_min_v: f32,
    /// Highest voltage that a cell can have, in V, above the lowest, within +-100.
    pub voltage_max_v: f32,
}

/// How each cell's resistance is learnt.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCellResistancesParams {
    /// Of a new cell between two samples, about its series resistance, in ohm; above zero.
    pub resistance_ohm: f32,
    /// How alike the cells are: standard deviation as a ratio to that; above zero.
    pub spread_sd: f32,
    /// Standard deviation of the noise of a cell's voltage, in V; above zero.
    pub noise_sd_v: f32,
    /// The smallest change of the current to learn from, in A; above zero.
    pub least_step_a: f32,
    /// How many such changes are remembered; above 1.
    pub memory_steps: f32,
}

/// How the resistance of the mean is learnt.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepResistanceParams {
    /// Standard deviation of a voltage reading, quantum included, in V; above zero.
    pub voltage_sd_v: f32,
    /// Standard deviation of a current reading, quantum included, in A; above zero.
    pub current_sd_a: f32,
    /// The smallest change of the current to learn from, in A; above zero.
    pub least_step_a: f32,
    /// How many such changes are remembered; above 1.
    pub memory_steps: f32,
    /// Standard deviation of the factor before anything was learnt; above zero.
    pub initial_sd: f32,
    /// Voltage and current of a sample may be so far apart in time, in s; zero or above.
    pub skew_s: f32,
}

/// How the capacity is learnt.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCapacityParams {
    /// Standard deviation of the cell's capacity before anything was learnt, in A h; above zero.
    pub nominal_sd_ah: f32,
    /// Standard deviation of the noise of one current reading, in A; zero or above.
    pub current_noise_sd_a: f32,
    /// Standard deviation of the sensor's constant offset, in A; above zero.
    pub current_offset_sd_a: f32,
    /// Standard deviation of its gain, a ratio; zero or above.
    pub current_gain_sd: f32,
    /// The smallest change of the state of charge to learn from, a ratio; above zero.
    pub least_soc_change: f32,
    /// The same in multiples of its own standard deviation; above zero.
    pub least_soc_change_sds: f32,
    /// How many pairs of rests are remembered; above 1.
    pub memory_pairs: f32,
}

/// The share of the largest current at a temperature: none outside, all within, a line in between.
/// In degC, each not below the one before.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepTemperatureWindow {
    /// None below.
    pub none_below_c: f32,
    /// All from here on.
    pub all_from_c: f32,
    /// All up to here.
    pub all_to_c: f32,
    /// None above.
    pub none_above_c: f32,
}

/// The limits that the state of power keeps, beside the cell's largest currents.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepPowerParams {
    /// Lowest voltage at the terminals, in V; above zero.
    pub voltage_min_v: f32,
    /// Highest voltage at the terminals, in V; above the lowest.
    pub voltage_max_v: f32,
    /// Lowest state of charge, a ratio 0..1.
    pub soc_min: f32,
    /// Highest state of charge, above the lowest, up to 1.
    pub soc_max: f32,
    /// How many standard deviations to stay away from every limit; zero or above.
    pub margin_sds: f32,
    /// How long the currents must hold, in s; above zero and rising.
    pub horizons_s: [f32; VOLTSTEP_HORIZONS],
    /// Temperatures at which it may be discharged.
    pub discharge_window: VoltstepTemperatureWindow,
    /// Temperatures at which it may be charged.
    pub charge_window: VoltstepTemperatureWindow,
}

/// What counts as empty and as full.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepEnergyParams {
    /// State of charge at which it counts as empty, a ratio 0..1.
    pub empty_soc: f32,
    /// State of charge at which it counts as full, above that, up to 1.
    pub full_soc: f32,
    /// Voltage at the terminals at which it counts as empty, too, in V; 0 for none.
    pub empty_v: f32,
    /// A current below this is none, for the times, in A; above zero.
    pub least_a: f32,
}

/// Everything that the estimators are told. Start from `voltstep_estimator_params_preset` and change
/// what differs. All in the units of one cell, or all in those of a pack as one.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepEstimatorParams {
    /// `VOLTSTEP_ABI`.
    pub abi: u32,
    /// The cell.
    pub cell: VoltstepCellParams,
    /// The filter.
    pub filter: VoltstepFilterParams,
    /// The coulomb counter.
    pub counter: VoltstepCounterParams,
    /// The cells in series.
    pub cells: VoltstepCellsParams,
    /// Their resistances.
    pub cell_resistances: VoltstepCellResistancesParams,
    /// Resistance of the mean.
    pub resistance: VoltstepResistanceParams,
    /// Capacity of the mean.
    pub capacity: VoltstepCapacityParams,
    /// State of power.
    pub power: VoltstepPowerParams,
    /// Energy and time left.
    pub energy: VoltstepEnergyParams,
}
