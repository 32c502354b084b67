//! Entries on a flash memory, in a ring of erase blocks.

use embedded_storage::nor_flash::NorFlash;
use plant_core::ParamError;

use super::entry::{Entry, EntryError, LENGTH, later};

/// A ring of entries on a flash memory. An entry is written into erased memory and never touched
/// again until its block is the oldest and is erased as a whole; so a cut at any moment loses the
/// entry that was being written, or entries of the block that was being erased, the oldest ones.
///
/// ```
/// # use embedded_storage::nor_flash::NorFlash;
/// # use voltstep_bms::log::{Log, LogStore};
/// fn save_one<F: NorFlash>(store: &mut LogStore<F>, log: &mut Log) {
///     if let Some(entry) = log.pending() {
///         if store.append(entry).is_ok() {
///             log.stored();
///         }
///     }
/// }
/// ```
#[derive(Debug)]
pub struct LogStore<F> {
    pub(super) flash: F,
    offset: u32,
    slots: u32,
    /// Where the next entry goes.
    next: u32,
    newest: Option<u32>,
}

/// Why an entry was not stored. What was stored before is still there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError<E> {
    /// The memory failed.
    Flash(E),
    /// The memory does not give back what was written; the next entry goes elsewhere.
    NotVerified,
}

impl<F: NorFlash> LogStore<F> {
    const SLOT: u32 = {
        assert!(LENGTH.is_multiple_of(F::WRITE_SIZE) && LENGTH.is_multiple_of(F::READ_SIZE));
        assert!(F::ERASE_SIZE.is_multiple_of(LENGTH) && F::ERASE_SIZE <= u32::MAX as usize);
        #[expect(clippy::cast_possible_truncation, reason = "64")]
        let bytes = LENGTH as u32;
        bytes
    };
    const BLOCK: u32 = {
        #[expect(clippy::cast_possible_truncation, reason = "checked above")]
        let bytes = F::ERASE_SIZE as u32;
        bytes
    };

    /// Takes so many erase blocks from an offset on, two at least, and looks for the newest entry.
    /// A memory that cannot write or erase whole entries is refused when compiling.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] where they are not aligned or do not fit the memory.
    pub fn new(flash: F, offset: u32, blocks: u32) -> Result<Self, ParamError> {
        let end = u64::from(offset) + u64::from(blocks) * u64::from(Self::BLOCK);
        let fits = offset.is_multiple_of(Self::BLOCK) && end <= flash.capacity() as u64;
        if blocks < 2 || !fits || end > u64::from(u32::MAX) {
            return Err(ParamError::OutOfRange("log_store.blocks"));
        }
        let slots = blocks * (Self::BLOCK / Self::SLOT);
        let mut store = Self { flash, offset, slots, next: 0, newest: None };
        let mut place = None;
        for slot in 0..slots {
            if let Some(Ok(entry)) = store.read(slot)
                && store.newest.is_none_or(|newest| later(entry.sequence, newest))
            {
                store.newest = Some(entry.sequence);
                place = Some(slot);
            }
        }
        store.next = place.map_or(0, |slot| store.after(slot));
        Ok(store)
    }

    /// The number of the newest entry.
    #[must_use]
    pub const fn newest(&self) -> Option<u32> {
        self.newest
    }

    /// How many entries fit.
    #[must_use]
    pub const fn slots(&self) -> u32 {
        self.slots
    }

    /// The entry in a slot; `None` where there is none.
    pub fn entry(&mut self, slot: u32) -> Option<Entry> {
        self.read(slot).and_then(Result::ok)
    }

    /// Writes an entry and reads it back.
    ///
    /// # Errors
    /// [`StoreError`]; it may be tried again.
    pub fn append(&mut self, entry: &Entry) -> Result<(), StoreError<F::Error>> {
        // What a cut left half written lies in the way: at most a block of it.
        for _ in 0..Self::BLOCK / Self::SLOT {
            if self.next.is_multiple_of(Self::BLOCK / Self::SLOT) {
                let block = self.offset + self.next * Self::SLOT;
                self.flash.erase(block, block + Self::BLOCK).map_err(StoreError::Flash)?;
            }
            if self.read(self.next) == Some(Err(EntryError::Blank)) {
                break;
            }
            self.next = self.after(self.next);
        }
        let (slot, bytes) = (self.next, entry.encode());
        self.next = self.after(slot);
        let place = self.offset + slot * Self::SLOT;
        self.flash.write(place, &bytes).map_err(StoreError::Flash)?;
        let mut read = [0; LENGTH];
        self.flash.read(place, &mut read).map_err(StoreError::Flash)?;
        if read != bytes {
            return Err(StoreError::NotVerified);
        }
        self.newest = Some(entry.sequence);
        Ok(())
    }

    /// The memory, given back.
    #[must_use]
    pub fn release(self) -> F {
        self.flash
    }

    const fn after(&self, slot: u32) -> u32 {
        if slot + 1 < self.slots { slot + 1 } else { 0 }
    }

    /// `None` where the memory does not answer, or beyond the last slot.
    fn read(&mut self, slot: u32) -> Option<Result<Entry, EntryError>> {
        if slot >= self.slots {
            return None;
        }
        let mut bytes = [0; LENGTH];
        self.flash.read(self.offset + slot * Self::SLOT, &mut bytes).ok()?;
        Some(Entry::decode(&bytes))
    }
}
