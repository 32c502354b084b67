//! `voltstep bms SCENARIO.toml`.

use serde_json::Value;

use super::Sandbox;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/scenarios/heated-cell.toml");

fn scenario(rest: &str) -> String {
    format!("[start]\nsoc = 0.97\ntemperature_c = 25\n[drive]\n{rest}\n")
}

#[test]
fn the_example_opens_before_harm() {
    let sandbox = Sandbox::new();
    let table = sandbox.succeed(&["bms", EXAMPLE]);
    for part in ["TemperatureReadsLow", "CellHeated", "opened in time", "ms before a cell would"] {
        assert!(table.contains(part), "{part}: {table}");
    }
    let json: Value = serde_json::from_str(&sandbox.succeed(&["bms", EXAMPLE, "--json"])).unwrap();
    assert_eq!(json["verdict"], "in-time");
    assert!(json["before_harm_ms"].as_u64().unwrap() > 1000, "{json}");
    assert_eq!(json["faults"][1]["planted"]["fault"], "cell-heated");
    assert!(json["faults"][1]["noticed_ms"].as_u64().unwrap() > 0, "{json}");
    let recorded = json["recorded"].as_array().unwrap();
    assert!(recorded.iter().any(|event| event["what"] == "tripped"), "{json}");
    assert!(
        json["felt"]["most_a"].as_f64().is_some() && json["false_trips"] == Value::Array(vec![])
    );
}

#[test]
fn a_charger_that_goes_mad_is_stopped_and_a_quiet_one_is_no_fault() {
    let sandbox = Sandbox::new();
    let fault = "charge_a = 20\n[[fault]]\nkind = \"overcharge\"\nat_s = 4\namount = 150";
    sandbox.write("mad.toml", scenario(fault));
    let json: Value =
        serde_json::from_str(&sandbox.succeed(&["bms", "mad.toml", "--json"])).unwrap();
    assert_eq!((&json["name"], &json["verdict"]), (&"mad".into(), &"in-time".into()));
    sandbox.write("quiet.toml", scenario("charge_a = 20\nseconds = 20").replace("0.97", "0.5"));
    let table = sandbox.succeed(&["bms", "quiet.toml"]);
    assert!(table.contains("quiet: no fault in 20.000 s"), "{table}");
}

/// Without a BMS that notices, exit code 1: a sensor's error that is on no list of what may be
/// overlooked, in a drive that ends before it can show.
#[test]
fn what_is_missed_ends_with_code_1() {
    let sandbox = Sandbox::new();
    let fault = "charge_a = 20\nseconds = 4.01\n[[fault]]\nkind = \"interlock\"\nat_s = 4";
    sandbox.write("short.toml", scenario(fault));
    let finished = sandbox.run(&["bms", "short.toml"]);
    assert_eq!((finished.code, finished.stderr.as_str()), (Some(1), ""));
    assert!(finished.stdout.contains("short: missed"), "{}", finished.stdout);
}

#[test]
fn a_bad_scenario_is_refused_with_its_place() {
    let sandbox = Sandbox::new();
    sandbox.write("bad.toml", scenario("charge_a = 20\n[[fault]]\nkind = \"crash\"\nat_s = \"x\""));
    sandbox.write("text.toml", b"\xff\xfe");
    sandbox.write("cycle.csv", "time_s,speed_m_s\n0,0\n1,x\n");
    sandbox.write("by.toml", scenario("cycle = \"cycle.csv\"\nvehicle = \"bmw-i3-60ah\""));
    for (file, part) in [
        ("nowhere.toml", "nowhere.toml: cannot read"),
        ("bad.toml", "bad.toml:8:8: `at_s` in [fault[0]]: expected a number, found the text"),
        ("text.toml", "text.toml:1:1: not a text"),
        ("by.toml", "cycle.csv:3:3"),
    ] {
        let finished = sandbox.run(&["bms", file]);
        assert_eq!(finished.code, Some(2), "{file}");
        assert!(finished.stderr.contains(part), "{file}: {}", finished.stderr);
    }
    let both = sandbox.run(&["bms", "bad.toml", "--serve"]);
    assert_eq!(both.code, Some(2), "{}", both.stderr);
}
