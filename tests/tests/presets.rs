//! Every preset survives a file: what is written as JSON or TOML is read back to the bit.
//!
//! Many hold a limit that is infinite, for which JSON has no number.

use std::fmt::Debug;

use plant_core::presets::{
    BMW_I3_60AH_PACK, BMW_I3_60AH_TABLE_5_2, BMW_I3_60AH_THERMAL, CONVERTER_BENCH_LOAD,
    CONVERTER_BENCH_MOTOR, MAPPED_VEHICLES, MOTOR_MOMENTS, MOTOR_PASEK, PANASONIC_NCR18650PF,
    VEHICLES, Vehicle,
};
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
