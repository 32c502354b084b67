//! State of health of a faded cell after ten days of driving and charging.

#![allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, clippy::cast_sign_loss)]

use plant_core::battery::{MappedBattery, MappedBatteryParams, OverSoc};
use plant_core::num::SocTable;
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::signal::sensors::{
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use voltstep_bms::estimate::soh::{
    CapacityEstimator, CapacityInput, CapacityOutput, CapacityParams, ResistanceEstimator,
    ResistanceInput, ResistanceOutput, ResistanceParams,
};
use voltstep_bms::{Dt, Estimate};

/// The capacity's error that is allowed, as a share of it.
const CAPACITY: f32 = 0.02;
/// The resistance's.
const RESISTANCE: f32 = 0.10;

/// What became of the cell.
const CAPACITY_LEFT: f32 = 0.85;
const RESISTANCE_NOW: f32 = 1.4;

const CYCLES: u32 = 10;
const DT_S: f32 = 1.0;
const REST_S: u32 = 2700;
const VOLTAGE_NOISE_V: f32 = 0.001;
const VOLTAGE_QUANTUM_V: f32 = 0.001;
const CURRENT_NOISE_A: f32 = 0.01;
const CURRENT_QUANTUM_A: f32 = 0.01;

fn larger(over_soc: OverSoc, factor: f32) -> OverSoc {
    match over_soc {
        OverSoc::Constant(ohm) => OverSoc::Constant(factor * ohm),
        OverSoc::Table(table) => {
            OverSoc::Table(SocTable::new("r", table.values().map(|ohm| factor * ohm)).unwrap())
        }
    }
}

fn faded() -> MappedBatteryParams {
    let mut params = PANASONIC_NCR18650PF;
    params.capacity_ah *= CAPACITY_LEFT;
    for resistance in [
        &mut params.series.resistance_ohm,
        &mut params.polarisation.resistance_ohm,
        &mut params.second_polarisation.resistance_ohm,
    ] {
        *resistance = larger(*resistance, RESISTANCE_NOW);
    }
    params
}

/// Even and normal numbers, the same for the same seed.
struct Dice(u32);

impl Dice {
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 16_777_216.0
    }

    fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.roll()).sum::<f32>() - 6.0
    }
}

/// How the current sensor lies.
#[derive(Clone, Copy, Default)]
struct Lie {
    offset_a: f32,
    gain: f32,
}

struct Bench {
    plant: MappedBattery,
    state: plant_core::battery::MappedBatteryState,
    known: MappedBattery,
    voltage: VoltageSensor,
    current: CurrentSensor,
    dice: Dice,
    /// Since the last rest.
    counted_ah: f64,
    seconds: f32,
}

impl Bench {
    fn new(seed: u32, lie: Lie, start_soc: f32) -> Self {
        let dt = Dt::from_s(DT_S).unwrap();
        let plant = MappedBattery::new(faded(), dt).unwrap();
        let sensor = |gain, offset, quantum| SensorParams { gain, offset, quantum };
        Self {
            state: plant.rested_at(start_soc, 25.0).unwrap(),
            plant,
            known: MappedBattery::new(PANASONIC_NCR18650PF, dt).unwrap(),
            voltage: VoltageSensor::new(sensor(1.0, 0.0, VOLTAGE_QUANTUM_V)).unwrap(),
            current: CurrentSensor::new(sensor(1.0 + lie.gain, lie.offset_a, CURRENT_QUANTUM_A))
                .unwrap(),
            dice: Dice(seed),
            counted_ah: 0.0,
            seconds: 0.0,
        }
    }

    /// One second: the readings.
    fn step(&mut self, current_a: f32) -> (f32, f32) {
        let (source, _) = self.plant.offer(&self.state);
        let voltage_v = source.voltage_v(current_a) + VOLTAGE_NOISE_V * self.dice.normal();
        let noisy_a = current_a + CURRENT_NOISE_A * self.dice.normal();
        self.plant.settle(&mut self.state, current_a);
        self.plant.refresh(&mut self.state);
        let read_v = self.voltage.step(&mut (), VoltageSensorInput { voltage_v }).voltage_v;
        let read_a =
            self.current.step(&mut (), CurrentSensorInput { current_a: noisy_a }).current_a;
        self.counted_ah += f64::from(read_a * DT_S / 3600.0);
        self.seconds += DT_S;
        (read_v, read_a)
    }

    /// What the open-circuit curve says after a rest: not quite all of the voltage has settled.
    fn read_at_rest(&mut self) -> Estimate {
        let mut sum = 0.0;
        for _ in 0..REST_S {
            sum = self.step(0.0).0;
        }
        for _ in 1..10 {
            sum += self.step(0.0).0;
        }
        let curve = self.known.open_circuit();
        let soc = curve.soc_at(0.1 * sum);
        let (_, slope_v) = curve.with_slope(soc);
        self.estimate(soc, 0.002 / slope_v)
    }

    fn estimate(&self, soc: f32, soc_sd: f32) -> Estimate {
        Estimate::rested(soc, soc_sd, self.state.temperature_c.get())
    }
}

/// Ten days; what is known at the end of each.
fn live(seed: u32, lie: Lie) -> Vec<(CapacityOutput, ResistanceOutput)> {
    let dt = Dt::from_s(DT_S).unwrap();
    let nominal_ah = PANASONIC_NCR18650PF.capacity_ah;
    let capacity = CapacityEstimator::new(
        CapacityParams {
            nominal_ah,
            nominal_sd_ah: 0.2 * nominal_ah,
            current_noise_sd_a: CURRENT_NOISE_A,
            current_offset_sd_a: 0.005,
            current_gain_sd: 0.003,
            least_soc_change: 0.2,
            least_soc_change_sds: 10.0,
            memory_pairs: 50.0,
        },
        dt,
    )
    .unwrap();
    let mut bench = Bench::new(seed, lie, 0.9);
    let known = bench.known;
    let resistance = ResistanceEstimator::new(
        ResistanceParams {
            voltage_sd_v: 0.0011,
            current_sd_a: 0.0105,
            least_step_a: 0.5,
            memory_steps: 2000.0,
            initial_sd: 0.5,
            skew_s: 0.0,
        },
        &known,
        dt,
    )
    .unwrap();
    let (mut capacity_state, mut resistance_state) = (capacity.unknown(), resistance.unknown());
    let mut days = Vec::new();
    let mut before = bench.read_at_rest();
    for _ in 0..CYCLES {
        let mut said = (None, None);
        for driving in [true, false] {
            (bench.counted_ah, bench.seconds) = (0.0, 0.0);
            let mut drive_a = 0.0;
            // The state of charge that a filter with the wrong capacity would follow.
            let mut soc = before.soc;
            while if driving { bench.state.soc.get() > 0.25 } else { bench.state.soc.get() < 0.9 } {
                if bench.dice.roll() < 0.3 {
                    drive_a = 2.0 + 2.5 * bench.dice.normal();
                }
                let current_a = if driving { drive_a.clamp(-3.0, 9.0) } else { -1.0 };
                let (voltage_v, current_a) = bench.step(current_a);
                soc -= current_a * DT_S / (3600.0 * nominal_ah);
                let estimate = bench.estimate(soc + 0.02, 0.02);
                let input = ResistanceInput { voltage_v, current_a, estimate };
                said.1 = Some(resistance.step(&mut resistance_state, input));
            }
            let now = bench.read_at_rest();
            let input = CapacityInput {
                start: before,
                end: now,
                discharged_ah: bench.counted_ah as f32,
                duration_s: bench.seconds,
            };
            said.0 = Some(capacity.step(&mut capacity_state, input));
            before = now;
        }
        days.push((said.0.unwrap(), said.1.unwrap()));
    }
    days
}

fn check(seeds: u32, lie: Lie) {
    let truth_ah = CAPACITY_LEFT * PANASONIC_NCR18650PF.capacity_ah;
    for seed in 0..seeds {
        let days = live(seed, lie);
        let (capacity, resistance) = *days.last().unwrap();
        let off = capacity.capacity_ah / truth_ah - 1.0;
        let factor_off = resistance.factor / RESISTANCE_NOW - 1.0;
        let named = format!("{off:+.4} {factor_off:+.4} {capacity:?} {resistance:?}");
        println!("{named}");
        assert!(off.abs() <= CAPACITY && factor_off.abs() <= RESISTANCE, "{named}");
        assert!(
            (capacity.capacity_ah - truth_ah).abs() <= 3.0 * capacity.capacity_sd_ah,
            "{named}"
        );
        // It learns from the first day on, and ever surer.
        assert!(days[0].0.capacity_sd_ah > capacity.capacity_sd_ah && days[0].1.factor_sd < 0.1);
    }
}

#[test]
fn finds_what_a_faded_cell_has_lost() {
    check(5, Lie::default());
}

#[test]
fn a_current_sensor_within_its_limits_does_not_mislead_it() {
    for (offset_a, gain) in [(0.005, 0.0), (-0.005, 0.0), (0.0, 0.003), (0.0, -0.003)] {
        check(2, Lie { offset_a, gain });
    }
}
