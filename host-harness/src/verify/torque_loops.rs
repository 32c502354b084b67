//! UDDS under a controller of the speed whose torque ideal current loops make, on one axle and on two
//! that are not alike, against the adaptive solution.

use anyhow::Context;
use plant_core::battery::Battery;
use plant_core::control::pid::{Pid, PidInput, PidParams, PidState};
use plant_core::converter::Gates;
use plant_core::machine::dc::DcMotorParams;
use plant_core::mechanics::gearbox::GearboxParams;
use plant_core::powertrain::ledger::NoLedger;
use plant_core::powertrain::{DriveParams, Drives, Limited, Powertrain, PowertrainInput};
use plant_core::presets::{BMW_I3_60AH_PMSM, EPOWERTRAIN_UDDS, TWO_AXLES};
use plant_core::{Dt, ParamError, Real};

use super::adaptive::Clock;
use super::composed::sets::{I3_PMSM, TWO_AXLES as TWO, UDDS};
use super::composed::{
    Command, ComposedReference, Controller, Description, Drive, ENERGY, Gates as Told, MOST,
    Machine, SOC, V,
};
use super::drives::{START_SOC, STEPS_MS, Sample, TOLERANCE, judge, single};
use super::tolerance::{self as t, Bound};
use super::{Case, Checks};
use crate::read::cycle;

pub(super) const CASES: [Case; 4] = [
    Case {
        name: "UDDS by a torque loop, DC machine",
        models: &["Powertrain", "DcMotor", "Converter", "Battery", "Pid"],
        run: |checks| {
            let description = Description { drives: &[FRONT], ..UDDS };
            let udds = EPOWERTRAIN_UDDS.powertrain;
            let plant = |dt| udds.with_drives(front()).build(dt);
            let trip = Trip { description, shares: &[1.0], ..TRIP };
            followed(checks, &trip, plant, Gates::Torque, &t::TORQUE_LOOP)?;
            Ok(())
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
            let trip = Trip { description, shares: &[0.7, 0.05], ..TRIP };
            followed(checks, &trip, plant, command, &t::TWO_AXLES)?;
            Ok(())
        },
    },
    Case {
        name: "UDDS by a torque loop, PMSM vehicle",
        models: &["Powertrain", "Pmsm", "Converter", "Gearbox", "Battery", "Auxiliary", "Pid"],
        run: |checks| {
            let plant = |dt| BMW_I3_60AH_PMSM.powertrain.build(dt);
            let trip = Trip { description: I3_PMSM, shares: &[1.0], whole: true, ..I3_TRIP };
            let (exact_kwh, runs) =
                followed(checks, &trip, plant, Gates::Torque, &t::PMSM_TORQUE_LOOP)?;
            let [coarse, usual, fine] = runs.map(|kwh| (kwh - exact_kwh).abs());
            checks.against(&t::PMSM_ENERGY[0], exact_kwh, runs[1]);
            checks.add(&t::PMSM_ENERGY[1], coarse / usual);
            checks.add(&t::PMSM_ENERGY[2], usual / fine);
            Ok(())
        },
    },
    Case {
        name: "UDDS by torque loops, two axles: PMSM and DC machine",
        models: &["Powertrain", "Pmsm", "DcMotor", "Converter", "Gearbox", "Battery", "Pid"],
        run: |checks| {
            let mut params = TWO_AXLES.powertrain;
            params.drives.1.converter.voltage_drop_v = 0.0;
            let drives = params.build(Dt::from_s(1e-3)?)?;
            let command = |nm| drives.drives().command(nm);
            // Of 0.7 and 0.3 at the road.
            let shares = &[0.7, 0.3 * 9.665 / 8.0];
            let trip = Trip { description: TWO, shares, ..I3_TRIP };
            followed(checks, &trip, |dt| params.build(dt), command, &t::PMSM_AND_DC)?;
            Ok(())
        },
    },
];

/// That of UDDS with a torque loop.
const FRONT: Drive = Drive {
    machine: Machine::Dc { r: 0.025, l: 1e-3, ke: 1.4, kt: 1.4 },
    j: 3.87e-7,
    bm: 4.21e-6,
    gear: 1.0,
    gear_loss: 0.0,
    rate: RATE,
};
/// A smaller and faster one.
const REAR: Drive = Drive {
    machine: Machine::Dc { r: 0.04, l: 3e-4, ke: 0.3, kt: 0.3 },
    j: 0.02,
    bm: 1e-3,
    gear: 6.0,
    gear_loss: 0.0,
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

/// What is driven, and by what.
#[derive(Clone, Copy)]
struct Trip {
    description: Description,
    /// Of the controller's torque, of each drive.
    shares: &'static [f64],
    /// The controller of the speed: torque per speed error \[N·m·s/m\], and its integral's rate.
    k: f64,
    i: f64,
    auxiliary_w: f64,
    /// The whole of UDDS.
    whole: bool,
}

const TRIP: Trip =
    Trip { description: UDDS, shares: &[], k: 1500.0, i: 750.0, auxiliary_w: 0.0, whole: false };
/// As much force at the road.
const I3_TRIP: Trip = Trip { k: 210.0, i: 105.0, auxiliary_w: 530.0, ..TRIP };

/// How much of UDDS is driven \[s\]: two hills of five, the second to its highest speed.
const UDDS_S: f32 = 340.0;
/// Points of UDDS are 1 s apart; so are the rows compared.
type Points<'a> = &'a [(f32, f32)];

/// What came of a run: rows, and the energy out of the battery's chemistry \[kWh\].
type Driven = (Vec<Sample>, f64);

/// UDDS under a controller of the speed whose torque the drives share. Gives the energy of the
/// adaptive solution and of each step \[kWh\].
fn followed<D: Drives>(
    checks: &mut Checks,
    trip: &Trip,
    plant: impl Fn(Dt) -> Result<Powertrain<NoLedger, Battery, D>, ParamError> + Sync,
    command: impl Fn(Real) -> D::Command + Sync,
    bounds: &[Bound; 6],
) -> anyhow::Result<(f64, [f64; 3])> {
    let cycle = cycle::by_name("udds").context("no cycle `udds`")?;
    let driven = |p: &(f32, f32)| trip.whole || p.0 <= UDDS_S;
    let points: Vec<_> = cycle.points.iter().copied().filter(driven).collect();
    let run = |step_ms: f64| {
        let dt = Dt::from_s(single(step_ms / 1000.0))?;
        follow(&plant(dt)?, dt, trip, &points, &command)
    };
    let all = || STEPS_MS.into_iter().map(run).collect::<anyhow::Result<Vec<Driven>>>();
    let (exact, runs) = rayon::join(|| exact_followed(trip, &points), all);
    let ((exact, exact_kwh), runs) = (exact?, runs?);
    let (rows, kwh): (Vec<_>, Vec<_>) = runs.into_iter().unzip();
    judge(checks, &exact, &rows, bounds)?;
    Ok((exact_kwh, <[f64; 3]>::try_from(kwh).ok().context("a run for each step")?))
}

fn exact_followed(trip: &Trip, points: Points<'_>) -> anyhow::Result<Driven> {
    let (min, max) = (f64::NEG_INFINITY, f64::INFINITY);
    let controller =
        Controller { k: trip.k, i: trip.i, d: 0.0, min, max, smoothing: f64::INFINITY };
    let description = Description { controller: Some(controller), ..trip.description };
    let mut vehicle = ComposedReference::new(description)?;
    let mut y = vehicle.rolling_at(0.0, START_SOC);
    let mut gates = [Told::Off; MOST];
    for (gates, share) in gates.iter_mut().zip(trip.shares) {
        *gates = Told::ControlledTorque(*share);
    }
    let mut found = Vec::new();
    for pair in points.windows(2) {
        let [(t0, v0), (t1, v1)] = [pair[0], pair[1]].map(|(t, v)| (f64::from(t), f64::from(v)));
        let command = Command {
            gates,
            from_s: t0,
            reference: v0,
            rate: (v1 - v0) / (t1 - t0),
            auxiliary_w: trip.auxiliary_w,
            ..Command::default()
        };
        let clock = &mut Clock::never();
        vehicle.advance(&mut y, &command, (t0, t1), TOLERANCE, clock, |_, _, _| {})?;
        // No converter makes more than its bus has; none of the fields is weakened.
        for drive in 0..trip.shares.len() {
            let used = vehicle.used(t1, &y, drive);
            anyhow::ensure!(used < 1.0, "drive {drive} would need {used} of its voltage at {t1} s");
        }
        found.push([y[V], y[SOC], vehicle.battery_a(t1, &y)]);
    }
    Ok((found, y[ENERGY]))
}

fn follow<D: Drives>(
    plant: &Powertrain<NoLedger, Battery, D>,
    dt: Dt,
    trip: &Trip,
    points: Points<'_>,
    command: &impl Fn(Real) -> D::Command,
) -> anyhow::Result<Driven> {
    let pid = Pid::new(
        PidParams {
            proportional: single(trip.k),
            integral_per_s: single(trip.i),
            smoothing_per_s: Real::INFINITY,
            ..PidParams::DEFAULT
        },
        dt,
    )?;
    let (mut state, mut control) = (plant.at_rest(single(START_SOC))?, PidState::default());
    let (mut found, mut energy_j) = (Vec::new(), 0.0);
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
            anyhow::ensure!(out.limited == Limited::No, "at {t0} s: {:?}", out.limited);
            let flow_w = f64::from(out.open_circuit_v) * f64::from(out.battery_a);
            energy_j += flow_w * f64::from(dt.s());
            last = [out.speed_m_s, out.soc, out.battery_a].map(f64::from);
            number += 1.0;
        }
        found.push(last);
    }
    Ok((found, energy_j / 3.6e6))
}
