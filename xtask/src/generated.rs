//! What a command prints and a document shows, and the plots of the documents.
//!
//! A block stands between `<!-- generated: ARGUMENTS -->` and `<!-- end -->`, in any of the
//! documents; it holds what `voltstep ARGUMENTS` prints, without the lines that differ from run to
//! run.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::documents;
use crate::firmware;
use crate::metadata::Metadata;
use crate::shell::{cargo, output};

/// The commands whose plot sheets the documents show, and where these are kept.
const PLOTS: &[(&str, &str)] = &[
    ("replay udds", "docs/src/udds.svg"),
    ("experiment motor-step", "docs/src/experiments/motor-step.svg"),
    ("experiment converter-bench", "docs/src/experiments/converter-bench.svg"),
    ("experiment udds-energy", "docs/src/experiments/udds-energy.svg"),
    ("experiment pmsm-start", "docs/src/experiments/pmsm-start.svg"),
    ("experiment pmsm-field-weakening", "docs/src/experiments/pmsm-field-weakening.svg"),
    ("experiment precharge", "docs/src/experiments/precharge.svg"),
    ("experiment buck-converter", "docs/src/experiments/buck-converter.svg"),
    ("experiment boost-converter", "docs/src/experiments/boost-converter.svg"),
    ("experiment h-bridge-motor", "docs/src/experiments/h-bridge-motor.svg"),
    ("experiment bridge-start", "docs/src/experiments/bridge-start.svg"),
    ("experiment bridge-open-transistor", "docs/src/experiments/bridge-open-transistor.svg"),
    ("experiment bridge-shorted-transistor", "docs/src/experiments/bridge-shorted-transistor.svg"),
];
/// The block that holds the accuracy table, and the cases of `voltstep validate` that it shows.
const ACCURACY: &str = "validate --json";
const CASES: &[&str] = &[
    "UDDS, epowertrain-udds",
    "DC motor step, Pasek, with static torque",
    "converter bench, sine",
];
/// A battery with a larger capacity is a pack, of which trips are known \[A·h\].
const CELL_AH: f64 = 10.0;
/// The block that holds how far identified batteries are from files that they were not made from,
/// and the files that say so.
const BATTERIES: (&str, [&str; 2]) =
    ("data/batteries", ["panasonic-ncr18650pf.toml", "bmw-i3-60ah.toml"]);
const BEGIN: &str = "<!-- generated: ";
const END: &str = "<!-- end -->";

/// Brings blocks and plot up to date; fails where they were not, so that a stale figure cannot pass
/// unseen.
pub fn generated() -> Result<()> {
    let folder = Metadata::load()?.target_directory()?.join("xtask-generated");
    let mut stale = Vec::new();
    for document in documents::all()? {
        let new = filled(&document.text, |arguments| block(arguments, &folder))
            .with_context(|| document.path.display().to_string())?;
        if document.replace(&new)? {
            stale.push(document.path.display().to_string());
        }
    }
    for &(arguments, kept) in PLOTS {
        let plot = folder.join(folder_name(arguments)).join("report.svg");
        let plot = fs::read_to_string(plot)
            .with_context(|| format!("no document shows what `voltstep {arguments}` prints"))?;
        if fs::read_to_string(firmware::root().join(kept)).ok().as_ref() != Some(&plot) {
            fs::write(firmware::root().join(kept), plot)?;
            stale.push(kept.to_owned());
        }
    }
    ensure!(
        stale.is_empty(),
        "out of date: {}; brought up to date now: look at it and commit it",
        stale.join(", ")
    );
    Ok(())
}

/// What stands in a block.
fn block(arguments: &str, folder: &Path) -> Result<String> {
    match arguments {
        ACCURACY => {
            // Without the real measurements, so that it is the same for everybody.
            let mut command = cargo();
            command.args(["run", "--quiet", "--release", "--", "validate", "--json"]);
            accuracy(&output(command.env_remove(crate::data::VARIABLE))?)
        }
        _ if arguments == BATTERIES.0 => held_out(),
        _ => voltstep(arguments, &folder.join(folder_name(arguments))),
    }
}

/// A folder for what a command writes.
fn folder_name(arguments: &str) -> String {
    arguments.replace(['/', ' ', '.'], "-")
}

fn voltstep(arguments: &str, out: &Path) -> Result<String> {
    let mut command = cargo();
    command.args(["run", "--quiet", "--release", "--"]).args(arguments.split(' '));
    if PLOTS.iter().any(|plot| plot.0 == arguments) || arguments.starts_with("replay ") {
        command.arg("--out").arg(out);
    }
    output(&mut command)
}

/// The accuracy table, from the report of `voltstep validate --json`.
fn accuracy(json: &str) -> Result<String> {
    let report: Value = serde_json::from_str(json).context("the report is no JSON")?;
    let cases = report["cases"].as_array().context("the report has no cases")?;
    let number = |value: &Value| {
        value.as_f64().map_or_else(String::new, |x| {
            let text = format!("{x:.6}");
            if x != 0.0 && x.abs() < 1e-4 { format!("{x:.1e}") } else { shortened(&text) }
        })
    };
    let mut table =
        String::from("| | target | obtained | tolerance | source |\n|---|--:|--:|--:|---|\n");
    for name in CASES {
        let rows = cases.iter().filter(|c| c["name"] == *name && c["pass"].is_boolean());
        let before = table.len();
        for (i, case) in rows.enumerate() {
            if i == 0 {
                table += &format!("| **{name}** | | | | |\n");
            }
            table += &format!(
                "| {} | {} | {} | {} | {} |\n",
                case["quantity"].as_str().unwrap_or(""),
                number(&case["target"]),
                number(&case["obtained"]),
                number(&case["tolerance"]),
                case["source"].as_str().unwrap_or(""),
            );
        }
        ensure!(table.len() > before, "the report has no case `{name}`");
    }
    let count =
        |what: &str| cases.iter().filter(|c| c["pass"].as_bool() == Some(what == "passed")).count();
    table += &format!("\n{} checks passed, {} failed.", count("passed"), count("failed"));
    Ok(table)
}

/// The table of the cross-validations: a row for each test of a cell, one for all trips of a pack.
fn held_out() -> Result<String> {
    let mut table = String::from(
        "| left out of the fit | voltage above 15 % SOC | above 25 % SOC |\n|---|--:|--:|\n",
    );
    for file in BATTERIES.1 {
        let path = Path::new(BATTERIES.0).join(file);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let battery: toml::Table = text.parse().with_context(|| path.display().to_string())?;
        let found = &battery["fit"]["cross_validation"];
        let rows = found["held_out"].as_array().context("no list of what was left out")?;
        let number = |value: &toml::Value| value.as_float().context("no number");
        if battery["battery"]["capacity_ah"].as_float().is_some_and(|q| q > CELL_AH) {
            table += &format!(
                "| `{}`, {} trips | median {:.2} V, 90th percentile {:.2} V | |\n",
                battery["name"].as_str().unwrap_or(""),
                rows.len(),
                number(&found["voltage_rmse_v_median"])?,
                number(&found["voltage_rmse_v_p90"])?,
            );
            continue;
        }
        for row in rows {
            table += &format!(
                "| `{}`, {} | {:.1} mV | {:.1} mV |\n",
                battery["name"].as_str().unwrap_or(""),
                row["name"].as_str().unwrap_or(""),
                1000.0 * number(&row["above_15_soc"])?,
                1000.0 * number(&row["above_25_soc"])?,
            );
        }
    }
    Ok(table)
}

/// A decimal without zeros at its end.
fn shortened(number: &str) -> String {
    number.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What is the same in every run: not the time it took, nor where its files are.
fn steady(printed: &str) -> String {
    let lines =
        printed.lines().filter(|line| !(line.contains("times real time") || says_where(line)));
    lines.collect::<Vec<_>>().join("\n").trim().to_owned()
}

/// The text with every block filled by what its command prints.
fn filled(text: &str, mut run: impl FnMut(&str) -> Result<String>) -> Result<String> {
    let mut new = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(BEGIN) {
        let Some((arguments, body)) = after.split_once(" -->") else {
            bail!("a generated block has no end of its first line");
        };
        let Some((_, tail)) = body.split_once(END) else {
            bail!("the generated block `{arguments}` has no end");
        };
        let block = steady(&run(arguments)?);
        // A table of Markdown stands as it is, what a terminal shows within a fence.
        let block = if block.starts_with('|') { block } else { format!("```text\n{block}\n```") };
        new += &format!("{before}{BEGIN}{arguments} -->\n{block}\n{END}");
        rest = tail;
    }
    Ok(new + rest)
}

/// Whether a line says in which folder a command left its files.
fn says_where(line: &str) -> bool {
    line.contains("summary.json") && line.contains(" are in ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a\n<!-- generated: replay x -->\nold\n<!-- end -->\nz\n";

    #[test]
    fn fills_a_block_with_what_stays_the_same() {
        let printed = "x in 0.1 s (9 times real time)\ntable\n\nreport.html, summary.json and trace.csv are in out\n";
        let new = filled(TEXT, |arguments| {
            assert_eq!(arguments, "replay x");
            Ok(printed.to_owned())
        });
        let expected = "a\n<!-- generated: replay x -->\n```text\ntable\n```\n<!-- end -->\nz\n";
        assert_eq!(new.unwrap(), expected);
        let again = filled(expected, |_| Ok(printed.to_owned()));
        assert_eq!(again.unwrap(), expected);
    }

    #[test]
    fn the_accuracy_table_shows_its_cases_or_fails() {
        let case = |name: &str| {
            format!(
                r#"{{"name":"{name}","quantity":"q","target":0.5,"obtained":0.25,"tolerance":1e-6,"source":"s","pass":true}}"#
            )
        };
        let all: Vec<_> = CASES.iter().map(|name| case(name)).collect();
        let table = accuracy(&format!(r#"{{"cases":[{}]}}"#, all.join(","))).unwrap();
        assert!(table.contains("| q | 0.5 | 0.25 | 1.0e-6 | s |"), "{table}");
        assert!(table.ends_with("3 checks passed, 0 failed."));
        assert!(accuracy(&format!(r#"{{"cases":[{}]}}"#, all[0])).is_err());
    }

    #[test]
    fn a_block_without_an_end_is_an_error() {
        let cut = TEXT.replace(END, "");
        assert!(filled(&cut, |_| Ok(String::new())).is_err());
    }
}
