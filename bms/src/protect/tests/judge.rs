//! What measurements are worth.

use super::scene::{CELLS, MSL, PACK, Scene, State, TABLE};
use crate::protect::{
    EXAMPLE, Flow, Id, Level, Protection, Row, Sample, Seen, Sensing, Sensor, Side, Source, Table,
    Trip,
};
use crate::{Reading, Real};

#[test]
fn a_row_tells_bad_near_good_and_missing() {
    let over = TABLE.row(Id::CellVoltage(Side::High, MSL));
    let under = TABLE.row(Id::CellVoltage(Side::Low, MSL));
    let h = over.hysteresis;
    for (row, out) in [(over, 1.0), (under, -1.0)] {
        let at = |by: Real| row.judge(Seen::all(row.threshold + out * by));
        assert_eq!(at(1e-4), Sample::Bad);
        assert_eq!(at(-0.5 * h), Sample::Near);
        assert_eq!(at(-1.01 * h), Sample::Good);
        // An extreme of some cells is bad for all, and good for none.
        let of_some =
            |by: Real| row.judge(Seen { value: row.threshold + out * by, complete: false });
        assert_eq!((of_some(1e-4), of_some(-1.0)), (Sample::Bad, Sample::Missing));
    }
    // A limit may be reached, not exceeded; so may the end of the hysteresis. Exact in binary.
    for (row, out) in [(over, 1.0), (under, -1.0)] {
        let row = Row { threshold: 4.0, hysteresis: 0.25, ..*row };
        let at = |by: Real| row.judge(Seen::all(4.0 + out * by));
        assert_eq!((at(0.0), at(-0.25)), (Sample::Near, Sample::Good));
    }
    for bad in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, 1e30] {
        assert_eq!(over.judge(Seen::all(bad)), Sample::Missing);
    }
}

/// Nothing is permitted before everything was seen, nor with a cell or a sensor missing.
#[test]
fn closing_needs_every_cell_and_sensor() {
    let mut state = State::NEW;
    let scene = Scene::healthy();
    for tick in 1..40 {
        assert_eq!(scene.step(&mut state).permit, tick >= 20, "tick {tick}");
    }
    for cell in 0..CELLS {
        let mut scene = Scene::healthy();
        scene.now.cell_v[cell] = Reading::NONE;
        let mut state = State::NEW;
        assert!((0..100).all(|_| !scene.step(&mut state).permit), "cell {cell}");
    }
    for sensor in 0..4 {
        let mut scene = Scene::healthy();
        scene.now.temperature_c[sensor] = Reading::NONE;
        let mut state = State::NEW;
        assert!((0..100).all(|_| !scene.step(&mut state).permit), "sensor {sensor}");
    }
}

/// Whether each wire that may be open is found, given what looks at them.
fn finds_every_wire(look: impl Fn(&Scene, &mut State) -> bool) -> Result<(), usize> {
    for wire in 0..=CELLS {
        let mut scene = Scene::healthy();
        let mut state = State::NEW;
        scene.settle(&mut state);
        scene.wires_v[wire] = 1.2;
        if !(0..100).any(|_| look(&scene, &mut state)) {
            return Err(wire);
        }
    }
    Ok(())
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_open_wire_is_found() {
    assert_eq!(finds_every_wire(|s, state| s.step(state).rose.has(Id::OpenWire)), Ok(()));
}

/// Planted: only wires 0 and 1 are looked at.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn two_wires_only_is_caught() {
    let wrong = |scene: &Scene, state: &mut State| {
        let mut blind = *scene;
        blind.wires_v[2..].fill(0.01);
        blind.step(state).rose.has(Id::OpenWire)
    };
    assert_eq!(finds_every_wire(wrong), Err(2));
}

/// Whether a front end that speaks in another unit, or in sentinels, is told from one that measures.
fn refuses_other_units(pack: &Protection<14, 4>) -> Result<(), Real> {
    for value in [3700.0, 819.1, 65.535, -0.001, 37.0, 5.001] {
        let mut scene = Scene::healthy();
        let mut state = State::NEW;
        let cells = [Reading::new(value); CELLS];
        scene.now.cell_v = cells;
        let found =
            (0..100).any(|_| scene.step_of(pack, &mut state).tripped.has(Id::Range(Source::Cell)));
        let verdict = scene.step_of(pack, &mut state);
        if !found || verdict.permit || verdict.trip < Trip::Soft {
            return Err(value);
        }
    }
    Ok(())
}

#[test]
fn millivolts_and_sentinels_are_no_voltages() {
    assert_eq!(refuses_other_units(&PACK), Ok(()));
}

/// Planted: volts taken for millivolts, by a range that takes either.
#[test]
fn volts_taken_for_millivolts_are_caught() {
    let cell_v = Sensor { highest: 5000.0, ..EXAMPLE.sensing.cell_v };
    let sheet =
        crate::protect::PackSheet { sensing: Sensing { cell_v, ..EXAMPLE.sensing }, ..EXAMPLE };
    let table = Table::new(sheet).unwrap();
    let wrong = Protection::new(&table).unwrap();
    assert_eq!(refuses_other_units(&wrong), Err(3700.0));
}

/// A sensor that dies at the same moment hides no over-voltage.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_bad_cell_that_is_lost_stays_bad() {
    let over = Id::CellVoltage(Side::High, MSL);
    let mut scene = Scene::healthy();
    let mut state = State::NEW;
    scene.settle(&mut state);
    scene.now.cell_v[3].value = 4.3;
    for _ in 0..40 {
        assert!(!scene.step(&mut state).tripped.has(over));
    }
    scene.now.cell_v[3].valid = false;
    assert!((0..60).any(|_| scene.step(&mut state).tripped.has(over)));
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_stuck_sensor_is_told_and_a_quiet_one_is_not() {
    for id in [Id::StuckCell, Id::StuckTemperature, Id::StuckCurrent] {
        let mut state = State::NEW;
        let mut scene = Scene::healthy();
        scene.settle(&mut state);
        // Nothing moves: nothing shows that something is stuck.
        assert!(scene.settle(&mut state).tripped.is_empty());
        scene.plant(id, &mut state);
        assert!((0..200).any(|_| scene.step(&mut state).tripped.has(id)), "{id:?}");
    }
    let mut state = State::NEW;
    let mut scene = Scene::healthy();
    scene.settle(&mut state);
    for step in 0..50 {
        scene.load(step % 2 == 0);
        for _ in 0..100 {
            let verdict = scene.step(&mut state);
            for id in [Id::StuckCell, Id::StuckTemperature, Id::StuckCurrent] {
                assert!(!verdict.tripped.has(id), "{id:?}");
            }
        }
    }
}

/// Ten seconds of the ten-second current are allowed, eleven are not; the continuous one always is.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn ten_seconds_of_the_ten_second_current() {
    let after = |current_a: Real| {
        let mut scene = Scene::healthy();
        let mut state = State::NEW;
        scene.settle(&mut state);
        scene.now.current_a.value = current_a;
        let heat = |flow| move |tripped: crate::protect::Faults| tripped.has(Id::Heat(flow));
        let flow = if current_a > 0.0 { Flow::Discharge } else { Flow::Charge };
        (1..60_000).find(|_| heat(flow)(scene.step(&mut state).tripped))
    };
    for current_a in [280.0, -100.0] {
        assert!(after(current_a).is_some_and(|ms| (9_990..10_010).contains(&ms)));
    }
    assert_eq!((after(139.0), after(-49.0)), (None, None));
}

/// In the cold less is continuous.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_continuous_current_follows_the_temperature() {
    let mol = Id::Current(Flow::Discharge, Level::Mol);
    let tripped = |temperature_c: Real, current_a: Real| {
        let mut scene = Scene::healthy();
        scene.now.temperature_c = [Reading::new(temperature_c); 4];
        scene.now.current_a.value = current_a;
        let mut state = State::NEW;
        scene.settle(&mut state).tripped.has(mol)
    };
    assert!(!tripped(25.0, 130.0) && !tripped(-15.0, 65.0));
    assert!(tripped(25.0, 145.0) && tripped(-15.0, 75.0));
    assert!(tripped(-30.0, 8.0));
}

/// What is left of a short current: the charge of the squared current beyond the continuous one.
#[test]
fn the_heat_of_a_current_is_counted() {
    let mut state = State::NEW;
    let mut scene = Scene::healthy();
    scene.settle(&mut state);
    assert_eq!(state.heat_share(&TABLE, Flow::Discharge), 0.0);
    scene.now.current_a.value = 280.0;
    for _ in 0..5000 {
        scene.step(&mut state);
    }
    let share = state.heat_share(&TABLE, Flow::Discharge);
    assert!((share - 0.5).abs() < 0.02, "half of ten seconds: {share}");
    assert_eq!(state.heat_share(&TABLE, Flow::Charge), 0.0);
    scene.now.current_a.value = -100.0;
    for _ in 0..2500 {
        scene.step(&mut state);
    }
    let share = state.heat_share(&TABLE, Flow::Charge);
    assert!((share - 0.25).abs() < 0.02, "{share}");
    assert!(state.heat_share(&TABLE, Flow::Discharge) < 0.5, "it cools");
}
