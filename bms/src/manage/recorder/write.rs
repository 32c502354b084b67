//! What records.

use plant_core::{ParamError, Real};
use postcard::ser_flavors::{Flavor, Size};

use super::change::{self, Pen, same, single};
use super::{
    CHECKSUM, Call, HEAD, Hash, MAGIC, MOST_WIRES, NO_WIRES, OTHERS, Others, TIMED, VERSION, WIRES,
    digest,
};
use crate::contactor::{Coils, Feedback};
use crate::manage::{Bms, BmsState, Board};
use crate::protect::Faults;
use crate::{Measurements, Reading};

/// One half of the memory: a checkpoint, and inputs after it.
#[derive(Clone, Copy, Debug, Default)]
struct Half {
    checkpoint: usize,
    end: usize,
    calls: u32,
}

/// Records a checkpoint and what a [`Bms`] was given since, in memory of the user's.
///
/// ```
/// use voltstep_bms::manage::{Bms, BmsState, Board};
/// use voltstep_bms::manage::recorder::{Call, Recorder};
/// use voltstep_bms::protect::Trip;
///
/// /// In place of `bms.tick(state, board)`; half a second after a trip it is kept.
/// fn millisecond<B: Board<14, 4>>(
///     recorder: &mut Recorder,
///     bms: &Bms<14, 4>,
///     state: &mut BmsState<14, 4>,
///     board: &mut B,
///     since_trip: &mut u16,
/// ) {
///     recorder.call(Call::Tick, bms, state, board);
///     *since_trip += u16::from(state.verdict().trip > Trip::None || *since_trip > 0);
///     if *since_trip == 500 {
///         recorder.freeze(state);
///     }
/// }
/// ```
#[derive(Debug)]
pub struct Recorder<'m> {
    memory: [&'m mut [u8]; 2],
    halves: [Half; 2],
    /// The one that is written, once there is a checkpoint.
    half: Option<usize>,
    /// What was last said and answered since the checkpoint.
    last: Others,
    /// The hash of the wires' voltages, likewise.
    wires: Option<u64>,
    digest: Option<u64>,
    /// The memory is too small.
    broken: bool,
}

impl<'m> Recorder<'m> {
    /// Takes memory for what a BMS is given; how long that is stands [above](super).
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] where a half cannot hold a checkpoint and an input, or with more than
    /// 255 cells.
    pub fn new<const CELLS: usize, const SENSORS: usize>(
        _: &Bms<CELLS, SENSORS>,
        memory: &'m mut [u8],
    ) -> Result<Self, ParamError> {
        if CELLS >= MOST_WIRES {
            return Err(ParamError::OutOfRange("recorder.cells"));
        }
        let least = 2 * (size_of::<BmsState<CELLS, SENSORS>>() + longest(CELLS, SENSORS));
        if memory.len() < least || u32::try_from(memory.len()).is_err() {
            return Err(ParamError::OutOfRange("recorder.memory"));
        }
        let (first, second) = memory.split_at_mut(memory.len() / 2);
        Ok(Self {
            memory: [first, second],
            halves: [Half::default(); 2],
            half: None,
            last: Others::default(),
            wires: None,
            digest: None,
            broken: false,
        })
    }

    /// One call of the BMS, which is recorded unless the recording is frozen. All calls of the BMS go
    /// through here.
    pub fn call<const CELLS: usize, const SENSORS: usize, B: Board<CELLS, SENSORS>>(
        &mut self,
        call: Call,
        bms: &Bms<CELLS, SENSORS>,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) {
        if self.digest.is_some() || self.broken {
            call.of(bms, state, board);
            return;
        }
        if self.half.is_none_or(|half| self.room(half) < longest(CELLS, SENSORS)) {
            self.checkpoint(state);
        }
        let index = self.half.unwrap_or(0);
        let (Some(memory), Some(half)) = (self.memory.get_mut(index), self.halves.get_mut(index))
        else {
            return;
        };
        let mut pen = Pen { bytes: memory, at: half.end, full: false };
        let head = pen.reserve();
        pen.set(head, call as u8);
        let asked = state.asked;
        let mut others = Others { asked: new(self.last.asked, asked), ..Others::default() };
        let expected_us = expected_us(bms, state);
        let mut tap = Tap {
            board,
            pen,
            last: &self.last,
            others: &mut others,
            head,
            uptime_us: expected_us,
            wires: &mut self.wires,
        };
        call.of(bms, state, &mut tap);
        let Tap { mut pen, uptime_us, .. } = tap;
        if uptime_us != expected_us {
            pen.set(head, TIMED);
            pen.put_all(&uptime_us);
        }
        if others != Others::default() {
            pen.set(head, OTHERS);
            pen.put_all(&others);
        }
        self.broken = pen.full;
        half.end = pen.at;
        half.calls += 1;
        self.last.take(others);
        self.last.asked = Some(state.asked);
    }

    fn room(&self, index: usize) -> usize {
        match (self.memory.get(index), self.halves.get(index)) {
            (Some(memory), Some(half)) => memory.len() - half.end,
            _ => 0,
        }
    }

    /// Begins the other half with a checkpoint: what was in it is lost.
    pub fn checkpoint<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        state: &BmsState<CELLS, SENSORS>,
    ) {
        if self.digest.is_some() {
            return;
        }
        let index = self.half.map_or(0, |half| 1 - half);
        let (Some(memory), Some(half)) = (self.memory.get_mut(index), self.halves.get_mut(index))
        else {
            return;
        };
        match postcard::to_slice(state, memory) {
            Ok(written) => {
                *half = Half { checkpoint: written.len(), end: written.len(), calls: 0 };
            }
            Err(_) => self.broken = true,
        }
        self.half = Some(index);
        (self.last, self.wires) = (Others::default(), None);
    }

    /// Keeps what there is, up to the call before. Later calls are not recorded.
    pub fn freeze<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        state: &BmsState<CELLS, SENSORS>,
    ) {
        self.digest = self.digest.or_else(|| Some(digest(state)));
    }

    /// How many calls there are.
    #[must_use]
    pub const fn calls(&self) -> u32 {
        let [first, second] = &self.halves;
        first.calls + second.calls
    }

    /// Gives the bytes of a recording that was frozen, piece by piece; `false` where none was, or where
    /// the memory was too small for a checkpoint.
    pub fn write<const CELLS: usize, const SENSORS: usize>(
        &self,
        bms: &Bms<CELLS, SENSORS>,
        mut sink: impl FnMut(&[u8]),
    ) -> bool {
        let (Some(digest), Some(newer), false) = (self.digest, self.half, self.broken) else {
            return false;
        };
        let params = bms.description().params();
        let older = 1 - newer;
        let part = |index: usize| {
            let (memory, half) = (self.memory.get(index)?, self.halves.get(index)?);
            memory.get(..half.end)?.split_at_checked(half.checkpoint)
        };
        let Some((newer_checkpoint, newer)) = part(newer) else { return false };
        let (checkpoint, before) = match part(older) {
            Some((checkpoint, inputs)) if !checkpoint.is_empty() => (checkpoint, inputs),
            _ => (newer_checkpoint, &[][..]),
        };
        let Ok(length) = postcard::serialize_with_flavor(params, Size::default()) else {
            return false;
        };
        let mut sum = CHECKSUM.digest();
        let mut put = |bytes: &[u8]| {
            sum.update(bytes);
            sink(bytes);
        };
        let [m, a, g, i] = MAGIC;
        put(&[m, a, g, i, VERSION, 0]);
        #[expect(clippy::cast_possible_truncation, reason = "checked where the memory was taken")]
        let (short, long) =
            (|n: usize| (n as u16).to_le_bytes(), |n: usize| (n as u32).to_le_bytes());
        put(&short(CELLS));
        put(&short(SENSORS));
        put(&long(length));
        put(&long(checkpoint.len()));
        put(&long(before.len() + newer.len()));
        put(&digest.to_le_bytes());
        let written = postcard::serialize_with_flavor(params, Sink(&mut put)).is_ok();
        put(checkpoint);
        put(before);
        put(newer);
        sink(&sum.finalize().to_le_bytes());
        written
    }
}

const _: () = assert!(HEAD == MAGIC.len() + 2 + 2 * 2 + 3 * 4 + 8);

/// Bytes of the longest input.
const fn longest(cells: usize, sensors: usize) -> usize {
    160 + 14 * cells + 10 * sensors
}

/// When the next call comes, if it comes in time \[µs\].
pub(super) fn expected_us<const CELLS: usize, const SENSORS: usize>(
    bms: &Bms<CELLS, SENSORS>,
    state: &BmsState<CELLS, SENSORS>,
) -> u64 {
    let tick_us = 1e6 * bms.description().params().sheet.tick_s + 0.5;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let tick_us = tick_us as u64;
    state.uptime_us.unwrap_or(0).wrapping_add(tick_us)
}

impl Call {
    /// Has the BMS do it.
    pub(super) fn of<const CELLS: usize, const SENSORS: usize, B: Board<CELLS, SENSORS>>(
        self,
        bms: &Bms<CELLS, SENSORS>,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) {
        match self {
            Self::Tick => bms.tick(state, board),
            Self::Fast => bms.fast(state, board),
            Self::Filter => bms.filter(state, board),
            Self::Slow => {
                bms.slow(state);
            }
        }
    }
}

fn new<T: PartialEq>(last: Option<T>, now: T) -> Option<T> {
    if last.as_ref() == Some(&now) { None } else { Some(now) }
}

/// Not a number is equal to itself.
fn new_real(last: Option<Real>, now: Real) -> Option<Real> {
    if last.is_some_and(|last| same(last, now)) { None } else { Some(now) }
}

impl Others {
    /// What has changed is the last now.
    pub(super) fn take(&mut self, others: Self) {
        self.asked = others.asked.or(self.asked);
        self.feedback = others.feedback.or(self.feedback);
        self.drives = others.drives.or(self.drives);
        self.flags = others.flags.or(self.flags);
        self.second_current_a = others.second_current_a.or(self.second_current_a);
        self.insulation = others.insulation.or(self.insulation);
        self.cells_found = others.cells_found.or(self.cells_found);
        self.balancing_c = others.balancing_c.or(self.balancing_c);
    }
}

/// A sink of bytes as `postcard` wants it.
struct Sink<'s, F>(&'s mut F);

impl<F: FnMut(&[u8])> Flavor for Sink<'_, F> {
    type Output = ();

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        (self.0)(&[byte]);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}

/// A board that is listened to.
struct Tap<'t, 'p, B> {
    board: &'t mut B,
    pen: Pen<'p>,
    last: &'t Others,
    others: &'t mut Others,
    head: usize,
    uptime_us: u64,
    wires: &'t mut Option<u64>,
}

impl<B: Board<CELLS, SENSORS>, const CELLS: usize, const SENSORS: usize> Board<CELLS, SENSORS>
    for Tap<'_, '_, B>
{
    fn uptime_us(&mut self) -> u64 {
        self.uptime_us = self.board.uptime_us();
        self.uptime_us
    }

    fn measure(&mut self, into: &mut Measurements<CELLS, SENSORS>) {
        let before = *into;
        self.board.measure(into);
        change::put(&mut self.pen, &before, into);
    }

    fn feedback(&mut self) -> [Feedback; 3] {
        let feedback = self.board.feedback();
        self.others.feedback = new(self.last.feedback, feedback);
        feedback
    }

    fn drive(&mut self, coils: Coils) -> bool {
        let drives = self.board.drive(coils);
        self.others.drives = new(self.last.drives, drives);
        drives
    }

    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.board.bleed(cells);
    }

    fn flags(&mut self) -> Faults {
        let flags = self.board.flags();
        self.others.flags = new(self.last.flags, flags);
        flags
    }

    fn second_current_a(&mut self) -> Real {
        let second_current_a = self.board.second_current_a();
        self.others.second_current_a = new_real(self.last.second_current_a, second_current_a);
        second_current_a
    }

    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        let insulation = self.board.insulation_ohm_per_v();
        self.others.insulation = new(self.last.insulation, insulation);
        insulation
    }

    fn cells_found(&mut self) -> Option<u16> {
        let cells_found = self.board.cells_found();
        self.others.cells_found = new(self.last.cells_found, cells_found);
        cells_found
    }

    fn wires_v(&mut self) -> Option<&[Real]> {
        let wires_v = self.board.wires_v();
        let mut hash = Hash::NEW;
        let seen = wires_v.map(|wires_v| wires_v.get(..=CELLS).unwrap_or(wires_v));
        for wire_v in seen.into_iter().flatten() {
            for byte in single(*wire_v) {
                hash.take(byte);
            }
        }
        let hash = if seen.is_some() { hash.0 } else { 0 };
        if self.wires.replace(hash) != Some(hash) {
            self.pen.set(self.head, WIRES);
            let count = seen.map_or(NO_WIRES, |seen| u16::try_from(seen.len()).unwrap_or(NO_WIRES));
            self.pen.put(&count.to_le_bytes());
            seen.into_iter().flatten().for_each(|wire_v| self.pen.put(&single(*wire_v)));
        }
        wires_v
    }

    fn balancing_c(&mut self) -> Real {
        let balancing_c = self.board.balancing_c();
        self.others.balancing_c = new_real(self.last.balancing_c, balancing_c);
        balancing_c
    }
}
