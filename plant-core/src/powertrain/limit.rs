//! Battery limits: they act on the duty, so both sides of the converter agree.
//!
//! Within a friction mode the battery current `D·i = I` is a quadratic in the duty,
//! `(E − R·I)·D² + β·D − ρ·I = 0`; its root in the mode that it leads to is the duty. It is ours.
//!
//! Tests: below; property `limits`.

use super::solve::{Solution, Start};
use super::{Limited, Powertrain, PowertrainState};
use crate::battery::Pack;
use crate::mechanics::body::Resistance;
use crate::num::{Real, max, sqrt};
use crate::port::Slip;
use crate::powertrain::ledger::Book;

/// How often the friction mode may change while the duty is sought; there are three modes.
const TRIES: u32 = 3;

/// A step that keeps the battery's limits.
pub(super) struct Held {
    pub solution: Solution,
    pub limited: Limited,
    pub starved: bool,
}

impl<L: Book, B: Pack> Powertrain<L, B> {
    /// The step again, so that the limits are kept: the auxiliary loads are cut off if the battery
    /// cannot feed even them, then the duty is held back.
    ///
    /// It works out for itself where the step starts from, and takes numbers one by one: to be
    /// handed more would have every step keep it in memory, for the sake of the few that come here.
    ///
    /// Within a friction mode (forward, backward, stuck) the current is
    /// `i = (β + D·E)/(ρ + D²·R)`, so `D·i = I` is a quadratic in D. Its root can change the mode,
    /// so it is solved again in the mode found.
    #[cold]
    #[inline(never)]
    pub(super) fn hold_limits(
        &self,
        state: &PowertrainState<L, B::State>,
        commanded: Real,
        auxiliary_w: Real,
        force_n: Real,
        slope_n_s_per_m: Real,
        friction_n: Real,
    ) -> Held {
        let limits = self.battery.limits(&state.battery);
        let resistance = Resistance { force_n, slope_n_s_per_m, friction_n, drag_n_s_per_m: 0.0 };
        let (mut start, source, _) = self.start(state, auxiliary_w, resistance);
        let starved = limits.discharge_a < start.loads.current_a(start.bus.emf_v);
        if starved {
            start.starve(source);
        }
        let (mut duty, mut limited, mut tries) = (commanded, Limited::No, 0);
        let (mut sought, mut allowed_a) = (Slip::Stuck, 0.0);
        loop {
            let solution = self.solve(&start, duty);
            let slip = solution.motion.slip;
            if limited == Limited::No {
                // What is left for the drive when the battery is at its limit.
                let left_a =
                    |battery_a| battery_a - start.loads.current_a(source.voltage_v(battery_a));
                (limited, allowed_a) = if solution.battery_a < -limits.charge_a {
                    (Limited::Charge, left_a(-limits.charge_a))
                } else if solution.battery_a > limits.discharge_a {
                    (Limited::Discharge, max(left_a(limits.discharge_a), 0.0))
                } else {
                    return Held { solution, limited, starved };
                };
            } else if slip == sought || tries == TRIES {
                return Held { solution, limited, starved };
            }
            (sought, tries) = (slip, tries + 1);
            let root = self.drive(&start, slip).drawing(allowed_a, commanded);
            duty = self.converter.allowed_duty(root);
        }
    }

    /// The drive in one friction mode.
    #[inline(always)]
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
    /// The root of `(E − R·I)·D² + β·D − ρ·I = 0` that lies between `commanded` and no
    /// battery current: towards 0 when discharging, towards back-EMF when charging (lowering the
    /// duty there would raise the current).
    #[inline(always)]
    fn drawing(self, allowed_a: Real, commanded: Real) -> Real {
        let Self { emf_v, source_ohm, beta_v, rho_ohm } = self;
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

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: DutyLaw = DutyLaw { emf_v: 350.0, source_ohm: 0.1, beta_v: 0.0, rho_ohm: 0.2 };

    #[test]
    fn the_duty_draws_what_is_allowed_between_the_command_and_none() {
        for beta_v in [-120.0, -40.0, 40.0, 120.0] {
            for allowed_a in [-80.0, -10.0, 10.0, 300.0] {
                for commanded in [-0.9, 0.9] {
                    let duty = DutyLaw { beta_v, ..LAW }.drawing(allowed_a, commanded);
                    let a = 350.0 - 0.1 * allowed_a;
                    let discriminant = beta_v * beta_v + 4.0 * a * 0.2 * allowed_a;
                    if discriminant < 0.0 {
                        assert_eq!(duty, -beta_v / 350.0, "as little as can be");
                        continue;
                    }
                    let rest_v = a * duty * duty + beta_v * duty - 0.2 * allowed_a;
                    assert!(rest_v.abs() < 1e-2, "{beta_v} {allowed_a}: {duty} leaves {rest_v}");
                    // The other root: the product of both is −ρ·I/a.
                    let other = -0.2 * allowed_a / a / duty;
                    if allowed_a < 0.0 {
                        assert!(duty.abs() >= other.abs(), "towards back-EMF: {duty}, not {other}");
                    } else {
                        assert!(duty * commanded > 0.0, "{duty} for {commanded}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_left_as_it_is() {
        // Beyond the short-circuit current.
        let law = DutyLaw { beta_v: -1.0, ..LAW };
        assert_eq!(law.drawing(4000.0, 0.7), 0.7);
        assert_eq!(DutyLaw { beta_v: -20.0, ..LAW }.drawing(4000.0, 0.7), 0.7);
    }
}
