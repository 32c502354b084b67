//! Limits: they act on the commands, so both sides of the converters agree.
//!
//! Within a friction mode the speed is linear in the winding currents, and so are the windings'
//! voltages. The limits bound the power on the bus; each drive says which current, nearest to what it
//! wants, keeps its share ([`Machine::hold`](crate::machine::Machine::hold)). The currents give the
//! forces, these the speed, both the power, that the bus voltage, and all the commands. It is ours.
//!
//! Tests: those of the powertrain over many steps; property `limits`.

use super::drives::{Drives, Mode, Wishes};
use super::solve::{Loads, Walk};
use super::{Limited, Powertrain, PowertrainState};
use crate::battery::{CurrentLimits, Pack};
use crate::machine::{Held, Solved};
use crate::mechanics::body::{Motion, Resistance};
use crate::num::{LARGEST, Real, clamp, max, min, sqrt};
use crate::port::{Slip, Source};
use crate::powertrain::ledger::Book;

/// How often the friction mode may change while the currents are sought; there are three modes.
const TRIES: u32 = 3;
/// What flows beyond a limit counts as exceeding it from this share of the current on.
const EXCEEDED_REL: Real = 1e-3;
/// And from this much on \[A\].
const EXCEEDED_A: Real = 2e-3;

/// Of the current of a battery's greatest power, what a limit beyond it leaves: at the greatest
/// power itself a current does not follow from a power in single precision; here 99.9 % of it do.
const GREATEST: Real = 0.97;
/// The share of the voltage that is left there.
pub(super) const COLLAPSED: Real = 1.0 - 0.5 * GREATEST;

/// A step that keeps the limits, as far as commands can.
pub(super) struct Kept<K> {
    pub walk: Walk<K>,
    pub limited: Limited,
    pub starved: bool,
    /// What draws beside the drives; less where that is starved.
    pub loads: Loads,
    /// What flows beyond the battery's limits all the same \[A\].
    pub exceeded_a: Real,
}

impl<L: Book, B: Pack, D: Drives> Powertrain<L, B, D> {
    /// The step again, so that the limits are kept: the auxiliary loads are cut off where nothing
    /// feeds them, then the commands are held back.
    ///
    /// It takes values, not references: what is lent to a call lies in memory, in every step.
    #[cold]
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "see above")]
    pub(super) fn keep_limits(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        command: D::Command,
        asked: CurrentLimits,
        solved: Solved<D::Link>,
        mut loads: Loads,
        source: Source,
        resistance: Resistance,
    ) -> Kept<D::Link> {
        // Again, as what a call gets every step has to keep.
        let mut walk = self.reviewed(state, &loads, solved);
        let mut limits = self.battery.faded(&state.battery).within(asked);
        if limits.discharge_a < LARGEST {
            // No more than the source can give at all.
            let greatest_a = GREATEST * 0.5 * source.emf_v / source.resistance_ohm;
            limits.discharge_a = min(limits.discharge_a, greatest_a);
        }
        let bus = loads.leave(source);
        if !walk.review.fits {
            // Or a winding's own limit, where this changes nothing.
            walk = self.again(state, command, &walk.link, &loads, bus, &resistance);
        }
        let (mut walk, limited) =
            self.held(state, command, walk, &loads, source, bus, &resistance, limits);
        // The drives have given what they can; the loads get what is left.
        let starved =
            loads.current_a(bus.emf_v) > limits.discharge_a && walk.battery_a > limits.discharge_a;
        if starved {
            let link = &walk.link;
            let rises = self.drives.reached(&state.drives, link, false);
            let speed_m_s = state.body.speed_m_s.get();
            let motion = resistance.solve(self.drives.force(&state.drives, link, rises), speed_m_s);
            let ended_m_s = speed_m_s + motion.increment_m_s;
            let power_w = self.drives.wishes(&state.drives, link, rises, ended_m_s).power_w;
            let battery_v = source.voltage_v(limits.discharge_a);
            let share = (limits.discharge_a - power_w / battery_v) / loads.current_a(battery_v);
            loads = loads.times(clamp(share, 0.0, 1.0));
            let bus = loads.leave(source);
            if let Some(bus_v) = bus_v(bus, power_w) {
                let at = At { command, loads: &loads, bus, resistance: &resistance };
                walk = self.imposed(state, &walk, rises, motion, bus_v, &at);
            } else {
                walk = self.again(state, command, link, &loads, bus, &resistance);
            }
        }
        let over_a = max(walk.battery_a - limits.discharge_a, -walk.battery_a - limits.charge_a);
        let exceeded = over_a > EXCEEDED_REL * walk.battery_a.abs() + EXCEEDED_A;
        Kept { walk, loads, limited, starved, exceeded_a: if exceeded { over_a } else { 0.0 } }
    }

    #[expect(clippy::too_many_arguments, reason = "one step's values")]
    #[inline(always)]
    fn held(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        command: D::Command,
        walk: Walk<D::Link>,
        loads: &Loads,
        source: Source,
        bus: Source,
        resistance: &Resistance,
        limits: CurrentLimits,
    ) -> (Walk<D::Link>, Limited) {
        let link = &walk.link;
        let (lowest_w, mut highest_w) = drive_power_w(loads, source, limits);
        let v = state.body.speed_m_s.get();
        let half_v = 0.5 * bus.emf_v;
        let draws = walk.battery_a > limits.discharge_a || walk.battery_v < COLLAPSED * bus.emf_v;
        if !draws {
            highest_w = LARGEST;
        }
        // A duty beyond that of the greatest power asks for more and brings less.
        let collapsed = draws && walk.battery_v < half_v;
        let wants = self.drives.reached(&state.drives, link, collapsed);
        let carried = self.drives.within_winding(&state.drives, wants);
        let mut motion = walk.motion;
        let (mut rises, mut held) = (carried, Held::No);
        for pass in 1..=D::PASSES + TRIES {
            let slip = motion.slip;
            let mode =
                mode(resistance, v, slip, self.drives.force(&state.drives, link, rises).effort);
            let alone = D::PASSES == 1;
            let wishes = if alone {
                Wishes::default()
            } else {
                self.drives.wishes(&state.drives, link, carried, mode.ended_m_s())
            };
            let shares = wishes.shares(lowest_w, highest_w, bus.emf_v, bus.resistance_ohm, alone);
            (rises, held) = self.drives.hold(&state.drives, link, wants, rises, &mode, &shares);
            motion = resistance.solve(self.drives.force(&state.drives, link, rises), v);
            if motion.slip == slip && pass >= D::PASSES {
                break;
            }
        }
        if held == Held::No {
            return (walk, Limited::No);
        }
        let limited = match held {
            Held::Discharge => Limited::Discharge,
            Held::Charge => Limited::Charge,
            Held::Current | Held::No => Limited::Current,
        };
        let ended_m_s = v + motion.increment_m_s;
        let power_w = self.drives.wishes(&state.drives, link, rises, ended_m_s).power_w;
        // A d axis may take more than the battery has: then nothing makes these currents.
        let Some(bus_v) = bus_v(bus, power_w) else { return (walk, limited) };
        let at = At { command, loads, bus, resistance };
        (self.imposed(state, &walk, rises, motion, bus_v, &at), limited)
    }

    /// The step that makes these rises of the currents at this bus voltage; where a converter cannot
    /// make a voltage, what the nearest command leads to.
    fn imposed(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        walk: &Walk<D::Link>,
        rises: D::Rises,
        motion: Motion,
        bus_v: Real,
        at: &At<'_, D::Command>,
    ) -> Walk<D::Link> {
        let ended_m_s = state.body.speed_m_s.get() + motion.increment_m_s;
        let (link, nearest) =
            self.drives.impose(&state.drives, &walk.link, rises, at.command, ended_m_s, bus_v);
        match nearest {
            None => self.reviewed(state, at.loads, Solved { link, bus_v, motion }),
            Some(command) => {
                self.again(state, command, &walk.link, at.loads, at.bus, at.resistance)
            }
        }
    }

    /// The step under a command, where what the first supposed did not fit.
    fn again(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        command: D::Command,
        link: &D::Link,
        loads: &Loads,
        bus: Source,
        resistance: &Resistance,
    ) -> Walk<D::Link> {
        let seen = Self::seen(state, bus, resistance);
        let (law, link) = self.drives.law_again(&state.drives, command, seen, link);
        self.reviewed(state, loads, self.drives.closed(law, link, seen, bus, resistance))
    }
}

/// What a solution depends on beside its state.
struct At<'a, C> {
    command: C,
    loads: &'a Loads,
    bus: Source,
    resistance: &'a Resistance,
}

/// The voltage of a bus from which this power is taken, where it can be \[V\].
#[inline(always)]
fn bus_v(bus: Source, power_w: Real) -> Option<Real> {
    let half_v = 0.5 * bus.emf_v;
    let headroom = half_v * half_v - bus.resistance_ohm * power_w;
    if headroom < 0.0 {
        return None;
    }
    let bus_v = half_v + sqrt(headroom);
    // Loads alone may want more than there is.
    if bus_v > 0.0 { Some(bus_v) } else { None }
}

/// How the road answers in a friction mode.
#[inline(always)]
fn mode(resistance: &Resistance, speed_m_s: Real, slip: Slip, force_n: Real) -> Mode {
    if slip == Slip::Stuck {
        return Mode { coasting_m_s: 0.0, mobility: 0.0, force_n };
    }
    let mobility = 1.0 / resistance.slope_n_s_per_m;
    let coasting_n = resistance.force_n - slip.sign() * resistance.friction_n;
    Mode { coasting_m_s: speed_m_s + coasting_n * mobility, mobility, force_n }
}

/// The lowest and the highest power that the drives may take from the bus \[W\].
#[inline(always)]
fn drive_power_w(loads: &Loads, source: Source, limits: CurrentLimits) -> (Real, Real) {
    let charging_v = source.voltage_v(-limits.charge_a);
    let fed_a = limits.charge_a + loads.current_a(charging_v);
    let drawing_v = source.voltage_v(limits.discharge_a);
    let left_a = max(limits.discharge_a - loads.current_a(drawing_v), 0.0);
    (-fed_a * charging_v, left_a * drawing_v)
}
