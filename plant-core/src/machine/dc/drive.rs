//! A DC machine behind a four-quadrant converter, seen from the road.
//!
//! `i' = g·(L/h·i − Ke·v − V_d) + g·D·V − g·Ke·Δv`, `g = 1/(L/h + R + R_c)`: a line in the voltage V
//! of the bus and the speed increment Δv. The converter's drop is set-valued: it takes its voltage
//! from what drives the current, and where that is less, nothing flows. With gates off the bus
//! itself is such a drop.
//!
//! Tests: those of the powertrain.

mod joined;

use super::DcMotorParams;
use crate::converter::{Converter, ConverterParams, Gates};
use crate::error::{ParamError, check, positive};
use crate::machine::Seen;
use crate::model::Dt;
use crate::num::{Real, clamp, lag_gain, max, sign};
use crate::port::BusLaw;

/// A DC machine with its converter, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcDrive {
    converter: Converter,
    /// Ke and Kt, seen from the road.
    back_emf: Real,
    effort_per_a: Real,
    inductance_ohm: Real,
    /// Winding and converter.
    resistance_ohm: Real,
    /// L/h and resistance, and one over both.
    step_ohm: Real,
    admittance_s: Real,
    /// Ke·Kt
    effort_emf: Real,
    inductance_h: Real,
    motor_rad_per_m: Real,
    torque_nm_per_a: Real,
    /// Share of the distance to a commanded torque that one step goes.
    torque_gain: Real,
}

/// What a step with a [`DcDrive`] leaves for the walk back. Until it is closed, `rise_a` is the rise of
/// the current if bus voltage and speed stayed as they are, `admittance_s` what they add to it.
#[derive(Clone, Copy, Debug)]
pub struct DcLink {
    duty: Real,
    drop_v: Real,
    rise_a: Real,
    admittance_s: Real,
    /// Ke·v at the start \[V\].
    emf_v: Real,
    /// A duty was commanded.
    on: bool,
    clipped: bool,
}

impl DcLink {
    /// No current after this step.
    #[inline(always)]
    const fn blocked(current_a: Real, emf_v: Real, duty: Real, on: bool) -> Self {
        Self { duty, drop_v: 0.0, rise_a: -current_a, admittance_s: 0.0, emf_v, on, clipped: false }
    }
}

/// What a step says of a [`DcDrive`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DcDriveOutput {
    /// The duty applied. With gates off the diodes': ±1 while they conduct, else 0.
    pub duty: Real,
    /// Winding current \[A\].
    pub motor_a: Real,
    /// Air-gap torque \[N·m\].
    pub motor_nm: Real,
    /// Motor speed \[rad/s\].
    pub motor_rad_s: Real,
}

impl DcDrive {
    /// Checks the parameters; the shaft turns by `motor_rad_per_m` per metre of road.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub(crate) const fn new(
        params: &DcMotorParams,
        converter: ConverterParams,
        torque_rate_per_s: Real,
        motor_rad_per_m: Real,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let converter = check!(Converter::new(converter));
        let inductance_h = check!(positive("motor.inductance_h", params.inductance_h));
        let ke = check!(positive("motor.back_emf_v_s_per_rad", params.back_emf_v_s_per_rad));
        let kt = check!(positive("motor.torque_nm_per_a", params.torque_nm_per_a));
        let winding_ohm = check!(positive("motor.resistance_ohm", params.resistance_ohm));
        let resistance_ohm = winding_ohm + converter.params.resistance_ohm;
        let inductance_ohm = inductance_h / dt.s();
        Ok(Self {
            converter,
            back_emf: ke * motor_rad_per_m,
            effort_per_a: kt * motor_rad_per_m,
            inductance_ohm,
            resistance_ohm,
            step_ohm: inductance_ohm + resistance_ohm,
            admittance_s: 1.0 / (inductance_ohm + resistance_ohm),
            effort_emf: ke * kt * (motor_rad_per_m * motor_rad_per_m),
            inductance_h,
            motor_rad_per_m,
            torque_nm_per_a: kt,
            torque_gain: lag_gain(dt.s() * torque_rate_per_s),
        })
    }

    /// What a command leads to before anything is solved, and whether a current may flow.
    #[inline(always)]
    fn commanded(&self, i: Real, gates: Gates, seen: Seen) -> (DcLink, bool) {
        let emf_v = self.back_emf * seen.speed_m_s;
        let asked = match gates {
            Gates::Off => return (DcLink::blocked(i, emf_v, 0.0, false), false),
            Gates::On(duty) => duty,
            Gates::Torque(torque_nm) => self.duty_for(torque_nm, i, seen),
        };
        let clipped = asked.abs() > self.converter.params.duty_limit;
        let duty = if clipped { self.converter.allowed_duty(asked) } else { asked };
        let mut link = DcLink { clipped, ..DcLink::blocked(i, emf_v, duty, true) };
        let drop_v = self.converter.params.voltage_drop_v;
        if drop_v > 0.0 {
            let driving_v = duty * seen.bus_v + self.inductance_ohm * i - emf_v;
            if driving_v.abs() <= drop_v {
                return (link, false);
            }
            link.drop_v = if driving_v < 0.0 { -drop_v } else { drop_v };
        }
        (link, true)
    }

    /// The step that a duty leads to, `drop_v` against it.
    #[inline(always)]
    fn conducting(&self, link: DcLink, current_a: Real, from_v: Real) -> (BusLaw, DcLink) {
        let rise_a = self.admittance_s * self.driving_v(&link, current_a, from_v);
        let reached_a = current_a + rise_a;
        let per_v = self.admittance_s * link.duty;
        let per_speed = self.admittance_s * self.back_emf;
        (
            BusLaw {
                current_a: link.duty * reached_a,
                conductance_s: link.duty * per_v,
                a_per_speed: link.duty * per_speed,
                effort: self.effort_per_a * reached_a,
                effort_per_v: self.effort_per_a * per_v,
                slope: self.effort_per_a * per_speed,
            },
            DcLink { rise_a, admittance_s: self.admittance_s, ..link },
        )
    }

    /// The voltage before the converter's drop that makes a rise of the current \[V\].
    fn terminal_v(&self, current_a: Real, rise_a: Real, speed_m_s: Real) -> Real {
        let drop_v = sign(current_a + rise_a) * self.converter.params.voltage_drop_v;
        let held_v = self.back_emf * speed_m_s + self.resistance_ohm * current_a + drop_v;
        held_v + self.step_ohm * rise_a
    }

    /// What a duty drives the current with, the bus at `from_v` \[V\].
    #[inline(always)]
    fn driving_v(&self, link: &DcLink, current_a: Real, from_v: Real) -> Real {
        link.duty * from_v - (self.resistance_ohm * current_a + link.emf_v + link.drop_v)
    }

    /// The current at the end of a step under a commanded torque: the gain's share of the way there.
    fn toward_a(&self, torque_nm: Real, current_a: Real) -> Real {
        let most_a = self.converter.params.current_limit_a;
        let target_a = clamp(torque_nm / self.torque_nm_per_a, -most_a, most_a);
        current_a + self.torque_gain * (target_a - current_a)
    }

    /// The duty for a torque, the back-EMF being that of the end of the step.
    #[inline]
    fn duty_for(&self, torque_nm: Real, current_a: Real, seen: Seen) -> Real {
        let reached_a = self.toward_a(torque_nm, current_a);
        let force_n = self.effort_per_a * reached_a;
        let ended_m_s = seen.footing.speed_m_s + seen.footing.mobility * force_n;
        let voltage_v = self.terminal_v(current_a, reached_a - current_a, ended_m_s);
        voltage_v / max(seen.from_v, 1.0)
    }
}
