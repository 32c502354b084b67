//! What a replay says and leaves.

use plant_core::powertrain::ledger::EnergyReport;
use serde_json::{Map, Value};

use crate::{OUTPUTS, Sandbox, TRIP};

/// Keys of `summary.json` that every replay has.
const ALWAYS: [&str; 9] = [
    "vehicle",
    "input",
    "mode",
    "dt_s",
    "steps",
    "run_wall_s",
    "realtime_factor",
    "limited_steps",
    "notes",
];
/// … and that the measurement of a trip has too.
const FIGURES: [&str; 10] = [
    "distance_km",
    "soc_initial",
    "soc_final",
    "battery_energy_kwh",
    "consumption_wh_per_km",
    "motor_torque_min_nm",
    "motor_torque_max_nm",
    "battery_current_min_a",
    "battery_current_max_a",
    "battery_voltage_min_v",
];
/// Keys where the whole vehicle drove.
const DRIVEN: [&str; 4] =
    ["speed_error_rms_m_s", "speed_error_max_m_s", "energy", "energy_residual_rel"];
/// Keys of `error`, on trips.
const ERRORS: [&str; 8] = [
    "soc_rmse",
    "soc_final",
    "soc_drop_rel",
    "voltage_rmse_v",
    "voltage_max_v",
    "current_rmse_a",
    "energy_rel",
    "soc_samples_missing",
];
/// Columns of `trace.csv`.
const COLUMNS: [&str; 18] = [
    "time_s",
    "reference_m_s",
    "speed_m_s",
    "distance_m",
    "slope_sin",
    "duty",
    "motor_torque_nm",
    "brake_n",
    "motor_current_a",
    "battery_current_a",
    "battery_voltage_v",
    "soc",
    "motor_torque_min_nm",
    "motor_torque_max_nm",
    "battery_current_min_a",
    "battery_current_max_a",
    "battery_voltage_min_v",
    "battery_voltage_max_v",
];
/// Columns beside them on trips.
const MEASURED: [&str; 4] = [
    "measured_motor_torque_nm",
    "measured_battery_current_a",
    "measured_battery_voltage_v",
    "measured_soc",
];
/// The trace and the summary come from the same numbers; the trace has seven digits.
const TRACE_TOLERANCE: f64 = 1e-6;
/// The ledger's terms stand in the summary as single-precision sums, 20 of them.
const LEDGER_TOLERANCE: f64 = 2e-6;

/// A number of the summary.
#[track_caller]
fn number(object: &Map<String, Value>, key: &str) -> f64 {
    let value = object.get(key).unwrap_or_else(|| panic!("no key `{key}`"));
    value.as_f64().unwrap_or_else(|| panic!("`{key}` is {value}, not a number"))
}

#[track_caller]
fn object<'a>(parent: &'a Map<String, Value>, key: &str) -> &'a Map<String, Value> {
    parent.get(key).and_then(Value::as_object).unwrap_or_else(|| panic!("no object `{key}`"))
}

#[track_caller]
fn close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * a.abs().max(1.0), "{what}: {a} against {b}");
}

/// Replays with `--json`; checks what holds for any replay and gives the summary.
#[track_caller]
fn replayed(sandbox: &Sandbox, args: &[&str]) -> Map<String, Value> {
    let stdout = sandbox.succeed(&[&["replay", "--json", "--out", "out"], args].concat());
    assert_eq!(sandbox.read("out/summary.json"), stdout);
    assert_eq!(sandbox.names("out"), OUTPUTS);
    let Value::Object(summary) = serde_json::from_str(&stdout).unwrap() else {
        panic!("not an object: {stdout}")
    };
    for key in ALWAYS.iter().chain(&FIGURES) {
        assert!(summary.contains_key(*key), "no key `{key}`");
    }
    assert!(number(&summary, "run_wall_s") > 0.0 && number(&summary, "realtime_factor") > 0.0);

    let svg = sandbox.read("out/report.svg");
    assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{}", &svg[..80]);
    assert!(svg.trim_end().ends_with("</svg>"));
    summary
}

/// The whole vehicle drove: every figure is a number, and the ledger closes.
fn check_driven(summary: &Map<String, Value>) {
    for key in FIGURES {
        number(summary, key);
    }
    for key in DRIVEN {
        assert!(summary.contains_key(key), "no key `{key}`");
    }
    let consumption =
        1000.0 * number(summary, "battery_energy_kwh") / number(summary, "distance_km");
    close(number(summary, "consumption_wh_per_km"), consumption, 1e-9, "consumption");
    assert!(number(summary, "energy_residual_rel").abs() <= 1e-6);

    let ledger = object(summary, "energy");
    let mut expected: Vec<_> = EnergyReport::default().terms().iter().map(|t| t.0).collect();
    expected.sort_unstable();
    let mut found: Vec<_> = ledger.keys().map(String::as_str).collect();
    found.sort_unstable();
    assert_eq!(found, expected);
    let not_a_sink = ["electrochemical", "open_circuit_explicit", "throughput"];
    let sinks = expected.iter().filter(|t| !not_a_sink.contains(t));
    let spent: f64 = sinks.map(|t| number(ledger, t)).sum();
    let throughput = number(ledger, "throughput");
    close(
        number(ledger, "electrochemical") / throughput,
        spent / throughput,
        LEDGER_TOLERANCE,
        "the sum of the ledger",
    );
}

/// The trace: its header, and its rows as numbers, missing ones as NaN.
fn trace(sandbox: &Sandbox, columns: &[&str]) -> Vec<Vec<f64>> {
    let text = sandbox.read("out/trace.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap().split(',').collect::<Vec<_>>(), columns);
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            let field = |f: &str| if f.is_empty() { f64::NAN } else { f.parse().unwrap() };
            line.split(',').map(field).collect()
        })
        .collect();
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row.len(), columns.len(), "row {i}");
        assert!(row[..COLUMNS.len()].iter().all(|v| v.is_finite()), "row {i}: {row:?}");
        assert!(i == 0 || row[0] > rows[i - 1][0], "time rises at row {i}");
    }
    rows
}

/// The trace ends where the summary does, and stays within its extremes.
fn check_trace(rows: &[Vec<f64>], summary: &Map<String, Value>) {
    let column = |name: &str| COLUMNS.iter().position(|c| *c == name).unwrap();
    let last = rows.last().unwrap();
    close(last[column("soc")], number(summary, "soc_final"), TRACE_TOLERANCE, "soc");
    let within = |name: &str, low: &str, high: Option<&str>| {
        let low = number(summary, low);
        let high = high.map_or(f64::INFINITY, |key| number(summary, key));
        // The first row is before the first step.
        for row in &rows[1..] {
            let value = row[column(name)];
            assert!(value >= low - 1e-3 && value <= high + 1e-3, "{name} {value}");
        }
    };
    within("battery_current_a", "battery_current_min_a", Some("battery_current_max_a"));
    within("battery_voltage_v", "battery_voltage_min_v", None);
    if summary["mode"] != "battery" {
        let km = last[column("distance_m")] / 1000.0;
        close(km, number(summary, "distance_km"), TRACE_TOLERANCE, "distance");
        within("motor_torque_nm", "motor_torque_min_nm", Some("motor_torque_max_nm"));
    }
}

fn check_measured(summary: &Map<String, Value>) {
    let (measured, error) = (object(summary, "measured"), object(summary, "error"));
    for key in FIGURES {
        number(measured, key);
    }
    for key in ERRORS {
        number(error, key);
    }
    let difference = number(summary, "soc_final") - number(measured, "soc_final");
    close(number(error, "soc_final"), difference, 1e-9, "soc_final");
}

#[test]
fn a_cycle() {
    let sandbox = Sandbox::new();
    let summary = replayed(&sandbox, &["udds"]);
    assert_eq!(summary["vehicle"], "bmw-i3-60ah");
    assert_eq!((&summary["input"], &summary["mode"]), (&"udds".into(), &"cycle".into()));
    assert_eq!((number(&summary, "dt_s"), number(&summary, "steps")), (0.001, 1_369_000.0));
    assert!((number(&summary, "distance_km") - 11.990).abs() < 0.005);
    check_driven(&summary);
    assert!(!summary.contains_key("measured") && !summary.contains_key("error"));
    let rows = trace(&sandbox, &COLUMNS);
    assert_eq!((rows.len(), rows[0][0], rows[13_690][0]), (13_691, 0.0, 1369.0));
    check_trace(&rows, &summary);
}

#[test]
fn a_trip() {
    let sandbox = Sandbox::new();
    let summary = replayed(&sandbox, &[TRIP]);
    assert_eq!((&summary["input"], &summary["mode"]), (&"synthetic".into(), &"trip".into()));
    check_driven(&summary);
    check_measured(&summary);
    number(object(&summary, "error"), "torque_rmse_nm");
    let rows = trace(&sandbox, &[COLUMNS.as_slice(), &MEASURED].concat());
    assert_eq!(rows.len(), 6001);
    check_trace(&rows, &summary);
}

#[test]
fn the_battery_alone_on_a_trip() {
    let sandbox = Sandbox::new();
    let summary = replayed(&sandbox, &[TRIP, "--mode", "battery", "--dt-ms", "10"]);
    assert_eq!((&summary["mode"], number(&summary, "dt_s")), (&"battery".into(), 0.01));
    assert_eq!(number(&summary, "steps"), 60_000.0);
    check_measured(&summary);
    for key in DRIVEN {
        assert!(!summary.contains_key(key), "`{key}` where nothing drove");
    }
    assert!(summary["motor_torque_min_nm"].is_null() && summary["motor_torque_max_nm"].is_null());
    // What flows is what was measured.
    assert!(number(object(&summary, "error"), "current_rmse_a") < 0.2);
    let rows = trace(&sandbox, &[COLUMNS.as_slice(), &MEASURED].concat());
    check_trace(&rows, &summary);
}

#[test]
fn a_cycle_file_and_a_vehicle_file() {
    let sandbox = Sandbox::new();
    sandbox.write("hill start.csv", "time_s,speed_m_s\n10,0\n20,8\n30,8\n35,0\n");
    let vehicle = include_str!("../../data/vehicles/epowertrain-udds.toml");
    sandbox.write("mine.toml", vehicle.replace("name = \"epowertrain-udds\"", "name = \"mine\""));
    let summary = replayed(&sandbox, &["hill start.csv", "--vehicle", "mine.toml"]);
    assert_eq!((&summary["vehicle"], &summary["input"]), (&"mine".into(), &"hill start".into()));
    assert!((number(&summary, "distance_km") - 0.140).abs() < 0.001);
    check_driven(&summary);
    check_trace(&trace(&sandbox, &COLUMNS), &summary);
}

#[cfg(unix)]
#[test]
fn what_is_read_from_a_pipe() {
    let sandbox = Sandbox::new();
    let cycle = "time_s,speed_m_s\n0,0\n5,4\n9,4\n12,0\n";
    let trip = std::fs::read(TRIP).unwrap();
    for (content, mode) in [(cycle.as_bytes(), "cycle"), (&trip, "trip")] {
        let mut child = sandbox
            .command(&["replay", "/dev/stdin", "--json", "--out", "out", "--dt-ms", "10"])
            .stdin(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), content).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{mode}");
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(summary["mode"], mode);
    }
}

#[test]
fn a_second_run_replaces_the_first_and_comes_to_the_same() {
    let sandbox = Sandbox::new();
    let args = ["us06", "--dt-ms", "10"];
    let first = replayed(&sandbox, &args);
    let (trace, other) = (sandbox.read("out/trace.csv"), replayed(&sandbox, &["nedc"]));
    assert_ne!(sandbox.read("out/trace.csv"), trace);
    assert_ne!(first["soc_final"], other["soc_final"]);
    let second = replayed(&sandbox, &args);
    assert_eq!(sandbox.read("out/trace.csv"), trace);
    for key in FIGURES.iter().chain(&["energy", "energy_residual_rel"]) {
        assert_eq!(first[*key], second[*key], "{key}");
    }
}

#[test]
fn what_a_long_step_costs_is_said() {
    let sandbox = Sandbox::new();
    let energy = |dt_ms| {
        let summary = replayed(&sandbox, &["udds", "--no-ledger", "--dt-ms", dt_ms]);
        let notes: Vec<_> = summary["notes"].as_array().unwrap().clone();
        let error = summary.get("step_error").map(|e| e["energy_rel"].as_f64().unwrap());
        (number(&summary, "battery_energy_kwh"), error, notes)
    };
    let (exact, none, _) = energy("1");
    assert_eq!(none, None);
    for (dt_ms, noted) in [("10", false), ("100", true), ("200", true)] {
        let (kwh, error, notes) = energy(dt_ms);
        close(error.unwrap(), kwh / exact - 1.0, 1e-9, "the error");
        let found = notes.iter().any(|n| {
            n.as_str().unwrap().starts_with(&format!("in steps of {dt_ms} ms the energy"))
        });
        assert_eq!(found, noted, "{dt_ms}: {notes:?}");
        assert_eq!(error.unwrap().abs() > 0.005, noted, "{dt_ms}: {error:?}");
    }
}

#[test]
fn the_ledger_can_be_left_out() {
    let sandbox = Sandbox::new();
    let args = ["hwfet", "--dt-ms", "10"];
    let with = replayed(&sandbox, &args);
    let without = replayed(&sandbox, &[args.as_slice(), &["--no-ledger"]].concat());
    assert!(!without.contains_key("energy") && !without.contains_key("energy_residual_rel"));
    for key in FIGURES {
        assert_eq!(with[key], without[key], "{key}");
    }
}

#[test]
fn a_table_for_people_and_a_folder_by_default() {
    let sandbox = Sandbox::new();
    let text = sandbox.succeed(&["replay", TRIP, "--dt-ms", "10"]);
    for word in ["synthetic", "bmw-i3-60ah", "measured", "consumption", "out/synthetic"] {
        assert!(text.contains(word), "`{word}` in {text}");
    }
    assert_eq!(sandbox.names("."), ["out"]);
    assert_eq!(sandbox.names("out/synthetic"), OUTPUTS);
}

#[test]
fn the_list_names_every_cycle_and_every_vehicle() {
    let list = Sandbox::new().succeed(&["list"]);
    for (name, length_s, distance_km) in [
        ("udds", "1369", "11.990"),
        ("hwfet", "765", "16.507"),
        ("us06", "600", "12.888"),
        ("wltc3b", "1800", "23.266"),
        ("nedc", "1180", "10.931"),
    ] {
        let row = list.lines().find(|line| line.contains(&format!(" {name} ")));
        let row = row.unwrap_or_else(|| panic!("no row for {name}"));
        assert!(row.contains(length_s) && row.contains(distance_km), "{row}");
    }
    for name in [
        "bmw-i3-60ah",
        "bmw-i3-60ah-constant",
        "bmw-i3-60ah-epowertrain",
        "epowertrain-udds",
        "epowertrain-udds-table",
    ] {
        assert!(list.contains(&format!(" {name} ")), "{name}");
    }
}

/// A vehicle with temperatures shows them; on a hard cycle they derate it, and the summary says so.
#[test]
fn a_vehicle_that_heats_up() {
    let sandbox = Sandbox::new();
    let with: Vec<_> = COLUMNS.into_iter().chain(["machine_c", "inverter_c"]).collect();
    let hottest = |summary: &Map<String, Value>| {
        let rows = trace(&sandbox, &with);
        let hot = object(summary, "drive_temperatures");
        assert_eq!(rows[0][with.len() - 2..], [50.0, 50.0]);
        for (column, key) in [(with.len() - 2, "machine_max_c"), (with.len() - 1, "inverter_max_c")]
        {
            let most = rows.iter().map(|row| row[column]).fold(f64::MIN, f64::max);
            // Between two rows of the trace it is a little hotter.
            assert!(
                most <= number(hot, key) + 1e-3 && most > number(hot, key) - 2.0,
                "{key}: {most}"
            );
        }
        (number(hot, "inverter_max_c"), number(hot, "current_limit_left_min"))
    };
    let summary = replayed(&sandbox, &["udds", "--vehicle", "bmw-i3-60ah-thermal"]);
    check_driven(&summary);
    let (inverter_c, left) = hottest(&summary);
    assert!((55.0..95.0).contains(&inverter_c) && left == 1.0, "{inverter_c} {left}");
    let warm = ["replay", "udds", "--vehicle", "bmw-i3-60ah-thermal", "--out", "table"];
    let text = sandbox.succeed(&warm);
    assert!(text.contains("machine, highest [°C]") && text.contains("inverter, highest [°C]"));
    assert!(!text.contains("a hot drive left"), "{text}");
    // Full throttle and hard braking, over and over.
    let rows: Vec<_> = (0..=300_u32).map(|k| format!("{},{}\n", 4 * k, 18 * (k % 2))).collect();
    sandbox.write("hard.csv", format!("time_s,speed_m_s\n{}", rows.concat()));
    let summary = replayed(&sandbox, &["hard.csv", "--vehicle", "bmw-i3-60ah-thermal"]);
    let (inverter_c, left) = hottest(&summary);
    assert!(
        (100.0..125.0).contains(&inverter_c) && (0.05..0.95).contains(&left),
        "{inverter_c} {left}"
    );
    let notes = summary["notes"].as_array().unwrap();
    assert!(notes.iter().any(|n| n.as_str().unwrap().starts_with("a hot drive left")), "{notes:?}");
}
