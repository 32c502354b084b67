//! The examples of the crates that run on target: each asserts what it shows.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::shell::{cargo, output};

/// Folder, package and the features that its examples need.
const PACKAGES: [(&str, &str, &str); 2] =
    [("plant-core", "plant-core", ""), ("bms", "voltstep-bms", "recorder")];

/// Runs every example; one that fails, or shows nothing, is an error.
pub fn examples() -> Result<()> {
    for (folder, package, features) in PACKAGES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder).join("examples");
        for example in names(&path)? {
            println!("{package}: {example}");
            let run = ["run", "-q", "-p", package, "--features", features, "--example", &example];
            let shown = output(cargo().args(run))?;
            if shown.trim().is_empty() {
                bail!("the example `{example}` of {package} shows nothing");
            }
        }
    }
    Ok(())
}

/// The examples of a folder, of which there must be one at least.
fn names(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("no {}", folder.display()))? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "rs")
            && let Some(name) = path.file_stem()
        {
            names.push(name.to_string_lossy().into_owned());
        }
    }
    if names.is_empty() {
        bail!("no example in {}", folder.display());
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_examples_is_an_error() {
        let folder = std::env::temp_dir().join(format!("voltstep-examples-{}", std::process::id()));
        assert!(names(&folder).is_err());
        fs::create_dir_all(&folder).unwrap();
        assert!(names(&folder).unwrap_err().to_string().contains("no example"));
        for file in ["b.rs", "a.rs", "notes.md"] {
            fs::write(folder.join(file), "").unwrap();
        }
        assert_eq!(names(&folder).unwrap(), ["a", "b"]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
