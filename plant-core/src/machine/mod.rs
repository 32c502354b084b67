//! Electric machines, alone and behind a converter, and what turns three phases into one vector.
//!
//! A machine joins the [coupled plant](crate::powertrain) by the trait [`Machine`].

mod axis;
pub mod dc;
pub mod flux;
pub mod heated;
pub mod pmsm;
pub mod transform;

use crate::converter::Gates;
use crate::mechanics::body::{Motion, Resistance};
use crate::num::{Real, max, min};
use crate::port::{BusLaw, DriveLaw, Source};

/// What a machine sees when a step begins.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Voltage of the bus if no drive draws from it \[V\].
    pub bus_v: Real,
    /// Its voltage in the last step \[V\], from which the laws count.
    pub from_v: Real,
    /// Speed of the road \[m/s\].
    pub speed_m_s: Real,
    /// How the road will answer to a force.
    pub footing: Footing,
}

/// A solution of one step: the machines' links, the bus voltage \[V\], the road.
#[derive(Clone, Copy, Debug)]
pub struct Solved<K> {
    /// What the walk back needs.
    pub link: K,
    /// Voltage of the bus \[V\].
    pub bus_v: Real,
    /// What the body does.
    pub motion: Motion,
}

impl Solved<()> {
    /// What a law leads to on a bus: one equation.
    #[inline(always)]
    #[must_use]
    pub const fn of(law: BusLaw, seen: Seen, bus: Source, resistance: &Resistance) -> Self {
        let (drive, rise) = law.on(bus, seen.from_v);
        let motion = resistance.solve(drive, seen.speed_m_s);
        Self { link: (), bus_v: seen.from_v + rise.at(motion.increment_m_s), motion }
    }
}

/// What a solution would lead to, before it is booked.
#[derive(Clone, Copy, Debug, Default)]
pub struct Review {
    /// Current drawn from the bus \[A\].
    pub bus_a: Real,
    /// Power into the field of the axis that makes the torque \[W\]: once it has grown, the bus is
    /// charged with so much more.
    pub field_w: Real,
    /// The winding keeps its own limit, and what was supposed of diodes and drops holds.
    pub fits: bool,
    /// The sum of the magnitudes of what would enter the state.
    pub magnitude: Real,
}

/// The losses and conversions of a machine that the energy ledger names, as powers \[W\] or what
/// they are proportional to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MachineFlows {
    /// Loss of the converter that depends on the load.
    pub converter: Real,
    /// Heat in the winding.
    pub copper: Real,
    /// What a parameter set with Ke ≠ Kt takes from one side and does not give to the other.
    pub conversion: Real,
    /// Heat in the iron.
    pub iron: Real,
    /// Into the field.
    pub field: Real,
    /// What the step dissipates in the field.
    pub numerical: Real,
}

impl MachineFlows {
    /// One for each term.
    pub const ONES: Self = Self {
        converter: 1.0,
        copper: 1.0,
        conversion: 1.0,
        iron: 1.0,
        field: 1.0,
        numerical: 1.0,
    };

    /// Term by term.
    #[inline(always)]
    #[must_use]
    pub const fn times(&self, factors: &Self) -> Self {
        Self {
            converter: self.converter * factors.converter,
            copper: self.copper * factors.copper,
            conversion: self.conversion * factors.conversion,
            iron: self.iron * factors.iron,
            field: self.field * factors.field,
            numerical: self.numerical * factors.numerical,
        }
    }
}

impl core::ops::Add for MachineFlows {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            converter: self.converter + other.converter,
            copper: self.copper + other.copper,
            conversion: self.conversion + other.conversion,
            iron: self.iron + other.iron,
            field: self.field + other.field,
            numerical: self.numerical + other.numerical,
        }
    }
}

/// How warm a drive is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Temperatures {
    /// The machine, its winding included \[°C\].
    pub machine_c: Real,
    /// The inverter \[°C\].
    pub inverter_c: Real,
    /// What both leave of the current limit, 0..1.
    pub left: Real,
}

impl Temperatures {
    /// Of two drives, the warmer parts and the less that is left.
    #[must_use]
    pub const fn worse(self, other: Self) -> Self {
        Self {
            machine_c: max(self.machine_c, other.machine_c),
            inverter_c: max(self.inverter_c, other.inverter_c),
            left: min(self.left, other.left),
        }
    }
}

/// How the road answers a drive within one step, the other drives given.
#[derive(Clone, Copy, Debug)]
pub struct Footing {
    /// The speed at the end of the step without this drive's force \[m/s\].
    pub speed_m_s: Real,
    /// The speed that its force adds \[m/(s·N)\]; 0 where friction holds.
    pub mobility: Real,
}

/// The powers of a machine at the bus for given winding currents \[W\].
#[derive(Clone, Copy, Debug, Default)]
pub struct Wish {
    /// Over the step that leads to them.
    pub now_w: Real,
    /// Once they are held.
    pub held_w: Real,
}

/// The power that a machine may take from the bus, and what the bus is.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// At least \[W\], ≤ 0.
    pub lowest_w: Real,
    /// At most \[W\], ≥ 0.
    pub highest_w: Real,
    /// Voltage of the bus if no drive draws from it \[V\].
    pub bus_v: Real,
    /// How much a current of the bus lowers it \[Ω\].
    pub bus_ohm: Real,
}

/// A machine behind its converter, seen from the road: what the coupled plant asks of it.
///
/// Every step goes down once ([`law`](Self::law)), checks the solution ([`review`](Self::review)) and
/// comes back ([`settle`](Self::settle)). Where a limit acts, the machine says which current comes
/// nearest to its wish ([`hold`](Self::hold)), and [`impose`](Self::impose) makes it.
pub trait Machine: Copy {
    /// What it remembers: the winding's current; none by default.
    type State: Copy + Default;
    /// What its converter modulates with.
    type Modulation: Copy;
    /// What a step adds to the winding's current \[A\].
    type Rise: Copy;
    /// What the walk down leaves for the walk back.
    type Link: Copy;
    /// What a step says of it.
    type Output: Copy;
    /// Iron and field have terms of their own in the ledger.
    const THREE_PHASE: bool = false;

    /// Down the chain: the step under a command. With gates off, that the diodes block is only
    /// supposed; [`review`](Self::review) says whether they do.
    fn law(
        &self,
        state: &Self::State,
        gates: Gates<Self::Modulation>,
        seen: Seen,
    ) -> (BusLaw, Self::Link);
    /// The force that a command is about to make at the road \[N\].
    fn expected_n(&self, state: &Self::State, gates: Gates<Self::Modulation>) -> Real;
    /// The step again where a solution did not fit: diodes conduct that were supposed to block, or a
    /// drop would drive a current.
    fn law_again(
        &self,
        state: &Self::State,
        gates: Gates<Self::Modulation>,
        seen: Seen,
        link: &Self::Link,
    ) -> (BusLaw, Self::Link);
    /// The rise of the current, once those of bus voltage and speed are known.
    fn close(&self, link: Self::Link, rise_v: Real, dv: Real) -> Self::Link;
    /// All of this for a machine that has the bus for itself.
    #[inline(always)]
    fn solve(
        &self,
        state: &Self::State,
        gates: Gates<Self::Modulation>,
        seen: Seen,
        bus: Source,
        resistance: &Resistance,
    ) -> Solved<Self::Link> {
        let (law, link) = self.law(state, gates, seen);
        let solved = Solved::of(law, seen, bus, resistance);
        let link = self.close(link, solved.bus_v - seen.from_v, solved.motion.increment_m_s);
        Solved { link, bus_v: solved.bus_v, motion: solved.motion }
    }
    /// What a solution leads to.
    fn review(&self, state: &Self::State, link: &Self::Link, bus_v: Real, dv: Real) -> Review;
    /// Back: books a solution.
    fn settle(&self, state: &mut Self::State, link: &Self::Link);
    /// The force of its current at the road \[N\].
    fn force_n(&self, state: &Self::State) -> Real;
    /// What a step says, after it was booked.
    fn output(&self, state: &Self::State, link: &Self::Link, speed_m_s: Real) -> Self::Output;
    /// The torque at the end of a step \[N·m\].
    fn torque_nm(output: &Self::Output) -> Real;
    /// Duty and winding current \[A\]; of three phases the lengths of both.
    fn duty_and_current(output: &Self::Output) -> (Real, Real);
    /// What the ledger books, without the factors.
    fn flows(
        &self,
        before: &Self::State,
        after: &Self::State,
        link: &Self::Link,
        speed_m_s: Real,
    ) -> MachineFlows;
    /// What the ledger's powers are to be multiplied by.
    fn flow_factors(&self) -> MachineFlows;
    /// Energy in the field \[J\], where the ledger counts it as stored.
    fn field_j(&self, state: &Self::State) -> Real;
    /// Motor speed per road speed \[rad/m\].
    fn motor_rad_per_m(&self) -> Real;

    /// How warm it is, where it has temperatures.
    #[inline(always)]
    #[must_use]
    fn temperatures(_output: &Self::Output) -> Option<Temperatures> {
        None
    }

    /// Whether the converter changed the command.
    fn is_clipped(link: &Self::Link) -> bool;
    /// Whether a temperature holds a commanded torque back.
    #[inline(always)]
    #[must_use]
    fn is_derated(_link: &Self::Link) -> bool {
        false
    }
    /// What a solution adds to the winding's current; where it pulls the bus down beyond the
    /// battery's greatest power (`collapsed`), as much as can be in that direction.
    fn reached(&self, state: &Self::State, link: &Self::Link, collapsed: bool) -> Self::Rise;
    /// The nearest that the winding may carry.
    fn within_winding(&self, state: &Self::State, rise: Self::Rise) -> Self::Rise;
    /// The powers that it takes, the speed at the end of the step being `speed_m_s`.
    fn wish(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rise: Self::Rise,
        speed_m_s: Real,
    ) -> Wish;
    /// What it does at the road.
    fn force(&self, state: &Self::State, link: &Self::Link, rise: Self::Rise) -> DriveLaw;
    /// The rise nearest to `want` that keeps the winding's limit and the bounds.
    fn hold(
        &self,
        state: &Self::State,
        link: &Self::Link,
        want: Self::Rise,
        footing: Footing,
        bounds: &Bounds,
    ) -> (Self::Rise, Held);
    /// The step that makes a rise: its link, and, where the converter cannot make the
    /// voltage, the command that comes nearest.
    fn impose(
        &self,
        state: &Self::State,
        link: &Self::Link,
        rise: Self::Rise,
        speed_m_s: Real,
        bus_v: Real,
    ) -> (Self::Link, Option<Gates<Self::Modulation>>);
}

/// What held a current back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Held {
    /// Nothing.
    #[default]
    No,
    /// The winding's own limit.
    Current,
    /// The bus may not be charged more.
    Charge,
    /// The bus may not be discharged more.
    Discharge,
}
