//! What runs a recording again.

use core::fmt;

use plant_core::Real;

use super::eye::{self, Eye, real};
use super::write::expected_us;
use super::{
    CHECKSUM, Call, HEAD, MAGIC, MOST_WIRES, NO_WIRES, OTHERS, Others, TIMED, VERSION, WIRES,
    digest,
};
use crate::contactor::{Coils, Feedback};
use crate::manage::{Bms, BmsParams, BmsState, Board};
use crate::protect::Faults;
use crate::{Measurements, Reading};

/// Why bytes give no recording, or no more of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RecordingError {
    /// Not a recording.
    Unknown,
    /// Of another version.
    Version(u8),
    /// It ends too soon, or the checksum does not fit.
    Corrupted,
    /// Of a pack with other numbers of cells or sensors, or written by another version of this crate.
    OfAnother,
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown => f.write_str("not a recording of a BMS"),
            Self::Version(version) => {
                write!(f, "a recording of version {version}, not {VERSION}")
            }
            Self::Corrupted => f.write_str("damaged: it is cut short, or its checksum is wrong"),
            Self::OfAnother => {
                f.write_str("made by another version of voltstep-bms, or of a pack of another size")
            }
        }
    }
}

impl core::error::Error for RecordingError {}

/// A recording as read.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'r> {
    cells: u16,
    sensors: u16,
    digest: u64,
    params: &'r [u8],
    checkpoint: &'r [u8],
    inputs: &'r [u8],
}

impl<'r> Recording<'r> {
    /// Reads the bytes of [`Recorder::write`](super::Recorder::write).
    ///
    /// # Errors
    /// [`RecordingError`] says why they are none.
    pub fn read(bytes: &'r [u8]) -> Result<Self, RecordingError> {
        let mut eye = Eye { bytes };
        match eye.take() {
            Some(MAGIC) => {}
            _ => return Err(RecordingError::Unknown),
        }
        let [version, _] = eye.take().ok_or(RecordingError::Corrupted)?;
        if version != VERSION {
            return Err(RecordingError::Version(version));
        }
        Self::rest(bytes, eye).ok_or(RecordingError::Corrupted)
    }

    fn rest(bytes: &'r [u8], mut eye: Eye<'r>) -> Option<Self> {
        let (cells, sensors) = (u16::from_le_bytes(eye.take()?), u16::from_le_bytes(eye.take()?));
        let mut length = || usize::try_from(u32::from_le_bytes(eye.take()?)).ok();
        let lengths = [length()?, length()?, length()?];
        let digest = u64::from_le_bytes(eye.take()?);
        let [params, checkpoint, inputs] = lengths.map(|length| eye.slice(length));
        let sum = u32::from_le_bytes(eye.take()?);
        let body = bytes.get(..bytes.len() - 4)?;
        let whole = eye.bytes.is_empty() && body.len() >= HEAD && CHECKSUM.checksum(body) == sum;
        whole.then_some(())?;
        Some(Self {
            cells,
            sensors,
            digest,
            params: params?,
            checkpoint: checkpoint?,
            inputs: inputs?,
        })
    }

    /// How many cells and temperatures the pack has.
    #[must_use]
    pub const fn size(&self) -> (u16, u16) {
        (self.cells, self.sensors)
    }

    /// The description of the pack.
    ///
    /// # Errors
    /// [`RecordingError::OfAnother`] where it is not understood.
    pub fn params(&self) -> Result<BmsParams, RecordingError> {
        postcard::from_bytes(self.params).map_err(|_| RecordingError::OfAnother)
    }

    /// The state at the checkpoint.
    ///
    /// # Errors
    /// [`RecordingError::OfAnother`] where it is one of a pack of another size, or not understood.
    pub fn state<const CELLS: usize, const SENSORS: usize>(
        &self,
    ) -> Result<BmsState<CELLS, SENSORS>, RecordingError> {
        if (usize::from(self.cells), usize::from(self.sensors)) != (CELLS, SENSORS) {
            return Err(RecordingError::OfAnother);
        }
        postcard::from_bytes(self.checkpoint).map_err(|_| RecordingError::OfAnother)
    }

    /// Whether a state is the one that the recording ended with, to the last bit.
    #[must_use]
    pub fn ends_with<const CELLS: usize, const SENSORS: usize>(
        &self,
        state: &BmsState<CELLS, SENSORS>,
    ) -> bool {
        digest(state) == self.digest
    }

    /// The calls, from the first on.
    #[must_use]
    pub const fn playback(&self) -> Playback<'r> {
        Playback {
            eye: Eye { bytes: self.inputs },
            last: Others {
                asked: None,
                feedback: None,
                drives: None,
                flags: None,
                second_current_a: None,
                insulation: None,
                cells_found: None,
                balancing_c: None,
            },
            wires_v: [0.0; MOST_WIRES],
            wires: NO_WIRES,
        }
    }
}

impl Call {
    const ALL: [Self; 4] = [Self::Tick, Self::Fast, Self::Filter, Self::Slow];

    /// Whether it reads measurements.
    const fn reads(self) -> bool {
        matches!(self, Self::Tick | Self::Fast)
    }
}

/// Runs the calls of a recording, one after the other.
///
/// ```
/// use voltstep_bms::manage::Bms;
/// use voltstep_bms::manage::recorder::{Recording, RecordingError};
///
/// /// Whether the same bits come out, of a pack of 14 cells.
/// fn same(bytes: &[u8], bms: &Bms<14, 4>) -> Result<bool, RecordingError> {
///     let recording = Recording::read(bytes)?;
///     let mut state = recording.state()?;
///     let mut playback = recording.playback();
///     while playback.next(bms, &mut state)?.is_some() {}
///     Ok(recording.ends_with(&state))
/// }
/// ```
#[derive(Clone, Debug)]
pub struct Playback<'r> {
    eye: Eye<'r>,
    last: Others,
    wires_v: [Real; MOST_WIRES],
    wires: u16,
}

impl<'r> Playback<'r> {
    /// The next call, with what was asked for and answered then; `None` at the end.
    ///
    /// # Errors
    /// [`RecordingError::Corrupted`] where the inputs end in the middle of one.
    pub fn next<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        bms: &Bms<CELLS, SENSORS>,
        state: &mut BmsState<CELLS, SENSORS>,
    ) -> Result<Option<Call>, RecordingError> {
        if self.eye.bytes.is_empty() {
            return Ok(None);
        }
        let (call, readings, uptime_us) = self.read(bms, state).ok_or(RecordingError::Corrupted)?;
        state.asked = self.last.asked.unwrap_or(state.asked);
        let wires_v = self.wires_v.get(..usize::from(self.wires));
        let mut player = Player { readings, others: &self.last, uptime_us, wires_v };
        call.of(bms, state, &mut player);
        self.last.asked = None;
        Ok(Some(call))
    }

    fn read<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        bms: &Bms<CELLS, SENSORS>,
        state: &BmsState<CELLS, SENSORS>,
    ) -> Option<(Call, Eye<'r>, u64)> {
        let at = &mut self.eye;
        let head = at.byte()?;
        let call = *Call::ALL.get(usize::from(head & 3))?;
        let readings = *at;
        if call.reads() {
            // Where they end; the board's turn comes in the call.
            let mut scratch = state.now;
            eye::take(at, &mut scratch)?;
        }
        if head & WIRES != 0 {
            self.wires = u16::from_le_bytes(at.take()?);
            if self.wires != NO_WIRES {
                for wire_v in self.wires_v.get_mut(..usize::from(self.wires))? {
                    *wire_v = real(at.take()?);
                }
            }
        }
        let uptime_us = if head & TIMED != 0 { at.take_all()? } else { expected_us(bms, state) };
        if head & OTHERS != 0 {
            self.last.take(at.take_all()?);
        }
        Some((call, readings, uptime_us))
    }
}

/// A board that answers as one did.
struct Player<'p> {
    readings: Eye<'p>,
    others: &'p Others,
    uptime_us: u64,
    wires_v: Option<&'p [Real]>,
}

impl<const CELLS: usize, const SENSORS: usize> Board<CELLS, SENSORS> for Player<'_> {
    fn uptime_us(&mut self) -> u64 {
        self.uptime_us
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        // It was long enough when it was read.
        let _ = eye::take(&mut self.readings, into);
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        self.others.feedback.unwrap_or([Feedback::Unknown; 3])
    }

    fn drive(&mut self, _: Coils) -> bool {
        self.others.drives.unwrap_or(true)
    }

    fn bleed(&mut self, _: &[bool; CELLS]) {}

    fn flags(&mut self) -> Faults {
        self.others.flags.unwrap_or(Faults::NONE)
    }

    fn second_current_a(&mut self) -> Real {
        self.others.second_current_a.unwrap_or(Real::NAN)
    }

    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        self.others.insulation.unwrap_or(None)
    }

    fn cells_found(&mut self) -> Option<u16> {
        self.others.cells_found.unwrap_or(None)
    }

    fn wires_v(&mut self) -> Option<&[Real]> {
        self.wires_v
    }

    fn balancing_c(&mut self) -> Real {
        self.others.balancing_c.unwrap_or(25.0)
    }
}
