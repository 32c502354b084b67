//! Alive counter and checksum, in the last two bytes of a message.
//!
//! The counter goes 0 to 14; the checksum is that of SAE J1850 over the identifier, low byte first,
//! and the seven bytes before it: counter and polynomial as in \[AutosarE2E\], profile 1; the place
//! in the frame is ours.

use crc::{CRC_8_SAE_J1850, Crc, NoTable};

use super::field::{Field, Layout, Message};

pub(super) const ALIVE: Field = Field::raw("Alive", 48, 4);
pub(super) const CHECKSUM: Field = Field::raw("Checksum", 56, 8);

/// No message has this counter.
pub(super) const NO_ALIVE: u8 = 15;

const CRC: Crc<u8, NoTable> = Crc::<u8, NoTable>::new(&CRC_8_SAE_J1850);

/// The message with its counter and checksum.
pub(super) fn sealed(layout: &Layout, bits: u64, alive: u8) -> Message {
    let bits = ALIVE.with_raw(bits, u64::from(alive));
    layout.message(CHECKSUM.with_raw(bits, u64::from(checksum(layout, bits))))
}

/// The bits and the counter of a message of this layout, where checksum and counter can be.
pub(super) fn opened(layout: &Layout, message: &Message) -> Option<(u64, u8)> {
    let bits = message.bits(layout)?;
    #[expect(clippy::cast_possible_truncation, reason = "four bits")]
    let alive = ALIVE.raw_of(bits) as u8;
    let sound = CHECKSUM.raw_of(bits) == u64::from(checksum(layout, bits)) && alive != NO_ALIVE;
    sound.then_some((bits, alive))
}

fn checksum(layout: &Layout, bits: u64) -> u8 {
    let [rest @ .., _] = bits.to_le_bytes();
    let mut digest = CRC.digest();
    digest.update(&layout.id.to_le_bytes());
    digest.update(&rest);
    digest.finalize()
}
