#![no_std]
#![no_main]
//! The least that steps a plant: a car held at a constant duty for ten seconds.

use cortex_m_rt::entry;
use panic_halt as _;
use plant_core::powertrain::{Powertrain, PowertrainInput};
use plant_core::presets::EPOWERTRAIN_UDDS;
use plant_core::{Dt, must};
use semihosting::process::ExitCode;
use semihosting::{eprintln, println};

/// Checked and discretised by the compiler; the coefficients lie in flash.
const CAR: Powertrain =
    must!(Powertrain::new(EPOWERTRAIN_UDDS.powertrain, must!(Dt::from_s(1e-3))));
const STEPS_PER_S: u32 = 1000;
const END_S: u32 = 10;
const DUTY: f32 = 0.05;

#[entry]
fn main() -> ! {
    let Ok(mut state) = CAR.at_rest(EPOWERTRAIN_UDDS.initial_soc) else {
        eprintln!("the state of charge is no ratio");
        ExitCode::FAILURE.exit_process();
    };
    let input = PowertrainInput::on(DUTY);
    for second in 1..=END_S {
        for _ in 1..STEPS_PER_S {
            CAR.step(&mut state, input);
        }
        let out = CAR.step(&mut state, input);
        println!(
            "t {second} s  speed {:.3} m/s  motor {:.1} A  battery {:.1} V  soc {:.5}",
            out.speed_m_s, out.drives.motor_a, out.battery_v, out.soc
        );
    }
    ExitCode::SUCCESS.exit_process();
}
