//! `voltstep bms`.

use std::io::Write;
use std::process::Stdio;

use serde_json::Value;
use voltstep_bms::comm::can::{Command, Message, Status, alive_after};
use voltstep_bms::contactor::Phase;
use voltstep_bms::limit::Request;
use voltstep_bms::protect::Clear;

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

fn status(line: &str) -> Option<Status> {
    let (id, data) = line.split(' ').next_back()?.split_once('#')?;
    let bytes: Vec<u8> =
        (0..8).map(|at| u8::from_str_radix(&data[2 * at..2 * at + 2], 16).unwrap()).collect();
    Status::decode(&Message::new(u16::from_str_radix(id, 16).unwrap(), &bytes)?)
}

#[test]
fn a_vehicle_can_talk_to_a_pack_that_is_not_there() {
    let sandbox = Sandbox::new();
    let mut serve = sandbox.command(&["bms", "--serve", "--seconds", "2"]);
    let mut child = serve.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let mut alive = 0;
    for turn in 0..100 {
        let request = if turn < 20 { Request::Off } else { Request::Drive };
        let message = Command { request, clear: Clear::No }.encode_vehicle(alive);
        alive = alive_after(alive);
        write!(stdin, "({}) vcan0 {:03X}#", 0.02 * f64::from(turn), message.id()).unwrap();
        for byte in message.data() {
            write!(stdin, "{byte:02X}").unwrap();
        }
        writeln!(stdin).unwrap();
    }
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    let phases: Vec<Phase> = text.lines().filter_map(status).map(|status| status.phase).collect();
    assert_eq!(phases.len(), 200, "a status every 10 ms");
    assert!(phases.contains(&Phase::Standby), "{phases:?}");
    assert!(phases.contains(&Phase::Closed), "{phases:?}");
}
