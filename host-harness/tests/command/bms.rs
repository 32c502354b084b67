//! `voltstep bms`.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use voltstep_bms::comm::can::{Command, Message, Status, alive_after};
use voltstep_bms::contactor::Phase;
use voltstep_bms::limit::Request;
use voltstep_bms::protect::Clear;

#[cfg(target_os = "linux")]
use socketcan::{CanSocket, EmbeddedFrame, Socket};

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
    let harmless = cases.iter().filter(|case| case["verdict"] == "harmless").count();
    let unnoticed = report["unnoticed"].as_array().unwrap();
    let reasons: u64 = unnoticed.iter().map(|of| of["cases"].as_u64().unwrap()).sum();
    assert_eq!(usize::try_from(reasons).unwrap(), harmless, "{unnoticed:?}");
    let kinds = report["kinds"].as_array().unwrap();
    assert!(kinds.len() > 30 && kinds[0]["fault"] == "cell-wire-open", "{kinds:?}");
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

/// `voltstep bms --serve --listen 127.0.0.1:0`, and the address that it prints.
fn listening(sandbox: &Sandbox, seconds: &str) -> (Child, BufReader<ChildStdout>, String) {
    let args = ["bms", "--serve", "--listen", "127.0.0.1:0", "--seconds", seconds];
    let mut child = sandbox.command(&args).stdout(Stdio::piped()).spawn().unwrap();
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut said = String::new();
    out.read_line(&mut said).unwrap();
    let address = said.trim().strip_prefix("listening on ").unwrap().to_owned();
    (child, out, address)
}

fn connect(address: &str) -> TcpStream {
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    stream
}

fn request(stream: &mut TcpStream, request: Request, alive: u8) {
    let message = Command { request, clear: Clear::No }.encode_vehicle(alive);
    let mut line = format!("(1700000000.5) can0 {:03X}#", message.id());
    for byte in message.data() {
        line.push_str(&format!("{byte:02X}"));
    }
    writeln!(stream, "{line}").unwrap();
}

#[test]
fn several_vehicles_can_talk_to_it_over_tcp() {
    let sandbox = Sandbox::new();
    let (mut child, _out, address) = listening(&sandbox, "10");
    let (mut speaks, listens) = (connect(&address), connect(&address));
    let mut lines = BufReader::new(listens).lines();
    let start = Instant::now();
    let (mut alive, mut closed, mut seen) = (0, false, 0);
    while !closed && start.elapsed() < Duration::from_secs(9) {
        let wanted = if seen < 20 { Request::Off } else { Request::Drive };
        request(&mut speaks, wanted, alive);
        alive = alive_after(alive);
        // A status comes every 10 ms, a request is due every 20.
        for _ in 0..2 {
            let status = (&mut lines).map_while(Result::ok).find_map(|line| status(&line));
            let status = status.expect("the pack went on");
            closed |= status.phase == Phase::Closed;
            seen += 1;
        }
    }
    assert!(closed, "what one asked for, the other saw: {seen} statuses");
    // Whoever goes, sends rubbish or a line without end takes nothing away from the others.
    drop(speaks);
    let mut wild = connect(&address);
    wild.write_all(&vec![b'x'; 20_000]).unwrap();
    let after = (&mut lines).map_while(Result::ok).filter_map(|line| status(&line)).take(50);
    assert_eq!(after.count(), 50);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(lines.map_while(Result::ok).count() < 100_000, "it ended");
}

#[test]
fn only_an_address_of_this_machine_is_served() {
    let sandbox = Sandbox::new();
    let holds = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = holds.local_addr().unwrap().to_string();
    for (address, part) in [
        ("0.0.0.0:0", "--listen 0.0.0.0:0: must be an address of this machine alone"),
        ("nowhere", "invalid value 'nowhere'"),
        (taken.as_str(), "--listen 127.0.0.1:"),
    ] {
        let finished = sandbox.run(&["bms", "--serve", "--seconds", "1", "--listen", address]);
        assert_eq!(finished.code, Some(2), "{address}");
        assert!(finished.stderr.contains(part), "{}", finished.stderr);
    }
    assert_eq!(sandbox.run(&["bms", "--listen", "127.0.0.1:0"]).code, Some(2));
}

#[test]
#[cfg(target_os = "linux")]
fn an_interface_of_socketcan_is_served() {
    let sandbox = Sandbox::new();
    let nowhere = sandbox.run(&["bms", "--serve", "--seconds", "1", "--can", "none0"]);
    assert_eq!(nowhere.code, Some(2));
    assert!(nowhere.stderr.contains("--can none0"), "{}", nowhere.stderr);
    if !Path::new("/sys/class/net/vcan0").exists() {
        // Not by a macro: the test runner keeps to itself what a test that passes prints.
        let how = "`ip link add vcan0 type vcan; ip link set up vcan0`";
        let _ = writeln!(std::io::stderr(), "SKIPPED the test on SocketCAN: no vcan0 ({how})");
        return;
    }
    let listens = CanSocket::open("vcan0").unwrap();
    listens.set_read_timeout(Duration::from_secs(10)).unwrap();
    let args = ["bms", "--serve", "--seconds", "2", "--can", "vcan0"];
    let mut child = sandbox.command(&args).spawn().unwrap();
    let mut found = 0;
    while found < 50 {
        let frame = listens.read_frame().unwrap();
        found += usize::from(Message::of(&frame).is_some_and(|m| Status::decode(&m).is_some()));
        assert!(frame.dlc() <= 8);
    }
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
