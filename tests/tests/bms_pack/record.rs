//! Whatever happens to a slot while it is written or later, the older record is read, or none:
//! never a wrong one.

use proptest::prelude::*;
use voltstep_bms::estimate::ekf::Polarisation;
use voltstep_bms::store::record::{
    Found, LENGTH, Record, RecordError, RecordStore, SaveError, Slot,
};

use crate::draw::cases;
use crate::flash::Flash;

fn record() -> impl Strategy<Value = Record> {
    (
        (0.0..=1.0_f32, 0.0..=1.0_f32, 0.1..1000.0_f32, 0.0..=1.0_f32),
        (0.5..5.0_f32, 0.0..2.0_f32, -10.0..10.0_f32, 0.0..10.0_f32),
        (0.0..1e6_f32, any::<Option<u32>>()),
        prop::option::of((prop::array::uniform2(-20.0..20.0_f32), 0.0..500.0_f32, -1.0..=1.0_f32)),
        (0.0..1e4_f32, any::<u16>(), any::<u32>()),
    )
        .prop_map(|(a, b, c, d, e)| Record {
            soc: a.0,
            soc_sd: a.1,
            capacity_ah: a.2,
            capacity_sd_ah: a.2 * a.3,
            resistance_factor: b.0,
            resistance_factor_sd: b.1,
            current_offset_a: b.2,
            current_offset_sd_a: b.3,
            throughput_ah: c.0,
            written_at_s: c.1,
            polarisation: d.map(|(branches_v, load_a, hysteresis)| Polarisation {
                branches_v,
                load_a,
                hysteresis,
            }),
            resistor_heat_j: e.0,
            lock_out_cause: e.1,
            log_sequence: e.2,
        })
}

/// Any sequence number, the last before the wrap to 0 often.
fn sequence() -> impl Strategy<Value = u32> {
    prop_oneof![any::<u32>(), (0..4_u32).prop_map(|n| u32::MAX - n)]
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn reads_what_was_written(record in record(), sequence in sequence()) {
        prop_assert_eq!(Record::decode(&record.encode(sequence).unwrap()), Ok((record, sequence)));
    }

    #[test]
    fn any_wrong_bit_gives_the_older_record(
        older in record(), newer in record(), sequence in sequence(),
    ) {
        let first = older.encode(sequence).unwrap();
        let second = newer.encode(sequence.wrapping_add(1)).unwrap();
        prop_assert_eq!(Found::in_slots(&first, &second).newest.unwrap().record, newer);
        for bit in 0..8 * LENGTH {
            let mut wrong = second;
            wrong[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(Record::decode(&wrong).is_err(), "bit {}", bit);
            let found = Found::in_slots(&first, &wrong);
            prop_assert_eq!(found.newest.unwrap().record, older);
            prop_assert!(found.damaged);
            prop_assert_eq!(found.next().0, Slot::Second);
            // And in the other order.
            prop_assert_eq!(Found::in_slots(&wrong, &first).newest.unwrap().record, older);
            prop_assert_eq!(Found::in_slots(&wrong, &wrong).newest, None);
        }
    }

    /// A write that stops after any byte, over what was there or over erased memory, with the
    /// next byte half programmed.
    #[test]
    fn any_torn_write_gives_the_older_record(
        oldest in record(), older in record(), newer in record(),
        sequence in sequence(), half in any::<u8>(),
    ) {
        let before = oldest.encode(sequence).unwrap();
        let first = older.encode(sequence.wrapping_add(1)).unwrap();
        let whole = newer.encode(sequence.wrapping_add(2)).unwrap();
        for ground in [before, [0xff; LENGTH], [0; LENGTH]] {
            for written in 0..LENGTH {
                let mut torn = ground;
                torn[..written].copy_from_slice(&whole[..written]);
                let mut halfway = torn;
                halfway[written] = (whole[written] | half) & (ground[written] | !half);
                // From the end, too: nothing says in which order the words are written.
                let mut backwards = ground;
                backwards[LENGTH - written..].copy_from_slice(&whole[LENGTH - written..]);
                for slot in [torn, halfway, backwards] {
                    let found = Found::in_slots(&first, &slot).newest.unwrap();
                    let expected = if slot == whole { newer } else { older };
                    prop_assert_eq!(found.record, expected, "after {}", written);
                }
            }
        }
    }

    #[test]
    fn nothing_else_is_a_record(bytes in prop::array::uniform32(any::<[u8; 2]>())) {
        let mut slot = [0; LENGTH];
        for (place, byte) in slot.iter_mut().zip(bytes.iter().flatten()) {
            *place = *byte;
        }
        prop_assert!(Record::decode(&slot).is_err());
        slot[..3].copy_from_slice(b"VS\x02");
        prop_assert_eq!(Record::decode(&slot), Err(RecordError::Corrupted));
    }

    /// Saved again and again while the power fails after any number of bytes erased or written:
    /// what is there afterwards is the last record saved or the one being saved.
    #[test]
    fn a_power_cut_loses_one_record_at_most(
        records in prop::collection::vec((record(), 0..400_u32), 2..30),
        unreadable in any::<bool>(),
    ) {
        let mut flash = Flash::new(512, unreadable);
        let mut last: Option<Record> = None;
        for (record, left) in records {
            flash.left = left;
            flash.torn = None;
            let mut store = RecordStore::new(flash, [0, 256]).unwrap();
            let saved = store.save(&record);
            prop_assert_eq!(store.load().newest.map(|stored| stored.record).is_some_and(|found| found == record), saved.is_ok());
            flash = store.release();
            flash.left = u32::MAX;
            let mut store = RecordStore::new(flash, [0, 256]).unwrap();
            let found = store.load().newest.map(|stored| stored.record);
            prop_assert!(found == last || found == Some(record), "{found:?} {last:?}");
            if saved.is_ok() {
                prop_assert_eq!(found, Some(record));
            }
            last = found;
            flash = store.release();
        }
    }
}

#[test]
fn refuses_slots_that_do_not_fit() {
    for (offsets, fits) in [
        ([0, 128], true),
        ([384, 0], true),
        ([0, 0], false),
        ([0, 64], false),
        ([0, 512], false),
        ([u32::MAX - 127, 0], false),
    ] {
        assert_eq!(RecordStore::new(Flash::new(512, false), offsets).is_ok(), fits, "{offsets:?}");
    }
}

#[test]
fn reports_a_memory_that_forgets() {
    let good = Record {
        soc: 0.5,
        soc_sd: 0.1,
        capacity_ah: 60.0,
        capacity_sd_ah: 1.0,
        resistance_factor: 1.0,
        resistance_factor_sd: 0.1,
        current_offset_a: 0.0,
        current_offset_sd_a: 0.1,
        throughput_ah: 0.0,
        written_at_s: None,
        polarisation: None,
        resistor_heat_j: 0.0,
        lock_out_cause: 0,
        log_sequence: 0,
    };
    let mut store = RecordStore::new(Flash::new(512, false), [0, 128]).unwrap();
    assert_eq!(store.load(), Found { newest: None, damaged: false });
    assert!(matches!(store.save(&Record { soc: 2.0, ..good }), Err(SaveError::Implausible(_))));
    store.save(&good).unwrap();
    let mut flash = store.release();
    flash.forgets = true;
    let mut store = RecordStore::new(flash, [0, 128]).unwrap();
    assert_eq!(store.save(&Record { soc: 0.4, ..good }), Err(SaveError::NotVerified));
    assert_eq!(store.load().newest.unwrap().record, good);
}
