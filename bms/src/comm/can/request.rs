//! What vehicle and charger ask for, and whether they can be believed.

use plant_core::Real;

use super::field::{Field, Layout, Message, alive_after};
use super::guard::{ALIVE, CHECKSUM, NO_ALIVE, opened, sealed};
use crate::limit::Request;
use crate::protect::{Clear, Faults, Id};

const MODE: Field = Field::raw("Mode", 0, 3);
const CLEAR: Field = Field::raw("Clear", 8, 2);
const KEY: Field = Field::raw("Key", 16, 16);
const FIELDS: &[Field] = &[MODE, CLEAR, KEY, ALIVE, CHECKSUM];
pub(super) const VEHICLE_REQUEST: Layout =
    Layout { id: 0x520, length: 8, name: "VehicleRequest", fields: FIELDS };
pub(super) const CHARGER_REQUEST: Layout =
    Layout { id: 0x521, length: 8, name: "ChargerRequest", fields: FIELDS };

/// What must come with a wish to end faults, so that no stray bit is one.
const RESET_KEY: u64 = 0x5ac3;
/// The same of a workshop.
const SERVICE_KEY: u64 = 0xc35a;

/// A counter may be this far from the last one: frames get lost.
const MOST_AHEAD: u8 = 3;
/// The frames that corrupt ones are counted among, and how many of them may be: one in as many as
/// the counter has values.
const REMEMBERED: u16 = (1 << 15) - 1;
const TOLERATED: u32 = 1;

/// What one of them asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Command {
    /// What to do. [`Request::Silent`] is not sent: who is silent sends nothing; it goes out as one
    /// that has no meaning.
    pub request: Request,
    /// Which faults to end.
    pub clear: Clear,
}

impl Command {
    /// As a message of the vehicle; `alive` is one more each time ([`alive_after`]).
    #[must_use]
    pub fn encode_vehicle(&self, alive: u8) -> Message {
        self.encode(&VEHICLE_REQUEST, alive)
    }

    /// As a message of a charger.
    #[must_use]
    pub fn encode_charger(&self, alive: u8) -> Message {
        self.encode(&CHARGER_REQUEST, alive)
    }

    fn encode(&self, layout: &Layout, alive: u8) -> Message {
        let mode = match self.request {
            Request::Off => 0,
            Request::Drive => 1,
            Request::Charge => 2,
            Request::Silent | Request::Unknown => 7,
        };
        let (clear, key) = match self.clear {
            Clear::No => (0, 0),
            Clear::Reset => (1, RESET_KEY),
            Clear::Service => (2, SERVICE_KEY),
        };
        let bits = CLEAR.with_raw(MODE.with_raw(0, mode), clear);
        sealed(layout, KEY.with_raw(bits, key), alive)
    }

    fn decode(bits: u64) -> Self {
        let request = match MODE.raw_of(bits) {
            0 => Request::Off,
            1 => Request::Drive,
            2 => Request::Charge,
            _ => Request::Unknown,
        };
        let clear = match (CLEAR.raw_of(bits), KEY.raw_of(bits)) {
            (1, RESET_KEY) => Clear::Reset,
            (2, SERVICE_KEY) => Clear::Service,
            _ => Clear::No,
        };
        Self { request, clear }
    }
}

/// Hears one of them, and says when it cannot be believed.
///
/// A message counts where its checksum fits and its counter is one to three ahead of the last: a
/// counter that stands still is as good as silence. After silence the first message only tells the
/// counter. Of fifteen messages one may be corrupt or out of turn.
///
/// ```
/// use voltstep_bms::comm::can::{Command, REQUEST, RequestWatchState};
/// use voltstep_bms::limit::Request;
/// use voltstep_bms::protect::{Clear, Id, Signals};
///
/// let mut vehicle = RequestWatchState::NEW;
/// let drive = Command { request: Request::Drive, clear: Clear::No };
/// for alive in 0..2 {
///     REQUEST.elapse(&mut vehicle, 0.02);
///     REQUEST.hear(&mut vehicle, &drive.encode_vehicle(alive));
/// }
/// assert_eq!(vehicle.request(), Request::Drive);
///
/// REQUEST.elapse(&mut vehicle, 0.11); // longer than it may be silent
/// assert_eq!(vehicle.request(), Request::Silent);
/// let signals =
///     Signals { flags: REQUEST.faults(&vehicle), clear: vehicle.take_clear(), ..Signals::QUIET };
/// assert!(signals.flags.has(Id::RequestLost));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RequestWatch {
    layout: &'static Layout,
    timeout_s: Real,
    lost: Id,
    corrupt: Option<Id>,
}

/// Hears the vehicle: every 20 ms, silent for 100 ms at most.
pub const REQUEST: RequestWatch = RequestWatch {
    layout: &VEHICLE_REQUEST,
    timeout_s: 0.1,
    lost: Id::RequestLost,
    corrupt: Some(Id::RequestCorrupt),
};

/// Hears a charger: every 100 ms, silent for 500 ms at most. Its corrupt messages are only not
/// heard: then it is lost.
pub const CHARGER: RequestWatch =
    RequestWatch { layout: &CHARGER_REQUEST, timeout_s: 0.5, lost: Id::ChargerLost, corrupt: None };

/// What a [`RequestWatch`] remembers.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RequestWatchState {
    command: Command,
    silent: bool,
    since_s: Real,
    last_alive: u8,
    /// One bit for each of the last fifteen messages, set where one was corrupt or out of turn.
    history: u16,
    clear: Clear,
}

impl RequestWatchState {
    /// Nobody was heard.
    pub const NEW: Self = Self {
        command: Command { request: Request::Off, clear: Clear::No },
        silent: true,
        since_s: 0.0,
        last_alive: NO_ALIVE,
        history: 0,
        clear: Clear::No,
    };

    /// What is asked for now.
    #[must_use]
    pub const fn request(&self) -> Request {
        if self.silent { Request::Silent } else { self.command.request }
    }

    /// Which faults to end, once for each time that it was asked: the wish must be gone in between.
    pub const fn take_clear(&mut self) -> Clear {
        core::mem::replace(&mut self.clear, Clear::No)
    }
}

impl RequestWatch {
    /// Lets `elapsed_s` pass; a time below zero or not a number is a clock gone wrong, and silence.
    pub fn elapse(&self, state: &mut RequestWatchState, elapsed_s: Real) {
        state.since_s += if elapsed_s >= 0.0 { elapsed_s } else { Real::INFINITY };
        if state.since_s > self.timeout_s {
            state.silent = true;
            state.last_alive = NO_ALIVE;
            state.clear = Clear::No;
        }
    }

    /// Takes a message; others than its own are left alone.
    pub fn hear(&self, state: &mut RequestWatchState, message: &Message) {
        if message.id() != self.layout.id {
            return;
        }
        let opened = opened(self.layout, message);
        let last = state.last_alive;
        let in_turn = match opened {
            Some((_, alive)) => {
                state.last_alive = alive;
                last == NO_ALIVE || ahead(last, alive) <= MOST_AHEAD
            }
            None => false,
        };
        state.history = (state.history << 1 | u16::from(!in_turn)) & REMEMBERED;
        let Some((bits, alive)) = opened else { return };
        // The first only tells the counter, so a single frame from anywhere starts nothing.
        if !in_turn || last == NO_ALIVE || alive == last {
            state.since_s = if last == NO_ALIVE { 0.0 } else { state.since_s };
            return;
        }
        let command = Command::decode(bits);
        if command.clear != state.command.clear {
            state.clear = command.clear;
        }
        state.command = command;
        state.since_s = 0.0;
        state.silent = false;
    }

    /// What is wrong, for the table's [`Signals`](crate::protect::Signals): lost is who asked for
    /// something and went silent without asking to end it.
    #[must_use]
    pub fn faults(&self, state: &RequestWatchState) -> Faults {
        let mut faults = Faults::NONE;
        if state.silent && state.command.request != Request::Off {
            faults = faults.with(self.lost);
        }
        if let Some(corrupt) = self.corrupt
            && state.history.count_ones() > TOLERATED
        {
            faults = faults.with(corrupt);
        }
        faults
    }
}

/// How far a counter is ahead of another; 0 where it stands still.
fn ahead(last: u8, alive: u8) -> u8 {
    let mut at = last;
    let mut steps = 0;
    while at != alive && steps < NO_ALIVE {
        at = alive_after(at);
        steps += 1;
    }
    steps
}
