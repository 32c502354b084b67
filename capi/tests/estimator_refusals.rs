//! Mistakes with the estimators: each gets its code, and changes nothing.

#![allow(clippy::cast_possible_truncation)] // a few cells

use std::ptr::{from_mut, null, null_mut};

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod memory;
use memory::all::all;
use memory::{DT_S, blank, preset, words};

/// The pointers of a call are bad one at a time: all others are good. Where it answers with another
/// code than the one asked for, its number in the list is said.
macro_rules! each_bad {
    ($bad:ident, $code:expr; $($name:ident($($argument:tt)*);)+) => {$(
        each_bad!(@call $bad, $code, $name, [] $($argument)*);
    )+};
    // Each `*p` is bad once, with all before and after it good.
    (@call $bad:ident, $code:expr, $name:ident, [$($before:tt)*] * $p:ident, $($after:tt)*) => {
        assert_eq!(
            each_bad!(@good $name, [$($before)* $bad($p),] $($after)*),
            $code,
            concat!(stringify!($name), ": ", stringify!($p))
        );
        each_bad!(@call $bad, $code, $name, [$($before)* $p,] $($after)*);
    };
    (@call $bad:ident, $code:expr, $name:ident, [$($before:tt)*] $p:expr, $($after:tt)*) => {
        each_bad!(@call $bad, $code, $name, [$($before)* $p,] $($after)*);
    };
    (@call $bad:ident, $code:expr, $name:ident, [$($before:tt)*]) => {};
    (@good $name:ident, [$($before:tt)*] * $p:ident, $($after:tt)*) => {
        each_bad!(@good $name, [$($before)* $p,] $($after)*)
    };
    (@good $name:ident, [$($before:tt)*] $p:expr, $($after:tt)*) => {
        each_bad!(@good $name, [$($before)* $p,] $($after)*)
    };
    (@good $name:ident, [$($before:tt)*]) => { $name($($before)*) };
}

/// Every function with every pointer that may not be null and has an alignment, marked by `*`.
macro_rules! every_pointer {
    ($bad:ident, $code:expr) => {{
        let mut all = all();
        let a = &mut *all;
        let words = a.pack.len() as u32;
        let (e, params) = (from_mut(&mut *a.e), &raw mut a.params);
        let (filter, counter) = (&raw mut a.filter, &raw mut a.counter);
        let (resistance, capacity) = (&raw mut a.resistance, &raw mut a.capacity);
        let (energy, walk, pack) = (&raw mut a.energy, &raw mut a.walk, a.pack.as_mut_ptr());
        let (sample, series_sample) = (&raw mut a.sample, &raw mut a.series_sample);
        let (estimate, health, pair) = (&raw mut a.estimate, &raw mut a.health, &raw mut a.pair);
        let (limits, record) = (a.limits.as_mut_ptr(), &raw mut a.record);
        let (bytes, stored) = (a.bytes.as_mut_ptr(), &raw mut a.stored);
        let (report, cell, cell_v) = (&raw mut a.report, &raw mut a.cell, a.cell_v.as_mut_ptr());
        let (done, sequence) = (&raw mut a.done, &raw mut a.sequence);
        // SAFETY: bad pointers are refused before they are used; the others are good.
        unsafe {
            each_bad! { $bad, $code;
                voltstep_estimator_params_preset(0, *params,);
                voltstep_estimators_init(*e, *params, DT_S,);
                voltstep_filter_start(*e, *filter, 0.5, 0.1, 25.0,);
                voltstep_filter_start_unknown(*e, *filter, 25.0,);
                voltstep_filter_start_rested(*e, *filter, 3.7, 25.0,);
                voltstep_filter_resume(*e, *filter, *record, 0.0, 25.0,);
                voltstep_filter_step(*e, *filter, *sample, null_mut(),);
                voltstep_filter_adopt(*e, *filter, *health,);
                voltstep_filter_record(*e, *filter, *health, *record,);
                voltstep_counter_start(*e, *counter, 0.5, 0.1,);
                voltstep_counter_start_rested(*e, *counter, 3.7,);
                voltstep_counter_resume(*e, *counter, *record, 0.0,);
                voltstep_counter_step(*e, *counter, 1.0,);
                voltstep_counter_review(*e, *counter, 3.7, null_mut(),);
                voltstep_health_unlearnt(*e, *health,);
                voltstep_resistance_start(*e, *resistance, *health,);
                voltstep_resistance_step(*e, *resistance, 3.7, 1.0, *estimate, null_mut(),);
                voltstep_capacity_start(*e, *capacity, *health,);
                voltstep_capacity_step(*e, *capacity, *pair, null_mut(),);
                voltstep_power_ahead(*e, *estimate, *health, *limits,);
                voltstep_power_walk_start(*e, *walk,);
                voltstep_power_walk(*e, *walk, *estimate, *health, *limits, done,);
                voltstep_energy_start(*e, *energy,);
                voltstep_energy_step(*e, *energy, 1.0, 3.7,);
                voltstep_energy_report(*e, *energy, *estimate, *health, *report,);
                voltstep_record_encode(*record, 1, bytes,);
                voltstep_record_decode(bytes, *record, *sequence,);
                voltstep_record_newest(bytes, bytes, *stored,);
                voltstep_series_start(*e, *pack, words, 4, record, 0.0, 25.0,);
                voltstep_series_step(*e, *pack, *series_sample, *cell_v, 4, null_mut(),);
                voltstep_series_cell(*pack, 0, *cell,);
                voltstep_series_power(*e, *pack, *limits,);
                voltstep_series_power_walk(*e, *pack, *walk, *limits, done,);
                voltstep_series_energy(*e, *pack, *report,);
                voltstep_series_record(*e, *pack, *record,);
            }
        }
    }};
}

/// No pointer.
fn no<T>(_: *mut T) -> *mut T {
    null_mut()
}

/// The same pointer, one byte on.
fn off<T>(pointer: *mut T) -> *mut T {
    pointer.wrapping_byte_add(1)
}

#[test]
fn null_pointers_are_refused() {
    every_pointer!(no, Status::NullPointer);
    let mut all = all();
    let a = &mut *all;
    let (e, walk, pack) = (&raw const *a.e, &raw mut a.walk, a.pack.as_mut_ptr());
    let (estimate, health) = (&raw const a.estimate, &raw const a.health);
    let (limits, done) = (a.limits.as_mut_ptr(), &raw mut a.done);
    let (bytes, record) = (a.bytes.as_mut_ptr(), &raw mut a.record);
    let (sequence, stored) = (&raw mut a.sequence, &raw mut a.stored);
    // SAFETY: null is allowed everywhere; the others come from references.
    unsafe {
        each_bad! { no, Status::NullPointer;
            voltstep_power_walk(e, walk, estimate, health, limits, *done,);
            voltstep_series_power_walk(e, pack, walk, limits, *done,);
            voltstep_record_encode(record, 1, *bytes,);
            voltstep_record_decode(*bytes, record, sequence,);
            voltstep_record_newest(*bytes, bytes, stored,);
            voltstep_record_newest(bytes, *bytes, stored,);
        }
    }
}

#[test]
fn misaligned_pointers_are_refused() {
    every_pointer!(off, Status::Misaligned);
    let mut all = all();
    let a = &mut *all;
    let (e, pair, cell_v) = (&raw const *a.e, &raw const a.pair, a.cell_v.as_ptr());
    let (sample, series_sample) = (&raw const a.sample, &raw const a.series_sample);
    let (estimate, pack) = (&raw const a.estimate, a.pack.as_mut_ptr());
    let (filter, counter) = (&raw mut a.filter, &raw mut a.counter);
    let (resistance, capacity) = (&raw mut a.resistance, &raw mut a.capacity);
    let (filter_out, counter_out) = (&raw mut a.filter_out, &raw mut a.counter_out);
    let (resistance_out, capacity_out) = (&raw mut a.resistance_out, &raw mut a.capacity_out);
    let series_out = &raw mut a.series_out;
    let record = &raw mut a.record;
    // SAFETY: misaligned pointers are refused before they are used; the others are good.
    unsafe {
        each_bad! { off, Status::Misaligned;
            voltstep_filter_step(e, filter, sample, *filter_out,);
            voltstep_counter_review(e, counter, 3.7, *counter_out,);
            voltstep_resistance_step(e, resistance, 3.7, 1.0, estimate, *resistance_out,);
            voltstep_capacity_step(e, capacity, pair, *capacity_out,);
            voltstep_series_step(e, pack, series_sample, cell_v, 4, *series_out,);
            voltstep_series_start(e, pack, 144, 4, *record, 0.0, 25.0,);
        }
    }
}

#[test]
fn a_step_without_a_place_for_its_outputs_is_not_made() {
    let mut all = all();
    let a = &mut *all;
    let (e, estimate, pair) = (&raw const *a.e, &raw const a.estimate, &raw const a.pair);
    let (sample, series_sample) = (&raw const a.sample, &raw const a.series_sample);
    let (pack, cell_v) = (a.pack.as_mut_ptr(), a.cell_v.as_ptr());
    let (filter, counter) = (&raw mut a.filter, &raw mut a.counter);
    let (resistance, capacity) = (&raw mut a.resistance, &raw mut a.capacity);
    /// Refuses a call, then makes it on the state and on a copy from before; both say the same.
    macro_rules! refused {
        ($state:ident, $out:expr, |$out_name:ident| $call:expr) => {{
            let mut before = $state.read();
            let $out_name = off(&raw mut $out);
            assert_eq!($call, Status::Misaligned);
            let $out_name = &raw mut $out;
            assert_eq!($call, Status::Ok);
            let after = $out;
            let $state = &raw mut before;
            assert_eq!($call, Status::Ok);
            assert_eq!(after, $out);
        }};
    }
    // SAFETY: misaligned pointers are refused before they are used; the others are good.
    unsafe {
        // What was counted before the review would be booked by the one that is refused.
        voltstep_counter_step(e, counter, 2.0);
        voltstep_counter_step(e, counter, f32::NAN);
        voltstep_resistance_step(e, resistance, 3.8, 0.0, estimate, null_mut());
        refused!(filter, a.filter_out, |out| voltstep_filter_step(e, filter, sample, out));
        refused!(counter, a.counter_out, |out| voltstep_counter_review(e, counter, 3.7, out));
        refused!(resistance, a.resistance_out, |out| {
            voltstep_resistance_step(e, resistance, 3.7, 2.0, estimate, out)
        });
        (a.pair.start.soc, a.pair.end.soc, a.pair.discharged_ah) = (0.9, 0.2, 1.9);
        (a.pair.start.soc_sd, a.pair.end.soc_sd, a.pair.duration_s) = (0.01, 0.01, 9e3);
        refused!(capacity, a.capacity_out, |out| voltstep_capacity_step(e, capacity, pair, out));
        assert!(
            a.resistance_out.learned && a.capacity_out.learned && a.counter_out.current_missing
        );

        let mut before = a.pack.clone();
        let out = &raw mut a.series_out;
        let status = voltstep_series_step(e, pack, series_sample, cell_v, 4, off(out));
        assert_eq!(status, Status::Misaligned);
        assert_eq!(voltstep_series_step(e, pack, series_sample, cell_v, 4, out), Status::Ok);
        let after = a.series_out;
        let pack = before.as_mut_ptr();
        assert_eq!(voltstep_series_step(e, pack, series_sample, cell_v, 4, out), Status::Ok);
        assert_eq!(after, a.series_out);
    }
}

/// What a step that is refused leaves as it was.
#[test]
fn inputs_that_are_none_are_refused() {
    let mut all = all();
    let a = &mut *all;
    let e = &raw const *a.e;
    let (filter, filter_out) = (&raw mut a.filter, &raw mut a.filter_out);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        assert_eq!(voltstep_filter_step(e, filter, &raw const a.sample, filter_out), Status::Ok);
        let before = *filter_out;
        for bad in [f32::NAN, 1e30] {
            a.sample.voltage_v = bad;
            let status = voltstep_filter_step(e, filter, &raw const a.sample, filter_out);
            let out = *filter_out;
            assert!(status == Status::InputRejected && out.rejected, "{out:?}");
            assert!(out.estimate.soc_sd >= before.estimate.soc_sd);
        }
        let (estimate, out) = (&raw const a.estimate, &raw mut a.resistance_out);
        let resistance = &raw mut a.resistance;
        let status = voltstep_resistance_step(e, resistance, f32::NAN, 1.0, estimate, out);
        assert!(status == Status::InputRejected && (*out).rejected && (*out).factor == 1.0);
        a.pair.duration_s = -1.0;
        let (pair, out) = (&raw const a.pair, &raw mut a.capacity_out);
        let status = voltstep_capacity_step(e, &raw mut a.capacity, pair, out);
        assert!(status == Status::InputRejected && (*out).rejected);
        let energy = &raw mut a.energy;
        assert_eq!(voltstep_energy_step(e, energy, f32::NAN, 3.7), Status::InputRejected);
        a.estimate.soc = f32::NAN;
        let (health, report) = (&raw const a.health, &raw mut a.report);
        let status = voltstep_energy_report(e, energy, &raw const a.estimate, health, report);
        assert_eq!((status, a.report.remaining_energy_wh), (Status::InputRejected, 0.0));
        // Without an estimate nothing is allowed.
        let limits = a.limits.as_mut_ptr();
        assert_eq!(voltstep_power_ahead(e, &raw const a.estimate, health, limits), Status::Ok);
        let allowed = a.limits[0].discharge;
        assert_eq!((allowed.current_a, allowed.bound_by), (0.0, VoltstepBoundBy::Unknown as u32));
    }
}

#[test]
fn starts_name_what_is_out_of_range() {
    let mut all = all();
    let a = &mut *all;
    let e = &raw const *a.e;
    let (filter, counter) = (&raw mut a.filter, &raw mut a.counter);
    let (pack, words, record) = (a.pack.as_mut_ptr(), a.pack.len() as u32, &raw const a.record);
    // SAFETY: every pointer comes from a reference, null says that there is no record.
    unsafe {
        for (status, wanted) in [
            (voltstep_filter_start(e, filter, 1.1, 0.1, 25.0), Status::Soc),
            (voltstep_filter_start(e, filter, 0.5, f32::NAN, 25.0), Status::SocSd),
            (voltstep_filter_start(e, filter, 0.5, 0.1, 300.0), Status::TemperatureC),
            (voltstep_filter_start_unknown(e, filter, f32::NAN), Status::TemperatureC),
            (voltstep_filter_start_rested(e, filter, f32::NAN, 25.0), Status::VoltageV),
            (voltstep_filter_resume(e, filter, record, 0.0, 300.0), Status::TemperatureC),
            (voltstep_counter_start(e, counter, -0.1, 0.1), Status::Soc),
            (voltstep_counter_start(e, counter, 0.1, 2.0), Status::SocSd),
            (voltstep_series_start(e, pack, words, 4, record, 0.0, -200.0), Status::TemperatureC),
            (voltstep_series_start(e, pack, words, 4, null(), 0.0, -200.0), Status::TemperatureC),
            (voltstep_series_start(e, pack, words, 5, record, 0.0, 25.0), Status::CellCount),
            (
                voltstep_series_start(e, pack, words - 1, 4, record, 0.0, 25.0),
                Status::MemoryTooSmall,
            ),
            (voltstep_series_start(e, pack, words, 96, record, 0.0, 25.0), Status::MemoryTooSmall),
        ] {
            assert_eq!(status, wanted);
        }
        let bad = VoltstepRecord { capacity_ah: f32::NAN, ..*record };
        for status in [
            voltstep_filter_resume(e, filter, &raw const bad, 0.0, 25.0),
            voltstep_counter_resume(e, counter, &raw const bad, 0.0),
            voltstep_series_start(e, pack, words, 4, &raw const bad, 0.0, 25.0),
        ] {
            assert_eq!(status, Status::RecordCapacityAh);
        }
        // The memory is as it was: four cells.
        let (sample, cell_v) = (&raw const a.series_sample, a.cell_v.as_ptr());
        let out = &raw mut a.series_out;
        assert_eq!(voltstep_series_step(e, pack, sample, cell_v, 4, out), Status::Ok);
        assert_eq!(voltstep_series_step(e, pack, sample, cell_v, 3, out), Status::CellCount);
        assert_eq!(voltstep_series_cell(pack, 4, &raw mut a.cell), Status::CellIndex);
    }
}

#[test]
fn what_was_not_initialised_was_moved_or_overlaps_is_refused() {
    let mut all = all();
    let a = &mut *all;
    let e = &raw const *a.e;
    // SAFETY: every pointer comes from a reference; what is in an object is checked before use.
    unsafe {
        let nothing = blank();
        let mut copy = blank();
        copy.opaque = a.e.opaque;
        for (e, wanted) in [
            (&raw const *nothing, Status::EstimatorsNotInitialised),
            (&raw const *copy, Status::EstimatorsMoved),
        ] {
            assert_eq!(voltstep_counter_step(e, &raw mut a.counter, 1.0), wanted);
            assert_eq!(voltstep_filter_start_unknown(e, &raw mut a.filter, 25.0), wanted);
            assert_eq!(voltstep_health_unlearnt(e, &raw mut a.health), wanted);
            let (pack, limits) = (a.pack.as_mut_ptr(), a.limits.as_mut_ptr());
            assert_eq!(voltstep_series_power(e, pack, limits), wanted);
        }
        // Initialised where it lies, a copy is as good as any other.
        let params = preset();
        let copy_at = &raw mut *copy;
        assert_eq!(voltstep_estimators_init(copy_at, &raw const params, DT_S), Status::Ok);
        assert_eq!(voltstep_counter_step(copy_at, &raw mut a.counter, 1.0), Status::Ok);

        // A state of another kind is none.
        let wrong = (&raw mut a.counter).cast::<VoltstepEnergyState>();
        assert_eq!(voltstep_energy_step(e, wrong, 1.0, 3.7), Status::StateNotInitialised);
        let mut fresh = words(4);
        let fresh = fresh.as_mut_ptr();
        let cell = &raw mut a.cell;
        assert_eq!(voltstep_series_cell(fresh, 0, cell), Status::StateNotInitialised);
        // Nor is one with another mark, or of a number of cells that there is not.
        let pack = a.pack.as_mut_ptr();
        for (place, word) in [(0, 0), (1, 5)] {
            let head = pack.cast::<u32>().add(place);
            let was = head.replace(word);
            assert_eq!(voltstep_series_cell(pack, 0, cell), Status::StateNotInitialised);
            head.write(was);
            assert_eq!(voltstep_series_cell(pack, 0, cell), Status::Ok);
        }

        // A state within the estimators.
        let within = e.cast_mut().wrapping_byte_add(64);
        let energy = within.cast::<VoltstepEnergyState>();
        assert_eq!(voltstep_energy_start(e, energy), Status::Overlap);
        assert_eq!(voltstep_energy_step(e, energy, 1.0, 3.7), Status::Overlap);
        let started = voltstep_series_start(e, within.cast(), 4096, 4, null(), 0.0, 25.0);
        assert_eq!(started, Status::Overlap);
    }
}

#[test]
fn refused_parameters_leave_the_estimators_as_they_were() {
    let mut all = all();
    let a = &mut *all;
    let e = &raw mut *a.e;
    a.params.energy.empty_soc = 2.0;
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let refused = voltstep_estimators_init(e, &raw const a.params, DT_S);
        assert_eq!(refused, Status::EnergyEmptySoc);
        assert_eq!(voltstep_counter_step(e, &raw mut a.counter, 1.0), Status::Ok);
    }
}
