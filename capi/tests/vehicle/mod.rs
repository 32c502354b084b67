//! A vehicle as C would have it.
#![allow(dead_code, reason = "each test takes what it needs")]

use std::mem::MaybeUninit;

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

pub const DT_S: f32 = 1e-3;

pub fn preset(preset: VoltstepPreset) -> VoltstepParams {
    let mut params = MaybeUninit::uninit();
    // SAFETY: the pointer is to memory of its type, which is written where the answer is Ok.
    unsafe {
        assert_eq!(voltstep_params_preset(preset as u32, params.as_mut_ptr()), Status::Ok);
        params.assume_init()
    }
}

pub fn plant(params: &VoltstepParams) -> VoltstepPlant {
    let mut plant = VoltstepPlant { opaque: [MaybeUninit::zeroed(); VOLTSTEP_PLANT_WORDS] };
    // SAFETY: both are references.
    assert_eq!(unsafe { voltstep_plant_init(&raw mut plant, params, DT_S) }, Status::Ok);
    plant
}

pub fn state(plant: &VoltstepPlant, soc: f32) -> VoltstepState {
    let mut state = VoltstepState { opaque: [MaybeUninit::zeroed(); VOLTSTEP_STATE_WORDS] };
    // SAFETY: both are references.
    assert_eq!(unsafe { voltstep_state_init(plant, &raw mut state, soc, 0.0) }, Status::Ok);
    state
}

pub fn inputs(reference_m_s: f32) -> VoltstepInputs {
    let mut inputs = MaybeUninit::uninit();
    // SAFETY: the pointer is to memory of its type, which is written.
    let inputs = unsafe {
        assert_eq!(voltstep_inputs_default(inputs.as_mut_ptr()), Status::Ok);
        inputs.assume_init()
    };
    VoltstepInputs { reference_m_s, ..inputs }
}

pub fn step(
    plant: &VoltstepPlant,
    state: &mut VoltstepState,
    inputs: &VoltstepInputs,
) -> (Status, VoltstepOutputs) {
    let mut outputs = MaybeUninit::uninit();
    // SAFETY: all are references, and with these answers the outputs are written.
    unsafe {
        let status = voltstep_step(plant, state, inputs, outputs.as_mut_ptr());
        assert!(matches!(status, Status::Ok | Status::InputRejected), "{status:?}");
        (status, outputs.assume_init())
    }
}

pub fn snapshot(state: &VoltstepState) -> VoltstepSnapshot {
    let mut snapshot = MaybeUninit::uninit();
    // SAFETY: both are references; the snapshot is written where the answer is Ok.
    unsafe {
        assert_eq!(voltstep_state_snapshot(state, snapshot.as_mut_ptr()), Status::Ok);
        snapshot.assume_init()
    }
}

/// What a step answers.
pub fn stepped(
    plant: &VoltstepPlant,
    state: &mut VoltstepState,
    inputs: &VoltstepInputs,
) -> Status {
    // SAFETY: all are references; outputs may be null.
    unsafe { voltstep_step(plant, state, inputs, std::ptr::null_mut()) }
}

/// What these parameters are answered with.
pub fn refusal(params: &VoltstepParams) -> Status {
    let mut plant = VoltstepPlant { opaque: [MaybeUninit::zeroed(); VOLTSTEP_PLANT_WORDS] };
    // SAFETY: both are references.
    unsafe { voltstep_plant_init(&raw mut plant, params, DT_S) }
}
