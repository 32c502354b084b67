//! plant-core against traces that another tool computed from the same equations, written as
//! Modelica models, at tolerances far below those here: see `data/reference`.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "f64 references against an f32 plant; counts and times are small and ≥ 0"
)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plant_core::battery::{Battery, BatteryInput, BatteryParams, BatteryState, RcBranchParams};
use plant_core::control::pid::{AntiWindup, DerivativeOf, Pid, PidInput, PidParams, PidState};
use plant_core::converter::Converter;
use plant_core::machine::dc::{DcMotor, DcMotorInput, DcMotorParams, DcMotorState};
use plant_core::mechanics::body::{Body, BodyInput, BodyState, Road};
use plant_core::mechanics::rotational::{RotationalLoad, RotationalLoadState};
use plant_core::mechanics::slope::Grade;
use plant_core::port::Source;
use plant_core::{Accum, Dt, presets};
use voltstep::read::{cycle, vehicle};
use voltstep::simulate::progress::Unseen;
use voltstep::simulate::route::Route;
use voltstep::simulate::run;

#[path = "second_reference/tolerances.rs"]
mod tolerances;

use tolerances::{END_TOLERANCES, Of, TOLERANCES};

/// The two steps \[s\].
const STEPS_S: [f64; 2] = [1e-3, 1e-4];

/// A trace's columns, by name.
type Columns = BTreeMap<String, Vec<f64>>;
/// What the plant says at each row of a trace, under the names of the trace's columns.
type Series = Vec<(&'static str, Vec<f64>)>;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/reference")
}

fn read(name: &str) -> csv::Reader<std::fs::File> {
    let path = folder().join(format!("{name}.csv"));
    csv::Reader::from_path(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn trace(name: &str) -> Columns {
    let mut reader = read(name);
    let header = reader.headers().unwrap().clone();
    let mut columns = Columns::new();
    for row in reader.deserialize() {
        let row: Vec<f64> = row.unwrap();
        for (column, value) in header.iter().zip(row) {
            columns.entry(column.to_owned()).or_default().push(value);
        }
    }
    assert!(columns["time_s"].len() > 200, "{name}: a short trace");
    columns
}

fn difference(of: Of, ours: &[f64], theirs: &[f64]) -> f64 {
    assert_eq!(ours.len(), theirs.len());
    let squares = || ours.iter().zip(theirs).map(|(a, b)| (a - b).powi(2));
    match of {
        Of::Max => squares().fold(0.0, f64::max).sqrt(),
        Of::Rms => (squares().sum::<f64>() / ours.len() as f64).sqrt(),
    }
}

/// Each quantity of a run that lies further from its trace than the table allows.
fn disagreements(name: &str, trace: &Columns, step: usize, series: &Series) -> Vec<String> {
    let rows: Vec<_> = TOLERANCES.iter().filter(|t| t.0 == name).collect();
    assert_eq!(rows.len(), series.len(), "{name}: a tolerance for each quantity, and no other");
    let mut found = Vec::new();
    for (quantity, ours) in series {
        let (.., of, allowed) = rows.iter().find(|t| t.1 == *quantity).expect("a tolerance");
        let off = difference(*of, ours, &trace[*quantity]);
        println!("{name} {quantity} at {} s: {off:.3e} of {:.1e}", STEPS_S[step], allowed[step]);
        if off.is_nan() || off > allowed[step] {
            found.push(format!("{name} {quantity} at {} s: {off:.3e}", STEPS_S[step]));
        }
    }
    found
}

/// Holds a model against its trace at both steps; then against a trace that is 1 % and one row off,
/// which each check must notice.
fn check(name: &str, run: impl Fn(f64, &Columns) -> Series) {
    let trace = trace(name);
    let mut failed = Vec::new();
    for (step, dt_s) in STEPS_S.into_iter().enumerate() {
        let series = run(dt_s, &trace);
        failed.extend(disagreements(name, &trace, step, &series));
        let mut wrong = trace.clone();
        for values in wrong.values_mut() {
            values.rotate_left(1);
            for value in values {
                *value *= 1.01;
            }
        }
        assert_eq!(disagreements(name, &wrong, step, &series).len(), series.len());
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Walks along a trace: `step` is called with the row that ends the stretch and the time at the
/// start of the step, `row` after each stretch (and before the first).
fn walk<S>(
    dt_s: f64,
    trace: &Columns,
    state: &mut S,
    mut step: impl FnMut(&mut S, usize, f64),
    names: &[&'static str],
    mut row: impl FnMut(&S) -> Vec<f64>,
) -> Series {
    let times = &trace["time_s"];
    let mut series: Series = names.iter().map(|n| (*n, Vec::new())).collect();
    let mut keep = |state: &S| {
        for ((_, values), value) in series.iter_mut().zip(row(state)) {
            values.push(value);
        }
    };
    keep(state);
    for n in 1..times.len() {
        let steps = ((times[n] - times[n - 1]) / dt_s).round() as u32;
        for k in 0..steps {
            step(state, n, times[n - 1] + f64::from(k) * dt_s);
        }
        keep(state);
    }
    series
}

fn dt(dt_s: f64) -> Dt {
    Dt::from_s(dt_s as f32).unwrap()
}

fn sum(value: f64) -> Accum {
    let mut sum = Accum::new(value as f32);
    sum.add((value - f64::from(value as f32)) as f32);
    sum
}

#[test]
fn motor_step() {
    let run = |params: DcMotorParams| {
        move |dt_s: f64, trace: &Columns| {
            let motor = DcMotor::new(params, dt(dt_s)).unwrap();
            let mut state = DcMotorState {
                current_a: sum(trace["current_a"][0]),
                speed_rad_s: sum(trace["speed_rad_s"][0]),
            };
            let step = |s: &mut DcMotorState, n: usize, _| {
                let voltage_v = trace["voltage_v"][n] as f32;
                motor.step(s, DcMotorInput { voltage_v, load_nm: 0.0 });
            };
            walk(dt_s, trace, &mut state, step, &["current_a", "speed_rad_s"], |s| {
                vec![s.current_a.get().into(), s.speed_rad_s.get().into()]
            })
        }
    };
    let free = |p: DcMotorParams| DcMotorParams { coulomb_nm: 0.0, ..p };
    check("motor_pasek", run(free(presets::MOTOR_PASEK)));
    check("motor_moments", run(free(presets::MOTOR_MOMENTS)));
    check("motor_pasek_static", run(presets::MOTOR_PASEK));
    check("motor_moments_static", run(presets::MOTOR_MOMENTS));
}

#[test]
fn battery_pulses() {
    let run = |resistance_ohm, capacitance_f| {
        move |dt_s: f64, trace: &Columns| {
            let params = BatteryParams {
                polarisation: RcBranchParams { resistance_ohm, capacitance_f },
                ..presets::BMW_I3_60AH_EPOWERTRAIN.powertrain.battery
            };
            let battery = Battery::new(params, dt(dt_s)).unwrap();
            let mut state = (BatteryState::rested(0.869).unwrap(), trace["terminal_v"][0] as f32);
            let step = |s: &mut (BatteryState, f32), n: usize, _| {
                let current_a = trace["current_a"][n] as f32;
                s.1 = battery.step(&mut s.0, BatteryInput { current_a }).terminal_v;
            };
            walk(dt_s, trace, &mut state, step, &["soc", "rc_v", "terminal_v"], |(s, v)| {
                vec![s.soc.get().into(), s.rc.voltage_v.get().into(), f64::from(*v)]
            })
        }
    };
    check("battery_table", run(1.7834e-4, 9532.9));
    check("battery_slow", run(0.02, 1500.0));
}

#[test]
fn pid_round_a_lag() {
    let run = |derivative_s, amplitude: f64| {
        move |dt_s: f64, trace: &Columns| {
            let params = PidParams {
                proportional: 4.0,
                integral_per_s: 6.0,
                derivative_s,
                derivative_filter_s: 0.0,
                derivative_of: DerivativeOf::Error,
                dead_zone: 0.0,
                output_min: -1.0,
                output_max: 1.0,
                smoothing_per_s: 200.0,
                anti_windup: AntiWindup::Freeze,
            };
            let pid = Pid::new(params, dt(dt_s)).unwrap();
            let mut state = (PidState::default(), 0.0_f64);
            let step = |s: &mut (PidState, f64), n: usize, t: f64| {
                let wave = amplitude * (std::f64::consts::PI * t).sin();
                let reference = if amplitude > 0.0 { wave } else { trace["reference"][n] };
                let input = PidInput { reference: reference as f32, measurement: s.1 as f32 };
                let output = f64::from(pid.step(&mut s.0, input).output);
                s.1 += dt_s / (0.5 + dt_s) * (2.0 * output - s.1);
            };
            walk(dt_s, trace, &mut state, step, &["output", "measurement"], |(s, y)| {
                vec![s.output().into(), *y]
            })
        }
    };
    check("pid_step", run(0.0, 0.0));
    check("pid_sine", run(0.05, 1.6));
}

#[test]
fn body_coasts_down() {
    let run = |sin: f32| {
        move |dt_s: f64, trace: &Columns| {
            let body = Body::new(presets::EPOWERTRAIN_UDDS.powertrain.body, dt(dt_s)).unwrap();
            let road = Road { grade: Grade::from_sin(sin), ..Road::default() };
            let mut state =
                BodyState { speed_m_s: sum(trace["speed_m_s"][0]), ..BodyState::default() };
            let step = |s: &mut BodyState, _, _| {
                body.step(s, BodyInput { force_n: 0.0, road });
            };
            walk(dt_s, trace, &mut state, step, &["speed_m_s", "distance_m"], |s| {
                vec![s.speed_m_s.get().into(), s.distance_m.get().into()]
            })
        }
    };
    check("body_flat", run(0.0));
    check("body_uphill", run(0.02));
    check("body_downhill", run(-0.005));
    let standing = |name: &str| trace(name)["speed_m_s"].ends_with(&[0.0]);
    assert!(standing("body_flat") && standing("body_downhill") && !standing("body_uphill"));
}

/// What the bench carries from step to step.
#[derive(Default)]
struct Bench {
    motor: DcMotorState,
    load: RotationalLoadState,
    pid: PidState,
    supply_a: f64,
    energy_j: f64,
}

#[test]
fn converter_bench() {
    let run = |closed: bool| {
        move |dt_s: f64, trace: &Columns| {
            let motor = DcMotor::new(presets::CONVERTER_BENCH_MOTOR, dt(dt_s)).unwrap();
            let load = RotationalLoad::new(presets::CONVERTER_BENCH_LOAD, dt(dt_s)).unwrap();
            let params = PidParams {
                proportional: 0.05,
                integral_per_s: 0.02,
                smoothing_per_s: 1e3,
                ..PidParams::DEFAULT
            };
            let pid = Pid::new(params, dt(dt_s)).unwrap();
            let supply_v = presets::CONVERTER_BENCH_SUPPLY_V;
            let (times, duties) = (&trace["time_s"], &trace["duty"]);
            let step = |s: &mut Bench, n: usize, t: f64| {
                let (i, w) = (s.motor.current_a.get(), s.load.speed_rad_s.get());
                let duty = if closed {
                    let turn = std::f64::consts::TAU * 0.1 * t;
                    let reference = (75.0 * (1.0 - turn.cos())) as f32;
                    pid.step(&mut s.pid, PidInput { reference, measurement: w }).output
                } else {
                    let along = (t + dt_s - times[n - 1]) / (times[n] - times[n - 1]);
                    (duties[n - 1] + along * (duties[n] - duties[n - 1])) as f32
                };
                let seen = Converter::seen_through(Source::stiff(supply_v), duty);
                let (law, current) = motor.winding().law(seen, i, w);
                let (dw, slip) = load.solve(&s.load, law, motor.coast());
                s.motor.current_a.add(current.increment_a(dw));
                load.settle(&mut s.load, dw, slip);
                s.supply_a = f64::from(duty * s.motor.current_a.get());
                s.energy_j += f64::from(supply_v) * s.supply_a * dt_s;
            };
            let names = &["motor_a", "speed_rad_s", "supply_a", "energy_j"];
            walk(dt_s, trace, &mut Bench::default(), step, names, |s| {
                let (i, w) = (s.motor.current_a.get(), s.load.speed_rad_s.get());
                vec![i.into(), w.into(), s.supply_a, s.energy_j]
            })
        }
    };
    check("bench_open", run(false));
    check("bench_closed", run(true));
}

/// The end values that stray further from `theirs` than the table allows at this step.
fn wrong_ends(name: &str, step: usize, ours: &[(&str, f64)], theirs: &Columns) -> Vec<String> {
    let mut found = Vec::new();
    for (quantity, value) in ours {
        let (_, allowed) = END_TOLERANCES.iter().find(|t| t.0 == *quantity).expect("a tolerance");
        let off = (value / theirs[*quantity][0] - 1.0).abs();
        println!("{name} {quantity} at {} s: {off:.3e} of {:.1e}", STEPS_S[step], allowed[step]);
        if off.is_nan() || off > allowed[step] {
            found.push(format!("{name} {quantity} at {} s: {off:.3e}", STEPS_S[step]));
        }
    }
    found
}

/// The end values of one trace, as columns of one value each.
fn end_values(name: &str) -> Columns {
    let mut reader = read("udds_end_values");
    let header = reader.headers().unwrap().clone();
    let row = reader.records().map(Result::unwrap).find(|r| &r[0] == name).unwrap();
    let fields = header.iter().zip(&row).skip(1);
    fields.map(|(h, v)| (h.to_owned(), vec![v.parse().unwrap()])).collect()
}

fn udds(name: &str, set: &str) {
    let (car, cycle) = (vehicle::load(set).unwrap(), cycle::by_name("udds").unwrap());
    let theirs = end_values(name);
    let mut wrong = theirs.clone();
    for values in wrong.values_mut() {
        values[0] *= 1.25;
    }
    let strayed = std::cell::RefCell::new(Vec::new());
    check(name, |dt_s, trace| {
        let run = run::vehicle(&car, &Route::of_cycle(&cycle), 0.8, dt_s, true, &Unseen).unwrap();
        let (torque, battery) = (run.totals.motor_torque_nm, run.totals.battery_current_a);
        let energy_j = f64::from(run.energy.unwrap().electrochemical);
        let ends = [
            ("energy_kwh", energy_j / 3.6e6),
            ("torque_min_nm", torque.0.into()),
            ("torque_max_nm", torque.1.into()),
            ("battery_min_a", battery.0.into()),
            ("battery_max_a", battery.1.into()),
        ];
        let step = STEPS_S.iter().position(|s| *s == dt_s).unwrap();
        strayed.borrow_mut().extend(wrong_ends(name, step, &ends, &theirs));
        assert_eq!(wrong_ends(name, step, &ends, &wrong).len(), ends.len());
        let at = |f: fn(&run::TraceRow) -> f32| -> Vec<f64> {
            run.trace.iter().step_by(10).map(|r| f64::from(f(r))).collect()
        };
        assert_eq!(run.trace.len(), 10 * (trace["time_s"].len() - 1) + 1);
        vec![
            ("speed_m_s", at(|r| r.speed_m_s)),
            ("distance_m", at(|r| r.distance_m)),
            ("soc", at(|r| r.soc)),
            ("motor_a", at(|r| r.motor_current_a)),
            ("battery_a", at(|r| r.battery_current_a)),
        ]
    });
    assert!(strayed.borrow().is_empty(), "{strayed:#?}");
}

#[test]
fn udds_closed_loop() {
    udds("udds", "epowertrain-udds");
}

#[test]
fn udds_closed_loop_to_the_letter_of_the_table() {
    udds("udds_table", "epowertrain-udds-table");
}

#[test]
fn every_trace_is_compared() {
    for file in std::fs::read_dir(folder()).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        if path.extension().is_some_and(|e| e == "csv") && name != "udds_end_values" {
            assert!(TOLERANCES.iter().any(|t| t.0 == name), "{name} is compared with nothing");
        }
    }
}
