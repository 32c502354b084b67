//! Memory as C would have it, and good values to start from.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::mem::MaybeUninit;

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

pub mod all;

pub const DT_S: f32 = 0.1;

/// What a call writes.
///
/// # Safety
/// The call writes all of it where it answers `Ok`; else the value is not used.
pub unsafe fn get<T>(call: impl FnOnce(*mut T) -> Status) -> T {
    let mut value = MaybeUninit::zeroed();
    assert_eq!(call(value.as_mut_ptr()), Status::Ok);
    // SAFETY: as promised by the caller.
    unsafe { value.assume_init() }
}

/// The parameters of the preset.
pub fn preset() -> VoltstepEstimatorParams {
    let number = VoltstepCellPreset::PanasonicNcr18650Pf as u32;
    // SAFETY: the pointer is to memory of its type.
    unsafe { get(|params| voltstep_estimator_params_preset(number, params)) }
}

/// Memory that nothing was written to.
pub fn blank() -> Box<VoltstepEstimators> {
    Box::new(VoltstepEstimators { opaque: [MaybeUninit::zeroed(); VOLTSTEP_ESTIMATORS_WORDS] })
}

/// The estimators of the preset, which stay where they are.
pub fn set_up() -> Box<VoltstepEstimators> {
    let mut estimators = blank();
    let params = preset();
    // SAFETY: both are references.
    let status = unsafe { voltstep_estimators_init(&raw mut *estimators, &raw const params, DT_S) };
    assert_eq!(status, Status::Ok);
    estimators
}

/// Memory for so many cells in series.
pub fn words(cells: usize) -> Vec<MaybeUninit<u64>> {
    vec![MaybeUninit::zeroed(); VOLTSTEP_SERIES_WORDS + cells * VOLTSTEP_SERIES_WORDS_PER_CELL]
}

/// A good record.
pub fn known() -> VoltstepRecord {
    VoltstepRecord {
        soc: 0.75,
        soc_sd: 0.02,
        capacity_ah: 2.7,
        capacity_sd_ah: 0.03,
        resistance_factor: 1.2,
        resistance_factor_sd: 0.05,
        current_offset_a: 0.01,
        current_offset_sd_a: 0.02,
        throughput_ah: 900.0,
        timed: 1,
        written_at_s: 77,
        polarised: 0,
        polarisation_v: [0.0; 2],
        load_a: 0.0,
        hysteresis: 0.0,
        resistor_heat_j: 3.0,
        lock_out_cause: 5,
        log_sequence: 42,
    }
}
