//! Which elements conduct, and where on its curve an element lies.

use super::element::{Branch, Element, Mode};
use super::network::{Network, Solution};
use super::{Circuit, CircuitInput, CircuitOutput, CircuitState};
use crate::num::{Accum, Real, max};

/// How many times a step solves its network at most.
pub const ROUNDS: u32 = 24;
/// From which round on only the first element that contradicts the solution changes, which comes to
/// an end in any passive network; and what is within rounding is no contradiction any more.
const CAREFUL: u32 = 8;
/// Rounding of a voltage or a current against the largest of them.
const ROUNDING: Real = 1e-5;
/// Where a curve counts as met, against its own current.
const MET: Real = 1e-5;
/// And against the largest of all that drives the network: what rounding leaves.
const MET_OF_DRIVE: Real = 1e-6;

impl<const N: usize, const E: usize, const S: usize, const C: usize> Circuit<N, E, S, C> {
    /// Solves a step whose linear elements are driven by `drive`, and leaves in `state` what conducts
    /// and where the curves are.
    pub(super) fn settle(
        &self,
        state: &mut CircuitState<E>,
        input: &CircuitInput<E>,
        mut drive: [Real; E],
    ) -> CircuitOutput<E> {
        self.gate(state, input.gates);
        let mut out = CircuitOutput {
            voltage_v: [0.0; E],
            current_a: [0.0; E],
            rounds: 0,
            settled: false,
            missed_a: 0.0,
            rejected: false,
        };
        while out.rounds < ROUNDS && !out.settled {
            out.rounds += 1;
            self.drops(state, &mut drive, input.gates);
            let found = if C > 0 {
                self.looked_up(state, &drive)
            } else {
                self.solved(state, input, &mut drive, &mut out.missed_a)
            };
            (out.voltage_v, out.current_a) = (found.voltage_v, found.current_a);
            let (forward, reverse) = self.judge(state, input, &out);
            let same = forward == state.forward && reverse == state.reverse;
            out.settled = same && out.missed_a <= 0.0;
            (state.forward, state.reverse) = (forward, reverse);
        }
        out
    }

    /// What the gates decide by themselves.
    fn gate(&self, state: &mut CircuitState<E>, gates: u32) {
        for e in 0..E {
            let element = &self.branches[e].element;
            if !element.two_state() {
                continue;
            }
            let drops = element.drops_v(on(gates, e));
            if !drops.one_way {
                state.forward &= !(1 << e);
            } else if drops.closed && !on(state.reverse, e) {
                state.forward |= 1 << e;
            }
        }
    }

    /// What drives the elements that conduct against their voltage drops.
    fn drops(&self, state: &CircuitState<E>, drive: &mut [Real; E], gates: u32) {
        for e in 0..E {
            let element = &self.branches[e].element;
            if element.two_state() && element.drives() {
                let drops = element.drops_v(on(gates, e));
                let step_s = self.conducting_s[e] - self.blocking_s[e];
                drive[e] = if drops.closed {
                    0.0
                } else if on(state.forward, e) {
                    -step_s * drops.forward
                } else if on(state.reverse, e) {
                    step_s * drops.reverse
                } else {
                    0.0
                };
            }
        }
    }

    /// The solution of a configuration from its table.
    fn looked_up(&self, state: &CircuitState<E>, drive: &[Real; E]) -> Solution<E> {
        let mut found = Solution { voltage_v: [0.0; E], current_a: [0.0; E] };
        let conducts = state.forward | state.reverse;
        let (mut configuration, mut device) = (0, 0);
        for e in 0..E {
            if self.branches[e].element.two_state() {
                configuration |= usize::from(on(conducts, e)) << device;
                device += 1;
            }
        }
        let Some(response) = self.table.get(configuration) else {
            return found;
        };
        let mut driving = [0.0; S];
        for (value, e) in driving.iter_mut().zip(self.drives) {
            *value = drive.get(e).copied().unwrap_or(0.0);
        }
        for e in 0..E {
            let mut sum = 0.0;
            for (row, value) in response.rows[e].iter().zip(&driving) {
                sum += row * value;
            }
            let conductance_s =
                if on(conducts, e) { self.conducting_s[e] } else { self.blocking_s[e] };
            let source = conductance_s == Real::INFINITY;
            (found.voltage_v[e], found.current_a[e]) = if on(response.by_current, e) {
                let voltage_v = if source { drive[e] } else { (sum - drive[e]) / conductance_s };
                (voltage_v, sum)
            } else {
                (sum, conductance_s * sum + drive[e])
            };
        }
        found
    }

    /// The solution with each curve along its tangent. `missed_a`: by how much the worst of them lies
    /// off beyond what counts as met.
    fn solved(
        &self,
        state: &mut CircuitState<E>,
        input: &CircuitInput<E>,
        drive: &mut [Real; E],
        missed_a: &mut Real,
    ) -> Solution<E> {
        let conducts = state.forward | state.reverse;
        let mut conductance_s = [0.0; E];
        for e in 0..E {
            let element = &self.branches[e].element;
            conductance_s[e] = if element.curved() {
                let guess_v = state.stored[e].get();
                let (current_a, slope_s) = element.curve(guess_v, state.rate[e]);
                drive[e] = current_a - slope_s * guess_v;
                slope_s
            } else {
                element.conductance_s(self.per_s, on(conducts, e), input.values[e])
            };
        }
        let Ok(net) = Network::<N, E>::new(&self.branches, conductance_s) else {
            return Solution { voltage_v: [Real::NAN; E], current_a: [Real::NAN; E] };
        };
        let found = net.solve(&self.branches, drive);
        *missed_a = 0.0;
        let mut largest_a = 0.0;
        for e in 0..E {
            if conductance_s[e] < Real::INFINITY {
                largest_a = max(largest_a, drive[e].abs());
            }
        }
        for e in 0..E {
            let Branch { to, element, .. } = self.branches[e];
            if !element.curved() {
                continue;
            }
            if let Element::Mos { gate, .. } = element {
                state.rate[e] =
                    net.potential_v(gate, &found.voltage_v) - net.potential_v(to, &found.voltage_v);
            }
            let (current_a, _) = element.curve(found.voltage_v[e], state.rate[e]);
            let off_a = (current_a - found.current_a[e]).abs()
                - (MET * current_a.abs() + MET_OF_DRIVE * largest_a);
            *missed_a = max(*missed_a, off_a);
            let guess_v = state.stored[e].get();
            state.stored[e] = Accum::new(element.damped_v(guess_v, found.voltage_v[e]));
        }
        found
    }

    /// What would conduct by this solution: bits forward, bits backward.
    fn judge(
        &self,
        state: &CircuitState<E>,
        input: &CircuitInput<E>,
        out: &CircuitOutput<E>,
    ) -> (u32, u32) {
        let careful = out.rounds > CAREFUL;
        let (mut largest_v, mut largest_a) = (0.0, 0.0);
        for e in 0..E {
            if careful {
                largest_v = max(largest_v, out.voltage_v[e].abs());
                largest_a = max(largest_a, out.current_a[e].abs());
            }
        }
        let (mut forward, mut reverse) = (state.forward, state.reverse);
        for e in 0..E {
            let element = &self.branches[e].element;
            if !element.two_state() {
                continue;
            }
            let drops = element.drops_v(on(input.gates, e));
            let (voltage_v, current_a) = (out.voltage_v[e], out.current_a[e]);
            let mode = if drops.closed {
                // Which way matters once its gate goes off.
                if current_a < 0.0 && drops.back { Mode::Reverse } else { Mode::Forward }
            } else if on(state.forward, e) {
                let least_a = self.blocking_s[e] * drops.forward - ROUNDING * largest_a;
                let holds = drops.one_way && current_a >= least_a;
                if holds { Mode::Forward } else { Mode::Blocking }
            } else if on(state.reverse, e) {
                let least_a = self.blocking_s[e] * drops.reverse - ROUNDING * largest_a;
                let holds = drops.back && -current_a >= least_a;
                if holds { Mode::Reverse } else { Mode::Blocking }
            } else if drops.one_way && voltage_v > drops.forward + ROUNDING * largest_v {
                Mode::Forward
            } else if drops.back && -voltage_v > drops.reverse + ROUNDING * largest_v {
                Mode::Reverse
            } else {
                Mode::Blocking
            };
            let bit = 1 << e;
            let was = (forward & bit != 0) || (reverse & bit != 0);
            forward = if mode == Mode::Forward { forward | bit } else { forward & !bit };
            reverse = if mode == Mode::Reverse { reverse | bit } else { reverse & !bit };
            if careful && was != (mode != Mode::Blocking) {
                break;
            }
        }
        (forward, reverse)
    }
}

/// Whether a bit is set.
#[inline]
const fn on(bits: u32, e: usize) -> bool {
    bits >> e & 1 == 1
}
