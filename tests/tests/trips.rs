//! Trips against their measurements: the synthetic one always, real ones where they are.
//!
//! Real measurements are not part of the project: `VOLTSTEP_DATA` names the folder that has them
//! in `bmw-i3-trips/*.csv`. With `--nocapture` every trip prints a row of figures.

use std::path::{Path, PathBuf};

use plant_core::mechanics::body::RoadResistance;
use serde_json::Value;
use voltstep::cli::Mode;
use voltstep::read::vehicle::{self, Vehicle, VehicleBattery};
use voltstep::simulate::replay::{self, DEFAULT_VEHICLE, Options, Replay};
use voltstep::simulate::summary::NUMERICAL_WARNING;

/// "Good" is speed within ±1.6 km/h in `EPowertrain` (2025), section 5.5.2 \[m/s\].
const SPEED_RMS_M_S: f64 = 1.6 / 3.6;
/// The ledger is compensated sums in single precision.
const RESIDUAL: f64 = 1e-6;
/// Speed that is followed makes the same distance; ours stands still where a gap is bridged.
const DISTANCE: f64 = 0.01;
/// The battery alone on measured current: SOC is ampere-hours over a capacity, in readings of 0.1 %.
const SOC_RMSE: f64 = 0.02;
/// Ten times the step changes the drop of SOC by what the step dissipates: by less than the share
/// above which a summary warns.
const STEP: f64 = NUMERICAL_WARNING;

/// With true parameters, what is left in the voltage is the sensor: 0.03 V of noise and steps of
/// 0.1 V make 0.042 V, and the current's own noise over the resistance 0.01 V.
const TRUE_VOLTAGE_RMSE_V: f64 = 0.06;
/// … in SOC it is steps of 0.1 %, which make 0.0003 …
const TRUE_SOC_RMSE: f64 = 0.0005;
/// … and in the drop of SOC, 4 to 5 %, half such a step at its end.
const TRUE_SOC_DROP: f64 = 0.0125;
/// Height comes in steps of 1 m, auxiliary power in steps of 40 W.
const TRUE_ENERGY: f64 = 0.005;

/// Trips whose measured SOC cannot be right; their notes must say so.
const WRONG_SOC: [&str; 1] = ["TripB02"];
const WRONG_SOC_NOTE: &str = "SoC drop does not fit the ampere-hours";

fn synthetic() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/trips/synthetic.csv")
}

fn real_trips() -> Vec<PathBuf> {
    voltstep_tests::real_files("bmw-i3-trips")
}

fn options(mode: Mode, dt_ms: f64) -> Options {
    Options { vehicle: DEFAULT_VEHICLE.to_owned(), mode, dt_ms, ledger: true, show_progress: false }
}

/// Replays a trip; every figure must be finite, and every row of the trace.
#[track_caller]
fn replayed(path: &Path, mode: Mode, dt_ms: f64) -> Replay {
    let replay = replay::replay(&path.to_string_lossy(), &options(mode, dt_ms))
        .unwrap_or_else(|e| panic!("{}: {e:#}", path.display()));
    check_finite(&replay, mode);
    replay
}

#[track_caller]
fn check_finite(replay: &Replay, mode: Mode) {
    let trip = replay.trip.as_ref().unwrap();
    let summary = serde_json::to_value(&replay.summary).unwrap();
    let mut missing = Vec::new();
    find_missing(&summary, "", &mut missing);
    let torque = ["motor_torque_min_nm", "motor_torque_max_nm"].map(str::to_owned);
    let expected = if mode == Mode::Battery { torque.to_vec() } else { Vec::new() };
    missing.sort_unstable_by(|a, b| b.cmp(a));
    assert_eq!(missing, expected, "{}: figures that are not finite", trip.name);
    assert_eq!(replay.run.trace.len(), trip.len(), "{}: a row per sample", trip.name);
    for row in &replay.run.trace {
        let finite =
            [row.speed_m_s, row.duty, row.battery_current_a, row.battery_voltage_v, row.soc];
        assert!(finite.iter().all(|v| v.is_finite()), "{}: {row:?}", trip.name);
        assert!((0.0..=1.0).contains(&row.soc), "{}: {row:?}", trip.name);
    }
}

/// JSON has no NaN and no infinity: they become null.
fn find_missing(value: &Value, path: &str, missing: &mut Vec<String>) {
    match value {
        Value::Null => missing.push(path.to_owned()),
        Value::Object(entries) => {
            for (key, value) in entries {
                let dot = if path.is_empty() { "" } else { "." };
                find_missing(value, &format!("{path}{dot}{key}"), missing);
            }
        }
        _ => {}
    }
}

/// One row of the table that `--nocapture` shows.
fn show(replay: &Replay) {
    let summary = &replay.summary;
    let error = summary.error.as_ref().unwrap();
    let speed = summary
        .speed_error_rms_m_s
        .map_or(String::new(), |rms| format!(", speed RMS {rms:.4} m/s"));
    println!(
        "{:9} {:7} {:4} ms: SOC RMSE {:.3} %, SOC drop {:+5.1} %, energy {:+5.1} %, voltage \
         RMSE {:5.2} V, current RMSE {:5.2} A{speed}",
        summary.input,
        summary.mode,
        summary.dt_s * 1000.0,
        100.0 * error.soc_rmse,
        100.0 * error.soc_drop_rel,
        100.0 * error.energy_rel,
        error.voltage_rmse_v,
        error.current_rmse_a,
    );
}

/// The whole vehicle follows the measured speed, and the ledger closes.
#[track_caller]
fn check_vehicle(path: &Path, dt_ms: f64) -> Replay {
    let replay = replayed(path, Mode::Vehicle, dt_ms);
    show(&replay);
    let summary = &replay.summary;
    let rms = summary.speed_error_rms_m_s.unwrap();
    assert!(rms <= SPEED_RMS_M_S, "{}: speed error {rms} m/s RMS", summary.input);
    let residual = summary.energy_residual_rel.unwrap();
    assert!(residual.abs() <= RESIDUAL, "{}: residual {residual:e}", summary.input);
    let (ours, measured) =
        (summary.figures.distance_km, summary.measured.as_ref().unwrap().distance_km);
    assert!((ours / measured - 1.0).abs() < DISTANCE, "{}: {ours} km", summary.input);
    replay
}

/// The battery alone on the measured current follows the measured SOC.
#[track_caller]
fn check_battery(path: &Path, dt_ms: f64) {
    let replay = replayed(path, Mode::Battery, dt_ms);
    show(&replay);
    let summary = &replay.summary;
    let rmse = summary.error.as_ref().unwrap().soc_rmse;
    let noted = summary.notes.iter().any(|note| note.contains(WRONG_SOC_NOTE));
    let excepted = WRONG_SOC.contains(&summary.input.as_str());
    assert_eq!(noted, excepted, "{}: {:?}", summary.input, summary.notes);
    assert!(excepted || rmse < SOC_RMSE, "{}: SOC RMSE {rmse}", summary.input);
}

#[test]
fn the_vehicle_on_real_trips() {
    for path in real_trips() {
        check_vehicle(&path, 10.0);
    }
}

#[test]
fn the_battery_on_real_trips() {
    for path in real_trips() {
        check_battery(&path, 10.0);
    }
}

#[test]
fn a_real_trip_in_short_steps() {
    let trips = real_trips();
    if !trips.is_empty() {
        let path = trips.iter().find(|path| path.ends_with("TripA01.csv")).expect("TripA01.csv");
        step_makes_no_difference(path);
        check_battery(path, 1.0);
    }
}

#[test]
fn the_synthetic_trip() {
    step_makes_no_difference(&synthetic());
    check_battery(&synthetic(), 10.0);
    check_battery(&synthetic(), 1.0);
}

#[track_caller]
fn step_makes_no_difference(path: &Path) {
    let [short, long] = [1.0, 10.0].map(|dt_ms| {
        let figures = check_vehicle(path, dt_ms).summary.figures;
        figures.soc_initial - figures.soc_final
    });
    assert!((long / short - 1.0).abs() < STEP, "{}: SOC drop {short}, {long}", path.display());
}

/// The vehicle whose parameters the synthetic trip's differ from.
const CONSTANT_VEHICLE: &str = "bmw-i3-60ah-constant";

/// The vehicle that made the synthetic trip.
fn truth() -> Vehicle {
    let path = synthetic().with_extension("truth.toml");
    let truth: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    let truth = toml::Value::Table(truth);
    let number = |path: &str| -> f32 {
        let value = path.split('.').try_fold(&truth, |table, key| table.get(key));
        value.unwrap_or_else(|| panic!("no {path}")).to_string().parse().unwrap()
    };
    let mut vehicle = vehicle::load(CONSTANT_VEHICLE).unwrap();
    let VehicleBattery::Constant(battery) = &mut vehicle.powertrain.battery else {
        panic!("{CONSTANT_VEHICLE} has a map")
    };
    battery.capacity_ah = number("battery.capacity_ah");
    battery.series_resistance_ohm = number("battery.series_resistance_ohm");
    let branch = &mut battery.polarisation;
    branch.resistance_ohm = number("battery.polarisation.resistance_ohm");
    branch.capacitance_f = number("battery.polarisation.capacitance_f");
    vehicle.powertrain.auxiliary.power_w = number("auxiliary.power_w");
    let body = &mut vehicle.powertrain.body;
    body.mass_kg = number("body.mass_kg");
    let RoadResistance::Physical { rolling_coefficient, .. } = &mut body.resistance else {
        panic!("{:?}", body.resistance)
    };
    *rolling_coefficient = number("body.resistance.physical.rolling_coefficient");
    vehicle
}

fn synthetic_with(vehicle: Vehicle, mode: Mode) -> Replay {
    let trip = voltstep::read::trip::read(synthetic()).unwrap();
    let replay = replay::of_trip(vehicle, trip, mode, &options(mode, 1.0)).unwrap();
    check_finite(&replay, mode);
    show(&replay);
    replay
}

#[test]
fn the_true_battery_fits_the_synthetic_trip_and_another_does_not() {
    let error = synthetic_with(truth(), Mode::Battery).summary.error.unwrap();
    assert!(error.voltage_rmse_v < TRUE_VOLTAGE_RMSE_V, "{error:?}");
    assert!(error.soc_rmse < TRUE_SOC_RMSE, "{error:?}");
    assert!(error.soc_drop_rel.abs() < TRUE_SOC_DROP, "{error:?}");
    assert!(error.energy_rel.abs() < TRUE_ENERGY, "{error:?}");

    let preset = vehicle::load(CONSTANT_VEHICLE).unwrap();
    let error = synthetic_with(preset, Mode::Battery).summary.error.unwrap();
    assert!(error.voltage_rmse_v > TRUE_VOLTAGE_RMSE_V, "{error:?}");
    assert!(error.soc_rmse > TRUE_SOC_RMSE && error.soc_drop_rel > TRUE_SOC_DROP, "{error:?}");
}

#[test]
fn the_true_vehicle_fits_the_synthetic_trip_and_another_does_not() {
    let summary = synthetic_with(truth(), Mode::Vehicle).summary;
    let error = summary.error.unwrap();
    assert!(error.energy_rel.abs() < TRUE_ENERGY, "{error:?}");
    assert!(error.soc_rmse < TRUE_SOC_RMSE, "{error:?}");
    assert!(error.soc_drop_rel.abs() < TRUE_SOC_DROP, "{error:?}");

    let preset = vehicle::load(DEFAULT_VEHICLE).unwrap();
    let error = synthetic_with(preset, Mode::Vehicle).summary.error.unwrap();
    assert!(error.energy_rel.abs() > TRUE_ENERGY, "{error:?}");
}
