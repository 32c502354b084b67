//! Circuits: resistors, coils, capacitors, sources, switches, diodes and transistors between nodes.
//!
//! # Map
//! | File | What it holds |
//! |---|---|
//! | `bridge` | the branches of an H-bridge and of a three-phase bridge |
//! | `build` | checks a circuit and discretises it |
//! | `element` | what a circuit is made of, and the curves of diode and MOS |
//! | `network` | the linear equations, along a spanning tree |
//! | `phases` | a synchronous machine as three coils |
//! | `settle` | which switches conduct; Newton's iteration for the curves |
//! | `books` | power of a step, what the method itself swallows |
//! | `error` | why a circuit is refused |
//!
//! # Equations
//! Each element is `i = g·v + s` over one step. With k = 1/h (backward Euler, first order) or 2/h
//! (trapezoidal rule, second order), and u the voltage across the pure inductance:
//!
//! - coil: `g = 1/(R + k·L)`, `s = i₀ + g·(u₀ − R·i₀ − e)`
//! - capacitor: `g = k·C`, `s = −g·v₀ − i₀`
//! - conducting diode or switch: `g = 1/R_on`, `s = −(g − 1/R_off)·V_drop`
//!
//! backward Euler without `u₀` and `−i₀`. A trapezoidal step in which a switch changed is taken again
//! as two halves by backward Euler, which has the same g: nothing rings \[MartiLin1989\]. Companion
//! models are \[Ho1975\]'s.
//!
//! Which of the two-state elements conduct is a linear complementarity problem with one solution,
//! since each of them is a rising curve: all that contradict the solution change at once, at last only
//! the first of them \[Murty1974\], at most [`ROUNDS`] times; an output says whether that was enough.
//! With [`Circuit::tabled`] the solution of each of the `2^n` configurations is computed when the
//! circuit is made, and a step only multiplies.
//!
//! Curved elements (junction, MOS) take the tangent at the last guess, at most [`ROUNDS`] times,
//! damped; the gate of a MOS is that of the guess before. An output gives the largest current that the
//! last tangent missed.
//!
//! The elements and their defaults are \[EPowertrain2025\]'s. Tests: `tests` below; property
//! `circuit`; cases "circuit: precharge", "circuit: series resonance", "circuit: buck converter"; against
//! ngspice `tests/tests/circuit.rs`.

#![expect(clippy::needless_range_loop, reason = "element e of several arrays at once")]

mod books;
mod bridge;
mod build;
mod element;
mod error;
mod network;
mod phases;
mod settle;

pub use books::Books;
pub use bridge::{h_bridge, three_phase};
pub use build::{sources, two_states};
pub use element::{Branch, Element};
pub use error::CircuitError;
pub use phases::Phases;
pub use settle::ROUNDS;

use crate::model::Model;
use crate::num::{Accum, Real};
use element::Devices;

/// How a step approximates a derivative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// First order; damps what is faster than the step.
    #[default]
    BackwardEuler,
    /// Second order; conserves energy. A step in which a switch changes is taken as two halves by
    /// backward Euler.
    Trapezoidal,
}

/// A circuit of `NODES` nodes, the ground included, and `ELEMENTS` elements, discretised for one step.
///
/// ```
/// use plant_core::circuit::{Branch, Circuit, CircuitInput, CircuitState, Element, Method};
/// use plant_core::{Dt, must};
///
/// // A capacitor is charged through 40 Ω from 355 V.
/// const PRECHARGE: [Branch; 3] = [
///     Branch::new(1, 0, Element::Voltage),
///     Branch::new(1, 2, Element::Resistor { ohm: 40.0 }),
///     Branch::new(2, 0, Element::Capacitor { farad: 0.00096 }),
/// ];
/// const CIRCUIT: Circuit<3, 3> =
///     must!(Circuit::new(PRECHARGE, Method::Trapezoidal, must!(Dt::from_s(0.0001))));
///
/// let mut state = CircuitState::default();
/// let mut out = CIRCUIT.step(&mut state, CircuitInput::of([355.0, 0.0, 0.0]));
/// for _ in 1..384 {
///     out = CIRCUIT.step(&mut state, CircuitInput::of([355.0, 0.0, 0.0]));
/// }
/// // After one time constant of 38.4 ms; the source rose from zero over the first step, so half a step
/// // of 0.1 ms late.
/// assert!((out.voltage_v[2] - 355.0 * (1.0 - (-38.35_f32 / 38.4).exp())).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circuit<
    const NODES: usize,
    const ELEMENTS: usize,
    const SOURCES: usize = 0,
    const CONFIGURATIONS: usize = 0,
> {
    branches: [Branch; ELEMENTS],
    method: Method,
    /// 1/h or 2/h.
    per_s: Real,
    /// Conductance of each element, blocking and conducting; those that vary stay zero.
    blocking_s: [Real; ELEMENTS],
    conducting_s: [Real; ELEMENTS],
    devices: Devices,
    /// Bit e: element e is a coil or a capacitor.
    stores: u32,
    /// Voltage drops, forward and backward.
    drop_v: [(Real, Real); ELEMENTS],
    /// The elements that can drive a current.
    drives: [usize; SOURCES],
    table: [Response<ELEMENTS, SOURCES>; CONFIGURATIONS],
}

/// All elements' answers to what drives the network, for one set of conducting elements.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Response<const E: usize, const S: usize> {
    /// Voltage of an element, or its current where `by_current` has its bit.
    rows: [[Real; S]; E],
    by_current: u32,
}

/// The state of a [`Circuit`]: at rest and without charge by default.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CircuitState<const ELEMENTS: usize> {
    /// Current of a coil \[A\], voltage of a capacitor \[V\], charge of a variable one \[C\], voltage of a
    /// curved element \[V\].
    pub stored: [Accum; ELEMENTS],
    /// Voltage across the inductance of a coil \[V\], current of a capacitor \[A\]; for the trapezoidal
    /// rule.
    pub rate: [Real; ELEMENTS],
    /// Bit e: element e conducts forward.
    pub forward: u32,
    /// Bit e: element e conducts backward.
    pub reverse: u32,
}

impl<const ELEMENTS: usize> Default for CircuitState<ELEMENTS> {
    fn default() -> Self {
        Self { stored: [Accum::new(0.0); ELEMENTS], rate: [0.0; ELEMENTS], forward: 0, reverse: 0 }
    }
}

/// Input of one step of a [`Circuit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircuitInput<const ELEMENTS: usize> {
    /// What [`Element`] says for each kind; without meaning for the others.
    pub values: [Real; ELEMENTS],
    /// Bit e: the gate of element e is on.
    pub gates: u32,
}

impl<const ELEMENTS: usize> CircuitInput<ELEMENTS> {
    /// Values, all gates off.
    #[must_use]
    pub const fn of(values: [Real; ELEMENTS]) -> Self {
        Self { values, gates: 0 }
    }
}

/// Output of one step of a [`Circuit`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircuitOutput<const ELEMENTS: usize> {
    /// Voltage of each element \[V\].
    pub voltage_v: [Real; ELEMENTS],
    /// Current of each element \[A\].
    pub current_a: [Real; ELEMENTS],
    /// How many times the network was solved.
    pub rounds: u32,
    /// The elements that conduct fit the solution.
    pub settled: bool,
    /// By how much the worst curve was missed beyond rounding \[A\].
    pub missed_a: Real,
    /// An input was not finite or absurd; the state is unchanged, all else is zero.
    pub rejected: bool,
}

impl<const N: usize, const E: usize, const S: usize, const C: usize> Circuit<N, E, S, C> {
    /// What the circuit is made of.
    #[must_use]
    pub const fn branches(&self) -> &[Branch; E] {
        &self.branches
    }

    /// Advances by one step.
    pub fn step(&self, state: &mut CircuitState<E>, input: CircuitInput<E>) -> CircuitOutput<E> {
        let out = match self.method {
            Method::BackwardEuler => self.advance(state, &input, false),
            Method::Trapezoidal => self.trapezoidal(state, &input),
        };
        out.unwrap_or(CircuitOutput {
            voltage_v: [0.0; E],
            current_a: [0.0; E],
            rounds: 0,
            settled: false,
            missed_a: 0.0,
            rejected: true,
        })
    }

    fn trapezoidal(
        &self,
        state: &mut CircuitState<E>,
        input: &CircuitInput<E>,
    ) -> Option<CircuitOutput<E>> {
        let mut next = *state;
        let mut out = self.advance(&mut next, input, true);
        if (next.forward | next.reverse) != (state.forward | state.reverse) {
            next = *state;
            let first = self.advance(&mut next, input, false)?;
            out = self.advance(&mut next, input, false);
            if let Some(second) = &mut out {
                second.rounds += first.rounds;
                second.settled &= first.settled;
            }
        }
        if out.is_some() {
            *state = next;
        }
        out
    }

    /// One step, or half of one, or nothing and no change where its input is not finite or absurd;
    /// `memory`: by the trapezoidal rule.
    #[inline(always)]
    fn advance(
        &self,
        state: &mut CircuitState<E>,
        input: &CircuitInput<E>,
        memory: bool,
    ) -> Option<CircuitOutput<E>> {
        let mut drive = [0.0; E];
        let weight = if memory { 1.0 } else { 0.0 };
        for e in 0..E {
            let (value, stored, rate) =
                (input.values[e], state.stored[e].get(), weight * state.rate[e]);
            drive[e] = match self.branches[e].element {
                Element::Coil { ohm, .. } => {
                    stored + self.blocking_s[e] * (rate - ohm * stored - value)
                }
                Element::Capacitor { .. } => -self.blocking_s[e] * stored - rate,
                Element::VariableCapacitor => -self.per_s * stored - rate,
                Element::Voltage | Element::Current => value,
                _ => 0.0,
            };
        }
        let before = *state;
        let out = self.settle(state, input, drive);
        // What is not a number spreads to every element; what is absurd would stay in those that store.
        let mut sum = out.voltage_v.first().map_or(0.0, |v| v.abs());
        for e in 0..E {
            sum += input.values[e].abs();
            if self.stores >> e & 1 == 1 {
                sum += out.voltage_v[e].abs() + out.current_a[e].abs();
            }
        }
        if !crate::num::sound(sum) {
            (state.forward, state.reverse) = (before.forward, before.reverse);
            if C == 0 {
                *state = before;
            }
            return None;
        }
        for e in 0..E {
            if self.stores >> e & 1 == 0 {
                continue;
            }
            let (voltage_v, current_a) = (out.voltage_v[e], out.current_a[e]);
            match self.branches[e].element {
                Element::Coil { ohm, .. } => {
                    let stored = state.stored[e].get();
                    let across_v =
                        voltage_v + weight * state.rate[e] - ohm * stored - input.values[e];
                    state.stored[e].add(self.blocking_s[e] * across_v);
                    state.rate[e] = voltage_v - input.values[e] - ohm * state.stored[e].get();
                }
                Element::Capacitor { .. } => {
                    let charge = current_a + weight * state.rate[e];
                    state.stored[e].add(charge / self.blocking_s[e]);
                    state.rate[e] = current_a;
                }
                Element::VariableCapacitor => {
                    state.stored[e] = Accum::new(input.values[e] * voltage_v);
                    state.rate[e] = current_a;
                }
                _ => {}
            }
        }
        Some(out)
    }
}

impl<const N: usize, const E: usize, const S: usize, const C: usize> Model for Circuit<N, E, S, C> {
    type State = CircuitState<E>;
    type Input = CircuitInput<E>;
    type Output = CircuitOutput<E>;

    #[inline]
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Output {
        Circuit::step(self, state, input)
    }
}

#[cfg(test)]
mod tests;
