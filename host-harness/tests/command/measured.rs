//! `voltstep validate --trips` and `--cells`.

use serde_json::Value;

use super::{Sandbox, TRIP};

#[test]
fn compares_every_trip_of_a_folder_in_both_modes() {
    let sandbox = Sandbox::new();
    let trip = std::fs::read(TRIP).unwrap();
    sandbox.write("trips/one.csv", &trip);
    sandbox.write("trips/two.csv", &trip);
    sandbox.write("trips/notes.txt", "not a trip");
    let run = sandbox.run(&["validate", "--trips", "trips", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let rows = report["trips"].as_array().unwrap();
    let names: Vec<_> =
        rows.iter().map(|r| (r["name"].as_str().unwrap(), r["mode"].as_str().unwrap())).collect();
    let expected = [("one", "battery"), ("one", "vehicle"), ("two", "battery"), ("two", "vehicle")];
    assert_eq!(names, expected);
    for row in rows {
        let whole = row["mode"] == "vehicle";
        for field in ["voltage_rmse_v", "soc_rmse", "soc_drop_rel", "current_rmse_a", "energy_rel"]
        {
            assert!(row[field].is_f64(), "{field}: {row}");
        }
        for field in ["torque_rmse_nm", "speed_error_rms_m_s"] {
            assert_eq!(row[field].is_f64(), whole, "{field}: {row}");
        }
    }
    let battery = &report["summary"]["battery"];
    assert_eq!(battery["count"], 2);
    for suffix in ["median", "p90", "max"] {
        assert_eq!(battery[format!("voltage_rmse_v_{suffix}")], rows[0]["voltage_rmse_v"]);
    }
    assert!(report["summary"]["vehicle"]["torque_rmse_nm_median"].is_f64());

    let table = sandbox.run(&["validate", "--trips", "trips"]).stdout;
    for part in ["one", "two", "median of 2", "90th percentile", "2 trips"] {
        assert!(table.contains(part), "{part}: {table}");
    }
}

#[test]
fn a_trip_that_cannot_be_trusted_is_named_and_left_out() {
    let sandbox = Sandbox::new();
    let trip = String::from_utf8_lossy(&std::fs::read(TRIP).unwrap()).into_owned();
    sandbox.write("trips/good.csv", &trip);
    // A state of charge that falls half as fast again as the ampere-hours.
    let mut lines = trip.lines();
    let header = lines.next().unwrap();
    let place = header.split(';').position(|name| name.starts_with("SoC")).unwrap();
    let spoilt = lines.map(|line| {
        let mut fields: Vec<_> = line.split(';').map(str::to_owned).collect();
        if let Ok(soc) = fields[place].parse::<f64>() {
            fields[place] = format!("{:.1}", 100.0 - 2.0 * (100.0 - soc));
        }
        fields.join(";")
    });
    let text: Vec<_> = std::iter::once(header.to_owned()).chain(spoilt).collect();
    sandbox.write("trips/spoilt.csv", text.join("\n"));
    let run = sandbox.run(&["validate", "--trips", "trips", "--json"]);
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["summary"]["battery"]["count"], 1, "{}", run.stdout);
    let row = &report["trips"][2];
    assert_eq!((&row["name"], &row["counts"]), (&"spoilt".into(), &false.into()));
    assert!(row["notes"].to_string().contains("does not fit the ampere-hours"), "{row}");
}

#[test]
fn refuses_a_folder_without_trips() {
    let sandbox = Sandbox::new();
    sandbox.write("empty/notes.txt", "no trip");
    sandbox.write("wrong/cycle.csv", "time_s,speed_m_s\n0,0\n1,1\n");
    for (folder, part) in [
        ("empty", "no .csv file"),
        ("nowhere", "cannot be read"),
        ("wrong", "cycle.csv:1:1: this is a driving cycle"),
    ] {
        let run = sandbox.run(&["validate", "--trips", folder]);
        assert_eq!(run.code, Some(2), "{folder}");
        assert!(run.stderr.contains(part), "{folder}: {}", run.stderr);
        assert!(run.stdout.is_empty());
    }
}

/// A drive cycle that the built-in cell itself drove, its voltage off by `bias_v`, and 1 s between
/// samples.
pub fn drive_cycle(bias_v: f32) -> String {
    use plant_core::Dt;
    use plant_core::battery::{MappedBattery, MappedBatteryInput};
    let cell = voltstep::read::battery::load("panasonic-ncr18650pf").unwrap();
    let battery = MappedBattery::new(cell.battery, Dt::from_s(0.01).unwrap()).unwrap();
    let mut state = battery.rested_at(1.0, 20.0).unwrap();
    let mut text =
        "time_s,current_a,voltage_v,discharged_ah,cell_temperature_c,chamber_temperature_c\n"
            .to_owned();
    let mut last = battery.step(&mut state, MappedBatteryInput { current_a: 2.0 });
    for second in 0..3000_u16 {
        let current_a = if second / 60 % 3 == 0 { 4.0 } else { 1.0 };
        let used_ah = (1.0 - last.soc) * cell.battery.capacity_ah;
        let (volts, celsius) = (last.terminal_v + bias_v, last.temperature_c);
        text += &format!("{second},{},{volts:.5},{used_ah:.5},{celsius:.2},20\n", last.current_a);
        for _ in 0..100 {
            last = battery.step(&mut state, MappedBatteryInput { current_a });
        }
    }
    text
}

#[test]
fn compares_every_drive_cycle_of_a_cell() {
    let sandbox = Sandbox::new();
    sandbox.write("cells/own.csv", drive_cycle(0.0));
    sandbox.write("cells/off.csv", drive_cycle(0.05));
    sandbox.write(
        "cells/slow.csv",
        drive_cycle(0.0).lines().step_by(60).collect::<Vec<_>>().join("\n"),
    );
    let run = sandbox.run(&["validate", "--cells", "cells", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let cells = report["cells"].as_array().unwrap();
    assert_eq!(cells.len(), 2, "{}", run.stdout);
    assert!(report["skipped"][0].as_str().unwrap().starts_with("slow: sampled every"));
    let (off, own) = (&cells[0], &cells[1]);
    let of = |row: &Value, name: &str| row[name].as_f64().unwrap();
    // Its own voltage, but for the delay of the built-in cell's logger at the edges.
    assert!(of(own, "voltage_rmse_mv") < 5.0, "{own}");
    assert!((of(off, "voltage_rmse_mv") - 50.0).abs() < 2.0, "{off}");
    assert!((of(off, "voltage_rmse_mv_above_25_soc") - 50.0).abs() < 2.0, "{off}");
    assert!(of(own, "temperature_rmse_k") < 0.1, "{own}");
    let worst = of(&report["summary"], "voltage_rmse_mv_max");
    assert_eq!(worst, of(off, "voltage_rmse_mv"));
    let table = sandbox.run(&["validate", "--cells", "cells"]).stdout;
    assert!(table.contains("own") && table.contains("no drive cycle: slow"), "{table}");
}
