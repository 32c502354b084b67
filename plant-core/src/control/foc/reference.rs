//! The currents for a torque: least current, then field weakening, then limits.
//!
//! For constant inductances (for a map: those of the present currents), each point in closed form
//! but for a quartic, which a fixed number of Newton steps solves: they approach the root from one
//! side. \[Morimoto1990\] has the regions.

use crate::machine::flux::LinearFlux;
use crate::machine::transform::Dq;
use crate::num::{Real, max, min, sqrt};

/// Newton steps of [`least_current`]: its error starts below 40 %; the fourth leaves 1e-8.
const LEAST_CURRENT_STEPS: u8 = 4;
/// Newton steps of [`on_flux_circle`], at most; after one as small as this the next would be lost
/// in rounding.
const CIRCLE_STEPS: u8 = 8;
const SMALL_TURN: Real = 1e-4;
/// How often the drop at the resistance is put right.
const PASSES: u8 = 3;
/// Halvings of the torque that a limit leaves: to 1e-3 of it.
const BISECTIONS: u8 = 10;
/// Slower, the induced voltage does not matter \[rad/s\].
const SLOWEST_RAD_S: Real = 1e-3;
/// No divisor is smaller.
const TINY: Real = 1e-30;

/// What the currents for a torque depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// Inductances and magnets.
    pub flux: LinearFlux,
    /// Pole pairs.
    pub pole_pairs: Real,
    /// Resistance of one phase \[Ω\].
    pub resistance_ohm: Real,
    /// Largest winding current \[A\]; infinity for none.
    pub current_limit_a: Real,
    /// Largest torque \[N·m\]; infinity for none.
    pub torque_limit_nm: Real,
}

/// Currents, and the torque that they make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// The currents \[A\].
    pub current_a: Dq,
    /// Their torque \[N·m\].
    pub torque_nm: Real,
    /// The field is weakened.
    pub weakened: bool,
    /// Less torque than asked for.
    pub limited: bool,
}

/// Electrical speed in the direction of the torque, and the largest steady voltage.
#[derive(Clone, Copy)]
struct Operating {
    turning: Real,
    voltage_v: Real,
}

impl Torque {
    /// The currents for a torque at a speed, if the steady voltage may be `voltage_v` (≥ 0).
    #[must_use]
    pub fn currents(&self, torque_nm: Real, speed_rad_s: Real, voltage_v: Real) -> Reference {
        // Torque in units of 3/2·p, positive; both directions are alike but for the voltage.
        let per_unit = 1.5 * self.pole_pairs;
        let asked = torque_nm.abs() / per_unit;
        let turning = self.pole_pairs * if torque_nm < 0.0 { -speed_rad_s } else { speed_rad_s };
        let most = most_at_current(&self.flux, self.current_limit_a);
        let torque = min(min(asked, self.torque_limit_nm / per_unit), most);
        let operating = Operating { turning, voltage_v };
        let (mut current_a, mut weakened) = self.point(torque, operating);
        if weakened && !self.holds(current_a, torque, operating) {
            (current_a, weakened) = self.most(torque, operating);
        }
        let mut reached = torque_of(&self.flux, current_a);
        let limited = reached < asked * (1.0 - 1e-5);
        if torque_nm < 0.0 {
            current_a.q = -current_a.q;
            reached = -reached;
        }
        Reference { current_a, torque_nm: per_unit * reached, weakened, limited }
    }

    /// The least current for a torque whose voltage is allowed, whatever the other limits; and
    /// whether it weakens the field.
    fn point(&self, torque: Real, operating: Operating) -> (Dq, bool) {
        let Operating { turning, voltage_v } = operating;
        let mut current_a = least_current(&self.flux, torque);
        if self.excess_v2(current_a, torque, operating) <= 0.0 {
            return (current_a, false);
        }
        for _ in 0..PASSES {
            let room = voltage_v * voltage_v - self.ohmic_v2(current_a, torque, turning);
            let flux_wb = sqrt(max(room, 0.0)) / max(turning.abs(), SLOWEST_RAD_S);
            current_a = on_flux_circle(&self.flux, torque, flux_wb);
        }
        (current_a, true)
    }

    /// Whether currents make a torque and stay within the limits.
    fn holds(&self, current_a: Dq, torque: Real, operating: Operating) -> bool {
        let voltage_v2 = operating.voltage_v * operating.voltage_v;
        torque_of(&self.flux, current_a) >= torque * (1.0 - 1e-4)
            && current_a.dot(current_a) <= self.current_limit_a * self.current_limit_a
            && self.excess_v2(current_a, torque, operating) <= 4e-3 * voltage_v2
    }

    /// The most torque that voltage and current allow, below one that they do not, by bisection;
    /// where they allow none, the current that weakens the field as far as it may.
    #[cold]
    fn most(&self, torque: Real, operating: Operating) -> (Dq, bool) {
        let (mut found, mut weakened) = self.point(0.0, operating);
        found = found.within(self.current_limit_a);
        let (mut low, mut high) = (0.0, torque);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            let (current_a, weakens) = self.point(middle, operating);
            if self.holds(current_a, middle, operating) {
                (low, found, weakened) = (middle, current_a, weakens);
            } else {
                high = middle;
            }
        }
        (found, weakened)
    }

    /// What the resistance adds to the square of the induced voltage:
    /// `|v|² = R²·|i|² + 2·R·ω_e·(i·Jψ) + ω_e²·|ψ|²`, and `i·Jψ` is the torque.
    fn ohmic_v2(&self, current_a: Dq, torque: Real, turning: Real) -> Real {
        let ohm = self.resistance_ohm;
        ohm * (ohm * current_a.dot(current_a) + 2.0 * turning * torque)
    }

    /// The steady voltage's square above what it may be.
    fn excess_v2(&self, current_a: Dq, torque: Real, operating: Operating) -> Real {
        let Operating { turning, voltage_v } = operating;
        let LinearFlux { magnet_wb, d_h, q_h } = self.flux;
        let psi = Dq { d: magnet_wb + d_h * current_a.d, q: q_h * current_a.q };
        turning * turning * psi.dot(psi) + self.ohmic_v2(current_a, torque, turning)
            - voltage_v * voltage_v
    }
}

/// Torque over 3/2·p: `(ψ_m − (L_q − L_d)·i_d)·i_q`.
fn torque_of(flux: &LinearFlux, current_a: Dq) -> Real {
    (flux.magnet_wb - (flux.q_h - flux.d_h) * current_a.d) * current_a.q
}

/// The least current for a torque (≥ 0, over 3/2·p), MTPA.
///
/// There `i_d = (a − √(a² + b²·i_q²))/b` with `a = ψ_m/2`, `b = L_q − L_d`; put into the torque,
/// `b²·i_q⁴ + 2a·τ·i_q = τ²`, convex: Newton from above.
fn least_current(flux: &LinearFlux, torque: Real) -> Dq {
    if torque <= 0.0 {
        return Dq::ZERO;
    }
    let (a, b) = (0.5 * flux.magnet_wb, flux.q_h - flux.d_h);
    let mut q = min(torque / (2.0 * a), sqrt(torque / b.abs()));
    for _ in 0..LEAST_CURRENT_STEPS {
        let (saliency, magnet) = (b * b * q * q * q, 2.0 * a * torque);
        let excess = saliency * q + magnet * q - torque * torque;
        q -= excess / max(4.0 * saliency + magnet, TINY);
    }
    Dq { d: -b * q * q / max(a + sqrt(a * a + b * b * q * q), TINY), q }
}

/// The most torque (over 3/2·p) that a current can make.
fn most_at_current(flux: &LinearFlux, current_a: Real) -> Real {
    if current_a == Real::INFINITY {
        return current_a;
    }
    let (m, b) = (flux.magnet_wb, flux.q_h - flux.d_h);
    let square = current_a * current_a;
    let d = -2.0 * b * square / max(m + sqrt(m * m + 8.0 * b * b * square), TINY);
    torque_of(flux, Dq { d, q: sqrt(max(square - d * d, 0.0)) })
}

/// The currents for a torque (≥ 0, over 3/2·p) whose flux linkage has a given length; where it is
/// more than that flux can make, those of the most (MTPV).
///
/// With the flux at an angle δ from d, `τ = ψ·sin δ·(A − E·cos δ)`, `A = ψ_m/L_d`,
/// `E = ψ·(L_q − L_d)/(L_d·L_q)`. It grows up to the angle of the most torque, convex up to its
/// turning point `cos δ = A/4E` and concave beyond: Newton from there. The angle is carried as
/// sine and cosine.
fn on_flux_circle(flux: &LinearFlux, torque: Real, flux_wb: Real) -> Dq {
    let LinearFlux { magnet_wb, d_h, q_h } = *flux;
    if torque <= 0.0 {
        return Dq { d: (flux_wb - magnet_wb) / d_h, q: 0.0 };
    }
    let (a, e) = (magnet_wb / d_h, flux_wb * (q_h - d_h) / (d_h * q_h));
    let made = |cos: Real, sin: Real| flux_wb * sin * (a - e * cos);
    let cos_most = -2.0 * e / max(a + sqrt(a * a + 8.0 * e * e), TINY);
    let sin_most = sqrt(max(1.0 - cos_most * cos_most, 0.0));
    let (mut cos, mut sin) = (cos_most, sin_most);
    if torque < made(cos, sin) {
        cos = if 4.0 * e > a { a / (4.0 * e) } else { 1.0 };
        sin = sqrt(max(1.0 - cos * cos, 0.0));
        for _ in 0..CIRCLE_STEPS {
            let slope = flux_wb * (a * cos - e * (cos * cos - sin * sin));
            let half = 0.5 * (torque - made(cos, sin)) / max(slope, TINY);
            // Turns by 2·atan(half), a little less than Newton would.
            let (turn, per) = (1.0 - half * half, 1.0 / (1.0 + half * half));
            (cos, sin) =
                (per * (turn * cos - 2.0 * half * sin), per * (turn * sin + 2.0 * half * cos));
            if half.abs() < SMALL_TURN {
                break;
            }
        }
    }
    Dq { d: (flux_wb * cos - magnet_wb) / d_h, q: flux_wb * sin / q_h }
}

#[cfg(test)]
mod tests;
