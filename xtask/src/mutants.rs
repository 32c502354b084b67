//! Mutation testing: changes plant-core in one place after the other and sees whether a unit test
//! notices. What is left out, and the features, stand in `.cargo/mutants.toml`; what survives, and
//! why, in `docs/src/mutants.md`.

use std::fs;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

use crate::shell::cargo;

/// The least share of the viable mutants that must be noticed.
const CAUGHT: f64 = 0.9;
/// Where the outcomes are kept.
const OUTCOMES: &str = "target/mutants.out/outcomes.json";
/// Set to `k/n` to take only every n-th mutant, from the k-th, counted from 0: all take an hour.
const SHARD: &str = "VOLTSTEP_MUTANTS_SHARD";
/// Ways for cargo-mutants to end: all caught, some missed, some that never ended.
const FINISHED: [i32; 3] = [0, 2, 3];

/// Runs all mutants, or a share of them.
pub fn mutants() -> Result<()> {
    let mut command = cargo();
    command.args(["mutants", "-p", "plant-core", "--jobs", "2", "--output", "target"]);
    // What is not in git is large, and need not be copied.
    command.args(["--gitignore", "true"]);
    if let Ok(shard) = std::env::var(SHARD) {
        command.args(["--shard", &shard, "--sharding", "round-robin"]);
    }
    let status = command.status().context("cannot start cargo")?;
    if !status.code().is_some_and(|code| FINISHED.contains(&code)) {
        bail!("`cargo mutants` ended with {status}; `cargo install cargo-mutants` installs it");
    }
    let outcomes = fs::read_to_string(OUTCOMES).context(OUTCOMES)?;
    println!("{}", judge(&serde_json::from_str(&outcomes).context(OUTCOMES)?)?);
    Ok(())
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
    ensure!(share >= CAUGHT, "only {line}; see target/mutants.out/missed.txt");
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
}
