//! Drives: a machine with its converter and its gearbox, one or several on one battery and one road.
//!
//! Laws add, so two drives are a drive; pairs nest. Where a limit acts, what the bus may be charged
//! with, or give, is shared in proportion to what each wants.
//!
//! Tests: those of the powertrain; property `drives`.

use crate::converter::{ConverterParams, Gates};
use crate::error::{ParamError, check, positive};
use crate::machine::dc::{DcDrive, DcMotor, DcMotorParams};
use crate::machine::pmsm::{Pmsm, PmsmDrive, PmsmParams};
use crate::machine::{Bounds, Footing, Held, Machine, MachineFlows, Review, Seen, Solved, Wish};
use crate::mechanics::body::Resistance;
use crate::mechanics::gearbox::{Gearbox, GearboxParams};
use crate::mechanics::wheel::{Wheel, WheelParams};
use crate::model::Dt;
use crate::num::{Real, max, min};
use crate::port::{BusLaw, Coast, DriveLaw, Source};

/// Parameters of a drive; `M` are those of its machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DriveParams<M = DcMotorParams> {
    /// The converter.
    #[cfg_attr(feature = "serde", serde(default))]
    pub converter: ConverterParams,
    /// The machine.
    pub motor: M,
    /// The gearbox.
    pub gearbox: GearboxParams,
    /// Bandwidth of the ideal current loop behind [`Gates::Torque`] \[1/s\], above zero.
    #[cfg_attr(feature = "serde", serde(default = "default_torque_rate"))]
    pub torque_rate_per_s: Real,
    /// Of a driver's demand this drive takes its share, in proportion to those of the others, above
    /// zero.
    #[cfg_attr(feature = "serde", serde(default = "default_share"))]
    pub torque_share: Real,
}

/// Of a current loop as drives have it: 80 Hz \[1/s\].
pub const TORQUE_RATE_PER_S: Real = 500.0;

#[cfg(feature = "serde")]
fn default_torque_rate() -> Real {
    TORQUE_RATE_PER_S
}

#[cfg(feature = "serde")]
fn default_share() -> Real {
    1.0
}

impl<M> DriveParams<M> {
    /// A machine behind an ideal converter and a gearbox.
    #[must_use]
    pub const fn new(motor: M, gearbox: GearboxParams) -> Self {
        Self {
            converter: ConverterParams::IDEAL,
            motor,
            gearbox,
            torque_rate_per_s: TORQUE_RATE_PER_S,
            torque_share: 1.0,
        }
    }
}

/// A machine with its converter and its gearbox at the road, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<M = DcDrive> {
    machine: M,
    /// Loss of the gears as friction at the road, per force.
    gear_loss: Real,
    torque_share: Real,
}

/// Drives on one road with what they add to all that moves and rubs there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axles<D> {
    pub(super) drives: D,
    /// At the shaft of the wheels.
    pub(super) coast: Coast,
    pub(super) has_gear_loss: bool,
    /// Losses of the converters that do not depend on their load \[W\].
    pub(super) constant_loss_w: Real,
}

impl<D: Copy> Axles<D> {
    /// These drives and others on the same road.
    #[must_use]
    pub const fn and<E: Copy>(self, others: Axles<E>) -> Axles<(D, E)> {
        Axles {
            drives: (self.drives, others.drives),
            coast: self.coast.plus(others.coast),
            has_gear_loss: self.has_gear_loss || others.has_gear_loss,
            constant_loss_w: self.constant_loss_w + others.constant_loss_w,
        }
    }
}

impl<D> Axles<D> {
    /// The same axles, their drives told apart otherwise, as where a file says which there are.
    #[must_use]
    pub fn map<E>(self, drives: impl FnOnce(D) -> E) -> Axles<E> {
        Axles {
            drives: drives(self.drives),
            coast: self.coast,
            has_gear_loss: self.has_gear_loss,
            constant_loss_w: self.constant_loss_w,
        }
    }
}

/// What a drive is made of beside its machine.
struct Chain {
    converter: ConverterParams,
    gearbox: Gearbox,
    /// Motor turns (rad) per metre of road.
    motor_rad_per_m: Real,
}

impl Chain {
    const fn new(
        converter: ConverterParams,
        gearbox: GearboxParams,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let gearbox = check!(Gearbox::new(gearbox, dt));
        let wheel = check!(Wheel::new(wheel, dt));
        Ok(Self { converter, gearbox, motor_rad_per_m: gearbox.ratio * wheel.per_radius })
    }

    const fn axles<M: Copy>(
        &self,
        machine: M,
        shaft: Coast,
        torque_share: Real,
    ) -> Axles<Drive<M>> {
        let gear_loss = self.gearbox.loss_ratio() / self.gearbox.ratio;
        Axles {
            drives: Drive { machine, gear_loss, torque_share },
            coast: self.gearbox.coast(shaft),
            has_gear_loss: self.gearbox.loss_ratio() > 0.0,
            constant_loss_w: self.converter.constant_loss_w,
        }
    }
}

impl DriveParams<DcMotorParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(self, wheel: WheelParams, dt: Dt) -> Result<Axles<Drive<DcDrive>>, ParamError> {
        let chain = check!(Chain::new(self.converter, self.gearbox, wheel, dt));
        let rate = check!(positive("drive.torque_rate_per_s", self.torque_rate_per_s));
        let motor = check!(DcMotor::new(self.motor, dt));
        let machine =
            check!(DcDrive::new(&self.motor, self.converter, rate, chain.motor_rad_per_m, dt));
        let share = check!(positive("drive.torque_share", self.torque_share));
        Ok(chain.axles(machine, motor.coast(), share))
    }
}

impl DriveParams<PmsmParams> {
    /// Checks the parameters and discretises them for steps of `dt` of a vehicle on these wheels.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn on(
        self,
        wheel: WheelParams,
        dt: Dt,
    ) -> Result<Axles<Drive<PmsmDrive>>, ParamError> {
        let chain = check!(Chain::new(self.converter, self.gearbox, wheel, dt));
        let rate = check!(positive("drive.torque_rate_per_s", self.torque_rate_per_s));
        let share = check!(positive("drive.torque_share", self.torque_share));
        let motor = check!(Pmsm::new(self.motor, dt));
        let ratio = chain.motor_rad_per_m;
        let machine = check!(PmsmDrive::new(&self.motor, self.converter, rate, ratio, dt));
        Ok(chain.axles(machine, motor.coast(), share))
    }
}

/// What a set of limits leaves to each drive.
#[derive(Clone, Copy, Debug)]
pub struct Shares {
    /// There is one drive.
    alone: bool,
    wishes: Wishes,
    /// What all together may take from the bus, at least and at most \[W\].
    lowest_w: Real,
    highest_w: Real,
    /// Voltage of the bus if no drive draws from it \[V\].
    bus_v: Real,
    /// How much a current lowers it \[Ω\].
    bus_ohm: Real,
}

/// What all drives want from the bus \[W\].
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_field_names, reason = "the unit")]
pub struct Wishes {
    /// The sum over the step, and, where that is less, once held.
    pub(super) power_w: Real,
    least_w: Real,
    /// What those draw, and feed (≤ 0), that do.
    draws_w: Real,
    feeds_w: Real,
}

impl core::ops::Add for Wishes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            power_w: self.power_w + other.power_w,
            least_w: self.least_w + other.least_w,
            draws_w: self.draws_w + other.draws_w,
            feeds_w: self.feeds_w + other.feeds_w,
        }
    }
}

impl From<Wish> for Wishes {
    fn from(wish: Wish) -> Self {
        let least_w = min(wish.now_w, wish.held_w);
        Self {
            power_w: wish.now_w,
            least_w,
            draws_w: max(wish.now_w, 0.0),
            feeds_w: min(least_w, 0.0),
        }
    }
}

impl Wishes {
    /// What is left to each where all together may take from `lowest_w` to `highest_w`.
    pub(super) const fn shares(
        self,
        lowest_w: Real,
        highest_w: Real,
        bus_v: Real,
        bus_ohm: Real,
        alone: bool,
    ) -> Shares {
        Shares { alone, wishes: self, lowest_w, highest_w, bus_v, bus_ohm }
    }
}

impl Shares {
    /// For one drive: all.
    const fn all(&self) -> Bounds {
        Bounds {
            lowest_w: self.lowest_w,
            highest_w: self.highest_w,
            bus_v: self.bus_v,
            bus_ohm: self.bus_ohm,
        }
    }

    /// Those that feed, or draw, too much share what there is in proportion to it; what is left over
    /// anyone may have.
    fn bounds(&self, wish: Wish) -> Bounds {
        let (all, own) = (&self.wishes, Wishes::from(wish));
        let lowest_w = if all.least_w < self.lowest_w {
            (self.lowest_w - (all.least_w - all.feeds_w)) * (own.feeds_w / all.feeds_w)
        } else {
            self.lowest_w - (all.least_w - own.least_w)
        };
        let highest_w = if all.power_w > self.highest_w {
            (self.highest_w - (all.power_w - all.draws_w)) * (own.draws_w / all.draws_w)
        } else {
            self.highest_w - (all.power_w - own.power_w)
        };
        Bounds {
            lowest_w: min(lowest_w, 0.0),
            highest_w: max(highest_w, 0.0),
            bus_v: self.bus_v,
            bus_ohm: self.bus_ohm,
        }
    }
}

/// How the road answers all drives in one friction mode.
#[derive(Clone, Copy, Debug)]
pub struct Mode {
    /// Speed at the end of the step if no drive made a force \[m/s\].
    pub coasting_m_s: Real,
    /// Speed that a force adds \[m/(s·N)\]; 0 where friction holds.
    pub mobility: Real,
    /// What all drives make of it \[N\].
    pub force_n: Real,
}

impl Mode {
    /// The speed at the end of the step \[m/s\].
    pub(super) const fn ended_m_s(&self) -> Real {
        self.coasting_m_s + self.mobility * self.force_n
    }
}

/// One drive or several: what the coupled plant asks of all together. See [`Machine`].
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

    /// See [`Machine::law`].
    fn law(&self, state: &Self::State, command: Self::Command, seen: Seen) -> (BusLaw, Self::Link);
    /// The command for a torque of all, as felt at the shaft of the first motor \[N·m\]: each takes
    /// its share.
    fn command(&self, torque_nm: Real) -> Self::Command;
    /// What the shares refer to.
    fn torque_share(&self) -> Real;
    /// See [`Machine::expected_n`].
    fn expected_n(&self, state: &Self::State, command: Self::Command) -> Real;
    /// See [`Machine::law_again`].
    fn law_again(
        &self,
        state: &Self::State,
        command: Self::Command,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link);
    /// See [`Machine::close`].
    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link;
    /// See [`Machine::solve`].
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
    /// See [`Machine::review`].
    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review;
    /// See [`Machine::settle`].
    fn settle(&self, state: &mut Self::State, link: &Self::Link);
    /// Friction of the gears at the road \[N\].
    fn gear_n(&self, state: &Self::State) -> Real;
    /// See [`Machine::output`].
    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output;
    /// All torques, as felt at the shaft of the first motor \[N·m\].
    fn torque_nm(&self, output: &Self::Output) -> Real;
    /// See [`Machine::duty_and_current`]; of several drives, those of the first.
    fn duty_and_current(output: &Self::Output) -> (Real, Real);
    /// See [`Machine::flows`].
    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows;
    /// See [`Machine::flow_factors`].
    fn flow_factors(&self) -> MachineFlows;
    /// See [`Machine::field_j`].
    fn field_j(&self, state: &Self::State) -> Real;
    /// Of the first motor; see [`Machine::motor_rad_per_m`].
    fn motor_rad_per_m(&self) -> Real;
    /// Whether a converter changed its command.
    fn is_clipped(link: &Self::Link) -> bool;
    /// See [`Machine::reached`].
    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rises;
    /// See [`Machine::within_winding`].
    fn within_winding(&self, state: &Self::State, rises: Self::Rises) -> Self::Rises;
    /// See [`Machine::wish`].
    fn wishes(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rises: Self::Rises,
        speed_m_s: Real,
    ) -> Wishes;
    /// See [`Machine::force`].
    fn force(&self, state: &Self::State, link: &Self::Link, rises: Self::Rises) -> DriveLaw;
    /// See [`Machine::hold`]: `wants` held to its share, given what the last pass found.
    fn hold(
        &self,
        state: &Self::State,
        link: &Self::Link,
        wants: Self::Rises,
        found: Self::Rises,
        mode: &Mode,
        shares: &Shares,
    ) -> (Self::Rises, Held);
    /// See [`Machine::impose`]; the commands where one cannot be imposed.
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
    fn is_clipped(link: &M::Link) -> bool {
        M::is_clipped(link)
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

    fn hold(
        &self,
        state: &M::State,
        link: &M::Link,
        want: M::Rise,
        found: M::Rise,
        mode: &Mode,
        shares: &Shares,
    ) -> (M::Rise, Held) {
        let others_n = mode.force_n - self.machine.force(state, link, found).effort;
        let footing = Footing {
            speed_m_s: mode.coasting_m_s + mode.mobility * others_n,
            mobility: mode.mobility,
        };
        let bounds = if shares.alone {
            shares.all()
        } else {
            let carried = self.machine.within_winding(state, want);
            shares.bounds(self.machine.wish(state, link, carried, mode.ended_m_s()))
        };
        self.machine.hold(state, link, want, footing, &bounds)
    }

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
    fn is_clipped(link: &Self::Link) -> bool {
        A::is_clipped(&link.0) || B::is_clipped(&link.1)
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
