//! The battery as its management sees it: the plant is the pack, sensors are noisy and coarse,
//! estimators work on what they show.

use plant_core::ParamError;
use plant_core::battery::MappedBatteryParams;
use plant_core::powertrain::PowertrainOutput;
use plant_core::signal::sensors::{
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use plant_core::{Dt, must};
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams, CoulombState};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams, EkfState, Uncertainty};

use crate::DT;

/// Control steps in a sample of the filter.
const STEPS_PER_SAMPLE: u32 = 100;
#[allow(clippy::cast_precision_loss, reason = "a hundred")]
const SAMPLE: Dt = must!(Dt::from_s(DT.s() * STEPS_PER_SAMPLE as f32));
/// Control steps between two reviews of the counter.
const STEPS_PER_REVIEW: u32 = 1000;
/// The pack's temperature \[°C\].
const TEMPERATURE_C: f32 = 25.0;
/// How wrong the state of charge is that the estimators are told at the start, and how wrong they
/// are told that it is.
const WRONG: f32 = 0.1;

/// 12 bits over ±500 A, 0.3 A off.
const AMMETER: CurrentSensor = must!(CurrentSensor::new(SensorParams {
    offset: 0.3,
    quantum: 1000.0 / 4096.0,
    ..SensorParams::IDEAL
}));
/// 12 bits over 800 V.
const VOLTMETER: VoltageSensor =
    must!(VoltageSensor::new(SensorParams { quantum: 800.0 / 4096.0, ..SensorParams::IDEAL }));
/// Largest noise before the sensors \[A\], \[V\].
const NOISE_A: f32 = 0.5;
const NOISE_V: f32 = 0.5;

/// The estimators of a battery.
#[derive(Clone, Copy, Debug)]
pub struct Monitor {
    /// Kalman filter, at 10 Hz.
    pub ekf: Ekf,
    /// Counts at the rate of the control loop.
    pub counter: CoulombCounter,
}

/// What they remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonitorState {
    /// The filter.
    pub ekf: EkfState,
    /// The counter.
    pub counter: CoulombState,
    sum_a: f32,
    noise: u32,
}

impl Monitor {
    /// Estimators for a battery.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(battery: MappedBatteryParams, nominal_v: f32) -> Result<Self, ParamError> {
        let known = Uncertainty::typical(nominal_v, battery.capacity_ah);
        let params = EkfParams::typical(battery, nominal_v);
        let ekf = match Ekf::new(params, SAMPLE) {
            Ok(ekf) => ekf,
            Err(error) => return Err(error),
        };
        let counter = CoulombParams {
            capacity_ah: battery.capacity_ah,
            capacity_sd_ah: known.capacity_sd * battery.capacity_ah,
            charge_efficiency: 1.0,
            offset_sd_a: known.current_offset_sd_a,
            gain_sd: 0.005,
            largest_current_a: 1000.0,
            open_circuit: battery.open_circuit,
            rest_voltage_sd_v: known.open_circuit_sd_v,
            rest_current_a: 1.0,
            rest_s: 1800.0,
        };
        match CoulombCounter::new(counter, DT) {
            Ok(counter) => Ok(Self { ekf, counter }),
            Err(error) => Err(error),
        }
    }

    /// Told a state of charge that is wrong.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] where that is none.
    pub fn start(&self, soc: f32) -> Result<MonitorState, ParamError> {
        let told = soc - WRONG;
        Ok(MonitorState {
            ekf: self.ekf.start(told, WRONG, TEMPERATURE_C)?,
            counter: CoulombState::known(told, WRONG),
            sum_a: 0.0,
            noise: 1,
        })
    }

    /// What the battery did in control step `step`, seen by the sensors.
    #[inline]
    pub fn step<O>(&self, state: &mut MonitorState, step: u32, pack: &PowertrainOutput<O>) {
        let noise_a = NOISE_A * state.draw();
        let measured_a = AMMETER
            .step(&mut (), CurrentSensorInput { current_a: pack.battery_a + noise_a })
            .current_a;
        self.counter.step(&mut state.counter, CoulombInput { current_a: measured_a });
        state.sum_a += measured_a;
        if step % STEPS_PER_SAMPLE == STEPS_PER_SAMPLE - 1 {
            let noise_v = NOISE_V * state.draw();
            let voltage_v = VOLTMETER
                .step(&mut (), VoltageSensorInput { voltage_v: pack.battery_v + noise_v })
                .voltage_v;
            #[allow(clippy::cast_precision_loss, reason = "a hundred")]
            let current_a = state.sum_a / STEPS_PER_SAMPLE as f32;
            state.sum_a = 0.0;
            let input = EkfInput {
                current_a,
                voltage_v,
                temperature_c: TEMPERATURE_C,
                contactors_open: false,
            };
            self.ekf.step(&mut state.ekf, input);
            if step % STEPS_PER_REVIEW == STEPS_PER_REVIEW - 1 {
                self.counter.review(&mut state.counter, voltage_v);
            }
        }
    }
}

impl MonitorState {
    /// The next of a sequence that looks random, in −1..1: xorshift (Marsaglia2003).
    fn draw(&mut self) -> f32 {
        self.noise ^= self.noise << 13;
        self.noise ^= self.noise >> 17;
        self.noise ^= self.noise << 5;
        #[allow(clippy::cast_precision_loss, reason = "24 bits")]
        let unit = (self.noise >> 8) as f32 / 8_388_608.0;
        unit - 1.0
    }
}
