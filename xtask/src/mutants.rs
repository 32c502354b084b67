//! Mutation testing: changes plant-core, and what protects in voltstep-bms, in one place after the
//! other and sees whether a unit test notices. What is looked at, and the features, stand in
//! `.cargo/mutants.toml` and `.cargo/mutants-bms.toml`; what survives, and why, in
//! `docs/src/mutants.md`.

use std::fs;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::shell::cargo;

/// The least share of the viable mutants that must be noticed.
const CAUGHT: f64 = 0.9;
/// Package, settings, and where `mutants.out` goes.
const OF: [(&str, &str, &str); 2] = [
    ("plant-core", ".cargo/mutants.toml", "target"),
    ("voltstep-bms", ".cargo/mutants-bms.toml", "target/mutants-bms"),
];
/// Set to one of the packages to take it alone.
const PACKAGE: &str = "VOLTSTEP_MUTANTS_OF";
/// Set to `k/n` to take only every n-th mutant, from the k-th, counted from 0: all take hours.
const SHARD: &str = "VOLTSTEP_MUTANTS_SHARD";
/// Ways for cargo-mutants to end: all caught, some missed, some that never ended.
const FINISHED: [i32; 3] = [0, 2, 3];

/// Runs all mutants, or a share of them.
pub fn mutants() -> Result<()> {
    for (package, settings, folder) in chosen(std::env::var(PACKAGE).ok().as_deref())? {
        let mut command = cargo();
        // One at a time: the tests of voltstep-bms take both cores of a small machine.
        command.args(["mutants", "-p", package, "--config", settings, "--jobs", "1"]);
        // What is not in git is large, and need not be copied.
        command.args(["--output", folder, "--gitignore", "true"]);
        if let Ok(shard) = std::env::var(SHARD) {
            command.args(["--shard", &shard, "--sharding", "round-robin"]);
        }
        fs::create_dir_all(folder).context(folder)?;
        let status = command.status().context("cannot start cargo")?;
        if !status.code().is_some_and(|code| FINISHED.contains(&code)) {
            bail!("`cargo mutants` ended with {status}; `cargo install cargo-mutants` installs it");
        }
        let outcomes = format!("{folder}/mutants.out/outcomes.json");
        let text = fs::read_to_string(&outcomes).context(outcomes.clone())?;
        let line = judge(&serde_json::from_str(&text).context(outcomes)?)
            .with_context(|| format!("{package}; see {folder}/mutants.out/missed.txt"))?;
        println!("{package}: {line}");
    }
    Ok(())
}

/// All of them, or the one that is named.
fn chosen(package: Option<&str>) -> Result<Vec<(&'static str, &'static str, &'static str)>> {
    let chosen: Vec<_> = OF
        .into_iter()
        .filter(|(name, ..)| package.is_none_or(|package| package == *name))
        .collect();
    ensure!(!chosen.is_empty(), "{PACKAGE}: one of plant-core, voltstep-bms");
    Ok(chosen)
}

/// The figures in a line; fails where too few are caught. One that never ends is caught: no test
/// run would pass with it.
fn judge(outcomes: &Value) -> Result<String> {
    let count = |name: &str| outcomes[name].as_u64().with_context(|| format!("no `{name}`"));
    let (caught, missed) = (count("caught")? + count("timeout")?, count("missed")?);
    let viable = caught + missed;
    ensure!(viable > 0, "no mutant was viable");
    #[expect(clippy::cast_precision_loss, reason = "there are a few thousand")]
    let share = caught as f64 / viable as f64;
    let line = format!(
        "{caught} of {viable} viable mutants caught, {:.1} %; {} did not compile",
        100.0 * share,
        count("unviable")?
    );
    ensure!(share >= CAUGHT, "only {line}");
    Ok(line)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn nine_of_ten_must_be_caught() {
        let outcomes = |caught: u32, timeout: u32, missed: u32| json!({"caught": caught, "timeout": timeout, "missed": missed, "unviable": 3});
        let line = judge(&outcomes(88, 2, 10)).unwrap();
        assert_eq!(line, "90 of 100 viable mutants caught, 90.0 %; 3 did not compile");
        let error = judge(&outcomes(88, 1, 11)).unwrap_err().to_string();
        assert!(error.contains("only 89 of 100"), "{error}");
        assert!(judge(&outcomes(0, 0, 0)).is_err() && judge(&json!({})).is_err());
    }

    #[test]
    fn one_package_alone_or_all() {
        let names = |package| chosen(package).map(|of| of.iter().map(|(name, ..)| *name).collect());
        let names = |package| -> Option<Vec<_>> { names(package).ok() };
        assert_eq!(names(None).unwrap(), ["plant-core", "voltstep-bms"]);
        assert_eq!(names(Some("voltstep-bms")).unwrap(), ["voltstep-bms"]);
        assert_eq!(names(Some("voltstep")), None);
    }
}
