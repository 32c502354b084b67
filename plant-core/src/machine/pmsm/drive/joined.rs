//! How it joins a chain.

use super::{DqCurrents, PmsmDrive, PmsmDriveOutput, PmsmLink};
use crate::converter::Gates;
use crate::machine::axis::{Axis, AxisBounds};
use crate::machine::heated::HeatedMachine;
use crate::machine::transform::{Dq, LARGEST_PER_BUS};
use crate::machine::{Bounds, Footing, Held, Machine, MachineFlows, Review, Seen, Wish};
use crate::num::{Real, clamp, max, min, sqrt};
use crate::port::{BusLaw, DriveLaw};
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

/// From what share of it on a current stands at its limit.
const AT_LIMIT: Real = 0.9999;

impl HeatedMachine for PmsmDrive {
    #[inline(always)]
    fn with(&self, winding_ohm: Real, current_limit_a: Real) -> Self {
        let mut other = *self;
        other.current_limit_a = current_limit_a;
        other.winding = self.winding.with_resistance(winding_ohm + self.inverter_ohm);
        other
    }

    #[inline(always)]
    fn holds(&self, gates: Gates<Dq>, link: &PmsmLink) -> bool {
        let most_a = AT_LIMIT * self.current_limit_a;
        matches!(gates, Gates::Torque(_)) && link.ends_a.dot(link.ends_a) >= most_a * most_a
    }
}
