//! Battery limits: they act on the duty, so both sides of the converter agree.

use super::{Limited, Loads, Powertrain, Solution, Start};
use crate::battery::{CurrentLimits, Pack};
use crate::energy::Book;
use crate::num::{Real, max, sqrt};
use crate::port::{Slip, Source};

/// How often the friction mode may change while the duty is sought; there are three modes.
const TRIES: u32 = 3;

/// A step that keeps the battery's limits.
pub(super) struct Held {
    pub start: Start,
    pub solution: Solution,
    pub limited: Limited,
    pub starved: bool,
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    /// A step that keeps the battery's limits: the auxiliary loads are cut off if it cannot feed
    /// even them, then the duty is held back.
    #[cold]
    #[inline(never)]
    pub(super) fn hold_limits(
        &self,
        mut start: Start,
        source: Source,
        limits: CurrentLimits,
        commanded: Solution,
    ) -> Held {
        let mut solution = commanded;
        let starved = limits.discharge_a < start.loads.current_a(start.bus.emf_v);
        if starved {
            start.loads = Loads { any: true, ..Loads::default() };
            start.bus = source;
            solution = self.solve_again(&start, commanded.duty);
        }
        let charging = solution.battery_a < -limits.charge_a;
        let limited = if charging {
            Limited::Charge
        } else if solution.battery_a > limits.discharge_a {
            Limited::Discharge
        } else {
            return Held { start, solution, limited: Limited::No, starved };
        };
        // What is left for the drive when the battery is at its limit.
        let battery_a = if charging { -limits.charge_a } else { limits.discharge_a };
        let left_a = battery_a - start.loads.current_a(source.voltage_v(battery_a));
        let allowed_a = if charging { left_a } else { max(left_a, 0.0) };
        let solution = self.hold_drive(&start, solution, allowed_a);
        Held { start, solution, limited, starved }
    }

    /// The hot path's solution once more; not inlined, to save flash.
    #[inline(never)]
    fn solve_again(&self, start: &Start, duty: Real) -> Solution {
        self.solve(start, duty)
    }

    /// The step at whose duty the drive draws `allowed_a`.
    ///
    /// Within a friction mode (forward, backward, stuck) the current is
    /// `i = (β + D·E)/(ρ + D²·R)`, so `D·i = I` is a quadratic in D. Its root can change the mode,
    /// so it is solved again in the mode found.
    fn hold_drive(&self, start: &Start, commanded: Solution, allowed_a: Real) -> Solution {
        let mut solution = commanded;
        let mut tries = 0;
        while tries < TRIES {
            let slip = solution.motion.slip;
            let root = self.drive(start, slip).drawing(allowed_a, commanded.duty);
            solution = self.solve_again(start, self.converter.allowed_duty(root));
            if solution.motion.slip == slip {
                break;
            }
            tries += 1;
        }
        solution
    }

    /// The drive in one friction mode.
    fn drive(&self, start: &Start, slip: Slip) -> DutyLaw {
        let winding = &self.winding;
        let mut law = DutyLaw {
            emf_v: start.bus.emf_v,
            source_ohm: start.bus.resistance_ohm,
            beta_v: winding.inductance_per_h_ohm * start.current_a,
            rho_ohm: winding.inductance_per_h_ohm + winding.resistance_ohm + start.converter_ohm,
        };
        if slip != Slip::Stuck {
            let mobility = 1.0 / start.resistance.slope_n_s_per_m;
            let coasting_n = start.resistance.force_n - slip.sign() * start.resistance.friction_n;
            law.beta_v -= winding.back_emf * (start.speed_m_s + coasting_n * mobility);
            law.rho_ohm += winding.back_emf * winding.effort_per_a * mobility;
        }
        law
    }
}

/// A drive in one friction mode on a source.
struct DutyLaw {
    emf_v: Real,
    source_ohm: Real,
    beta_v: Real,
    rho_ohm: Real,
}

impl DutyLaw {
    /// The root of `(E − R·I)·D² + β·D − ρ·I = 0` that lies on the way from `commanded` to no
    /// battery current: towards 0 when discharging, towards back-EMF when charging (lowering the
    /// duty there would raise the current).
    fn drawing(&self, allowed_a: Real, commanded: Real) -> Real {
        let Self { emf_v, source_ohm, beta_v, rho_ohm } = *self;
        let a = emf_v - source_ohm * allowed_a;
        let discriminant = beta_v * beta_v + 4.0 * a * rho_ohm * allowed_a;
        if discriminant < 0.0 {
            // No duty charges that much; or discharges that much, but for rounding.
            return if allowed_a < 0.0 { -beta_v / emf_v } else { commanded };
        }
        let root = sqrt(discriminant);
        if allowed_a < 0.0 {
            return if beta_v > 0.0 { -beta_v - root } else { -beta_v + root } / (2.0 * a);
        }
        let signed = if commanded < 0.0 { -root } else { root };
        if beta_v * signed > 0.0 {
            // Without cancellation; also for a ≤ 0, as plug braking can draw more than the
            // short-circuit current.
            2.0 * rho_ohm * allowed_a / (beta_v + signed)
        } else if a > 0.0 {
            (signed - beta_v) / (2.0 * a)
        } else {
            commanded // beyond the short-circuit current: nothing to hold back
        }
    }
}
