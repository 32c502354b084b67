//! Which elements conduct, and where on its curve an element lies.

use super::element::{Branch, Element};
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
    #[inline(always)]
    pub(super) fn settle(
        &self,
        state: &mut CircuitState<E>,
        input: &CircuitInput<E>,
        mut drive: [Real; E],
    ) -> CircuitOutput<E> {
        let devices = &self.devices;
        let may = May {
            forward: devices.all & (!devices.gated | input.gates),
            both: devices.level & input.gates,
        };
        // What the gates decide by themselves.
        state.forward = state.forward & may.forward | may.both & !state.reverse;
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
            self.drops(state, &mut drive, may);
            if C > 0 {
                self.looked_up(state, &drive, &mut out);
            } else {
                let found = self.solved(state, input, &mut drive, &mut out.missed_a);
                (out.voltage_v, out.current_a) = (found.voltage_v, found.current_a);
            }
            let (forward, reverse) = self.judge(state, may, &out);
            let conducts = forward | reverse;
            // Where there is no drop, which way it conducts changes nothing.
            let turned = (forward ^ state.forward) & devices.drop & !may.both;
            let same = conducts == (state.forward | state.reverse) && turned & conducts == 0;
            out.settled = same && out.missed_a <= 0.0;
            (state.forward, state.reverse) = (forward, reverse);
        }
        out
    }

    /// What drives the elements that conduct against their voltage drops.
    #[inline(always)]
    fn drops(&self, state: &CircuitState<E>, drive: &mut [Real; E], may: May) {
        for e in 0..E {
            if on(self.devices.drop, e) {
                let step_s = self.conducting_s[e] - self.blocking_s[e];
                let (forward_v, reverse_v) = self.drop_v[e];
                drive[e] = if on(may.both, e) {
                    0.0
                } else if on(state.forward, e) {
                    -step_s * forward_v
                } else if on(state.reverse, e) {
                    step_s * reverse_v
                } else {
                    0.0
                };
            }
        }
    }

    /// The solution of a configuration from its table.
    #[inline(always)]
    fn looked_up(&self, state: &CircuitState<E>, drive: &[Real; E], out: &mut CircuitOutput<E>) {
        let conducts = state.forward | state.reverse;
        let Some(response) = self.table.get(self.devices.configuration(conducts)) else {
            return;
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
            (out.voltage_v[e], out.current_a[e]) = if on(response.by_current, e) {
                let source = conductance_s == Real::INFINITY;
                (if source { drive[e] } else { (sum - drive[e]) / conductance_s }, sum)
            } else {
                (sum, conductance_s * sum + drive[e])
            };
        }
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
    #[inline(always)]
    fn judge(&self, state: &CircuitState<E>, may: May, out: &CircuitOutput<E>) -> (u32, u32) {
        let conducts = (state.forward, state.reverse);
        if out.rounds > CAREFUL {
            return self.judge_carefully(conducts, may, out);
        }
        let (mut forward, mut reverse) = (0, 0);
        for e in 0..E {
            if on(self.devices.all, e) {
                let (is_forward, is_reverse) = self.judge_one(e, conducts, may, out, (0.0, 0.0));
                forward |= u32::from(is_forward) << e;
                reverse |= u32::from(is_reverse) << e;
            }
        }
        (forward, reverse)
    }

    /// The same up to the first that changes, rounding being no reason.
    #[cold]
    #[inline(never)]
    fn judge_carefully(
        &self,
        conducts: (u32, u32),
        may: May,
        out: &CircuitOutput<E>,
    ) -> (u32, u32) {
        let mut rounding = (0.0, 0.0);
        for e in 0..E {
            rounding.0 = max(rounding.0, ROUNDING * out.voltage_v[e].abs());
            rounding.1 = max(rounding.1, ROUNDING * out.current_a[e].abs());
        }
        let (mut forward, mut reverse) = conducts;
        for e in 0..E {
            if !on(self.devices.all, e) {
                continue;
            }
            let (is_forward, is_reverse) = self.judge_one(e, conducts, may, out, rounding);
            let bit = 1 << e;
            forward = if is_forward { forward | bit } else { forward & !bit };
            reverse = if is_reverse { reverse | bit } else { reverse & !bit };
            if on(conducts.0 | conducts.1, e) != (is_forward || is_reverse) {
                break;
            }
        }
        (forward, reverse)
    }

    /// Whether an element would conduct forward, or backward.
    #[inline(always)]
    fn judge_one(
        &self,
        e: usize,
        (forward, reverse): (u32, u32),
        may: May,
        out: &CircuitOutput<E>,
        (rounding_v, rounding_a): (Real, Real),
    ) -> (bool, bool) {
        let (voltage_v, current_a) = (out.voltage_v[e], out.current_a[e]);
        let (forward_v, reverse_v) = self.drop_v[e];
        let back = on(self.devices.back, e);
        let least_a = |drop_v: Real| self.blocking_s[e] * drop_v - rounding_a;
        if on(may.both, e) {
            // Which way matters once its gate goes off.
            let turned = back && current_a < 0.0;
            (!turned, turned)
        } else if on(forward, e) {
            (on(may.forward, e) && current_a >= least_a(forward_v), false)
        } else if on(reverse, e) {
            (false, back && -current_a >= least_a(reverse_v))
        } else {
            let begins = on(may.forward, e) && voltage_v > forward_v + rounding_v;
            (begins, !begins && back && -voltage_v > reverse_v + rounding_v)
        }
    }
}

/// What the gates allow in a step: bits of the elements that may conduct forward, and of those that
/// conduct both ways.
#[derive(Clone, Copy)]
struct May {
    forward: u32,
    both: u32,
}

/// Whether a bit is set.
#[inline]
const fn on(bits: u32, e: usize) -> bool {
    bits >> e & 1 == 1
}
