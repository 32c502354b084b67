//! Reading out the log: one entry at a time, in frames of seven bytes.

use super::field::{Field, Layout, Message};
use crate::log::{Entry, EntryError, LENGTH};

/// Bytes of an entry in a frame.
const IN_A_PART: usize = 7;
/// How many frames hold an entry.
pub const PARTS: usize = LENGTH.div_ceil(IN_A_PART);

const PART: Field = Field::raw("Part", 0, 8);
const BYTES: Field = Field::raw("Bytes", 8, 56);
pub(super) const LOG_PART: Layout =
    Layout { id: 0x517, length: 8, name: "LogPart", fields: &[PART, BYTES] };

const SEQUENCE: Field = Field::raw("Sequence", 0, 32);
const NEWEST: Field = Field::raw("Newest", 32, 1);
pub(super) const LOG_REQUEST: Layout =
    Layout { id: 0x522, length: 8, name: "LogRequest", fields: &[SEQUENCE, NEWEST] };

/// The answer where there is no such entry: a part that none has.
pub const NO_ENTRY: Message = LOG_PART.message(0xff);

/// Which entry somebody wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LogRequest {
    /// The last one.
    Newest,
    /// The one with this number.
    Sequence(u32),
}

impl LogRequest {
    /// As a message.
    #[must_use]
    pub const fn encode(&self) -> Message {
        LOG_REQUEST.message(match self {
            Self::Newest => NEWEST.with_raw(0, 1),
            Self::Sequence(sequence) => SEQUENCE.with_raw(0, *sequence as u64),
        })
    }

    /// That of a message; `None` where it is another.
    #[must_use]
    pub fn decode(message: &Message) -> Option<Self> {
        let bits = message.bits(&LOG_REQUEST)?;
        Some(match NEWEST.raw_of(bits) {
            0 => Self::Sequence(u32::try_from(SEQUENCE.raw_of(bits)).ok()?),
            _ => Self::Newest,
        })
    }

    /// The entry among those, oldest first.
    #[must_use]
    pub fn find<'e>(&self, mut entries: impl Iterator<Item = &'e Entry>) -> Option<&'e Entry> {
        match self {
            Self::Newest => entries.last(),
            Self::Sequence(sequence) => entries.find(|entry| entry.sequence == *sequence),
        }
    }
}

/// The frames of an entry; its own checksum guards them all.
#[must_use]
pub fn log_parts(entry: &Entry) -> [Message; PARTS] {
    let bytes = entry.encode();
    let mut parts = [NO_ENTRY; PARTS];
    for ((part, bytes), number) in parts.iter_mut().zip(bytes.chunks(IN_A_PART)).zip(0..) {
        let value = bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte));
        *part = LOG_PART.message(BYTES.with_raw(PART.with_raw(0, number), value));
    }
    parts
}

/// Puts an entry together again.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LogReader {
    bytes: [u8; LENGTH],
    next: usize,
}

impl LogReader {
    /// Nothing yet.
    pub const NEW: Self = Self { bytes: [0; LENGTH], next: 0 };

    /// Takes a message: the entry, or why there is none, with its last part; before that `None`. A
    /// part that is not the next one is dropped with those before it; part 0 begins anew.
    pub fn read(&mut self, message: &Message) -> Option<Result<Entry, EntryError>> {
        let bits = message.bits(&LOG_PART)?;
        if *message == NO_ENTRY {
            self.next = 0;
            return Some(Err(EntryError::Blank));
        }
        let part = usize::try_from(PART.raw_of(bits)).ok()?;
        if part != 0 && part != self.next {
            self.next = 0;
            return None;
        }
        let place = self.bytes.chunks_mut(IN_A_PART).nth(part)?;
        for (place, byte) in place.iter_mut().zip(BYTES.raw_of(bits).to_le_bytes()) {
            *place = byte;
        }
        self.next = part + 1;
        if self.next < PARTS {
            return None;
        }
        self.next = 0;
        Some(Entry::decode(&self.bytes))
    }
}
