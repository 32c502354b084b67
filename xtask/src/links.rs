//! Links of the documents: what they lead to is there. Links to elsewhere are only looked at, not
//! followed: a check has to give the same result without a network.

use std::path::Path;

use anyhow::{Result, bail};
use pulldown_cmark::{Event, Tag};

use crate::documents::{self, BOOK, Document};
use crate::firmware;

const SUMMARY: &str = "docs/src/SUMMARY.md";

/// Fails where a link of a document leads nowhere, or a page is not in the book's table of contents.
pub fn check(documents: &[Document]) -> Result<()> {
    let is_there = |path: &Path| firmware::root().join(path).exists();
    let mut faults = Vec::new();
    for document in documents {
        faults.extend(faults_of(document, documents, is_there));
    }
    faults.extend(unlisted(documents));
    if faults.is_empty() {
        println!("the links of {} documents lead somewhere", documents.len());
        return Ok(());
    }
    bail!("links that lead nowhere:\n  {}", faults.join("\n  "))
}

/// Where a document's links lead, as they are written.
fn links(document: &Document) -> Vec<String> {
    let links = document.events().filter_map(|event| match event {
        Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
            Some(dest_url.to_string())
        }
        _ => None,
    });
    links.collect()
}

fn faults_of(
    document: &Document,
    documents: &[Document],
    is_there: impl Fn(&Path) -> bool,
) -> Vec<String> {
    let faulty = |link: &String| -> Option<String> {
        let why = fault(document, link, documents, &is_there)?;
        Some(format!("{}: ({link}) {why}", document.path.display()))
    };
    links(document).iter().filter_map(faulty).collect()
}

/// What is wrong with a link.
fn fault(
    document: &Document,
    link: &str,
    documents: &[Document],
    is_there: impl Fn(&Path) -> bool,
) -> Option<&'static str> {
    if let Some((scheme, rest)) = link.split_once("://") {
        let host = rest.split('/').next().unwrap_or("");
        let named = host.contains('.') && !host.starts_with('.') && !host.ends_with('.');
        return (scheme != "https" || !named || link.contains(char::is_whitespace))
            .then_some("is no address");
    }
    let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = if path.is_empty() {
        document.path.clone()
    } else {
        let Some(target) = documents::tidy(&document.folder().join(path)) else {
            return Some("leads out of the project");
        };
        target
    };
    if !is_there(&target) {
        return Some("is not there");
    }
    // A built book is read without the sources beside it.
    if document.path.starts_with(BOOK) && !target.starts_with(BOOK) {
        return Some("leads out of the book; name the path instead");
    }
    if anchor.is_empty() {
        return None;
    }
    let page = documents.iter().find(|other| other.path == target);
    let found = page.is_some_and(|page| page.anchors().iter().any(|a| a == anchor));
    (!found).then_some("has no such heading")
}

/// Pages that the table of contents does not list: mdBook leaves them out without a word.
fn unlisted(documents: &[Document]) -> Vec<String> {
    let summary = documents.iter().find(|document| document.path == Path::new(SUMMARY));
    let listed = summary.map(links).unwrap_or_default();
    let pages = documents.iter().filter(|d| d.path.starts_with(BOOK));
    pages
        .filter(|page| page.path != Path::new(SUMMARY))
        .filter(|page| !listed.iter().any(|link| Path::new(BOOK).join(link) == page.path))
        .map(|page| format!("{} is not in {SUMMARY}", page.path.display()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn document(path: &str, text: &str) -> Document {
        Document { path: PathBuf::from(path), text: text.to_owned() }
    }

    fn faults(path: &str, text: &str) -> Vec<String> {
        let documents =
            [document(path, text), document("docs/src/cost.md", "# Cost\n\n## On a Cortex-M0+\n")];
        let there = ["README.md", "docs/src/cost.md", "docs/src/start.md", "docs/src/udds.svg"];
        faults_of(&documents[0], &documents, |p| there.iter().any(|t| p == Path::new(t)))
    }

    #[test]
    fn links_that_lead_somewhere() {
        let text = "[a](docs/src/cost.md) ![p](docs/src/udds.svg) [b](https://doi.org/10.1/x) \
                    [c](docs/src/cost.md#on-a-cortex-m0)";
        assert!(faults("README.md", text).is_empty());
        assert!(faults("docs/src/start.md", "# Top\n\n[a](cost.md) [b](#top)").is_empty());
    }

    #[test]
    fn links_that_do_not() {
        for (path, text, why) in [
            ("README.md", "[a](docs/src/gone.md)", "not there"),
            ("README.md", "![a](udds.svg)", "not there"),
            ("README.md", "[a](docs/src/cost.md#gone)", "no such heading"),
            ("README.md", "[a](../x.md)", "out of the project"),
            ("README.md", "[a](https://nowhere)", "no address"),
            ("README.md", "[a](http://doi.org/x)", "no address"),
            ("docs/src/start.md", "[a](../../README.md)", "out of the book"),
        ] {
            let found = faults(path, text);
            assert!(found.len() == 1 && found[0].contains(why), "{text}: {found:?}");
        }
    }

    #[test]
    fn code_holds_no_links() {
        assert!(faults("README.md", "`[a](gone.md)`\n\n```text\n[a](gone.md)\n```\n").is_empty());
    }

    #[test]
    fn a_page_that_is_not_listed_is_named() {
        let documents = [
            document(SUMMARY, "# Summary\n\n- [Cost](cost.md)\n"),
            document("docs/src/cost.md", ""),
            document("docs/src/lost.md", ""),
            document("README.md", ""),
        ];
        assert_eq!(unlisted(&documents), ["docs/src/lost.md is not in docs/src/SUMMARY.md"]);
    }
}
