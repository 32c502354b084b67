//! What is wrong with the input is said in one line, exit code 2, and nothing is written.

use crate::{OUTPUTS, Sandbox};

const CYCLE: &str = "time_s,speed_m_s\n0,0\n10,5\n20,0\n";
const TRIP: &str = "\
Time [s];Velocity [km/h];Elevation [m];Battery Voltage [V];Battery Current [A];SoC [%]
0;0;500;390;-10;80
1;3.6;500;389;-12;79.9
2;0;500;390;-10;79.8
";
const VEHICLE: &str = include_str!("../../data/vehicles/bmw-i3-60ah.toml");

/// `text` with one piece replaced that must be there.
fn with(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}`");
    text.replace(from, to)
}

/// A folder with sound inputs, spoilt ones and an earlier output.
fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("cycle.csv", CYCLE);
    sandbox.write("no-column.csv", with(CYCLE, "_s,speed_m_s", "_s"));
    sandbox.write("other-column.csv", with(CYCLE, "speed_m_s", "speed_ms"));
    sandbox.write("text.csv", with(CYCLE, "10,5", "10,fast"));
    sandbox.write("backwards.csv", with(CYCLE, "20,0", "9.5,0"));
    sandbox.write("nan.csv", with(CYCLE, "10,5", "10,NaN"));
    sandbox.write("one-row.csv", "time_s,speed_m_s\n0,0\n");
    sandbox.write("brief.csv", "time_s,speed_m_s\n0,0\n0.0004,0\n");
    sandbox.write("empty.csv", "");
    sandbox.write("blank.csv", "\n\n");
    sandbox.write("binary.csv", b"\x7fELF\x02\x01\x01\0\0\0\n\xff\xfe\0\0");
    sandbox.write("folder/inside.txt", "");

    sandbox.write("trip.csv", TRIP);
    sandbox.write("trip-no-column.csv", with(TRIP, "SoC [%]", "Charge [%]"));
    sandbox.write("trip-text.csv", with(TRIP, "389", "abc"));
    sandbox.write("trip-comma.csv", with(TRIP, "1;3.6;500;389", "1.0;3,6;500;389"));
    sandbox.write("trip-backwards.csv", with(TRIP, "\n2;", "\n0.5;"));
    sandbox.write("trip-nan.csv", with(TRIP, "-12", "NaN"));
    sandbox.write("trip-short-row.csv", with(TRIP, "-12;", ""));
    sandbox.write("trip-header-only.csv", TRIP.lines().next().unwrap());
    let no_soc = TRIP.replace(";80\n", ";\n").replace(";79.9\n", ";\n").replace(";79.8\n", ";\n");
    sandbox.write("trip-no-soc.csv", no_soc);
    sandbox.write("trip-binary.csv", b"\0\x01;\xff\n;;;\n\r\x1b[31m");

    sandbox.write("negative.toml", with(VEHICLE, "[body]\nmass_kg = ", "[body]\nmass_kg = -"));
    sandbox.write("typo.toml", with(VEHICLE, "\nradius_m", "\nradios_m"));
    sandbox.write("half.toml", &VEHICLE[..VEHICLE.find("radius_m").unwrap()]);
    sandbox.write("broken.toml", with(VEHICLE, "[wheel]", "[wheel"));

    for name in OUTPUTS {
        sandbox.write(&format!("earlier/{name}"), "an earlier output");
        // One of the three cannot be replaced: it is a folder.
        let blocked = format!("blocked/{name}{}", if name == "trace.csv" { "/x" } else { "" });
        sandbox.write(&blocked, "an earlier output");
    }
    sandbox
}

/// Runs each, and looks for each piece of what it must say.
#[track_caller]
fn refused(sandbox: &Sandbox, cases: &[(&[&str], &[&str])]) {
    let before = sandbox.everything();
    for (args, pieces) in cases {
        let out: &[&str] = if args.contains(&"--out") { &[] } else { &["--out", "earlier"] };
        let finished = sandbox.run(&[&["replay"], *args, out].concat());
        let said = finished.stderr;
        assert_eq!((finished.code, finished.stdout.as_str()), (Some(2), ""), "{args:?}: {said}");
        let lines = said.lines().count();
        assert!(lines == 1 && said.ends_with('\n'), "{args:?}: {lines} lines: {said}");
        assert!(said.starts_with("voltstep: ") && !said.contains('\u{1b}'), "{args:?}: {said}");
        for piece in *pieces {
            assert!(said.contains(piece), "{args:?}: no `{piece}` in {said}");
        }
        assert!(sandbox.everything() == before, "{args:?} changed a file");
    }
}

#[test]
fn what_is_no_input() {
    let names = "udds, hwfet, us06, wltc3b, nedc";
    refused(
        &sandbox(),
        &[
            (&["nowhere.csv"], &["`nowhere.csv` is neither a file nor", names]),
            (&["uddz"], &["`uddz`", "did you mean `udds`?", names]),
            (&["UDDS"], &["`UDDS`", "did you mean `udds`?"]),
            (&[""], &["neither a file nor", names]),
            (&["two\nlines"], &["`two", "lines`"]),
            (&["folder"], &["folder", "directory"]),
        ],
    );
}

#[test]
fn cycle_files() {
    refused(
        &sandbox(),
        &[
            (&["no-column.csv"], &["no-column.csv:1:1: no column `speed_m_s`"]),
            (&["other-column.csv"], &["other-column.csv:1:8: unknown", "`speed_m_s`?"]),
            (&["text.csv"], &["text.csv:3:4: `fast` for speed_m_s; expected a number"]),
            (
                &["backwards.csv"],
                &["backwards.csv:4:1: time does not rise: 9.5 after 10 in line 3"],
            ),
            (&["nan.csv"], &["nan.csv:3:4: `NaN` for speed_m_s"]),
            (&["one-row.csv"], &["one-row.csv: 1 samples; expected two"]),
            (&["brief.csv"], &["brief", "shorter than a step", "0.4000 ms"]),
            (&["empty.csv"], &["empty.csv:1:1: empty file"]),
            (&["blank.csv"], &["blank.csv:1:1: empty file"]),
            (&["binary.csv"], &["binary.csv:2:1: not a text"]),
        ],
    );
}

#[test]
fn trip_files() {
    refused(
        &sandbox(),
        &[
            (&["trip-no-column.csv"], &["trip-no-column.csv:1:1: no column `SoC [%]`", "`Charge`"]),
            (&["trip-text.csv"], &["trip-text.csv:3:11: `abc` for Battery Voltage"]),
            (&["trip-comma.csv"], &["trip-comma.csv:3:5: `3,6` for Velocity", "decimal point"]),
            (
                &["trip-backwards.csv"],
                &["trip-backwards.csv:4:1: time does not rise: 0.5 after 1 in line 3"],
            ),
            (&["trip-nan.csv"], &["trip-nan.csv:3:15: `NaN` for Battery Current"]),
            (&["trip-short-row.csv"], &["trip-short-row.csv:3:19: 5 fields; expected 6"]),
            (&["trip-header-only.csv"], &["trip-header-only.csv: 0 samples"]),
            (&["trip-no-soc.csv"], &["trip-no-soc: no state of charge"]),
            (&["trip-binary.csv"], &["trip-binary.csv:1:", "not a text"]),
            (&["trip-text.csv", "--mode", "battery"], &["trip-text.csv:3:11: "]),
            (&["cycle.csv", "--mode", "battery"], &["`cycle` is a driving cycle", "a trip"]),
            (&["udds", "--mode", "battery"], &["`udds` is a driving cycle", "a trip"]),
        ],
    );
}

#[test]
fn vehicles() {
    let line = |key: &str| 1 + VEHICLE.lines().position(|l| l.starts_with(key)).unwrap();
    let negative = format!("negative.toml:{}:1: `mass_kg` in [body]", line("mass_kg"));
    let typo = format!("typo.toml:{}:1: unknown key `radios_m` in [wheel]", line("radius_m"));
    let broken = format!("broken.toml:{}:", line("[wheel]"));
    refused(
        &sandbox(),
        &[
            (&["cycle.csv", "--vehicle", "negative.toml"], &[&negative, "found -"]),
            (&["cycle.csv", "--vehicle", "typo.toml"], &[&typo, "did you mean `radius_m`?"]),
            (&["cycle.csv", "--vehicle", "half.toml"], &["half.toml", "missing key"]),
            (&["cycle.csv", "--vehicle", "broken.toml"], &[&broken]),
            (&["cycle.csv", "--vehicle", "bmw-i4-60ah"], &["bmw-i4-60ah", "`bmw-i3-60ah`?"]),
            (&["cycle.csv", "--vehicle", "nowhere.toml"], &["nowhere.toml: cannot read"]),
            (&["cycle.csv", "--vehicle", "./binary.csv"], &["./binary.csv:2:1: not a text"]),
            (&["cycle.csv", "--vehicle", "two\nlines.toml"], &["lines.toml: cannot read"]),
            (&["cycle.csv", "--vehicle", "folder/"], &["folder/", "directory"]),
        ],
    );
}

#[test]
fn steps() {
    let steps = ["0", "-1", "NaN", "inf", "0.00001", "1001"];
    for step in steps {
        refused(&sandbox(), &[(&["cycle.csv", "--dt-ms", step], &["--dt-ms must lie in", step])]);
    }
}

/// The loop round the plant bounds the step, not the plant.
#[test]
fn steps_that_make_a_loop_useless() {
    let driven = |args: &[&'static str]| [&["udds", "--no-ledger"], args].concat();
    let long = driven(&["--dt-ms", "1000"]);
    let stiff = driven(&["--dt-ms", "20", "--vehicle", "epowertrain-udds"]);
    refused(
        &sandbox(),
        &[
            (&long, &["bmw-i3-60ah: in steps of 1000 ms", "energy", "m/s RMS", "useless"]),
            (&stiff, &["epowertrain-udds: in steps of 20 ms", "against steps of 1 ms"]),
        ],
    );
}

#[test]
fn folders_that_cannot_take_the_output() {
    let sandbox = sandbox();
    let case = |folder: &'static str| ["trip.csv", "--mode", "battery", "--out", folder];
    refused(
        &sandbox,
        &[
            (&case("text.csv"), &["text.csv", "exists"]),
            (&case("text.csv/under"), &["text.csv/under", "ot a directory"]),
            (&case("blocked"), &["blocked/trace.csv", "directory"]),
        ],
    );
    #[cfg(target_os = "linux")]
    refused(&sandbox, &[(&case("/proc/voltstep"), &["/proc/voltstep"])]);
    #[cfg(unix)]
    without_permission(&sandbox);
}

#[cfg(unix)]
fn without_permission(sandbox: &Sandbox) {
    use std::fs::{File, Permissions, set_permissions};
    use std::os::unix::fs::PermissionsExt;
    let folder = sandbox.path().join("earlier");
    set_permissions(&folder, Permissions::from_mode(0o555)).unwrap();
    if File::create(folder.join("probe")).is_ok() {
        // Not by a macro: the test runner keeps to itself what a test that passes prints.
        let told = "SKIPPED a folder without permission to write: this user may write anywhere";
        let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("{told}\n").as_bytes());
        return;
    }
    refused(sandbox, &[(&["trip.csv", "--mode", "battery"], &["earlier", "ermission denied"])]);
    set_permissions(&folder, Permissions::from_mode(0o755)).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output() {
    let sandbox = sandbox();
    for args in [["list"].as_slice(), &["replay", "cycle.csv", "--json", "--out", "earlier"]] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = sandbox.command(args).stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.contains("standard output"), "{said}");
    }
}

/// What is wrong with the words of the command itself is said together with its usage.
#[test]
fn words_that_are_not_understood() {
    let sandbox = sandbox();
    let before = sandbox.everything();
    let cases: [(&[&str], &str); 7] = [
        (&[], "Usage: voltstep <COMMAND>"),
        (&["replay"], "Usage: voltstep replay"),
        (&["drive"], "'drive'"),
        (&["replay", "cycle.csv", "--mode", "flight", "--out", "earlier"], "'flight'"),
        (&["replay", "cycle.csv", "--dt-ms", "short", "--out", "earlier"], "'short'"),
        (&["replay", "cycle.csv", "--fast", "--out", "earlier"], "'--fast'"),
        (&["replay", "cycle.csv", "--out"], "'--out <DIR>'"),
    ];
    for (args, piece) in cases {
        let finished = sandbox.run(args);
        assert_eq!((finished.code, finished.stdout.as_str()), (Some(2), ""), "{args:?}");
        assert!(finished.stderr.contains(piece), "{args:?}: {}", finished.stderr);
    }
    assert!(sandbox.everything() == before);
}

#[test]
fn what_is_sound_is_not_refused() {
    let sandbox = sandbox();
    for args in [["replay", "cycle.csv", "--out", "a"], ["replay", "trip.csv", "--out", "b"]] {
        sandbox.succeed(&args);
    }
    assert!(sandbox.names("a") == OUTPUTS && sandbox.names("b") == OUTPUTS);
}
