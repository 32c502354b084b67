//! Drives: a machine with its converter and its gearbox, one or several on one battery and one road.
//!
//! Laws add, so two drives are a drive; pairs nest. Where a limit acts, what the bus may be charged
//! with, or give, is shared in proportion to what each wants.
//!
//! Tests: those of the powertrain; property `drives`.

mod axles;
mod either;
mod heated;
mod pair;
mod shares;
mod single;

pub use axles::{Axles, Drive, DriveParams, TORQUE_RATE_PER_S};
pub use either::Either;
pub use heated::HeatedDriveParams;
pub use shares::{Mode, Shares, Wishes};

use crate::machine::{Held, MachineFlows, Review, Seen, Solved, Temperatures};
use crate::mechanics::body::Resistance;
use crate::num::Real;
use crate::port::{BusLaw, DriveLaw, Source};

/// One drive or several: what the coupled plant asks of all together. See [`Machine`](crate::machine::Machine).
pub trait Drives: Copy {
    /// What the converters are told; gates off by default.
    type Command: Copy + Default;
    /// What the windings remember; no current by default.
    type State: Copy + Default;
    /// What the walk down leaves for the walk back.
    type Link: Copy;
    /// What a step adds to the windings' currents.
    type Rises: Copy;
    /// What a step says of them.
    type Output: Copy;
    /// How often the currents within a limit are sought: the drives move one another's road. Once
    /// where there is one, which has the bus for itself.
    const PASSES: u32;
    /// One of them has three phases.
    const THREE_PHASE: bool;

    /// See [`Machine::law`](crate::machine::Machine::law).
    fn law(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (BusLaw, Self::Link);
    /// The command for a torque of all, as felt at the shaft of the first motor \[N·m\]: each takes
    /// its share.
    fn command(&self, torque_nm: Real) -> Self::Command;
    /// What the shares refer to.
    fn torque_share(&self) -> Real;
    /// See [`Machine::expected_n`](crate::machine::Machine::expected_n).
    fn expected_n(&self, state: &Self::State, command: Self::Command) -> Real;
    /// See [`Machine::law_again`](crate::machine::Machine::law_again).
    fn law_again(
        &self,
        state: &Self::State,
        command: Self::Command,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link);
    /// See [`Machine::close`](crate::machine::Machine::close).
    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link;
    /// See [`Machine::solve`](crate::machine::Machine::solve).
    #[inline(always)]
    fn solve(
        &self,
        state: &Self::State,
        command: Self::Command,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<Self::Link> {
        let (law, link) = self.law(state, command, seen);
        self.closed(law, link, seen, bus, resistance)
    }
    /// A law solved and closed.
    #[inline(always)]
    fn closed(
        &self,
        law: BusLaw,
        link: Self::Link,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<Self::Link> {
        let Solved { bus_v, motion, .. } = Solved::of(law, seen, bus, resistance);
        let link = self.close(link, bus_v - seen.from_v, motion.increment_m_s);
        Solved { link, bus_v, motion }
    }
    /// See [`Machine::review`](crate::machine::Machine::review).
    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review;
    /// See [`Machine::settle`](crate::machine::Machine::settle).
    fn settle(&self, state: &mut Self::State, link: &Self::Link);
    /// Friction of the gears at the road \[N\].
    fn gear_n(&self, state: &Self::State) -> Real;
    /// See [`Machine::output`](crate::machine::Machine::output).
    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output;
    /// All torques, as felt at the shaft of the first motor \[N·m\].
    fn torque_nm(&self, output: &Self::Output) -> Real;
    /// See [`Machine::duty_and_current`](crate::machine::Machine::duty_and_current); of several drives, those of the first.
    fn duty_and_current(output: &Self::Output) -> (Real, Real);
    /// See [`Machine::flows`](crate::machine::Machine::flows).
    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows;
    /// See [`Machine::flow_factors`](crate::machine::Machine::flow_factors).
    fn flow_factors(&self) -> MachineFlows;
    /// See [`Machine::field_j`](crate::machine::Machine::field_j).
    fn field_j(&self, state: &Self::State) -> Real;
    /// Of the first motor; see [`Machine::motor_rad_per_m`](crate::machine::Machine::motor_rad_per_m).
    fn motor_rad_per_m(&self) -> Real;
    /// How warm they are, those that have temperatures; of several the warmest parts.
    fn temperatures(output: &Self::Output) -> Option<Temperatures>;
    /// Whether a converter changed its command.
    fn is_clipped(link: &Self::Link) -> bool;
    /// See [`Machine::is_derated`](crate::machine::Machine::is_derated).
    fn is_derated(link: &Self::Link) -> bool;
    /// See [`Machine::reached`](crate::machine::Machine::reached).
    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rises;
    /// See [`Machine::within_winding`](crate::machine::Machine::within_winding).
    fn within_winding(&self, state: &Self::State, rises: Self::Rises) -> Self::Rises;
    /// See [`Machine::wish`](crate::machine::Machine::wish).
    fn wishes(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        speed_m_s: Real,
    ) -> Wishes;
    /// See [`Machine::force`](crate::machine::Machine::force).
    fn force(&self, state: &Self::State, link: &Self::Link, rises: Self::Rises) -> DriveLaw;
    /// See [`Machine::hold`](crate::machine::Machine::hold): `wants` held to its share, given what the last pass found.
    fn hold(
        &self,
        state: &Self::State,
        link: &Self::Link,
        wants: Self::Rises,
        found: Self::Rises,
        mode: &Mode,
        shares: &Shares,
    ) -> (Self::Rises, Held);
    /// See [`Machine::impose`](crate::machine::Machine::impose); the commands where one cannot be imposed.
    fn impose(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        command: Self::Command,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (Self::Link, Option<Self::Command>);
}
