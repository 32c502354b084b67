//! Limits: they act on the duty, so both sides of the converter agree.
//!
//! Within a friction mode the speed is linear in the winding current x, and so is the winding's
//! voltage `e + r·x + l·(x − i)`. The limits bound the power on the bus, that is a quadratic in x;
//! the nearest x that keeps them gives the voltage, the bus and the duty. It is ours.
//!
//! Tests: `tests` below, and those of the powertrain over many steps; property `limits`.

use super::solve::{Solution, Start};
use super::{Limited, Powertrain, PowertrainState};
use crate::battery::{CurrentLimits, Pack};
use crate::converter::Gates;
use crate::mechanics::body::Resistance;
use crate::num::{LARGEST, Real, clamp, max, min, sign, sqrt};
use crate::port::{Slip, Source};
use crate::powertrain::ledger::Book;

/// How often the friction mode may change while the duty is sought; there are three modes.
const TRIES: u32 = 3;
/// What flows beyond a limit counts as exceeding it from this share of the current on.
const EXCEEDED_REL: Real = 1e-3;
/// And from this much on \[A\].
const EXCEEDED_A: Real = 1e-3;

/// Of the current of a battery's greatest power, what a limit beyond it leaves: at the greatest
/// power itself a current does not follow from a power in single precision; here 99.9 % of it do.
const GREATEST: Real = 0.97;

/// A step that keeps the limits, as far as a duty can.
pub(super) struct Held {
    pub solution: Solution,
    pub limited: Limited,
    pub starved: bool,
    /// What flows beyond the battery's limits all the same \[A\].
    pub exceeded_a: Real,
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    /// The step again, so that the limits are kept: the auxiliary loads are cut off where nothing
    /// feeds them, then the duty is held back.
    ///
    /// It works out for itself where the step starts from, and takes numbers one by one: to be
    /// handed more would have every step keep it in memory, for the sake of the few that come here.
    #[cold]
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "see above")]
    pub(super) fn hold_limits(
        &self,
        state: &PowertrainState<L, B::State>,
        gates: Gates,
        auxiliary_w: Real,
        asked: CurrentLimits,
        force_n: Real,
        slope_n_s_per_m: Real,
        friction_n: Real,
    ) -> Held {
        let limits = self.battery.faded(&state.battery).within(asked);
        let resistance = Resistance { force_n, slope_n_s_per_m, friction_n, drag_n_s_per_m: 0.0 };
        let (mut start, source, _) = self.start(state, auxiliary_w, resistance);
        let walk = |start: &Start| match gates {
            Gates::Off => self.solve_off(start),
            Gates::On(duty) => self.solve(start, self.converter.allowed_duty(duty)),
        };
        let mut solution = walk(&start);
        let starved = solution.battery_a > limits.discharge_a
            && start.loads.current_a(start.bus.emf_v) > limits.discharge_a;
        if starved {
            start.starve(source);
            solution = walk(&start);
        }
        let mut limited = Limited::No;
        if let Gates::On(_) = gates {
            (solution, limited) = self.held(&start, source, limits, solution);
        }
        let over_a =
            max(solution.battery_a - limits.discharge_a, -solution.battery_a - limits.charge_a);
        let exceeded = over_a > EXCEEDED_REL * solution.battery_a.abs() + EXCEEDED_A;
        Held { solution, limited, starved, exceeded_a: if exceeded { over_a } else { 0.0 } }
    }

    /// The solution with the winding current nearest to that of `wanted` that keeps the limits.
    ///
    /// The current decides on the power, the power on the bus voltage, both on the duty. In which
    /// direction friction acts is part of the axis; where it turns out another, once more.
    fn held(
        &self,
        start: &Start,
        source: Source,
        limits: CurrentLimits,
        wanted: Solution,
    ) -> (Solution, Limited) {
        let wanted_a = start.current_a + wanted.current_increment_a;
        let most_a = self.converter.params.current_limit_a;
        let half_v = 0.5 * start.bus.emf_v;
        let (lowest_w, mut highest_w) = drive_power_w(start, source, limits);
        let mut asked_a = wanted_a;
        if wanted.battery_a <= limits.discharge_a {
            highest_w = LARGEST;
        } else if wanted.battery_v < half_v {
            // A duty beyond that of the greatest power asks for more and brings less.
            asked_a = sign(wanted_a) * LARGEST;
        }
        let want = clamp(asked_a, -most_a, most_a);
        let (mut solution, mut limited, mut tries) = (wanted, Limited::No, 0);
        loop {
            let slip = solution.motion.slip;
            let axis = self.axis(start, slip, want);
            let current_a = axis.held(want, lowest_w, highest_w);
            if current_a != want {
                // Braking by drawing may end as braking that charges.
                let draws = axis.power_w(want) > highest_w && axis.power_w(current_a) >= 0.0;
                limited = if draws { Limited::Discharge } else { Limited::Charge };
            } else if want != wanted_a {
                limited = Limited::Current;
            } else if limited == Limited::No {
                return (wanted, limited);
            }
            let terminal_v = axis.terminal_v(current_a);
            let headroom = half_v * half_v - start.bus.resistance_ohm * terminal_v * current_a;
            let bus_v = half_v + sqrt(max(headroom, 0.0));
            solution = self.solve(start, self.converter.allowed_duty(terminal_v / bus_v));
            tries += 1;
            if solution.motion.slip == slip || tries == TRIES {
                return (solution, limited);
            }
        }
    }

    /// The winding with its converter in one friction mode, the speed eliminated; `want` says
    /// in which direction the converter's drop acts.
    fn axis(&self, start: &Start, slip: Slip, want: Real) -> Axis {
        let winding = &self.winding;
        let mut axis = Axis {
            inductance_ohm: winding.inductance_per_h_ohm,
            resistance_ohm: winding.resistance_ohm + start.converter_ohm,
            back_emf_v: sign(want) * start.drop_v,
            current_a: start.current_a,
        };
        if slip != Slip::Stuck {
            let mobility = 1.0 / start.resistance.slope_n_s_per_m;
            let coasting_n = start.resistance.force_n - slip.sign() * start.resistance.friction_n;
            axis.back_emf_v += winding.back_emf * (start.speed_m_s + coasting_n * mobility);
            axis.resistance_ohm += winding.back_emf * winding.effort_per_a * mobility;
        }
        axis
    }
}

/// The lowest and the highest power that the drive may take from the bus \[W\].
fn drive_power_w(start: &Start, source: Source, limits: CurrentLimits) -> (Real, Real) {
    let charging_v = source.voltage_v(-limits.charge_a);
    let fed_a = limits.charge_a + start.loads.current_a(charging_v);
    // No more than the source can give at all.
    let drawn_a = min(limits.discharge_a, GREATEST * 0.5 * source.emf_v / source.resistance_ohm);
    let drawing_v = source.voltage_v(drawn_a);
    let left_a = max(drawn_a - start.loads.current_a(drawing_v), 0.0);
    (-fed_a * charging_v, left_a * drawing_v)
}

/// A winding over one step. A step that ends at the current x takes the power
/// `x·(e + r·x + l·(x − i))` from the bus; held there, it takes `x·(e + r·x)`.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// l: inductance over the step \[Ω\].
    inductance_ohm: Real,
    /// r: resistance, and how a current changes the back-EMF \[Ω\].
    resistance_ohm: Real,
    /// e: back-EMF without current \[V\].
    back_emf_v: Real,
    /// i: current at the start \[A\].
    current_a: Real,
}

impl Axis {
    /// The voltage that leads to the current x.
    fn terminal_v(&self, x: Real) -> Real {
        self.back_emf_v + self.resistance_ohm * x + self.inductance_ohm * (x - self.current_a)
    }

    fn power_w(&self, x: Real) -> Real {
        x * self.terminal_v(x)
    }

    /// The current nearest to `want` whose power lies between `lowest_w` ≤ 0 and `highest_w` ≥ 0.
    ///
    /// Discharging, the power of the step itself is held, which is stable: less current, less
    /// power. Charging it is not, as a voltage that lowers the power lets the current grow: there
    /// the power of the current *held* bounds it, `r·x² + e·x = lowest`, whatever i is. From
    /// within this edge the step lands on it. A current beyond decays with L/r, under the voltage
    /// that belongs to the edge, so that the battery's current exceeds its limit by the factor
    /// |i|/|edge| at most.
    fn held(&self, want: Real, lowest_w: Real, highest_w: Real) -> Real {
        let (e, i) = (self.back_emf_v, self.current_a);
        let want =
            if self.power_w(want) > highest_w { self.at_power(highest_w, want) } else { want };
        let discriminant = e * e + 4.0 * self.resistance_ohm * lowest_w;
        if discriminant > 0.0 {
            // All counted in the direction in which the machine brakes.
            let direction = -sign(e);
            let edge = -2.0 * lowest_w / (e.abs() + sqrt(discriminant));
            let (held, braking) = (direction * i, direction * want);
            if held > edge && braking > 0.0 {
                let share = self.resistance_ohm / (self.inductance_ohm + self.resistance_ohm);
                let decayed = direction * (held + (edge - held) * share);
                // Faster only where that charges less.
                let faster =
                    braking < direction * decayed && self.power_w(want) >= self.power_w(decayed);
                return if faster { want } else { decayed };
            }
            if braking > edge {
                return direction * edge;
            }
        }
        if self.power_w(want) < lowest_w { self.at_power(lowest_w, i) } else { want }
    }

    /// The root of `(l + r)·x² + (e − l·i)·x = p` on the side of `near`.
    fn at_power(&self, p: Real, near: Real) -> Real {
        let a = self.inductance_ohm + self.resistance_ohm;
        let b = self.back_emf_v - self.inductance_ohm * self.current_a;
        let discriminant = b * b + 4.0 * a * p;
        if discriminant < 0.0 {
            return -b / (2.0 * a);
        }
        // Without cancellation.
        let q = -0.5 * (b + if b < 0.0 { -sqrt(discriminant) } else { sqrt(discriminant) });
        if q == 0.0 {
            return 0.0;
        }
        let (one, two) = (q / a, -p / q);
        let first = if p > 0.0 {
            (one > 0.0) == (near > 0.0)
        } else {
            (one - near).abs() < (two - near).abs()
        };
        if first { one } else { two }
    }
}

#[cfg(test)]
mod tests;
