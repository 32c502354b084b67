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
    polarisation: Some(Polarisation { branches_v: [0.012, -0.34], load_a: 17.5, hysteresis: -0.5 }),
    resistor_heat_j: 61.0,
    lock_out_cause: 0x0203,
    log_sequence: 77,
};

/// The bytes with a checksum that fits.
fn sealed(mut bytes: [u8; LENGTH]) -> [u8; LENGTH] {
    let sum = checksum::<WORDS>(&bytes).to_le_bytes();
    *bytes.last_chunk_mut().unwrap() = sum;
    bytes
}

#[test]
fn reads_what_it_wrote() {
    let (untimed, unknown) = (
        Record { written_at_s: None, ..RECORD },
        Record { polarisation: None, lock_out_cause: 0, ..RECORD },
    );
    for record in [RECORD, untimed, unknown] {
        let bytes = record.encode(7).unwrap();
        assert_eq!(Record::decode(&bytes), Ok((record, 7)));
    }
}

/// Records in the field must stay readable.
#[test]
fn has_the_layout_that_the_page_gives() {
    let bytes = RECORD.encode(0x0102_0304).unwrap();
    assert_eq!(bytes[..8], [b'V', b'S', 2, 3, 4, 3, 2, 1]);
    assert_eq!(bytes[8..12], 0.62_f32.to_le_bytes());
    assert_eq!(bytes[40..44], 12_345.6_f32.to_le_bytes());
    assert_eq!(bytes[44..48], 1_700_000_000_u32.to_le_bytes());
    assert_eq!(bytes[48..52], 0.012_f32.to_le_bytes());
    assert_eq!(bytes[60..64], (-0.5_f32).to_le_bytes());
    assert_eq!(bytes[64..68], 61.0_f32.to_le_bytes());
    assert_eq!(bytes[68..76], [3, 2, 0, 0, 77, 0, 0, 0]);
    assert_eq!(bytes[76..92], [0; 16]);
    assert_eq!(CHECKSUM.checksum(b"123456789"), 0xe306_9283, "CRC-32C");
}

/// As the first version wrote it, with what that did not know left open.
#[test]
fn reads_the_first_version() {
    let mut bytes = [0xff; LENGTH];
    bytes[..48].copy_from_slice(&RECORD.encode(0x0102_0304).unwrap()[..48]);
    bytes[2..4].copy_from_slice(&[1, 1]);
    bytes[48..60].fill(0);
    bytes[60..64].copy_from_slice(&0x3490_8036_u32.to_le_bytes());
    let first = Record {
        polarisation: None,
        resistor_heat_j: 0.0,
        lock_out_cause: 0,
        log_sequence: 0,
        ..RECORD
    };
    assert_eq!(Record::decode(&bytes), Ok((first, 0x0102_0304)));
    for at in 0..64 {
        let mut wrong = bytes;
        wrong[at] ^= 4;
        assert!(Record::decode(&wrong).is_err(), "{at}");
    }
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
    assert_eq!(Record::decode(&sealed(changed(2, 3))), Err(RecordError::Unknown));
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
    refused(|r, x| r.resistor_heat_j = x, 1.1e6, OutOfRange("record.resistor_heat_j"));
    let polarised = |change: fn(&mut Polarisation, Real), bad, field| {
        let mut polarisation = Polarisation::NONE;
        change(&mut polarisation, bad);
        let record = Record { polarisation: Some(polarisation), ..RECORD };
        assert_eq!(record.encode(0), Err(OutOfRange(field)), "{bad}");
    };
    polarised(|p, x| p.branches_v[1] = x, -1.1e4, "record.polarisation.branches_v");
    polarised(|p, x| p.load_a = x, 1.1e5, "record.polarisation.load_a");
    polarised(|p, x| p.hysteresis = x, 1.1, "record.polarisation.hysteresis");
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

#[test]
fn goes_on_from_a_record_as_old_as_it_is() {
    use crate::estimate::coulomb::{CoulombCounter, CoulombParams};
    use crate::estimate::ekf::{Ekf, EkfParams};
    use plant_core::presets::PANASONIC_NCR18650PF as CELL;
    let dt = plant_core::Dt::from_s(1.0).unwrap();
    let filter = Ekf::new(EkfParams::typical(CELL, 3.65), dt).unwrap();
    let counter = CoulombCounter::new(
        CoulombParams {
            capacity_ah: CELL.capacity_ah,
            capacity_sd_ah: 0.1,
            charge_efficiency: 1.0,
            offset_sd_a: 0.03,
            gain_sd: 0.005,
            largest_current_a: 30.0,
            open_circuit: CELL.open_circuit,
            rest_voltage_sd_v: 0.01,
            rest_current_a: 0.03,
            rest_s: 1800.0,
        },
        dt,
    )
    .unwrap();
    let state = filter.start(0.6, 0.01, 25.0).unwrap();
    let health = crate::Health {
        capacity_ah: 2.6,
        capacity_sd_ah: 0.05,
        resistance_factor: 1.3,
        resistance_factor_sd: 0.1,
    };
    let record = Record { written_at_s: Some(1000), ..Record::of(filter.remember(&state), health) };
    let record = Record::decode(&record.encode(0).unwrap()).unwrap().0;
    assert_eq!(record.health(), health);
    assert_eq!((record.age_s(Some(4600)), record.age_s(Some(999))), (Some(3600.0), None));
    assert_eq!(
        (record.age_s(None), Record { written_at_s: None, ..record }.age_s(Some(1))),
        (None, None)
    );
    let mut before = 0.0;
    for now_s in [Some(1000), Some(87_400), None] {
        let filter_sd = filter.estimate(&record.filter(&filter, now_s, 25.0).unwrap()).soc_sd;
        let state = record.counter(&counter, now_s, 0.001);
        assert!((filter_sd - counter.soc_sd(&state)).abs() < 0.02, "{filter_sd}");
        assert!(filter_sd > before && counter.soc(&state) == record.soc, "{now_s:?}");
        before = filter_sd;
    }
    assert!(record.filter(&filter, None, Real::NAN).is_err());
}
