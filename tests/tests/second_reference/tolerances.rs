//! How far plant-core may lie from each reference trace, and why. Each figure is some 1.4 times what
//! was measured.

/// How a trace's differences become one number.
#[derive(Clone, Copy)]
pub enum Of {
    /// The largest.
    Max,
    /// The root of the mean square: for currents that ring, where one sample says little.
    Rms,
}
use Of::{Max, Rms};

/// Trace, column, measure, and the difference allowed at 1 ms and at 0.1 ms, in the column's unit.
/// The method is of first order: the second is a tenth of the first, down to where f32 rounds.
pub const TOLERANCES: &[(&str, &str, Of, [f64; 2])] = &[
    // Backward Euler's error on the steep flank after the voltage step.
    ("motor_pasek", "current_a", Max, [1.4e-1, 1.4e-2]),
    ("motor_pasek", "speed_rad_s", Max, [9.3e-1, 9.4e-2]),
    ("motor_moments", "current_a", Max, [8.7e-2, 8.8e-3]),
    ("motor_moments", "speed_rad_s", Max, [1.3e0, 1.3e-1]),
    ("motor_pasek_static", "current_a", Max, [1.4e-1, 1.4e-2]),
    ("motor_pasek_static", "speed_rad_s", Max, [9.3e-1, 9.4e-2]),
    ("motor_moments_static", "current_a", Max, [8.7e-2, 8.8e-3]),
    ("motor_moments_static", "speed_rad_s", Max, [1.3e0, 1.3e-1]),
    // Charge and RC branch, down to f32: 3e-5 V is one digit at 390 V, 6e-8 one of the SOC.
    ("battery_table", "soc", Max, [6.4e-8, 6.7e-8]),
    ("battery_table", "rc_v", Max, [1.6e-6, 1.6e-7]),
    ("battery_table", "terminal_v", Max, [6.1e-5, 4.5e-5]),
    ("battery_slow", "soc", Max, [6.4e-8, 6.7e-8]),
    ("battery_slow", "rc_v", Max, [1.1e-5, 1.2e-6]),
    ("battery_slow", "terminal_v", Max, [6.7e-5, 4.3e-5]),
    // A sampled controller acts one step late.
    ("pid_step", "output", Max, [2.1e-2, 2e-3]),
    ("pid_step", "measurement", Max, [1.9e-3, 1.9e-4]),
    ("pid_sine", "output", Max, [1.3e-2, 1.3e-3]),
    ("pid_sine", "measurement", Max, [1.7e-3, 1.7e-4]),
    // Speed is nearly exact; x += h·v' counts half a step of the speed lost since.
    ("body_flat", "speed_m_s", Max, [2e-6, 1.9e-6]),
    ("body_flat", "distance_m", Max, [2.2e-2, 2.2e-3]),
    ("body_uphill", "speed_m_s", Max, [7e-5, 2.2e-6]),
    ("body_uphill", "distance_m", Max, [1.9e-2, 2.5e-3]),
    ("body_downhill", "speed_m_s", Max, [1.2e-6, 1.2e-6]),
    ("body_downhill", "distance_m", Max, [9.3e-3, 9.1e-4]),
    // 25 mΩ: currents of thousands of amperes. The energy is a sum of the steps' ends.
    ("bench_open", "motor_a", Max, [5.3e0, 5.4e-1]),
    ("bench_open", "speed_rad_s", Max, [1.3e-1, 1.3e-2]),
    ("bench_open", "supply_a", Max, [1.6e0, 1.6e-1]),
    ("bench_open", "energy_j", Max, [5.8e2, 5.8e1]),
    ("bench_closed", "motor_a", Max, [5.1e-1, 5.1e-2]),
    ("bench_closed", "speed_rad_s", Max, [2.5e-3, 2.6e-4]),
    ("bench_closed", "supply_a", Max, [8.3e-2, 8.4e-3]),
    ("bench_closed", "energy_j", Max, [1.6e2, 1.6e1]),
    // More is drawn at coarse steps: 0.1 % at 1 ms. The speed is at the last digit of f32 at both
    // steps, and the sampled currents fall less than tenfold; the f64 twin was not tried here.
    // The second set draws twice the charge, so its SOC is off by twice as much.
    ("udds", "speed_m_s", Rms, [8.6e-7, 6.6e-7]),
    ("udds", "distance_m", Max, [1.9e-2, 1.9e-3]),
    ("udds", "soc", Max, [8.5e-5, 8.4e-6]),
    ("udds", "motor_a", Rms, [2.2e-2, 9.9e-3]),
    ("udds", "battery_a", Rms, [3.8e-3, 2.2e-3]),
    ("udds_table", "speed_m_s", Rms, [7.3e-7, 6.6e-7]),
    ("udds_table", "distance_m", Max, [1.9e-2, 1.9e-3]),
    ("udds_table", "soc", Max, [1.8e-4, 1.8e-5]),
    ("udds_table", "motor_a", Rms, [2.5e-2, 2e-2]),
    ("udds_table", "battery_a", Rms, [4.2e-3, 3.6e-3]),
];

/// End values of UDDS: the relative difference allowed at 1 ms and at 0.1 ms. Currents peak while
/// the loop rings at 33 Hz, of which a step of 1 ms resolves a thirtieth.
pub const END_TOLERANCES: &[(&str, [f64; 2])] = &[
    ("energy_kwh", [1.5e-3, 1.5e-4]),
    ("torque_min_nm", [3e-3, 2.5e-4]),
    ("torque_max_nm", [3.4e-3, 1.6e-4]),
    ("battery_min_a", [4.4e-2, 4.7e-3]),
    ("battery_max_a", [8.3e-2, 8.1e-3]),
];
