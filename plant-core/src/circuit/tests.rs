extern crate std;

use super::*;
use crate::{Dt, must};
use std::format;

const US: Dt = must!(Dt::from_s(1e-6));

const TRANSISTOR: Element =
    Element::Transistor { on_ohm: 0.005, off_ohm: 1e5, drop_v: 0.0, diode_drop_v: 0.8 };
const DIODE: Element = Element::Diode { on_ohm: 0.005, off_ohm: 1e5, drop_v: 0.8 };

/// 400 V; legs A and B; a coil with a back-EMF between them.
const H_BRIDGE: [Branch; 6] = h_bridge(TRANSISTOR, Element::Coil { henry: 1e-3, ohm: 1.0 });

#[test]
fn a_table_gives_what_solving_gives() {
    const S: usize = sources(&H_BRIDGE);
    const TABLED: Circuit<4, 6, S, 16> =
        must!(Circuit::tabled(H_BRIDGE, Method::BackwardEuler, US));
    const SOLVED: Circuit<4, 6> = must!(Circuit::new(H_BRIDGE, Method::BackwardEuler, US));
    let (mut a, mut b) = (CircuitState::default(), CircuitState::default());
    let mut mean_a = 0.0;
    for step in 0..20_000_u32 {
        let phase = step % 200;
        // 140 of 200 µs forward, with 2 µs of dead time.
        let gates = match phase {
            2..=139 => 0b10010,
            142..=199 => 0b01100,
            _ => 0,
        };
        let input = CircuitInput { values: [400.0, 0.0, 0.0, 0.0, 0.0, 100.0], gates };
        let (x, y) = (TABLED.step(&mut a, input), SOLVED.step(&mut b, input));
        assert!(x.settled && y.settled, "{step} {x:?}");
        for e in 0..6 {
            assert!((x.current_a[e] - y.current_a[e]).abs() < 1e-2, "{step} {e} {x:?} {y:?}");
            assert!((x.voltage_v[e] - y.voltage_v[e]).abs() < 2e-2, "{step} {e} {x:?} {y:?}");
        }
        mean_a += if step >= 19_800 { x.current_a[5] / 200.0 } else { 0.0 };
    }
    // 138 of 200 µs forward; backward in the dead time too, through the diodes.
    assert!((mean_a - (0.38 * 400.0 - 100.0) / 1.01).abs() < 0.2, "{mean_a}");
}

#[test]
fn power_balances_and_what_euler_swallows_is_named() {
    const SOLVED: Circuit<4, 6> = must!(Circuit::new(H_BRIDGE, Method::BackwardEuler, US));
    let mut state = CircuitState::default();
    for step in 0..5000_u32 {
        let gates = if step % 200 < 140 { 0b10010 } else { 0b01100 };
        let input = CircuitInput { values: [400.0, 0.0, 0.0, 0.0, 0.0, 100.0], gates };
        let before = state;
        let out = SOLVED.step(&mut state, input);
        let books = SOLVED.books(&before, &state, &out);
        assert!(books.balance_w.abs() <= 1e-5 * books.throughput_w + 1e-3, "{step} {books:?}");
        let rise = state.stored[5].since(before.stored[5]);
        let energy_w = 1e-3 * (rise * state.stored[5].get()) / 1e-6;
        let half_w = 0.5e-3 * rise * (state.stored[5].get() + before.stored[5].get()) / 1e-6;
        assert!((energy_w - half_w - books.numerical_w).abs() <= 1e-4 * energy_w.abs() + 1e-2);
    }
}

#[test]
fn a_series_circuit_rings_as_it_should() {
    const RLC: [Branch; 3] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Coil { henry: 1e-3, ohm: 2.0 }),
        Branch::new(2, 0, Element::Capacitor { farad: 1e-5 }),
    ];
    const RULE: Circuit<3, 3> = must!(Circuit::new(RLC, Method::Trapezoidal, US));
    const EULER: Circuit<3, 3> = must!(Circuit::new(RLC, Method::BackwardEuler, US));
    // Euler damps by ω²·h/2 = 50 1/s more: 0.25 V at the most.
    for (circuit, bound_v) in [(RULE, 2e-3), (EULER, 0.3)] {
        let mut state = CircuitState::default();
        // A step at t = 0+: the rule's first interval begins with the source already there.
        state.rate[1] = 10.0;
        let mut worst: Real = 0.0;
        for step in 1..=1000_u32 {
            let out = circuit.step(&mut state, CircuitInput::of([10.0, 0.0, 0.0]));
            let t = f64::from(step) * 1e-6;
            let (decay, w) = (1000.0, (1e8_f64 - 1e6).sqrt());
            let exact =
                10.0 * (1.0 - (-decay * t).exp() * ((w * t).cos() + decay / w * (w * t).sin()));
            worst = worst.max((f64::from(out.voltage_v[2]) - exact).abs() as Real);
        }
        assert!(worst < bound_v, "{:?} {worst}", circuit.method);
    }
}

#[test]
fn a_rectifier_charges_and_holds() {
    const RECTIFIER: [Branch; 7] = [
        Branch::new(1, 2, Element::Voltage),
        Branch::new(1, 3, DIODE),
        Branch::new(2, 3, DIODE),
        Branch::new(0, 1, DIODE),
        Branch::new(0, 2, DIODE),
        Branch::new(3, 0, Element::Capacitor { farad: 1e-3 }),
        Branch::new(3, 0, Element::Resistor { ohm: 100.0 }),
    ];
    const CIRCUIT: Circuit<4, 7> =
        must!(Circuit::new(RECTIFIER, Method::BackwardEuler, must!(Dt::from_s(5e-5))));
    let mut state = CircuitState::default();
    let (mut least, mut most) = (Real::INFINITY, 0.0);
    for step in 0..4000_u32 {
        let source =
            (100.0 * (std::f64::consts::TAU * 50.0 * f64::from(step) * 5e-5).sin()) as Real;
        let mut values = [0.0; 7];
        values[0] = source;
        let out = CIRCUIT.step(&mut state, CircuitInput::of(values));
        assert!(out.settled, "{step} {out:?}");
        if step > 2000 {
            least = crate::num::min(least, out.voltage_v[5]);
            most = crate::num::max(most, out.voltage_v[5]);
        }
    }
    assert!((most - 98.4).abs() < 0.3 && (least - 91.0).abs() < 1.5, "{least} {most}");
}

#[test]
fn a_junction_lies_on_its_curve() {
    const CLAMP: [Branch; 3] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Resistor { ohm: 100.0 }),
        Branch::new(2, 0, Element::JUNCTION),
    ];
    const CIRCUIT: Circuit<3, 3> = must!(Circuit::new(CLAMP, Method::BackwardEuler, US));
    for source in [-5.0, 0.0, 0.3, 5.0, 100.0, 1e4] {
        let mut state = CircuitState::default();
        let out = CIRCUIT.step(&mut state, CircuitInput::of([source, 0.0, 0.0]));
        let (v, i) = (f64::from(out.voltage_v[2]), f64::from(out.current_a[2]));
        let x = v / 0.04;
        let curve = 1e-6 * (x.min(15.0).exp() * (1.0 + (x - 15.0).max(0.0)) - 1.0) + v / 1e8;
        assert!(out.settled && (curve - i).abs() <= 1e-4 * i.abs() + 1e-8, "{source} {out:?}");
        assert!((v + 100.0 * i - f64::from(source)).abs() <= 1e-5 * f64::from(source).abs() + 1e-6);
    }
}

/// Its saturation current above its thermal voltage's, where damping by a logarithm ends.
#[test]
fn a_junction_that_hardly_bends_stays_finite() {
    let bent = Element::Junction {
        saturation_a: 4.0,
        thermal_v: 1.0,
        largest_exponent: 0.001,
        parallel_ohm: 1.0,
    };
    let clamp = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Resistor { ohm: 1.0 }),
        Branch::new(2, 0, bent),
    ];
    let circuit: Circuit<3, 3> = Circuit::new(clamp, Method::BackwardEuler, US).unwrap();
    let mut state = CircuitState::default();
    for source in [-10.0, -4.0, 10.0, -1.0] {
        let out = circuit.step(&mut state, CircuitInput::of([source, 0.0, 0.0]));
        assert!(out.settled && state.stored[2].get().is_finite(), "{source} {out:?} {state:?}");
    }
}

#[test]
fn an_inverter_inverts() {
    const P: Element = Element::Mos {
        gate: 2,
        p_channel: true,
        threshold_v: 3.0,
        gain_a_v2: 5e-4,
        modulation_per_v: 0.0,
    };
    const N: Element = Element::Mos {
        gate: 2,
        p_channel: false,
        threshold_v: 3.0,
        gain_a_v2: 5e-4,
        modulation_per_v: 0.0,
    };
    const INVERTER: [Branch; 5] = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(2, 0, Element::Voltage),
        // Drain at the output, source at the supply: its voltage and current are negative.
        Branch::new(3, 1, P),
        Branch::new(3, 0, N),
        Branch::new(3, 0, Element::Capacitor { farad: 1e-9 }),
    ];
    const CIRCUIT: Circuit<4, 5> = must!(Circuit::new(INVERTER, Method::BackwardEuler, US));
    for (input, output) in [(0.0, 10.0), (10.0, 0.0), (2.0, 10.0), (8.5, 0.0)] {
        let mut state = CircuitState::default();
        let mut out = None;
        for _ in 0..2000 {
            out = Some(CIRCUIT.step(&mut state, CircuitInput::of([10.0, input, 0.0, 0.0, 0.0])));
        }
        let out = out.unwrap();
        assert!(out.settled && (out.voltage_v[4] - output).abs() < 0.02, "{input} {out:?}");
    }
}

#[test]
fn says_why_a_circuit_is_refused() {
    const OHM: Element = Element::Resistor { ohm: 1.0 };
    let made = |branches| Circuit::<3, 3>::new(branches, Method::BackwardEuler, US).err();
    let v = Element::Voltage;
    for (branches, error, text) in [
        (
            [Branch::new(1, 0, v), Branch::new(1, 0, OHM), Branch::new(1, 0, OHM)],
            CircuitError::Floating(2),
            "node is tied to the others by nothing but sources of current (2)",
        ),
        (
            [Branch::new(1, 0, v), Branch::new(2, 0, v), Branch::new(1, 2, v)],
            CircuitError::SourceLoop(2),
            "element closes a loop of voltage sources (2)",
        ),
        (
            [Branch::new(1, 0, v), Branch::new(1, 3, OHM), Branch::new(2, 0, OHM)],
            CircuitError::NoSuchNode(1),
            "element names a node that the circuit does not have (1)",
        ),
        (
            [Branch::new(1, 0, v), Branch::new(1, 2, OHM), Branch::new(2, 2, OHM)],
            CircuitError::Shorted(2),
            "element has both ends at the same node (2)",
        ),
        (
            [
                Branch::new(1, 0, v),
                Branch::new(1, 2, Element::Resistor { ohm: 0.0 }),
                Branch::new(2, 0, OHM),
            ],
            CircuitError::Element(1, crate::ParamError::NotPositive("resistor.ohm")),
            "resistor.ohm must be finite and between 1e-12 and 1e12 (1)",
        ),
    ] {
        let found = made(branches).unwrap();
        assert_eq!(found, error);
        assert_eq!((format!("{found}").as_str(), found.text().as_str()), (text, text));
    }
    let table = Circuit::<4, 6, 6, 8>::tabled(H_BRIDGE, Method::BackwardEuler, US);
    assert_eq!(table.err(), Some(CircuitError::TableSize(16)));
    let table = Circuit::<4, 6, 1, 16>::tabled(H_BRIDGE, Method::BackwardEuler, US);
    assert_eq!(table.err(), Some(CircuitError::Sources(6)));
}

#[test]
fn a_bad_value_leaves_the_state_as_it_was() {
    const SOLVED: Circuit<4, 6> = must!(Circuit::new(H_BRIDGE, Method::BackwardEuler, US));
    let mut state = CircuitState::default();
    SOLVED.step(&mut state, CircuitInput { values: [400.0, 0.0, 0.0, 0.0, 0.0, 0.0], gates: 18 });
    let before = state;
    for bad in [Real::NAN, Real::INFINITY, 1e12] {
        let out = SOLVED.step(&mut state, CircuitInput::of([bad, 0.0, 0.0, 0.0, 0.0, 0.0]));
        assert!(out.rejected && state == before);
    }
}
