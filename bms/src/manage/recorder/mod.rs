//! A checkpoint of a [`Bms`](super::Bms) and the raw inputs since, in memory that the user gives:
//! what has happened can be run again on a PC, to the same bits or with another threshold.
//!
//! [`Recorder`] stands between the [`Bms`](super::Bms) and its [`Board`](super::Board). Its memory is
//! two halves. Each begins with a checkpoint; when one is full, the other is begun anew, so that at
//! least what fits one half is there. [`Recorder::write`] gives the bytes of a recording, with the
//! description of the pack. On a PC, with the feature `rewind`, `Recording` reads them and `Playback`
//! runs them; `voltstep rewind` does both. What is asked for is recorded, not the frames that it came in.
//!
//! # How long
//! A call takes one byte, and where it reads the board one more. A reading that is new takes 2 or 3
//! bytes where it has moved by its noise, and none where it has not moved; four cells share a byte.
//! With cells and temperatures every 20 ms, current, pack and link every millisecond, and noise on all,
//! the 14 cells of a test below take 11 kB a second and 2.5 kB for a checkpoint: 64 KiB hold 2.7 to
//! 5.6 s.
//!
//! The call in which a half is begun writes a checkpoint too. That is the only call that costs more
//! than a few hundred instructions; where that is too much, begin it by
//! [`Recorder::checkpoint`] when there is time.
//!
//! # Layout
//! Little-endian: `"VSRC"`, version and a byte of zero, cells and sensors in 2 bytes each, the lengths
//! of description, checkpoint and inputs in 4 bytes each, the digest of the last state in 8; then
//! description and checkpoint as `postcard` writes them, the inputs, and the CRC-32C of all that. An
//! input is a byte (call, whether the time is another than the period, whether other answers follow);
//! for a call that reads, a byte with two bits each for current, pack and link, and whether cells and
//! temperatures have changed, then what has changed; then wires, time and other answers. It is ours. Tests:
//! `tests` below; in QEMU and on a PC, `cargo xtask bits`.

mod change;
#[cfg(feature = "rewind")]
mod eye;
#[cfg(feature = "rewind")]
mod play;
mod write;

#[cfg(feature = "rewind")]
pub use play::{Playback, Recording, RecordingError};
pub use write::Recorder;

use crc::{CRC_32_ISCSI, Crc, NoTable};
use plant_core::Real;
use serde::{Deserialize, Serialize};

use super::{Asked, BmsState};
use crate::Reading;
use crate::contactor::Feedback;
use crate::protect::Faults;

/// How a recording begins.
pub const MAGIC: [u8; 4] = *b"VSRC";
/// Version of the layout. A recording is read by the version of this crate that wrote it: a checkpoint
/// is the state as it is.
const VERSION: u8 = 1;
/// Bytes before the description.
const HEAD: usize = 30;
/// As in the log: without a table.
const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISCSI);

/// Which of its calls a [`Bms`](super::Bms) gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Call {
    /// [`tick`](super::Bms::tick).
    Tick,
    /// [`fast`](super::Bms::fast).
    Fast,
    /// [`filter`](super::Bms::filter).
    Filter,
    /// [`slow`](super::Bms::slow).
    Slow,
}

/// In the first byte of an input, beside the call: the time follows, other answers do, the wires'
/// voltages do.
const TIMED: u8 = 4;
const OTHERS: u8 = 8;
const WIRES: u8 = 16;
/// In place of their number: there are none.
const NO_WIRES: u16 = u16::MAX;

/// What is asked for and what a board answers, beside time, measurements and wires, where it has
/// changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(clippy::option_option, reason = "as it was, or other, which may be nothing")]
struct Others {
    asked: Option<Asked>,
    feedback: Option<[Feedback; 3]>,
    drives: Option<bool>,
    flags: Option<Faults>,
    second_current_a: Option<Real>,
    insulation: Option<Option<Reading>>,
    cells_found: Option<Option<u16>>,
    balancing_c: Option<Real>,
}

/// The most wires.
const MOST_WIRES: usize = 256;

/// FNV-1a.
#[derive(Clone, Copy)]
struct Hash(u64);

impl Hash {
    const NEW: Self = Self(0xcbf2_9ce4_8422_2325);

    const fn take(&mut self, byte: u8) {
        self.0 = (self.0 ^ byte as u64).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

impl postcard::ser_flavors::Flavor for Hash {
    type Output = u64;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.take(byte);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<u64> {
        Ok(self.0)
    }
}

/// A hash of all that a state holds, but what was stored of it.
fn digest<const CELLS: usize, const SENSORS: usize>(state: &BmsState<CELLS, SENSORS>) -> u64 {
    // Nothing in a state is refused, and the hash takes everything.
    postcard::serialize_with_flavor(state, Hash::NEW).unwrap_or(0)
}

#[cfg(all(test, feature = "rewind"))]
mod tests;
