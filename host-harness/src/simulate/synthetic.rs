//! A synthetic trip whose true parameters are known: what an identification should find again.
//!
//! It is the plant of `plant-core` in the i3's preset with other parameters, driven over hills,
//! then seen through sensors as coarse and as noisy as those of a real car's log. The same bytes
//! come out on every machine: no function of the platform's mathematics library is called.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the plant computes in f32; counts are small"
)]

use std::fmt::Write as _;

use plant_core::battery::{BatteryParams, RcBranchParams};
use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::mechanics::body::{BodyParams, RoadResistance};
use plant_core::mechanics::slope::Grade;
use plant_core::num::sin_cos_turns;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainOutput, PowertrainParams};
use plant_core::presets::BMW_I3_60AH_CONSTANT;
use plant_core::signal::sensors::{
    CurrentSensor, CurrentSensorInput, SensorParams, VoltageSensor, VoltageSensorInput,
};
use plant_core::{Dt, must};

use crate::simulate::noise::Noise;

/// Seed of the noise.
pub const SEED: u64 = 20_260_117;
/// State of charge at the start.
pub const INITIAL_SOC: f32 = 0.742;
/// Temperature outside \[°C\].
pub const AMBIENT_C: f32 = 18.0;
/// Length of the trip \[s\].
pub const DURATION_S: u32 = 600;
/// Steps of the plant from one row to the next.
const STEPS_PER_ROW: u32 = 100;
const ROWS_PER_S: u32 = 10;
const DT: Dt = must!(Dt::from_s(0.001));

/// The plant that drives the trip.
pub const TRUTH: PowertrainParams = PowertrainParams {
    battery: BatteryParams {
        capacity_ah: 61.2,
        series_resistance_ohm: 0.095,
        polarisation: RcBranchParams { resistance_ohm: 0.03, capacitance_f: 1500.0 },
        ..BMW_I3_60AH_CONSTANT.powertrain.battery
    },
    body: BodyParams {
        mass_kg: 1560.0,
        resistance: RoadResistance::Physical {
            drag_coefficient: 0.29,
            frontal_area_m2: 2.38,
            air_density_kg_m3: 1.2,
            rolling_coefficient: 0.0142,
        },
    },
    ..BMW_I3_60AH_CONSTANT.powertrain
};

/// What is recorded of one quantity.
struct Channel {
    header: &'static str,
    /// Its key in the truth file.
    key: &'static str,
    /// Standard deviation of the noise before rounding, in the file's unit.
    noise: f32,
    /// Readings are multiples of this, in the file's unit.
    quantum: f32,
}

/// Noise and steps as seen at standstill in real logs.
const CHANNELS: [Channel; 10] = [
    channel("Velocity [km/h]", "velocity_km_h", 0.02, 0.01),
    channel("Elevation [m]", "elevation_m", 0.0, 1.0),
    channel("Motor Torque [Nm]", "motor_torque_nm", 0.3, 0.5),
    channel("Battery Voltage [V]", "battery_voltage_v", 0.03, 0.1),
    channel("Battery Current [A]", "battery_current_a", 0.1, 0.1),
    channel("Battery Temperature [°C]", "battery_temperature_c", 0.0, 1.0),
    channel("SoC [%]", "soc_percent", 0.0, 0.1),
    channel("Heating Power CAN [kW]", "heating_power_kw", 0.0, 0.04),
    channel("AirCon Power [kW]", "aircon_power_kw", 0.0, 0.04),
    channel("Ambient Temperature [°C]", "ambient_temperature_c", 0.0, 0.5),
];
const VOLTAGE: usize = 3;
const CURRENT: usize = 4;

const fn channel(header: &'static str, key: &'static str, noise: f32, quantum: f32) -> Channel {
    Channel { header, key, noise, quantum }
}

/// Where the speed goes: target \[km/h\], largest acceleration up to there \[m/s²\], then held \[s\].
const PROFILE: [(f64, f64, f64); 19] = [
    (0.0, 1.0, 8.0),
    (30.0, 1.2, 20.0),
    (50.0, 1.6, 35.0),
    (0.0, 1.5, 14.0),
    (50.0, 2.0, 40.0),
    (30.0, 0.9, 15.0),
    (0.0, 1.8, 11.0),
    (50.0, 1.4, 18.0),
    (80.0, 1.5, 55.0),
    (50.0, 0.7, 12.0),
    (80.0, 1.9, 15.0),
    (100.0, 1.1, 60.0),
    (80.0, 0.6, 8.0),
    (50.0, 1.3, 15.0),
    (0.0, 2.0, 18.0),
    (30.0, 1.7, 15.0),
    (50.0, 1.2, 25.0),
    (30.0, 1.0, 10.0),
    (0.0, 1.2, 60.0),
];

/// The file, in the format of the real logs: `;`, Latin-1, CRLF, discharge negative.
///
/// # Panics
/// Never: the parameters are constants that the tests run through.
#[must_use]
pub fn trip_csv() -> Vec<u8> {
    let mut text = String::from("Time [s]");
    for Channel { header, .. } in &CHANNELS {
        let _ = write!(text, ";{header}");
    }
    text.push_str("\r\n");
    let sensors = Sensors::new();
    let mut noise = Noise::from_state(SEED);
    drive(|row, out, heating_w, aircon_w| {
        let share = row as f32 / (DURATION_S * ROWS_PER_S) as f32;
        let values = [
            out.speed_m_s * 3.6,
            height_m(out.distance_m),
            out.drives.motor_nm,
            out.battery_v,
            -out.battery_a,
            20.0 + 2.0 * share,
            out.soc * 100.0,
            heating_w / 1000.0,
            aircon_w / 1000.0,
            AMBIENT_C,
        ];
        text.push_str(&short(row as f32 / ROWS_PER_S as f32));
        for (i, (value, channel)) in values.into_iter().zip(&CHANNELS).enumerate() {
            // A wheel that stands gives no pulses, so no noise either.
            let still = i == 0 && out.speed_m_s.abs() < 0.02;
            let noisy = value + channel.noise * noise.normal();
            let reading = if still { 0.0 } else { sensors.reading(i, noisy) };
            let _ = write!(text, ";{}", short(reading));
        }
        text.push_str("\r\n");
    });
    // Every character is within Latin-1.
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect()
}

/// The true parameters, the noise and the seed, as TOML.
#[must_use]
pub fn truth_toml() -> String {
    let head = "# The true parameters of synthetic.csv: vehicle `bmw-i3-60ah-constant`, but for what is below.\n\
                      # Written by `cargo xtask trip`.\n\n";
    let b = &TRUTH.battery;
    let mut text = String::from(head);
    let _ = write!(
        text,
        "seed = {SEED}\nduration_s = {DURATION_S}\nrow_s = 0.1\nstep_s = 0.001\n\
         initial_soc = {INITIAL_SOC}\nambient_c = {AMBIENT_C}\n\n\
         [battery]\ncapacity_ah = {}\nseries_resistance_ohm = {}\n\n\
         [battery.polarisation]\nresistance_ohm = {}\ncapacitance_f = {}\n\n",
        b.capacity_ah,
        b.series_resistance_ohm,
        b.polarisation.resistance_ohm,
        b.polarisation.capacitance_f,
    );
    let _ = write!(
        text,
        "# Drawn beside what the file's heating and air conditioning say.\n\
         [auxiliary]\npower_w = {}\n\n[body]\nmass_kg = {}\n\n",
        TRUTH.auxiliary.power_w, TRUTH.body.mass_kg,
    );
    if let RoadResistance::Physical { rolling_coefficient, .. } = TRUTH.body.resistance {
        let _ = write!(
            text,
            "[body.resistance.physical]\nrolling_coefficient = {rolling_coefficient}\n\n"
        );
    }
    text.push_str("# Standard deviation of the noise, then the step of the readings; file's units.\n[sensors]\n");
    for Channel { key, noise, quantum, .. } in &CHANNELS {
        let _ = writeln!(text, "{key} = {{ noise = {noise:?}, quantum = {quantum:?} }}");
    }
    text
}

/// Drives the trip and shows each row: its number, the plant, heating and air conditioning \[W\].
fn drive(mut show: impl FnMut(u32, &PowertrainOutput, f32, f32)) {
    let plant = must!(Powertrain::new(TRUTH, DT));
    let driver = must!(Driver::new(BMW_I3_60AH_CONSTANT.driver, &TRUTH, DT));
    let Ok(mut state) = plant.at_rest(INITIAL_SOC) else { unreachable!("a ratio") };
    let mut driver_state = DriverState::default();
    let mut vehicle = plant.feedback(&state);
    let mut metres = 0.0;
    for step in 0..=DURATION_S * ROWS_PER_S * STEPS_PER_ROW {
        let (reference_m_s, reference_m_s2) = profile(f64::from(step) * 0.001);
        let command =
            driver.step(&mut driver_state, DriverInput { reference_m_s, reference_m_s2, vehicle });
        let (heating_w, aircon_w) = auxiliaries_w(step);
        let mut input = PowertrainInput {
            auxiliary_w: heating_w + aircon_w,
            ..PowertrainInput::on(command.duty)
        };
        input.road.brake_n = command.brake_n;
        input.road.grade = grade(metres);
        let out = plant.step(&mut state, input);
        (vehicle, metres) = ((&out).into(), out.distance_m);
        if step % STEPS_PER_ROW == 0 {
            show(step / STEPS_PER_ROW, &out, heating_w, aircon_w);
        }
    }
}

/// Speed \[m/s\] and acceleration \[m/s²\] at a time: ramps without a jerk at either end.
fn profile(time_s: f64) -> (f32, f32) {
    let (mut start_s, mut speed) = (0.0, 0.0);
    for (target_km_h, largest, hold_s) in PROFILE {
        let change = target_km_h / 3.6 - speed;
        // v = v₀ + Δv·(3x² − 2x³) is steepest in its middle: 1.5·Δv/T.
        let ramp_s = 1.5 * change.abs() / largest;
        let x = (time_s - start_s) / ramp_s;
        if x < 1.0 {
            let speed = speed + change * x * x * (3.0 - 2.0 * x);
            return (speed as f32, (change * 6.0 * x * (1.0 - x) / ramp_s) as f32);
        }
        speed += change;
        start_s += ramp_s + hold_s;
        if time_s < start_s {
            break;
        }
    }
    (speed as f32, 0.0)
}

/// Waves of the road: amplitude \[m\], length \[m\], start \[turns\].
const HILLS: [(f32, f32, f32); 3] = [(14.0, 2900.0, 0.0), (7.0, 1150.0, 0.3), (4.0, 640.0, 0.7)];

/// Height of the road at a distance \[m\].
fn height_m(distance_m: f32) -> f32 {
    let wave = |(height, length, start): (f32, f32, f32)| {
        height * sin_cos_turns(distance_m / length + start).0
    };
    540.0 + HILLS.into_iter().map(wave).sum::<f32>()
}

/// Slope of the same road.
fn grade(distance_m: f32) -> Grade {
    let wave = |(height, length, start): (f32, f32, f32)| {
        height * std::f32::consts::TAU / length * sin_cos_turns(distance_m / length + start).1
    };
    Grade::from_sin(HILLS.into_iter().map(wave).sum())
}

/// Heating and air conditioning at a step \[W\], in the steps of their readings: they are recorded
/// as they are.
fn auxiliaries_w(step: u32) -> (f32, f32) {
    // Either changes once in 5 s.
    let turns = (step / 5000) as f32 / 120.0;
    let in_steps = |kw: f32| (kw / 0.04).round() * 40.0;
    let heating = if turns < 0.25 { 1.6 - 4.0 * turns } else { 0.0 };
    (in_steps(heating), in_steps(0.5 + 0.4 * sin_cos_turns(3.0 * turns).0))
}

/// What rounds each reading.
struct Sensors {
    volts: VoltageSensor,
    amperes: CurrentSensor,
}

impl Sensors {
    const fn new() -> Self {
        const fn of(channel: usize) -> SensorParams {
            SensorParams { quantum: CHANNELS[channel].quantum, ..SensorParams::IDEAL }
        }
        Self {
            volts: must!(VoltageSensor::new(of(VOLTAGE))),
            amperes: must!(CurrentSensor::new(of(CURRENT))),
        }
    }

    fn reading(&self, channel: usize, value: f32) -> f32 {
        match channel {
            VOLTAGE => self.volts.step(&mut (), VoltageSensorInput { voltage_v: value }).voltage_v,
            CURRENT => {
                self.amperes.step(&mut (), CurrentSensorInput { current_a: value }).current_a
            }
            _ => (value / CHANNELS[channel].quantum).round() * CHANNELS[channel].quantum,
        }
    }
}

/// Two decimals at most, as in the real files.
fn short(value: f32) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::trip;

    fn committed(name: &str) -> Vec<u8> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/trips/");
        std::fs::read(format!("{folder}{name}")).unwrap()
    }

    #[test]
    fn the_committed_files_are_what_the_generator_makes() {
        let fix = "run `cargo xtask trip`";
        assert!(committed("synthetic.csv") == trip_csv(), "{fix}");
        assert!(committed("synthetic.truth.toml") == truth_toml().into_bytes(), "{fix}");
    }

    #[test]
    fn it_is_a_trip_as_intended() {
        let csv = trip_csv();
        assert!(csv.len() < 600_000 && csv.contains(&0xb0));
        let t = trip::parse("synthetic.csv", &csv).unwrap();
        assert_eq!((t.name.as_str(), t.len(), t.duration_s()), ("synthetic", 6001, 600.0));
        assert!(t.notes.is_empty() && t.quirks(60.0).is_empty(), "{:?}", t.quirks(60.0));
        let span = |values: &[f64]| {
            let of = |f: fn(f64, f64) -> f64| values.iter().copied().reduce(f).unwrap();
            (of(f64::min), of(f64::max))
        };
        let (low, high) = span(&t.elevation_m);
        assert!(low >= 515.0 && high <= 565.0 && high - low > 30.0, "{low} {high}");
        let (slowest, fastest) = span(&t.speed_m_s);
        assert!(slowest >= 0.0 && (27.5..28.3).contains(&fastest), "{slowest} {fastest}");
        let stops = t.speed_m_s.windows(2).filter(|v| v[0] > 0.0 && v[1] == 0.0).count();
        assert!(stops >= 4, "{stops}");
        let (charge, discharge) = span(&t.battery_a);
        assert!(charge < -20.0 && discharge > 100.0, "{charge} {discharge}");
        assert_eq!(t.first_soc(), Some(0.742));
        assert_eq!((t.auxiliary_w(0), t.speed_m_s[0], t.speed_m_s[6000]), (2120.0, 0.0, 0.0));
    }

    #[test]
    fn the_driver_keeps_to_the_profile_and_the_limits_to_themselves() {
        let mut worst: f32 = 0.0;
        drive(|row, out, _, _| {
            worst = worst.max((out.speed_m_s - profile(f64::from(row) * 0.1).0).abs());
            assert!(!out.rejected && out.limited == plant_core::powertrain::Limited::No);
        });
        assert!(worst < 0.2, "{worst}");
    }
}
