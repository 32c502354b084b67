//! State of charge by counting.

use plant_core::error::ratio;
use voltstep_bms::estimate::coulomb::{CoulombInput, CoulombState};

use super::handle::{VoltstepCounterState, VoltstepEstimators, models, start};
use super::record::{VoltstepRecord, elapsed};
use crate::handle::{answer, check_apart, check_optional, exclusive, read_from, write_optional};
use crate::status::VoltstepStatus;

/// What the coulomb counter says.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCounterOutputs {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio.
    pub soc_sd: f32,
    /// A reading was missing or too large since the last review: the uncertainty grew.
    pub current_missing: bool,
    /// The count was put right from the voltage at rest.
    pub anchored: bool,
    /// At rest, but the voltage lies so far outside the curve that it was not used.
    pub voltage_implausible: bool,
}

/// Starts the counter from a state of charge and its standard deviation (ratios 0..1).
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_counter_start(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCounterState,
    soc: f32,
    soc_sd: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|_| {
            let (soc, soc_sd) = (ratio("soc", soc)?, ratio("soc_sd", soc_sd)?);
            start(estimators, state, Ok(CoulombState::known(soc, soc_sd)))
        })
    })
}

/// Starts the counter from the voltage of a rested battery in V; where it says nothing, with nothing
/// known.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_counter_start_rested(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCounterState,
    voltage_v: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators)
            .and_then(|m| start(estimators, state, Ok(m.series.counter.rested(voltage_v))))
    })
}

/// Starts the counter from a record that is `elapsed_s` seconds old (NaN: nobody knows). It takes
/// over the health.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_counter_resume(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCounterState,
    record: *const VoltstepRecord,
    elapsed_s: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let (memory, health) = read_from(record)?.remembered()?;
            let counter = &m.series.counter;
            let mut made = CoulombState::known(memory.soc, memory.soc_sd);
            counter.adopt(&mut made, &health);
            let standby_sd_a = m.series.filter.params().uncertainty.standby_sd_a;
            counter.pause(&mut made, elapsed(elapsed_s), standby_sd_a);
            start(estimators, state, Ok(made))
        })
    })
}

/// Counts one sample of the current in A, positive when discharging; NaN where there is no usable
/// reading.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_counter_step(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCounterState,
    current_a: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_apart(estimators, state)?;
            m.series.counter.step(&mut exclusive(state)?.value, CoulombInput { current_a });
            Ok(())
        })
    })
}

/// Takes stock, about once a second: puts the count right where the battery has rested and
/// `voltage_v` (in V; NaN where there is no usable reading) knows better. `outputs` may be null.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_counter_review(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCounterState,
    voltage_v: f32,
    outputs: *mut VoltstepCounterOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs)?;
            check_apart(estimators, state)?;
            let out = m.series.counter.review(&mut exclusive(state)?.value, voltage_v);
            let said = VoltstepCounterOutputs {
                soc: out.soc,
                soc_sd: out.soc_sd,
                current_missing: out.current_missing,
                anchored: out.anchored,
                voltage_implausible: out.voltage_implausible,
            };
            write_optional(outputs, said)
        })
    })
}
