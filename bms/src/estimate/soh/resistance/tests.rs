extern crate std;
use plant_core::battery::MappedBatteryParams;
use plant_core::must;
use plant_core::presets::PANASONIC_NCR18650PF;

use super::*;

const DT: Dt = must!(Dt::from_s(1.0));
const BATTERY: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));
const PARAMS: ResistanceParams = ResistanceParams {
    voltage_sd_v: 0.001,
    current_sd_a: 0.01,
    least_step_a: 0.3,
    memory_steps: 500.0,
    initial_sd: 0.5,
    skew_s: 0.0,
};
const ESTIMATOR: ResistanceEstimator<'static> =
    must!(ResistanceEstimator::new(PARAMS, &BATTERY, DT));

fn at(soc: Real) -> Estimate {
    Estimate::rested(soc, 0.01, 25.0)
}

/// The current of a restless driver.
fn current_a(i: u32) -> Real {
    [0.0, 2.0, 5.0, -1.0, 3.0, 3.0, 0.5][i as usize % 7]
}

/// Runs `steps` seconds of a cell with resistances `factor` times as large; `disturb` may
/// change what is read.
fn run(
    state: &mut ResistanceState,
    factor: Real,
    steps: u32,
    disturb: impl Fn(u32, &mut ResistanceInput),
) -> ResistanceOutput {
    let mut cell = BATTERY.rested_at(0.6, 25.0).unwrap();
    let mut out = ESTIMATOR.step(
        state,
        ResistanceInput {
            voltage_v: BATTERY.open_circuit().at(0.6),
            current_a: 0.0,
            estimate: at(0.6),
        },
    );
    for i in 0..steps {
        let current_a = current_a(i);
        let open_circuit_v = BATTERY.open_circuit().at(cell.soc.get());
        let (source, _) = BATTERY.offer(&cell);
        let over_v = open_circuit_v - source.voltage_v(current_a);
        BATTERY.settle(&mut cell, current_a);
        BATTERY.set_temperature(&mut cell, 25.0);
        let mut input = ResistanceInput {
            voltage_v: open_circuit_v - factor * over_v,
            current_a,
            estimate: at(cell.soc.get()),
        };
        disturb(i, &mut input);
        out = ESTIMATOR.step(state, input);
    }
    out
}

/// A voltage that is read a tenth of a second late, ten times a second, while the current changes
/// every second or so: without being told it finds what is not there, and says so.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn learns_from_readings_that_are_out_of_step_only_where_the_current_is_steady() {
    const TENTH: Dt = must!(Dt::from_s(0.1));
    const BATTERY: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, TENTH));
    let run = |skew_s, factor: Real| {
        let params = ResistanceParams { skew_s, ..PARAMS };
        let estimator = ResistanceEstimator::new(params, &BATTERY, TENTH).unwrap();
        let mut cell = BATTERY.rested_at(0.8, 25.0).unwrap();
        let (mut state, mut late_v) = (estimator.unknown(), BATTERY.open_circuit().at(0.8));
        let mut out = None;
        for i in 0..18_000_u32 {
            // Half a second to a second and a half.
            let current_a = current_a(i / (5 + i / 20 % 11));
            let open_circuit_v = BATTERY.open_circuit().at(cell.soc.get());
            let (source, _) = BATTERY.offer(&cell);
            let voltage_v =
                open_circuit_v - factor * (open_circuit_v - source.voltage_v(current_a));
            BATTERY.settle(&mut cell, current_a);
            BATTERY.set_temperature(&mut cell, 25.0);
            let estimate = at(cell.soc.get());
            out = Some(
                estimator
                    .step(&mut state, ResistanceInput { voltage_v: late_v, current_a, estimate }),
            );
            late_v = voltage_v;
        }
        out.unwrap()
    };
    for factor in [1.0, 1.8] {
        let told = run(0.1, factor);
        assert!((told.factor - factor).abs() <= 0.04 * factor && !told.at_bound, "{told:?}");
        assert!((told.factor - factor).abs() <= 3.0 * told.factor_sd, "{told:?}");
    }
    let untold = run(0.0, 1.0);
    assert!(untold.at_bound && untold.factor_sd >= PARAMS.initial_sd, "{untold:?}");
}

#[test]
fn finds_the_factor() {
    for factor in [0.7, 1.0, 1.4, 3.0] {
        let out = run(&mut ESTIMATOR.unknown(), factor, 600, |_, _| {});
        assert!((out.factor / factor - 1.0).abs() < 5e-3, "{factor}: {out:?}");
        assert!(out.factor_sd < 0.02, "{out:?}");
    }
}

#[test]
fn follows_a_change_and_remembers_what_it_is_told() {
    let mut state = ESTIMATOR.known(1.4, 0.01);
    assert_eq!((state.factor, state.last), (1.4, None));
    run(&mut state, 1.4, 600, |_, _| {});
    let out = run(&mut state, 1.6, 4000, |_, _| {});
    assert!((out.factor - 1.6).abs() < 0.02, "{out:?}");
    for (factor, sd) in [(Real::NAN, 0.1), (0.0, 0.1), (1.2, Real::NAN)] {
        assert_eq!(ESTIMATOR.known(factor, sd), ESTIMATOR.unknown());
    }
}

#[test]
fn learns_nothing_where_nothing_changes() {
    let mut state = ESTIMATOR.unknown();
    let steady = |i: u32| [2.0, 2.1, 2.2][i as usize % 3];
    for i in 0..1000 {
        let input = ResistanceInput { voltage_v: 3.6, current_a: steady(i), estimate: at(0.6) };
        let out = ESTIMATOR.step(&mut state, input);
        assert!(!out.learned && out.factor == 1.0 && out.factor_sd == 0.5, "{out:?}");
    }
}

#[test]
fn a_wild_reading_now_and_then_does_little() {
    let wild = |i: u32, input: &mut ResistanceInput| {
        if i % 50 == 7 {
            input.voltage_v += 1.0;
        }
    };
    let out = run(&mut ESTIMATOR.unknown(), 1.4, 3000, wild);
    assert!((out.factor - 1.4).abs() < 0.05, "{out:?}");
}

#[test]
fn says_so_where_the_readings_are_worse_than_promised() {
    let noisy = |i: u32, input: &mut ResistanceInput| {
        input.voltage_v += 0.003 * Real::from(((i % 13) * (i % 13) % 13) as u8) - 0.018;
    };
    let out = run(&mut ESTIMATOR.unknown(), 1.4, 3000, noisy);
    let calm = run(&mut ESTIMATOR.unknown(), 1.4, 3000, |_, _| {});
    assert!((out.factor - 1.4).abs() < 3.0 * out.factor_sd, "{out:?}");
    assert!(out.factor_sd > 2.0 * calm.factor_sd, "{out:?} {calm:?}");
}

#[test]
fn bad_readings_change_nothing_and_are_not_compared() {
    let mut state = ESTIMATOR.unknown();
    run(&mut state, 1.4, 600, |_, _| {});
    let before = state.factor;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        for field in 0..4 {
            let mut input = ResistanceInput { voltage_v: 3.6, current_a: 1.0, estimate: at(0.6) };
            match field {
                0 => input.voltage_v = bad,
                1 => input.current_a = bad,
                2 => input.estimate.soc = bad,
                _ => input.estimate.temperature_c = bad,
            }
            assert!(ESTIMATOR.step(&mut state, input).rejected);
            let next = ResistanceInput { voltage_v: 1.0, current_a: 9.0, estimate: at(0.6) };
            assert!(!ESTIMATOR.step(&mut state, next).learned);
            assert_eq!(state.factor, before);
        }
    }
}

#[test]
fn stays_within_bounds() {
    let absurd = |_, input: &mut ResistanceInput| input.voltage_v *= -1e6;
    for factor in [-50.0, 50.0] {
        let out = run(&mut ESTIMATOR.unknown(), factor, 3000, absurd);
        assert!((SMALLEST_FACTOR..=LARGEST_FACTOR).contains(&out.factor), "{out:?}");
        assert!(out.factor_sd.is_finite() && out.factor_sd > 0.0);
    }
}

#[test]
fn does_not_learn_outside_the_identified_range() {
    const NARROW: MappedBattery = must!(MappedBattery::new(
        MappedBatteryParams {
            identified: plant_core::battery::IdentifiedRange {
                soc_min: 0.7,
                ..PANASONIC_NCR18650PF.identified
            },
            ..PANASONIC_NCR18650PF
        },
        DT
    ));
    let estimator = ResistanceEstimator::new(PARAMS, &NARROW, DT).unwrap();
    let mut state = estimator.unknown();
    for (i, soc, learned) in [(0, 0.6, false), (1, 0.6, false), (2, 0.8, true)] {
        let input = ResistanceInput { voltage_v: 3.6, current_a: current_a(i), estimate: at(soc) };
        assert_eq!(estimator.step(&mut state, input).learned, learned);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| ResistanceEstimator::new(p, &BATTERY, DT).unwrap_err().field();
    for bad in [0.0, -1.0, Real::NAN, Real::INFINITY] {
        let fields = [
            (ResistanceParams { voltage_sd_v: bad, ..PARAMS }, "resistance.voltage_sd_v"),
            (ResistanceParams { current_sd_a: bad, ..PARAMS }, "resistance.current_sd_a"),
            (ResistanceParams { least_step_a: bad, ..PARAMS }, "resistance.least_step_a"),
            (ResistanceParams { memory_steps: bad, ..PARAMS }, "resistance.memory_steps"),
            (ResistanceParams { initial_sd: bad, ..PARAMS }, "resistance.initial_sd"),
        ];
        for (params, field) in fields {
            assert_eq!(refused(params), field);
        }
    }
    for skew_s in [-1.0, Real::NAN, Real::INFINITY] {
        assert_eq!(refused(ResistanceParams { skew_s, ..PARAMS }), "resistance.skew_s");
    }
    let forgetful = ResistanceParams { memory_steps: 1.0, ..PARAMS };
    assert_eq!(
        ResistanceEstimator::new(forgetful, &BATTERY, DT),
        Err(ParamError::NotAbove("resistance.memory_steps"))
    );
}
