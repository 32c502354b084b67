//! The coupled plant against the adaptive solution in what is not a drive cycle: gates off above
//! base speed, battery limits from outside.

use anyhow::Context;
use plant_core::battery::{Battery, CurrentLimits};
use plant_core::converter::Gates;
use plant_core::machine::flux::{Flux, LinearFlux};
use plant_core::machine::pmsm::PmsmDrive;
use plant_core::machine::transform::Dq;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{Drive as Axle, Drives, Powertrain, PowertrainInput};
use plant_core::presets::{BMW_I3_60AH_PMSM, EPOWERTRAIN_UDDS};
use plant_core::{Dt, ParamError, Real};

use super::adaptive::Clock;
use super::composed::sets::{I3_PMSM, UDDS};
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

pub(super) const CASES: [Case; 4] = [
    Case {
        name: "gates off above base speed, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery"],
        run: |checks| {
            compared(checks, &RECTIFYING, dc, duty, &t::GATES_OFF)?;
            Ok(())
        },
    },
    Case {
        name: "battery limits from outside, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery"],
        run: |checks| {
            let found = compared(checks, &LIMITED, dc, duty, &t::LIMITS)?;
            held(checks, &LIMITED, &found)
        },
    },
    Case {
        name: "gates off above base speed, PMSM vehicle",
        models: &["Powertrain", "Pmsm", "Converter", "Gearbox", "Battery", "Auxiliary"],
        run: |checks| {
            let plant = |dt| BMW_I3_60AH_PMSM.powertrain.build(dt);
            compared(checks, &PMSM_RECTIFYING, plant, torque, &t::PMSM_GATES_OFF)?;
            Ok(())
        },
    },
    Case {
        name: "battery limits from outside, PMSM vehicle",
        models: &["Powertrain", "Pmsm", "Converter", "Gearbox", "Battery", "Auxiliary"],
        run: |checks| {
            let exact = exact(&PMSM_LIMITED)?;
            let run = |step_ms| ours(&PMSM_LIMITED, step_ms, &round, torque);
            let (usual, fine) = (run(1.0)?, run(0.1)?);
            checks.add(&t::PMSM_LIMITS[0], off(&usual, &exact, 0));
            checks.add(&t::PMSM_LIMITS[1], off(&usual, &exact, 0) / off(&fine, &exact, 0));
            checks.add(&t::PMSM_LIMITS[2], off(&usual, &exact, 1));
            held(checks, &PMSM_LIMITED, &usual)?;
            held(checks, &PMSM_LIMITED, &run(10.0)?)
        },
    },
];

/// Speed, state of charge, battery current.
pub(super) type Sample = [f64; 3];

/// A DC machine with more resistance and a gear: some hundred amperes where it charges by its diodes.
const MACHINE: Machine = Machine::Dc { r: 0.15, l: 9e-3, ke: 1.4, kt: 1.4 };
const GEAR: f64 = 3.0;

/// What is told to plant and solution, one after the other.
struct Scene {
    description: Description,
    start_m_s: f64,
    auxiliary_w: f64,
    parts: &'static [Part],
}

/// For so long.
struct Part {
    duration_s: f64,
    told: Told,
    discharge_a: f64,
    charge_a: f64,
}

const FREE: Part =
    Part { duration_s: 4.0, told: Told::Off, discharge_a: f64::INFINITY, charge_a: f64::INFINITY };

/// Base speed is 34 m/s.
const RECTIFYING: Scene =
    Scene { description: DESCRIPTION, start_m_s: 45.0, auxiliary_w: 0.0, parts: &[FREE] };

const DRIVING: Told = Told::Modulated([0.6, 0.0]);
const BRAKING: Told = Told::Modulated([0.1, 0.0]);
const LIMITED: Scene = Scene {
    start_m_s: 10.0,
    parts: &[
        Part { duration_s: 1.0, told: DRIVING, discharge_a: 100.0, charge_a: 60.0 },
        Part { duration_s: 1.0, told: DRIVING, discharge_a: 40.0, ..FREE },
        Part { duration_s: 0.8, told: BRAKING, discharge_a: 100.0, charge_a: 30.0 },
        Part { duration_s: 0.6, told: BRAKING, discharge_a: 100.0, charge_a: 15.0 },
    ],
    ..RECTIFYING
};

/// The magnets alone induce what the bus holds at 32 m/s.
const PMSM_RECTIFYING: Scene =
    Scene { description: I3_PMSM, start_m_s: 45.0, auxiliary_w: 530.0, parts: &[FREE] };

/// By its torque loop.
const PMSM_LIMITED: Scene = Scene {
    description: ROUND,
    start_m_s: 12.0,
    parts: &[
        Part { duration_s: 1.0, told: Told::Torque(80.0), discharge_a: 60.0, charge_a: 60.0 },
        Part { duration_s: 1.0, told: Told::Torque(80.0), discharge_a: 25.0, ..FREE },
        Part { duration_s: 0.8, told: Told::Torque(-87.0), discharge_a: 60.0, charge_a: 40.0 },
        Part { duration_s: 0.6, told: Told::Torque(-87.0), discharge_a: 60.0, charge_a: 15.0 },
    ],
    ..PMSM_RECTIFYING
};

const DESCRIPTION: Description = Description {
    drives: &[Drive {
        machine: MACHINE,
        j: 3.87e-7,
        bm: 4.21e-6,
        gear: GEAR,
        gear_loss: 0.0,
        rate: f64::NAN,
    }],
    controller: None,
    ..UDDS
};

/// The i3 without reluctance, as limits act on one axis.
const ROUND: Description = Description {
    drives: &[Drive {
        machine: Machine::Pmsm {
            r: 0.012,
            ld: 2e-4,
            lq: 2e-4,
            magnet: 0.04,
            pairs: 6.0,
            iron: 0.016,
        },
        ..I3_PMSM.drives[0]
    }],
    ..I3_PMSM
};

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub(super) const fn single(x: f64) -> Real {
    x as Real
}

fn dc(dt: Dt) -> Result<Powertrain, ParamError> {
    let mut params = EPOWERTRAIN_UDDS.powertrain;
    params.drives.motor.resistance_ohm = 0.15;
    params.drives.motor.inductance_h = 9e-3;
    params.drives.gearbox = GearboxParams { ratio: single(GEAR), ..GearboxParams::NONE };
    params.build(dt)
}

fn round(dt: Dt) -> Result<Powertrain<NoLedger, Battery, Axle<PmsmDrive>>, ParamError> {
    let mut params = BMW_I3_60AH_PMSM.powertrain;
    let inductance_h = 2e-4;
    params.drives.motor.flux =
        Flux::Linear(LinearFlux { magnet_wb: 0.04, d_h: inductance_h, q_h: inductance_h });
    params.build(dt)
}

const fn duty(told: Told) -> Gates {
    match told {
        Told::Modulated([duty, _]) => Gates::On(single(duty)),
        _ => Gates::Off,
    }
}

const fn torque(told: Told) -> Gates<Dq> {
    match told {
        Told::Torque(torque_nm) => Gates::Torque(single(torque_nm)),
        _ => Gates::Off,
    }
}

fn exact(scene: &Scene) -> anyhow::Result<Vec<Sample>> {
    let mut vehicle = ComposedReference::new(scene.description)?;
    let mut y = vehicle.rolling_at(scene.start_m_s, START_SOC);
    let (mut found, mut clock, mut from_s) = (Vec::new(), Clock::new(ROW_S), 0.0);
    for part in scene.parts {
        let command = Command {
            gates: [part.told; MOST],
            discharge_a: part.discharge_a,
            charge_a: part.charge_a,
            auxiliary_w: scene.auxiliary_w,
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
fn ours<D: Drives>(
    scene: &Scene,
    step_ms: f64,
    plant: &impl Fn(Dt) -> Result<Powertrain<NoLedger, Battery, D>, ParamError>,
    command: fn(Told) -> D::Command,
) -> anyhow::Result<Vec<Sample>> {
    let dt_s = step_ms / 1000.0;
    let plant = plant(Dt::from_s(single(dt_s))?)?;
    let mut state = plant.at_speed(single(START_SOC), single(scene.start_m_s))?;
    let per_row = (ROW_S / dt_s).round() as usize;
    let mut found = Vec::new();
    for part in scene.parts {
        let limits = CurrentLimits {
            discharge_a: single(part.discharge_a),
            charge_a: single(part.charge_a),
        };
        let input = PowertrainInput { limits, ..PowertrainInput::with(command(part.told)) };
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
fn held(checks: &mut Checks, scene: &Scene, found: &[Sample]) -> anyhow::Result<()> {
    let mut rows = 0;
    for part in scene.parts {
        rows += rows_of(part);
        let sample = found.get(rows - 1).context("no such row")?;
        // A duty charges where it makes less than the back-EMF.
        let drives = match part.told {
            Told::Modulated([duty, _]) => duty > 0.5,
            Told::Torque(torque_nm) => torque_nm > 0.0,
            _ => anyhow::bail!("a part without a limit"),
        };
        let limit_a = if drives { part.discharge_a } else { -part.charge_a };
        checks.against(&t::LIMIT_HELD, limit_a, sample[2]);
    }
    Ok(())
}

/// The largest differences of speed and state of charge at 1 ms; how they fall with the step.
/// Gives the run at 1 ms.
fn compared<D: Drives>(
    checks: &mut Checks,
    scene: &Scene,
    plant: impl Fn(Dt) -> Result<Powertrain<NoLedger, Battery, D>, ParamError>,
    command: fn(Told) -> D::Command,
    bounds: &[Bound; 6],
) -> anyhow::Result<Vec<Sample>> {
    let exact = exact(scene)?;
    let mut runs = Vec::new();
    for step_ms in STEPS_MS {
        runs.push(ours(scene, step_ms, &plant, command)?);
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
    for k in 0..2 {
        let off = |ours: &[Sample]| off(ours, exact, k);
        checks.add(&bounds[3 * k], off(usual));
        checks.add(&bounds[3 * k + 1], off(coarse) / off(usual));
        checks.add(&bounds[3 * k + 2], off(usual) / off(fine));
    }
    Ok(())
}

/// The largest difference of one quantity.
pub(super) fn off(ours: &[Sample], exact: &[Sample], k: usize) -> f64 {
    let pairs = ours.iter().zip(exact);
    pairs.map(|(a, b)| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn rows_of(part: &Part) -> usize {
    (part.duration_s / ROW_S).round() as usize
}
