//! The power fails at any step of a drive, and in the middle of any write or erase of the flash
//! memory: after the restart nothing is lost but the running interval, no contactor closes before
//! a renewed request, no count has gone back.

use voltstep_bms::Measurements;
use voltstep_bms::contactor::{Coils, Feedback, Phase};
use voltstep_bms::limit::Request;
use voltstep_bms::log::{Entry, LogStore};
use voltstep_bms::manage::{Asked, BmsState, Board};
use voltstep_bms::protect::{Clear, Faults, Id};
use voltstep_bms::store::record::{Record, RecordStore};

use crate::flash::Flash;
use crate::hardware::Hardware;
use crate::pack::BMS;

type State = BmsState<14, 4>;

/// The pack of the example with rows that somebody else finds bad.
#[derive(Clone)]
struct Bench {
    hardware: Hardware,
    flags: Faults,
}

impl Board<14, 4> for Bench {
    fn uptime_us(&mut self) -> u64 {
        self.hardware.uptime_us()
    }
    fn measure(&mut self, into: &mut Measurements<14, 4>) {
        self.hardware.measure(into);
    }
    fn feedback(&mut self) -> [Feedback; 3] {
        self.hardware.feedback()
    }
    fn drive(&mut self, coils: Coils) -> bool {
        self.hardware.drive(coils)
    }
    fn bleed(&mut self, cells: &[bool; 14]) {
        self.hardware.bleed(cells);
    }
    fn flags(&mut self) -> Faults {
        self.flags
    }
}

/// What is asked for, what is wrong, until when.
struct Stage {
    asked: Asked,
    wrong: Option<Id>,
    until: Phase,
    and_ms: u32,
}

const fn stage(vehicle: Request, clear: Clear, wrong: Option<Id>, until: Phase, ms: u32) -> Stage {
    Stage { asked: Asked { vehicle, clear, ..Asked::NOTHING }, wrong, until, and_ms: ms }
}

/// Start, precharge, drive, a fault, its end, a drive, a crash, its end, a drive, shut down.
const SCENARIO: [Stage; 10] = [
    stage(Request::Off, Clear::No, None, Phase::Standby, 50),
    stage(Request::Drive, Clear::No, None, Phase::Closed, 2500),
    stage(Request::Drive, Clear::No, Some(Id::Interlock), Phase::Fault, 50),
    stage(Request::Off, Clear::Reset, None, Phase::Standby, 50),
    stage(Request::Drive, Clear::No, None, Phase::Closed, 300),
    stage(Request::Drive, Clear::No, Some(Id::Crash), Phase::Fault, 50),
    stage(Request::Off, Clear::Service, None, Phase::Standby, 50),
    stage(Request::Drive, Clear::No, None, Phase::Closed, 300),
    stage(Request::Off, Clear::No, None, Phase::Cooldown, 20),
    stage(Request::Off, Clear::No, None, Phase::Standby, 50),
];

/// Two slots for the record, then the log.
const SLOTS: [u32; 2] = [0, 128];
const LOG: (u32, u32) = (256, 14);

fn records(flash: &mut Flash) -> RecordStore<&mut Flash> {
    RecordStore::new(flash, SLOTS).unwrap()
}

fn entries(flash: &mut Flash) -> LogStore<&mut Flash> {
    LogStore::new(flash, LOG.0, LOG.1).unwrap()
}

fn now_s(bench: &Bench) -> u32 {
    1000 + bench.hardware.milliseconds / 1000
}

fn started(flash: &mut Flash, bench: &Bench) -> State {
    let record = records(flash).load().newest.map(|stored| stored.record);
    let mut state = BMS.start(record.as_ref(), Some(now_s(bench)), 25.0).unwrap();
    state.log_mut().follow(entries(flash).newest());
    state
}

/// What the memory has confirmed so far.
#[derive(Clone)]
struct Stored {
    record: Option<Record>,
    newest: Option<u32>,
}

/// What a cut must not lose.
#[derive(Clone, Copy)]
struct Truth {
    soc: f32,
    throughput_ah: f32,
    heat_j: f32,
}

fn truth(state: &State, bench: &Bench) -> Truth {
    let now = BMS.worth_keeping(state, None);
    let (throughput_ah, heat_j) = (now.throughput_ah, now.resistor_heat_j);
    Truth { soc: bench.hardware.soc(), throughput_ah, heat_j }
}

/// What is being written.
#[derive(Clone, Copy)]
enum Write {
    Nothing,
    Record(Record),
    Entry(Entry),
}

impl Write {
    fn to(&self, flash: &mut Flash) -> bool {
        match self {
            Self::Nothing => true,
            Self::Record(record) => records(flash).save(record).is_ok(),
            Self::Entry(entry) => entries(flash).append(entry).is_ok(),
        }
    }
}

fn tick(state: &mut State, bench: &mut Bench, asked: Asked) {
    BMS.request(state, asked);
    BMS.tick(state, bench);
    bench.hardware.wait_for_the_next_millisecond(state.limits());
}

const DRIVE: Asked = Asked { vehicle: Request::Drive, ..Asked::NOTHING };
const OFF: Asked = Asked { vehicle: Request::Off, ..Asked::NOTHING };

/// After a cut: what is there, and what the BMS does while the request still stands; with a
/// renewed one too, where `wholly`.
fn judge(flash: &Flash, bench: &Bench, stored: &Stored, write: Write, truth: Truth, wholly: bool) {
    let (mut flash, mut bench) = (flash.clone(), bench.clone());
    flash.left = u32::MAX;
    bench.hardware.set_pins([false; 3]);
    bench.flags = Faults::NONE;
    let at = bench.hardware.milliseconds;

    let found = records(&mut flash).load().newest.map(|stored| stored.record);
    let being_written = matches!(write, Write::Record(record) if found == Some(record));
    assert!(found == stored.record || being_written, "{at} ms: {found:?}");
    let newest = entries(&mut flash).newest();
    let being_written = matches!(write, Write::Entry(entry) if newest == Some(entry.sequence));
    assert!(newest == stored.newest || being_written, "{at} ms: entry {newest:?}");

    let mut state = started(&mut flash, &bench);
    let kept = BMS.worth_keeping(&state, None);
    let report = BMS.report(&state);
    if let Some(record) = found {
        assert_eq!(kept.throughput_ah, record.throughput_ah, "{at} ms");
        assert_eq!(kept.lock_out_cause, record.lock_out_cause, "{at} ms");
        let lost_ah = truth.throughput_ah - kept.throughput_ah;
        assert!((0.0..=0.03 * report.capacity_ah).contains(&lost_ah), "{at} ms: {lost_ah} A·h");
        let error = (report.soc - truth.soc).abs();
        assert!(error <= 3.0 * report.soc_sd, "{at} ms: {error} of {}", report.soc_sd);
        // A heat that is forgotten lets a resistor be burnt by one cut after the other.
        assert!(
            kept.resistor_heat_j >= 0.97 * truth.heat_j - 1.0,
            "{at} ms: {kept:?} {}",
            truth.heat_j
        );
    }
    // Whoever asked before has not asked again.
    for _ in 0..50 {
        tick(&mut state, &mut bench, DRIVE);
        assert_eq!(state.contactors().coils(), Coils::default(), "{at} ms");
    }
    if !wholly {
        return;
    }
    let locked = kept.lock_out_cause != 0;
    for _ in 0..200 {
        tick(&mut state, &mut bench, OFF);
    }
    let closes = (0..1500).any(|_| {
        tick(&mut state, &mut bench, DRIVE);
        state.contactors().phase() == Phase::Closed
    });
    assert_eq!(closes, !locked, "{at} ms: {:?}", BMS.report(&state));
    // The next event is a new one.
    bench.flags = Faults::NONE.with(Id::Coolant);
    let next = (0..5000).find_map(|_| {
        tick(&mut state, &mut bench, DRIVE);
        state.log().pending().copied()
    });
    let next = next.expect("an event").sequence;
    assert!(newest.is_none_or(|newest| next > newest), "{at} ms: {next} after {newest:?}");
}

/// A pack at 60 % with the record of a product's first day.
fn fresh(soc_sd: f32) -> (Bench, Flash, Stored) {
    let bench = Bench { hardware: Hardware::at(0.6).unwrap(), flags: Faults::NONE };
    let mut flash = Flash::new(2048, false);
    let nothing = BMS.worth_keeping(&started(&mut flash, &bench), Some(now_s(&bench)));
    let known = Record { soc: 0.6, soc_sd, ..nothing };
    assert!(Write::Record(known).to(&mut flash));
    (bench, flash, Stored { record: Some(known), newest: None })
}

/// Goes through the scenario; `each` sees every step, and every write with the memory before it.
fn drive(mut each: impl FnMut(&Flash, &Bench, &Stored, &State, Write)) {
    let (mut bench, mut flash, mut stored) = fresh(0.01);
    let mut state = started(&mut flash, &bench);
    for stage in &SCENARIO {
        bench.flags = stage.wrong.map_or(Faults::NONE, |id| Faults::NONE.with(id));
        let (mut ms, mut left) = (0, stage.and_ms);
        while left > 0 {
            tick(&mut state, &mut bench, stage.asked);
            each(&flash, &bench, &stored, &state, Write::Nothing);
            if let Some(entry) = state.log().pending().copied() {
                each(&flash, &bench, &stored, &state, Write::Entry(entry));
                assert!(Write::Entry(entry).to(&mut flash));
                state.log_mut().stored();
                stored.newest = Some(entry.sequence);
            }
            if let Some(record) = BMS.record(&mut state, Some(now_s(&bench))) {
                each(&flash, &bench, &stored, &state, Write::Record(record));
                assert!(Write::Record(record).to(&mut flash));
                stored.record = Some(record);
            }
            left -= u32::from(state.contactors().phase() == stage.until);
            ms += 1;
            assert!(ms < 12_000, "{:?} is not reached: {:?}", stage.until, BMS.report(&state));
        }
    }
    let phase = state.contactors().phase();
    assert_eq!(phase, Phase::Standby);
}

#[test]
fn a_cut_at_any_step_loses_the_running_interval_and_nothing_more() {
    let (mut cuts, mut last) = (0, None);
    drive(|flash, bench, stored, state, write| {
        if matches!(write, Write::Nothing) {
            let phase = Some(state.contactors().phase());
            judge(flash, bench, stored, write, truth(state, bench), phase != last);
            last = phase;
            cuts += 1;
        }
    });
    println!("{cuts} cuts between two steps");
    assert!(cuts > 5000);
}

#[test]
fn a_cut_in_any_write_loses_what_was_being_written_and_nothing_more() {
    let (mut cuts, mut writes) = (0, 0);
    drive(|flash, bench, stored, state, write| {
        if matches!(write, Write::Nothing) {
            return;
        }
        writes += 1;
        for left in 0.. {
            for unreadable in [false, true] {
                let mut torn = flash.clone();
                (torn.left, torn.unreadable) = (left, unreadable);
                let whole = write.to(&mut torn);
                judge(&torn, bench, stored, write, truth(state, bench), left == 64);
                cuts += 1;
                if whole {
                    return;
                }
            }
        }
    });
    println!("{writes} writes, {cuts} cuts in them");
    assert!(writes > 10 && cuts > 1000);
}

/// Some minutes up and down, a cut every half second: a record is written often enough.
#[test]
fn a_cut_in_a_long_drive_loses_little_charge_and_says_so() {
    let (mut bench, mut flash, mut stored) = fresh(0.001);
    let (mut state, mut writes) = (started(&mut flash, &bench), 0);
    for ms in 0..500_000 {
        tick(&mut state, &mut bench, if ms < 100 { OFF } else { DRIVE });
        if ms % 500 == 0 {
            judge(&flash, &bench, &stored, Write::Nothing, truth(&state, &bench), false);
        }
        if let Some(record) = BMS.record(&mut state, Some(now_s(&bench))) {
            assert!(Write::Record(record).to(&mut flash));
            (stored.record, writes) = (Some(record), writes + 1);
        }
    }
    assert_eq!(state.contactors().phase(), Phase::Closed);
    assert!((4..20).contains(&writes), "{writes}");
    println!("{writes} writes in 500 s");
}
