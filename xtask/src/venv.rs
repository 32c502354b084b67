//! Pythons of the checks' own: virtual environments in the target folder.

use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::shell::program;

/// Nothing here may take longer: a network that does not answer must not hold up the checks.
pub const LONGEST: Duration = Duration::from_mins(3);

/// Whether a Python has a module.
pub fn has(python: &str, module: &str) -> bool {
    let mut import = program(python);
    import.args(["-c", &format!("import {module}")]);
    within(import.stdout(Stdio::null()).stderr(Stdio::null()), LONGEST).is_ok_and(|done| done)
}

/// The Python of a virtual environment with what `pip install` takes, or none where it cannot be
/// had. Where everything is there, pip asks nobody.
pub fn with(folder: &Path, wanted: &[&str]) -> Result<Option<String>> {
    let python = folder.join("bin/python").to_string_lossy().into_owned();
    if !Path::new(&python).exists() {
        let made = within(program("python3").args(["-m", "venv"]).arg(folder), LONGEST);
        if !made.is_ok_and(|made| made) {
            return Ok(None);
        }
    }
    let mut install = program(&python);
    install.args(["-m", "pip", "install", "-q", "--disable-pip-version-check"]);
    install.args(["--timeout", "15", "--retries", "1"]).args(wanted);
    Ok(within(&mut install, LONGEST)?.then_some(python))
}

/// Runs a command; whether it succeeded. One that takes longer is ended and did not.
pub fn within(command: &mut Command, longest: Duration) -> Result<bool> {
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
