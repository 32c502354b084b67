//! How it joins a chain: as the machine that it is at its temperatures, and back with their heat.

use super::{
    Bounds, BusLaw, DriveLaw, Footing, Gates, Heated, HeatedLink, HeatedMachine, HeatedOutput,
    HeatedState, Held, Machine, MachineFlows, Real, Resistance, Review, Seen, Solved, Source,
    Temperatures, Wish,
};

impl<M: HeatedMachine> Machine for Heated<M> {
    type State = HeatedState<M::State>;
    type Modulation = M::Modulation;
    type Rise = M::Rise;
    type Link = HeatedLink<M::Link>;
    type Output = HeatedOutput<M::Output>;
    const THREE_PHASE: bool = M::THREE_PHASE;

    #[inline(always)]
    fn law(
        &self,
        state: &Self::State,
        gates: Gates<M::Modulation>,
        seen: Seen,
    ) -> (BusLaw, Self::Link) {
        let warm = self.warm(state);
        let (law, link) = warm.law(&state.machine, gates, seen);
        let derated = self.derates(state, &warm, gates, &link);
        (law, HeatedLink { link, speed_m_s: seen.speed_m_s, derated })
    }

    #[inline(always)]
    fn expected_n(&self, state: &Self::State, gates: Gates<M::Modulation>) -> Real {
        self.warm(state).expected_n(&state.machine, gates)
    }

    fn law_again(
        &self,
        state: &Self::State,
        gates: Gates<M::Modulation>,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link) {
        let warm = self.warm(state);
        let (law, link) = warm.law_again(&state.machine, gates, seen, &link.link);
        let derated = self.derates(state, &warm, gates, &link);
        (law, HeatedLink { link, speed_m_s: seen.speed_m_s, derated })
    }

    #[inline(always)]
    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link {
        // Nothing here depends on a temperature: the link holds what did.
        HeatedLink {
            link: self.cold.close(link.link, rise_v, dv),
            speed_m_s: link.speed_m_s + dv,
            ..link
        }
    }

    #[inline(always)]
    fn solve(
        &self,
        state: &Self::State,
        gates: Gates<M::Modulation>,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<Self::Link> {
        let warm = self.warm(state);
        let Solved { link, bus_v, motion } =
            warm.solve(&state.machine, gates, seen, bus, resistance);
        let derated = self.derates(state, &warm, gates, &link);
        let speed_m_s = seen.speed_m_s + motion.increment_m_s;
        Solved { link: HeatedLink { link, speed_m_s, derated }, bus_v, motion }
    }

    #[inline(always)]
    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review {
        self.warm(state).review(&state.machine, &link.link, bus_v, dv)
    }

    /// Back, and what the step lost heats the nodes.
    #[inline(always)]
    fn settle(&self, state: &mut Self::State, link: &Self::Link) {
        let warm = self.warm(state);
        let before = state.machine;
        warm.settle(&mut state.machine, &link.link);
        let speed_m_s = link.speed_m_s;
        let lost =
            warm.flows(&before, &state.machine, &link.link, speed_m_s).times(&warm.flow_factors());
        let friction_w = (self.viscous * speed_m_s.abs() + self.coulomb_n) * speed_m_s.abs();
        let machine_w = lost.copper + lost.iron + friction_w;
        let inverter_w = lost.converter + self.constant_loss_w;
        self.machine.node.step_above(&mut state.machine_above_k, machine_w);
        self.inverter.node.step_above(&mut state.inverter_above_k, inverter_w);
    }

    #[inline(always)]
    fn force_n(&self, state: &Self::State) -> Real {
        self.cold.force_n(&state.machine)
    }

    #[inline(always)]
    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output {
        HeatedOutput {
            machine: self.cold.output(&state.machine, &link.link, speed_m_s),
            temperatures: self.temperatures(state),
        }
    }

    #[inline(always)]
    fn torque_nm(output: &Self::Output) -> Real {
        M::torque_nm(&output.machine)
    }

    #[inline(always)]
    fn duty_and_current(output: &Self::Output) -> (Real, Real) {
        M::duty_and_current(&output.machine)
    }

    /// With the factors: one of them is the resistance.
    #[inline(always)]
    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows {
        let warm = self.warm(before);
        warm.flows(&before.machine, &after.machine, &link.link, speed_m_s)
            .times(&warm.flow_factors())
    }

    #[inline(always)]
    fn flow_factors(&self) -> MachineFlows {
        MachineFlows::ONES
    }

    fn field_j(&self, state: &Self::State) -> Real {
        self.cold.field_j(&state.machine)
    }

    fn motor_rad_per_m(&self) -> Real {
        self.cold.motor_rad_per_m()
    }

    fn temperatures(output: &Self::Output) -> Option<Temperatures> {
        Some(output.temperatures)
    }

    #[inline(always)]
    fn is_clipped(link: &Self::Link) -> bool {
        M::is_clipped(&link.link)
    }

    #[inline(always)]
    fn is_derated(link: &Self::Link) -> bool {
        link.derated
    }

    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> M::Rise {
        self.warm(state).reached(&state.machine, &link.link, collapsed)
    }

    fn within_winding(&self, state: &Self::State, rise: M::Rise) -> M::Rise {
        self.warm(state).within_winding(&state.machine, rise)
    }

    fn wish(&self, state: &Self::State, link: &Self::Link, rise: M::Rise, speed_m_s: Real) -> Wish {
        self.warm(state).wish(&state.machine, &link.link, rise, speed_m_s)
    }

    fn force(&self, state: &Self::State, link: &Self::Link, rise: M::Rise) -> DriveLaw {
        self.warm(state).force(&state.machine, &link.link, rise)
    }

    fn hold(
        &self,
        state: &Self::State,
        link: &Self::Link,
        want: M::Rise,
        footing: Footing,
        bounds: &Bounds,
    ) -> (M::Rise, Held) {
        self.warm(state).hold(&state.machine, &link.link, want, footing, bounds)
    }

    fn impose(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rise: M::Rise,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (Self::Link, Option<Gates<M::Modulation>>) {
        let warm = self.warm(state);
        let (imposed, nearest) = warm.impose(&state.machine, &link.link, rise, speed_m_s, bus_v);
        (HeatedLink { link: imposed, speed_m_s, ..*link }, nearest)
    }
}
