//! State of charge by the filter.

use voltstep_bms::estimate::ekf::EkfInput;

use super::handle::{VoltstepEstimators, VoltstepFilterState, models, start};
use super::record::{VoltstepRecord, elapsed};
use super::values::{VoltstepEstimate, VoltstepHealth};
use crate::handle::{answer, check_apart, check_optional, exclusive, read_from, shared, write_to};
use crate::status::VoltstepStatus;

/// One sample of the filter; NaN where there is no usable reading.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepFilterInput {
    /// Current in A, positive when discharging.
    pub current_a: f32,
    /// Voltage at the terminals in V.
    pub voltage_v: f32,
    /// Temperature in degC. A missing one is the last one.
    pub temperature_c: f32,
    /// Other than 0: the contactors are open, no current flows, what the sensor shows is its offset.
    pub contactors_open: u32,
}

impl From<VoltstepFilterInput> for EkfInput {
    fn from(input: VoltstepFilterInput) -> Self {
        Self {
            current_a: input.current_a,
            voltage_v: input.voltage_v,
            temperature_c: input.temperature_c,
            contactors_open: input.contactors_open != 0,
        }
    }
}

/// What the filter believes after a sample, and what to think of it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepFilterOutputs {
    /// What is believed.
    pub estimate: VoltstepEstimate,
    /// Measured voltage less the expected one, in V; 0 without a sample.
    pub residual_v: f32,
    /// The standard deviation is below the `converged_sd` of the parameters.
    pub converged: bool,
    /// The model's error, and the mean residual beside it, are of the size that is expected.
    pub consistent: bool,
    /// The open-circuit curve is flat here: the voltage does not correct.
    pub flat: bool,
    /// State of charge or temperature lie outside the identified range.
    pub outside_identified: bool,
    /// The temperature is not known; the last one holds.
    pub temperature_missing: bool,
    /// Current or voltage was missing or absurd: the estimate is held, its uncertainty grows.
    pub rejected: bool,
}

/// Starts the filter from a state of charge that is known from elsewhere, and its standard deviation
/// (ratios 0..1), at a temperature in degC (-100..200). The battery need not be rested.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_start(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    soc: f32,
    soc_sd: f32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let made = m.series.filter.start(soc, soc_sd, temperature_c);
            start(estimators, state, made.map_err(Into::into))
        })
    })
}

/// Starts the filter with nothing known of the state of charge, at a temperature in degC
/// (-100..200).
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_start_unknown(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let made = m.series.filter.start_unknown(temperature_c);
            start(estimators, state, made.map_err(Into::into))
        })
    })
}

/// Starts the filter from the voltage of a rested battery in V, at a temperature in degC
/// (-100..200).
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_start_rested(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    voltage_v: f32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let made = m.series.filter.start_rested(voltage_v, temperature_c);
            start(estimators, state, made.map_err(Into::into))
        })
    })
}

/// Starts the filter from a record that is `elapsed_s` seconds old (NaN: nobody knows), at a
/// temperature in degC (-100..200). It takes over the health.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_resume(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    record: *const VoltstepRecord,
    elapsed_s: f32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let (memory, health) = read_from(record)?.remembered()?;
            let filter = &m.series.filter;
            let mut made = filter.resume(memory, elapsed(elapsed_s), temperature_c)?;
            filter.adopt(&mut made, &health);
            start(estimators, state, Ok(made))
        })
    })
}

/// One sample. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that current or voltage
/// was missing or absurd: the estimate is held, its uncertainty grows, the outputs are written all
/// the same. Any other error leaves everything as it was.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `input` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_step(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    input: *const VoltstepFilterInput,
    outputs: *mut VoltstepFilterOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs)?;
            check_apart(estimators, state)?;
            let input = read_from(input)?;
            let state = &mut exclusive(state)?.value;
            let filter = &m.series.filter;
            let out = filter.step(state, input.into());
            if !outputs.is_null() {
                let status = filter.status(state);
                let said = VoltstepFilterOutputs {
                    estimate: filter.estimate(state).into(),
                    residual_v: out.residual_v,
                    converged: status.converged,
                    consistent: status.consistent,
                    flat: status.flat,
                    outside_identified: status.outside_identified,
                    temperature_missing: status.temperature_missing,
                    rejected: out.rejected,
                };
                write_to(outputs, said)?;
            }
            if out.rejected { Err(VoltstepStatus::InputRejected) } else { Ok(()) }
        })
    })
}

/// The filter takes over what was learnt of the health, where it is known better than was declared.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `health` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_adopt(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepFilterState,
    health: *const VoltstepHealth,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_apart(estimators, state)?;
            let health = read_from(health)?.into();
            m.series.filter.adopt(&mut exclusive(state)?.value, &health);
            Ok(())
        })
    })
}

/// Fills `record` with what is worth keeping of the filter and the health; throughput, time and what
/// follows are left at 0.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `health` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_filter_record(
    estimators: *const VoltstepEstimators,
    state: *const VoltstepFilterState,
    health: *const VoltstepHealth,
    record: *mut VoltstepRecord,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let health = read_from(health)?;
            let memory = m.series.filter.remember(&shared(state)?.value);
            write_to(record, VoltstepRecord::of(memory, health.into()))
        })
    })
}
