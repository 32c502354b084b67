//! `voltstep check`.

use serde_json::Value;

use super::{Sandbox, TRIP};

#[test]
fn says_what_each_file_is_and_what_can_be_done_with_it() {
    let sandbox = Sandbox::new();
    sandbox.write("own.csv", "time_s,speed_mph,remark\n0,0,a\n1,10,b\n2,10,c\n");
    let said = sandbox.succeed(&["check", "own.csv", TRIP]);
    for part in [
        "own.csv: a driving cycle, by columns",
        "speed_mph",
        "mph",
        "not used: remark",
        "try: voltstep replay own.csv",
        "a trip, by columns",
        "Battery Voltage [V]",
        "--mode battery",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let found: Value =
        serde_json::from_str(&sandbox.succeed(&["check", "own.csv", "--json"])).unwrap();
    assert_eq!(found[0]["kind"], "cycle");
    assert_eq!(found[0]["table"]["samples"], 3);
    assert_eq!(found[0]["table"]["columns"][1]["unit"], "mph");
    assert_eq!(found[0]["table"]["columns"][1]["largest"], 4.4704);
}

#[test]
fn a_doubt_ends_with_code_1_and_what_cannot_be_read_with_2() {
    let sandbox = Sandbox::new();
    let rows = (0..200).map(|i| format!("{i},-2,3.7,{}\n", f64::from(i) / 1800.0));
    let rows = rows.collect::<Vec<_>>().concat();
    sandbox.write("turned.csv", format!("time_s,current_a,voltage_v,discharged_ah\n{rows}"));
    let run = sandbox.run(&["check", "turned.csv"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stdout.contains("doubt: the sign of the current is reversed"), "{}", run.stdout);
    sandbox.write("other.csv", "a,b\n1,2\n");
    let run = sandbox.run(&["check", "other.csv"]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""));
    for part in
        ["other.csv:1:1: not recognised", "a driving cycle (", "a circuit (TOML with [run])"]
    {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    // A unit that nobody converts is refused where the column can be missing, too.
    sandbox.write("slope.csv", "time_s,speed_m_s,grade_deg\n0,0,1\n1,1,1\n");
    let run = sandbox.run(&["check", "slope.csv"]);
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("slope.csv:1:18: unknown unit `deg`"), "{}", run.stderr);
}
