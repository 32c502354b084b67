//! `voltstep identify`.

use super::{Sandbox, TRIP};

#[test]
fn refuses_what_tells_no_battery_and_keeps_an_earlier_file() {
    let sandbox = Sandbox::new();
    sandbox.write("cell.toml", "earlier");
    let header = "time_s,current_a,voltage_v,discharged_ah,cell_temperature_c\n";
    let rows = |amps: f64| {
        (0..2000).fold(String::new(), |text, s| {
            let used_ah = amps * f64::from(s) / 3600.0;
            text + &format!("{s},{amps},{:.4},{used_ah:.5},25\n", 4.1 - 0.3 * used_ah)
        })
    };
    sandbox.write("steady.csv", format!("{header}{}", rows(2.0)));
    sandbox.write("short.csv", format!("{header}{}", rows(0.1)));
    sandbox.write("bad.csv", format!("{header}0,1,four,0,25\n1,1,4,0,25\n"));
    sandbox.write("trip.csv", std::fs::read(TRIP).unwrap());
    for (files, part) in [
        (&["bad.csv"][..], "bad.csv:2:5: `four` for voltage_v; expected a number"),
        (&["steady.csv"], "give one, or --capacity-ah"),
        (&["steady.csv", "--capacity-ah", "3"], "too little to tell a resistance"),
        (&["short.csv", "--capacity-ah", "3"], "too little for an open-circuit curve"),
        (&["steady.csv", "trip.csv"], "not of one battery"),
        (&["nowhere.csv"], "cannot read"),
        (&["steady.csv", "--capacity-ah=-3"], "must be above 0"),
    ] {
        let run = sandbox.run(&[&["identify", "battery", "--out", "cell.toml"], files].concat());
        assert_eq!(run.code, Some(2), "{files:?}: {}", run.stderr);
        assert!(run.stderr.contains(part), "{files:?}: {}", run.stderr);
        assert_eq!(sandbox.read("cell.toml"), "earlier");
    }
}

/// So many copies of a trip in a folder.
fn trips(sandbox: &Sandbox, count: usize) {
    for i in 0..count {
        sandbox.write(&format!("trips/{i}.csv"), std::fs::read(TRIP).unwrap());
    }
}

#[test]
fn a_vehicle_is_written_that_drives_as_the_trips_did() {
    let sandbox = Sandbox::new();
    trips(&sandbox, 3);
    // This trip's heights are true, and its hills shorter than what real heights are smoothed over.
    let vehicle = include_str!("../../data/vehicles/bmw-i3-60ah-constant.toml");
    let conditions = "[trips]\nspeed_smoothing_s = 0.15\nheight_smoothing_m = 40\nwarm_up_factor = 0\n\
                      rolling_factor = [[15, 1]]\nwarm_up_m = 2500\nmoving_power_w = 0\n";
    sandbox.write("given.toml", format!("{vehicle}\n{conditions}"));
    let identify = |out: &str, rest: &[&str]| {
        let all = ["identify", "vehicle", "trips", "--vehicle", "given.toml", "--out", out];
        sandbox.run(&[&all, rest].concat())
    };
    let run = identify("car.toml", &["--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let mass_kg = found["parameters"][0]["value"].as_f64().unwrap();
    // One drive with a pedal that is not recorded: what the gear loses (3 %) looks like mass.
    assert!((mass_kg / 1560.0 - 1.0).abs() < 0.05, "{mass_kg}");
    assert_eq!((&found["name"], &found["left_out"][2]["name"]), (&"car".into(), &"2".into()));
    let file: toml::Table = sandbox.read("car.toml").parse().unwrap();
    assert!((file["body"]["mass_kg"].as_float().unwrap() / mass_kg - 1.0).abs() < 1e-3);
    assert_eq!(file["fit"]["trips"].as_array().unwrap().len(), 3);
    assert!(file["standard_error"]["mass_kg"].is_float());
    // The same from the same, and a table that says so.
    let again = identify("again.toml", &[]);
    assert!(again.stdout.contains("mass_kg") && again.stdout.contains("a new trip"));
    assert_eq!(
        sandbox.read("again.toml").replace("\"again\"", "\"car\""),
        sandbox.read("car.toml")
    );

    let run = sandbox.run(&["validate", "--trips", "trips", "--vehicle", "car.toml", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let off = report["summary"]["vehicle"]["energy_rel_median"].as_f64().unwrap();
    assert!(off < 0.02, "{off}");
}

#[test]
fn refuses_what_tells_no_vehicle_and_keeps_an_earlier_file() {
    let sandbox = Sandbox::new();
    sandbox.write("car.toml", "earlier");
    trips(&sandbox, 2);
    let cell =
        "time_s,current_a,voltage_v,discharged_ah,cell_temperature_c\n0,1,4,0,25\n1,1,4,0,25\n";
    sandbox.write("cell.csv", cell);
    for (arguments, part) in [
        (&["cell.csv"][..], "tests of a cell tell no vehicle"),
        (&["trips"], "2 trips that can be trusted; a vehicle wants 3"),
        (&["trips", "--vehicle", "two-axles"], "only a vehicle with one DC machine"),
        (&["trips", "--vehicle", "nothing"], "no such vehicle"),
        (&["nowhere.csv"], "cannot read"),
    ] {
        let run = sandbox.run(&[&["identify", "vehicle", "--out", "car.toml"], arguments].concat());
        assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(part), "{arguments:?}: {}", run.stderr);
        assert_eq!(sandbox.read("car.toml"), "earlier");
    }
}
