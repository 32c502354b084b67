//! UDDS under a controller of the speed whose torque ideal current loops make, on one axle and on two
//! that are not alike, against the adaptive solution.

use anyhow::Context;
use plant_core::battery::Battery;
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::converter::Gates;
use plant_core::machine::dc::DcMotorParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{DriveParams, Drives, Powertrain, PowertrainInput};
use plant_core::presets::EPOWERTRAIN_UDDS;
use plant_core::{Dt, ParamError, Real};

use super::adaptive::Clock;
use super::composed::sets::UDDS;
use super::composed::{
    Command, ComposedReference, Controller, Description, Drive, Gates as Told, MOST, Machine, SOC,
    V,
};
use super::drives::{START_SOC, STEPS_MS, Sample, TOLERANCE, judge, single};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};
use crate::read::cycle;

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "UDDS by a torque loop, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery", "Pid"],
        run: |checks| {
            let description = Description { drives: &[FRONT], ..UDDS };
            let udds = EPOWERTRAIN_UDDS.powertrain;
            let plant = |dt| udds.with_drives(front()).build(dt);
            followed(checks, description, &[1.0], plant, Gates::Torque, &t::TORQUE_LOOP)
        },
    },
    Case {
        name: "UDDS by torque loops, two axles with different DC machines",
        models: &["Powertrain", "DcMotor", "Converter", "Battery", "Pid"],
        run: |checks| {
            let description = Description { drives: &[FRONT, REAR], ..UDDS };
            let udds = EPOWERTRAIN_UDDS.powertrain;
            let plant = |dt| udds.with_drives((front(), rear())).build(dt);
            let command = |nm| (Gates::Torque(0.7 * nm), Gates::Torque(0.05 * nm));
            followed(checks, description, &[0.7, 0.05], plant, command, &t::TWO_AXLES)
        },
    },
];

/// That of UDDS with a torque loop.
const FRONT: Drive = Drive {
    machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 1.4, kt: 1.4 },
    j: 3.87e-7,
    bm: 4.21e-6,
    gear: 1.0,
    rate: RATE,
};
/// A smaller and faster one.
const REAR: Drive = Drive {
    machine: Machine::Dc { r: 0.04, l: 3e-4, ke: 0.3, kt: 0.3 },
    j: 0.02,
    bm: 1e-3,
    gear: 6.0,
    rate: RATE,
};
/// Of the current loops \[1/s\].
const RATE: f64 = 500.0;

const fn front() -> DriveParams {
    let params = EPOWERTRAIN_UDDS.powertrain.drives;
    DriveParams { torque_rate_per_s: single(RATE), ..params }
}

const fn rear() -> DriveParams {
    let motor = DcMotorParams {
        resistance_ohm: 0.04,
        inductance_h: 3e-4,
        back_emf_v_s_per_rad: 0.3,
        torque_nm_per_a: 0.3,
        inertia_kg_m2: 0.02,
        viscous_nm_s_per_rad: 1e-3,
        coulomb_nm: 0.0,
    };
    let gearbox = GearboxParams { ratio: 6.0, ..GearboxParams::NONE };
    DriveParams { torque_rate_per_s: single(RATE), ..DriveParams::new(motor, gearbox) }
}

/// The controller of the speed: torque per speed error \[N·m·s/m\], and its integral's rate.
const K: f64 = 1500.0;
const I: f64 = 750.0;
/// How much of UDDS is driven \[s\]: two hills of five, the second to its highest speed.
const UDDS_S: f32 = 340.0;
/// Points of UDDS are 1 s apart; so are the rows compared.
type Points<'a> = &'a [(f32, f32)];

/// UDDS under a controller of the speed whose torque the drives share.
fn followed<D: Drives>(
    checks: &mut Checks,
    description: Description,
    shares: &[f64],
    plant: impl Fn(Dt) -> Result<Powertrain<NoLedger, Battery, D>, ParamError>,
    command: impl Fn(Real) -> D::Command + Copy,
    bounds: &[Bound; 6],
) -> anyhow::Result<()> {
    let cycle = cycle::by_name("udds").context("no cycle `udds`")?;
    let points: Vec<_> = cycle.points.iter().copied().filter(|p| p.0 <= UDDS_S).collect();
    let exact = exact_followed(description, shares, &points)?;
    let mut runs = Vec::new();
    for step_ms in STEPS_MS {
        let dt = Dt::from_s(single(step_ms / 1000.0))?;
        runs.push(follow(&plant(dt)?, dt, &points, command)?);
    }
    judge(checks, &exact, &runs, bounds)
}

fn exact_followed(
    description: Description,
    shares: &[f64],
    points: Points<'_>,
) -> anyhow::Result<Vec<Sample>> {
    let unlimited = (f64::NEG_INFINITY, f64::INFINITY);
    let (min, max) = unlimited;
    let controller = Controller { k: K, i: I, d: 0.0, min, max, smoothing: f64::INFINITY };
    let description = Description { controller: Some(controller), ..description };
    let mut vehicle = ComposedReference::new(description)?;
    let mut y = vehicle.rolling_at(0.0, START_SOC);
    let mut gates = [Told::Off; MOST];
    for (gates, share) in gates.iter_mut().zip(shares) {
        *gates = Told::ControlledTorque(*share);
    }
    let mut found = Vec::new();
    for pair in points.windows(2) {
        let [(t0, v0), (t1, v1)] = [pair[0], pair[1]].map(|(t, v)| (f64::from(t), f64::from(v)));
        let rate = (v1 - v0) / (t1 - t0);
        let command = Command { gates, from_s: t0, reference: v0, rate, ..Command::default() };
        let clock = &mut Clock::never();
        vehicle.advance(&mut y, &command, (t0, t1), TOLERANCE, clock, |_, _, _| {})?;
        // No converter makes more than its bus has.
        for drive in 0..shares.len() {
            let used = vehicle.used(t1, &y, drive);
            anyhow::ensure!(used < 1.0, "drive {drive} would need {used} of its voltage at {t1} s");
        }
        found.push([y[V], y[SOC], vehicle.battery_a(t1, &y)]);
    }
    Ok(found)
}

fn follow<D: Drives>(
    plant: &Powertrain<NoLedger, Battery, D>,
    dt: Dt,
    points: Points<'_>,
    command: impl Fn(Real) -> D::Command,
) -> anyhow::Result<Vec<Sample>> {
    let pid = Pid::new(
        PidParams {
            proportional: single(K),
            integral_per_s: single(I),
            smoothing_per_s: Real::INFINITY,
            ..PidParams::DEFAULT
        },
        dt,
    )?;
    let (mut state, mut control) = (plant.at_rest(single(START_SOC))?, PidState::default());
    let mut found = Vec::new();
    for pair in points.windows(2) {
        let ((t0, v0), (t1, v1)) = (pair[0], pair[1]);
        let steps = ((t1 - t0) / dt.s()).round();
        let mut number = 0.0;
        let mut last = [0.0; 3];
        while number < steps {
            let reference = v0 + (v1 - v0) * (number / steps);
            let measurement = state.body.speed_m_s.get();
            let torque_nm = pid.step(&mut control, PidInput { reference, measurement }).output;
            let out = plant.step(&mut state, PowertrainInput::with(command(torque_nm)));
            anyhow::ensure!(!out.rejected, "the plant refused its input");
            last = [out.speed_m_s, out.soc, out.battery_a].map(f64::from);
            number += 1.0;
        }
        found.push(last);
    }
    Ok(found)
}
