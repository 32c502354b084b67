//! When rows trip.

extern crate std;

use std::{format, println};

use super::scene::{Scene, State, TABLE, made_over_time};
use crate::protect::{
    CURRENT_BUDGET_S, Flow, Id, Level, Pace, STALE_BUDGET_S, Side, Source, TEMPERATURE_BUDGET_S,
    Table, VOLTAGE_BUDGET_S,
};

/// Ticks from the event to the trip of a row, with the event so many ticks into a sweep.
fn ticks_to_trip(id: Id, phase: u16, settled: &State) -> Option<u32> {
    let (mut scene, mut state) = (Scene::healthy(), *settled);
    for _ in 0..phase {
        let verdict = scene.step(&mut state);
        assert!(verdict.permit && verdict.tripped.is_empty(), "{verdict:?}");
    }
    scene.plant(id, &mut state);
    let mut ticks = 0;
    for _ in 0..40_000 {
        let verdict = scene.step(&mut state);
        // What is made over time begins when it is made, at the end of a sweep that it counts for.
        ticks = if made_over_time(id) && !state.stuck.has(id) { 0 } else { ticks + 1 };
        if verdict.rose.has(id) {
            return Some(ticks);
        }
    }
    None
}

/// (count − 1)·P + D < t ≤ count·P + D after the event, over all rows, wherever in a sweep it comes.
/// What is looked at in turn may have to wait for its turn, one sweep.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_row_trips_in_time() {
    let sweep = u32::from(TABLE.sheet().sweep_ticks);
    let mut settled = State::NEW;
    Scene::healthy().settle(&mut settled);
    for row in TABLE.rows() {
        let (period, turn) = match row.pace {
            Pace::Tick => (1, 0),
            Pace::Sweep => (sweep, sweep),
        };
        let (count, delay) = (u32::from(row.debounce.count), u32::from(row.debounce.delay));
        let (mut first, mut last) = (u32::MAX, 0);
        for phase in 0..TABLE.sheet().sweep_ticks {
            let ticks = ticks_to_trip(row.id, phase, &settled);
            let ticks = ticks.unwrap_or_else(|| panic!("{:?} never trips", row.id));
            let (after, until) = ((count + delay - 1) * period, (count + delay) * period + turn);
            assert!(after < ticks && ticks <= until, "{:?}: {after} < {ticks} <= {until}", row.id);
            (first, last) = (first.min(ticks), last.max(ticks));
        }
        println!("{:44} {first:5} .. {last:5} ms", format!("{:?}", row.id));
    }
}

fn assert_budgets(table: &Table) {
    let sides = [Side::Low, Side::High];
    let flows = [Flow::Discharge, Flow::Charge];
    let within = |id: Id, budget_s: crate::Real| {
        let longest_s = table.longest_s(table.row(id));
        assert!(longest_s <= budget_s + 1e-5, "{id:?}: {longest_s} s");
        assert!(longest_s > 0.0);
    };
    for level in [Level::Mol, Level::Rsl, Level::Msl] {
        for flow in flows {
            within(Id::Current(flow, level), CURRENT_BUDGET_S);
            within(Id::Surge(flow), CURRENT_BUDGET_S);
            for side in sides {
                within(Id::CellVoltage(side, level), VOLTAGE_BUDGET_S);
                within(Id::PackVoltage(side), VOLTAGE_BUDGET_S);
                within(Id::Temperature(flow, side, level), TEMPERATURE_BUDGET_S);
            }
        }
    }
    within(Id::ShortCircuit, CURRENT_BUDGET_S);
    for source in [Source::Cell, Source::Temperature, Source::Current, Source::Pack, Source::Link] {
        within(Id::Stale(source), STALE_BUDGET_S);
        within(Id::Range(source), STALE_BUDGET_S);
    }
}

/// Over-current within 20 ms, voltages and missing data within 100 ms, temperatures within 1 s; at
/// other rates too.
#[test]
fn safety_limits_keep_their_budgets() {
    assert_eq!((CURRENT_BUDGET_S, VOLTAGE_BUDGET_S), (0.02, 0.1));
    assert_eq!((TEMPERATURE_BUDGET_S, STALE_BUDGET_S), (1.0, 0.1));
    assert_budgets(&TABLE);
    for (tick_s, sweep_ticks) in [(1e-3, 1), (5e-4, 40), (5e-3, 4), (2e-3, 12), (1e-3, 25)] {
        let sheet = crate::protect::PackSheet { tick_s, sweep_ticks, ..crate::protect::EXAMPLE };
        assert_budgets(&Table::new(sheet).unwrap());
    }
}

/// The age that a reading may have is part of the budget: from the last value that came.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_sensor_that_stops_is_told_in_time() {
    for source in [Source::Cell, Source::Current, Source::Pack, Source::Link] {
        for phase in 0..20 {
            let mut scene = Scene::healthy();
            let mut state = State::NEW;
            scene.settle(&mut state);
            for _ in 0..phase {
                scene.step(&mut state);
            }
            let dt = crate::Dt::from_s(0.001).unwrap();
            let ticks = (1..200).find(|_| {
                let reading = match source {
                    Source::Cell => &mut scene.now.cell_v[0],
                    Source::Current => &mut scene.now.current_a,
                    Source::Pack => &mut scene.now.pack_v,
                    _ => &mut scene.now.link_v,
                };
                reading.elapse(dt.s());
                scene.step(&mut state).rose.has(Id::Stale(source))
            });
            assert!(ticks.is_some_and(|ticks| ticks <= 100), "{source:?}: {ticks:?} ms");
        }
    }
}
