//! The columns of a trace.

use crate::read::trip::Trip;
use crate::simulate::run::{Run, TraceRow};

/// A column of the trace: its name and how to read it.
pub type Column = (&'static str, fn(&TraceRow) -> f64);

const COLUMNS: [Column; 18] = [
    ("time_s", |r| r.time_s),
    ("reference_m_s", |r| f64::from(r.reference_m_s)),
    ("speed_m_s", |r| f64::from(r.speed_m_s)),
    ("distance_m", |r| f64::from(r.distance_m)),
    ("slope_sin", |r| f64::from(r.slope_sin)),
    ("duty", |r| f64::from(r.duty)),
    ("motor_torque_nm", |r| f64::from(r.motor_torque_nm)),
    ("brake_n", |r| f64::from(r.brake_n)),
    ("motor_current_a", |r| f64::from(r.motor_current_a)),
    ("battery_current_a", |r| f64::from(r.battery_current_a)),
    ("battery_voltage_v", |r| f64::from(r.battery_voltage_v)),
    ("soc", |r| f64::from(r.soc)),
    // Lowest and highest of every step since the row before; the first row has no step.
    ("motor_torque_min_nm", |r| f64::from(r.extremes.motor_torque_nm.0)),
    ("motor_torque_max_nm", |r| f64::from(r.extremes.motor_torque_nm.1)),
    ("battery_current_min_a", |r| f64::from(r.extremes.battery_current_a.0)),
    ("battery_current_max_a", |r| f64::from(r.extremes.battery_current_a.1)),
    ("battery_voltage_min_v", |r| f64::from(r.extremes.battery_voltage_v.0)),
    ("battery_voltage_max_v", |r| f64::from(r.extremes.battery_voltage_v.1)),
];

/// Those of a vehicle that has temperatures.
const WARM: [Column; 2] = [
    ("machine_c", |r| r.temperatures.map_or(f64::NAN, |t| f64::from(t.machine_c))),
    ("inverter_c", |r| r.temperatures.map_or(f64::NAN, |t| f64::from(t.inverter_c))),
];

/// The columns that a run has.
pub fn columns(run: &Run) -> impl Iterator<Item = &'static Column> {
    let warm = if run.totals.temperatures.is_some() { &WARM[..] } else { &[] };
    COLUMNS.iter().chain(warm)
}

/// What was measured on a trip, at the same rows.
#[must_use]
pub fn measured(trip: &Trip) -> Vec<(&'static str, &[f64])> {
    vec![
        ("measured_motor_torque_nm", trip.motor_torque_nm.as_slice()),
        ("measured_battery_current_a", &trip.battery_a),
        ("measured_battery_voltage_v", &trip.battery_v),
        ("measured_soc", &trip.soc),
    ]
}
