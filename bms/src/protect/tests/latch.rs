//! What ends a trip.

use super::scene::{Scene, State, TABLE, made_over_time};
use crate::protect::{Clear, Faults, Flow, Id, Level, Reaction, Side, Trip, Verdict};

/// What a row that has tripped does, given a step: the tests below run on the real one and on one
/// that is wrong.
type Step = fn(&Scene, &mut State) -> Verdict;

fn trip(id: Id, state: &mut State, step: Step) -> Scene {
    let mut scene = Scene::healthy();
    scene.settle(state);
    scene.plant(id, state);
    // Only where the current flows is a temperature of that direction a matter.
    if let Id::Temperature(flow, ..) = id {
        scene.now.current_a.value = if flow == Flow::Discharge { 20.0 } else { -20.0 };
        scene.signals.second_current_a = scene.now.current_a.value;
        for cell in &mut scene.now.cell_v {
            cell.value -= 0.001;
        }
    }
    let tripped = (0..40_000).any(|_| step(&scene, state).tripped.has(id));
    assert!(tripped, "{id:?}");
    scene
}

/// A latched fault stays while its cause lasts, whatever is asked; stays when the cause is gone and
/// nobody asks, or not strongly enough; then it ends.
fn latches(id: Id, step: Step) -> Result<(), &'static str> {
    let clear = TABLE.row(id).clear;
    let mut state = State::NEW;
    let mut bad = trip(id, &mut state, step);
    if !step(&bad, &mut state).latched.has(id) {
        return Err("it does not latch");
    }
    bad.signals.clear = Clear::Service;
    let after = (0..3000).map(|_| step(&bad, &mut state)).last().unwrap();
    if !made_over_time(id) && !matches!(id, Id::TemperatureRate) && !after.latched.has(id) {
        return Err("it ends while its cause lasts");
    }
    let mut state = State::NEW;
    trip(id, &mut state, step);
    let mut scene = Scene::healthy();
    for asked in [Clear::No, Clear::Reset, Clear::Service] {
        scene.signals.clear = asked;
        for tick in 0..45_000 {
            // What was stuck must be seen to move.
            if tick % 100 == 0 {
                scene.load(tick % 200 == 0);
            }
            let verdict = step(&scene, &mut state);
            if asked < clear && !verdict.latched.has(id) {
                return Err("it ends without being asked");
            }
            if verdict.latched.has(id) && verdict.permit {
                return Err("closing is permitted while it is latched");
            }
            if asked >= clear && verdict.latched.is_empty() {
                break;
            }
        }
        scene.signals.clear = Clear::No;
    }
    if step(&scene, &mut state).latched.has(id) {
        return Err("it does not end");
    }
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_latched_fault_ends_by_request_alone_with_its_cause_gone() {
    let mut latching = 0;
    for row in TABLE.rows().iter().filter(|row| row.clear > Clear::No) {
        assert_eq!(latches(row.id, Scene::step), Ok(()), "{:?}", row.id);
        latching += 1;
    }
    assert!(latching > 25, "{latching}");
}

/// Planted: one good sample clears a latched fault.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn one_good_sample_that_clears_is_caught() {
    fn wrong(scene: &Scene, state: &mut State) -> Verdict {
        let mut verdict = scene.step(state);
        let good = scene.now.cell_v.iter().all(|cell| cell.value < 4.2);
        if good {
            let over = Id::CellVoltage(Side::High, Level::Msl);
            verdict.latched = verdict.latched.without(over);
        }
        verdict
    }
    let over = Id::CellVoltage(Side::High, Level::Msl);
    assert_eq!(latches(over, Scene::step), Ok(()));
    assert_eq!(latches(over, wrong), Err("it ends without being asked"));
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_does_not_latch_heals_after_a_good_second() {
    for row in TABLE.rows().iter().filter(|row| row.clear == Clear::No) {
        let mut state = State::NEW;
        trip(row.id, &mut state, Scene::step);
        let mut healthy = Scene::healthy();
        let ticks = (1..45_000).find(|tick| {
            if tick % 100 == 0 {
                healthy.load(tick % 200 == 0);
            }
            healthy.step(&mut state).fell.has(row.id)
        });
        assert!(ticks.is_some_and(|ticks| ticks >= 1000), "{:?}: {ticks:?}", row.id);
        // Temperatures that stay up after a jump are another row's matter, currents of a moment too.
        for on in [true, false] {
            healthy.load(on);
            for _ in 0..100 {
                healthy.step(&mut state);
            }
        }
        healthy.signals.clear = Clear::Service;
        // Of jumps the rate of temperatures is the last to forget: 10 s and more.
        let verdict = (0..16).map(|_| healthy.settle(&mut state)).last().unwrap();
        assert!(verdict.permit, "{:?}: {verdict:?}", row.id);
    }
}

/// What a temperature forbids is the direction that it concerns.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn cold_forbids_charging_and_not_driving() {
    let cold = Id::Temperature(Flow::Charge, Side::Low, Level::Msl);
    let mut scene = Scene::healthy();
    let mut state = State::NEW;
    for sensor in &mut scene.now.temperature_c {
        sensor.value = -5.0;
    }
    let verdict = scene.settle(&mut state);
    assert!(verdict.tripped.has(cold) && verdict.latched.is_empty() && verdict.permit);
    assert_eq!(verdict.trip, Trip::None);
    assert!(verdict.bars(&TABLE, Flow::Charge) && !verdict.bars(&TABLE, Flow::Discharge));
    scene.now.current_a.value = -20.0;
    assert_eq!(scene.step(&mut state).trip, Trip::Hard);
    // A current that nobody knows may be one that charges.
    let mut state = State::NEW;
    scene.now.current_a.valid = false;
    scene.settle(&mut state);
    assert_eq!(scene.step(&mut state).trip, Trip::Hard);
}

/// Reactions as the table says, the strongest of several.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_strongest_reaction_counts() {
    for row in TABLE.rows() {
        let mut state = State::NEW;
        let scene = trip(row.id, &mut state, Scene::step);
        let verdict = scene.step(&mut state);
        let flowing = |id| match id {
            Id::Temperature(Flow::Discharge, ..) => scene.now.current_a.value > 0.0,
            Id::Temperature(Flow::Charge, ..) => scene.now.current_a.value < 0.0,
            _ => true,
        };
        let all = verdict.tripped.iter().filter(|id| flowing(*id));
        let strongest = all.map(|id| TABLE.row(id).reaction).max().unwrap();
        assert_eq!(verdict.trip, strongest.trip(), "{:?} {verdict:?}", row.id);
        assert!(verdict.trip >= row.reaction.trip());
        if row.reaction >= Reaction::Soft {
            assert!(!verdict.permit, "{:?}", row.id);
        }
        if let (Some(flow), Level::Msl) = (row.id.flow(), row.level) {
            assert!(verdict.bars(&TABLE, flow), "{:?}", row.id);
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_lock_out_lasts_over_a_power_cut() {
    let mut state = State::locked_by(Id::DeepDischarge);
    let mut scene = Scene::healthy();
    scene.signals.clear = Clear::Reset;
    let verdict = scene.settle(&mut state);
    assert_eq!(verdict.latched, Faults::NONE.with(Id::DeepDischarge));
    assert!(!verdict.permit);
    scene.signals.clear = Clear::Service;
    assert!(scene.step(&mut state).permit);
}
