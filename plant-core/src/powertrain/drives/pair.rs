//! Two drives, or two pairs of them.

use super::{Drives, Mode, Shares, Wishes};
use crate::machine::{Footing, Held, MachineFlows, Review, Seen, Temperatures};
use crate::num::Real;
use crate::port::{BusLaw, DriveLaw};

/// What each of a pair sees: a road that the other moves too.
trait PairSeen: Drives {
    /// Both views.
    fn seen(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (Seen, Seen);
}

impl<A: Drives, B: Drives> PairSeen for (A, B) {
    #[inline(always)]
    fn seen(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (Seen, Seen) {
        let Footing { speed_m_s, mobility } = seen.footing;
        let beside = |other_n: Real| Seen {
            footing: Footing { speed_m_s: speed_m_s + mobility * other_n, mobility },
            ..seen
        };
        (
            beside(self.1.expected_n(&state.1, command.1)),
            beside(self.0.expected_n(&state.0, command.0)),
        )
    }
}

impl<A: Drives, B: Drives> Drives for (A, B) {
    type Command = (A::Command, B::Command);
    type State = (A::State, B::State);
    type Link = (A::Link, B::Link);
    type Rises = (A::Rises, B::Rises);
    type Output = (A::Output, B::Output);
    const PASSES: u32 = 3;
    const THREE_PHASE: bool = A::THREE_PHASE || B::THREE_PHASE;

    #[inline(always)]
    fn law(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (BusLaw, Self::Link) {
        let (of_one, of_two) = self.seen(state, command, seen);
        let (one, a) = self.0.law(&state.0, command.0, of_one);
        let (two, b) = self.1.law(&state.1, command.1, of_two);
        (one + two, (a, b))
    }

    #[inline(always)]
    fn command(&self, torque_nm: Real) -> Self::Command {
        let (one, two) = (self.0.torque_share(), self.1.torque_share());
        let first_nm = torque_nm * one / (one + two);
        let ratio = self.0.motor_rad_per_m() / self.1.motor_rad_per_m();
        (self.0.command(first_nm), self.1.command((torque_nm - first_nm) * ratio))
    }

    fn torque_share(&self) -> Real {
        self.0.torque_share() + self.1.torque_share()
    }

    #[inline(always)]
    fn expected_n(&self, state: &Self::State, command: Self::Command) -> Real {
        self.0.expected_n(&state.0, command.0) + self.1.expected_n(&state.1, command.1)
    }

    fn law_again(
        &self,
        state: &Self::State,
        command: Self::Command,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link) {
        let (of_one, of_two) = self.seen(state, command, seen);
        let (one, a) = self.0.law_again(&state.0, command.0, of_one, &link.0);
        let (two, b) = self.1.law_again(&state.1, command.1, of_two, &link.1);
        (one + two, (a, b))
    }

    #[inline(always)]
    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link {
        (self.0.close(link.0, rise_v, dv), self.1.close(link.1, rise_v, dv))
    }

    #[inline(always)]
    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review {
        let a = self.0.review(&state.0, &link.0, bus_v, dv);
        let b = self.1.review(&state.1, &link.1, bus_v, dv);
        Review {
            bus_a: a.bus_a + b.bus_a,
            field_w: a.field_w + b.field_w,
            fits: a.fits && b.fits,
            magnitude: a.magnitude + b.magnitude,
        }
    }

    #[inline(always)]
    fn settle(&self, state: &mut Self::State, link: &Self::Link) {
        self.0.settle(&mut state.0, &link.0);
        self.1.settle(&mut state.1, &link.1);
    }

    #[inline(always)]
    fn gear_n(&self, state: &Self::State) -> Real {
        self.0.gear_n(&state.0) + self.1.gear_n(&state.1)
    }

    #[inline(always)]
    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output {
        (self.0.output(&state.0, &link.0, speed_m_s), self.1.output(&state.1, &link.1, speed_m_s))
    }

    #[inline(always)]
    fn torque_nm(&self, output: &Self::Output) -> Real {
        let ratio = self.1.motor_rad_per_m() / self.0.motor_rad_per_m();
        self.0.torque_nm(&output.0) + ratio * self.1.torque_nm(&output.1)
    }

    #[inline(always)]
    fn duty_and_current(output: &Self::Output) -> (Real, Real) {
        A::duty_and_current(&output.0)
    }

    #[inline(always)]
    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows {
        let a = self.0.flows(&before.0, &after.0, &link.0, speed_m_s);
        let b = self.1.flows(&before.1, &after.1, &link.1, speed_m_s);
        a.times(&self.0.flow_factors()) + b.times(&self.1.flow_factors())
    }

    #[inline(always)]
    fn flow_factors(&self) -> MachineFlows {
        MachineFlows::ONES
    }

    fn field_j(&self, state: &Self::State) -> Real {
        self.0.field_j(&state.0) + self.1.field_j(&state.1)
    }

    fn motor_rad_per_m(&self) -> Real {
        self.0.motor_rad_per_m()
    }

    #[inline(always)]
    fn temperatures(output: &Self::Output) -> Option<Temperatures> {
        match (A::temperatures(&output.0), B::temperatures(&output.1)) {
            (Some(one), Some(two)) => Some(one.worse(two)),
            (one, two) => one.or(two),
        }
    }

    #[inline(always)]
    fn is_clipped(link: &Self::Link) -> bool {
        A::is_clipped(&link.0) || B::is_clipped(&link.1)
    }

    #[inline(always)]
    fn is_derated(link: &Self::Link) -> bool {
        A::is_derated(&link.0) || B::is_derated(&link.1)
    }

    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rises {
        (self.0.reached(&state.0, &link.0, collapsed), self.1.reached(&state.1, &link.1, collapsed))
    }

    fn within_winding(&self, state: &Self::State, rises: Self::Rises) -> Self::Rises {
        (self.0.within_winding(&state.0, rises.0), self.1.within_winding(&state.1, rises.1))
    }

    fn wishes(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        speed_m_s: Real,
    ) -> Wishes {
        self.0.wishes(&state.0, &link.0, rises.0, speed_m_s)
            + self.1.wishes(&state.1, &link.1, rises.1, speed_m_s)
    }

    fn force(&self, state: &Self::State, link: &Self::Link, rises: Self::Rises) -> DriveLaw {
        self.0.force(&state.0, &link.0, rises.0) + self.1.force(&state.1, &link.1, rises.1)
    }

    fn hold(
        &self,
        state: &Self::State,
        link: &Self::Link,
        wants: Self::Rises,
        found: Self::Rises,
        mode: &Mode,
        shares: &Shares,
    ) -> (Self::Rises, Held) {
        let (a, one) = self.0.hold(&state.0, &link.0, wants.0, found.0, mode, shares);
        let (b, two) = self.1.hold(&state.1, &link.1, wants.1, found.1, mode, shares);
        ((a, b), if one == Held::No { two } else { one })
    }

    fn impose(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        command: Self::Command,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (Self::Link, Option<Self::Command>) {
        let (a, one) = self.0.impose(&state.0, &link.0, rises.0, command.0, speed_m_s, bus_v);
        let (b, two) = self.1.impose(&state.1, &link.1, rises.1, command.1, speed_m_s, bus_v);
        let nearest = match (one, two) {
            (None, None) => None,
            (one, two) => Some((one.unwrap_or(command.0), two.unwrap_or(command.1))),
        };
        ((a, b), nearest)
    }
}
