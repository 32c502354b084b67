//! The coupled plant against the adaptive solution in what is not a drive cycle: gates off above
//! base speed, battery limits from outside.

use anyhow::Context;
use plant_core::battery::CurrentLimits;
use plant_core::converter::Gates;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainParams};
use plant_core::presets::EPOWERTRAIN_UDDS;
use plant_core::{Dt, Real};

use super::adaptive::Clock;
use super::composed::sets::UDDS;
use super::composed::{
    Command, ComposedReference, Description, Drive, Gates as Told, MOST, Machine, SOC, V,
};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};

/// Steps that are compared \[ms\].
pub(super) const STEPS_MS: [f64; 3] = [10.0, 1.0, 0.1];
/// Trajectories are compared at this spacing \[s\].
const ROW_S: f64 = 0.01;
pub(super) const TOLERANCE: f64 = 1e-10;
pub(super) const START_SOC: f64 = 0.6;

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "gates off above base speed, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery"],
        run: |checks| {
            compared(checks, &RECTIFYING, &t::GATES_OFF)?;
            Ok(())
        },
    },
    Case {
        name: "battery limits from outside, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery"],
        run: limited,
    },
];

/// Speed, state of charge, battery current.
pub(super) type Sample = [f64; 3];

/// A DC machine with more resistance and a gear: some hundred amperes where it charges by its diodes.
const MACHINE: Machine = Machine::Dc { r: 0.15, l: 9e-3, ke: 1.4, kt: 1.4 };
const GEAR: f64 = 3.0;

/// What is told to plant and solution, one after the other.
struct Scene {
    start_m_s: f64,
    parts: &'static [Part],
}

/// For so long.
struct Part {
    duration_s: f64,
    duty: Option<f64>,
    discharge_a: f64,
    charge_a: f64,
}

const FREE: Part =
    Part { duration_s: 4.0, duty: None, discharge_a: f64::INFINITY, charge_a: f64::INFINITY };

/// Base speed is 34 m/s.
const RECTIFYING: Scene = Scene { start_m_s: 45.0, parts: &[FREE] };

const LIMITED: Scene = Scene {
    start_m_s: 10.0,
    parts: &[
        Part { duration_s: 1.0, duty: Some(0.6), discharge_a: 100.0, charge_a: 60.0 },
        Part { duration_s: 1.0, duty: Some(0.6), discharge_a: 40.0, ..FREE },
        Part { duration_s: 0.8, duty: Some(0.1), discharge_a: 100.0, charge_a: 30.0 },
        Part { duration_s: 0.6, duty: Some(0.1), discharge_a: 100.0, charge_a: 15.0 },
    ],
};

fn description() -> Description {
    const DRIVES: &[Drive] =
        &[Drive { machine: MACHINE, j: 3.87e-7, bm: 4.21e-6, gear: GEAR, rate: f64::NAN }];
    Description { drives: DRIVES, controller: None, ..UDDS }
}

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub(super) const fn single(x: f64) -> Real {
    x as Real
}

fn params() -> PowertrainParams {
    let mut params = EPOWERTRAIN_UDDS.powertrain;
    params.drives.motor.resistance_ohm = 0.15;
    params.drives.motor.inductance_h = 9e-3;
    params.drives.gearbox = GearboxParams { ratio: single(GEAR), ..GearboxParams::NONE };
    params
}

fn exact(scene: &Scene) -> anyhow::Result<Vec<Sample>> {
    let mut vehicle = ComposedReference::new(description())?;
    let mut y = vehicle.rolling_at(scene.start_m_s, START_SOC);
    let (mut found, mut clock, mut from_s) = (Vec::new(), Clock::new(ROW_S), 0.0);
    for part in scene.parts {
        let told = part.duty.map_or(Told::Off, |duty| Told::Modulated([duty, 0.0]));
        let command = Command {
            gates: [told; MOST],
            discharge_a: part.discharge_a,
            charge_a: part.charge_a,
            ..Command::default()
        };
        let span = (from_s, from_s + part.duration_s);
        vehicle.advance(&mut y, &command, span, TOLERANCE, &mut clock, |t, y, vehicle| {
            found.push([y[V], y[SOC], vehicle.battery_a(t, y)]);
        })?;
        from_s = span.1;
    }
    Ok(found)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn ours(scene: &Scene, step_ms: f64) -> anyhow::Result<Vec<Sample>> {
    let dt_s = step_ms / 1000.0;
    let plant = Powertrain::new(params(), Dt::from_s(single(dt_s))?)?;
    let mut state = plant.at_speed(single(START_SOC), single(scene.start_m_s))?;
    let per_row = (ROW_S / dt_s).round() as usize;
    let mut found = Vec::new();
    for part in scene.parts {
        let input = PowertrainInput {
            gates: part.duty.map_or(Gates::Off, |duty| Gates::On(single(duty))),
            limits: CurrentLimits {
                discharge_a: single(part.discharge_a),
                charge_a: single(part.charge_a),
            },
            ..PowertrainInput::default()
        };
        for number in 1..=rows_of(part) * per_row {
            let out = plant.step(&mut state, input);
            anyhow::ensure!(!out.rejected, "the plant refused its input");
            if number % per_row == 0 {
                found.push([out.speed_m_s, out.soc, out.battery_a].map(f64::from));
            }
        }
    }
    Ok(found)
}

/// Each part ends with the battery at its limit.
fn limited(checks: &mut Checks) -> anyhow::Result<()> {
    let found = compared(checks, &LIMITED, &t::LIMITS)?;
    let mut rows = 0;
    for part in LIMITED.parts {
        rows += rows_of(part);
        let sample = found.get(rows - 1).context("no such row")?;
        // It charges where the duty makes less than the back-EMF.
        let drives = part.duty > Some(0.5);
        let limit_a = if drives { part.discharge_a } else { -part.charge_a };
        checks.against(&t::LIMIT_HELD, limit_a, sample[2]);
    }
    Ok(())
}

/// The largest differences of speed and state of charge at 1 ms; how they fall with the step.
/// Gives the run at 1 ms.
fn compared(
    checks: &mut Checks,
    scene: &Scene,
    bounds: &[Bound; 6],
) -> anyhow::Result<Vec<Sample>> {
    let exact = exact(scene)?;
    let mut runs = Vec::new();
    for step_ms in STEPS_MS {
        runs.push(ours(scene, step_ms)?);
    }
    judge(checks, &exact, &runs, bounds)?;
    Ok(runs.swap_remove(1))
}

/// What is said of runs in each of the steps.
pub(super) fn judge(
    checks: &mut Checks,
    exact: &[Sample],
    runs: &[Vec<Sample>],
    bounds: &[Bound; 6],
) -> anyhow::Result<()> {
    let [coarse, usual, fine] = runs else { anyhow::bail!("a run for each step") };
    for run in runs {
        anyhow::ensure!(run.len() == exact.len(), "the rows do not match");
    }
    let off = |ours: &[Sample], k: usize| {
        let pairs = ours.iter().zip(exact);
        pairs.map(|(a, b)| (a[k] - b[k]).abs()).fold(0.0, f64::max)
    };
    for k in 0..2 {
        checks.add(&bounds[3 * k], off(usual, k));
        checks.add(&bounds[3 * k + 1], off(coarse, k) / off(usual, k));
        checks.add(&bounds[3 * k + 2], off(usual, k) / off(fine, k));
    }
    Ok(())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn rows_of(part: &Part) -> usize {
    (part.duration_s / ROW_S).round() as usize
}
