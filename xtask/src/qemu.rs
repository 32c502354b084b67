//! Images in QEMU, and what they say there.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Context, Result};

use crate::shell::{output, program};

/// The machine that most images run on: its processor, its name.
pub const MPS2_AN386: &[&str] = &["-cpu", "cortex-m4", "-machine", "mps2-an386"];

/// Runs an image to its end on a machine; what it said.
pub fn run(machine: &[&str], elf: &Path, more: &[impl AsRef<OsStr>]) -> Result<String> {
    output(
        program("qemu-system-arm")
            .args(machine)
            .args(["-nographic", "-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(elf)
            .args(more),
    )
}

/// The rest of the line that begins with these words, in what an image said.
pub fn line<'a>(said: &'a str, words: &str) -> Result<&'a str> {
    said.lines()
        .find_map(|line| line.strip_prefix(words)?.strip_prefix(' '))
        .with_context(|| format!("the image says nothing of `{words}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_by_its_first_words() {
        let said = "soc 1\nresult hash ff soc 0.7\n";
        assert_eq!(line(said, "result").unwrap(), "hash ff soc 0.7");
        assert_eq!(line(said, "result hash").unwrap(), "ff soc 0.7");
        assert!(line(said, "res").is_err() && line(said, "hash").is_err());
    }
}
