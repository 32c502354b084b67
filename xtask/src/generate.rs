//! Files that are made from others: the code that makes them is a program of the tests' crate.

use anyhow::Result;

use crate::shell::{cargo, run};

/// Writes `plant-core/src/presets/batteries.rs` from `data/batteries/*.toml`.
pub fn presets() -> Result<()> {
    generate("presets")?;
    run(cargo().args(["fmt", "-p", "plant-core"]))
}

/// Writes the synthetic trip and its true parameters into `data/trips/`.
pub fn trip() -> Result<()> {
    generate("trip")
}

fn generate(what: &str) -> Result<()> {
    run(cargo().args(["run", "--quiet", "-p", "voltstep-tests", "--bin", "generate", "--", what]))
}
