#![no_std]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
//! Voltstep for C: the coupled plant with its drivers, the estimators of a battery, and a whole BMS, as
//! a static library.
//!
//! `include/voltstep.h` is made from these sources by `cargo xtask capi`. This is the only crate
//! of the project with `unsafe` code: C hands over raw pointers. Every function checks them (null,
//! alignment, overlap, whether the object was initialised) before it touches anything, and answers
//! with a [`VoltstepStatus`]. The caller owns all memory; nothing is allocated, and nothing is
//! kept between calls.

// Nothing here needs the standard library; on a PC it brings the panic handler that a static
// library has to have.
#[cfg(not(target_os = "none"))]
extern crate std;

#[cfg(feature = "bms")]
mod bms;
mod cars;
mod convert;
mod estimators;
mod handle;
mod params;
mod refusals;
mod status;
mod step;
mod values;

#[cfg(feature = "bms")]
pub use bms::*;
pub use estimators::*;
pub use handle::{VOLTSTEP_PLANT_WORDS, VOLTSTEP_STATE_WORDS, VoltstepPlant, VoltstepState};
pub use params::{
    VOLTSTEP_ABI, VOLTSTEP_DRIVES, VOLTSTEP_SOC_POINTS, VoltstepAuxiliaryParams,
    VoltstepBatteryModel, VoltstepBatteryParams, VoltstepBodyParams, VoltstepConverterParams,
    VoltstepDriveParams, VoltstepDriverKind, VoltstepGearboxParams, VoltstepMachine,
    VoltstepMotorParams, VoltstepOpenCircuit, VoltstepParams, VoltstepPidParams,
    VoltstepPmsmParams, VoltstepPreset, VoltstepRoadLaw, VoltstepTorqueParams, VoltstepWheelParams,
    VoltstepWindup,
};
pub use refusals::voltstep_error_message;
pub use status::VoltstepStatus;
pub use step::{
    voltstep_inputs_default, voltstep_params_preset, voltstep_plant_init, voltstep_state_init,
    voltstep_state_snapshot, voltstep_step,
};
pub use values::{
    VoltstepDriveOutputs, VoltstepDriveSnapshot, VoltstepInputs, VoltstepLimited, VoltstepOutputs,
    VoltstepSnapshot, VoltstepSum,
};

/// What a static library for a microcontroller has to have. No path leads here: the linked image
/// of the example is searched for panics.
#[cfg(all(target_os = "none", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
