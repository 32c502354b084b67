//! Drives that a vehicle's file chooses: each one of two kinds, told apart at run time.

use plant_core::machine::dc::DcDrive;
use plant_core::machine::pmsm::PmsmDrive;
use plant_core::machine::{Held, MachineFlows, Review, Seen};
use plant_core::mechanics::wheel::WheelParams;
use plant_core::port::{BusLaw, DriveLaw};
use plant_core::powertrain::drives::{Mode, Shares, Wishes};
use plant_core::powertrain::{Axles, Drive, Drives, DrivesParams};
use plant_core::{Dt, ParamError};

use crate::read::vehicle::DriveKind;

/// One of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Either<A, B> {
    /// The one.
    One(A),
    /// The other.
    Other(B),
}

/// A drive of either kind.
pub type AnyDrive = Either<Drive<DcDrive>, Drive<PmsmDrive>>;

/// The drive that a file describes.
///
/// # Errors
/// A parameter that is out of range.
pub fn axle(kind: DriveKind, wheel: WheelParams, dt: Dt) -> Result<Axles<AnyDrive>, ParamError> {
    match kind {
        DriveKind::Dc(params) => Ok(params.axles(wheel, dt)?.map(Either::One)),
        DriveKind::Pmsm(params) => Ok(params.axles(wheel, dt)?.map(Either::Other)),
    }
}

/// Asks the drive that it is; what belongs to it is of the same kind.
macro_rules! each {
    ($drive:expr, $link:expr, |$it:ident, $of:ident| $one:expr, $other:expr) => {
        match ($drive, $link) {
            (Either::One($it), Either::One($of)) => $one,
            (Either::Other($it), Either::Other($of)) => $other,
            _ => unreachable!("a drive does not change its kind"),
        }
    };
}

impl<A: Drives, B: Drives> Drives for Either<A, B> {
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

    fn command(&self, torque_nm: f32) -> Self::Command {
        match self {
            Self::One(it) => (it.command(torque_nm), B::Command::default()),
            Self::Other(it) => (A::Command::default(), it.command(torque_nm)),
        }
    }

    fn torque_share(&self) -> f32 {
        match self {
            Self::One(it) => it.torque_share(),
            Self::Other(it) => it.torque_share(),
        }
    }

    fn expected_n(&self, state: &Self::State, command: Self::Command) -> f32 {
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
            self,
            link,
            |it, of| {
                let (law, link) = it.law_again(&state.0, command.0, seen, of);
                (law, Either::One(link))
            },
            {
                let (law, link) = it.law_again(&state.1, command.1, seen, of);
                (law, Either::Other(link))
            }
        )
    }

    fn close(&self, link: Self::Link, rise_v: f32, dv: f32) -> Self::Link {
        each!(
            self,
            link,
            |it, of| Either::One(it.close(of, rise_v, dv)),
            Either::Other(it.close(of, rise_v, dv))
        )
    }

    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: f32, dv: f32) -> Review {
        each!(
            self,
            link,
            |it, of| it.review(&state.0, of, bus_v, dv),
            it.review(&state.1, of, bus_v, dv)
        )
    }

    fn settle(&self, state: &mut Self::State, link: &Self::Link) {
        each!(self, link, |it, of| it.settle(&mut state.0, of), it.settle(&mut state.1, of));
    }

    fn gear_n(&self, state: &Self::State) -> f32 {
        match self {
            Self::One(it) => it.gear_n(&state.0),
            Self::Other(it) => it.gear_n(&state.1),
        }
    }

    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: f32) -> Self::Output {
        each!(
            self,
            link,
            |it, of| Either::One(it.output(&state.0, of, speed_m_s)),
            Either::Other(it.output(&state.1, of, speed_m_s))
        )
    }

    fn torque_nm(&self, output: &Self::Output) -> f32 {
        each!(self, output, |it, of| it.torque_nm(of), it.torque_nm(of))
    }

    fn duty_and_current(output: &Self::Output) -> (f32, f32) {
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
        speed_m_s: f32,
    ) -> MachineFlows {
        each!(
            self,
            link,
            |it, of| it.flows(&before.0, &after.0, of, speed_m_s),
            it.flows(&before.1, &after.1, of, speed_m_s)
        )
    }

    fn flow_factors(&self) -> MachineFlows {
        match self {
            Self::One(it) => it.flow_factors(),
            Self::Other(it) => it.flow_factors(),
        }
    }

    fn field_j(&self, state: &Self::State) -> f32 {
        match self {
            Self::One(it) => it.field_j(&state.0),
            Self::Other(it) => it.field_j(&state.1),
        }
    }

    fn motor_rad_per_m(&self) -> f32 {
        match self {
            Self::One(it) => it.motor_rad_per_m(),
            Self::Other(it) => it.motor_rad_per_m(),
        }
    }

    fn is_clipped(link: &Self::Link) -> bool {
        match link {
            Either::One(of) => A::is_clipped(of),
            Either::Other(of) => B::is_clipped(of),
        }
    }

    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rises {
        each!(
            self,
            link,
            |it, of| Either::One(it.reached(&state.0, of, collapsed)),
            Either::Other(it.reached(&state.1, of, collapsed))
        )
    }

    fn within_winding(&self, state: &Self::State, rises: Self::Rises) -> Self::Rises {
        each!(
            self,
            rises,
            |it, of| Either::One(it.within_winding(&state.0, of)),
            Either::Other(it.within_winding(&state.1, of))
        )
    }

    fn wishes(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        speed_m_s: f32,
    ) -> Wishes {
        match (self, link, rises) {
            (Self::One(it), Either::One(of), Either::One(rises)) => {
                it.wishes(&state.0, of, rises, speed_m_s)
            }
            (Self::Other(it), Either::Other(of), Either::Other(rises)) => {
                it.wishes(&state.1, of, rises, speed_m_s)
            }
            _ => unreachable!("a drive does not change its kind"),
        }
    }

    fn force(&self, state: &Self::State, link: &Self::Link, rises: Self::Rises) -> DriveLaw {
        match (self, link, rises) {
            (Self::One(it), Either::One(of), Either::One(rises)) => it.force(&state.0, of, rises),
            (Self::Other(it), Either::Other(of), Either::Other(rises)) => {
                it.force(&state.1, of, rises)
            }
            _ => unreachable!("a drive does not change its kind"),
        }
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
        match (self, link, wants, found) {
            (Self::One(it), Either::One(of), Either::One(wants), Either::One(found)) => {
                let (rises, held) = it.hold(&state.0, of, wants, found, mode, shares);
                (Either::One(rises), held)
            }
            (Self::Other(it), Either::Other(of), Either::Other(wants), Either::Other(found)) => {
                let (rises, held) = it.hold(&state.1, of, wants, found, mode, shares);
                (Either::Other(rises), held)
            }
            _ => unreachable!("a drive does not change its kind"),
        }
    }

    fn impose(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        command: Self::Command,
        speed_m_s: f32,
        bus_v: f32,
    ) -> (Self::Link, Option<Self::Command>) {
        match (self, link, rises) {
            (Self::One(it), Either::One(of), Either::One(rises)) => {
                let (link, nearest) = it.impose(&state.0, of, rises, command.0, speed_m_s, bus_v);
                (Either::One(link), nearest.map(|nearest| (nearest, command.1)))
            }
            (Self::Other(it), Either::Other(of), Either::Other(rises)) => {
                let (link, nearest) = it.impose(&state.1, of, rises, command.1, speed_m_s, bus_v);
                (Either::Other(link), nearest.map(|nearest| (command.0, nearest)))
            }
            _ => unreachable!("a drive does not change its kind"),
        }
    }
}
