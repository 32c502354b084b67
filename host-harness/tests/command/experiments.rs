//! `voltstep experiment`.

use serde_json::Value;

use super::{OUTPUTS, Sandbox};

/// Each experiment, with columns that its trace has and words that its table has.
const EXPERIMENTS: [(&str, &[&str], &[&str]); 5] = [
    ("motor-step", &["voltage_v", "pasek_current_a", "moments_speed_rpm"], &["4.5", "1772"]),
    ("converter-bench", &["square_speed_rad_s", "sine_residual_j"], &["energy balance"]),
    ("udds-energy", &["soc_rate_percent_per_min", "residual_j"], &["0.743", "above 60"]),
    ("pmsm-start", &["speed_rad_s", "d_a", "q_a", "voltage_v"], &["closed form"]),
    ("pmsm-field-weakening", &["closed_form_d_a", "d_a", "shaft_w"], &["weakening current"]),
];

#[test]
fn each_shows_its_figures_and_leaves_its_files() {
    let sandbox = Sandbox::new();
    for (name, columns, words) in EXPERIMENTS {
        let table = sandbox.succeed(&["experiment", name]);
        for word in words.iter().chain(&["published", "target", "obtained", "pass"]) {
            assert!(table.contains(word), "{name}: no `{word}` in {table}");
        }
        assert!(!table.contains("FAIL"), "{table}");
        let folder = format!("out/{name}");
        assert!(table.contains(&folder) && sandbox.names(&folder) == OUTPUTS);

        let trace = sandbox.read(&format!("{folder}/trace.csv"));
        let mut lines = trace.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        assert_eq!(header[0], "time_s");
        for column in columns {
            assert!(header.contains(column), "{name}: no `{column}` in {header:?}");
        }
        let mut before = f64::NEG_INFINITY;
        for line in lines {
            let row: Vec<_> = line.split(',').collect();
            let time_s: f64 = row[0].parse().unwrap();
            assert!(row.len() == header.len() && time_s > before, "{name}: {line}");
            before = time_s;
        }
        assert!(before > 0.0, "{name}: no rows");
        let plot = sandbox.read(&format!("{folder}/report.svg"));
        assert!(plot.trim_end().ends_with("</svg>") && plot.contains(name), "{name}");

        let summary: Value =
            serde_json::from_str(&sandbox.read(&format!("{folder}/summary.json"))).unwrap();
        let figures = summary["figures"].as_array().unwrap();
        assert!(figures.iter().any(|f| f["pass"] == true) && summary["name"] == name, "{summary}");
    }
}

#[test]
fn json_and_another_folder() {
    let sandbox = Sandbox::new();
    let json = sandbox.succeed(&["experiment", "pmsm-start", "--json", "--out", "here"]);
    assert_eq!(json, sandbox.read("here/summary.json"));
    assert_eq!(sandbox.names("."), ["here"]);
    let summary: Value = serde_json::from_str(&json).unwrap();
    assert!(summary["source"].as_str().unwrap().starts_with("EPowertrain2025"), "{summary}");
}

#[test]
fn without_a_name_they_are_listed() {
    let sandbox = Sandbox::new();
    let list = sandbox.succeed(&["experiment"]);
    for (name, ..) in EXPERIMENTS {
        assert!(list.lines().any(|l| l.starts_with(name)), "{name}: {list}");
    }
    assert!(sandbox.names(".").is_empty());
}

#[test]
fn an_unknown_name_tells_what_there_is() {
    let sandbox = Sandbox::new();
    let run = sandbox.run(&["experiment", "motor-stop"]);
    assert_eq!((run.code, run.stdout.as_str(), run.stderr.lines().count()), (Some(2), "", 1));
    for piece in ["no such experiment", "did you mean `motor-step`?"] {
        assert!(run.stderr.contains(piece), "{}", run.stderr);
    }
    for (name, ..) in EXPERIMENTS {
        assert!(run.stderr.contains(name), "{}", run.stderr);
    }
    assert!(sandbox.names(".").is_empty());
}
