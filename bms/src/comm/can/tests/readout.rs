//! Reading out the log.

extern crate std;

use std::vec::Vec;

use super::super::*;
use super::{harmed, message};
use crate::log::{Entry, EntryError, Frame, Kind};
use crate::protect::Id;

fn entry(sequence: u32) -> Entry {
    let frame = Frame {
        cell_v: [3.1, 4.1],
        temperature_c: [-5.0, 41.0],
        current_a: -120.5,
        pack_v: 51.2,
        link_v: 50.9,
        soc: 0.31,
    };
    Entry { sequence, at_ms: 123_456, id: Id::Crash, kind: Kind::Tripped, phase: 6, frame }
}

fn read(reader: &mut LogReader, parts: &[Message]) -> Vec<Result<Entry, EntryError>> {
    parts.iter().filter_map(|part| reader.read(part)).collect()
}

#[test]
fn an_entry_comes_back() {
    let mut reader = LogReader::NEW;
    for sequence in [0, 7, u32::MAX] {
        let sent = entry(sequence);
        assert_eq!(read(&mut reader, &log_parts(&sent)), [Ok(sent)]);
    }
}

#[test]
fn lost_doubled_and_mixed_parts_give_no_entry() {
    let mut reader = LogReader::NEW;
    let parts = log_parts(&entry(7));
    for lost in 0..PARTS {
        let rest: Vec<_> = (0..PARTS).filter(|k| *k != lost).map(|k| parts[k]).collect();
        assert_eq!(read(&mut reader, &rest), [], "without {lost}");
        assert_eq!(read(&mut reader, &parts), [Ok(entry(7))], "after that");
    }
    let mut doubled = parts.to_vec();
    doubled.insert(4, parts[4]);
    assert_eq!(read(&mut reader, &doubled), []);
    let mut mixed = parts;
    mixed[0] = log_parts(&entry(8))[0];
    assert_eq!(read(&mut reader, &mixed), [Err(EntryError::Corrupted)]);
    let begun_again: Vec<_> = parts[..3].iter().chain(&parts).copied().collect();
    assert_eq!(read(&mut reader, &begun_again), [Ok(entry(7))]);
}

#[test]
fn one_wrong_bit_gives_no_entry() {
    let parts = log_parts(&entry(7));
    for part in 0..PARTS {
        // The last part is one byte long; what lies behind it is not looked at.
        let bits = if part + 1 < PARTS { 8..64 } else { 8..16 };
        for bit in bits {
            let mut harmed_parts = parts;
            harmed_parts[part] = harmed(&parts[part], bit);
            let mut reader = LogReader::NEW;
            let read = read(&mut reader, &harmed_parts);
            assert_eq!(read, [Err(EntryError::Corrupted)], "part {part}, bit {bit}");
        }
    }
}

#[test]
fn other_messages_and_parts_are_left_alone() {
    let mut reader = LogReader::NEW;
    assert_eq!(reader.read(&message(0x510, &[0; 8])), None);
    for part in (PARTS as u8)..0xff {
        assert_eq!(reader.read(&message(0x517, &[part, 0, 0, 0, 0, 0, 0, 0])), None);
    }
    assert_eq!(reader.read(&NO_ENTRY), Some(Err(EntryError::Blank)));
}

#[test]
fn what_is_asked_for_is_found() {
    let entries = [entry(4), entry(6), entry(9)];
    for (asked, found) in [
        (LogRequest::Newest, Some(9)),
        (LogRequest::Sequence(4), Some(4)),
        (LogRequest::Sequence(6), Some(6)),
        (LogRequest::Sequence(5), None),
        (LogRequest::Sequence(10), None),
        (LogRequest::Sequence(u32::MAX), None),
    ] {
        assert_eq!(LogRequest::decode(&asked.encode()), Some(asked));
        let answer = asked.find(entries.iter()).map(|entry| entry.sequence);
        assert_eq!(answer, found, "{asked:?}");
    }
    assert_eq!(LogRequest::Newest.find([].iter()), None);
    assert_eq!(LogRequest::decode(&NO_ENTRY), None);
}
