//! The messages of the CAN maps, read by `cantools` from the DBC files alone.

use std::fs::{self, File};
use std::path::Path;

use anyhow::{Result, bail};

use crate::metadata::Metadata;
use crate::shell::{cargo, output, program};
use crate::venv::{self, LONGEST, within};

/// What reads them.
const CANTOOLS: &str = "cantools==45.1.0";

const NOTICE: &str = "
********************************************************************************
*  SKIPPED: the DBC files are not read by cantools. No Python that has it could *
*  be set up (python3 with venv, and PyPI); VOLTSTEP_PYTHON may name one.       *
********************************************************************************
";

/// Writes every message by the code, reads it by `cantools`, compares.
pub fn dbc() -> Result<()> {
    let target = Metadata::load()?.target_directory()?;
    let Some(python) = python(&target.join("xtask-cantools"))? else {
        println!("{NOTICE}");
        return Ok(());
    };
    let shown =
        output(cargo().args(["run", "-q", "-p", "voltstep-bms", "--example", "can_messages"]))?;
    let messages = target.join("xtask-can-messages.txt");
    fs::write(&messages, shown)?;
    let mut check = program(&python);
    check.args(["xtask/check_dbc.py", "data/voltstep.dbc", "data/inverter.dbc"]);
    if !within(check.stdin(File::open(&messages)?), LONGEST)? {
        bail!("the DBC files and the code do not say the same, see above");
    }
    Ok(())
}

/// A Python that has `cantools`: that of the user, or one set up in a folder, or none.
fn python(folder: &Path) -> Result<Option<String>> {
    match std::env::var("VOLTSTEP_PYTHON") {
        Ok(own) if venv::has(&own, "cantools") => Ok(Some(own)),
        _ => venv::with(folder, &[CANTOOLS]),
    }
}
