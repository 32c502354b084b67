//! Battery limits: they act on the duty, so both sides of the converter agree.

use super::{Powertrain, Solution, Start};
use crate::energy::Book;
use crate::num::{Real, sqrt};
use crate::port::Slip;

/// How often the friction mode may change while the duty is sought; there are three modes.
const TRIES: u32 = 3;

impl<L: Book> Powertrain<L> {
    /// The duty at which the drive draws `allowed_a`, and what it leads to.
    ///
    /// Within a friction mode (forward, backward, stuck) the current is
    /// `i = (β + D·E)/(ρ + D²·R)`, so `D·i = I` is a quadratic in D. Its root can change the mode,
    /// so it is solved again in the mode found.
    #[cold]
    #[inline(never)]
    pub(super) fn hold_limit(
        &self,
        start: &Start,
        commanded: Real,
        first: Solution,
        allowed_a: Real,
    ) -> (Real, Solution) {
        let (mut duty, mut solution) = (commanded, first);
        let mut tries = 0;
        while tries < TRIES {
            let slip = solution.motion.slip;
            let (beta_v, rho_ohm) = self.drive(start, slip);
            let root = duty_at(start.bus.emf_v, start.bus.resistance_ohm, beta_v, rho_ohm)
                .drawing(allowed_a, commanded);
            duty = self.converter.allowed_duty(root);
            solution = self.solve(start, duty);
            if solution.motion.slip == slip {
                break;
            }
            tries += 1;
        }
        (duty, solution)
    }

    /// β and ρ of the drive in one friction mode.
    fn drive(&self, start: &Start, slip: Slip) -> (Real, Real) {
        let motor = &self.motor;
        let ohm = motor.inductance_per_h_ohm + motor.resistance_ohm + start.converter_ohm;
        let beta_v = motor.inductance_per_h_ohm * start.current_a;
        if slip == Slip::Stuck {
            return (beta_v, ohm);
        }
        let axle = self.coasting_axle(start);
        let mobility = 1.0 / (start.resistance.slope_n_s_per_m + axle.slope_n_s_per_m);
        let force_n = start.resistance.force_n + axle.force_n
            - slip.sign() * (start.resistance.friction_n + axle.friction_n);
        let emf_v_s_per_m = motor.back_emf_v_s_per_rad * self.motor_rad_per_m;
        let force_n_per_a = motor.torque_nm_per_a * self.motor_rad_per_m;
        (
            beta_v - emf_v_s_per_m * (start.speed_m_s + force_n * mobility),
            ohm + emf_v_s_per_m * force_n_per_a * mobility,
        )
    }
}

/// A drive in one friction mode on a source.
struct DutyLaw {
    emf_v: Real,
    source_ohm: Real,
    beta_v: Real,
    rho_ohm: Real,
}

const fn duty_at(emf_v: Real, source_ohm: Real, beta_v: Real, rho_ohm: Real) -> DutyLaw {
    DutyLaw { emf_v, source_ohm, beta_v, rho_ohm }
}

impl DutyLaw {
    /// The root of `(E − R·I)·D² + β·D − ρ·I = 0` that lies on the way from `commanded` to no
    /// battery current: towards 0 when discharging, towards back-EMF when charging (lowering the
    /// duty there would raise the current).
    fn drawing(&self, allowed_a: Real, commanded: Real) -> Real {
        let Self { emf_v, source_ohm, beta_v, rho_ohm } = *self;
        let a = emf_v - source_ohm * allowed_a;
        if a <= 0.0 {
            return commanded; // beyond the short-circuit current: nothing to hold back
        }
        let discriminant = beta_v * beta_v + 4.0 * a * rho_ohm * allowed_a;
        if discriminant < 0.0 {
            return -beta_v / emf_v; // no duty charges that much
        }
        let root = sqrt(discriminant);
        if allowed_a < 0.0 {
            return if beta_v > 0.0 { -beta_v - root } else { -beta_v + root } / (2.0 * a);
        }
        let signed = if commanded < 0.0 { -root } else { root };
        if beta_v * signed <= 0.0 {
            (signed - beta_v) / (2.0 * a)
        } else {
            // The same root without cancellation.
            2.0 * rho_ohm * allowed_a / (beta_v + signed)
        }
    }
}
