//! Circuits in steps of 10 µs, and a hash of every bit of their state after every step: an H-bridge with
//! a DC motor, a three-phase bridge with a synchronous machine, and curved elements, whose logarithms and
//! exponentials must be the same everywhere: a rectifier and a MOS inverter.

use core::fmt::{Display, from_fn};

use plant_core::circuit::{
    Branch, Circuit, CircuitInput, CircuitOutput, CircuitState, Element, Method, Phases, h_bridge,
    sources, three_phase,
};
use plant_core::num::{sin_cos_turns, wrap_turns};
use plant_core::presets::PMSM_EPOWERTRAIN;
use plant_core::{Accum, Dt, Real, must};

use crate::Fnv1a;

/// The period of a step \[s\].
const STEP_S: Real = 1e-5;
const STEP: Dt = must!(Dt::from_s(STEP_S));
/// A switching period in steps.
const PERIOD: u32 = 10;
const BUS_V: Real = 300.0;
const TRANSISTOR: Element =
    Element::Transistor { on_ohm: 0.05, off_ohm: 1e5, drop_v: 0.0, diode_drop_v: 0.0 };

const H: [Branch; 6] = h_bridge(TRANSISTOR, Element::Coil { henry: 1e-3, ohm: 0.1 });
const H_BRIDGE: Circuit<4, 6, { sources(&H) }, 16> =
    must!(Circuit::tabled(H, Method::BackwardEuler, STEP));
const MOTOR_NM_PER_A: Real = 0.27;
const MOTOR_INERTIA: Real = 0.03;

const PHASES: Phases = must!(Phases::new(&PMSM_EPOWERTRAIN));
const PAIRS_PER_RAD: Real = PMSM_EPOWERTRAIN.pole_pairs as Real / core::f32::consts::TAU;
const THREE: [Branch; 10] = three_phase(TRANSISTOR, PHASES.coil());
const THREE_PHASE: Circuit<6, 10, { sources(&THREE) }, 64> =
    must!(Circuit::tabled(THREE, Method::BackwardEuler, STEP));

/// Four diodes from a source at 50 Hz to a capacitor and a resistor.
const RECTIFIER_PARTS: [Branch; 7] = [
    Branch::new(1, 2, Element::Voltage),
    Branch::new(1, 3, Element::JUNCTION),
    Branch::new(2, 3, Element::JUNCTION),
    Branch::new(0, 1, Element::JUNCTION),
    Branch::new(0, 2, Element::JUNCTION),
    Branch::new(3, 0, Element::Capacitor { farad: 1e-3 }),
    Branch::new(3, 0, Element::Resistor { ohm: 100.0 }),
];
const RECTIFIER: Circuit<4, 7> = must!(Circuit::new(RECTIFIER_PARTS, Method::Trapezoidal, STEP));
/// The frequency of its source.
const HERTZ: Real = 50.0;

const fn mos(p_channel: bool) -> Element {
    Element::Mos { gate: 2, p_channel, threshold_v: 3.0, gain_a_v2: 5e-4, modulation_per_v: 0.0 }
}
/// Supply, gate, the upper and the lower transistor, what hangs on them.
const INVERTER_PARTS: [Branch; 5] = [
    Branch::new(1, 0, Element::Voltage),
    Branch::new(2, 0, Element::Voltage),
    Branch::new(3, 1, mos(true)),
    Branch::new(3, 0, mos(false)),
    Branch::new(3, 0, Element::Capacitor { farad: 2e-8 }),
];
const INVERTER: Circuit<4, 5> = must!(Circuit::new(INVERTER_PARTS, Method::BackwardEuler, STEP));

/// A bridge and the machine that it drives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Driven<const ELEMENTS: usize> {
    circuit: CircuitState<ELEMENTS>,
    speed_rad_s: Accum,
    electrical_turns: Real,
}

impl Driven<6> {
    /// One step of the H-bridge with its motor; the current \[A\].
    #[inline(always)]
    pub fn step(&mut self, gates: u32) -> Real {
        let back_emf_v = MOTOR_NM_PER_A * self.speed_rad_s.get();
        let values = [BUS_V, 0.0, 0.0, 0.0, 0.0, back_emf_v];
        let out = H_BRIDGE.step(&mut self.circuit, CircuitInput { values, gates });
        let current_a = out.current_a[5];
        self.speed_rad_s.add(STEP_S / MOTOR_INERTIA * MOTOR_NM_PER_A * current_a);
        current_a
    }
}

impl Driven<10> {
    /// One step of the three-phase bridge with its machine; the currents of the phases \[A\].
    #[inline(always)]
    pub fn step(&mut self, gates: u32) -> [Real; 3] {
        let speed_rad_s = self.speed_rad_s.get();
        let k = PHASES.constants_nm_per_a(self.electrical_turns);
        let emf_v = [k.a, k.b, k.c].map(|k| k * speed_rad_s);
        let values = [BUS_V, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, emf_v[0], emf_v[1], emf_v[2]];
        let out = THREE_PHASE.step(&mut self.circuit, CircuitInput { values, gates });
        let [.., a, b, c] = out.current_a;
        let torque_nm = k.a * a + k.b * b + k.c * c;
        self.speed_rad_s.add(STEP_S / PMSM_EPOWERTRAIN.inertia_kg_m2 * torque_nm);
        let turned = self.electrical_turns + STEP_S * PAIRS_PER_RAD * self.speed_rad_s.get();
        self.electrical_turns = wrap_turns(turned);
        [a, b, c]
    }
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

/// Gates of the H-bridge and of the three-phase bridge at a step, at 10 kHz: a voltage, and a vector that
/// goes around once in 20 ms.
#[must_use]
pub const fn gates(step: u32) -> (u32, u32) {
    let h = leg(step, 6) << 1 | leg(step + 5, 2) << 3;
    let sixth = step / 333 % 6;
    let high = [6, 6, 4, 2, 2, 4];
    let [a, b, c] = [sixth, sixth + 4, sixth + 2];
    let (a, b, c) = (high[a as usize % 6], high[b as usize % 6], high[c as usize % 6]);
    (h, leg(step, a) << 1 | leg(step, b) << 3 | leg(step, c) << 5)
}

/// Steps of a run that is compared: 100 ms.
pub const STEPS: u32 = 10_000;

/// Runs all four for so many steps; the hash of every bit of their state after each step, and where they
/// end, in a line.
#[must_use]
pub fn switched(steps: u32) -> impl Display {
    let mut hash = Fnv1a::default();
    let (mut h, mut three) = (Driven::<6>::default(), Driven::<10>::default());
    let (mut rectifier, mut inverter) = (CircuitState::default(), CircuitState::default());
    let (mut turns, mut settled, mut ends) = (0.0, true, (0.0, [0.0; 3], 0.0, 0.0));
    for step in 0..steps {
        let (of_h, of_three) = gates(step);
        ends.0 = h.step(of_h);
        ends.1 = three.step(of_three);
        turns = wrap_turns(turns + STEP_S * HERTZ);
        let source_v = 100.0 * sin_cos_turns(turns).0;
        let values = [source_v, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let rectified = RECTIFIER.step(&mut rectifier, CircuitInput { values, gates: 0 });
        ends.2 = rectified.voltage_v[6];
        let gate_v = if step % 100 < 50 { 0.0 } else { 10.0 };
        let values = [10.0, gate_v, 0.0, 0.0, 0.0];
        let inverted = INVERTER.step(&mut inverter, CircuitInput { values, gates: 0 });
        ends.3 = inverted.voltage_v[4];
        settled &= fine(&rectified) && fine(&inverted);
        take(&mut hash, &h.circuit);
        take(&mut hash, &three.circuit);
        take(&mut hash, &rectifier);
        take(&mut hash, &inverter);
        hash.sum(h.speed_rad_s);
        hash.sum(three.speed_rad_s);
    }
    from_fn(move |f| {
        let (h_a, [a, b, c], rectified_v, inverted_v) = ends;
        write!(
            f,
            "hash {:016x} settled {settled} h_bridge_a {h_a} phases_a {a} {b} {c} rectified_v {rectified_v} inverted_v {inverted_v}",
            hash.get()
        )
    })
}

fn fine<const E: usize>(out: &CircuitOutput<E>) -> bool {
    out.settled && !out.rejected && out.missed_a < 1e-3
}

fn take<const E: usize>(hash: &mut Fnv1a, state: &CircuitState<E>) {
    for (sum, rate) in state.stored.iter().zip(state.rate) {
        hash.sum(*sum);
        hash.word(rate.to_bits());
    }
    hash.word(state.forward);
    hash.word(state.reverse);
}
