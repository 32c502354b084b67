//! `voltstep identify battery`.

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
        (&["bad.csv"][..], "bad.csv:2:5: voltage_v: expected a number"),
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
