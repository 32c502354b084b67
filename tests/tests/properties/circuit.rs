//! Networks of any elements: refused by name, or finite, settled, and in balance, in `f32` and in the
//! f64 twin.

use proptest::prelude::*;

use crate::check::cases;

const NODES: usize = 5;
const ELEMENTS: usize = 8;
const STEPS: u32 = 60;

/// One element as numbers: one end, how far on the other is, kind, and where its values lie within their decades.
type Drawn = (usize, usize, u8, f64, f64);

fn drawn() -> impl Strategy<Value = [Drawn; ELEMENTS]> {
    prop::array::uniform8((0..NODES, 1..NODES, 0..8_u8, 0.0..1.0, 0.0..1.0))
}

/// What drives each element in a step: a value and a gate.
fn driven() -> impl Strategy<Value = Vec<([f64; ELEMENTS], u32)>> {
    prop::collection::vec((prop::array::uniform8(-500.0..500.0), 0..256_u32), 1..6)
}

/// `base` times up to `decades` powers of ten.
fn decades(base: f64, decades: f64, share: f64) -> f64 {
    base * 10_f64.powf(decades * share)
}

macro_rules! networks {
    ($name:ident, $core:ident, $closes:expr) => {
        mod $name {
            use super::*;
            use $core::circuit::{Branch, Circuit, CircuitInput, CircuitState, Element, Method};
            use $core::{Dt, Real};

            fn element(kind: u8, a: f64, b: f64) -> Element {
                let on_ohm = decades(1e-5, 4.0, a) as Real;
                let off_ohm = decades(1e4, 3.0, b) as Real;
                match kind {
                    0 => Element::Resistor { ohm: decades(1e-3, 7.0, a) as Real },
                    1 => Element::Coil {
                        henry: decades(1e-6, 6.0, a) as Real,
                        ohm: decades(1e-3, 4.0, b) as Real,
                    },
                    2 => Element::Capacitor { farad: decades(1e-9, 6.0, a) as Real },
                    3 => Element::Voltage,
                    4 => Element::Current,
                    5 => Element::Switch { on_ohm, off_ohm },
                    6 => Element::Diode { on_ohm, off_ohm, drop_v: a as Real },
                    _ => Element::Transistor {
                        on_ohm,
                        off_ohm,
                        drop_v: if b < 0.5 { 0.0 } else { a as Real },
                        diode_drop_v: b as Real,
                    },
                }
            }

            /// The energy that is stored, four times over, within one step \[W\]: where a step moves
            /// little of it, its last bit is what a current is off by.
            fn kept_w(
                branches: &[Branch; ELEMENTS],
                state: &CircuitState<ELEMENTS>,
                step: Dt,
            ) -> f64 {
                let twice_j = |e: usize| {
                    let size = match branches[e].element {
                        Element::Coil { henry, .. } => henry,
                        Element::Capacitor { farad } => farad,
                        _ => 0.0,
                    };
                    f64::from(size) * f64::from(state.stored[e].get()).powi(2)
                };
                2.0 * (0..ELEMENTS).map(twice_j).sum::<f64>() / f64::from(step.s())
            }

            pub fn run(
                drawn: [Drawn; ELEMENTS],
                driven: &[([f64; ELEMENTS], u32)],
                rule: bool,
                dt: f64,
            ) -> Result<(), TestCaseError> {
                let branches = drawn.map(|(from, on, kind, a, b)| Branch {
                    from,
                    to: (from + on) % NODES,
                    element: element(kind, a, b),
                });
                let method = if rule { Method::Trapezoidal } else { Method::BackwardEuler };
                let step = Dt::from_s(decades(1e-7, 3.0, dt) as Real).unwrap();
                let c = Circuit::<NODES, ELEMENTS>::new(branches, method, step);
                let Ok(circuit) = c else {
                    return Ok(());
                };
                let mut state = CircuitState::default();
                for number in 0..STEPS {
                    let (values, gates) = &driven[number as usize / 10 % driven.len()];
                    let input = CircuitInput { values: values.map(|v| v as Real), gates: *gates };
                    let before = state;
                    let out = circuit.step(&mut state, input);
                    if out.rejected {
                        // A source of current into a small capacitor goes beyond all bounds.
                        prop_assert_eq!(state, before);
                        return Ok(());
                    }
                    prop_assert!(out.voltage_v.iter().chain(&out.current_a).all(|x| x.is_finite()));
                    prop_assert!(out.settled, "step {} of {:?}: {:?}", number, branches, out);
                    let books = circuit.books(&before, &state, &out);
                    let bound_w = $closes * f64::from(books.throughput_w)
                        + f64::from(Real::EPSILON) * kept_w(&branches, &state, step);
                    prop_assert!(
                        f64::from(books.balance_w).abs() <= bound_w,
                        "step {} of {:?}: {:?}",
                        number,
                        branches,
                        books
                    );
                }
                Ok(())
            }
        }
    };
}

networks!(single, plant_core, 1e-5);
networks!(double, plant_core_f64, 1e-9);

proptest! {
    #![proptest_config(cases(16_384))]

    #[test]
    fn any_network_is_refused_or_settles_in_balance(
        drawn in drawn(), driven in driven(), rule: bool, dt in 0.0..1.0,
    ) {
        single::run(drawn, &driven, rule, dt)?;
        double::run(drawn, &driven, rule, dt)?;
    }
}
