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

use super::{DqLaw, DqWinding, PmsmParams, REFERENCE_C};
use crate::converter::{Converter, ConverterParams, Gates};
use crate::error::{ParamError, check};
use crate::machine::axis::{Axis, AxisBounds};
use crate::machine::transform::{Dq, LARGEST_PER_BUS};
use crate::machine::{Bounds, Footing, Held, Machine, MachineFlows, Review, Seen, Wish};
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

impl Machine for PmsmDrive {
    type State = DqCurrents;
    type Modulation = Dq;
    type Rise = Dq;
    type Link = PmsmLink;
    type Output = PmsmDriveOutput;
    const THREE_PHASE: bool = true;

    #[inline(always)]
    fn law(&self, state: &DqCurrents, gates: Gates<Dq>, seen: Seen) -> (BusLaw, PmsmLink) {
        let i = state.get();
        let mut link = self.blocked(i, seen);
        let per_bus = match gates {
            Gates::Off => {
                let iron = link.law.iron_nm_s_per_rad;
                let effort = -iron * seen.speed_m_s;
                return (BusLaw { effort, slope: iron, ..BusLaw::default() }, link);
            }
            Gates::On(modulation) => {
                link.ends_a.q = Real::NAN;
                modulation * LARGEST_PER_BUS
            }
            Gates::Torque(torque_nm) => {
                let (rise_a, wanted_a) = self.toward(&link, i, torque_nm, seen.from_v);
                link.ends_a = wanted_a;
                let force = Self::force_of(&link, i + rise_a);
                let dv =
                    seen.footing.speed_m_s + seen.footing.mobility * force.effort - seen.speed_m_s;
                let voltage_v = link.law.voltage_v(rise_a) + link.law.back_emf_v_s_per_rad * dv;
                voltage_v * (1.0 / max(seen.from_v, 1.0))
            }
        };
        (link.per_bus, link.clipped) = self.allowed(per_bus);
        link.on = true;
        Self::conducting(link, i, seen.from_v)
    }

    #[inline(always)]
    fn expected_n(&self, state: &DqCurrents, gates: Gates<Dq>) -> Real {
        match gates {
            Gates::Off => 0.0,
            Gates::On(_) => self.force_n(state),
            Gates::Torque(torque_nm) => {
                let now_n = self.force_n(state);
                now_n + self.torque_gain * (torque_nm * self.motor_rad_per_m - now_n)
            }
        }
    }

    fn law_again(
        &self,
        state: &DqCurrents,
        gates: Gates<Dq>,
        seen: Seen,
        _link: &PmsmLink,
    ) -> (BusLaw, PmsmLink) {
        let (law, mut link) = self.law(state, gates, seen);
        if !matches!(gates, Gates::Off) {
            return (law, link);
        }
        let i = state.get();
        // The bus as it was: while diodes feed it, it is well above what it is alone, and the voltage's
        // direction depends on that.
        let from_v = max(seen.from_v, 1.0);
        match link.law.diode_v(i, LARGEST_PER_BUS * from_v) {
            None => (law, link),
            Some(voltage_v) => {
                link.per_bus = voltage_v * (1.0 / from_v);
                Self::conducting(link, i, seen.from_v)
            }
        }
    }

    #[inline(always)]
    fn close(&self, link: PmsmLink, rise_v: Real, dv: Real) -> PmsmLink {
        PmsmLink { rise_a: link.rise_a + link.per_v * rise_v - link.per_speed * dv, ..link }
    }

    #[inline(always)]
    fn review(&self, state: &DqCurrents, link: &PmsmLink, bus_v: Real, dv: Real) -> Review {
        let i = state.get();
        let reached_a = i + link.rise_a;
        let square = reached_a.dot(reached_a);
        // What is not a number fits, and is refused further on.
        let broken = if link.on {
            square > self.current_limit_a * self.current_limit_a
        } else if link.blocked {
            let free_v = link.law.impede(i) - link.law.held_v - link.law.back_emf_v_s_per_rad * dv;
            let most_v = LARGEST_PER_BUS * bus_v;
            free_v.dot(free_v) > most_v * most_v
        } else {
            // Diodes only feed the bus.
            link.per_bus.dot(reached_a) > 0.0
        };
        Review {
            bus_a: 1.5 * link.per_bus.dot(reached_a),
            field_w: 1.5 * link.law.inductance_ohm().q * link.rise_a.q * reached_a.q,
            fits: !broken,
            magnitude: square,
        }
    }

    #[inline(always)]
    fn settle(&self, state: &mut DqCurrents, link: &PmsmLink) {
        state.d_a.add(link.rise_a.d);
        state.q_a.add(link.rise_a.q);
    }

    #[inline(always)]
    fn force_n(&self, state: &DqCurrents) -> Real {
        let i = state.get();
        let psi = self.winding.flux().at(i).flux_wb;
        1.5 * self.winding.pole_pairs() * (psi.d * i.q - psi.q * i.d)
    }

    #[inline(always)]
    fn output(&self, state: &DqCurrents, link: &PmsmLink, speed_m_s: Real) -> PmsmDriveOutput {
        let current_a = state.get();
        PmsmDriveOutput {
            modulation: link.per_bus * (1.0 / LARGEST_PER_BUS),
            current_a,
            motor_nm: link.law.torque_nm(current_a) / self.motor_rad_per_m,
            motor_rad_s: self.motor_rad_per_m * speed_m_s,
            coarse_step: self.winding.is_coarse(speed_m_s),
            beyond_map: link.law.beyond_map,
        }
    }

    #[inline(always)]
    fn torque_nm(output: &PmsmDriveOutput) -> Real {
        output.motor_nm
    }

    #[inline(always)]
    fn duty_and_current(output: &PmsmDriveOutput) -> (Real, Real) {
        (output.modulation.length(), output.current_a.length())
    }

    #[inline(always)]
    fn flows(
        &self,
        _before: &DqCurrents,
        after: &DqCurrents,
        link: &PmsmLink,
        speed_m_s: Real,
    ) -> MachineFlows {
        let x = after.get();
        let square = 1.5 * x.dot(x);
        MachineFlows {
            converter: self.inverter_ohm * square,
            copper: (link.law.resistance_ohm - self.inverter_ohm) * square,
            conversion: 0.0,
            iron: link.law.iron_nm_s_per_rad * speed_m_s * speed_m_s,
            field: 1.5 * x.dot(link.law.field_v(link.rise_a)),
            numerical: 0.0,
        }
    }

    #[inline(always)]
    fn flow_factors(&self) -> MachineFlows {
        MachineFlows::ONES
    }

    fn field_j(&self, _state: &DqCurrents) -> Real {
        0.0
    }

    fn motor_rad_per_m(&self) -> Real {
        self.motor_rad_per_m
    }

    #[inline(always)]
    fn is_clipped(link: &PmsmLink) -> bool {
        link.clipped
    }

    fn reached(&self, state: &DqCurrents, link: &PmsmLink, _collapsed: bool) -> Dq {
        let i = state.get();
        if !link.on && link.per_bus.dot(i + link.rise_a) > 0.0 {
            return Dq::ZERO - i;
        }
        if link.clipped || link.ends_a.q.is_nan() {
            return link.rise_a;
        }
        // Without limits the bus would move, and all voltages with it; a loop sees only the bus that is.
        let d = if link.on { (link.ends_a.d - i.d) * self.torque_gain } else { link.rise_a.d };
        Dq { d, q: link.rise_a.q }
    }

    fn within_winding(&self, state: &DqCurrents, rise_a: Dq) -> Dq {
        let (i, most_a) = (state.get(), self.current_limit_a);
        // The d axis goes first: it is what weakens the field.
        let d = clamp(i.d + rise_a.d, -most_a, most_a);
        let most_q = sqrt(max(most_a * most_a - d * d, 0.0));
        Dq {
            d: clamp(rise_a.d, -most_a - i.d, most_a - i.d),
            q: clamp(rise_a.q, -most_q - i.q, most_q - i.q),
        }
    }

    fn wish(&self, state: &DqCurrents, link: &PmsmLink, rise_a: Dq, speed_m_s: Real) -> Wish {
        let law = &link.law;
        let x = state.get() + rise_a;
        let held_w =
            1.5 * (law.resistance_ohm * x.dot(x) + speed_m_s * law.back_emf_v_s_per_rad.dot(x));
        Wish { now_w: held_w + 1.5 * x.dot(law.field_v(rise_a)), held_w }
    }

    fn force(&self, state: &DqCurrents, link: &PmsmLink, rise_a: Dq) -> DriveLaw {
        Self::force_of(link, state.get() + rise_a)
    }

    /// The d axis stays; the q axis, which makes the torque, gives way.
    fn hold(
        &self,
        state: &DqCurrents,
        link: &PmsmLink,
        want: Dq,
        footing: Footing,
        bounds: &Bounds,
    ) -> (Dq, Held) {
        if !link.on {
            return (want, Held::No);
        }
        let law = &link.law;
        let (i, rise_a) = (state.get(), self.within_winding(state, want));
        let d_a = i.d + rise_a.d;
        let Dq { d: d_emf, q: q_emf } = law.back_emf_v_s_per_rad * 1.5;
        let ohm = 1.5 * law.resistance_ohm;
        let inductance_ohm = law.inductance_ohm() * 1.5;
        // What the d axis moves of the speed, and what it takes while held, and with its field.
        let speed_m_s = footing.speed_m_s + footing.mobility * d_emf * d_a;
        let held_w = d_a * (ohm * d_a + speed_m_s * d_emf);
        let now_w = held_w + d_a * inductance_ohm.d * rise_a.d;
        let axis = Axis {
            inductance_ohm: inductance_ohm.q,
            resistance_ohm: ohm + q_emf * q_emf * footing.mobility,
            back_emf_v: speed_m_s * q_emf,
            current_a: i.q,
        };
        // A voltage that was commanded leads somewhere beyond; the torque loop says where.
        let ends_q_a = if link.ends_a.q.is_nan() { i.q + rise_a.q } else { link.ends_a.q };
        let most_q_a = sqrt(max(self.current_limit_a * self.current_limit_a - d_a * d_a, 0.0));
        let (q, held) = axis.held(
            rise_a.q,
            ends_q_a,
            &AxisBounds {
                lowest_w: min(bounds.lowest_w - now_w, 0.0),
                lowest_held_w: min(bounds.lowest_w - held_w, 0.0),
                highest_w: max(bounds.highest_w - now_w, 0.0),
                current_a: most_q_a,
            },
        );
        let held = if held == Held::No && rise_a != want { Held::Current } else { held };
        (Dq { d: rise_a.d, q }, held)
    }

    fn impose(
        &self,
        state: &DqCurrents,
        link: &PmsmLink,
        rise_a: Dq,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (PmsmLink, Option<Gates<Dq>>) {
        let (per_v, per_speed) = (Dq::ZERO, Dq::ZERO);
        let mut imposed = PmsmLink { rise_a, per_v, per_speed, ..*link };
        if !link.on {
            // Where diodes conduct, the bus itself is their voltage.
            imposed.per_bus = Dq::ZERO;
            let none = state.get() + rise_a == Dq::ZERO;
            return (imposed, if none { None } else { Some(Gates::Off) });
        }
        let law = &link.law;
        let voltage_v =
            law.voltage_v(rise_a) + law.back_emf_v_s_per_rad * (speed_m_s - link.speed_m_s);
        let (per_bus, clipped) = self.allowed(voltage_v * (1.0 / bus_v));
        imposed.per_bus = per_bus;
        let nearest =
            if clipped { Some(Gates::On(per_bus * (1.0 / LARGEST_PER_BUS))) } else { None };
        (imposed, nearest)
    }
}

#[cfg(test)]
mod tests;
