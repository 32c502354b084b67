//! Limits on the axis of a winding that makes the torque: which current keeps them.
//!
//! Within one step a winding takes the power `x·(e + r·x + l·(x − i))` from the bus to end at the
//! current x, and `x·(e + r·x)` to hold it. Everything is counted as an increment x − i, so that the
//! voltage of a large inductance over a short step keeps its digits. It is ours.
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

/// A power is known to this share of the back-EMF's, or of the field's: a shorted winding, whose power
/// is rounding, does not charge.
pub(super) const ROUNDING: Real = 1e-6;

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
    /// The power of a step by this increment.
    pub(super) const fn power_w(&self, rise_a: Real) -> Real {
        (self.current_a + rise_a) * (self.held_v() + self.step_ohm() * rise_a)
    }

    /// The power of holding a current.
    const fn held_w(&self, x: Real) -> Real {
        x * (self.back_emf_v + self.resistance_ohm * x)
    }

    /// The voltage that holds the current of the start.
    const fn held_v(&self) -> Real {
        self.back_emf_v + self.resistance_ohm * self.current_a
    }

    const fn step_ohm(&self) -> Real {
        self.inductance_ohm + self.resistance_ohm
    }

    /// The increment nearest to `want` that keeps the bounds, `ends_at` being the current at which
    /// the command would settle.
    ///
    /// From within the edge the step lands on it. A current beyond decays with L/r, under the voltage
    /// that belongs to the edge, so that the battery's current exceeds its limit by the factor
    /// |i|/|edge| at most.
    #[inline(always)]
    pub(super) fn held(&self, want: Real, ends_at: Real, bounds: &AxisBounds) -> (Real, Held) {
        let (i, most_a) = (self.current_a, bounds.current_a);
        let (mut rise_a, mut held) = (clamp(want, -most_a - i, most_a - i), Held::No);
        if rise_a != want {
            held = Held::Current;
        }
        let mut power_w = self.power_w(rise_a);
        if power_w > bounds.highest_w {
            // Braking by drawing may end as braking that charges.
            (rise_a, held) = (self.at_power(bounds.highest_w, i + rise_a), Held::Discharge);
            power_w = bounds.highest_w;
        }
        let ends_at = clamp(ends_at, -most_a, most_a);
        if power_w >= 0.0 && ends_at * self.back_emf_v >= 0.0 {
            // It drives, and goes on to: nothing is charged.
            return (rise_a, held);
        }
        let rounding_v = ROUNDING * (self.back_emf_v.abs() + self.step_ohm() * rise_a.abs());
        let charges = self.held_w(ends_at) < bounds.lowest_held_w - rounding_v * ends_at.abs();
        let lowest_w = bounds.lowest_w - rounding_v * (i + rise_a).abs();
        if !charges && self.power_w(rise_a) >= lowest_w {
            return (rise_a, held);
        }
        let free = rise_a;
        // Counted in the direction in which the machine brakes.
        let direction = if self.back_emf_v > 0.0 { -1.0 } else { 1.0 };
        let (carried, braking) = (direction * i, direction * (i + rise_a));
        let to_edge = self.edge(bounds.lowest_held_w) - carried;
        let decayed = direction * to_edge * (self.resistance_ohm / self.step_ohm());
        if charges || direction * rise_a > 0.0 {
            if to_edge >= 0.0 {
                rise_a = direction * min(direction * rise_a, to_edge);
            } else if braking > 0.0 {
                rise_a = decayed;
            }
        }
        if self.power_w(rise_a) < lowest_w {
            let side = sign(i);
            let mut least = side * self.released(bounds.lowest_w);
            if carried > 0.0 {
                least = min(least, side * decayed);
            }
            rise_a = side * max(side * rise_a, least);
        }
        (rise_a, if rise_a == free { held } else { Held::Charge })
    }

    /// The largest braking current, in that direction, up to which holding takes no less than
    /// `lowest_w`; infinity where any does.
    #[inline(always)]
    fn edge(&self, lowest_w: Real) -> Real {
        let e = self.back_emf_v;
        let discriminant = e * e + 4.0 * self.resistance_ohm * lowest_w;
        if discriminant > 0.0 {
            -2.0 * lowest_w / (e.abs() + sqrt(discriminant))
        } else {
            Real::INFINITY
        }
    }

    /// The increment down to the least current for which its field does not give up too much.
    #[inline(always)]
    fn released(&self, lowest_w: Real) -> Real {
        match self.roots(RELEASE * lowest_w) {
            Some((one, two)) => {
                let side = sign(self.current_a);
                side * max(max(side * one, side * two), -self.current_a.abs())
            }
            None => -self.current_a,
        }
    }

    /// The increment to a power ≥ 0, the current on the side of `near`. One root lies on either side,
    /// or at no current.
    #[inline(always)]
    fn at_power(&self, power_w: Real, near: Real) -> Real {
        match self.roots(power_w) {
            Some((one, two)) if near > 0.0 => max(one, two),
            Some((one, two)) => min(one, two),
            None => -self.current_a,
        }
    }

    /// The increments that lead to a power: the roots of
    /// `(l + r)·Δ² + (e + r·i + (l + r)·i)·Δ + i·(e + r·i) − p`.
    #[inline(always)]
    fn roots(&self, power_w: Real) -> Option<(Real, Real)> {
        let (a, held_v) = (self.step_ohm(), self.held_v());
        let b = held_v + a * self.current_a;
        let c = self.current_a * held_v - power_w;
        let discriminant = b * b - 4.0 * a * c;
        if discriminant < 0.0 {
            return None;
        }
        // Without cancellation.
        let q = -0.5 * (b + if b < 0.0 { -sqrt(discriminant) } else { sqrt(discriminant) });
        if q == 0.0 { Some((0.0, 0.0)) } else { Some((q / a, c / q)) }
    }
}

#[cfg(test)]
mod tests;
