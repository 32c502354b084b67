//! The messages of the CAN maps, read by `cantools` from the DBC files alone.

use std::fs::{self, File};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::metadata::Metadata;
use crate::shell::{cargo, output, program};

/// What reads them.
const CANTOOLS: &str = "cantools==45.1.0";
/// Nothing here may take longer: a network that does not answer must not hold up the checks.
const LONGEST: Duration = Duration::from_mins(3);

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
fn python(folder: &std::path::Path) -> Result<Option<String>> {
    let has = |python: &str| {
        let mut import = program(python);
        let quiet =
            import.args(["-c", "import cantools"]).stdout(Stdio::null()).stderr(Stdio::null());
        within(quiet, LONGEST).is_ok_and(|imported| imported)
    };
    if let Ok(own) = std::env::var("VOLTSTEP_PYTHON")
        && has(&own)
    {
        return Ok(Some(own));
    }
    let inside = folder.join("bin/python").to_string_lossy().into_owned();
    if has(&inside) {
        return Ok(Some(inside));
    }
    let made = within(program("python3").args(["-m", "venv"]).arg(folder), LONGEST);
    if !made.is_ok_and(|made| made) {
        return Ok(None);
    }
    let mut install = program(&inside);
    install.args(["-m", "pip", "install", "-q", "--timeout", "15", "--retries", "1", CANTOOLS]);
    let installed = within(&mut install, LONGEST)?;
    Ok((installed && has(&inside)).then_some(inside))
}

/// Runs a command; whether it succeeded. One that takes longer is ended and did not.
fn within(command: &mut Command, longest: Duration) -> Result<bool> {
    let mut child = command.spawn().context("cannot start it")?;
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status.success());
        }
        if start.elapsed() > longest {
            child.kill()?;
            child.wait()?;
            return Ok(false);
        }
        thread::sleep(Duration::from_millis(20));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_too_long_is_ended() {
        let start = Instant::now();
        let short = Duration::from_millis(100);
        assert!(!within(Command::new("sleep").arg("30"), short).unwrap());
        assert!(start.elapsed() < Duration::from_secs(10));
        assert!(within(&mut Command::new("true"), LONGEST).unwrap());
        assert!(!within(&mut Command::new("false"), LONGEST).unwrap());
        assert!(within(&mut Command::new("/nowhere/python"), LONGEST).is_err());
    }
}
