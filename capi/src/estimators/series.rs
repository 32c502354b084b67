//! The estimators of cells in series, tied together.

use core::mem::MaybeUninit;

use voltstep_bms::estimate::ekf::EkfMemory;
use voltstep_bms::estimate::power::SLICES_OF_CELLS;

use super::handle::{VoltstepEstimators, VoltstepPowerWalk, models};
use super::memory::{begin, opened};
use super::params::VOLTSTEP_HORIZONS;
use super::power::VoltstepEnergyReport;
use super::record::{VoltstepRecord, elapsed};
use super::values::{
    VoltstepPowerAhead, VoltstepSeriesCell, VoltstepSeriesInput, VoltstepSeriesOutputs,
};
use crate::handle::{
    answer, check, check_apart, check_optional, exclusive, read_from, write_optional, write_to,
};
use crate::status::VoltstepStatus;

/// Calls of `voltstep_series_power_walk` until the answer is there.
pub const VOLTSTEP_SERIES_SLICES: usize = 18;
const _: () = assert!(VOLTSTEP_SERIES_SLICES == SLICES_OF_CELLS);

/// Starts the estimators of cells in series, 1, 4, 12, 18 or 96 of them, in `memory`: an array of
/// `words`, at least `VOLTSTEP_SERIES_WORDS + cells * VOLTSTEP_SERIES_WORDS_PER_CELL`, which a copy
/// of it may take the place of. `record` is what was remembered `elapsed_s` seconds ago (NaN: nobody
/// knows); null: nothing is known. At a temperature in degC (-100..200).
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_start(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    words: u32,
    cells: u32,
    record: *const VoltstepRecord,
    elapsed_s: f32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let remembered = if record.is_null() {
                let filter = &m.series.filter;
                let unknown = filter.remember(&filter.start_unknown(temperature_c)?);
                (EkfMemory { polarisation: None, ..unknown }, m.unlearnt)
            } else {
                read_from(record)?.remembered()?
            };
            let ago = if record.is_null() { Some(0.0) } else { elapsed(elapsed_s) };
            begin(cells, estimators, (memory, words), remembered, ago, temperature_c)
        })
    })
}

/// One sample of cells in series: `cell_v` is an array of `cells` voltages in V, as many as at the
/// start; NaN where there is no usable reading. `outputs` may be null. Once a second it takes
/// longer: every cell, the counter's review, what was learnt goes where it is used.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call;
/// `input` and `cell_v` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_step(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    input: *const VoltstepSeriesInput,
    cell_v: *const f32,
    cells: u32,
    outputs: *mut VoltstepSeriesOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs).and(check(cell_v))?;
            let input = read_from(input)?;
            let (state, count) = opened(memory)?;
            if cells != count {
                return Err(VoltstepStatus::CellCount);
            }
            state.step(m, input, core::slice::from_raw_parts(cell_v, cells as usize));
            if outputs.is_null() { Ok(()) } else { write_optional(outputs, state.outputs(m)) }
        })
    })
}

/// What is believed of one of the cells in series, the first of them 0.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_cell(
    memory: *mut MaybeUninit<u64>,
    index: u32,
    cell: *mut VoltstepSeriesCell,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        opened(memory).and_then(|(state, _)| {
            let found = state.cell(index as usize).ok_or(VoltstepStatus::CellIndex)?;
            write_to(cell, found)
        })
    })
}

/// What the cells in series allow, for the limits of one cell: fills `limits`, an array of
/// `VOLTSTEP_HORIZONS`; current as it is, power of one cell. A matter for once a second:
/// `voltstep_series_power_walk` does the same in shorter calls.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_power(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    limits: *mut VoltstepPowerAhead,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check(limits)?;
            write_to(
                limits.cast::<[VoltstepPowerAhead; VOLTSTEP_HORIZONS]>(),
                opened(memory)?.0.power(m).map(Into::into),
            )
        })
    })
}

/// The same in `VOLTSTEP_SERIES_SLICES` calls, from what is believed at each of them. The last one
/// fills `limits`, an array of `VOLTSTEP_HORIZONS`, and sets `done`; the next one begins again.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_power_walk(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    walk: *mut VoltstepPowerWalk,
    limits: *mut VoltstepPowerAhead,
    done: *mut bool,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check(limits).and(check(done))?;
            check_apart(estimators, walk)?;
            let (state, _) = opened(memory)?;
            let found = state.walk(m, &mut exclusive(walk)?.value);
            write_to(done, found.is_some())?;
            match found {
                Some(found) => write_to(limits.cast(), found.map(VoltstepPowerAhead::from)),
                None => Ok(()),
            }
        })
    })
}

/// What is left in the mean of cells in series, in the units of one cell.
/// `VOLTSTEP_STATUS_INPUT_REJECTED` says that the estimate was not finite; the report is not written
/// then.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_energy(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    report: *mut VoltstepEnergyReport,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let found = opened(memory)?.0.energy(m).ok_or(VoltstepStatus::InputRejected)?;
            write_to(report, found)
        })
    })
}

/// Fills `record` with what is worth keeping of cells in series; throughput, time and what follows
/// are left at 0.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_record(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    record: *mut VoltstepRecord,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| write_to(record, opened(memory)?.0.record(m)))
    })
}
