#![no_std]
#![no_main]
//! A battery model as a virtual sensor: it is fed the measured current, gives the state of charge
//! by integration and the voltage that the pack should show. The residual, measured less
//! expected, says how well model and pack agree.
//!
//! The measurement is made here: a pack whose series resistance is 20 % above the model's and
//! whose cells started 2 % fuller, under a pulsed load, read with the resolution of an ADC.

// For its critical section.
use cortex_m as _;
use cortex_m_rt::entry;
use defmt_semihosting as _;
use panic_halt as _;
use plant_core::battery::{Battery, BatteryInput, BatteryParams, BatteryState};
use plant_core::presets::BMW_I3_60AH_CONSTANT;
use plant_core::signal::sensors::{
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use plant_core::{Dt, must};
use semihosting::process::ExitCode;

const DT: Dt = must!(Dt::from_s(0.01));
const STEPS_PER_S: u32 = 100;
const MODEL_PARAMS: BatteryParams = BMW_I3_60AH_CONSTANT.powertrain.battery;
const MODEL: Battery = must!(Battery::new(MODEL_PARAMS, DT));

/// The pack itself.
const PACK: Battery = must!(Battery::new(
    BatteryParams {
        series_resistance_ohm: 1.2 * MODEL_PARAMS.series_resistance_ohm,
        ..MODEL_PARAMS
    },
    DT
));
const PACK_SOC: f32 = 0.82;
const MODEL_SOC: f32 = 0.80;

/// 12 bits over 500 V and over ±500 A.
const VOLTMETER: VoltageSensor =
    must!(VoltageSensor::new(SensorParams { quantum: 500.0 / 4096.0, ..SensorParams::IDEAL }));
const AMMETER: CurrentSensor =
    must!(CurrentSensor::new(SensorParams { quantum: 1000.0 / 4096.0, ..SensorParams::IDEAL }));

/// The load \[A\], each for ten seconds, over and over: rest, cruise, accelerate, brake.
const LOAD_A: [f32; 4] = [0.0, 40.0, 120.0, -60.0];
const HOLD_S: u32 = 10;
const END_S: u32 = 600;

#[entry]
fn main() -> ! {
    let (Ok(mut pack), Ok(mut model)) =
        (BatteryState::rested(PACK_SOC), BatteryState::rested(MODEL_SOC))
    else {
        defmt::error!("a state of charge is no ratio");
        ExitCode::FAILURE.exit_process();
    };
    let mut squares = 0.0;
    for (second, true_a) in (0..END_S).zip(LOAD_A.into_iter().flat_map(hold).cycle()) {
        let mut residual_v = 0.0;
        for _ in 0..STEPS_PER_S {
            // What the board would read from its converters.
            let truth = PACK.step(&mut pack, BatteryInput { current_a: true_a });
            let measured_v = VOLTMETER
                .step(&mut (), VoltageSensorInput { voltage_v: truth.terminal_v })
                .voltage_v;
            let measured_a =
                AMMETER.step(&mut (), CurrentSensorInput { current_a: true_a }).current_a;

            // The virtual sensor.
            let expected = MODEL.step(&mut model, BatteryInput { current_a: measured_a });
            residual_v = measured_v - expected.terminal_v;
            squares += residual_v * residual_v;
        }
        if second % 60 == 59 {
            defmt::info!(
                "t {=u32} s  current {=f32} A  soc {=f32} (pack {=f32})  residual {=f32} V",
                second + 1,
                true_a,
                model.soc.get(),
                pack.soc.get(),
                residual_v
            );
        }
    }
    #[allow(clippy::cast_precision_loss, reason = "a small number")]
    let mean_square = squares / (END_S * STEPS_PER_S) as f32;
    defmt::info!("residual, rms: {=f32} V", plant_core::num::sqrt(mean_square));
    ExitCode::SUCCESS.exit_process();
}

/// A load for as many seconds as it lasts.
fn hold(load_a: f32) -> impl Iterator<Item = f32> + Clone {
    (0..HOLD_S).map(move |_| load_a)
}
