//! Who asks, and whether it is believed; up to the table's verdict.

extern crate std;

use super::super::*;
use super::{harmed, message};
use crate::limit::Request;
use crate::measure::{Measurements, Reading};
use crate::protect::{
    Clear, EXAMPLE, Faults, Id, Protection, ProtectionState, Signals, Table, Trip, Verdict,
};
use crate::{Real, must};

const TABLE: Table = must!(Table::new(EXAMPLE));
const PACK: Protection<'static, 14, 4> = must!(Protection::new(&TABLE));

const fn ask(request: Request) -> Command {
    Command { request, clear: Clear::No }
}

/// A vehicle that has been heard, and the next value of its counter.
fn heard(request: Request) -> (RequestWatchState, u8) {
    let mut state = RequestWatchState::NEW;
    for alive in 0..2 {
        REQUEST.elapse(&mut state, 0.02);
        REQUEST.hear(&mut state, &ask(request).encode_vehicle(alive));
    }
    assert_eq!(state.request(), request);
    (state, 2)
}

#[test]
fn every_request_comes_through() {
    for request in [Request::Off, Request::Drive, Request::Charge, Request::Unknown] {
        let (state, _) = heard(request);
        assert!(REQUEST.faults(&state).is_empty());
    }
    let mut charger = RequestWatchState::NEW;
    for alive in 3..5 {
        CHARGER.hear(&mut charger, &ask(Request::Charge).encode_charger(alive));
        REQUEST.hear(&mut charger, &ask(Request::Drive).encode_charger(alive));
    }
    assert_eq!(charger.request(), Request::Charge, "the other's messages are left alone");
    assert!(REQUEST.faults(&charger).is_empty(), "and are not counted as corrupt");
}

#[test]
fn one_frame_starts_nothing() {
    let mut state = RequestWatchState::NEW;
    REQUEST.hear(&mut state, &ask(Request::Drive).encode_vehicle(4));
    assert_eq!(state.request(), Request::Silent);
    assert!(REQUEST.faults(&state).is_empty(), "nobody was there to be lost");
    REQUEST.elapse(&mut state, 0.11);
    REQUEST.hear(&mut state, &ask(Request::Drive).encode_vehicle(5));
    assert_eq!(state.request(), Request::Silent, "the silence between begins anew");
}

#[test]
fn a_counter_that_stands_still_is_silence() {
    let (mut state, _) = heard(Request::Drive);
    for step in 1..=5 {
        REQUEST.elapse(&mut state, 0.0199);
        REQUEST.hear(&mut state, &ask(Request::Drive).encode_vehicle(1));
        assert_eq!(state.request(), Request::Drive, "step {step}");
    }
    REQUEST.elapse(&mut state, 0.02);
    assert_eq!(state.request(), Request::Silent);
    assert_eq!(REQUEST.faults(&state), Faults::NONE.with(Id::RequestLost));
    for _ in 0..50 {
        REQUEST.hear(&mut state, &ask(Request::Drive).encode_vehicle(1));
        REQUEST.elapse(&mut state, 0.02);
        assert_eq!(state.request(), Request::Silent, "and stays so");
    }
}

#[test]
fn some_may_be_lost_and_more_is_out_of_turn() {
    for skipped in 0..14_u8 {
        let (mut state, _) = heard(Request::Drive);
        REQUEST.elapse(&mut state, 0.05);
        let alive = (0..=skipped).fold(1, |alive, _| alive_after(alive));
        REQUEST.hear(&mut state, &ask(Request::Charge).encode_vehicle(alive));
        let taken = state.request() == Request::Charge;
        assert_eq!(taken, skipped < 3, "{skipped} lost");
        // From there it goes on.
        REQUEST.hear(&mut state, &ask(Request::Charge).encode_vehicle(alive_after(alive)));
        assert_eq!(state.request(), Request::Charge);
        assert!(REQUEST.faults(&state).is_empty(), "one is tolerated");
    }
}

#[test]
fn a_counter_of_fifteen_is_none() {
    let (mut state, _) = heard(Request::Drive);
    REQUEST.hear(&mut state, &ask(Request::Charge).encode_vehicle(15));
    REQUEST.hear(&mut state, &ask(Request::Charge).encode_vehicle(15));
    assert_eq!(state.request(), Request::Drive);
    assert!(REQUEST.faults(&state).has(Id::RequestCorrupt));
}

#[test]
fn one_corrupt_in_fifteen_is_tolerated_a_second_is_not() {
    for apart in 1..40_usize {
        let (mut state, mut alive) = heard(Request::Drive);
        let mut ever = false;
        for number in 0..60 {
            let sound = ask(Request::Drive).encode_vehicle(alive);
            let wrong = number == 10 || number == 10 + apart;
            REQUEST.elapse(&mut state, 0.02);
            REQUEST.hear(&mut state, &if wrong { harmed(&sound, 3) } else { sound });
            alive = alive_after(alive);
            ever |= REQUEST.faults(&state).has(Id::RequestCorrupt);
        }
        assert_eq!(ever, apart < 15, "{apart} apart");
        assert_eq!(REQUEST.faults(&state), Faults::NONE, "it heals");
    }
}

#[test]
fn any_wrong_bit_is_not_heard() {
    for bit in 0..64 {
        let (mut state, alive) = heard(Request::Drive);
        REQUEST.hear(&mut state, &harmed(&ask(Request::Charge).encode_vehicle(alive), bit));
        assert_eq!(state.request(), Request::Drive, "bit {bit}");
    }
    let (mut state, alive) = heard(Request::Drive);
    let foreign = message(0x520, ask(Request::Charge).encode_charger(alive).data());
    REQUEST.hear(&mut state, &foreign);
    assert_eq!(state.request(), Request::Drive, "sealed for another identifier");
    REQUEST.hear(&mut state, &message(0x520, &[0; 7]));
    assert_eq!(state.request(), Request::Drive, "too short");
}

#[test]
fn who_asked_for_off_may_go() {
    for (request, lost) in [
        (Request::Off, false),
        (Request::Drive, true),
        (Request::Charge, true),
        (Request::Unknown, true),
    ] {
        let (mut state, _) = heard(request);
        REQUEST.elapse(&mut state, 1.0);
        assert_eq!(REQUEST.faults(&state).has(Id::RequestLost), lost, "{request:?}");
    }
    let mut charger = RequestWatchState::NEW;
    for alive in 0..2 {
        CHARGER.hear(&mut charger, &ask(Request::Charge).encode_charger(alive));
    }
    CHARGER.elapse(&mut charger, 0.5);
    assert_eq!(CHARGER.faults(&charger), Faults::NONE);
    CHARGER.elapse(&mut charger, 0.001);
    assert_eq!(CHARGER.faults(&charger), Faults::NONE.with(Id::ChargerLost));
}

#[test]
fn a_clock_gone_wrong_is_silence() {
    for elapsed_s in [-1.0, Real::NAN, Real::INFINITY] {
        let (mut state, _) = heard(Request::Drive);
        REQUEST.elapse(&mut state, elapsed_s);
        assert_eq!(state.request(), Request::Silent, "{elapsed_s}");
    }
}

#[test]
fn a_wish_to_clear_counts_once_and_with_its_key() {
    let (mut state, mut alive) = heard(Request::Off);
    let mut hear = |state: &mut RequestWatchState, clear, spoilt: bool| {
        let sent = Command { request: Request::Off, clear }.encode_vehicle(alive);
        let sent = if spoilt {
            // A wrong key under a checksum that fits.
            let bits = u64::from_le_bytes(sent.data().try_into().unwrap());
            guard::sealed(&request::VEHICLE_REQUEST, bits ^ 1 << 20, alive)
        } else {
            sent
        };
        REQUEST.elapse(state, 0.02);
        REQUEST.hear(state, &sent);
        alive = alive_after(alive);
        state.take_clear()
    };
    for clear in [Clear::Reset, Clear::Service] {
        assert_eq!(hear(&mut state, clear, true), Clear::No, "the key does not fit");
        assert_eq!(hear(&mut state, clear, false), clear);
        for _ in 0..40 {
            assert_eq!(hear(&mut state, clear, false), Clear::No, "a button that is stuck");
        }
        assert_eq!(hear(&mut state, Clear::No, false), Clear::No);
        assert_eq!(hear(&mut state, clear, false), clear, "pressed again");
        assert_eq!(hear(&mut state, Clear::No, false), Clear::No);
    }
}

fn judge(state: &mut ProtectionState<14, 4>, watch: &mut RequestWatchState) -> Verdict {
    let now = Measurements {
        cell_v: [Reading::new(3.7); 14],
        temperature_c: [Reading::new(25.0); 4],
        current_a: Reading::new(12.0),
        pack_v: Reading::new(51.8),
        link_v: Reading::new(51.8),
    };
    let signals = Signals {
        flags: REQUEST.faults(watch),
        clear: watch.take_clear(),
        mains_closed: true,
        second_current_a: 12.0,
        residual_v: 0.001,
        cells_found: Some(14),
        insulation_ohm_per_v: Some(Reading::new(5000.0)),
        wires_v: &[0.01; 15],
        elapsed_s: EXAMPLE.tick_s,
        ..Signals::QUIET
    };
    PACK.step(state, &now, &signals)
}

/// The table's verdict each tick, with a message every 20 ms made of counter and number by `send`:
/// when a row first trips, in ticks after `from`.
fn trips(id: Id, from: u32, send: impl Fn(u8, u32) -> Option<Message>) -> Option<u32> {
    let (mut watch, mut alive) = heard(Request::Drive);
    let mut state = ProtectionState::NEW;
    let every = (0.02 / EXAMPLE.tick_s).round() as u32;
    for tick in 0..2000_u32 {
        REQUEST.elapse(&mut watch, EXAMPLE.tick_s);
        if tick % every == 0 {
            if let Some(message) = send(alive, tick) {
                REQUEST.hear(&mut watch, &message);
            }
            alive = alive_after(alive);
        }
        let verdict = judge(&mut state, &mut watch);
        if verdict.tripped.has(id) {
            assert_eq!(verdict.trip, Trip::Soft);
            return tick.checked_sub(from);
        }
    }
    None
}

#[test]
fn the_table_trips_when_requests_end_freeze_or_are_corrupt() {
    let sound = |alive| ask(Request::Drive).encode_vehicle(alive);
    assert_eq!(trips(Id::RequestLost, 0, |alive, _| Some(sound(alive))), None);
    assert_eq!(trips(Id::RequestCorrupt, 0, |alive, _| Some(sound(alive))), None);
    // The last that counts comes at tick 1000: 100 ms of silence, and two judgements of the row.
    let ends = |alive, tick| (tick <= 1000).then(|| sound(alive));
    let ended = trips(Id::RequestLost, 1000, ends).unwrap();
    assert!((100..=103).contains(&ended), "{ended} ms");
    let frozen = |alive, tick| Some(if tick <= 1000 { sound(alive) } else { sound(0) });
    let frozen = trips(Id::RequestLost, 1000, frozen).unwrap();
    assert!((100..=123).contains(&frozen), "{frozen} ms");
    let corrupt =
        |alive, tick| Some(if tick <= 1000 { sound(alive) } else { harmed(&sound(alive), 0) });
    let corrupt = trips(Id::RequestCorrupt, 1000, corrupt).unwrap();
    assert!((40..=43).contains(&corrupt), "the second one, {corrupt} ms");
}
