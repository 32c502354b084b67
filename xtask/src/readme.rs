//! The parts of the README that a command prints, and its plot.
//!
//! A block stands between `<!-- generated: ARGUMENTS -->` and `<!-- end -->`; it holds what
//! `voltstep ARGUMENTS` prints, without the lines that differ from run to run.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use crate::metadata::Metadata;
use crate::shell::{cargo, output};

const README: &str = "README.md";
/// The replay whose plot sheet the README shows, and where it is kept.
const PLOT: (&str, &str) = ("replay udds", "docs/udds.svg");
const BEGIN: &str = "<!-- generated: ";
const END: &str = "<!-- end -->";

/// Brings README and plot up to date; fails where they were not, so that a stale figure cannot
/// pass unseen.
pub fn readme() -> Result<()> {
    let folder = Metadata::load()?.target_directory()?.join("xtask-readme");
    let old = fs::read_to_string(README).context("cannot read the README")?;
    let new = filled(&old, |arguments| {
        let out = folder.join(arguments.replace(['/', ' ', '.'], "-"));
        let printed = voltstep(arguments, &out)?;
        if arguments == PLOT.0 {
            let plot = fs::read_to_string(out.join("report.svg"))?;
            replace(Path::new(PLOT.1), &plot)?;
        }
        Ok(printed)
    })?;
    replace(Path::new(README), &new)?;
    ensure!(
        new == old,
        "the README was out of date; it is brought up to date now: look at it and commit it"
    );
    Ok(())
}

/// Writes a file if its content differs.
fn replace(path: &Path, content: &str) -> Result<()> {
    if fs::read_to_string(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, content).with_context(|| format!("cannot write {}", path.display()))
}

fn voltstep(arguments: &str, out: &Path) -> Result<String> {
    output(
        cargo()
            .args(["run", "--quiet", "--release", "--"])
            .args(arguments.split(' '))
            .arg("--out")
            .arg(out),
    )
}

/// What is the same in every run: not the time it took, nor where its files are.
fn steady(printed: &str) -> String {
    let lines = printed
        .lines()
        .filter(|line| !(line.contains("times real time") || line.starts_with("summary.json, ")));
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
        new += &format!("{before}{BEGIN}{arguments} -->\n```text\n{block}\n```\n{END}");
        rest = tail;
    }
    Ok(new + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a\n<!-- generated: replay x -->\nold\n<!-- end -->\nz\n";

    #[test]
    fn fills_a_block_with_what_stays_the_same() {
        let printed =
            "x in 0.1 s (9 times real time)\ntable\n\nsummary.json, trace.csv are in out\n";
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
    fn a_block_without_an_end_is_an_error() {
        let cut = TEXT.replace(END, "");
        assert!(filled(&cut, |_| Ok(String::new())).is_err());
    }
}
