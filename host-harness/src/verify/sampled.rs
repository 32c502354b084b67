//! The synchronous machine of the source work (`EPowertrain` 2025, PMSM) under a controller of
//! 10 kHz, which holds its voltage for a period: the same controller drives the machine in steps and
//! the adaptive solution.

use plant_core::control::foc::{Foc, FocInput, FocParams, FocState};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
use plant_core::machine::transform::Dq;
use plant_core::presets::PMSM_EPOWERTRAIN;
use plant_core::{Accum, Dt};

use super::adaptive::Clock;
use super::composed::sets::UDDS;
use super::composed::{self, Command, ComposedReference, Description, Gates, MOST, Machine, V};
use super::field_oriented::{BANDWIDTH, BUS_V};
use super::pmsm::{INERTIA, MAGNET_WB, OHM, PAIRS, ROUND, VISCOUS, single};
use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 1] =
    [Case { name: "PMSM under a sampled controller", models: &["Pmsm", "Foc"], run: sampled }];

const TOLERANCE: f64 = 1e-10;
/// The controller's own period \[s\]; the machine steps in as many parts of it.
const PERIOD_S: f64 = 1e-4;
const PARTS: [u32; 3] = [1, 10, 100];
/// Torques \[N·m\], each for 40 ms, against a load.
const TORQUES: [f64; 4] = [0.5, -0.2, 0.7, 0.1];
const PERIODS: u32 = 400;
const AGAINST_NM: f64 = 0.1;
const ROLLING: f64 = 50.0;

/// Currents of both axes and speed at each sample of the controller.
type Sample = [f64; 3];

/// The controller in `torques`, whose voltage `advance` holds for a period.
fn in_samples(
    mut now: Sample,
    mut advance: impl FnMut(u32, Dq) -> anyhow::Result<Sample>,
) -> anyhow::Result<Vec<Sample>> {
    let params = FocParams { bandwidth_rad_s: single(BANDWIDTH), ..FocParams::DEFAULT };
    let foc = Foc::new(params, PMSM_EPOWERTRAIN, Dt::from_s(single(PERIOD_S))?)?;
    let (mut control, mut found, mut number) = (FocState::default(), Vec::new(), 0);
    for torque in TORQUES {
        for _ in 0..PERIODS {
            let [d, q, speed] = now.map(single);
            let input = FocInput {
                torque_nm: single(torque),
                current_a: Dq { d, q },
                speed_rad_s: speed,
                bus_v: single(BUS_V),
            };
            now = advance(number, foc.step(&mut control, input).voltage_v)?;
            found.push(now);
            number += 1;
        }
    }
    Ok(found)
}

/// The machine on a free shaft in the equations of a vehicle: a wheel of 1 m without a body.
fn in_continuous_time() -> anyhow::Result<Vec<Sample>> {
    const DRIVE: composed::Drive = composed::Drive {
        machine: Machine::Pmsm {
            r: OHM,
            ld: ROUND.d_h,
            lq: ROUND.q_h,
            magnet: MAGNET_WB,
            pairs: PAIRS,
            iron: 0.0,
        },
        j: INERTIA,
        bm: VISCOUS,
        gear: 1.0,
        gear_loss: 0.0,
        rate: f64::NAN,
    };
    let shaft = Description {
        v_empty: BUS_V,
        v_full: BUS_V,
        drives: &[DRIVE],
        radius: 1.0,
        mass: 0.0,
        area: 0.0,
        controller: None,
        ..UDDS
    };
    let mut system = ComposedReference::new(shaft)?;
    let mut y = system.rolling_at(ROLLING, 0.5);
    in_samples([0.0, 0.0, ROLLING], |number, v| {
        let gates = [Gates::Volts([v.d, v.q].map(f64::from)); MOST];
        let command = Command { gates, brake: AGAINST_NM, ..Command::default() };
        let from_s = PERIOD_S * f64::from(number);
        let span = (from_s, from_s + PERIOD_S);
        system.advance(&mut y, &command, span, TOLERANCE, &mut Clock::never(), |_, _, _| {})?;
        let [d, q] = ComposedReference::currents(&y, 0);
        Ok([d, q, y[V]])
    })
}

fn in_steps(parts: u32) -> anyhow::Result<Vec<Sample>> {
    let dt = Dt::from_s(single(PERIOD_S / f64::from(parts)))?;
    let machine = Pmsm::new(PMSM_EPOWERTRAIN, dt)?;
    let mut state = PmsmState { speed_rad_s: Accum::new(single(ROLLING)), ..PmsmState::default() };
    in_samples([0.0, 0.0, ROLLING], |_, v| {
        for _ in 0..parts {
            machine.step(&mut state, PmsmInput::cold(v, single(AGAINST_NM)));
        }
        let i = state.current_a();
        Ok([i.d, i.q, state.speed_rad_s.get()].map(f64::from))
    })
}

/// The same controller on both; the machine in steps of its period, a tenth, a hundredth.
fn sampled(checks: &mut Checks) -> anyhow::Result<()> {
    let exact = in_continuous_time()?;
    let mut off = Vec::new();
    for parts in PARTS {
        let ours = in_steps(parts)?;
        let pairs = || ours.iter().zip(&exact);
        let currents = pairs().map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
        let speeds = pairs().map(|(a, b)| (a[2] - b[2]).abs());
        off.push([currents.fold(0.0, f64::max), speeds.fold(0.0, f64::max)]);
    }
    let largest = |value: fn(&Sample) -> f64| exact.iter().map(value).fold(0.0, f64::max);
    let largest = [largest(|s| s[0].hypot(s[1])), largest(|s| s[2].abs())];
    for k in 0..2 {
        checks.add(&t::SAMPLED[3 * k], off[1][k] / largest[k]);
        checks.add(&t::SAMPLED[3 * k + 1], off[0][k] / off[1][k]);
        checks.add(&t::SAMPLED[3 * k + 2], off[1][k] / off[2][k]);
    }
    Ok(())
}
