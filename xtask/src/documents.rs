//! The documents of the project, and what is in them.

use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result};
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

use crate::firmware;

/// The pages of the book.
pub const BOOK: &str = "docs/src";
/// The folders whose Markdown files are documents: the one list for generated figures, links and
/// paths.
const FOLDERS: &[&str] = &[
    "",
    BOOK,
    "docs/src/models",
    "plant-core",
    "bms",
    "host-harness",
    "capi",
    "firmware-example",
    "data/cycles",
];

/// The folders of the crates; those within another come with it.
pub const CRATES: &[&str] = &[
    "plant-core",
    "bms",
    "capi",
    "host-harness",
    "tests",
    "xtask",
    "fuzz",
    "firmware-example",
    "firmware-example/trace",
    "firmware-example/bench",
    "firmware-example/keep-all",
];
/// One document.
pub struct Document {
    /// From the root of the workspace.
    pub path: PathBuf,
    pub text: String,
}

impl Document {
    /// The folder that its relative links begin in.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// What it is made of.
    pub fn events(&self) -> Parser<'_> {
        events(&self.text)
    }

    /// Writes a new text if it is another one, and says whether it was.
    pub fn replace(&self, text: &str) -> Result<bool> {
        if text == self.text {
            return Ok(false);
        }
        let path = firmware::root().join(&self.path);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
        Ok(true)
    }

    /// The anchors of its headings, as GitHub and mdBook make them.
    pub fn anchors(&self) -> Vec<String> {
        let mut anchors: Vec<String> = Vec::new();
        let mut heading: Option<String> = None;
        for event in self.events() {
            match event {
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => {
                    let anchor = anchor(&heading.take().unwrap_or_default());
                    let same = anchors.iter().filter(|other| **other == anchor).count();
                    anchors.push(if same > 0 { format!("{anchor}-{same}") } else { anchor });
                }
                Event::Text(text) | Event::Code(text) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&text);
                    }
                }
                _ => {}
            }
        }
        anchors
    }
}

/// Markdown with tables and equations.
pub fn events(text: &str) -> Parser<'_> {
    Parser::new_ext(text, Options::ENABLE_TABLES | Options::ENABLE_MATH)
}

fn anchor(heading: &str) -> String {
    heading
        .chars()
        .filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c if c.is_alphanumeric() => Some(c.to_ascii_lowercase()),
            _ => None,
        })
        .collect()
}

/// Every document, in alphabetical order within its folder.
pub fn all() -> Result<Vec<Document>> {
    let mut documents = Vec::new();
    for folder in FOLDERS {
        for path in files(Path::new(folder), "md")? {
            let text = fs::read_to_string(firmware::root().join(&path))?;
            documents.push(Document { path, text });
        }
    }
    Ok(documents)
}

/// The comments of every Rust file, as documents.
pub fn comments() -> Result<Vec<Document>> {
    let mut documents = Vec::new();
    for folder in CRATES.iter().filter(|folder| !folder.contains('/')) {
        for path in sources(Path::new(folder))? {
            let text = comments_of(&fs::read_to_string(firmware::root().join(&path))?);
            documents.push(Document { path, text });
        }
    }
    Ok(documents)
}

/// The lines of comments in a source, those apart from each other by an empty line.
fn comments_of(source: &str) -> String {
    let lines = source.lines().map(|line| {
        let comment = line.trim_start().strip_prefix("//").unwrap_or("");
        let comment = comment.strip_prefix(['/', '!']).unwrap_or(comment);
        comment.strip_prefix(' ').unwrap_or(comment)
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The files of a folder that end so, in alphabetical order; paths from the root of the workspace.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let place = firmware::root().join(folder);
    let entries = fs::read_dir(&place).with_context(|| format!("no {}", place.display()))?;
    let mut paths = Vec::new();
    for entry in entries {
        let entry = entry?;
        let name = PathBuf::from(entry.file_name());
        if entry.file_type()?.is_file() && name.extension().is_some_and(|end| end == ending) {
            paths.push(folder.join(name));
        }
    }
    paths.sort();
    Ok(paths)
}

/// The Rust files below a folder, build products aside, folder after folder.
pub fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = files(folder, "rs")?;
    let place = firmware::root().join(folder);
    let mut folders = Vec::new();
    for entry in fs::read_dir(place)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() && entry.file_name() != "target" {
            folders.push(folder.join(entry.file_name()));
        }
    }
    folders.sort();
    for folder in folders {
        paths.extend(sources(&folder)?);
    }
    Ok(paths)
}

/// A path without `.` and `..`; none where it leads out of the workspace.
pub fn tidy(path: &Path) -> Option<PathBuf> {
    let mut tidy = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                if !tidy.pop() {
                    return None;
                }
            }
            Component::Normal(name) => tidy.push(name),
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(tidy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_those_of_github() {
        let text = "# What a `replay` prints\n\n## On target: 1 kHz\n\n## On target: 1 kHz\n";
        let document = Document { path: PathBuf::from("x.md"), text: text.to_owned() };
        assert_eq!(
            document.anchors(),
            ["what-a-replay-prints", "on-target-1-khz", "on-target-1-khz-1"]
        );
    }

    #[test]
    fn the_comments_of_a_source_and_nothing_else() {
        let source = "//! See `a`.\n//!\n//! Also.\nuse x; // not `b`\n    /// `c`\n    // `d`\n";
        assert_eq!(comments_of(source), "See `a`.\n\nAlso.\n\n`c`\n`d`");
    }

    #[test]
    fn a_path_stays_within_the_workspace() {
        assert_eq!(tidy(Path::new("docs/src/../x/./y")), Some(PathBuf::from("docs/x/y")));
        assert_eq!(tidy(Path::new("docs/../../x")), None);
        assert_eq!(tidy(Path::new("/x")), None);
    }

    #[test]
    fn the_documents_are_found() {
        let documents = all().unwrap();
        for path in ["README.md", "docs/src/references.md"] {
            assert!(documents.iter().any(|d| d.path == Path::new(path)), "{path}");
        }
        assert!(sources(Path::new("xtask")).unwrap().contains(&PathBuf::from("xtask/src/main.rs")));
    }
}
