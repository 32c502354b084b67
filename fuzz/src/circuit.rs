//! Networks of any elements.

use plant_core::Dt;
use plant_core::circuit::{Branch, Circuit, CircuitInput, CircuitState, Element, Method};

use super::Bits;

const NODES: usize = 5;
const ELEMENTS: usize = 8;
const STEPS: u32 = 32;

fn element(bits: &mut Bits<'_>) -> Element {
    match bits.count() % 13 {
        0 => Element::Resistor { ohm: bits.next() },
        1 => Element::Coil { henry: bits.next(), ohm: bits.next() },
        2 => Element::Capacitor { farad: bits.next() },
        3 => Element::VariableResistor,
        4 => Element::VariableCapacitor,
        5 => Element::Voltage,
        6 => Element::Current,
        7 => Element::Switch { on_ohm: bits.next(), off_ohm: bits.next() },
        8 => Element::Diode { on_ohm: bits.next(), off_ohm: bits.next(), drop_v: bits.next() },
        9 => Element::Transistor {
            on_ohm: bits.next(),
            off_ohm: bits.next(),
            drop_v: bits.next(),
            diode_drop_v: bits.next(),
        },
        10 => Element::Junction {
            saturation_a: bits.next(),
            thermal_v: bits.next(),
            largest_exponent: bits.next(),
            parallel_ohm: bits.next(),
        },
        // A node too many and an element's own node are refused.
        kind => Element::Mos {
            gate: usize::from(bits.count() % 7),
            p_channel: kind == 12,
            threshold_v: bits.next(),
            gain_a_v2: bits.next(),
            modulation_per_v: bits.next(),
        },
    }
}

/// A network with any bits for parameters and inputs: refused, or each of its steps is finite, or
/// rejected and without a trace. Whether one was taken.
pub fn circuit(data: &[u8]) -> bool {
    let mut bits = Bits { data, last: 1.0 };
    let Ok(dt) = Dt::from_s(bits.next()) else { return false };
    let method = if bits.next() < 0.0 { Method::BackwardEuler } else { Method::Trapezoidal };
    let branches: [Branch; ELEMENTS] = core::array::from_fn(|_| {
        let (from, to) = (usize::from(bits.count() % 6), usize::from(bits.count() % 6));
        Branch::new(from, to, element(&mut bits))
    });
    let Ok(circuit) = Circuit::<NODES, ELEMENTS>::new(branches, method, dt) else { return false };
    let (mut state, mut taken) = (CircuitState::default(), false);
    for _ in 0..STEPS {
        let gates = u32::from(bits.count());
        let values = core::array::from_fn(|_| bits.next());
        let before = state;
        let out = circuit.step(&mut state, CircuitInput { values, gates });
        if out.rejected {
            assert_eq!(state, before, "{out:?}");
        } else {
            let all = || out.voltage_v.iter().chain(&out.current_a).chain(&state.rate);
            assert!(all().all(|x| x.is_finite()), "{branches:?} {out:?} {state:?}");
            assert!(state.stored.iter().all(|x| x.get().is_finite()), "{branches:?} {state:?}");
        }
        taken |= !out.rejected;
    }
    taken
}
