//! What goes over the bus and when, and who is heard there.

use plant_core::Real;

use super::{Asked, Bms, BmsState};
use crate::comm::can::{
    CELLS_IN_A_GROUP, CHARGER, CellExtremes, CellGroup, FAULT_PAGES, FaultPage, LogRequest,
    Message, NO_ENTRY, PARTS, Pack, REQUEST, RequestWatchState, Status, TemperatureExtremes,
    alive_after, encode_limits, log_parts,
};

/// Groups of cells that a second has room for; of more, a set takes several.
const GROUPS_A_SECOND: u16 = 50;

/// The CAN bus of a BMS: hears vehicle and charger, and knows which message is due.
///
/// Messages are spread over the milliseconds, at most two in one. The periods are those of
/// [`comm::can`](crate::comm::can).
///
/// ```
/// # use voltstep_bms::comm::can::Message;
/// # use voltstep_bms::manage::{Bms, BmsState, Board, Bus};
/// fn millisecond<B: Board<14, 4>>(
///     bms: &Bms<14, 4>,
///     state: &mut BmsState<14, 4>,
///     bus: &mut Bus,
///     board: &mut B,
///     heard: Option<Message>,
///     send: impl FnMut(&Message),
/// ) {
///     heard.iter().for_each(|message| bus.hear(message));
///     bms.request(state, bus.asked(0.001));
///     bms.tick(state, board);
///     bus.send(bms, state, send);
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Bus {
    vehicle: RequestWatchState,
    charger: RequestWatchState,
    ms: u16,
    alive: [u8; 3],
    group: u16,
    wanted: Option<LogRequest>,
    /// Parts of the entry that is read out, and how many of them are sent.
    parts: [Message; PARTS],
    part: usize,
}

impl Bus {
    /// Nobody was heard.
    pub const NEW: Self = Self {
        vehicle: RequestWatchState::NEW,
        charger: RequestWatchState::NEW,
        ms: 0,
        alive: [0; 3],
        group: 0,
        wanted: None,
        parts: [NO_ENTRY; PARTS],
        part: PARTS,
    };

    /// Takes a message; those that are not for a BMS are left alone.
    pub fn hear(&mut self, message: &Message) {
        REQUEST.hear(&mut self.vehicle, message);
        CHARGER.hear(&mut self.charger, message);
        self.wanted = LogRequest::decode(message).or(self.wanted);
    }

    /// What is asked for, so much time after the last call \[s\].
    pub fn asked(&mut self, elapsed_s: Real) -> Asked {
        REQUEST.elapse(&mut self.vehicle, elapsed_s);
        CHARGER.elapse(&mut self.charger, elapsed_s);
        Asked::heard(&mut self.vehicle, &mut self.charger)
    }

    /// Sends what is due in this millisecond, the next at each call.
    pub fn send<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        bms: &Bms<CELLS, SENSORS>,
        state: &BmsState<CELLS, SENSORS>,
        mut send: impl FnMut(&Message),
    ) {
        let sheet = &bms.description().params().sheet;
        let (sensing, now) = (&sheet.sensing, state.measurements());
        let ms = self.ms;
        self.ms = if ms + 1 < 1000 { ms + 1 } else { 0 };
        match ms % 10 {
            0 => send(&status(bms, state).encode(self.next_alive(0))),
            5 => {
                let [current_a, pack_v, link_v] = bms.usable(state);
                send(&Pack { pack_v, link_v, current_a }.encode(self.next_alive(1)));
            }
            7 => self.send_log(state, &mut send),
            _ => {}
        }
        match ms % 100 {
            12 => send(&encode_limits(state.limits(), self.next_alive(2))),
            22 => {
                let oldest_s = sensing.cell_v.oldest_s(sheet.tick_s);
                send(&CellExtremes::of(&now.cell_v, oldest_s).encode());
            }
            32 => {
                let oldest_s = sensing.temperature_c.oldest_s(sheet.tick_s);
                send(&TemperatureExtremes::of(&now.temperature_c, oldest_s).encode());
            }
            slot @ (42 | 52 | 62 | 72) => {
                #[expect(clippy::cast_possible_truncation, reason = "0 to 3")]
                let page = ((slot - 42) / 10) as u8;
                if let Some(page) = FaultPage::of(state.verdict(), page) {
                    send(&page.encode());
                }
            }
            _ => {}
        }
        if ms % 20 == 19 {
            self.send_cells(bms, state, &mut send);
        }
    }

    fn next_alive(&mut self, of: usize) -> u8 {
        let Some(alive) = self.alive.get_mut(of) else { return 0 };
        *alive = alive_after(*alive);
        *alive
    }

    /// The next four cells; after the last, nothing until the second is over.
    fn send_cells<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        bms: &Bms<CELLS, SENSORS>,
        state: &BmsState<CELLS, SENSORS>,
        send: &mut impl FnMut(&Message),
    ) {
        let sheet = &bms.description().params().sheet;
        let oldest_s = sheet.sensing.cell_v.oldest_s(sheet.tick_s);
        let group = u8::try_from(self.group).unwrap_or(u8::MAX);
        if let Some(group) = CellGroup::of(&state.measurements().cell_v, oldest_s, group) {
            send(&group.encode());
        }
        let groups = CELLS.div_ceil(CELLS_IN_A_GROUP).max(usize::from(GROUPS_A_SECOND));
        self.group = if usize::from(self.group) + 1 < groups { self.group + 1 } else { 0 };
    }

    /// The next part of an entry that somebody wants.
    fn send_log<const CELLS: usize, const SENSORS: usize>(
        &mut self,
        state: &BmsState<CELLS, SENSORS>,
        send: &mut impl FnMut(&Message),
    ) {
        if let Some(wanted) = self.wanted.take() {
            match wanted.find(state.log().entries()) {
                Some(entry) => (self.parts, self.part) = (log_parts(entry), 0),
                None => send(&NO_ENTRY),
            }
        }
        if let Some(part) = self.parts.get(self.part) {
            send(part);
            self.part += 1;
        }
    }
}

const _: () = assert!(FAULT_PAGES == 4);

fn status<const CELLS: usize, const SENSORS: usize>(
    bms: &Bms<CELLS, SENSORS>,
    state: &BmsState<CELLS, SENSORS>,
) -> Status {
    let (soc, soc_sd, _) = bms.charge(state);
    Status {
        phase: state.contactors().phase(),
        cause: state.contactors().cause(),
        trip: state.verdict().trip,
        permit: state.verdict().permit,
        mode: state.mode,
        soc,
        soc_sd,
    }
}
