//! Switched circuits with their machines: an H-bridge with a DC motor, a three-phase bridge with a
//! synchronous one.

use plant_core::circuit::{
    Branch, Circuit, CircuitInput, CircuitState, Element, Method, Phases, h_bridge, sources,
    three_phase,
};
use plant_core::num::wrap_turns;
use plant_core::presets::PMSM_EPOWERTRAIN;
use plant_core::{Accum, Dt, must};

use crate::call;
use crate::stack::Stack;

/// The period of a step \[s\].
const STEP_S: f32 = 1e-5;
const STEP: Dt = must!(Dt::from_s(STEP_S));
/// A switching period in steps.
const PERIOD: u32 = 10;
const BUS_V: f32 = 300.0;
const TRANSISTOR: Element =
    Element::Transistor { on_ohm: 0.05, off_ohm: 1e5, drop_v: 0.0, diode_drop_v: 0.0 };

const H: [Branch; 6] = h_bridge(TRANSISTOR, Element::Coil { henry: 1e-3, ohm: 0.1 });
const H_BRIDGE: Circuit<4, 6, { sources(&H) }, 16> =
    must!(Circuit::tabled(H, Method::BackwardEuler, STEP));
const MOTOR_NM_PER_A: f32 = 0.27;
const MOTOR_INERTIA: f32 = 0.03;

const PHASES: Phases = must!(Phases::new(&PMSM_EPOWERTRAIN));
const PAIRS_PER_RAD: f32 = PMSM_EPOWERTRAIN.pole_pairs as f32 / core::f32::consts::TAU;
const THREE: [Branch; 10] = three_phase(TRANSISTOR, PHASES.coil());
const THREE_PHASE: Circuit<6, 10, { sources(&THREE) }, 64> =
    must!(Circuit::tabled(THREE, Method::BackwardEuler, STEP));

/// A bridge and the machine that it drives.
#[derive(Default)]
pub struct Driven<const ELEMENTS: usize> {
    circuit: CircuitState<ELEMENTS>,
    speed_rad_s: Accum,
    electrical_turns: f32,
}

/// An H-bridge and a DC motor; the input is its gates, the output its current.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_h_bridge(state: &mut Driven<6>, gates: &u32, current_a: &mut f32) {
    let back_emf_v = MOTOR_NM_PER_A * state.speed_rad_s.get();
    let values = [BUS_V, 0.0, 0.0, 0.0, 0.0, back_emf_v];
    let out = H_BRIDGE.step(&mut state.circuit, CircuitInput { values, gates: *gates });
    *current_a = out.current_a[5];
    state.speed_rad_s.add(STEP_S / MOTOR_INERTIA * MOTOR_NM_PER_A * *current_a);
}

/// A three-phase bridge and a synchronous machine, the same.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_three_phase(state: &mut Driven<10>, gates: &u32, current_a: &mut [f32; 3]) {
    let speed_rad_s = state.speed_rad_s.get();
    let k = PHASES.constants_nm_per_a(state.electrical_turns);
    let emf_v = [k.a, k.b, k.c].map(|k| k * speed_rad_s);
    let values = [BUS_V, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, emf_v[0], emf_v[1], emf_v[2]];
    let out = THREE_PHASE.step(&mut state.circuit, CircuitInput { values, gates: *gates });
    let [.., a, b, c] = out.current_a;
    *current_a = [a, b, c];
    let torque_nm = k.a * a + k.b * b + k.c * c;
    state.speed_rad_s.add(STEP_S / PMSM_EPOWERTRAIN.inertia_kg_m2 * torque_nm);
    let turned = state.electrical_turns + STEP_S * PAIRS_PER_RAD * state.speed_rad_s.get();
    state.electrical_turns = wrap_turns(turned);
}

/// Gates of a leg with its upper switch on for `high` of [`PERIOD`] steps, and one step of dead time
/// on either side.
const fn leg(phase: u32, high: u32) -> u32 {
    match phase % PERIOD {
        0 => 0,
        p if p <= high => 0b01,
        p if p == high + 1 => 0,
        _ => 0b10,
    }
}

/// Switches both for 50 ms at 10 kHz.
pub fn run(h_stack: &mut Stack, three_stack: &mut Stack) -> (Driven<6>, Driven<10>) {
    let (mut h, mut three) = (Driven::default(), Driven::default());
    for step in 0..5000_u32 {
        let gates = leg(step, 6) << 1 | leg(step + 5, 2) << 3;
        call!(h_stack, bench_h_bridge, &mut h, &gates);
        // A vector that goes around once in 20 ms.
        let sixth = step / 333 % 6;
        let high = |n: u32| [6, 6, 4, 2, 2, 4][((sixth + n) % 6) as usize];
        let gates = leg(step, high(0)) << 1 | leg(step, high(4)) << 3 | leg(step, high(2)) << 5;
        call!(three_stack, bench_three_phase, &mut three, &gates);
    }
    (h, three)
}
