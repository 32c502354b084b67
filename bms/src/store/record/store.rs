//! Records on a flash memory.

use embedded_storage::nor_flash::NorFlash;
use plant_core::ParamError;

use super::{Found, LENGTH, Record, RecordError, Slot};

/// Two slots on a flash memory, in erase blocks of their own.
///
/// ```
/// # use embedded_storage::nor_flash::NorFlash;
/// # use voltstep_bms::store::record::{Record, RecordStore};
/// fn at_power_down<F: NorFlash>(flash: F, record: &Record) -> bool {
///     let Ok(mut store) = RecordStore::new(flash, [0x1000, 0x2000]) else { return false };
///     store.save(record).is_ok()
/// }
/// ```
#[derive(Debug)]
pub struct RecordStore<F> {
    flash: F,
    offsets: [u32; 2],
}

/// Why a record was not saved. What was there before is still there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SaveError<E> {
    /// The record itself is refused.
    Implausible(ParamError),
    /// The memory failed.
    Flash(E),
    /// The memory does not give back what was written, or not as the newest.
    NotVerified,
}

impl<F: NorFlash> RecordStore<F> {
    /// Bytes that a slot takes: whole erase blocks.
    pub const SLOT: u32 = {
        assert!(LENGTH.is_multiple_of(F::WRITE_SIZE) && LENGTH.is_multiple_of(F::READ_SIZE));
        let bytes = LENGTH.next_multiple_of(F::ERASE_SIZE);
        assert!(bytes <= u32::MAX as usize);
        #[expect(clippy::cast_possible_truncation, reason = "just checked")]
        let bytes = bytes as u32;
        bytes
    };

    /// Takes two offsets on `flash`, each at the start of an erase block. A memory that cannot
    /// write or read [`LENGTH`] bytes in whole words is refused when compiling.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] where a slot is not aligned, does not fit the memory or overlaps
    /// the other.
    pub fn new(flash: F, offsets: [u32; 2]) -> Result<Self, ParamError> {
        let [first, second] = offsets;
        let fits = |offset: u32| {
            let end = u64::from(offset) + u64::from(Self::SLOT);
            offset.is_multiple_of(Self::ERASE) && end <= flash.capacity() as u64
        };
        if fits(first) && fits(second) && first.abs_diff(second) >= Self::SLOT {
            Ok(Self { flash, offsets })
        } else {
            Err(ParamError::OutOfRange("record_store.offsets"))
        }
    }

    const ERASE: u32 = {
        assert!(F::ERASE_SIZE <= u32::MAX as usize);
        #[expect(clippy::cast_possible_truncation, reason = "just checked")]
        let bytes = F::ERASE_SIZE as u32;
        bytes
    };

    /// The newest record, and whether a slot is damaged. One that cannot be read counts as
    /// damaged: memories with error correction refuse to read a torn write.
    pub fn load(&mut self) -> Found {
        Found::of(self.decode(Slot::First), self.decode(Slot::Second))
    }

    /// Writes a record over the older one and reads it back.
    ///
    /// # Errors
    /// [`SaveError`]; the newest record is then the one that it was before.
    pub fn save(&mut self, record: &Record) -> Result<(), SaveError<F::Error>> {
        let (slot, sequence) = self.load().next();
        let bytes = record.encode(sequence).map_err(SaveError::Implausible)?;
        let offset = self.offset(slot);
        self.flash.erase(offset, offset + Self::SLOT).map_err(SaveError::Flash)?;
        self.flash.write(offset, &bytes).map_err(SaveError::Flash)?;
        match self.load().newest {
            Some(newest) if newest.slot == slot && newest.sequence == sequence => {
                let mut read = [0; LENGTH];
                self.flash.read(offset, &mut read).map_err(SaveError::Flash)?;
                if read == bytes { Ok(()) } else { Err(SaveError::NotVerified) }
            }
            _ => Err(SaveError::NotVerified),
        }
    }

    /// The memory, given back.
    #[must_use]
    pub fn release(self) -> F {
        self.flash
    }

    const fn offset(&self, slot: Slot) -> u32 {
        let [first, second] = self.offsets;
        match slot {
            Slot::First => first,
            Slot::Second => second,
        }
    }

    fn decode(&mut self, slot: Slot) -> Result<(Record, u32), RecordError> {
        let mut bytes = [0; LENGTH];
        match self.flash.read(self.offset(slot), &mut bytes) {
            Ok(()) => Record::decode(&bytes),
            Err(_) => Err(RecordError::Unreadable),
        }
    }
}
