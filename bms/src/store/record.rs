//! What is worth knowing after a power cut: a record in two slots of non-volatile memory.
//!
//! The newer record is never touched while the next is written. Each carries a sequence number and
//! a checksum, so a write that was torn, or memory that has gone bad, gives the older record or
//! none, never a wrong one. The functions here are pure, over arrays of bytes; [`RecordStore`]
//! puts them on a flash memory.
//!
//! A slot is [`LENGTH`] bytes, little-endian: `"VS"`, version, flags, sequence number; in single
//! precision what stands first in [`Record`], up to the throughput; the time; polarisation, load,
//! hysteresis and resistor heat; the lock-out cause in 2 bytes and 2 of zero; the log's sequence
//! number; 16 bytes of zero, and the CRC-32C of all that. The first version was 64 bytes long: it
//! ended with the time, twelve bytes of zero and the CRC-32C of its own; it is read as that of a
//! battery whose polarisation is not known.
//!
//! The layout is ours. Tests: `tests` below; on a simulated flash memory in
//! `tests/tests/bms_pack/record.rs`.

use crc::{CRC_32_ISCSI, Crc, NoTable};
use plant_core::error::{check, not_negative, positive, ratio};
use plant_core::{ParamError, Real};

use crate::estimate::ekf::Polarisation;

mod resume;
mod store;

pub use store::{RecordStore, SaveError};

/// Bytes of a slot: a multiple of the 32 that some flash memories write at once.
pub const LENGTH: usize = 96;
/// Words of four bytes in it.
const WORDS: usize = LENGTH / 4;
/// Words of the first version, which filled the first part of the slot.
const FIRST_WORDS: usize = 16;
const MAGIC: [u8; 2] = *b"VS";
/// Version of the layout. Beside it, the first is read.
pub const VERSION: u8 = 2;
/// The first version.
const FIRST_VERSION: u8 = 1;
/// Flag: the time is known.
const TIMED: u8 = 1;
/// Flag: the polarisation is known.
const POLARISED: u8 = 2;

/// Castagnoli's polynomial: at this length it finds any 5 wrong bits \[Koopman2002\], and any
/// within 32 neighbours. Without a table: a record is written seldom.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// What is worth knowing after a power cut. Kept in single precision.
///
/// ```
/// use voltstep_bms::store::record::{Found, LENGTH, Record, Slot};
///
/// let record = Record {
///     soc: 0.63,
///     soc_sd: 0.01,
///     capacity_ah: 57.0,
///     capacity_sd_ah: 0.6,
///     resistance_factor: 1.2,
///     resistance_factor_sd: 0.02,
///     current_offset_a: 0.05,
///     current_offset_sd_a: 0.01,
///     throughput_ah: 12_000.0,
///     written_at_s: None,
///     polarisation: None,
///     resistor_heat_j: 0.0,
///     lock_out_cause: 0,
///     log_sequence: 0,
/// };
/// let (older, mut newer) = (record.encode(7)?, record.encode(8)?);
/// newer[LENGTH / 2] ^= 1; // memory gone bad
/// let found = Found::in_slots(&older, &newer);
/// assert!(found.damaged);
/// let stored = found.newest.expect("the older record is whole");
/// assert_eq!((stored.slot, stored.record), (Slot::First, record));
/// # Ok::<(), voltstep_bms::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Record {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation, 0..1.
    pub soc_sd: Real,
    /// Capacity \[A·h\], above 0 and up to 1e6.
    pub capacity_ah: Real,
    /// Its standard deviation \[A·h\], 0 up to the capacity.
    pub capacity_sd_ah: Real,
    /// Resistance as a multiple of that of a new cell, 0.01..100.
    pub resistance_factor: Real,
    /// Its standard deviation, 0..100.
    pub resistance_factor_sd: Real,
    /// What the current sensor shows without a current \[A\], ±10 000.
    pub current_offset_a: Real,
    /// Its standard deviation \[A\], 0..10 000.
    pub current_offset_sd_a: Real,
    /// Charge that has gone in or out over the life \[A·h\], 0..1e9.
    pub throughput_ah: Real,
    /// When this was written \[s\], on a clock of the product's own, where one was running.
    pub written_at_s: Option<u32>,
    /// What the last minutes left in the battery, where it is known: voltages within ±10 000 V, a
    /// load of up to 1e5 A.
    pub polarisation: Option<Polarisation>,
    /// Heat in the precharge resistor \[J\], 0..1e6.
    pub resistor_heat_j: Real,
    /// Why the contactors must stay open, a number of the product's own; 0: they need not.
    pub lock_out_cause: u16,
    /// Sequence number of the newest entry of the product's log.
    pub log_sequence: u32,
}

/// Why a slot gives no record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RecordError {
    /// Erased, nothing was written yet.
    Blank,
    /// Not a record, or another version of it.
    Unknown,
    /// The checksum does not fit: a torn write, or memory gone bad.
    Corrupted,
    /// The checksum fits, yet a field holds what it cannot.
    Implausible(ParamError),
    /// The memory did not answer.
    Unreadable,
}

/// One of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Slot {
    /// The first.
    First,
    /// The second.
    Second,
}

impl Slot {
    /// The one that is not this.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

/// A record as found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stored {
    /// The record.
    pub record: Record,
    /// Its number: one more with every write, 0 after the largest.
    pub sequence: u32,
    /// Where it lies.
    pub slot: Slot,
}

/// What the two slots hold.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Found {
    /// The newest record; `None` where no slot holds one.
    pub newest: Option<Stored>,
    /// A slot holds something else than a record or nothing: there may have been a newer record,
    /// so what has happened since this one is unknown.
    pub damaged: bool,
}

impl Record {
    /// Checks every field.
    ///
    /// # Errors
    /// [`ParamError`] names the field and the rule that it broke.
    pub const fn checked(self) -> Result<Self, ParamError> {
        check!(ratio("record.soc", self.soc));
        check!(ratio("record.soc_sd", self.soc_sd));
        check!(positive("record.capacity_ah", self.capacity_ah));
        check!(up_to("record.capacity_ah", self.capacity_ah, 1e6));
        check!(up_to("record.capacity_sd_ah", self.capacity_sd_ah, self.capacity_ah));
        check!(up_to("record.resistance_factor", self.resistance_factor, 100.0));
        if self.resistance_factor < 0.01 {
            return Err(ParamError::OutOfRange("record.resistance_factor"));
        }
        check!(up_to("record.resistance_factor_sd", self.resistance_factor_sd, 100.0));
        check!(up_to("record.current_offset_a", self.current_offset_a.abs(), 1e4));
        check!(up_to("record.current_offset_sd_a", self.current_offset_sd_a, 1e4));
        check!(up_to("record.throughput_ah", self.throughput_ah, 1e9));
        if let Some(polarisation) = &self.polarisation {
            let [fast_v, slow_v] = polarisation.branches_v;
            check!(up_to("record.polarisation.branches_v", fast_v.abs(), 1e4));
            check!(up_to("record.polarisation.branches_v", slow_v.abs(), 1e4));
            check!(up_to("record.polarisation.load_a", polarisation.load_a, 1e5));
            check!(up_to("record.polarisation.hysteresis", polarisation.hysteresis.abs(), 1.0));
        }
        check!(up_to("record.resistor_heat_j", self.resistor_heat_j, 1e6));
        Ok(self)
    }

    /// The bytes of a slot that holds this record under a sequence number.
    ///
    /// # Errors
    /// [`ParamError`] names a field that [`checked`](Self::checked) refuses.
    pub fn encode(&self, sequence: u32) -> Result<[u8; LENGTH], ParamError> {
        let record = self.checked()?;
        let timed = if record.written_at_s.is_some() { TIMED } else { 0 };
        let polarised = if record.polarisation.is_some() { POLARISED } else { 0 };
        let polarisation = record.polarisation.unwrap_or(Polarisation::NONE);
        let [fast_v, slow_v] = polarisation.branches_v;
        let [cause_low, cause_high] = record.lock_out_cause.to_le_bytes();
        let [v, s] = MAGIC;
        let words = [
            [v, s, VERSION, timed | polarised],
            sequence.to_le_bytes(),
            single(record.soc),
            single(record.soc_sd),
            single(record.capacity_ah),
            single(record.capacity_sd_ah),
            single(record.resistance_factor),
            single(record.resistance_factor_sd),
            single(record.current_offset_a),
            single(record.current_offset_sd_a),
            single(record.throughput_ah),
            record.written_at_s.unwrap_or(0).to_le_bytes(),
            single(fast_v),
            single(slow_v),
            single(polarisation.load_a),
            single(polarisation.hysteresis),
            single(record.resistor_heat_j),
            [cause_low, cause_high, 0, 0],
            record.log_sequence.to_le_bytes(),
        ];
        let mut bytes = [0; LENGTH];
        for (place, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
            *place = word;
        }
        let sum = checksum::<WORDS>(&bytes).to_le_bytes();
        if let Some(place) = bytes.last_chunk_mut() {
            *place = sum;
        }
        Ok(bytes)
    }

    /// The record that a slot holds, and its sequence number.
    ///
    /// # Errors
    /// [`RecordError`] says why there is none.
    pub fn decode(bytes: &[u8; LENGTH]) -> Result<(Self, u32), RecordError> {
        if bytes.iter().all(|byte| *byte == 0xff) {
            return Err(RecordError::Blank);
        }
        let (words, []) = bytes.as_chunks::<4>() else { return Err(RecordError::Unknown) };
        let [
            [v, s, version, flags],
            sequence,
            soc,
            soc_sd,
            capacity_ah,
            capacity_sd_ah,
            resistance_factor,
            resistance_factor_sd,
            current_offset_a,
            current_offset_sd_a,
            throughput_ah,
            written_at_s,
            fast_v,
            slow_v,
            load_a,
            first_sum_or_hysteresis,
            resistor_heat_j,
            [cause_low, cause_high, ..],
            log_sequence,
            ..,
            sum,
        ] = words
        else {
            return Err(RecordError::Unknown);
        };
        let (sum, expected) = match *version {
            VERSION => (sum, checksum::<WORDS>(bytes)),
            FIRST_VERSION => (first_sum_or_hysteresis, checksum::<FIRST_WORDS>(bytes)),
            _ => return Err(RecordError::Unknown),
        };
        if [*v, *s] != MAGIC {
            return Err(RecordError::Unknown);
        }
        if u32::from_le_bytes(*sum) != expected {
            return Err(RecordError::Corrupted);
        }
        let since_second = *version == VERSION;
        let record = Self {
            soc: real(*soc),
            soc_sd: real(*soc_sd),
            capacity_ah: real(*capacity_ah),
            capacity_sd_ah: real(*capacity_sd_ah),
            resistance_factor: real(*resistance_factor),
            resistance_factor_sd: real(*resistance_factor_sd),
            current_offset_a: real(*current_offset_a),
            current_offset_sd_a: real(*current_offset_sd_a),
            throughput_ah: real(*throughput_ah),
            written_at_s: (flags & TIMED != 0).then(|| u32::from_le_bytes(*written_at_s)),
            polarisation: (since_second && flags & POLARISED != 0).then(|| Polarisation {
                branches_v: [real(*fast_v), real(*slow_v)],
                load_a: real(*load_a),
                hysteresis: real(*first_sum_or_hysteresis),
            }),
            resistor_heat_j: if since_second { real(*resistor_heat_j) } else { 0.0 },
            lock_out_cause: if since_second {
                u16::from_le_bytes([*cause_low, *cause_high])
            } else {
                0
            },
            log_sequence: if since_second { u32::from_le_bytes(*log_sequence) } else { 0 },
        };
        match record.checked() {
            Ok(record) => Ok((record, u32::from_le_bytes(*sequence))),
            Err(error) => Err(RecordError::Implausible(error)),
        }
    }
}

impl Found {
    /// What the bytes of two slots hold.
    #[must_use]
    pub fn in_slots(first: &[u8; LENGTH], second: &[u8; LENGTH]) -> Self {
        Self::of(Record::decode(first), Record::decode(second))
    }

    fn of(
        first: Result<(Record, u32), RecordError>,
        second: Result<(Record, u32), RecordError>,
    ) -> Self {
        let damaged = |slot: &Result<_, _>| matches!(slot, Err(e) if *e != RecordError::Blank);
        let damaged = damaged(&first) || damaged(&second);
        let stored = |slot| move |(record, sequence)| Stored { record, sequence, slot };
        let first = first.ok().map(stored(Slot::First));
        let second = second.ok().map(stored(Slot::Second));
        let newest = match (first, second) {
            (Some(first), Some(second)) => {
                Some(if newer(second.sequence, first.sequence) { second } else { first })
            }
            (first, second) => first.or(second),
        };
        Self { newest, damaged }
    }

    /// Where the next record goes, and its sequence number: never over the newest.
    #[must_use]
    pub const fn next(&self) -> (Slot, u32) {
        match &self.newest {
            Some(newest) => (newest.slot.other(), newest.sequence.wrapping_add(1)),
            None => (Slot::First, 0),
        }
    }
}

/// Whether a sequence number comes after another. Two slots are one apart, so the wrap to 0 is
/// seen.
const fn newer(sequence: u32, other: u32) -> bool {
    sequence.wrapping_sub(other).cast_signed() > 0
}

/// Of so many words but the last, which holds it.
fn checksum<const WORDS: usize>(bytes: &[u8; LENGTH]) -> u32 {
    bytes.get(..4 * (WORDS - 1)).map_or(0, |body| CHECKSUM.checksum(body))
}

const fn up_to(field: &'static str, value: Real, largest: Real) -> Result<Real, ParamError> {
    check!(not_negative(field, value));
    if value <= largest { Ok(value) } else { Err(ParamError::OutOfRange(field)) }
}

/// The bytes of a number in single precision, whatever [`Real`] is.
#[allow(clippy::cast_possible_truncation, clippy::unnecessary_cast)]
const fn single(value: Real) -> [u8; 4] {
    (value as f32).to_le_bytes()
}

#[allow(clippy::cast_lossless, clippy::unnecessary_cast)]
const fn real(bytes: [u8; 4]) -> Real {
    f32::from_le_bytes(bytes) as Real
}

#[cfg(test)]
mod tests;
