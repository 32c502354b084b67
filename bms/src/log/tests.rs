extern crate std;

use std::vec;
use std::vec::Vec;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use plant_core::ParamError;

use super::*;
use crate::protect::{Faults, Id};

const FRAME: Frame = Frame {
    cell_v: [3.1, 3.2],
    temperature_c: [20.0, 30.0],
    current_a: -5.0,
    pack_v: 51.0,
    link_v: 50.5,
    soc: 0.5,
};

fn entry(sequence: u32) -> Entry {
    Entry {
        sequence,
        at_ms: sequence / 2,
        id: Id::Crash,
        kind: Kind::Tripped,
        phase: 3,
        frame: FRAME,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cut;

impl NorFlashError for Cut {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// A memory of four blocks of 256 bytes; the power fails after so many bytes more.
#[derive(Clone, Debug)]
struct Flash {
    bytes: Vec<u8>,
    left: usize,
}

impl Flash {
    fn new() -> Self {
        Self { bytes: vec![0xff; 1024], left: usize::MAX }
    }

    /// Whether one more byte is changed before the power fails.
    fn powered(&mut self) -> Result<(), Cut> {
        self.left = self.left.checked_sub(1).ok_or(Cut)?;
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = Cut;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Cut> {
        let from = offset as usize;
        bytes.copy_from_slice(&self.bytes[from..from + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 256;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Cut> {
        for at in from as usize..to as usize {
            self.powered()?;
            self.bytes[at] = 0xff;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Cut> {
        for (at, byte) in bytes.iter().enumerate() {
            self.powered()?;
            // A flash memory clears bits and sets none.
            self.bytes[offset as usize + at] &= byte;
        }
        Ok(())
    }
}

fn sequences(store: &mut LogStore<Flash>) -> Vec<u32> {
    let mut found: Vec<u32> =
        (0..store.slots()).filter_map(|slot| store.entry(slot)).map(|e| e.sequence).collect();
    found.sort_unstable();
    found
}

#[test]
fn every_entry_comes_back_and_no_wrong_bit_passes() {
    for id in Id::ALL {
        for kind in [Kind::Tripped, Kind::Healed, Kind::Cleared] {
            let entry = Entry { id, kind, ..entry(0xfff0_1234) };
            assert_eq!(Entry::decode(&entry.encode()), Ok(entry));
        }
    }
    let bytes = entry(9).encode();
    for bit in 0..8 * LENGTH {
        let mut wrong = bytes;
        wrong[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(Entry::decode(&wrong), Err(EntryError::Corrupted), "bit {bit}");
    }
    assert_eq!(Entry::decode(&[0xff; LENGTH]), Err(EntryError::Blank));
    assert_eq!(Entry::decode(&[0; LENGTH]), Err(EntryError::Corrupted));
}

#[test]
fn the_ring_keeps_the_newest_and_counts_the_rest() {
    let mut log = Log::new(100);
    let rows = Faults::NONE.with(Id::Crash).with(Id::Pin);
    log.write(Faults::NONE, Kind::Tripped, 1, 0, FRAME);
    assert_eq!(log.entries().count(), 0);
    log.write(rows, Kind::Tripped, 5, 2, FRAME);
    log.write(rows, Kind::Healed, 6, 2, FRAME);
    log.write(Faults::NONE.with(Id::Pin), Kind::Tripped, 9, 2, FRAME);
    let ids: Vec<_> = log.entries().map(|entry| (entry.sequence, entry.id)).collect();
    assert_eq!(ids[..3], [(100, Id::Pin), (101, Id::Crash), (102, Id::Pin)]);
    assert_eq!(log.occurrences(Id::Pin), Occurrences { count: 2, first_ms: 5, last_ms: 9 });
    assert_eq!(log.occurrences(Id::Crash), Occurrences { count: 1, first_ms: 5, last_ms: 5 });
    assert_eq!(log.occurrences(Id::Coolant), Occurrences::default());
    // Two are stored; then forty more come.
    for sequence in [100, 101] {
        assert_eq!(log.pending().map(|entry| entry.sequence), Some(sequence));
        log.stored();
    }
    for at_ms in 10..50 {
        log.write(Faults::NONE.with(Id::Record), Kind::Tripped, at_ms, 2, FRAME);
    }
    assert_eq!(log.entries().count(), KEPT);
    let kept: Vec<_> = log.entries().map(|entry| entry.sequence).collect();
    assert_eq!((kept[0], kept[KEPT - 1]), (113, 144));
    assert_eq!((log.lost(), log.pending().unwrap().sequence), (11, 113));
    for _ in 0..KEPT + 5 {
        log.stored();
    }
    assert_eq!(log.pending(), None);
}

#[test]
fn numbers_go_on_after_what_is_stored() {
    let next = |from: u32, newest: Option<u32>| {
        let mut log = Log::new(from);
        log.follow(newest);
        log.write(Faults::NONE.with(Id::Pin), Kind::Tripped, 1, 0, FRAME);
        // Too late: there is an event.
        log.follow(Some(1000));
        log.pending().map(|entry| entry.sequence)
    };
    assert_eq!(next(5, None), Some(5));
    assert_eq!(next(5, Some(3)), Some(5), "the record is newer");
    assert_eq!(next(5, Some(4)), Some(5));
    assert_eq!(next(5, Some(7)), Some(8), "the store is newer");
    assert_eq!(next(u32::MAX, Some(u32::MAX)), Some(0), "over the wrap");
}

#[test]
fn the_store_goes_on_where_it_was() {
    let mut store = LogStore::new(Flash::new(), 0, 4).unwrap();
    assert_eq!((store.newest(), store.slots()), (None, 16));
    for sequence in u32::MAX - 20..=u32::MAX {
        store.append(&entry(sequence)).unwrap();
        // Opened again each time.
        store = LogStore::new(store.release(), 0, 4).unwrap();
        assert_eq!(store.newest(), Some(sequence));
    }
    store.append(&entry(0)).unwrap();
    let mut store = LogStore::new(store.release(), 0, 4).unwrap();
    assert_eq!(store.newest(), Some(0), "over the wrap");
    assert!(sequences(&mut store).len() >= 13);
    for (offset, blocks) in [(0, 1), (0, 5), (16, 2), (768, 2)] {
        let error = LogStore::new(Flash::new(), offset, blocks).err();
        assert_eq!(error, Some(ParamError::OutOfRange("log_store.blocks")));
    }
}

/// The power fails after any byte of writing or erasing, at any place of the ring; then again while
/// the next entry is written.
#[test]
fn a_cut_at_any_step_loses_what_was_being_written_and_no_more() {
    for filled in 0..40_u32 {
        let mut store = LogStore::new(Flash::new(), 0, 4).unwrap();
        for sequence in 0..filled {
            store.append(&entry(sequence)).unwrap();
        }
        let before = store.release();
        let kept = sequences(&mut LogStore::new(before.clone(), 0, 4).unwrap());
        for cut in 0..=256 + LENGTH {
            let mut store = LogStore::new(before.clone(), 0, 4).unwrap();
            store.flash.left = cut;
            let whole = store.append(&entry(filled)).is_ok();
            let mut flash = store.release();
            flash.left = usize::MAX;
            let mut store = LogStore::new(flash, 0, 4).unwrap();
            let newest = if whole { Some(filled) } else { filled.checked_sub(1) };
            let complete = store.newest() == Some(filled);
            assert!(store.newest() == newest || complete, "{filled} {cut}");
            // All but the oldest block, which may be on its way out, is there.
            let found = sequences(&mut store);
            let safe = kept.iter().filter(|s| **s + 12 >= filled);
            for sequence in safe {
                assert!(found.contains(sequence), "{filled} {cut}: {sequence} of {found:?}");
            }
            // And it goes on.
            store.append(&entry(filled + 1)).unwrap();
            assert_eq!(store.newest(), Some(filled + 1));
            let mut store = LogStore::new(store.release(), 0, 4).unwrap();
            assert_eq!(store.newest(), Some(filled + 1), "{filled} {cut}");
            let found = sequences(&mut store);
            assert!(kept.iter().filter(|s| **s + 8 >= filled).all(|s| found.contains(s)));
        }
    }
}
