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

/// From what share of it on a power is the highest: there the battery gives its limit, and the bus
/// has the voltage that belongs to it.
const AT_LIMIT: Real = 1e-5;

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
    /// How much of what draws beside the drives is left to it.
    pub share: Real,
    /// What flows beyond the battery's limits all the same \[A\].
    pub exceeded_a: Real,
}

impl<L: Book, B: Pack, D: Drives> Powertrain<L, B, D> {
    /// The step again, so that the limits are kept: the commands are held back, then the auxiliary
    /// loads are cut off where nothing feeds them.
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
        mut solved: Solved<D::Link>,
        mut loads: Loads,
        source: Source,
        resistance: Resistance,
    ) -> Kept<D::Link> {
        let mut limits = self.battery.faded(&state.battery).within(asked);
        if limits.discharge_a < LARGEST {
            // No more than the source can give at all.
            let greatest_a = GREATEST * 0.5 * source.emf_v / source.resistance_ohm;
            limits.discharge_a = min(limits.discharge_a, greatest_a);
        }
        let mut bus = loads.leave(source);
        let mut walk = self.reviewed(state, &loads, solved);
        if !walk.review.fits {
            // Or a winding's own limit, where this changes nothing.
            solved = self.again(state, command, solved.link, bus, resistance);
            walk = self.reviewed(state, &loads, solved);
        }
        let v = state.body.speed_m_s.get();
        let drawing_v = source.voltage_v(limits.discharge_a);
        let (lowest_w, mut highest_w) = drive_power_w(&loads, source, limits, drawing_v);
        let draws = walk.battery_a > limits.discharge_a || walk.battery_v < COLLAPSED * bus.emf_v;
        if !draws {
            highest_w = LARGEST;
        }
        // A duty beyond that of the greatest power asks for more and brings less.
        let collapsed = draws && walk.battery_v < 0.5 * bus.emf_v;
        let wants = self.drives.reached(&state.drives, &solved.link, collapsed);
        let carried = self.drives.within_winding(&state.drives, wants);
        let sought = Sought { wants, carried, lowest_w, highest_w };
        let slip = solved.motion.slip;
        let (mut rises, mut held, mut motion) =
            self.seek(state, &solved.link, &sought, carried, slip, bus, &resistance);
        if D::PASSES > 1 || motion.slip != slip {
            let found = (rises, motion.slip);
            let sought = Sought { ..sought };
            (rises, held, motion) =
                self.seek_on(state, solved.link, sought, found, bus, resistance);
        }
        let limited = match held {
            Held::No => Limited::No,
            Held::Discharge => Limited::Discharge,
            Held::Charge => Limited::Charge,
            Held::Current => Limited::Current,
        };
        // The loads alone may draw more than there is, unless the drives feed them.
        let mut starves = loads.current_a(bus.emf_v) > limits.discharge_a;
        let mut share = 1.0;
        if held != Held::No || starves && walk.battery_a > limits.discharge_a {
            let ended_m_s = v + motion.increment_m_s;
            let power_w = self.drives.wishes(&state.drives, &solved.link, rises, ended_m_s).power_w;
            if starves {
                // The drives have given what they can; the loads get what is left.
                let left_a = limits.discharge_a - power_w / drawing_v;
                share = clamp(left_a / loads.current_a(drawing_v), 0.0, 1.0);
                starves = share < 1.0;
                loads = loads.times(share);
                bus = loads.leave(source);
            }
            let at_limit = starves && share > 0.0
                || D::PASSES == 1
                    && held == Held::Discharge
                    && (power_w - highest_w).abs() <= AT_LIMIT * highest_w;
            // A d axis may take more than the battery has: then nothing makes these currents.
            let bus_v = if at_limit { Some(drawing_v) } else { bus_v(bus, power_w) };
            let mut nearest = Some(command);
            if let Some(bus_v) = bus_v {
                let link;
                (link, nearest) = self.drives.impose(
                    &state.drives,
                    &solved.link,
                    rises,
                    command,
                    ended_m_s,
                    bus_v,
                );
                walk = self.reviewed(state, &loads, Solved { link, bus_v, motion });
            }
            // Where a converter cannot make a voltage: what the nearest command leads to.
            if let Some(command) = nearest
                && (bus_v.is_some() || starves)
            {
                let solved = self.again(state, command, solved.link, bus, resistance);
                walk = self.reviewed(state, &loads, solved);
            }
        } else {
            starves = false;
        }
        let over_a = max(walk.battery_a - limits.discharge_a, -walk.battery_a - limits.charge_a);
        let exceeded = over_a > EXCEEDED_REL * walk.battery_a.abs() + EXCEEDED_A;
        let exceeded_a = if exceeded { over_a } else { 0.0 };
        Kept { walk, limited, starved: starves, share, exceeded_a }
    }

    /// The rises of the currents in one friction mode, what held them back, and the motion that they
    /// make.
    #[expect(clippy::too_many_arguments, reason = "one step's values")]
    #[inline(always)]
    fn seek(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        link: &D::Link,
        sought: &Sought<D::Rises>,
        rises: D::Rises,
        slip: Slip,
        bus: Source,
        resistance: &Resistance,
    ) -> (D::Rises, Held, Motion) {
        let v = state.body.speed_m_s.get();
        let force_n = self.drives.force(&state.drives, link, rises).effort;
        let mode = mode(resistance, v, slip, force_n);
        let alone = D::PASSES == 1;
        let wishes = if alone {
            Wishes::default()
        } else {
            self.drives.wishes(&state.drives, link, sought.carried, mode.ended_m_s())
        };
        let shares =
            wishes.shares(sought.lowest_w, sought.highest_w, bus.emf_v, bus.resistance_ohm, alone);
        let (rises, held) =
            self.drives.hold(&state.drives, link, sought.wants, rises, &mode, &shares);
        let motion = resistance.solve(self.drives.force(&state.drives, link, rises), v);
        (rises, held, motion)
    }

    /// The same again, until the friction mode stays as it is and drives that share have agreed.
    #[cold]
    #[inline(never)]
    fn seek_on(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        link: D::Link,
        sought: Sought<D::Rises>,
        found: (D::Rises, Slip),
        bus: Source,
        resistance: Resistance,
    ) -> (D::Rises, Held, Motion) {
        let (mut rises, mut slip) = found;
        let mut pass = 2;
        loop {
            let (held, motion);
            (rises, held, motion) = self.seek(state, &link, &sought, rises, slip, bus, &resistance);
            let agreed = motion.slip == slip && pass >= D::PASSES;
            if agreed || pass == D::PASSES + TRIES {
                return (rises, held, motion);
            }
            slip = motion.slip;
            pass += 1;
        }
    }

    /// The step under a command, where what the first supposed did not fit.
    #[cold]
    #[inline(never)]
    fn again(
        &self,
        state: &PowertrainState<L, B::State, D::State>,
        command: D::Command,
        link: D::Link,
        bus: Source,
        resistance: Resistance,
    ) -> Solved<D::Link> {
        let seen = Self::seen(state, bus, &resistance);
        let (law, link) = self.drives.law_again(&state.drives, command, seen, &link);
        self.drives.closed(law, link, seen, bus, &resistance)
    }
}

/// What is sought where a limit acts.
struct Sought<R> {
    /// The rises of the currents without limits, and within those of the windings.
    wants: R,
    carried: R,
    /// What the drives may take from the bus, at least and at most \[W\].
    lowest_w: Real,
    highest_w: Real,
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
fn drive_power_w(
    loads: &Loads,
    source: Source,
    limits: CurrentLimits,
    drawing_v: Real,
) -> (Real, Real) {
    let charging_v = source.voltage_v(-limits.charge_a);
    let fed_a = limits.charge_a + loads.current_a(charging_v);
    let left_a = max(limits.discharge_a - loads.current_a(drawing_v), 0.0);
    (-fed_a * charging_v, left_a * drawing_v)
}
