//! The book in `docs`: built by mdBook without a warning, and complete without a network.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context, Result, ensure};

use crate::metadata::Metadata;
use crate::shell::{cargo, output, program, run};

/// What builds the book.
const MDBOOK: (&str, &str) = ("mdbook", "0.5.4");
/// Its features: the search of the finished book, and nothing that serves it.
const FEATURES: &str = "search";
/// What a browser fetches by itself: tag and attribute.
const FETCHED: &[(&str, &str)] = &[
    ("script", "src"),
    ("link", "href"),
    ("img", "src"),
    ("iframe", "src"),
    ("source", "src"),
    ("object", "data"),
    ("image", "href"),
];

/// Installs mdBook unless this version is there.
pub fn setup() -> Result<()> {
    let (name, version) = MDBOOK;
    let installed = output(program(name).arg("--version").stderr(Stdio::null()));
    if installed.is_ok_and(|said| said.trim() == format!("{name} v{version}")) {
        println!("{name} {version} is installed");
        return Ok(());
    }
    run(cargo().args(["install", "--locked", name, "--version", version]).args([
        "--no-default-features",
        "--features",
        FEATURES,
    ]))
}

/// Builds the book and looks at what came out.
pub fn build() -> Result<()> {
    let out = Metadata::load()?.target_directory()?.join("book");
    let built = program(MDBOOK.0)
        .args(["build", "docs", "--dest-dir"])
        .arg(&out)
        .stdout(Stdio::inherit())
        .output()
        .context("`cargo xtask setup` installs mdBook")?;
    let said = String::from_utf8_lossy(&built.stderr);
    eprint!("{said}");
    ensure!(built.status.success(), "mdbook ended with {}", built.status);
    ensure!(!said.contains("WARN") && !said.contains("ERROR"), "the book builds with warnings");
    crate::web::place(&out)?;
    let mut fetched = Vec::new();
    look(&out, &mut fetched)?;
    ensure!(fetched.is_empty(), "the book asks for what lies elsewhere: {}", fetched.join(", "));
    println!("{} holds the book", out.join("index.html").display());
    Ok(())
}

/// Gathers what the pages and styles of a folder fetch from elsewhere.
fn look(folder: &Path, fetched: &mut Vec<String>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            look(&path, fetched)?;
            continue;
        }
        let found = match path.extension().and_then(|end| end.to_str()) {
            Some("html" | "svg") => elsewhere_in_html(&fs::read_to_string(&path)?),
            Some("css") => elsewhere_in_css(&fs::read_to_string(&path)?),
            _ => Vec::new(),
        };
        fetched.extend(found.iter().map(|what| format!("{what} in {}", path.display())));
    }
    Ok(())
}

fn is_elsewhere(address: &str) -> bool {
    let within = address.starts_with("data:");
    address.starts_with("//") || (address.contains("://") && !within)
}

fn elsewhere_in_html(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for tag in text.split('<').skip(1) {
        let tag = &tag[..tag.find('>').unwrap_or(tag.len())];
        let name = tag.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or("");
        for (_, attribute) in FETCHED.iter().filter(|(fetching, _)| *fetching == name) {
            let value = tag.split_once(&format!("{attribute}=\"")).map_or("", |(_, rest)| rest);
            let address = value.split('"').next().unwrap_or("");
            if is_elsewhere(address) {
                found.push(address.to_owned());
            }
        }
    }
    found
}

fn elsewhere_in_css(text: &str) -> Vec<String> {
    let after = |words: &'static str| text.split(words).skip(1);
    let addresses = after("url(").chain(after("@import ")).map(|rest| {
        let end = rest.find([')', ';']).unwrap_or(rest.len());
        rest[..end].trim_matches(['"', '\'', ' '])
    });
    addresses.filter(|address| is_elsewhere(address)).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_page_fetches_from_elsewhere_is_seen() {
        for page in [
            "<script src=\"https://cdn.example.org/mathjax.js\"></script>",
            "<link rel=\"stylesheet\" href=\"//fonts.example.org/x.css\">",
            "<p><img alt=\"x\" src=\"http://example.org/x.png\"></p>",
        ] {
            assert_eq!(elsewhere_in_html(page).len(), 1, "{page}");
        }
        for style in [
            "a { background: url('https://example.org/x.png'); }",
            "@import \"https://example.org/x.css\";",
        ] {
            assert_eq!(elsewhere_in_css(style).len(), 1, "{style}");
        }
    }

    #[test]
    fn links_and_own_files_are_no_matter() {
        let page = "<a href=\"https://doi.org/10.1/x\">x</a> <script src=\"book.js\"></script> \
                    <svg xmlns=\"http://www.w3.org/2000/svg\"><image href=\"a.png\"/></svg>";
        assert!(elsewhere_in_html(page).is_empty());
        let style = "a { src: url(\"fonts/x.woff2\"); mask: url('data:image/svg+xml,<svg \
                     xmlns=\"http://www.w3.org/2000/svg\"/>'); }";
        assert!(elsewhere_in_css(style).is_empty());
    }
}
