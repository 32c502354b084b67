//! `voltstep bms`.

use serde_json::Value;

use super::Sandbox;

#[test]
fn every_fault_is_met_in_time() {
    let sandbox = Sandbox::new();
    let table = sandbox.succeed(&["bms", "--each", "60", "--hours", "0.25"]);
    for part in ["opened in time", "0 missed, 0 late", "0.25 h of driving without a fault: 0 false"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    let json = sandbox.succeed(&["bms", "--each", "60", "--hours", "0", "--json"]);
    let report: Value = serde_json::from_str(&json).unwrap();
    let cases = report["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 47);
    for key in ["case", "verdict", "opened_ms", "before_harm_ms", "harm", "reason", "rows"] {
        assert!(cases[0].get(key).is_some(), "{key}: {}", cases[0]);
    }
}

#[test]
fn bad_figures_are_refused() {
    let sandbox = Sandbox::new();
    for (figure, value, part) in [
        ("--each", "0", "--each 0: must lie in 1..1000"),
        ("--hours", "1001", "--hours 1001: must lie in 0..1000"),
        ("--hours", "nan", "--hours NaN: must lie in 0..1000"),
    ] {
        let finished = sandbox.run(&["bms", figure, value]);
        assert_eq!(finished.code, Some(2), "{figure} {value}");
        assert!(finished.stderr.contains(part), "{}", finished.stderr);
    }
}
