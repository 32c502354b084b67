//! A drive that is one of two, told apart at run time.

use super::{Drives, Mode, Shares, Wishes};
use crate::machine::{Held, MachineFlows, Review, Seen, Temperatures};
use crate::num::Real;
use crate::port::{BusLaw, DriveLaw};

/// One of two: where not the program but a file or a caller says which drives there are.
///
/// Command and state are those of both, of which one counts. What a drive is handed back is its own;
/// for what is the other's, which no plant hands to it, it answers as if there were nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Either<A, B> {
    /// The one.
    One(A),
    /// The other.
    Other(B),
}

/// That of the one: where neither counts, so that pairs of them nest.
impl<A: Default, B> Default for Either<A, B> {
    fn default() -> Self {
        Self::One(A::default())
    }
}

/// Asks the drive that it is, with what belongs to it.
macro_rules! each {
    ($drive:expr, $($link:expr),+ => |$it:ident, $($of:ident),+| $one:expr, $other:expr, else $none:expr) => {
        match ($drive, $($link),+) {
            (Either::One($it), $(Either::One($of)),+) => $one,
            (Either::Other($it), $(Either::Other($of)),+) => $other,
            _ => $none,
        }
    };
}

impl<A, B> Drives for Either<A, B>
where
    A: Drives<Rises: Default, Output: Default>,
    B: Drives<Rises: Default, Output: Default>,
{
    type Command = (A::Command, B::Command);
    type State = (A::State, B::State);
    type Link = Either<A::Link, B::Link>;
    type Rises = Either<A::Rises, B::Rises>;
    type Output = Either<A::Output, B::Output>;
    const PASSES: u32 = if A::PASSES > B::PASSES { A::PASSES } else { B::PASSES };
    const THREE_PHASE: bool = A::THREE_PHASE || B::THREE_PHASE;

    fn law(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (BusLaw, Self::Link) {
        match self {
            Self::One(it) => {
                let (law, link) = it.law(&state.0, command.0, seen);
                (law, Either::One(link))
            }
            Self::Other(it) => {
                let (law, link) = it.law(&state.1, command.1, seen);
                (law, Either::Other(link))
            }
        }
    }

    fn command(&self, torque_nm: Real) -> Self::Command {
        match self {
            Self::One(it) => (it.command(torque_nm), B::Command::default()),
            Self::Other(it) => (A::Command::default(), it.command(torque_nm)),
        }
    }

    fn torque_share(&self) -> Real {
        match self {
            Self::One(it) => it.torque_share(),
            Self::Other(it) => it.torque_share(),
        }
    }

    fn expected_n(&self, state: &Self::State, command: Self::Command) -> Real {
        match self {
            Self::One(it) => it.expected_n(&state.0, command.0),
            Self::Other(it) => it.expected_n(&state.1, command.1),
        }
    }

    fn law_again(
        &self,
        state: &Self::State,
        command: Self::Command,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link) {
        each!(
            self, link => |it, of| {
                let (law, link) = it.law_again(&state.0, command.0, seen, of);
                (law, Either::One(link))
            },
            {
                let (law, link) = it.law_again(&state.1, command.1, seen, of);
                (law, Either::Other(link))
            },
            else (BusLaw::default(), *link)
        )
    }

    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link {
        each!(
            self, link => |it, of| Either::One(it.close(of, rise_v, dv)),
            Either::Other(it.close(of, rise_v, dv)),
            else link
        )
    }

    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review {
        each!(
            self, link => |it, of| it.review(&state.0, of, bus_v, dv),
            it.review(&state.1, of, bus_v, dv),
            else Review::default()
        )
    }

    fn settle(&self, state: &mut Self::State, link: &Self::Link) {
        each!(
            self, link => |it, of| it.settle(&mut state.0, of),
            it.settle(&mut state.1, of),
            else ()
        );
    }

    fn gear_n(&self, state: &Self::State) -> Real {
        match self {
            Self::One(it) => it.gear_n(&state.0),
            Self::Other(it) => it.gear_n(&state.1),
        }
    }

    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output {
        match (self, link) {
            (Self::One(it), Either::One(of)) => Either::One(it.output(&state.0, of, speed_m_s)),
            (Self::Other(it), Either::Other(of)) => {
                Either::Other(it.output(&state.1, of, speed_m_s))
            }
            (Self::One(_), _) => Either::One(A::Output::default()),
            (Self::Other(_), _) => Either::Other(B::Output::default()),
        }
    }

    fn torque_nm(&self, output: &Self::Output) -> Real {
        each!(self, output => |it, of| it.torque_nm(of), it.torque_nm(of), else 0.0)
    }

    fn duty_and_current(output: &Self::Output) -> (Real, Real) {
        match output {
            Either::One(of) => A::duty_and_current(of),
            Either::Other(of) => B::duty_and_current(of),
        }
    }

    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows {
        each!(
            self, link => |it, of| it.flows(&before.0, &after.0, of, speed_m_s),
            it.flows(&before.1, &after.1, of, speed_m_s),
            else MachineFlows::default()
        )
    }

    fn flow_factors(&self) -> MachineFlows {
        match self {
            Self::One(it) => it.flow_factors(),
            Self::Other(it) => it.flow_factors(),
        }
    }

    fn field_j(&self, state: &Self::State) -> Real {
        match self {
            Self::One(it) => it.field_j(&state.0),
            Self::Other(it) => it.field_j(&state.1),
        }
    }

    fn motor_rad_per_m(&self) -> Real {
        match self {
            Self::One(it) => it.motor_rad_per_m(),
            Self::Other(it) => it.motor_rad_per_m(),
        }
    }

    fn temperatures(output: &Self::Output) -> Option<Temperatures> {
        match output {
            Either::One(of) => A::temperatures(of),
            Either::Other(of) => B::temperatures(of),
        }
    }

    fn is_clipped(link: &Self::Link) -> bool {
        match link {
            Either::One(of) => A::is_clipped(of),
            Either::Other(of) => B::is_clipped(of),
        }
    }

    fn is_derated(link: &Self::Link) -> bool {
        match link {
            Either::One(of) => A::is_derated(of),
            Either::Other(of) => B::is_derated(of),
        }
    }

    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rises {
        match (self, link) {
            (Self::One(it), Either::One(of)) => Either::One(it.reached(&state.0, of, collapsed)),
            (Self::Other(it), Either::Other(of)) => {
                Either::Other(it.reached(&state.1, of, collapsed))
            }
            (Self::One(_), _) => Either::One(A::Rises::default()),
            (Self::Other(_), _) => Either::Other(B::Rises::default()),
        }
    }

    fn within_winding(&self, state: &Self::State, rises: Self::Rises) -> Self::Rises {
        each!(
            self, rises => |it, of| Either::One(it.within_winding(&state.0, of)),
            Either::Other(it.within_winding(&state.1, of)),
            else rises
        )
    }

    fn wishes(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        speed_m_s: Real,
    ) -> Wishes {
        each!(
            self, link, rises => |it, of, rises| it.wishes(&state.0, of, rises, speed_m_s),
            it.wishes(&state.1, of, rises, speed_m_s),
            else Wishes::default()
        )
    }

    fn force(&self, state: &Self::State, link: &Self::Link, rises: Self::Rises) -> DriveLaw {
        each!(
            self, link, rises => |it, of, rises| it.force(&state.0, of, rises),
            it.force(&state.1, of, rises),
            else DriveLaw::default()
        )
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
        each!(
            self, link, wants, found => |it, of, wants, found| {
                let (rises, held) = it.hold(&state.0, of, wants, found, mode, shares);
                (Either::One(rises), held)
            },
            {
                let (rises, held) = it.hold(&state.1, of, wants, found, mode, shares);
                (Either::Other(rises), held)
            },
            else (wants, Held::No)
        )
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
        each!(
            self, link, rises => |it, of, rises| {
                let (link, nearest) = it.impose(&state.0, of, rises, command.0, speed_m_s, bus_v);
                (Either::One(link), nearest.map(|nearest| (nearest, command.1)))
            },
            {
                let (link, nearest) = it.impose(&state.1, of, rises, command.1, speed_m_s, bus_v);
                (Either::Other(link), nearest.map(|nearest| (command.0, nearest)))
            },
            else (*link, None)
        )
    }
}
