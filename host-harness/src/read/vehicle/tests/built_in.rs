//! The built-in vehicles: the same in files and presets.

use plant_core::presets;

use super::super::*;

#[test]
fn every_built_in_file_equals_its_preset_and_the_other_way_round() {
    let constant = presets::VEHICLES.map(|preset| in_full(preset, VehicleBattery::Constant));
    let mapped = presets::MAPPED_VEHICLES.map(|preset| in_full(preset, VehicleBattery::Mapped));
    let pmsm = in_full(&presets::BMW_I3_60AH_PMSM, VehicleBattery::Constant);
    let thermal = in_full(&presets::BMW_I3_60AH_THERMAL, VehicleBattery::Constant);
    let two_axles = in_full(&presets::TWO_AXLES, VehicleBattery::Constant);
    let mut expected = [&constant[..], &mapped, &[pmsm, thermal, two_axles]].concat();
    expected.sort_by(|a, b| a.name.cmp(&b.name));
    let built_in = builtin();
    assert_eq!(built_in.len(), expected.len());
    for ((vehicle, name), expected) in built_in.iter().zip(names()).zip(expected) {
        let (description, source) = (vehicle.description.clone(), vehicle.source.clone());
        assert!(!description.is_empty() && !description.contains('\n') && !source.is_empty());
        // How trips act on it is the host's alone.
        let trips = vehicle.trips.clone();
        assert_eq!(vehicle, &Vehicle { description, source, trips, ..expected });
        assert_eq!(vehicle.name, name);
        assert_eq!(&load(name).unwrap(), vehicle);
    }
}

/// What a file of the same vehicle says, but for the words.
fn in_full<P: Copy, D: Copy + Into<VehicleDrives>>(
    preset: &presets::Vehicle<P, D>,
    battery: impl FnOnce(P) -> VehicleBattery,
) -> Vehicle {
    Vehicle {
        name: preset.name.to_owned(),
        description: String::new(),
        source: String::new(),
        initial_soc: preset.initial_soc,
        powertrain: preset
            .powertrain
            .with_battery(battery(preset.powertrain.battery))
            .with_drives(preset.powertrain.drives.into()),
        driver: preset.driver,
        trips: None,
    }
}

#[test]
fn every_vehicle_file_is_built_in_and_has_its_source() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/vehicles");
    let sources = std::fs::read_to_string(folder.join("SOURCE.toml")).unwrap();
    let sources: toml::Table = sources.parse().unwrap();
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if stem != "SOURCE" {
            let from_path = load(path.to_str().unwrap()).unwrap();
            assert_eq!(from_path, load(&stem).unwrap());
            assert_eq!(from_path.name, stem);
            for key in ["file", "origin", "licence", "units"] {
                assert!(sources[&stem][key].is_str(), "{stem}: {key}");
            }
            files.push(stem);
        }
    }
    files.sort();
    let mut names: Vec<_> = names().collect();
    names.sort_unstable();
    assert_eq!(files, names);
    assert_eq!(sources.len(), names.len());
}
