//! How it joins a chain.

use super::{DcDrive, DcDriveOutput, DcLink};
use crate::converter::Gates;
use crate::machine::axis::{Axis, AxisBounds, ROUNDING};
use crate::machine::heated::HeatedMachine;
use crate::machine::{Bounds, Footing, Held, Machine, MachineFlows, Review, Seen, Solved, Wish};
use crate::mechanics::body::Resistance;
use crate::num::{Accum, LARGEST, Real, clamp, sign};
use crate::port::{BusLaw, DriveLaw, Source};
impl Machine for DcDrive {
    type State = Accum;
    type Modulation = Real;
    type Rise = Real;
    type Link = DcLink;
    type Output = DcDriveOutput;

    #[inline(always)]
    fn law(&self, state: &Accum, gates: Gates, seen: Seen) -> (BusLaw, DcLink) {
        let i = state.get();
        match self.commanded(i, gates, seen) {
            (link, true) => self.conducting(link, i, seen.from_v),
            (link, false) => (BusLaw::default(), link),
        }
    }

    #[inline(always)]
    fn close(&self, link: DcLink, rise_v: Real, dv: Real) -> DcLink {
        let more_v = link.duty * rise_v - self.back_emf * dv;
        DcLink { rise_a: link.rise_a + link.admittance_s * more_v, ..link }
    }

    /// With D²·R of the bus in the winding's resistance, so that its voltage follows in the end.
    #[inline(always)]
    fn solve(
        &self,
        state: &Accum,
        gates: Gates,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<DcLink> {
        let i = state.get();
        let (mut link, conducts) = self.commanded(i, gates, seen);
        let (mut drive, mut per_speed) = (DriveLaw::default(), 0.0);
        if conducts {
            let bus_ohm = link.duty * bus.resistance_ohm;
            let driving_v = self.driving_v(&link, i, bus.emf_v - bus_ohm * i);
            let admittance_s = 1.0 / (self.step_ohm + link.duty * bus_ohm);
            link.rise_a = admittance_s * driving_v;
            per_speed = admittance_s * self.back_emf;
            drive = DriveLaw {
                effort: self.effort_per_a * (i + link.rise_a),
                slope: admittance_s * self.effort_emf,
            };
        }
        let motion = resistance.solve(drive, seen.speed_m_s);
        link.rise_a -= per_speed * motion.increment_m_s;
        Solved { link, bus_v: bus.voltage_v(link.duty * (i + link.rise_a)), motion }
    }

    #[inline(always)]
    fn expected_n(&self, state: &Accum, gates: Gates) -> Real {
        let i = state.get();
        self.effort_per_a
            * match gates {
                Gates::Off => 0.0,
                Gates::On(_) => i,
                Gates::Torque(torque_nm) => self.toward_a(torque_nm, i),
            }
    }

    fn law_again(
        &self,
        state: &Accum,
        gates: Gates,
        seen: Seen,
        link: &DcLink,
    ) -> (BusLaw, DcLink) {
        let i = state.get();
        let emf_v = self.back_emf * seen.speed_m_s;
        if !matches!(gates, Gates::Off) {
            if link.drop_v * (i + link.rise_a) < 0.0 {
                return (BusLaw::default(), DcLink::blocked(i, emf_v, link.duty, true));
            }
            return self.law(state, gates, seen);
        }
        let drop_v = self.converter.params.voltage_drop_v;
        let free_v = self.inductance_ohm * i - emf_v;
        if free_v.abs() <= seen.bus_v + drop_v {
            return (BusLaw::default(), DcLink::blocked(i, emf_v, 0.0, false));
        }
        let direction = sign(free_v);
        let link = DcLink::blocked(i, emf_v, -direction, false);
        self.conducting(DcLink { drop_v: direction * drop_v, ..link }, i, seen.from_v)
    }

    #[inline(always)]
    fn review(&self, state: &Accum, link: &DcLink, bus_v: Real, dv: Real) -> Review {
        let i = state.get();
        let reached_a = i + link.rise_a;
        let drop_v = self.converter.params.voltage_drop_v;
        // What is not a number fits, and is refused further on.
        let broken = if link.on {
            reached_a.abs() > self.converter.params.current_limit_a
                || drop_v > 0.0 && link.drop_v * reached_a < 0.0
        } else if link.duty == 0.0 {
            let free_v = self.inductance_ohm * i - link.emf_v - self.back_emf * dv;
            free_v.abs() > bus_v + drop_v
        } else {
            // Diodes do not conduct backwards.
            link.duty * reached_a > 0.0
        };
        Review {
            bus_a: link.duty * reached_a,
            field_w: self.inductance_ohm * link.rise_a * reached_a,
            fits: !broken,
            magnitude: reached_a.abs(),
        }
    }

    #[inline(always)]
    fn settle(&self, state: &mut Accum, link: &DcLink) {
        state.add(link.rise_a);
    }

    #[inline(always)]
    fn force_n(&self, state: &Accum) -> Real {
        self.effort_per_a * state.get()
    }

    #[inline(always)]
    fn output(&self, state: &Accum, link: &DcLink, speed_m_s: Real) -> DcDriveOutput {
        DcDriveOutput {
            duty: link.duty,
            motor_a: state.get(),
            motor_nm: self.torque_nm_per_a * state.get(),
            motor_rad_s: self.motor_rad_per_m * speed_m_s,
        }
    }

    #[inline(always)]
    fn torque_nm(output: &DcDriveOutput) -> Real {
        output.motor_nm
    }

    #[inline(always)]
    fn duty_and_current(output: &DcDriveOutput) -> (Real, Real) {
        (output.duty, output.motor_a)
    }

    #[inline(always)]
    fn flows(&self, before: &Accum, after: &Accum, link: &DcLink, speed_m_s: Real) -> MachineFlows {
        let i = after.get();
        let _ = before;
        MachineFlows {
            converter: (self.converter.params.resistance_ohm * i + link.drop_v) * i,
            copper: i * i,
            conversion: speed_m_s * i,
            numerical: self.inductance_ohm * link.rise_a * link.rise_a,
            iron: 0.0,
            field: 0.0,
        }
    }

    #[inline(always)]
    fn flow_factors(&self) -> MachineFlows {
        MachineFlows {
            copper: self.resistance_ohm - self.converter.params.resistance_ohm,
            conversion: self.back_emf - self.effort_per_a,
            ..MachineFlows::ONES
        }
    }

    fn field_j(&self, state: &Accum) -> Real {
        0.5 * self.inductance_h * state.get() * state.get()
    }

    fn motor_rad_per_m(&self) -> Real {
        self.motor_rad_per_m
    }

    #[inline(always)]
    fn is_clipped(link: &DcLink) -> bool {
        link.clipped
    }

    fn reached(&self, state: &Accum, link: &DcLink, collapsed: bool) -> Real {
        let (i, rise_a) = (state.get(), link.rise_a);
        if collapsed {
            return sign(i + rise_a) * LARGEST;
        }
        // Diodes do not conduct backwards.
        if !link.on && link.duty * (i + rise_a) > 0.0 { -i } else { rise_a }
    }

    fn within_winding(&self, state: &Accum, rise_a: Real) -> Real {
        let (i, most_a) = (state.get(), self.converter.params.current_limit_a);
        clamp(rise_a, -most_a - i, most_a - i)
    }

    fn wish(&self, state: &Accum, _link: &DcLink, rise_a: Real, speed_m_s: Real) -> Wish {
        let x = state.get() + rise_a;
        Wish {
            now_w: x * self.terminal_v(state.get(), rise_a, speed_m_s),
            held_w: x * self.terminal_v(x, 0.0, speed_m_s),
        }
    }

    fn force(&self, state: &Accum, _link: &DcLink, rise_a: Real) -> DriveLaw {
        DriveLaw { effort: self.effort_per_a * (state.get() + rise_a), slope: 0.0 }
    }

    #[inline(always)]
    fn hold(
        &self,
        state: &Accum,
        link: &DcLink,
        want: Real,
        footing: Footing,
        bounds: &Bounds,
    ) -> (Real, Held) {
        if !link.on {
            return (want, Held::No);
        }
        let emf_v = self.back_emf * footing.speed_m_s;
        let drop_v = self.converter.params.voltage_drop_v;
        let axis = Axis {
            inductance_ohm: self.inductance_ohm,
            resistance_ohm: self.resistance_ohm
                + self.back_emf * self.effort_per_a * footing.mobility,
            back_emf_v: emf_v + sign(state.get() + want) * drop_v,
            current_a: state.get(),
        };
        let driving_v = link.duty * bounds.bus_v - emf_v;
        let settles_v = driving_v - clamp(driving_v, -drop_v, drop_v);
        // One that drives in the end charges nothing, wherever that is.
        let mut ends_at = 0.0;
        if settles_v * axis.back_emf_v < 0.0 {
            ends_at = settles_v / (axis.resistance_ohm + link.duty * link.duty * bounds.bus_ohm);
            if link.duty * ends_at * bounds.bus_ohm > 0.5 * bounds.bus_v {
                // Beyond the battery's greatest power: it draws whatever it can.
                ends_at = sign(ends_at) * LARGEST;
            }
        }
        axis.held(
            want,
            ends_at,
            &AxisBounds {
                lowest_w: bounds.lowest_w,
                lowest_held_w: bounds.lowest_w,
                highest_w: bounds.highest_w,
                current_a: self.converter.params.current_limit_a,
            },
        )
    }

    #[inline(always)]
    fn impose(
        &self,
        state: &Accum,
        link: &DcLink,
        rise_a: Real,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (DcLink, Option<Gates>) {
        // What rounding leaves of a current that ends has no direction, and no voltage drop.
        let left_a = state.get() + rise_a;
        let rise_a = if left_a.abs() <= ROUNDING * rise_a.abs() { -state.get() } else { rise_a };
        let x = state.get() + rise_a;
        let drop_v = sign(x) * self.converter.params.voltage_drop_v;
        let imposed = DcLink { drop_v, rise_a, admittance_s: 0.0, ..*link };
        if !link.on {
            // Where diodes conduct, the bus itself is their voltage.
            return (imposed, if x == 0.0 { None } else { Some(Gates::Off) });
        }
        let asked = self.terminal_v(state.get(), rise_a, speed_m_s) / bus_v;
        let duty = self.converter.allowed_duty(asked);
        let nearest = if duty == asked { None } else { Some(Gates::On(duty)) };
        (DcLink { duty, ..imposed }, nearest)
    }
}

impl HeatedMachine for DcDrive {
    #[inline(always)]
    fn with(&self, winding_ohm: Real, current_limit_a: Real) -> Self {
        let mut other = *self;
        other.converter.params.current_limit_a = current_limit_a;
        other.resistance_ohm = winding_ohm + self.converter.params.resistance_ohm;
        other.step_ohm = self.inductance_ohm + other.resistance_ohm;
        other.admittance_s = 1.0 / (self.inductance_ohm + other.resistance_ohm);
        other
    }

    #[inline(always)]
    fn holds(&self, gates: Gates, _link: &DcLink) -> bool {
        let most_nm = self.converter.params.current_limit_a * self.torque_nm_per_a;
        matches!(gates, Gates::Torque(torque_nm) if torque_nm.abs() > most_nm)
    }
}
