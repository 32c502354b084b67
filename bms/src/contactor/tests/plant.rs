//! The machine against contactors, a link and what is wrong with them: what happens, not what is
//! shown.

extern crate std;

use std::collections::HashSet;
use std::string::String;
use std::vec::Vec;
use std::{format, println, vec};

use crate::contactor::{
    Cause, Coils, ContactorControl, ContactorInput, ContactorParams, ContactorState, CurrentClass,
    Feedback, LinkClass, Phase, Watch,
};
use crate::protect::{Clear, Trip};
use crate::{Dt, must};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Wrong {
    Welds(usize),
    StuckOpen(usize),
    ShowsOpen(usize),
    ShowsClosed(usize),
    LinkLost,
    LinkShort,
    ResistorOpen,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct World {
    closed: [bool; 3],
    late: [bool; 3],
    welded: [bool; 3],
    /// Of the link: 0 empty, 3 charged.
    level: u8,
    change: i8,
    precharging: u8,
    bleeds: bool,
    inrush: bool,
}

/// What may happen in a step besides.
#[derive(Clone, Copy)]
struct Chance {
    on: bool,
    high: bool,
    trip: Trip,
    clear: Clear,
    lag: [bool; 3],
    onset: bool,
}

fn chances() -> Vec<Chance> {
    let mut chances = vec![];
    for bits in 0..64_u8 {
        let bit = |k: u8| bits >> k & 1 == 1;
        for trip in [Trip::None, Trip::Hard, Trip::Crash] {
            for clear in [Clear::No, Clear::Reset] {
                let lag = [bit(2), bit(3), bit(4)];
                let (on, high, onset) = (bit(0), bit(1), bit(5));
                chances.push(Chance { on, high, trip, clear, lag, onset });
            }
        }
    }
    chances
}

fn observe(world: &World, wrong: &[Wrong], chance: &Chance) -> ContactorInput {
    let mut feedback =
        world.closed.map(|closed| if closed { Feedback::Closed } else { Feedback::Open });
    for one in wrong {
        match *one {
            Wrong::ShowsOpen(k) => feedback[k] = Feedback::Open,
            Wrong::ShowsClosed(k) => feedback[k] = Feedback::Closed,
            _ => {}
        }
    }
    let lost = wrong.contains(&Wrong::LinkLost);
    let watch = if world.precharging == 0 {
        Watch::Wait
    } else if lost {
        Watch::Open
    } else if world.level == 3 {
        Watch::Done
    } else if wrong.contains(&Wrong::LinkShort) {
        Watch::Short
    } else if world.precharging >= 3 && world.change <= 0 {
        Watch::Open
    } else {
        Watch::Wait
    };
    let link = match world.change {
        _ if lost => LinkClass::Unknown,
        1 => LinkClass::Rising,
        -1 => LinkClass::Falling,
        _ => LinkClass::Steady,
    };
    let flows = chance.high && world.closed[0] && world.closed[2];
    ContactorInput {
        on: chance.on,
        clear: chance.clear,
        trip: chance.trip,
        permit: true,
        resistor_ready: true,
        watch,
        current: if flows { CurrentClass::High } else { CurrentClass::Breakable },
        link,
        feedback,
    }
}

fn follow(world: &World, coils: Coils, wrong: &[Wrong], chance: &Chance) -> World {
    let wanted = [coils.minus, coils.precharge, coils.plus];
    let mut next = *world;
    for (k, wanted) in wanted.into_iter().enumerate() {
        next.late[k] = wanted != world.closed[k] && chance.lag[k] && !world.late[k];
        if !next.late[k] {
            next.closed[k] = wanted;
        }
        if wrong.contains(&Wrong::StuckOpen(k)) {
            next.closed[k] = false;
        }
        next.welded[k] |= wrong.contains(&Wrong::Welds(k)) && chance.onset && world.closed[k];
        next.closed[k] |= next.welded[k];
    }
    let short = wrong.contains(&Wrong::LinkShort);
    let [minus, precharge, plus] = next.closed;
    if minus && plus {
        next.inrush |= next.level < 3;
        next.level = 3;
    } else if minus && precharge && !short && !wrong.contains(&Wrong::ResistorOpen) {
        next.level = (next.level + 1).min(3);
    } else if next.bleeds {
        next.level = next.level.saturating_sub(1);
    }
    if short {
        next.level = 0;
    }
    next.change = match next.level.cmp(&world.level) {
        core::cmp::Ordering::Less => -1,
        core::cmp::Ordering::Equal => 0,
        core::cmp::Ordering::Greater => 1,
    };
    next.precharging = if coils.precharge { (world.precharging + 1).min(4) } else { 0 };
    next
}

const CONTROL: ContactorControl = must!(ContactorControl::new(
    ContactorParams {
        start_limit_s: 0.04,
        settle_s: 0.02,
        close_limit_s: 0.04,
        precharge_limit_s: 0.07,
        open_limit_s: 0.04,
        shed_limit_s: 0.04,
        hard_limit_s: 0.02,
        weld_limit_s: 0.04,
        cooldown_s: 0.03,
        tries: 2,
    },
    must!(Dt::from_s(0.01))
));

/// What a step does that must not be.
fn amiss(
    wrong: &[Wrong],
    before: &ContactorState,
    after: &ContactorState,
    world: &World,
) -> Option<&'static str> {
    let accuses = !matches!(
        after.cause(),
        Cause::None | Cause::Soft | Cause::Hard | Cause::Crash | Cause::Lost
    );
    let faulted = after.phase() == Phase::Fault;
    let welded = world.welded.contains(&true);
    let shows_closed = wrong.iter().any(|one| matches!(one, Wrong::ShowsClosed(_)));
    let starts = before.phase() == Phase::Standby && after.phase() == Phase::CloseMinus;
    if world.inrush {
        Some("both mains on an uncharged link")
    } else if wrong.is_empty() && faulted && accuses {
        Some("a healthy pack is accused")
    } else if faulted && after.cause() == Cause::Welded && !welded && !shows_closed {
        Some("welded without a weld")
    } else if welded && starts {
        Some("a start with a welded contactor")
    } else if after.since > 10 {
        Some("a phase that outlasts every limit")
    } else {
        None
    }
}

/// Whatever chance does: how many states, and the causes of the faults.
fn walk(wrong: &[Wrong]) -> Result<(usize, HashSet<Cause>), String> {
    let chances = chances();
    let mut nodes = vec![];
    let mut found = HashSet::new();
    for level in 0..4 {
        for bleeds in [false, true] {
            let world = World {
                closed: [false; 3],
                late: [false; 3],
                welded: [false; 3],
                level: if wrong.contains(&Wrong::LinkShort) { 0 } else { level },
                change: 0,
                precharging: 0,
                bleeds,
                inrush: false,
            };
            let node = (CONTROL.start(), world);
            if found.insert(node) {
                nodes.push(node);
            }
        }
    }
    let mut causes = HashSet::new();
    let mut at = 0;
    while at < nodes.len() {
        let (before, world) = nodes[at];
        for chance in &chances {
            let mut after = before;
            let coils = CONTROL.step(&mut after, observe(&world, wrong, chance));
            let next = follow(&world, coils, wrong, chance);
            if let Some(why) = amiss(wrong, &before, &after, &next) {
                return Err(format!("{why}: {before:?} {world:?} -> {after:?} {next:?}"));
            }
            if after.phase() == Phase::Fault {
                causes.insert(after.cause());
            }
            if found.insert((after, next)) {
                nodes.push((after, next));
            }
        }
        at += 1;
    }
    Ok((nodes.len(), causes))
}

fn singles() -> Vec<Wrong> {
    let mut singles = vec![Wrong::LinkLost, Wrong::LinkShort, Wrong::ResistorOpen];
    for k in 0..3 {
        singles.extend([
            Wrong::Welds(k),
            Wrong::StuckOpen(k),
            Wrong::ShowsOpen(k),
            Wrong::ShowsClosed(k),
        ]);
    }
    singles
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_healthy_is_not_accused_and_each_fault_is_named() {
    let (states, causes) = walk(&[]).unwrap();
    println!("healthy: {states} states");
    assert_eq!(causes, HashSet::from([Cause::Hard, Cause::Crash]));
    for wrong in singles() {
        let (states, causes) = walk(&[wrong]).unwrap_or_else(|why| panic!("{wrong:?}: {why}"));
        println!("{wrong:?}: {states} states, ends in {causes:?}");
        let named = match wrong {
            Wrong::Welds(_) | Wrong::ShowsClosed(_) => Cause::Welded,
            Wrong::StuckOpen(0) | Wrong::ShowsOpen(0) | Wrong::LinkLost => Cause::MinusStuckOpen,
            Wrong::StuckOpen(1) => Cause::PrechargeStuckOpen,
            Wrong::StuckOpen(_) | Wrong::ShowsOpen(2) => Cause::PlusStuckOpen,
            Wrong::ShowsOpen(_) => Cause::PrechargeSlow,
            Wrong::LinkShort => Cause::PrechargeShort,
            Wrong::ResistorOpen => Cause::PrechargeOpen,
        };
        assert!(causes.contains(&named), "{wrong:?}: {causes:?}");
    }
}

/// Two at once: what is not detectable without a third voltage or a bleeder, and nothing else.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn two_faults_at_once() {
    let singles = singles();
    let mut missed = vec![];
    for (i, a) in singles.iter().enumerate() {
        for b in &singles[i + 1..] {
            if let Err(why) = walk(&[*a, *b]) {
                println!("{a:?} and {b:?}: {why}");
                missed.push([*a, *b]);
            }
        }
    }
    // A contactor that welds and shows open all the same.
    let expected: Vec<_> = (0..3).map(|k| [Wrong::Welds(k), Wrong::ShowsOpen(k)]).collect();
    assert_eq!(missed, expected);
}
