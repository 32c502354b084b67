//! The trace of a replay as CSV.

use crate::read::trip::Trip;
use crate::simulate::run::{Run, TraceRow};

/// A column of the trace: its name and how to read it.
type Column = (&'static str, fn(&TraceRow) -> f64);

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

/// The trace as CSV; on trips with the measured values beside ours. A missing one is empty.
pub fn csv(run: &Run, trip: Option<&Trip>) -> anyhow::Result<Vec<u8>> {
    let measured: Vec<(&str, &[f64])> = trip.map_or_else(Vec::new, |t| {
        vec![
            ("measured_motor_torque_nm", t.motor_torque_nm.as_slice()),
            ("measured_battery_current_a", &t.battery_a),
            ("measured_battery_voltage_v", &t.battery_v),
            ("measured_soc", &t.soc),
        ]
    });
    let mut writer = csv::Writer::from_writer(Vec::new());
    let warm = if run.totals.temperatures.is_some() { &WARM[..] } else { &[] };
    let columns: Vec<_> = COLUMNS.iter().chain(warm).collect();
    writer.write_record(columns.iter().map(|c| c.0).chain(measured.iter().map(|m| m.0)))?;
    for (i, row) in run.trace.iter().enumerate() {
        // Six significant digits at least, and no noise of the conversion from f32.
        let ours = columns.iter().map(|c| number(c.1(row)));
        let theirs = measured.iter().map(|m| number(m.1.get(i).copied().unwrap_or(f64::NAN)));
        writer.write_record(ours.chain(theirs))?;
    }
    writer.into_inner().map_err(|e| anyhow::anyhow!("writing the trace: {e}"))
}

/// A number as short as single precision allows; none where it is not finite.
#[expect(clippy::cast_possible_truncation, reason = "single precision is what was computed")]
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    // As f32 the shortest text that reads back the same.
    let value = value as f32;
    let text = value.to_string();
    if text.len() > 12 { format!("{value:e}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        for value in [0.0, 0.1, 389.25, -12.5, 1e-7, 123_456.7, -3.456_789e-4, 1e-30, 1e30] {
            let text = number(value);
            let back: f64 = text.parse().unwrap();
            assert!((back - value).abs() <= 1e-6 * value.abs(), "{value}: {text}");
        }
        assert_eq!(number(f64::NAN), "");
    }
}
