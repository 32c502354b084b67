//! UDDS in closed loop, with both parameter sets (`EPowertrain2025`, section 5.3).

use anyhow::Context;

use super::adaptive::Clock;
use super::composed::sets::{UDDS, UDDS_TABLE};
use super::composed::{
    Command, ComposedReference, DISTANCE, Description, ENERGY, Gates, MOST, SOC, V,
};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};
use crate::read::{cycle, vehicle};
use crate::simulate::progress::Unseen;
use crate::simulate::route::{Route, Row};
use crate::simulate::run::{self, Run};

/// The adaptive solver's tolerance.
const TOLERANCE: f64 = 1e-9;
/// Its peaks are looked for at this spacing \[s\].
const PEAKS_S: f64 = 2.5e-4;
/// Trajectories are compared at this spacing \[s\]: a third of the ringing's period, and ten phases
/// of it after each kink.
const ROW_S: f64 = 0.01;
/// Peaks per row.
const PER_ROW: u64 = 40;
/// State of charge at the start.
const START_SOC: f64 = 0.80;

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "UDDS, epowertrain-udds",
        models: &["Powertrain", "Driver", "Pid", "Battery"],
        run: |checks| both(checks, "epowertrain-udds", UDDS, &FIRST),
    },
    Case {
        name: "UDDS, epowertrain-udds-table",
        models: &["Powertrain", "Driver", "Pid", "Battery"],
        run: |checks| both(checks, "epowertrain-udds-table", UDDS_TABLE, &SECOND),
    },
];

/// What a set is checked against: its adaptive solution, runs in steps of 1 ms and of 0.1 ms.
struct Bounds {
    adaptive: &'static [Bound; 7],
    coarse: &'static [Bound; 6],
    fine: &'static [Bound; 6],
}

const FIRST: Bounds =
    Bounds { adaptive: &t::UDDS_ADAPTIVE, coarse: &t::UDDS_1MS, fine: &t::UDDS_100US };
const SECOND: Bounds = Bounds {
    adaptive: &t::UDDS_TABLE_ADAPTIVE,
    coarse: &t::UDDS_TABLE_1MS,
    fine: &t::UDDS_TABLE_100US,
};

/// A solution, in samples and figures.
#[derive(Default)]
pub(super) struct Trajectory {
    pub speed: Vec<f64>,
    pub soc: Vec<f64>,
    pub energy_kwh: f64,
    pub distance_km: f64,
    pub torque: (f64, f64),
    pub current: (f64, f64),
    pub error: f64,
}

pub(super) fn widen(range: &mut (f64, f64), x: f64) {
    *range = (range.0.min(x), range.1.max(x));
}

/// The adaptive solution along a route's speed.
fn solve(p: Description, points: &[(f32, f32)]) -> anyhow::Result<Trajectory> {
    let mut vehicle = ComposedReference::new(p)?;
    let mut y = vehicle.rolling_at(0.0, START_SOC);
    let mut found = Trajectory { speed: vec![0.0], soc: vec![START_SOC], ..Trajectory::default() };
    let mut clock = Clock::new(PEAKS_S);
    let mut count = 0;
    for pair in points.windows(2) {
        let [(t0, v0), (t1, v1)] = [pair[0], pair[1]].map(|(t, v)| (f64::from(t), f64::from(v)));
        let command = Command {
            gates: [Gates::ControlledDuty; MOST],
            from_s: t0,
            reference: v0,
            rate: (v1 - v0) / (t1 - t0),
            ..Command::default()
        };
        let span = (t0, t1);
        vehicle.advance(&mut y, &command, span, TOLERANCE, &mut clock, |t, y, vehicle| {
            widen(&mut found.torque, vehicle.torque(y, 0));
            widen(&mut found.current, vehicle.battery_a(t, y));
            found.error = found.error.max((command.reference_at(t) - y[V]).abs());
            count += 1;
            if count % PER_ROW == 0 {
                found.speed.push(y[V]);
                found.soc.push(y[SOC]);
            }
        })?;
    }
    (found.energy_kwh, found.distance_km) = (y[ENERGY], y[DISTANCE]);
    Ok(found)
}

/// The cycle with rows close enough to compare ringing trajectories.
fn route(points: &[(f32, f32)]) -> Route {
    let mut rows = Vec::new();
    let row = |time_s, speed_m_s| Row { time_s, speed_m_s, ..Row::FLAT };
    for pair in points.windows(2) {
        let [(t0, v0), (t1, v1)] = [pair[0], pair[1]].map(|(t, v)| (f64::from(t), f64::from(v)));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
        let parts = ((t1 - t0) / ROW_S).round() as u32;
        rows.extend((0..parts).map(|i| {
            let along = f64::from(i) / f64::from(parts);
            row(t0 + along * (t1 - t0), v0 + along * (v1 - v0))
        }));
    }
    rows.extend(points.last().map(|&(t, v)| row(f64::from(t), f64::from(v))));
    Route { rows }
}

/// How far a run is from the adaptive solution.
pub(super) struct Distance {
    /// Largest difference of the state of charge.
    pub soc: f64,
    /// Difference of the energy out of the battery's chemistry, relative.
    pub energy_rel: f64,
    /// Root mean square of the difference in speed \[m/s\].
    pub speed_rms: f64,
}

impl Distance {
    fn between(exact: &Trajectory, run: &Run) -> anyhow::Result<Self> {
        let energy = run.energy.context("a run without a ledger")?;
        anyhow::ensure!(run.trace.len() == exact.speed.len(), "the rows do not match");
        let (mut squares, mut soc, mut count) = (0.0, 0.0_f64, 0.0);
        for ((row, v), exact_soc) in run.trace.iter().zip(&exact.speed).zip(&exact.soc) {
            squares += (f64::from(row.speed_m_s) - v).powi(2);
            soc = soc.max((f64::from(row.soc) - exact_soc).abs());
            count += 1.0;
        }
        let energy_kwh = f64::from(energy.electrochemical) / 3.6e6;
        let energy_rel = (energy_kwh / exact.energy_kwh - 1.0).abs();
        Ok(Self { soc, energy_rel, speed_rms: f64::sqrt(squares / count) })
    }
}

/// Steps of which the table of step sizes tells \[ms\].
const STEPS_MS: [f64; 5] = [2.0, 1.0, 0.5, 0.2, 0.1];

/// What the length of a step costs in accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepRow {
    /// Length of a step \[ms\].
    pub step_ms: f64,
    /// Largest difference of the state of charge, 0..1.
    pub soc: f64,
    /// Difference of the energy out of the battery's chemistry, relative.
    pub energy_rel: f64,
    /// Root mean square of the difference in speed \[m/s\].
    pub speed_rms_m_s: f64,
    /// What the step itself dissipates, over the throughput.
    pub numerical_rel: f64,
}

/// The error of each step and what it dissipates: UDDS with `epowertrain-udds` against the adaptive
/// solution.
///
/// # Errors
/// A run that diverged.
pub fn step_sizes() -> anyhow::Result<Vec<StepRow>> {
    let cycle = cycle::by_name("udds").context("no cycle `udds`")?;
    let vehicle = vehicle::load("epowertrain-udds")?;
    let route = route(&cycle.points);
    let exact = solve(UDDS, &cycle.points)?;
    let row = |step_ms| {
        let dt_s = step_ms / 1000.0;
        let run = run::vehicle(&vehicle, &route, vehicle.initial_soc, dt_s, true, &Unseen)?;
        let energy = run.energy.context("a run without a ledger")?;
        let Distance { soc, energy_rel, speed_rms } = Distance::between(&exact, &run)?;
        let numerical_rel = f64::from(energy.numerical / energy.throughput);
        Ok(StepRow { step_ms, soc, energy_rel, speed_rms_m_s: speed_rms, numerical_rel })
    };
    STEPS_MS.into_iter().map(row).collect()
}

fn both(checks: &mut Checks, name: &str, p: Description, bounds: &Bounds) -> anyhow::Result<()> {
    let cycle = cycle::by_name("udds").context("no cycle `udds`")?;
    let vehicle = vehicle::load(name)?;
    let route = route(&cycle.points);
    let drive = |dt_s| run::vehicle(&vehicle, &route, vehicle.initial_soc, dt_s, true, &Unseen);
    let (exact, (coarse, fine)) =
        rayon::join(|| solve(p, &cycle.points), || rayon::join(|| drive(1e-3), || drive(1e-4)));
    let (exact, coarse, fine) = (exact?, coarse?, fine?);
    let soc = exact.soc.last().copied().unwrap_or(f64::NAN);
    let figures = [
        soc,
        exact.energy_kwh,
        exact.torque.0,
        exact.torque.1,
        exact.current.0,
        exact.current.1,
        exact.error,
    ];
    for (bound, figure) in bounds.adaptive.iter().zip(figures) {
        checks.add(bound, figure);
    }
    let first = compare(checks, &exact, &coarse, bounds.coarse, &t::NUMERICAL_1MS)?;
    let second = compare(checks, &exact, &fine, bounds.fine, &t::NUMERICAL_100US)?;
    for (bound, ratio) in t::UDDS_GAIN.iter().zip([
        first.soc / second.soc,
        first.energy_rel / second.energy_rel,
        first.speed_rms / second.speed_rms,
    ]) {
        checks.add(bound, ratio);
    }
    Ok(())
}

fn compare(
    checks: &mut Checks,
    exact: &Trajectory,
    run: &Run,
    bounds: &[Bound; 6],
    numerical: &Bound,
) -> anyhow::Result<Distance> {
    let energy = run.energy.context("a run without a ledger")?;
    let off = Distance::between(exact, run)?;
    let energy_kwh = f64::from(energy.electrochemical) / 3.6e6;
    let distance_km = run.trace.last().map_or(f64::NAN, |r| f64::from(r.distance_m) / 1000.0);
    let case = [
        (None, off.soc),
        (Some(exact.energy_kwh), energy_kwh),
        (None, off.speed_rms),
        (Some(exact.torque.1), f64::from(run.totals.motor_torque_nm.1)),
        (Some(exact.current.1), f64::from(run.totals.battery_current_a.1)),
        (Some(exact.distance_km), distance_km),
    ];
    let step = format!("{} ms: ", run.dt_s * 1000.0);
    let before = checks.list.len();
    for (bound, (target, obtained)) in bounds.iter().zip(case) {
        match target {
            Some(target) => checks.against(bound, target, obtained),
            None => checks.add(bound, obtained),
        }
    }
    checks.ledger(&energy, numerical);
    for check in &mut checks.list[before..] {
        check.quantity.insert_str(0, &step);
    }
    Ok(off)
}
