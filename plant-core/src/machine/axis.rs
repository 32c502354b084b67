//! Limits on the axis of a winding that makes the torque: which current keeps them.
//!
//! Within one step a winding takes the power `x·(e + r·x + l·(x − i))` from the bus to end at the
//! current x, and `x·(e + r·x)` to hold it. It is ours.
//!
//! Discharging, the power of the step itself is bounded: less current, less power, so that is
//! stable. Charging it is not, as a voltage that lowers the power lets the current grow: there the
//! power of the current *held* bounds it, up to the edge `r·x² + e·x = lowest`, whatever i is. Beyond
//! this edge and its other root less is charged again, by a machine that brakes by drawing: a
//! command that leads there in the end is no charging at all, and is left alone.
//!
//! Tests: `tests` below; those of the powertrain over many steps; property `limits`.

use super::Held;
use crate::num::{Real, clamp, max, min, sign, sqrt};

/// How much a current that is wanted lower may exceed the lowest power while it gives up its field:
/// without, it could never leave the edge.
const RELEASE: Real = 1.0005;

/// One axis of a winding over one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// l: inductance over the step \[Ω\].
    pub inductance_ohm: Real,
    /// r: resistance, and how a current changes the back-EMF \[Ω\].
    pub resistance_ohm: Real,
    /// e: back-EMF without current \[V\].
    pub back_emf_v: Real,
    /// i: current at the start \[A\].
    pub current_a: Real,
}

/// What a step on an [`Axis`] may do.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisBounds {
    /// Power, ≤ 0 \[W\].
    pub lowest_w: Real,
    /// Power of the current once held, ≤ 0 \[W\].
    pub lowest_held_w: Real,
    /// Power, ≥ 0 \[W\].
    pub highest_w: Real,
    /// Magnitude of the current \[A\].
    pub current_a: Real,
}

impl Axis {
    pub const fn power_w(&self, x: Real) -> Real {
        x * (self.held_v(x) + self.inductance_ohm * (x - self.current_a))
    }

    const fn held_v(&self, x: Real) -> Real {
        self.back_emf_v + self.resistance_ohm * x
    }

    /// The current nearest to `want` that keeps the bounds, `ends_at` being the one at which the
    /// command would settle.
    ///
    /// From within the edge the step lands on it. A current beyond decays with L/r, under the voltage
    /// that belongs to the edge, so that the battery's current exceeds its limit by the factor
    /// |i|/|edge| at most.
    pub fn held(&self, want: Real, ends_at: Real, bounds: &AxisBounds) -> (Real, Held) {
        let most_a = bounds.current_a;
        let (mut x, mut held) = (clamp(want, -most_a, most_a), Held::No);
        if x != want {
            held = Held::Current;
        }
        if self.power_w(x) > bounds.highest_w {
            // Braking by drawing may end as braking that charges.
            (x, held) = (self.at_power(bounds.highest_w, x), Held::Discharge);
        }
        let ends_at = clamp(ends_at, -most_a, most_a);
        let charges = ends_at * self.held_v(ends_at) < bounds.lowest_held_w;
        if !charges && self.power_w(x) >= bounds.lowest_w {
            return (x, held);
        }
        let free = x;
        // Counted in the direction in which the machine brakes.
        let direction = if self.back_emf_v > 0.0 { -1.0 } else { 1.0 };
        let carried = direction * self.current_a;
        let edge = self.edge(bounds.lowest_held_w);
        let share = self.resistance_ohm / (self.inductance_ohm + self.resistance_ohm);
        let decayed = carried + (edge - carried) * share;
        if charges || direction * x > carried {
            let braking = direction * x;
            x = if carried <= edge {
                direction * min(braking, edge)
            } else if braking > 0.0 {
                direction * decayed
            } else {
                x
            };
        }
        if self.power_w(x) < bounds.lowest_w {
            let mut least = self.released(bounds.lowest_w);
            if carried > 0.0 {
                least = min(least, decayed);
            }
            let side = sign(self.current_a);
            x = side * max(side * x, least);
        }
        (x, if x == free { held } else { Held::Charge })
    }

    /// The largest braking current, in that direction, up to which holding takes no less than
    /// `lowest_w`; infinity where any does.
    fn edge(&self, lowest_w: Real) -> Real {
        let e = self.back_emf_v;
        let discriminant = e * e + 4.0 * self.resistance_ohm * lowest_w;
        if discriminant > 0.0 {
            -2.0 * lowest_w / (e.abs() + sqrt(discriminant))
        } else {
            Real::INFINITY
        }
    }

    /// The least magnitude to which a current may fall in one step for what its field gives up.
    fn released(&self, lowest_w: Real) -> Real {
        let a = self.inductance_ohm + self.resistance_ohm;
        let b = self.inductance_ohm * self.current_a.abs() - sign(self.current_a) * self.back_emf_v;
        let discriminant = b * b + 4.0 * a * (RELEASE * lowest_w);
        if discriminant > 0.0 { 0.5 * max(b + sqrt(discriminant), 0.0) / a } else { 0.0 }
    }

    /// The root of `(l + r)·x² + (e − l·i)·x = p` on the side of `near`, p ≥ 0.
    fn at_power(&self, p: Real, near: Real) -> Real {
        let a = self.inductance_ohm + self.resistance_ohm;
        let b = self.back_emf_v - self.inductance_ohm * self.current_a;
        // Without cancellation.
        let root = sqrt(b * b + 4.0 * a * p);
        let q = -0.5 * (b + if b < 0.0 { -root } else { root });
        if q == 0.0 {
            return 0.0;
        }
        let (one, two) = (q / a, -p / q);
        if (one > 0.0) == (near > 0.0) { one } else { two }
    }
}

#[cfg(test)]
mod tests;
