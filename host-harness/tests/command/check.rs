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

/// A load of the battery alone: by current, and by the power that this current gave.
#[test]
fn a_profile_runs_the_battery_alone() {
    let sandbox = Sandbox::new();
    sandbox
        .write("pulse.csv", "time_s,current_a\n0,0\n10,0\n10.1,100\n60,100\n60.1,-50\n120,-50\n");
    let said = sandbox.succeed(&["check", "pulse.csv"]);
    assert!(said.contains("a profile of current or power, by columns"), "{said}");
    let run = sandbox.succeed(&["replay", "pulse.csv", "--json"]);
    let summary: Value = serde_json::from_str(&run).unwrap();
    assert_eq!(summary["mode"], "profile");
    let soc = |which: &str| summary[which].as_f64().unwrap();
    // 100 A for 49.9 s and a flank on either side, then 50 A back.
    let out_as = 100.0 * 49.9 + 0.5 * 100.0 * 0.1 + 0.5 * (100.0 - 50.0) * 0.1 - 50.0 * 59.9;
    let capacity_ah = out_as / 3600.0 / (soc("soc_initial") - soc("soc_final"));
    assert!((55.0..65.0).contains(&capacity_ah), "{capacity_ah}");
    let trace = sandbox.read("out/pulse/trace.csv");
    assert!(trace.lines().count() > 120, "a row each second at least");
    let column = |name: &str| {
        let header: Vec<_> = trace.lines().next().unwrap().split(',').collect();
        let at = header.iter().position(|field| *field == name).unwrap();
        let of = |line: &str| line.split(',').nth(at).unwrap().parse::<f64>().unwrap();
        trace.lines().skip(1).map(of).collect::<Vec<_>>()
    };
    let (time_s, volts, amps) =
        (column("time_s"), column("battery_voltage_v"), column("battery_current_a"));
    let rows = time_s.iter().zip(volts.iter().zip(&amps));
    let rows: Vec<_> = rows.map(|(t, (v, a))| format!("{t},{}\n", v * a)).collect();
    sandbox.write("power.csv", format!("time_s,power_w\n{}", rows.concat()));
    sandbox.succeed(&["replay", "power.csv"]);
    let trace = sandbox.read("out/power/trace.csv");
    let last = trace.lines().last().unwrap();
    // Linear in power is not linear in current, but at its ends.
    assert!(
        last.split(',').any(|field| field.parse::<f64>().is_ok_and(|a| (a + 50.0).abs() < 0.2)),
        "{last}"
    );
    // Other commands say what it is.
    let run = sandbox.run(&["soc", "pulse.csv"]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.stderr.contains("this is a profile of current or power; expected"),
        "{}",
        run.stderr
    );
}
