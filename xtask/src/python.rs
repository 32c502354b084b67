//! The Python package: its wheel is built, installed and tested, its notebook run.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::metadata::Metadata;
use crate::shell::{cargo, program, run};
use crate::venv;

/// The versions of what it needs.
const REQUIREMENTS: &str = "python/requirements.txt";

const NOTICE: &str = "
********************************************************************************
*  SKIPPED: the Python package is not tested. What it needs could not be set   *
*  up: python3 with venv, and PyPI.                                            *
********************************************************************************
";

/// Builds the wheel, installs it in an environment of its own, runs its tests against the command.
pub fn python() -> Result<()> {
    let target = Metadata::load()?.target_directory()?;
    let Some(python) = venv::with(&target.join("xtask-python"), &["-r", REQUIREMENTS])? else {
        println!("{NOTICE}");
        return Ok(());
    };
    run(cargo().args(["build", "--release", "-p", "voltstep"]))?;
    let wheels = target.join("xtask-wheels");
    // The only wheel there is the one that was built.
    if wheels.exists() {
        fs::remove_dir_all(&wheels)?;
    }
    run(program(&python)
        .args(["-m", "maturin", "build", "-m", "python/Cargo.toml", "--out"])
        .arg(&wheels))?;
    let install = ["-m", "pip", "install", "-q", "--no-deps", "--force-reinstall"];
    run(program(&python).args(install).arg(wheel(&wheels)?))?;
    run(program(&python)
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "python/tests"])
        .env("VOLTSTEP_COMMAND", target.join("release/voltstep")))
}

/// The wheel in a folder; it must do for every Python from the oldest on.
fn wheel(folder: &Path) -> Result<PathBuf> {
    let found = fs::read_dir(folder)?.filter_map(|entry| Some(entry.ok()?.path()));
    let wheel = found
        .into_iter()
        .find(|path| path.extension() == Some(OsStr::new("whl")))
        .with_context(|| format!("maturin left no wheel in {}", folder.display()))?;
    let name = wheel.to_string_lossy();
    ensure!(name.contains("-cp310-abi3-"), "{name} is for one version of Python only");
    Ok(wheel)
}
