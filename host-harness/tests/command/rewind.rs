//! `voltstep rewind`.

#[allow(dead_code, reason = "the pack is driven by another loop here")]
#[path = "../../../bms/examples/own_pack/hardware.rs"]
mod hardware;
#[allow(dead_code, reason = "likewise")]
#[path = "../../../bms/examples/own_pack/pack.rs"]
mod pack;
#[path = "../../../bms/examples/own_pack/recorded.rs"]
mod recorded;

use serde_json::Value;

use super::Sandbox;

fn recording() -> Vec<u8> {
    let (mut memory, mut bytes) = (vec![0; 1 << 16], Vec::new());
    assert!(recorded::drive(&mut memory, |piece| bytes.extend_from_slice(piece)).unwrap());
    bytes
}

const THRESHOLD: &str = "CellVoltage(High,Msl).threshold";

#[test]
fn a_recording_gives_the_same_bits_and_other_thresholds_beside() {
    let sandbox = Sandbox::new();
    sandbox.write("log.vsrc", recording());
    let text = sandbox.succeed(&["rewind", "log.vsrc"]);
    assert!(text.contains("14 cells, 4 temperatures, ") && text.contains(": the same bits"));
    for part in ["As it was:", " CellVoltage(High, Msl) tripped", " OpenFirst, cause Hard"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let trips_s = |set: &[&str]| {
        let mut args = vec!["rewind", "log.vsrc", "--json"];
        args.extend(set.iter().flat_map(|set| ["--set", set]));
        let report: Value = serde_json::from_str(&sandbox.succeed(&args)).unwrap();
        assert_eq!(report["same"], true);
        [&report["was"]["trips_s"], &report["supposed"]["trips_s"]].map(Value::as_f64)
    };
    let [was, nothing] = trips_s(&[]);
    assert!(was.is_some() && nothing.is_none());
    // The reading rises by 0.2 V a second; a cell is looked at every 20 ms.
    let [_, lower] = trips_s(&[&format!("{THRESHOLD}-=0.02")]);
    let earlier_s = was.unwrap() - lower.unwrap();
    assert!((earlier_s - 0.1).abs() < 0.0205, "{earlier_s}");
    let higher = format!("{THRESHOLD}+=0.5");
    assert_eq!(trips_s(&[&higher])[1], None);
    let text = sandbox.succeed(&["rewind", "log.vsrc", "--set", &higher]);
    assert!(text.contains("With CellVoltage(High,Msl).threshold+=0.5:"), "{text}");
    assert!(text.contains("s, and would not have by then."), "{text}");
    assert!(text.contains("the contactors do otherwise; the rest is not known"), "{text}");
}

/// CRC-32C, bit by bit.
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |sum: u32, _| {
            if sum & 1 == 1 { sum >> 1 ^ 0x82f6_3b78 } else { sum >> 1 }
        })
    })
}

/// A recording of another state at the end, and of an input that was not so.
#[test]
fn other_bits_are_told() {
    let sandbox = Sandbox::new();
    let bytes = recording();
    let body = bytes.len() - 4;
    assert_eq!(checksum(&bytes[..body]).to_le_bytes(), bytes[body..]);
    // In the digest; the low bits of the current in the last call.
    for at in [24, body - 2] {
        let mut wrong = bytes.clone();
        wrong[at] ^= 1;
        let sum = checksum(&wrong[..body]).to_le_bytes();
        wrong[body..].copy_from_slice(&sum);
        sandbox.write("wrong.vsrc", wrong);
        let finished = sandbox.run(&["rewind", "wrong.vsrc"]);
        assert_eq!(finished.code, Some(1), "{at}: {}", finished.stderr);
        assert!(finished.stdout.contains(": NOT the same bits"), "{}", finished.stdout);
    }
}

#[test]
fn what_is_no_recording_or_no_parameter_is_refused() {
    let sandbox = Sandbox::new();
    let bytes = recording();
    sandbox.write("log.vsrc", &bytes);
    sandbox.write("short.vsrc", &bytes[..bytes.len() - 1]);
    sandbox.write("text.vsrc", "a drive");
    for (args, part) in [
        (&["rewind", "none.vsrc"][..], "none.vsrc: "),
        (&["rewind", "text.vsrc"], "text.vsrc: not a recording of a BMS"),
        (&["rewind", "short.vsrc"], "damaged: it is cut short"),
        (&["rewind", "log.vsrc", "--set", "threshold"], "write NAME=VALUE"),
        (&["rewind", "log.vsrc", "--set", "volts=1"], "`volts` names no number"),
        (&["rewind", "log.vsrc", "--set", "sample_s=0.3"], "bms.sample_s"),
    ] {
        let finished = sandbox.run(args);
        assert_eq!(finished.code, Some(2), "{args:?}");
        assert!(finished.stderr.contains(part), "{}", finished.stderr);
    }
}
