//! Keys of sources, such as `Plett2011`: what a document or a comment cites is in the list.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result, bail};
use pulldown_cmark::{Event, Tag, TagEnd};

use crate::documents::Document;

/// The list.
const REFERENCES: &str = "docs/src/references.md";

/// Fails where one of the documents cites a key that the list does not have.
pub fn check(documents: &[Document]) -> Result<()> {
    let references = documents.iter().find(|d| d.path == Path::new(REFERENCES));
    let keys = keys(references.with_context(|| format!("no {REFERENCES}"))?);
    let unknown: Vec<String> = documents
        .iter()
        .flat_map(|document| {
            let unknown = cited(&document.text).filter(|key| !keys.contains(*key));
            unknown.map(|key| format!("{}: {key}", document.path.display())).collect::<Vec<_>>()
        })
        .collect();
    if unknown.is_empty() {
        println!("what is cited is among the {} references", keys.len());
        return Ok(());
    }
    bail!("not in {REFERENCES}:\n  {}", unknown.join("\n  "))
}

/// The code spans in the first column of the list's tables.
fn keys(references: &Document) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    let mut column = 0;
    for event in references.events() {
        match event {
            Event::Start(Tag::TableRow) => column = 0,
            Event::End(TagEnd::TableCell) => column += 1,
            Event::Code(key) if column == 0 => {
                keys.insert(key.to_string());
            }
            _ => {}
        }
    }
    keys
}

/// The words of a text that are made like a key: a name, a year, and what tells two of a year apart.
fn cited(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| {
        let letters = word.chars().take_while(char::is_ascii_alphabetic).count();
        let year = word.get(letters..letters + 4).and_then(|year| year.parse::<u32>().ok());
        letters >= 3
            && word.starts_with(|c: char| c.is_ascii_uppercase())
            && word[1..letters].contains(|c: char| c.is_ascii_lowercase())
            && year.is_some_and(|year| (1800..2100).contains(&year))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn document(path: &str, text: &str) -> Document {
        Document { path: PathBuf::from(path), text: text.to_owned() }
    }

    const LIST: &str = "# References\n\nAs `[Other1999]`.\n\n| Key | Source |\n|---|---|\n\
                        | `Plett2011` | G. L. Plett, `x` |\n| `Other1999` | y |\n";

    #[test]
    fn what_is_cited_is_in_the_list_or_named() {
        let list = || document(REFERENCES, LIST);
        let good = document("bms/src/x.rs", "after Plett2011, eq. 28, and [Other1999]");
        assert!(check(&[list(), good]).is_ok());
        let bad = document("bms/src/x.rs", "Plett2011 and Plett2004Part3");
        let error = check(&[list(), bad]).unwrap_err().to_string();
        assert!(error.ends_with("bms/src/x.rs: Plett2004Part3"), "{error}");
        assert!(check(&[document("README.md", "")]).is_err(), "no list");
    }

    #[test]
    fn what_is_no_key() {
        let text = "UDDS in 2025, CRC1234567, NCR18650PF, T2024, Nucleo F411RE, m2000, ISO26262";
        assert_eq!(cited(text).collect::<Vec<_>>(), [""; 0]);
    }
}
