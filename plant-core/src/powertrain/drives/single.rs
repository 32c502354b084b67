//! One drive.

use super::{Drive, Drives, Mode, Shares, Wishes};
use crate::converter::Gates;
use crate::machine::{Footing, Held, Machine, MachineFlows, Review, Seen, Solved, Temperatures};
use crate::mechanics::body::Resistance;
use crate::num::Real;
use crate::port::{BusLaw, DriveLaw, Source};

impl<M: Machine> Drives for Drive<M> {
    type Command = Gates<M::Modulation>;
    type State = M::State;
    type Link = M::Link;
    type Rises = M::Rise;
    type Output = M::Output;
    const PASSES: u32 = 1;
    const THREE_PHASE: bool = M::THREE_PHASE;

    #[inline(always)]
    fn law(&self, state: &M::State, command: Self::Command, seen: Seen) -> (BusLaw, M::Link) {
        self.machine.law(state, command, seen)
    }

    #[inline(always)]
    fn command(&self, torque_nm: Real) -> Self::Command {
        Gates::Torque(torque_nm)
    }

    fn torque_share(&self) -> Real {
        self.torque_share
    }

    #[inline(always)]
    fn expected_n(&self, state: &M::State, command: Self::Command) -> Real {
        self.machine.expected_n(state, command)
    }

    fn law_again(
        &self,
        state: &M::State,
        command: Self::Command,
        seen: Seen,
        link: &M::Link,
    ) -> (BusLaw, M::Link) {
        self.machine.law_again(state, command, seen, link)
    }

    #[inline(always)]
    fn close(&self, link: M::Link, rise_v: Real, dv: Real) -> M::Link {
        self.machine.close(link, rise_v, dv)
    }

    #[inline(always)]
    fn solve(
        &self,
        state: &M::State,
        command: Self::Command,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<M::Link> {
        self.machine.solve(state, command, seen, bus, resistance)
    }

    #[inline(always)]
    fn review(&self, state: &M::State, link: &M::Link, bus_v: Real, dv: Real) -> Review {
        self.machine.review(state, link, bus_v, dv)
    }

    #[inline(always)]
    fn settle(&self, state: &mut M::State, link: &M::Link) {
        self.machine.settle(state, link);
    }

    #[inline(always)]
    fn gear_n(&self, state: &M::State) -> Real {
        self.gear_loss * self.machine.force_n(state).abs()
    }

    #[inline(always)]
    fn output(&self, state: &M::State, link: &M::Link, speed_m_s: Real) -> M::Output {
        self.machine.output(state, link, speed_m_s)
    }

    #[inline(always)]
    fn torque_nm(&self, output: &M::Output) -> Real {
        M::torque_nm(output)
    }

    #[inline(always)]
    fn duty_and_current(output: &M::Output) -> (Real, Real) {
        M::duty_and_current(output)
    }

    #[inline(always)]
    fn flows(
        &self,
        before: &M::State,
        after: &M::State,
        link: &M::Link,
        speed_m_s: Real,
    ) -> MachineFlows {
        self.machine.flows(before, after, link, speed_m_s)
    }

    #[inline(always)]
    fn flow_factors(&self) -> MachineFlows {
        self.machine.flow_factors()
    }

    fn field_j(&self, state: &M::State) -> Real {
        self.machine.field_j(state)
    }

    fn motor_rad_per_m(&self) -> Real {
        self.machine.motor_rad_per_m()
    }

    #[inline(always)]
    fn temperatures(output: &M::Output) -> Option<Temperatures> {
        M::temperatures(output)
    }

    #[inline(always)]
    fn is_clipped(link: &M::Link) -> bool {
        M::is_clipped(link)
    }

    #[inline(always)]
    fn is_derated(link: &M::Link) -> bool {
        M::is_derated(link)
    }

    fn reached(&self, state: &M::State, link: &M::Link, collapsed: bool) -> M::Rise {
        self.machine.reached(state, link, collapsed)
    }

    fn within_winding(&self, state: &M::State, rise: M::Rise) -> M::Rise {
        self.machine.within_winding(state, rise)
    }

    fn wishes(&self, state: &M::State, link: &M::Link, rise: M::Rise, speed_m_s: Real) -> Wishes {
        self.machine.wish(state, link, rise, speed_m_s).into()
    }

    fn force(&self, state: &M::State, link: &M::Link, rise: M::Rise) -> DriveLaw {
        self.machine.force(state, link, rise)
    }

    #[inline(always)]
    fn hold(
        &self,
        state: &M::State,
        link: &M::Link,
        want: M::Rise,
        found: M::Rise,
        mode: &Mode,
        shares: &Shares,
    ) -> (M::Rise, Held) {
        let mut footing = Footing { speed_m_s: mode.coasting_m_s, mobility: mode.mobility };
        if shares.alone {
            return self.machine.hold(state, link, want, footing, &shares.all());
        }
        let others_n = mode.force_n - self.machine.force(state, link, found).effort;
        footing.speed_m_s += mode.mobility * others_n;
        let carried = self.machine.within_winding(state, want);
        let wish = self.machine.wish(state, link, carried, mode.ended_m_s());
        self.machine.hold(state, link, want, footing, &shares.bounds(wish))
    }

    #[inline(always)]
    fn impose(
        &self,
        state: &M::State,
        link: &M::Link,
        rise: M::Rise,
        _command: Self::Command,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (M::Link, Option<Self::Command>) {
        self.machine.impose(state, link, rise, speed_m_s, bus_v)
    }
}
