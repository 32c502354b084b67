//! Every preset survives a file: what is written as JSON or TOML is read back to the bit.
//!
//! Many hold a limit that is infinite, for which JSON has no number.

use std::fmt::Debug;

use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::mechanics::body::Road;
use plant_core::powertrain::{Powertrain, PowertrainInput};
use plant_core::presets::{
    BMW_I3_60AH, BMW_I3_60AH_PACK, BMW_I3_60AH_TABLE_5_2, BMW_I3_60AH_THERMAL,
    CONVERTER_BENCH_LOAD, CONVERTER_BENCH_MOTOR, MAPPED_VEHICLES, MOTOR_MOMENTS, MOTOR_PASEK,
    PANASONIC_NCR18650PF, VEHICLES, Vehicle,
};
use plant_core::{Dt, MappedBattery};
use serde::Serialize;
use serde::de::DeserializeOwned;

#[track_caller]
fn survives<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let json = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&json).unwrap(), value, "{json}");
    let toml = toml::to_string(value).unwrap();
    assert_eq!(&toml::from_str::<T>(&toml).unwrap(), value, "{toml}");
}

#[track_caller]
fn vehicle_survives<P: Serialize + DeserializeOwned + PartialEq + Debug>(vehicle: &Vehicle<P>) {
    survives(&vehicle.powertrain);
    survives(&vehicle.driver);
}

#[test]
fn vehicles() {
    for vehicle in VEHICLES {
        vehicle_survives(vehicle);
    }
    for vehicle in MAPPED_VEHICLES {
        vehicle_survives(vehicle);
    }
    survives(&BMW_I3_60AH_THERMAL.powertrain);
}

#[test]
fn components() {
    for motor in [MOTOR_PASEK, MOTOR_MOMENTS, CONVERTER_BENCH_MOTOR] {
        survives(&motor);
    }
    survives(&CONVERTER_BENCH_LOAD);
    for battery in [BMW_I3_60AH_PACK, BMW_I3_60AH_TABLE_5_2, PANASONIC_NCR18650PF] {
        survives(&battery);
    }
}

/// BMW's technical data say 7.2 s, and 7.9 s for the heavier car with a range extender.
#[test]
fn the_i3_reaches_100_km_h_as_fast_as_it_does() {
    let (params, dt) = (BMW_I3_60AH.powertrain, Dt::from_s(1e-3).unwrap());
    let battery = MappedBattery::new(params.battery, dt).unwrap();
    let axle = params.drives.on(params.wheel, dt).unwrap();
    let plant = Powertrain::of(battery, axle, &params, dt).unwrap();
    let driver = Driver::new(BMW_I3_60AH.driver, &params, dt).unwrap();
    let mut state = plant.at_rest(BMW_I3_60AH.initial_soc).unwrap();
    let mut driving = DriverState::default();
    let mut vehicle = plant.feedback(&state);
    let mut steps = 0_u32;
    while vehicle.speed_m_s < 100.0 / 3.6 && steps < 20_000 {
        let input = DriverInput { reference_m_s: 40.0, reference_m_s2: 0.0, vehicle };
        let command = driver.step(&mut driving, input);
        let road = Road { brake_n: command.brake_n, ..Road::default() };
        let out =
            plant.step(&mut state, PowertrainInput { road, ..PowertrainInput::on(command.duty) });
        assert!(!out.rejected);
        vehicle = plant.seen_of(&out);
        steps += 1;
    }
    let seconds = f64::from(steps) * 1e-3;
    assert!((7.2..=7.9).contains(&seconds), "{seconds} s");
}
