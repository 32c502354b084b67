//! `voltstep soc`.

use serde_json::Value;

use super::measured::drive_cycle;
use super::{Sandbox, TRIP};

/// What every run says in JSON.
const KEYS: [&str; 16] = [
    "name",
    "battery",
    "case",
    "soc_span",
    "soc_rmse",
    "soc_max",
    "soc_rmse_after_300_s",
    "soc_max_after_300_s",
    "soc_error_end",
    "soc_sd_end",
    "soc_sd_mean",
    "convergence_s",
    "inside_3_sigma",
    "inside_3_sigma_identified",
    "outside_5_percent_s",
    "samples",
];

#[test]
fn compares_an_estimator_with_what_was_counted() {
    let sandbox = Sandbox::new();
    sandbox.write("own.csv", drive_cycle(0.0));
    for estimator in ["ekf", "coulomb"] {
        let args = ["soc", "own.csv", TRIP, "--rate-hz", "1", "--estimator", estimator];
        let table = sandbox.succeed(&args);
        for part in ["own", "synthetic", "as it is", "RMS [%]", "inside 3σ [%]"] {
            assert!(table.contains(part), "{part}: {table}");
        }
        let json = sandbox.succeed(&[&args[..], &["--json"]].concat());
        let report: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(report["estimator"], estimator);
        assert_eq!(report["rate_hz"], 1.0);
        let runs = report["runs"].as_array().unwrap();
        let said = |key: &str| runs.iter().map(|run| run[key].clone()).collect::<Vec<_>>();
        assert_eq!(said("name"), ["own", "synthetic"]);
        assert_eq!(said("battery"), ["panasonic-ncr18650pf", "bmw-i3-60ah"]);
        for run in runs {
            for key in KEYS {
                assert!(!run[key].is_null(), "{key}: {run}");
            }
            assert!(run["notes"].is_array() && run["case"]["initial_soc_error"] == 0.0, "{run}");
        }
        // Its own cell, and the start is told.
        assert!(runs[0]["soc_rmse"].as_f64().unwrap() < 0.005, "{}", runs[0]);
    }
}

#[test]
fn a_standard_deviation_that_is_not_honest_fails_the_matrix() {
    let sandbox = Sandbox::new();
    sandbox.write("own.csv", drive_cycle(0.0));
    // What no model of this cell expects, whatever else is wrong.
    sandbox.write("off.csv", drive_cycle(-0.3));
    let run = |file| sandbox.run(&["soc", file, "--rate-hz", "1", "--matrix"]);
    let own = run("own.csv");
    assert_eq!((own.code, own.stderr.as_str()), (Some(0), ""), "{}", own.stdout);
    assert!(own.stdout.contains("capacity -5 %"), "{}", own.stdout);
    let off = run("off.csv");
    assert_eq!((off.code, off.stderr.as_str()), (Some(1), ""), "{}", off.stdout);
    assert!(off.stdout.contains(" !"), "{}", off.stdout);
}

#[test]
fn refuses_bad_usage_and_bad_files() {
    let sandbox = Sandbox::new();
    sandbox.write("cycle.csv", "time_s,speed_m_s\n0,0\n1,1\n");
    sandbox.write("text.csv", drive_cycle(0.0).replacen("\n0,", "\n0,fast,", 1));
    for (args, part) in [
        (&["nowhere.csv"][..], "no such file or folder"),
        (&[TRIP, "--rate-hz", "0"], "--rate-hz 0"),
        (&[TRIP, "--initial-soc-error", "1.5"], "--initial-soc-error 1.5"),
        (&[TRIP, "--current-bias-a", "inf"], "--current-bias-a inf"),
        (&[TRIP, "--matrix", "--current-bias-a", "1"], "cannot be used with"),
        (&[TRIP, "--cell", "no-such-cell"], "no-such-cell"),
        (
            &["cycle.csv"],
            "cycle.csv:1:1: this is a driving cycle; expected a trip (columns `Time [s]`",
        ),
        (&["text.csv"], "7 fields; expected 6, as in the header"),
    ] {
        let run = sandbox.run(&[&["soc"], args].concat());
        assert_eq!(run.code, Some(2), "{args:?}: {}", run.stderr);
        assert!(run.stderr.contains(part), "{args:?}: {}", run.stderr);
        assert!(run.stdout.is_empty(), "{args:?}: {}", run.stdout);
    }
}
