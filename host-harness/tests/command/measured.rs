//! `voltstep validate --trips`.

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
    for (folder, part) in
        [("empty", "no .csv file"), ("nowhere", "cannot be read"), ("wrong", "cycle.csv:1")]
    {
        let run = sandbox.run(&["validate", "--trips", folder]);
        assert_eq!(run.code, Some(2), "{folder}");
        assert!(run.stderr.contains(part), "{folder}: {}", run.stderr);
        assert!(run.stdout.is_empty());
    }
}
