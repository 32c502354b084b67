//! The pack of the tests of [`manage`](crate::manage), recorded and run again.

extern crate std;

use std::boxed::Box;
use std::vec::Vec;
use std::{println, vec};

use super::*;
use crate::contactor::{Coils, Phase};
use crate::manage::tests::{BMS, CELLS, DRIVE, OFF, PACK, Rig, State, record};
use crate::manage::{Bms, Board};
use crate::protect::{Clear, Id, Level, Row, Side, Trip};
use crate::{Measurements, ParamError};

const OVER: Id = Id::CellVoltage(Side::High, Level::Msl);

/// Noise on everything, cells and temperatures every 20 ms; where `restless`, every other answer
/// changes now and then.
struct Noisy {
    rig: Rig,
    seed: u32,
    ms: u32,
    restless: bool,
    wires_v: [Real; CELLS + 1],
    /// Every cell is read too high by this \[V\], and what is in series with it.
    reference_v: Real,
}

impl Noisy {
    fn new(restless: bool) -> Self {
        Self {
            rig: Rig::new(0.6),
            seed: 1,
            ms: 0,
            restless,
            wires_v: [0.01; CELLS + 1],
            reference_v: 0.0,
        }
    }

    fn noise(&mut self) -> Real {
        self.seed = self.seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.seed >> 8) as Real / 16_777_216.0 - 0.5
    }

    /// Now and then.
    fn now(&mut self, every: u32) -> bool {
        self.restless && self.ms % every == 3
    }
}

impl Board<CELLS, 4> for Noisy {
    fn uptime_us(&mut self) -> u64 {
        self.ms += 1;
        let late_us = if self.now(7) { 130 } else { 0 };
        self.rig.uptime_us() + late_us
    }
    fn measure(&mut self, into: &mut Measurements<CELLS, 4>) {
        let mut all = *into;
        self.rig.measure(&mut all);
        if self.ms.is_multiple_of(20) {
            for (cell, read) in into.cell_v.iter_mut().zip(all.cell_v) {
                *cell = Reading::new(read.value + self.reference_v + 0.002 * self.noise());
            }
            into.temperature_c = all.temperature_c;
        }
        into.current_a = Reading::new(all.current_a.value + 0.5 * self.noise());
        let series_v = 14.0 * self.reference_v;
        into.pack_v = Reading::new(all.pack_v.value + series_v + 0.05 * self.noise());
        into.link_v = Reading::new(all.link_v.value + series_v + 0.05 * self.noise());
        if self.now(90) {
            into.current_a.valid = false;
            into.cell_v[2] = Reading { value: Real::NAN, age_s: 0.03, valid: true };
        }
    }
    fn feedback(&mut self) -> [Feedback; 3] {
        let [minus, precharge, plus] = self.rig.feedback();
        if self.now(311) { [minus, Feedback::Unknown, plus] } else { [minus, precharge, plus] }
    }
    fn drive(&mut self, coils: Coils) -> bool {
        let drives = !self.now(1999);
        self.rig.drive(coils) && drives
    }
    fn bleed(&mut self, cells: &[bool; CELLS]) {
        self.rig.bleed(cells);
    }
    fn flags(&mut self) -> Faults {
        if self.now(1500) { Faults::NONE.with(Id::Coolant) } else { self.rig.flags }
    }
    fn second_current_a(&mut self) -> Real {
        if self.now(2) { self.rig.current_a } else { Real::NAN }
    }
    fn insulation_ohm_per_v(&mut self) -> Option<Reading> {
        self.now(5).then(|| Reading::new(5000.0))
    }
    fn cells_found(&mut self) -> Option<u16> {
        self.now(4).then_some(14)
    }
    fn wires_v(&mut self) -> Option<&[Real]> {
        self.wires_v[3] = 0.01 + 0.001 * self.noise();
        self.now(100).then_some(&self.wires_v[..])
    }
    fn balancing_c(&mut self) -> Real {
        if self.now(10) { 40.0 } else { 25.0 }
    }
}

fn started() -> State {
    let record = crate::store::record::Record { soc: 0.6, soc_sd: 0.02, ..record() };
    BMS.start(Some(&record), Some(100), 25.0).unwrap()
}

/// A drive of so many ticks, with a cell too high from the last half second on, and what is recorded.
fn recorded(bytes: usize, ticks: u32, board: &mut Noisy) -> (Vec<u8>, State, u32) {
    let mut memory = vec![0; bytes];
    let mut recorder = Recorder::new(&BMS, &mut memory).unwrap();
    let mut state = started();
    for ms in 0..ticks {
        BMS.request(&mut state, if ms < 100 { OFF } else { DRIVE });
        board.rig.load_a = if ms / 500 % 2 == 0 { 60.0 } else { -10.0 };
        board.rig.over_v[9] = if ms + 500 > ticks { 0.6 } else { 0.0 };
        recorder.call(Call::Tick, &BMS, &mut state, board);
    }
    let mut bytes = Vec::new();
    assert!(!recorder.write(&BMS, |_| panic!("not frozen")));
    recorder.freeze(&state);
    let kept = state.clone();
    // What comes later is not in it.
    for _ in 0..50 {
        recorder.call(Call::Tick, &BMS, &mut state, board);
    }
    assert!(recorder.write(&BMS, |piece| bytes.extend_from_slice(piece)));
    (bytes, kept, recorder.calls())
}

/// Runs it again: the last state, the calls, and the first call in which a row tripped.
fn again(bytes: &[u8], bms: &Bms<CELLS, 4>) -> (State, u32, Option<u32>) {
    let recording = Recording::read(bytes).unwrap();
    let mut state = recording.state().unwrap();
    let mut playback = recording.playback();
    let (mut calls, mut trips) = (0, None);
    while playback.next(bms, &mut state).unwrap().is_some() {
        calls += 1;
        if state.verdict.trip > Trip::None && trips.is_none() {
            trips = Some(calls);
        }
    }
    (state, calls, trips)
}

#[test]
fn gives_the_same_bits_whatever_a_board_answers() {
    for (bytes, ticks) in [(1 << 20, 3000), (1 << 16, 20_000), (1 << 15, 9_999)] {
        for restless in [false, true] {
            let (bytes, kept, calls) = recorded(bytes, ticks, &mut Noisy::new(restless));
            let recording = Recording::read(&bytes).unwrap();
            assert_eq!((recording.size(), recording.params()), ((14, 4), Ok(*PACK.params())));
            let (state, played, trips) = again(&bytes, &BMS);
            assert_eq!(played, calls);
            assert!(recording.ends_with(&state), "{restless}");
            assert!(trips.is_some() && state.verdict.trip >= Trip::Soft);
            assert!(restless || kept.verdict.latched.has(OVER));
            let mut other = state.clone();
            other.samples.elapsed_s += 1e-6;
            assert!(!recording.ends_with(&other), "one number of it");
        }
    }
}

#[test]
fn the_three_calls_are_recorded_too() {
    let (mut board, mut memory) = (Noisy::new(true), vec![0; 1 << 17]);
    let mut recorder = Recorder::new(&BMS, &mut memory).unwrap();
    let mut state = started();
    for ms in 1..5000_u32 {
        // The first wishes come too soon.
        let crashed = (1500..2000).contains(&ms);
        board.rig.flags = if crashed { Faults::NONE.with(Id::Crash) } else { Faults::NONE };
        let clear = if ms % 977 < 200 { Clear::Service } else { Clear::No };
        BMS.request(&mut state, Asked { clear, ..if ms < 100 { OFF } else { DRIVE } });
        recorder.call(Call::Fast, &BMS, &mut state, &mut board);
        if ms % 100 == 0 {
            recorder.call(Call::Filter, &BMS, &mut state, &mut board);
        } else if ms % 10 == 0 {
            recorder.call(Call::Slow, &BMS, &mut state, &mut board);
        }
    }
    recorder.freeze(&state);
    let mut bytes = Vec::new();
    assert!(recorder.write(&BMS, |piece| bytes.extend_from_slice(piece)));
    let (last, played, _) = again(&bytes, &BMS);
    assert!(played > 1000 && Recording::read(&bytes).unwrap().ends_with(&last));
}

/// Would it have tripped with a threshold a little higher, and when with one a little lower?
#[test]
fn another_threshold_is_tried_beside() {
    let mut board = Noisy::new(false);
    let mut memory = vec![0; 1 << 17];
    let mut recorder = Recorder::new(&BMS, &mut memory).unwrap();
    let mut state = started();
    let row = *PACK.table().row(OVER);
    for ms in 0..4000_u32 {
        BMS.request(&mut state, if ms < 100 { OFF } else { DRIVE });
        // 30 mV below the threshold for a while.
        board.reference_v = if ms > 3000 { row.threshold - 0.03 - board.rig.cell_v } else { 0.0 };
        recorder.call(Call::Tick, &BMS, &mut state, &mut board);
    }
    assert_eq!(state.contactors.phase(), Phase::Closed, "{:?}", state.verdict);
    recorder.freeze(&state);
    let mut bytes = Vec::new();
    assert!(recorder.write(&BMS, |piece| bytes.extend_from_slice(piece)));
    let with = |by_v: Real| -> Bms<CELLS, 4> {
        let row = Row { threshold: row.threshold + by_v, ..row };
        Bms::new(Box::leak(Box::new(PACK.supposing(row).unwrap()))).unwrap()
    };
    assert_eq!(again(&bytes, &BMS).2, None);
    assert_eq!(again(&bytes, &with(-0.02)).2, None);
    let (state, calls, trips) = again(&bytes, &with(-0.04));
    assert!(state.verdict.tripped.has(row.id));
    let after = trips.unwrap() + 4000 - calls - 3000;
    assert!((40..=101).contains(&after), "{after} ms after it rose");
}

/// The seconds that the page of this module gives.
#[test]
fn as_many_seconds_as_the_page_says() {
    let (bytes, _, calls) = recorded(1 << 20, 20_000, &mut Noisy::new(false));
    let [params, checkpoint, inputs] =
        [10, 14, 18].map(|at| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    assert_eq!(calls, 20_000);
    let per_s = f64::from(inputs) / 20.0;
    println!("{params} bytes of description, {checkpoint} of checkpoint, {per_s} a second");
    assert!((10_500.0..11_500.0).contains(&per_s) && checkpoint < 3000, "{per_s} {checkpoint}");
    let half = f64::from(1 << 15) - f64::from(checkpoint);
    let (least, most) = (half / per_s, 2.0 * half / per_s);
    assert!(least > 2.7 && most < 5.6, "{least} {most}");
    for ticks in [19_000, 20_000, 21_500] {
        let (.., calls) = recorded(1 << 16, ticks, &mut Noisy::new(false));
        assert!((2700..5600).contains(&calls), "{calls}");
    }
}

#[test]
fn what_is_no_recording_is_refused() {
    let (bytes, ..) = recorded(1 << 15, 700, &mut Noisy::new(true));
    let error = |bytes: &[u8]| Recording::read(bytes).unwrap_err();
    assert_eq!(error(b"candump"), RecordingError::Unknown);
    let changed = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    assert_eq!(error(&changed(1)), RecordingError::Unknown);
    assert_eq!(error(&changed(4)), RecordingError::Version(VERSION ^ 0x10));
    for at in (5..bytes.len()).step_by(3) {
        assert_eq!(error(&changed(at)), RecordingError::Corrupted, "{at}");
    }
    for length in 6..bytes.len() {
        assert_eq!(error(&bytes[..length]), RecordingError::Corrupted);
    }
    let recording = Recording::read(&bytes).unwrap();
    assert_eq!(recording.state::<13, 4>().unwrap_err(), RecordingError::OfAnother);
    let small = Recorder::new(&BMS, &mut [0; 3000]).unwrap_err();
    assert_eq!(small, ParamError::OutOfRange("recorder.memory"));
}
