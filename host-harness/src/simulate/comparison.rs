//! Ours against what was measured on a trip.

use serde::Serialize;

use crate::read::trip::Trip;
use crate::simulate::figures::Figures;
use crate::simulate::run::{Run, TraceRow};

/// How far a replay is from the measurement; ours minus measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// Root mean square of the difference in state of charge, 0..1.
    pub soc_rmse: f64,
    /// Difference of the last state of charge.
    pub soc_final: f64,
    /// Difference of the drop in state of charge, relative to the measured drop.
    pub soc_drop_rel: f64,
    /// Root mean square of the difference in battery voltage \[V\].
    pub voltage_rmse_v: f64,
    /// Largest difference in battery voltage \[V\].
    pub voltage_max_v: f64,
    /// Root mean square of the difference in battery current \[A\].
    pub current_rmse_a: f64,
    /// Root mean square of the difference in motor torque \[N·m\]; absent where none was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_rmse_nm: Option<f64>,
    /// Difference of the net energy at the battery's terminals, relative to the measured one.
    pub energy_rel: f64,
    /// Samples without a state of charge, left out of the comparison.
    pub soc_samples_missing: usize,
}

/// Root mean square and largest magnitude of a difference, over the samples that have both.
fn spread(ours: impl Iterator<Item = f64>, measured: &[f64]) -> Option<(f64, f64)> {
    let (mut squares, mut largest, mut count) = (0.0, 0.0_f64, 0.0);
    for (a, b) in ours.zip(measured) {
        if b.is_finite() {
            squares += (a - b) * (a - b);
            largest = largest.max((a - b).abs());
            count += 1.0;
        }
    }
    (count > 0.0).then(|| (f64::sqrt(squares / count), largest))
}

/// What was measured, as the same figures; and how far the run is from it.
///
/// The run's trace has a row for each sample of the trip.
#[must_use]
pub fn compare(run: &Run, trip: &Trip) -> (Figures, Deviation) {
    let ours = |pick: fn(&TraceRow) -> f32| run.trace.iter().map(move |row| f64::from(pick(row)));
    let extremes = |values: &[f64]| {
        let finite = values.iter().copied().filter(|v| v.is_finite());
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let energy_j: f64 = (1..trip.time_s.len())
        .map(|i| {
            let power = |j: usize| trip.battery_v[j] * trip.battery_a[j];
            0.5 * (power(i) + power(i - 1)) * (trip.time_s[i] - trip.time_s[i - 1])
        })
        .sum();
    let (current_low, current_high) = extremes(&trip.battery_a);
    let (torque_low, torque_high) = extremes(&trip.motor_torque_nm);
    let torque = torque_low.is_finite().then_some((torque_low, torque_high));
    let soc_initial = trip.first_soc().unwrap_or(f64::NAN);
    let soc_final = trip.last_soc().unwrap_or(f64::NAN);
    let measured = Figures::new(
        trip.distance_km(),
        (soc_initial, soc_final),
        energy_j,
        torque,
        (current_low, current_high),
        extremes(&trip.battery_v).0,
    );

    let last = trip.soc.iter().rposition(|s| s.is_finite()).unwrap_or(0);
    let our_final = f64::from(run.trace.get(last).map_or(f32::NAN, |row| row.soc));
    let our_initial = f64::from(run.trace.first().map_or(f32::NAN, |row| row.soc));
    let measured_drop = soc_initial - soc_final;
    let voltage = spread(ours(|r| r.battery_voltage_v), &trip.battery_v).unwrap_or_default();
    let torque_rmse = (run.trace.iter().any(|r| r.motor_torque_nm != 0.0))
        .then(|| spread(ours(|r| r.motor_torque_nm), &trip.motor_torque_nm))
        .flatten();
    let deviation = Deviation {
        soc_rmse: spread(ours(|r| r.soc), &trip.soc).unwrap_or_default().0,
        soc_final: our_final - soc_final,
        soc_drop_rel: (our_initial - our_final - measured_drop) / measured_drop,
        voltage_rmse_v: voltage.0,
        voltage_max_v: voltage.1,
        current_rmse_a: spread(ours(|r| r.battery_current_a), &trip.battery_a)
            .unwrap_or_default()
            .0,
        torque_rmse_nm: torque_rmse.map(|t| t.0),
        energy_rel: (run.totals.battery_energy_j - energy_j) / energy_j,
        soc_samples_missing: trip.soc.iter().filter(|s| !s.is_finite()).count(),
    };
    (measured, deviation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::run::Totals;
    use std::time::Duration;

    #[test]
    fn finds_a_known_deviation_and_leaves_missing_samples_out() {
        let n = 11;
        let trip = Trip {
            time_s: (0..n).map(f64::from).collect(),
            speed_m_s: vec![10.0; 11],
            battery_v: vec![400.0; 11],
            battery_a: vec![10.0; 11],
            soc: (0..n)
                .map(|i| if i == 3 { f64::NAN } else { 0.9 - 0.001 * f64::from(i) })
                .collect(),
            ..Trip::empty("t", 11)
        };
        let trace = (0..n)
            .map(|i| TraceRow {
                time_s: f64::from(i),
                battery_voltage_v: if i == 5 { 397.0 } else { 401.0 },
                battery_current_a: 12.0,
                soc: 0.9 - 0.0012 * i as f32,
                ..TraceRow::default()
            })
            .collect();
        let totals = Totals { battery_energy_j: 44_000.0, ..Totals::default() };
        let run = Run {
            dt_s: 1.0,
            steps: 10,
            wall: Duration::from_millis(1),
            trace,
            totals,
            energy: None,
        };
        let (measured, deviation) = compare(&run, &trip);
        assert!((measured.battery_energy_kwh - 40_000.0 / 3.6e6).abs() < 1e-9);
        assert!(
            (measured.distance_km - 0.1).abs() < 1e-9 && measured.motor_torque_min_nm.is_none()
        );
        assert!((deviation.energy_rel - 0.1).abs() < 1e-9);
        assert!((deviation.soc_drop_rel - 0.2).abs() < 1e-4, "{deviation:?}");
        assert!((deviation.current_rmse_a - 2.0).abs() < 1e-9);
        assert!((deviation.voltage_rmse_v - f64::sqrt((10.0 + 9.0) / 11.0)).abs() < 1e-9);
        assert_eq!((deviation.voltage_max_v, deviation.soc_samples_missing), (3.0, 1));
        assert!(deviation.torque_rmse_nm.is_none());
    }
}
