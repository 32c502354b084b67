//! Paths of the project that documents and comments name: they are there.
//!
//! What counts as one is a code span like `plant-core/src/port.rs`: with a slash, and with a first
//! folder that the project has or an ending that its files have. It may begin at the root of the
//! workspace, in the folder of the document, or in a crate or its `src`.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use pulldown_cmark::Event;

use crate::documents::{self, CRATES, Document};
use crate::firmware;

/// The endings of files that are kept.
const ENDINGS: &[&str] = &[
    "rs", "toml", "md", "csv", "svg", "h", "c", "mo", "py", "json", "yml", "sh", "txt", "x", "lock",
];
/// Made by the checks and not kept.
const MADE: &[&str] = &["target/", "out/"];

/// Fails where one of the documents names a path that is not there.
pub fn check(documents: &[Document]) -> Result<()> {
    let is_there = |path: &Path| firmware::root().join(path).exists();
    let missing: Vec<String> =
        documents.iter().flat_map(|document| missing(document, is_there)).collect();
    if missing.is_empty() {
        println!("the paths that {} files name are there", documents.len());
        return Ok(());
    }
    bail!("paths that are not there:\n  {}", missing.join("\n  "))
}

/// The paths that a document names and that are not there.
fn missing(document: &Document, is_there: impl Fn(&Path) -> bool) -> Vec<String> {
    let mut missing = Vec::new();
    for event in document.events() {
        let Event::Code(span) = event else { continue };
        let Some(path) = path(&span, &is_there) else { continue };
        let crates = CRATES.iter().flat_map(|name| {
            [PathBuf::from(name).join(path), PathBuf::from(name).join("src").join(path)]
        });
        let mut places =
            [PathBuf::from(path), document.folder().join(path)].into_iter().chain(crates);
        if !places.any(|place| documents::tidy(&place).is_some_and(|tidy| is_there(&tidy))) {
            missing.push(format!("{}: `{span}`", document.path.display()));
        }
    }
    missing
}

/// The path that a code span names, without a line number; none where it is something else.
fn path(span: &str, is_there: impl Fn(&Path) -> bool) -> Option<&str> {
    let path = match span.rsplit_once(':') {
        Some((path, line)) if line.chars().all(|c| c.is_ascii_digit()) => path,
        _ => span,
    };
    let named = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if !path.contains('/') || !path.chars().all(named) || path.starts_with('/') {
        return None;
    }
    if MADE.iter().any(|made| path.starts_with(made)) {
        return None;
    }
    let first = path.split('/').next().unwrap_or("");
    let ending = Path::new(path).extension().and_then(|end| end.to_str());
    let is_one = is_there(Path::new(first)) || ending.is_some_and(|end| ENDINGS.contains(&end));
    is_one.then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    const THERE: &[&str] = &[
        "plant-core",
        "plant-core/src/port.rs",
        "docs/src/udds.svg",
        "data",
        "data/cycles",
        "xtask",
        "xtask/src/arrows.rs",
    ];

    fn found(text: &str) -> Vec<String> {
        let document = Document { path: PathBuf::from("docs/src/x.md"), text: text.to_owned() };
        missing(&document, |path| THERE.iter().any(|there| path == Path::new(there)))
    }

    #[test]
    fn a_path_that_is_there() {
        let text = "`plant-core/src/port.rs` `port.rs:12` `src/port.rs:12` `data/cycles/` \
                    `../src/udds.svg` `arrows.rs`";
        assert!(found(text).is_empty(), "{:?}", found(text));
    }

    #[test]
    fn a_path_that_is_not() {
        for path in [
            "plant-core/src/ports.rs",
            "plant-core/source",
            "core/src/port.rs",
            "data/cycle",
            "mechanics/gone.rs:7",
            "docs/udds.svg",
        ] {
            let found = found(&format!("see `{path}`"));
            assert_eq!(found, [format!("docs/src/x.md: `{path}`")]);
        }
    }

    #[test]
    fn what_is_no_path() {
        let text = "`m/s` `N·s/m` `f(x)/g` `target/book/x.md` `data/batteries/*.toml` `x.rs` \
                    `--cells DIR`\n\n```text\nplant-core/gone.rs\n```\n";
        assert!(found(text).is_empty(), "{:?}", found(text));
    }
}
