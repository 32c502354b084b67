//! What moves though nothing else does: one cell, the current, a temperature.

use super::scene::{CELLS, Scene, State, TABLE};
use crate::protect::{Faults, Flow, Id, Level, Side, Trip};
use crate::{Reading, Real};

/// Steps of a pack at 25 °C whose cells have 20 mΩ: its current is `current_a`, the sensor shows `shown_a`.
fn flows(scene: &mut Scene, current_a: Real, shown_a: Real) {
    scene.now.current_a.value = shown_a;
    scene.signals.second_current_a = shown_a;
    let cell_v = 3.7 - 0.02 * current_a / 20.0;
    scene.now.cell_v = [Reading::new(cell_v); CELLS];
    scene.now.pack_v.value = 14.0 * cell_v;
    scene.now.link_v = scene.now.pack_v;
}

/// All that trips in so many milliseconds.
fn trips(scene: &Scene, state: &mut State, ms: u32) -> Faults {
    (0..ms).fold(Faults::NONE, |all, _| all.union(scene.step(state).rose))
}

fn settled(current_a: Real) -> (Scene, State) {
    let (mut scene, mut state) = (Scene::healthy(), State::NEW);
    flows(&mut scene, current_a, current_a);
    assert!(scene.settle(&mut state).tripped.is_empty());
    (scene, state)
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_cell_that_moves_alone_is_told() {
    for (cell, by_v) in [(0, 0.009), (6, -0.02), (13, 0.1)] {
        let (mut scene, mut state) = settled(-20.0);
        scene.now.cell_v[cell].value += by_v;
        let rows = trips(&scene, &mut state, 300);
        assert!(rows.has(Id::StuckCell), "{cell} by {by_v} V: {rows:?}");
    }
    // Three times the error and the hysteresis, 8 mV, is what cells may do.
    let (mut scene, mut state) = settled(-20.0);
    scene.now.cell_v[6].value += 0.0075;
    assert_eq!(trips(&scene, &mut state, 2000), Faults::NONE);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_cell_may_move_where_something_moves_it() {
    // A bleed switch.
    let (mut scene, mut state) = settled(0.0);
    scene.signals.bleeding = true;
    scene.now.cell_v[6].value -= 0.02;
    assert_eq!(trips(&scene, &mut state, 900), Faults::NONE);
    (scene.signals.bleeding, scene.now.cell_v[6].value) = (false, 3.7);
    assert_eq!(trips(&scene, &mut state, 900), Faults::NONE);
    // The current, of a cell with half as much resistance again.
    let (mut scene, mut state) = settled(0.0);
    for step in 0..50 {
        let current_a = if step % 2 == 0 { 60.0 } else { -20.0 };
        flows(&mut scene, current_a, current_a);
        scene.now.cell_v[6].value -= 0.01 * current_a / 20.0;
        assert_eq!(trips(&scene, &mut state, 300), Faults::NONE, "{step}");
    }
    // It relaxes by 0.3 V/s, in the cold, and one by a quarter more.
    let (mut scene, mut state) = settled(0.0);
    for _ in 0..1000 {
        for (index, cell) in scene.now.cell_v.iter_mut().enumerate() {
            cell.value += if index == 6 { 0.375e-3 } else { 0.3e-3 };
        }
        assert!(!scene.step(&mut state).rose.has(Id::StuckCell));
    }
    // Charge: 10 mV in a second.
    let (mut scene, mut state) = settled(0.0);
    for _ in 0..10_000 {
        scene.now.cell_v[6].value += 1e-5;
        assert!(!scene.step(&mut state).rose.has(Id::StuckCell));
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_current_that_its_cells_do_not_show_is_told() {
    // Offset, gain, the wrong sign: all of a sudden, with a charger on.
    for shown_a in [-26.5, -13.5, 20.0, 0.0, -60.0] {
        let (mut scene, mut state) = settled(-20.0);
        flows(&mut scene, -20.0, shown_a);
        let early = trips(&scene, &mut state, 500);
        assert!(!early.has(Id::StuckCurrent), "{shown_a} A: sooner than sensors may differ");
        assert!(trips(&scene, &mut state, 300).has(Id::StuckCurrent), "{shown_a} A");
    }
    // Cells that move by more than twice their largest resistance lets them: 120 mV by 6 A of the pack.
    for by_v in [0.12, -0.12] {
        let (mut scene, mut state) = settled(-20.0);
        flows(&mut scene, -20.0, -26.0);
        for cell in &mut scene.now.cell_v {
            cell.value += by_v;
        }
        assert!(trips(&scene, &mut state, 800).has(Id::StuckCurrent), "{by_v} V");
    }
    let (mut scene, mut state) = settled(-20.0);
    flows(&mut scene, -20.0, -26.0);
    for cell in &mut scene.now.cell_v {
        cell.value += 0.03;
    }
    assert!(!trips(&scene, &mut state, 800).has(Id::StuckCurrent), "5 A of them");
    // Within twice what the sensor may be off.
    for shown_a in [-24.0, -16.0] {
        let (mut scene, mut state) = settled(-20.0);
        flows(&mut scene, -20.0, shown_a);
        let rows = trips(&scene, &mut state, 3000);
        assert!(!rows.has(Id::StuckCurrent), "{shown_a} A");
    }
}

/// Told three sweeps and half a second after the change; a change that the cells show ends it, one that
/// they need not show does not.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_contradiction_lasts_until_the_cells_agree() {
    let (mut scene, mut state) = settled(-20.0);
    flows(&mut scene, -20.0, -60.0);
    let told = (1..2000).find(|_| {
        scene.step(&mut state);
        state.stuck.has(Id::StuckCurrent)
    });
    // At the end of the sweep of the change it begins to be steady again.
    assert_eq!(told, Some(20 * (1 + 3 + 25)));
    flows(&mut scene, -23.6, -63.6);
    trips(&scene, &mut state, 300);
    assert!(state.stuck.has(Id::StuckCurrent), "3.6 A are nearly what it may be off");
    flows(&mut scene, 0.0, -40.0);
    trips(&scene, &mut state, 300);
    assert!(!state.stuck.has(Id::StuckCurrent), "it measures changes again");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_current_that_goes_the_wrong_way_is_told() {
    let (mut scene, mut state) = settled(0.0);
    let mut rows = Faults::NONE;
    for current_a in [40.0, 90.0, 20.0, 60.0] {
        flows(&mut scene, current_a, -current_a);
        rows = rows.union(trips(&scene, &mut state, 700));
    }
    assert!(rows.has(Id::StuckCurrent), "{rows:?}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_passes_is_no_contradiction() {
    // A disturbance that goes as it came.
    let (mut scene, mut state) = settled(40.0);
    flows(&mut scene, 40.0, 55.0);
    let rows = trips(&scene, &mut state, 300);
    flows(&mut scene, 40.0, 40.0);
    assert!(!rows.union(trips(&scene, &mut state, 3000)).has(Id::StuckCurrent));
    // Pulses of cells between a tenth of the largest resistance of their life and twice it.
    for ohm in [0.007, 0.1] {
        let (mut scene, mut state) = settled(0.0);
        for step in 0..60 {
            let current_a = [0.0, 30.0, -20.0][step % 3];
            flows(&mut scene, current_a * ohm / 0.02, current_a);
            let rows = trips(&scene, &mut state, 200 + 17 * (step as u32 % 5));
            assert!(!rows.has(Id::StuckCurrent), "{ohm} Ω, step {step}");
        }
    }
}

/// Warms the sensors by so much for so long, under a current; whether anything says that it is too fast.
fn warms(k_per_s: Real, current_a: Real, seconds: u32) -> bool {
    let (mut scene, mut state) = settled(current_a);
    (0..1000 * seconds).any(|_| {
        for sensor in &mut scene.now.temperature_c {
            sensor.value += 0.001 * k_per_s;
        }
        scene.step(&mut state).rose.has(Id::TemperatureRate)
    })
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn warming_that_the_current_does_not_explain_is_told() {
    assert!(warms(0.2, 0.0, 30), "nothing flows");
    assert!(warms(0.2, 40.0, 30), "2 A of a cell warm it by 4 mK/s");
    assert!(!warms(0.1, 0.0, 90), "a heater may");
    // 6.5 A of a cell: 39 mK/s by the largest resistance, and three times that by cells that are not alike.
    assert!(!warms(0.2, 130.0, 90) && warms(0.35, 130.0, 90));
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn heat_that_shows_late_is_no_runaway() {
    let (mut scene, mut state) = settled(0.0);
    flows(&mut scene, 130.0, 130.0);
    trips(&scene, &mut state, 60_000);
    flows(&mut scene, 0.0, 0.0);
    for ms in 0..20_000 {
        for sensor in &mut scene.now.temperature_c {
            sensor.value += 0.001 * 0.15;
        }
        assert!(!scene.step(&mut state).rose.has(Id::TemperatureRate), "{ms} ms after the load");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_sensor_that_falls_is_told_and_one_that_cools_is_not() {
    let falls = |by_k: Real, for_ms: u32| {
        let (mut scene, mut state) = settled(12.0);
        scene.now.temperature_c[2].value -= by_k;
        let before = trips(&scene, &mut state, for_ms);
        scene.now.temperature_c[2].value += by_k;
        before.union(trips(&scene, &mut state, 3000)).has(Id::StuckTemperature)
    };
    assert!(falls(3.0, 2000), "three times what it may be off");
    assert!(!falls(3.0, 500), "one reading or some");
    assert!(!falls(1.0, 5000), "what it may be off");
    let (mut scene, mut state) = settled(12.0);
    for _ in 0..60_000 {
        for sensor in &mut scene.now.temperature_c {
            sensor.value -= 0.001 * 0.1;
        }
        assert!(!scene.step(&mut state).rose.has(Id::StuckTemperature));
    }
}

/// No current is allowed any more, and none flows: the cell that is too hot heats itself.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn too_hot_for_either_direction_opens_without_a_current() {
    let msl = |flow| TABLE.row(Id::Temperature(flow, Side::High, Level::Msl)).threshold;
    let trip = |celsius: Real, mains_closed: bool| {
        let (mut scene, mut state) = settled(0.0);
        scene.signals.mains_closed = mains_closed;
        scene.now.temperature_c[1].value = celsius;
        let verdict = scene.settle(&mut state);
        (verdict.trip, verdict.latched)
    };
    let (charge_c, discharge_c) = (msl(Flow::Charge), msl(Flow::Discharge));
    assert!(charge_c < discharge_c);
    // It is so hot by a jump, so the rate may have tripped, which opens softly.
    assert!(trip(charge_c + 0.1, true).0 < Trip::Hard, "driving is still allowed");
    let (opens, latched) = trip(discharge_c + 0.1, true);
    assert_eq!(opens, Trip::Hard);
    assert!(latched.has(Id::Temperature(Flow::Discharge, Side::High, Level::Msl)));
    // Open contactors have nothing to open.
    assert!(trip(discharge_c + 0.1, false).0 < Trip::Hard);
}
