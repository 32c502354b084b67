//! One event, and its bytes.

use crc::{CRC_32_ISCSI, Crc, NoTable};
use plant_core::Real;

use crate::protect::Id;

/// Bytes of an entry.
pub const LENGTH: usize = 64;

/// As in the record of what survives: without a table, entries are rare.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// What happened to a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Kind {
    /// It tripped.
    Tripped,
    /// It healed.
    Healed,
    /// Somebody ended it.
    Cleared,
}

/// A picture of the moment; NaN where a value was not known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Frame {
    /// Lowest and highest cell \[V\].
    pub cell_v: [Real; 2],
    /// Coldest and hottest sensor \[°C\].
    pub temperature_c: [Real; 2],
    /// Current of the pack \[A\], positive when discharging.
    pub current_a: Real,
    /// Voltage of the pack \[V\].
    pub pack_v: Real,
    /// Voltage behind the contactors \[V\].
    pub link_v: Real,
    /// State of charge, 0..1.
    pub soc: Real,
}

/// One event.
///
/// ```
/// use voltstep_bms::log::{Entry, EntryError, Frame, Kind};
/// use voltstep_bms::protect::Id;
///
/// let frame = Frame {
///     cell_v: [3.61, 3.64],
///     temperature_c: [24.0, 31.0],
///     current_a: 12.0,
///     pack_v: 50.8,
///     link_v: 50.7,
///     soc: 0.42,
/// };
/// let entry =
///     Entry { sequence: 7, at_ms: 125_000, id: Id::Interlock, kind: Kind::Tripped, phase: 6, frame };
/// let mut bytes = entry.encode();
/// assert_eq!(Entry::decode(&bytes), Ok(entry));
/// bytes[20] ^= 1;
/// assert_eq!(Entry::decode(&bytes), Err(EntryError::Corrupted));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Entry {
    /// Its number: one more with every entry, over the whole life.
    pub sequence: u32,
    /// Uptime \[ms\], sleep included.
    pub at_ms: u32,
    /// The row.
    pub id: Id,
    /// What happened to it.
    pub kind: Kind,
    /// The phase of the contactors, a number of the product's own.
    pub phase: u8,
    /// The moment.
    pub frame: Frame,
}

/// Why bytes give no entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EntryError {
    /// Erased.
    Blank,
    /// The checksum does not fit: a torn write, or memory gone bad.
    Corrupted,
    /// The checksum fits, yet a row or a kind has no meaning: of another version.
    Unknown,
}

impl Entry {
    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; LENGTH] {
        let Frame { cell_v, temperature_c, current_a, pack_v, link_v, soc } = self.frame;
        let kind = match self.kind {
            Kind::Tripped => 0,
            Kind::Healed => 1,
            Kind::Cleared => 2,
        };
        let words = [
            self.sequence.to_le_bytes(),
            self.at_ms.to_le_bytes(),
            [self.id.index(), kind, self.phase, 0],
            single(cell_v[0]),
            single(cell_v[1]),
            single(temperature_c[0]),
            single(temperature_c[1]),
            single(current_a),
            single(pack_v),
            single(link_v),
            single(soc),
        ];
        let mut bytes = [0; LENGTH];
        for (place, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
            *place = word;
        }
        let sum = checksum(&bytes).to_le_bytes();
        if let Some(place) = bytes.last_chunk_mut() {
            *place = sum;
        }
        bytes
    }

    /// The entry that bytes hold.
    ///
    /// # Errors
    /// [`EntryError`] says why there is none.
    pub fn decode(bytes: &[u8; LENGTH]) -> Result<Self, EntryError> {
        if bytes.iter().all(|byte| *byte == 0xff) {
            return Err(EntryError::Blank);
        }
        let (words, _) = bytes.as_chunks::<4>();
        let [
            sequence,
            at_ms,
            [index, kind, phase, _],
            lowest_v,
            highest_v,
            coldest_c,
            hottest_c,
            current_a,
            pack_v,
            link_v,
            soc,
            ..,
            sum,
        ] = words
        else {
            return Err(EntryError::Unknown);
        };
        if u32::from_le_bytes(*sum) != checksum(bytes) {
            return Err(EntryError::Corrupted);
        }
        let kind = match kind {
            0 => Kind::Tripped,
            1 => Kind::Healed,
            2 => Kind::Cleared,
            _ => return Err(EntryError::Unknown),
        };
        Ok(Self {
            sequence: u32::from_le_bytes(*sequence),
            at_ms: u32::from_le_bytes(*at_ms),
            id: Id::at(*index).ok_or(EntryError::Unknown)?,
            kind,
            phase: *phase,
            frame: Frame {
                cell_v: [real(*lowest_v), real(*highest_v)],
                temperature_c: [real(*coldest_c), real(*hottest_c)],
                current_a: real(*current_a),
                pack_v: real(*pack_v),
                link_v: real(*link_v),
                soc: real(*soc),
            },
        })
    }
}

/// Whether a number comes after another, over the wrap to 0 too.
pub(super) const fn later(sequence: u32, other: u32) -> bool {
    sequence.wrapping_sub(other).cast_signed() > 0
}

/// Of all but the last word, which holds it.
fn checksum(bytes: &[u8; LENGTH]) -> u32 {
    bytes.get(..LENGTH - 4).map_or(0, |body| CHECKSUM.checksum(body))
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
