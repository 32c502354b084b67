use super::*;

pub const RECORD: Record = Record {
    soc: 0.62,
    soc_sd: 0.015,
    capacity_ah: 58.5,
    capacity_sd_ah: 0.7,
    resistance_factor: 1.18,
    resistance_factor_sd: 0.05,
    current_offset_a: -0.12,
    current_offset_sd_a: 0.02,
    throughput_ah: 12_345.6,
    written_at_s: Some(1_700_000_000),
};

/// The bytes with a checksum that fits.
fn sealed(mut bytes: [u8; LENGTH]) -> [u8; LENGTH] {
    let sum = checksum(&bytes).to_le_bytes();
    *bytes.last_chunk_mut().unwrap() = sum;
    bytes
}

#[test]
fn reads_what_it_wrote() {
    for record in [RECORD, Record { written_at_s: None, ..RECORD }] {
        let bytes = record.encode(7).unwrap();
        assert_eq!(Record::decode(&bytes), Ok((record, 7)));
    }
}

/// Records in the field must stay readable.
#[test]
fn has_the_layout_that_the_page_gives() {
    let bytes = RECORD.encode(0x0102_0304).unwrap();
    assert_eq!(bytes[..8], [b'V', b'S', 1, 1, 4, 3, 2, 1]);
    assert_eq!(bytes[8..12], 0.62_f32.to_le_bytes());
    assert_eq!(bytes[40..44], 12_345.6_f32.to_le_bytes());
    assert_eq!(bytes[44..48], 1_700_000_000_u32.to_le_bytes());
    assert_eq!(bytes[48..60], [0; 12]);
    assert_eq!(bytes[60..], 0x3490_8036_u32.to_le_bytes());
    assert_eq!(CHECKSUM.checksum(b"123456789"), 0xe306_9283, "CRC-32C");
}

#[test]
fn tells_what_is_no_record() {
    assert_eq!(Record::decode(&[0xff; LENGTH]), Err(RecordError::Blank));
    assert_eq!(Record::decode(&[0; LENGTH]), Err(RecordError::Unknown));
    let good = RECORD.encode(1).unwrap();
    let changed = |at: usize, to: u8| {
        let mut bytes = good;
        bytes[at] = to;
        bytes
    };
    assert_eq!(Record::decode(&sealed(changed(2, 2))), Err(RecordError::Unknown));
    assert_eq!(Record::decode(&sealed(changed(0, b'X'))), Err(RecordError::Unknown));
    assert_eq!(Record::decode(&changed(20, 0)), Err(RecordError::Corrupted));
    // Sealed, but the exponent of the state of charge makes it huge.
    assert_eq!(
        Record::decode(&sealed(changed(11, 0x7f))),
        Err(RecordError::Implausible(ParamError::NotARatio("record.soc")))
    );
}

#[test]
fn refuses_each_implausible_field() {
    use ParamError::{Negative, NotARatio, NotPositive, OutOfRange};
    let refused = |change: fn(&mut Record, Real), bad: Real, error| {
        let mut record = RECORD;
        change(&mut record, bad);
        assert_eq!(record.encode(0), Err(error), "{bad}");
        change(&mut record, Real::NAN);
        assert_eq!(record.encode(0).unwrap_err().field(), error.field());
    };
    refused(|r, x| r.soc = x, 1.01, NotARatio("record.soc"));
    refused(|r, x| r.soc_sd = x, -0.01, NotARatio("record.soc_sd"));
    refused(|r, x| r.capacity_ah = x, 0.0, NotPositive("record.capacity_ah"));
    refused(|r, x| r.capacity_ah = x, 1.1e6, OutOfRange("record.capacity_ah"));
    refused(|r, x| r.capacity_sd_ah = x, 59.0, OutOfRange("record.capacity_sd_ah"));
    refused(|r, x| r.resistance_factor = x, 0.009, OutOfRange("record.resistance_factor"));
    refused(|r, x| r.resistance_factor = x, 101.0, OutOfRange("record.resistance_factor"));
    refused(|r, x| r.resistance_factor_sd = x, -1.0, Negative("record.resistance_factor_sd"));
    refused(|r, x| r.current_offset_a = x, -10_001.0, OutOfRange("record.current_offset_a"));
    refused(|r, x| r.current_offset_sd_a = x, 10_001.0, OutOfRange("record.current_offset_sd_a"));
    refused(|r, x| r.throughput_ah = x, 1.1e9, OutOfRange("record.throughput_ah"));
}

#[test]
fn finds_the_newest_and_writes_over_the_other() {
    let slot = |sequence| RECORD.encode(sequence).unwrap();
    let blank = [0xff; LENGTH];
    for (first, second, newest, next) in [
        (slot(4), slot(5), (Slot::Second, 5), (Slot::First, 6)),
        (slot(6), slot(5), (Slot::First, 6), (Slot::Second, 7)),
        (slot(0), slot(u32::MAX), (Slot::First, 0), (Slot::Second, 1)),
        (slot(u32::MAX - 1), slot(u32::MAX), (Slot::Second, u32::MAX), (Slot::First, 0)),
        (slot(9), blank, (Slot::First, 9), (Slot::Second, 10)),
        (blank, slot(9), (Slot::Second, 9), (Slot::First, 10)),
        (slot(3), [0; LENGTH], (Slot::First, 3), (Slot::Second, 4)),
    ] {
        let found = Found::in_slots(&first, &second);
        let stored = found.newest.unwrap();
        assert_eq!(((stored.slot, stored.sequence), found.next()), (newest, next));
        assert_eq!(found.damaged, second == [0; LENGTH]);
    }
    let nothing = Found::in_slots(&blank, &blank);
    assert_eq!(nothing, Found { newest: None, damaged: false });
    assert_eq!(nothing.next(), (Slot::First, 0));
    assert_eq!(Found::in_slots(&blank, &[0; LENGTH]), Found { newest: None, damaged: true });
}
