//! The figures of a replay, as JSON.

use std::collections::BTreeMap;

use plant_core::machine::Temperatures;
use plant_core::powertrain::ledger::EnergyReport;
use serde::Serialize;

use crate::simulate::comparison::Deviation;
use crate::simulate::figures::{Figures, J_PER_KWH};
use crate::simulate::mode::Replayed;
use crate::simulate::run::Run;

/// Above this share of the throughput the step's own dissipation is worth a warning.
pub const NUMERICAL_WARNING: f64 = 0.01;

/// Everything that `summary.json` says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The vehicle's name.
    pub vehicle: String,
    /// The cycle's or trip's name.
    pub input: String,
    /// What was replayed.
    pub mode: Replayed,
    /// The step \[s\].
    pub dt_s: f64,
    /// How many steps.
    pub steps: u64,
    /// Time spent stepping \[s\].
    pub run_wall_s: f64,
    /// Simulated time over time spent stepping.
    pub realtime_factor: f64,
    /// What the run came to.
    #[serde(flatten)]
    pub figures: Figures,
    /// Root mean square of the speed error over every step \[m/s\]; absent in battery mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_error_rms_m_s: Option<f64>,
    /// Largest speed error over every step \[m/s\]; absent in battery mode.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_error_max_m_s: Option<f64>,
    /// Steps in which a limit acted.
    pub limited_steps: u64,
    /// How hot the drives became; of a vehicle that has temperatures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_temperatures: Option<Hottest>,
    /// Charge that the battery refused \[A·h\]; battery mode only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused_charge_ah: Option<f64>,
    /// Every term of the energy ledger \[kWh\]; absent where none was kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<BTreeMap<&'static str, f64>>,
    /// What the ledger does not explain, over the throughput; absent where none was kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_residual_rel: Option<f64>,
    /// What the step costs, where it is longer than the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_error: Option<StepError>,
    /// What was measured; on trips.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<Figures>,
    /// Ours minus measured; on trips.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<Deviation>,
    /// What the user should know: quirks of the data, warnings.
    pub notes: Vec<String>,
}

/// The highest temperatures of a run, of several drives those of the hottest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hottest {
    /// The machine \[°C\].
    pub machine_max_c: f64,
    /// The inverter \[°C\].
    pub inverter_max_c: f64,
    /// What they left of the current limit at least, 0..1.
    pub current_limit_left_min: f64,
}

impl From<Temperatures> for Hottest {
    fn from(worst: Temperatures) -> Self {
        Self {
            machine_max_c: f64::from(worst.machine_c),
            inverter_max_c: f64::from(worst.inverter_c),
            current_limit_left_min: f64::from(worst.left),
        }
    }
}

/// What a long step costs: the difference from a run in steps of the default length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepError {
    /// Of the net energy at the battery's terminals, relative.
    pub energy_rel: f64,
    /// Of the speed at the rows of the trace, root mean square \[m/s\].
    pub speed_rms_m_s: f64,
}

impl Summary {
    /// The figures of a run.
    #[must_use]
    pub fn new(vehicle: &str, input: &str, mode: Replayed, run: &Run, duration_s: f64) -> Self {
        let (first, last) = (run.trace.first(), run.trace.last());
        let totals = &run.totals;
        let pair = |(a, b): (f32, f32)| (f64::from(a), f64::from(b));
        let drives = mode.drives();
        let distance_km = last.map_or(0.0, |r| f64::from(r.distance_m) / 1000.0);
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        let steps = run.steps as f64;
        let mut notes = Vec::new();
        if let Some(share) = run.energy.as_ref().and_then(numerical_share)
            && share > NUMERICAL_WARNING
        {
            notes.push(format!(
                "the step itself dissipates {:.1} % of the throughput: choose a shorter one",
                100.0 * share
            ));
        }
        notes.extend(limits(run));
        if totals.limit_exceeded_a > EXCEEDED_A {
            let by_a = totals.limit_exceeded_a;
            notes.push(format!(
                "the battery's limit was exceeded all the same, by up to {by_a:.1} A"
            ));
        }
        if let Some(worst) = totals.temperatures
            && worst.left < 1.0
        {
            let left = 100.0 * worst.left;
            notes.push(format!("a hot drive left {left:.0} % of its current limit at least"));
        }
        if drives {
            notes.extend(not_followed(run));
        }
        notes.extend(emptied(run));
        let exchanged_kwh = totals.battery_energy_j.abs() / J_PER_KWH;
        if exchanged_kwh > 0.0 && exchanged_kwh < PRINTED_KWH {
            notes.push(format!(
                "the energies are below what the table shows: {:.3e} kWh at the battery; \
                 summary.json has them all",
                totals.battery_energy_j / J_PER_KWH
            ));
        }
        Self {
            vehicle: vehicle.to_owned(),
            input: input.to_owned(),
            mode,
            dt_s: run.dt_s,
            steps: run.steps,
            run_wall_s: run.wall.as_secs_f64(),
            realtime_factor: duration_s / run.wall.as_secs_f64(),
            figures: Figures::new(
                distance_km,
                (
                    first.map_or(f64::NAN, |r| f64::from(r.soc)),
                    last.map_or(f64::NAN, |r| f64::from(r.soc)),
                ),
                totals.battery_energy_j,
                drives.then(|| pair(totals.motor_torque_nm)),
                pair(totals.battery_current_a),
                f64::from(totals.battery_voltage_min_v),
            ),
            speed_error_rms_m_s: drives.then(|| f64::sqrt(totals.speed_error_squares / steps)),
            speed_error_max_m_s: drives.then(|| f64::from(totals.speed_error_max_m_s)),
            limited_steps: totals.limited.any(),
            drive_temperatures: totals.temperatures.map(Hottest::from),
            refused_charge_ah: (!drives).then(|| totals.refused_charge_c / 3600.0),
            energy: run.energy.map(|report| {
                report.terms().into_iter().map(|(n, j)| (n, f64::from(j) / J_PER_KWH)).collect()
            }),
            energy_residual_rel: run.energy.map(|report| f64::from(report.residual_rel())),
            step_error: None,
            measured: None,
            error: None,
            notes,
        }
    }
}

/// Which limits acted, and for how long, in words.
#[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
fn limits(run: &Run) -> Vec<String> {
    let limited = run.totals.limited;
    [
        (limited.discharge, "the battery's limit of discharging"),
        (limited.charge, "the battery's limit of charging"),
        (limited.current, "the current limit of a drive"),
        (limited.duty, "the limit of the duty"),
    ]
    .into_iter()
    .filter(|(steps, _)| *steps > 0)
    .map(|(steps, limit)| format!("{limit} acted during {:.1} s", run.dt_s * steps as f64))
    .collect()
}

/// A limit that is exceeded by less is held, but for rounding \[A\].
const EXCEEDED_A: f32 = 0.05;
/// Speeds that differ by more for longer than a moment were not followed \[m/s\], \[s\].
const FOLLOWED_M_S: f64 = 1.0;
const FOLLOWED_S: f64 = 2.0;
/// Less energy has not two digits in the table \[kWh\].
const PRINTED_KWH: f64 = 1e-3;
/// A battery below this is empty.
const EMPTY_SOC: f32 = 1e-3;

/// Since when and by how much the speed was not that of the cycle or the trip, in words.
fn not_followed(run: &Run) -> Option<String> {
    let off = |i: usize| f64::from(run.trace[i].speed_m_s - run.trace[i].reference_m_s);
    let (mut since, mut first, mut total_s, mut worst) = (None, None, 0.0, 0.0_f64);
    for i in 1..run.trace.len() {
        let (from_s, to_s) = (run.trace[i - 1].time_s, run.trace[i].time_s);
        if off(i).abs() <= FOLLOWED_M_S {
            since = None;
            continue;
        }
        let start_s = *since.get_or_insert(from_s);
        if to_s - start_s > FOLLOWED_S {
            // The moment that it took to be sure counts, too.
            total_s += if first.is_none() { to_s - start_s } else { to_s - from_s };
            first.get_or_insert(start_s);
            worst = if off(i).abs() > worst.abs() { off(i) } else { worst };
        }
    }
    first.map(|s| {
        format!(
            "the speed is not followed from {s:.1} s on: off by more than {FOLLOWED_M_S} m/s during \
             {total_s:.1} s, by {worst:+.1} m/s at worst"
        )
    })
}

/// Since when the battery is empty, in words.
fn emptied(run: &Run) -> Option<String> {
    let row = run.trace.iter().find(|row| row.soc <= EMPTY_SOC)?;
    Some(format!(
        "the battery is empty from {:.1} s on, after {:.2} km",
        row.time_s,
        f64::from(row.distance_m) / 1000.0
    ))
}

/// The step's own dissipation over the throughput.
fn numerical_share(report: &EnergyReport) -> Option<f64> {
    (report.throughput > 0.0).then(|| f64::from(report.numerical / report.throughput))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::run::{LimitedSteps, Totals, TraceRow};

    fn run(rows: impl Iterator<Item = TraceRow>) -> Run {
        let totals = Totals { battery_energy_j: 10.0, ..Totals::default() };
        let wall = std::time::Duration::from_millis(1);
        Run { dt_s: 1.0, steps: 100, wall, trace: rows.collect(), totals, energy: None }
    }

    #[test]
    fn says_what_was_not_followed_and_when_the_battery_is_empty() {
        let row = |i: u16| TraceRow {
            time_s: f64::from(i),
            reference_m_s: 10.0,
            speed_m_s: if i < 50 { 10.0 } else { 7.0 },
            distance_m: 10.0 * f32::from(i),
            soc: if i < 60 { 0.02 } else { 0.0 },
            ..TraceRow::default()
        };
        let summary = |run: &Run| Summary::new("v", "i", Replayed::Cycle, run, 100.0);
        let notes = summary(&run((0..100).map(row))).notes.join("\n");
        for note in [
            "not followed from 49.0 s on: off by more than 1 m/s during 50.0 s, by -3.0 m/s",
            "the battery is empty from 60.0 s on, after 0.60 km",
            "2.778e-6 kWh",
        ] {
            assert!(notes.contains(note), "{notes}");
        }
        let sound = |i| TraceRow { speed_m_s: 9.5, soc: 0.5, ..row(i) };
        let mut sound = run((0..100).map(sound));
        sound.totals.battery_energy_j = 1e6;
        assert!(summary(&sound).notes.is_empty());
    }

    #[test]
    fn says_which_limit_acted_and_whether_it_was_exceeded() {
        let mut run = run(std::iter::once(TraceRow { soc: 0.5, ..TraceRow::default() }));
        run.totals = Totals {
            limited: LimitedSteps { discharge: 40, charge: 30, current: 10, duty: 20 },
            limit_exceeded_a: 0.04,
            ..run.totals
        };
        let notes = |run: &Run| Summary::new("v", "i", Replayed::Battery, run, 100.0).notes;
        assert_eq!(
            notes(&run)[..4],
            [
                "the battery's limit of discharging acted during 40.0 s",
                "the battery's limit of charging acted during 30.0 s",
                "the current limit of a drive acted during 10.0 s",
                "the limit of the duty acted during 20.0 s",
            ]
        );
        let exceeded = "the battery's limit was exceeded all the same, by up to 6.3 A".to_owned();
        assert!(!notes(&run).contains(&exceeded));
        run.totals.limit_exceeded_a = 6.3;
        assert!(notes(&run).contains(&exceeded));
    }
}
