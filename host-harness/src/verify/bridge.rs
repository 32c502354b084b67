//! A three-phase bridge, switch by switch, that drives the synchronous machine of the source work:
//! beside the averaged one, with dead time, and with one transistor that stays open.

use plant_core::circuit::{
    Branch, Circuit, CircuitError, CircuitInput, CircuitState, Element, Method, Phases, sources,
    three_phase,
};
use plant_core::machine::pmsm::{Pmsm, PmsmInput, PmsmState};
use plant_core::machine::transform::{Dq, RotorAngle, duties};
use plant_core::num::{max, wrap_turns};
use plant_core::presets::PMSM_EPOWERTRAIN as MACHINE;
use plant_core::{Accum, Dt, Real, must};

use super::pmsm::single;
use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 4] = [
    Case { name: "circuit: three-phase bridge", models: &["Circuit", "Pmsm"], run: averaged },
    Case { name: "circuit: dead time", models: &["Circuit"], run: dead_time },
    Case { name: "circuit: one transistor open", models: &["Circuit"], run: one_open },
    Case { name: "circuit: one transistor shorted", models: &["Circuit"], run: one_shorted },
];

/// The step, a hundredth of the switching period.
const STEP: Dt = must!(Dt::from_s(1e-6));
const PERIOD: u32 = 100;
/// Periods of 0.1 ms: 0.2 s, until it runs steadily.
const PERIODS: u32 = 2000;
const BUS_V: Real = 300.0;
/// What the load takes from the shaft \[N·m\], and the voltage that is asked for, as in "PMSM start".
const LOAD_NM: Real = 0.2;
const ASKED_V: Dq = Dq { d: -8.0, q: 60.0 };
const DIODE_DROP_V: Real = 0.8;
/// The drop of a transistor is that of its diode, so that it does not depend on the sign.
const TRANSISTOR: Element = Element::Transistor {
    on_ohm: 0.01,
    off_ohm: 1e6,
    drop_v: DIODE_DROP_V,
    diode_drop_v: DIODE_DROP_V,
};
const PHASES: Phases = must!(Phases::new(&MACHINE));

const BRIDGE: [Branch; 10] = three_phase(TRANSISTOR, PHASES.coil());
static CIRCUIT: Result<Circuit<6, 10, { sources(&BRIDGE) }, 64>, CircuitError> =
    Circuit::tabled(BRIDGE, Method::BackwardEuler, STEP);

/// How the bridge is driven.
#[derive(Clone, Copy, Default)]
pub(super) struct Drive {
    /// Steps in which both gates of a leg stay off after one of them was on.
    pub dead_steps: u32,
    /// From this period on the upper transistor of phase a does not close.
    pub open_from: Option<u32>,
    /// From this period on it conducts whatever its gate says. Once the source's current says so,
    /// all other gates stay off.
    pub shorted_from: Option<u32>,
}

pub(super) const WITH_DEAD_TIME: Drive =
    Drive { dead_steps: 2, open_from: None, shorted_from: None };
pub(super) const WITH_ONE_OPEN: Drive = Drive { open_from: Some(750), ..WITH_DEAD_TIME };
pub(super) const WITH_ONE_SHORTED: Drive = Drive { shorted_from: Some(750), ..WITH_DEAD_TIME };
/// The current of the source at which the gates go off \[A\].
const TRIP_A: Real = 50.0;

/// Means over one switching period, and what one instant in it looked like.
#[derive(Clone, Copy, Default)]
pub(super) struct Seen {
    pub speed_rad_s: f64,
    pub averaged_rad_s: f64,
    pub torque_nm: f64,
    pub averaged_nm: f64,
    pub current_a: [f64; 3],
    pub bus_a: f64,
    /// The largest in the period.
    pub largest_bus_a: f64,
}

/// Runs bridge and averaged machine side by side.
pub(super) fn run(drive: Drive, mut see: impl FnMut(u32, &Seen)) -> anyhow::Result<()> {
    let circuit = CIRCUIT?;
    let averaged = Pmsm::new(MACHINE, STEP)?;
    let (mut beside, mut state) = (PmsmState::default(), CircuitState::default());
    let (mut speed, mut turns) = (Accum::new(0.0), 0.0);
    let pairs_per_rad = Real::from(MACHINE.pole_pairs) / core::f32::consts::TAU;
    let (mut was_high, mut carried) = ([0; 3], [0.0; 3]);
    // Dead time and drops take a square wave against the current, of which the machine feels the
    // fundamental \[Leggate1997\].
    let dead_v = BUS_V * single(f64::from(drive.dead_steps) / f64::from(PERIOD));
    let lost_v = 4.0 / core::f32::consts::PI * (dead_v + DIODE_DROP_V);
    let mut given_v = ASKED_V;
    let mut tripped = false;
    for period in 0..PERIODS {
        // What will be right in the middle of the period.
        let middle = turns + 0.5e-4 * pairs_per_rad * speed.get();
        let shares = duties(ASKED_V.to_stator(RotorAngle::of_turns(middle)), BUS_V);
        // Whole steps; what rounding leaves goes into the next period.
        let mut high_steps = [0; 3];
        for ((steps, carried), share) in
            high_steps.iter_mut().zip(&mut carried).zip([shares.a, shares.b, shares.c])
        {
            let wanted = f64::from(share) * f64::from(PERIOD) + *carried;
            *steps = whole(wanted);
            *carried = wanted - f64::from(*steps);
        }
        let mut seen = Seen::default();
        for number in 0..PERIOD {
            let mut gates = 0;
            for (leg, steps) in high_steps.iter().enumerate() {
                let high = number.wrapping_sub((PERIOD - steps) / 2) < *steps;
                // Counts up while high, down while low.
                let since = &mut was_high[leg];
                *since = if high { i32::max(*since, 0) + 1 } else { i32::min(*since, 0) - 1 };
                if since.unsigned_abs() > drive.dead_steps {
                    gates |= if high { 0b01 } else { 0b10 } << (1 + 2 * leg);
                }
            }
            if drive.open_from.is_some_and(|from| period >= from) {
                gates &= !0b10;
            }
            if drive.shorted_from.is_some_and(|from| period >= from) {
                gates = if tripped { 0b10 } else { gates | 0b10 };
            }
            let k = PHASES.constants_nm_per_a(turns);
            let back_emf_v = [k.a, k.b, k.c].map(|k| k * speed.get());
            let mut values = [0.0; 10];
            values[0] = BUS_V;
            values[7..].copy_from_slice(&back_emf_v);
            let out = circuit.step(&mut state, CircuitInput { values, gates });
            anyhow::ensure!(out.settled && !out.rejected, "{out:?} in period {period}");
            let [.., a, b, c] = out.current_a;
            let torque_nm = k.a * a + k.b * b + k.c * c;
            let friction_nm = MACHINE.viscous_nm_s_per_rad * speed.get();
            speed.add(STEP.s() / MACHINE.inertia_kg_m2 * (torque_nm - friction_nm - LOAD_NM));
            turns = wrap_turns(turns + STEP.s() * pairs_per_rad * speed.get());
            let mean = averaged.step(&mut beside, PmsmInput::cold(given_v, LOAD_NM));
            let current_a = mean.current_a;
            given_v = ASKED_V - current_a * (lost_v / max(current_a.length(), 1e-3));
            let share = 1.0 / f64::from(PERIOD);
            seen.torque_nm += share * f64::from(torque_nm);
            seen.averaged_nm += share * f64::from(mean.torque_nm);
            seen.bus_a -= share * f64::from(out.current_a[0]);
            seen.largest_bus_a = seen.largest_bus_a.max(-f64::from(out.current_a[0]));
            tripped |= -out.current_a[0] > TRIP_A;
            seen.current_a = [a, b, c].map(f64::from);
            (seen.speed_rad_s, seen.averaged_rad_s) = (speed.get().into(), mean.speed_rad_s.into());
        }
        see(period, &seen);
    }
    Ok(())
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a period in steps"
)]
const fn whole(steps: f64) -> u32 {
    steps.round() as u32
}

/// From this period on it runs steadily; some fifteen turns of the field follow.
const STEADY: u32 = 1500;

/// The mean speed of the steady part, and that of the averaged machine \[rad/s\].
fn steady(drive: Drive) -> anyhow::Result<[f64; 2]> {
    let mut speeds = [0.0; 2];
    run(drive, |period, seen| {
        if period >= STEADY {
            let share = 1.0 / f64::from(PERIODS - STEADY);
            speeds[0] += share * seen.speed_rad_s;
            speeds[1] += share * seen.averaged_rad_s;
        }
    })?;
    Ok(speeds)
}

/// Switched and averaged agree in the mean.
fn averaged(checks: &mut Checks) -> anyhow::Result<()> {
    let [switched, averaged] = steady(Drive::default())?;
    checks.against(&t::BRIDGE_SPEED, averaged, switched);
    Ok(())
}

/// And with 2 µs of dead time.
fn dead_time(checks: &mut Checks) -> anyhow::Result<()> {
    let [switched, averaged] = steady(WITH_DEAD_TIME)?;
    checks.against(&t::DEAD_TIME_SPEED, averaged, switched);
    Ok(())
}

/// Without its upper transistor a leg drives no current into its phase.
fn one_open(checks: &mut Checks) -> anyhow::Result<()> {
    let (mut least_a, mut most_a) = (0.0_f64, 0.0_f64);
    run(WITH_ONE_OPEN, |period, seen| {
        if period >= STEADY {
            least_a = least_a.min(seen.current_a[0]);
            most_a = most_a.max(seen.current_a[0]);
        }
    })?;
    checks.add(&t::ONE_OPEN, most_a / -least_a);
    Ok(())
}

/// With its upper transistor shorted a leg shoots through once; then the machine brakes against it.
fn one_shorted(checks: &mut Checks) -> anyhow::Result<()> {
    let (mut into_a, mut out_of_a, mut largest_a) = (0.0_f64, 0.0_f64, 0.0_f64);
    let from = WITH_ONE_SHORTED.shorted_from.unwrap_or(0);
    run(WITH_ONE_SHORTED, |period, seen| {
        largest_a = largest_a.max(seen.largest_bus_a);
        // What flowed before has died away after 5 ms.
        if period >= from + 50 {
            for phase_a in &seen.current_a[1..] {
                (into_a, out_of_a) = (into_a.max(*phase_a), out_of_a.max(-phase_a));
            }
        }
    })?;
    checks.add(&t::ONE_SHORTED, into_a / out_of_a);
    let through_a = f64::from((BUS_V - 2.0 * DIODE_DROP_V) / (2.0 * 0.01));
    checks.against(&t::SHOOT_THROUGH, through_a, largest_a);
    Ok(())
}
