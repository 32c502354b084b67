//! A permanent-magnet synchronous machine behind an averaged three-phase inverter, seen from the
//! road.
//!
//! With m the voltage of both axes per bus voltage V, `Z·Δi = m·V − v_held − γ·Δv`
//! ([`DqLaw`]), `I = 3/2·m·i'`, `F = 3/2·γ·i' − F_fe`: lines in V and Δv. The inverter passes power
//! on, whatever the angle; its largest voltage is V/√3, that of space vector modulation.
//!
//! An ideal inner torque loop ([`Gates::Torque`]) moves the currents a share of the distance to those
//! of least current for the torque, with the field weakened where the bus asks for it, and makes the
//! voltage that leads there in this step: it is stable however far the rotor turns.
//!
//! Tests: `drive/tests.rs`; property `drives`; cases "PMSM vehicle".

mod joined;

use super::{DqLaw, DqWinding, PmsmParams, REFERENCE_C};
use crate::converter::{Converter, ConverterParams};
use crate::error::{ParamError, check};
use crate::machine::Seen;
use crate::machine::transform::{Dq, LARGEST_PER_BUS};
use crate::model::Dt;
use crate::num::{Accum, Real, clamp, lag_gain, max, min, sqrt};
use crate::port::{BusLaw, DriveLaw};

/// Share of the largest voltage that the torque loop plans with; the rest is for the resistance and
/// for changes of the current.
const PLANNED: Real = 0.92;
/// Share of the planned flux that the q axis may take.
const Q_SHARE: Real = 0.95;
/// Slower, the induced voltage does not matter \[rad/s\].
const SLOWEST_RAD_S: Real = 1.0;
/// Below this current of the q axis its chord inductance is taken as the incremental one \[A\].
const CHORD_A: Real = 1.0;
/// No divisor is smaller.
const TINY: Real = 1e-12;

/// A synchronous machine with its inverter, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PmsmDrive {
    /// Seen from the road.
    winding: DqWinding,
    /// The inverter's part of its resistance \[Ω\].
    inverter_ohm: Real,
    current_limit_a: Real,
    /// Largest modulation; 1 is V/√3.
    modulation_limit: Real,
    motor_rad_per_m: Real,
    torque_gain: Real,
}

/// The currents of both axes; none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DqCurrents {
    /// Of the d axis \[A\].
    pub d_a: Accum,
    /// Of the q axis \[A\].
    pub q_a: Accum,
}

impl DqCurrents {
    /// As a vector \[A\].
    #[inline]
    #[must_use]
    pub const fn get(&self) -> Dq {
        Dq { d: self.d_a.get(), q: self.q_a.get() }
    }
}

/// What a step with a [`PmsmDrive`] leaves for the walk back. Until it is closed, `rise_a` is the rise
/// of the currents if bus voltage and speed stayed as they are.
#[derive(Clone, Copy, Debug)]
pub struct PmsmLink {
    law: DqLaw,
    speed_m_s: Real,
    /// Voltage per bus voltage.
    per_bus: Dq,
    rise_a: Dq,
    per_v: Dq,
    per_speed: Dq,
    /// The currents at which the command settles, as far as that is known \[A\].
    ends_a: Dq,
    on: bool,
    blocked: bool,
    clipped: bool,
}

/// What a step says of a [`PmsmDrive`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PmsmDriveOutput {
    /// Voltage of both axes over the largest; 1 is V/√3. With gates off the diodes', or 0.
    pub modulation: Dq,
    /// Winding current, peak of a phase \[A\].
    pub current_a: Dq,
    /// Air-gap torque \[N·m\], before the iron's loss.
    pub motor_nm: Real,
    /// Motor speed \[rad/s\].
    pub motor_rad_s: Real,
    /// The rotor turned by more than [`FINE_STEP_RAD`](super::FINE_STEP_RAD): what rings at the
    /// electrical frequency is damped, not followed.
    pub coarse_step: bool,
    /// The currents lie beyond the flux map, which goes on straight there.
    pub beyond_map: bool,
}

impl PmsmDrive {
    /// Checks the parameters; the shaft turns by `motor_rad_per_m` per metre of road.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range; an inverter's drop is none of the
    /// model's, it must be 0.
    pub(crate) const fn new(
        params: &PmsmParams,
        inverter: ConverterParams,
        torque_rate_per_s: Real,
        motor_rad_per_m: Real,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let inverter = check!(Converter::new(inverter)).params;
        if inverter.voltage_drop_v != 0.0 {
            return Err(ParamError::OutOfRange("converter.voltage_drop_v"));
        }
        let inverter_ohm = inverter.resistance_ohm;
        let mut whole = *params;
        whole.resistance_ohm += inverter_ohm;
        Ok(Self {
            winding: check!(DqWinding::new(&whole, dt)).reflected(motor_rad_per_m),
            inverter_ohm,
            current_limit_a: inverter.current_limit_a,
            modulation_limit: min(inverter.duty_limit, 1.0),
            motor_rad_per_m,
            torque_gain: lag_gain(dt.s() * torque_rate_per_s),
        })
    }

    /// The machine over one step, no current after it.
    #[inline(always)]
    fn blocked(&self, i: Dq, seen: Seen) -> PmsmLink {
        PmsmLink {
            law: self.winding.law(i, seen.speed_m_s, REFERENCE_C),
            speed_m_s: seen.speed_m_s,
            per_bus: Dq::ZERO,
            rise_a: Dq::ZERO - i,
            per_v: Dq::ZERO,
            per_speed: Dq::ZERO,
            ends_a: Dq::ZERO,
            on: false,
            blocked: true,
            clipped: false,
        }
    }

    /// The step under a voltage per bus voltage.
    #[inline(always)]
    fn conducting(link: PmsmLink, i: Dq, from_v: Real) -> (BusLaw, PmsmLink) {
        let PmsmLink { law, per_bus, speed_m_s, .. } = link;
        let rise_a = law.admit(per_bus * from_v - law.held_v);
        let per_v = law.admit(per_bus);
        let per_speed = law.admit(law.back_emf_v_s_per_rad);
        let (bus, road) = (per_bus * 1.5, law.back_emf_v_s_per_rad * 1.5);
        let reached_a = i + rise_a;
        let iron = law.iron_nm_s_per_rad;
        (
            BusLaw {
                current_a: bus.dot(reached_a),
                conductance_s: bus.dot(per_v),
                a_per_speed: bus.dot(per_speed),
                effort: road.dot(reached_a) - iron * speed_m_s,
                effort_per_v: road.dot(per_v),
                slope: road.dot(per_speed) + iron,
            },
            PmsmLink { rise_a, per_v, per_speed, blocked: false, ..link },
        )
    }

    /// A modulation within the limit, as voltage per bus voltage, and whether it was changed.
    #[inline(always)]
    fn allowed(&self, per_bus: Dq) -> (Dq, bool) {
        let most = self.modulation_limit * LARGEST_PER_BUS;
        let square = per_bus.dot(per_bus);
        // A number that is none stays so, for the caller to see.
        if square > most * most {
            (per_bus * (most / sqrt(square)), true)
        } else {
            (per_bus, false)
        }
    }

    /// Least current for a torque, then the field weakened to the bus, then the limit: one pass with
    /// the inductances and the current of now, so that a torque is exact once it stands
    /// \[Morimoto1990\].
    fn wanted_a(&self, link: &PmsmLink, i: Dq, torque_nm: Real, bus_v: Real) -> Dq {
        let law = &link.law;
        let per_h = self.winding.per_h();
        let Dq { d: d_ohm, q: q_ohm } = law.inductance_ohm();
        let d_h = d_ohm / per_h;
        let q_h = if i.q.abs() > CHORD_A { law.flux_wb.q / i.q } else { q_ohm / per_h };
        let magnet_wb = law.flux_wb.d - d_h * i.d;
        let saliency_h = q_h - d_h;
        // Torque over 3/2·p.
        let per_unit = torque_nm * self.motor_rad_per_m / (1.5 * self.winding.pole_pairs());
        let mut q = per_unit / max(magnet_wb - saliency_h * i.d, TINY);
        let half = 0.5 * magnet_wb;
        let mut d = -saliency_h * q * q
            / max(half + sqrt(half * half + saliency_h * saliency_h * q * q), TINY);
        let turning = max((self.winding.pole_pairs() * link.speed_m_s).abs(), SLOWEST_RAD_S);
        let most_wb = PLANNED * LARGEST_PER_BUS * bus_v / turning;
        q = clamp(q, -Q_SHARE * most_wb / q_h, Q_SHARE * most_wb / q_h);
        let room_wb = sqrt(max(most_wb * most_wb - q_h * q_h * q * q, 0.0));
        let most_a = self.current_limit_a;
        d = max(min(d, (room_wb - magnet_wb) / d_h), -most_a);
        let q_most = sqrt(max(most_a * most_a - d * d, 0.0));
        Dq { d, q: clamp(q, -q_most, q_most) }
    }

    /// The rise of the currents toward a torque \[A\], and the currents where it ends.
    fn toward(&self, link: &PmsmLink, i: Dq, torque_nm: Real, bus_v: Real) -> (Dq, Dq) {
        let wanted_a = self.wanted_a(link, i, torque_nm, bus_v);
        ((wanted_a - i) * self.torque_gain, wanted_a)
    }

    /// What a current does at the road.
    #[inline(always)]
    fn force_of(link: &PmsmLink, current_a: Dq) -> DriveLaw {
        let iron = link.law.iron_nm_s_per_rad;
        DriveLaw { effort: link.law.torque_nm(current_a) - iron * link.speed_m_s, slope: iron }
    }
}

#[cfg(test)]
mod tests;
