//! A simulated pack that is managed.

extern crate std;

use plant_core::presets::PANASONIC_NCR18650PF as CELL;

use super::*;
use crate::comm::can::{CellGroup, Command, LogReader, LogRequest, Message, Status};
use crate::contactor::{Cause, Coils, Phase};
use crate::estimate::ekf::EkfMemory;
use crate::limit::{Limits, Request};
use crate::protect::{Clear, EXAMPLE, Faults, Id, Level, Side, Trip};
use crate::store::record::Record;
use crate::{Health, Real, must};

pub(super) const CELLS: usize = 14;
const PARALLEL: Real = 20.0;
pub(super) static PACK: Description =
    must!(Description::new(BmsParams::typical(EXAMPLE, CELL, 33.0)));
pub(super) const BMS: Bms<CELLS, 4> = must!(Bms::new(&PACK));

mod rig;
pub(super) use rig::Rig;

pub(super) type State = BmsState<CELLS, 4>;

pub(super) const OFF: Asked = Asked { vehicle: Request::Off, ..Asked::NOTHING };
pub(super) const DRIVE: Asked = Asked { vehicle: Request::Drive, ..Asked::NOTHING };

fn run(state: &mut State, rig: &mut Rig, ms: u32) {
    for _ in 0..ms {
        BMS.tick(state, rig);
    }
}

/// The time until something is so \[ms\].
fn until(state: &mut State, rig: &mut Rig, most_ms: u32, so: impl Fn(&State) -> bool) -> u32 {
    for ms in 1..=most_ms {
        BMS.tick(state, rig);
        if so(state) {
            return ms;
        }
    }
    panic!("not within {most_ms} ms: {:?}", BMS.report(state));
}

/// A pack at so much that drives.
fn driving(soc: Real) -> (State, Rig) {
    let mut rig = Rig::new(soc);
    let record = Record { soc, soc_sd: 0.02, ..record() };
    let mut state = BMS.start(Some(&record), Some(100), 25.0).unwrap();
    BMS.request(&mut state, OFF);
    run(&mut state, &mut rig, 100);
    BMS.request(&mut state, DRIVE);
    until(&mut state, &mut rig, 1000, |state| state.contactors.phase() == Phase::Closed);
    (state, rig)
}

pub(super) fn record() -> Record {
    let health = Health::as_new(PACK.battery());
    Record { written_at_s: Some(100), ..Record::of(EkfMemory::UNKNOWN, health) }
}

#[test]
fn drives_and_knows_what_is_left() {
    let (mut state, mut rig) = driving(0.8);
    for second in 0..120_u16 {
        rig.load_a = if second % 20 < 10 { 60.0 } else { -10.0 };
        run(&mut state, &mut rig, 1000);
    }
    let report = BMS.report(&state);
    let truth = rig.cell.soc.get();
    assert!((report.soc - truth).abs() < 3.0 * report.soc_sd, "{truth} {report:?}");
    assert!(report.soc_sd < 0.02, "{report:?}");
    assert!((report.soc - truth).abs() < 0.01, "{truth} {report:?}");
    let Limits { discharge, charge } = report.limits;
    assert!(discharge.current_a > 20.0 * 5.0 && charge.current_a > 10.0, "{report:?}");
    let energy = report.energy.expect("after a second");
    // 14 groups of 20 cells of 2.9 Ah at about 3.6 V.
    let nominal_wh = 14.0 * 20.0 * 2.9 * 3.6;
    let left = energy.remaining_energy_wh / nominal_wh;
    assert!((left - truth).abs() < 0.1, "{left} {truth}");
    assert!((report.capacity_ah - 58.0).abs() < 3.0);
    assert!(report.throughput_ah > 1.0 && report.verdict.tripped.is_empty(), "{report:?}");
}

#[test]
fn a_cell_too_high_opens_in_time() {
    let (mut state, mut rig) = driving(0.8);
    rig.over_v[9] = 0.6;
    let trips = until(&mut state, &mut rig, 200, |state| state.verdict.trip == Trip::Hard);
    assert!(trips <= 100, "{trips}");
    let opens = until(&mut state, &mut rig, 200, |state| !state.contactors.coils().plus);
    assert!(opens <= 51, "{opens}");
    let high = Id::CellVoltage(Side::High, Level::Msl);
    assert!(state.verdict.latched.has(high));
    let entries: std::vec::Vec<_> = state.log().entries().filter(|e| e.id == high).collect();
    assert_eq!(entries.len(), 1, "{entries:?}");
    assert!(entries[0].frame.cell_v[1] > 4.25 && (entries[0].frame.soc - 0.8).abs() < 0.02);
    // Nothing closes until it is gone and somebody ends it.
    rig.over_v = [0.0; CELLS];
    run(&mut state, &mut rig, 12_000);
    assert_eq!(state.contactors.phase(), Phase::Fault, "{:?}", BMS.report(&state));
    BMS.request(&mut state, Asked { clear: Clear::Reset, ..OFF });
    run(&mut state, &mut rig, 100);
    BMS.request(&mut state, DRIVE);
    until(&mut state, &mut rig, 1000, |state| state.contactors.phase() == Phase::Closed);
}

#[test]
fn data_that_do_not_come_end_the_drive() {
    let (mut state, mut rig) = driving(0.5);
    rig.lost = true;
    let trips = until(&mut state, &mut rig, 200, |state| state.verdict.trip == Trip::Soft);
    assert!(trips <= 101, "{trips}");
    until(&mut state, &mut rig, 2100, |state| !state.contactors.coils().plus);
    let Limits { discharge, charge } = BMS.report(&state).limits;
    assert_eq!((discharge.current_a, charge.current_a), (0.0, 0.0));
}

#[test]
fn a_crash_opens_at_once() {
    let (mut state, mut rig) = driving(0.5);
    rig.load_a = 200.0;
    run(&mut state, &mut rig, 5);
    rig.flags = Faults::NONE.with(Id::Crash);
    let opens =
        until(&mut state, &mut rig, 10, |state| state.contactors.coils() == Coils::default());
    assert!(opens <= 2, "{opens}");
    // Beyond a power cut, until a workshop ends it.
    rig.flags = Faults::NONE;
    rig.load_a = 0.0;
    run(&mut state, &mut rig, 6000);
    let record = BMS.record(&mut state, Some(110)).expect("worth it");
    assert_ne!(record.lock_out_cause, 0);
    let mut state = BMS.start(Some(&record), Some(200), 25.0).unwrap();
    BMS.request(&mut state, OFF);
    run(&mut state, &mut rig, 500);
    BMS.request(&mut state, DRIVE);
    run(&mut state, &mut rig, 1000);
    assert_eq!((state.contactors.phase(), state.contactors.cause()), (Phase::Fault, Cause::Crash));
    assert!(state.verdict.latched.has(Id::Crash));
    BMS.request(&mut state, Asked { clear: Clear::Reset, ..OFF });
    run(&mut state, &mut rig, 100);
    assert_eq!(state.contactors.phase(), Phase::Fault, "a driver cannot end it");
    BMS.request(&mut state, Asked { clear: Clear::Service, ..OFF });
    run(&mut state, &mut rig, 100);
    assert_eq!(state.contactors.phase(), Phase::Standby);
}

#[test]
fn a_current_through_open_contactors_is_told() {
    let (mut state, mut rig) = driving(0.5);
    rig.load_a = 20.0;
    run(&mut state, &mut rig, 2000);
    assert!(state.verdict.tripped.is_empty(), "{:?}", state.verdict);
    rig.load_a = 0.0;
    BMS.request(&mut state, OFF);
    until(&mut state, &mut rig, 10_000, |state| state.contactors.phase() == Phase::Standby);
    rig.leak_a = 20.0;
    let told =
        until(&mut state, &mut rig, 1000, |state| state.verdict.tripped.has(Id::CurrentWhileOpen));
    assert!(told >= 500, "{told}");
    assert!(!state.verdict.permit);
}

/// The reports of a pack are those of its cells, series and parallel.
#[test]
fn what_is_left_is_that_of_the_pack() {
    let (mut state, mut rig) = driving(0.5);
    rig.load_a = 40.0;
    run(&mut state, &mut rig, 5000);
    let (report, of_cell) = (BMS.report(&state), state.energy_left.unwrap());
    let energy = report.energy.unwrap();
    for (of_pack, of_cell, times) in [
        (energy.remaining_capacity_ah, of_cell.remaining_capacity_ah, 20.0),
        (energy.full_charge_capacity_ah, of_cell.full_charge_capacity_ah, 20.0),
        (energy.remaining_energy_wh, of_cell.remaining_energy_wh, 280.0),
        (energy.full_charge_energy_wh, of_cell.full_charge_energy_wh, 280.0),
        (energy.remaining_energy_sd_wh, of_cell.remaining_energy_sd_wh, 280.0),
    ] {
        assert!((of_pack / of_cell - times).abs() < 1e-3 && of_cell > 0.0, "{of_pack} {of_cell}");
    }
    assert!((report.capacity_ah / state.series.health.capacity_ah - 20.0).abs() < 1e-4);
}

#[test]
fn a_record_is_worth_a_write_when_it_opens() {
    let (mut state, mut rig) = driving(0.6);
    assert_eq!(BMS.record(&mut state, Some(101)), None, "nothing has changed");
    rig.load_a = 30.0;
    run(&mut state, &mut rig, 20_000);
    assert_eq!(BMS.record(&mut state, Some(121)), None);
    rig.load_a = 0.0;
    BMS.request(&mut state, OFF);
    until(&mut state, &mut rig, 10_000, |state| state.contactors.phase() == Phase::Standby);
    let record = BMS.record(&mut state, Some(130)).expect("it has opened");
    assert_eq!(BMS.record(&mut state, Some(131)), None, "once");
    let resumed = BMS.start(Some(&record), Some(160), 25.0).unwrap();
    let (before, after) = (BMS.report(&state), BMS.report(&resumed));
    assert!((before.soc - after.soc).abs() < 2e-3, "{before:?} {after:?}");
    assert!(record.polarisation.is_some() && record.throughput_ah > 0.15, "{record:?}");
    assert_eq!(before.throughput_ah, after.throughput_ah);
    let late = BMS.start(Some(&record), None, 25.0).unwrap();
    assert!(BMS.report(&late).soc_sd > after.soc_sd, "nobody knows how long it stood");
}

#[test]
fn late_calls_lose_no_charge() {
    for late in [1, 3, 7] {
        let (mut state, mut rig) = driving(0.7);
        rig.load_a = 100.0;
        let before = (BMS.series.counter.soc(&state.series.counter), rig.cell.soc.get());
        // A whole number of samples of either length.
        for n in 1..=21_000_u32 {
            BMS.fast(&mut state, &mut rig);
            if n % (100 * late) == 0 {
                BMS.filter(&mut state, &mut rig);
            }
        }
        let after = (BMS.series.counter.soc(&state.series.counter), rig.cell.soc.get());
        let (counted, gone) = (before.0 - after.0, before.1 - after.1);
        assert!((counted / gone - 1.0).abs() < 2e-3, "{late}: {counted} {gone}");
    }
}

#[test]
fn sleep_ages_what_is_known() {
    let (mut state, mut rig) = driving(0.7);
    BMS.request(&mut state, OFF);
    until(&mut state, &mut rig, 10_000, |state| state.contactors.phase() == Phase::Standby);
    let before = BMS.report(&state);
    rig.tick_us = 8 * 3600 * 1_000_000;
    BMS.fast(&mut state, &mut rig);
    rig.tick_us = 1000;
    BMS.filter(&mut state, &mut rig);
    let after = BMS.report(&state);
    // C/3000 over eight hours.
    let grown = after.soc_sd * after.soc_sd - before.soc_sd * before.soc_sd;
    assert!(after.soc_sd > before.soc_sd && grown < 1e-4, "{before:?} {after:?}");
    assert!(state.verdict.tripped.has(Id::LateStep) || !state.verdict.rose.has(Id::LateStep));
}

#[test]
fn a_fuller_cell_is_bled_and_the_estimate_knows() {
    let mut rig = Rig::new(0.6);
    // At this charge the curve rises by some 0.7 V: 5 % of charge.
    rig.over_v[3] = 0.04;
    let record = Record { soc: 0.6, soc_sd: 0.005, ..record_of_rest() };
    let mut state = BMS.start(Some(&record), Some(100), 25.0).unwrap();
    BMS.request(&mut state, OFF);
    let mut bled = [0_u32; CELLS];
    for _ in 0..400_000_u32 {
        BMS.tick(&mut state, &mut rig);
        for (count, on) in bled.iter_mut().zip(rig.bled) {
            *count += u32::from(on);
        }
    }
    assert!(bled[3] > 50_000, "{bled:?}");
    assert!(bled.iter().enumerate().all(|(cell, ms)| cell == 3 || *ms == 0), "{bled:?}");
}

fn record_of_rest() -> Record {
    use crate::estimate::ekf::Polarisation;
    Record { polarisation: Some(Polarisation::NONE), ..record() }
}

#[test]
fn nobody_who_asks_is_heard_beyond_silence() {
    let (mut state, mut rig) = driving(0.5);
    BMS.request(&mut state, Asked::NOTHING);
    until(&mut state, &mut rig, 10_000, |state| state.contactors.phase() == Phase::Standby);
    BMS.request(&mut state, Asked { vehicle: Request::Drive, charger: Request::Charge, ..OFF });
    run(&mut state, &mut rig, 3000);
    assert_eq!(state.contactors.phase(), Phase::Standby, "they do not agree");
}

#[test]
fn a_description_that_cannot_be_is_refused() {
    let usual = BmsParams::typical(EXAMPLE, CELL, 33.0);
    let refused = |params| Description::new(params).unwrap_err();
    for sample_s in [0.03, 0.3, 0.1001, 0.0, Real::NAN] {
        let error = refused(BmsParams { sample_s, ..usual });
        assert_eq!(error.field(), "bms.sample_s", "{sample_s}");
    }
    let error = refused(BmsParams { current_gain_sd: 2.0, ..usual });
    assert_eq!(error.field(), "bms.current_gain_sd");
    assert_eq!(Bms::<13, 4>::new(&PACK).unwrap_err(), ParamError::LengthsDiffer("layout.series"),);
}

/// A pack on a bus for a while: what it sent.
fn on_a_bus(
    seconds: u32,
    says: impl Fn(u32) -> Option<Message>,
) -> (State, std::vec::Vec<Message>) {
    let (mut rig, mut bus) = (Rig::new(0.5), Bus::NEW);
    let mut state =
        BMS.start(Some(&Record { soc: 0.5, soc_sd: 0.02, ..record() }), None, 25.0).unwrap();
    let mut sent = std::vec::Vec::new();
    for ms in 0..1000 * seconds {
        if let Some(message) = says(ms) {
            bus.hear(&message);
        }
        BMS.request(&mut state, bus.asked(0.001));
        BMS.tick(&mut state, &mut rig);
        let before = sent.len();
        bus.send(&BMS, &state, |message| sent.push(*message));
        assert!(sent.len() - before <= 2, "{ms}: too many at once");
    }
    (state, sent)
}

fn drives(ms: u32) -> Option<Message> {
    let request = if ms < 500 { Request::Off } else { Request::Drive };
    let alive = u8::try_from(ms / 20 % 15).unwrap();
    let command = Command { request, clear: Clear::No };
    ms.is_multiple_of(20).then(|| command.encode_vehicle(alive))
}

#[test]
fn a_bus_hears_and_says_everything_in_time() {
    let (state, sent) = on_a_bus(3, drives);
    assert_eq!(state.contactors().phase(), Phase::Closed);
    let count = |id| sent.iter().filter(|message| message.id() == id).count();
    // 14 cells are four groups; each set of pages and of groups in its second.
    assert_eq!([0x510, 0x511, 0x512, 0x513].map(count), [300, 300, 30, 30]);
    assert_eq!([0x514, 0x515, 0x516, 0x517].map(count), [30, 12, 120, 0]);
    let last = sent.iter().rev().find_map(Status::decode).unwrap();
    assert_eq!((last.phase, last.mode), (Phase::Closed, crate::limit::Mode::Drive));
    assert!((last.soc - BMS.report(&state).soc).abs() < 1e-3);
    let groups: std::vec::Vec<u8> =
        sent.iter().filter_map(CellGroup::decode).map(|group| group.group).collect();
    assert_eq!(groups, [0, 1, 2, 3].repeat(3));
}

#[test]
fn a_vehicle_that_falls_silent_ends_the_drive_and_can_be_read_out() {
    let says = |ms: u32| match ms {
        0..2000 => drives(ms),
        9000 => Some(LogRequest::Newest.encode()),
        _ => None,
    };
    let (state, sent) = on_a_bus(10, says);
    assert_eq!(state.contactors().coils(), Coils::default());
    let mut reader = LogReader::NEW;
    let entry = sent.iter().find_map(|message| reader.read(message)).unwrap().unwrap();
    assert_eq!(Some(&entry), state.log().entries().last());
    let lost = |e: &crate::log::Entry| e.id == Id::RequestLost;
    assert!(state.log().entries().any(lost), "{:?}", state.log());
}
