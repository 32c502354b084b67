//! What is not built in is refused by name, and the rest works: `cargo xtask capi` runs it so.
#![cfg(not(any(feature = "drives", feature = "pmsm", feature = "thermal")))]

use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod vehicle;
use vehicle::{inputs, plant, preset, refusal, state, step};

#[test]
fn one_dc_drive_steps_and_others_are_refused() {
    let car = preset(VoltstepPreset::BmwI3Constant);
    let plant = plant(&car);
    let mut state = state(&plant, 0.8);
    let (status, first) = step(&plant, &mut state, &inputs(1.0));
    assert_eq!((status, first.rejected), (Status::Ok, false));
    assert_eq!(first.drives[1].motor_a, 0.0);

    for number in
        [VoltstepPreset::BmwI3Pmsm, VoltstepPreset::TwoAxles, VoltstepPreset::BmwI3Thermal]
    {
        let mut params = car;
        // SAFETY: the pointer comes from a reference.
        let status = unsafe { voltstep_params_preset(number as u32, &raw mut params) };
        assert_eq!((status, params), (Status::NotBuiltIn, car));
    }
    let mut other = car;
    other.drives[0].machine = VoltstepMachine::Pmsm as u32;
    assert_eq!(refusal(&other), Status::NotBuiltIn);
    let mut other = car;
    other.drives[0].thermal.heated = 1;
    assert_eq!(refusal(&other), Status::NotBuiltIn);
    for count in 2..=4 {
        let mut other = car;
        (other.drive_count, other.drives) = (count, [car.drives[0]; VOLTSTEP_DRIVES]);
        assert_eq!(refusal(&other), Status::NotBuiltIn);
    }
    let mut other = car;
    other.drive_count = 5;
    assert_eq!(refusal(&other), Status::DriveCount);
}
