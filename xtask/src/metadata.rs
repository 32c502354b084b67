//! What `cargo metadata` knows of the workspace.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use serde_json::Value;

use crate::shell;

/// The workspace as cargo describes it.
pub struct Metadata(Value);

impl Metadata {
    /// Asks cargo.
    pub fn load() -> Result<Metadata> {
        let args = ["metadata", "--no-deps", "--format-version", "1"];
        Metadata::parse(&shell::output(shell::cargo().args(args))?)
    }

    fn parse(json: &str) -> Result<Metadata> {
        Ok(Metadata(
            serde_json::from_str(json).context("cannot read the output of cargo metadata")?,
        ))
    }

    /// The names of a package's features, in alphabetical order.
    pub fn features(&self, package: &str) -> Result<Vec<String>> {
        let packages = self.0["packages"].as_array().context("cargo metadata lists no packages")?;
        let Some(found) = packages.iter().find(|entry| entry["name"] == package) else {
            bail!("the workspace has no package `{package}`");
        };
        let features = found["features"].as_object().context("cargo metadata lists no features")?;
        let mut names: Vec<String> = features.keys().cloned().collect();
        names.sort();
        Ok(names)
    }

    /// The folder for build products.
    pub fn target_directory(&self) -> Result<PathBuf> {
        let path = self.0["target_directory"].as_str();
        Ok(PathBuf::from(path.context("cargo metadata names no target directory")?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const JSON: &str = r#"{
        "packages": [
            { "name": "other", "features": { "loud": [] } },
            { "name": "plant-core", "features": { "serde": ["dep:serde"], "defmt": [], "default": [] } },
            { "name": "bare", "features": {} }
        ],
        "target_directory": "/somewhere/target"
    }"#;

    #[test]
    fn features_are_those_of_the_package_sorted() {
        let metadata = Metadata::parse(JSON).unwrap();
        assert_eq!(metadata.features("plant-core").unwrap(), ["default", "defmt", "serde"]);
        assert!(metadata.features("bare").unwrap().is_empty());
    }

    #[test]
    fn an_unknown_package_is_named() {
        let error = Metadata::parse(JSON).unwrap().features("absent").unwrap_err();
        assert!(error.to_string().contains("absent"));
    }

    #[test]
    fn the_target_directory() {
        let metadata = Metadata::parse(JSON).unwrap();
        assert_eq!(metadata.target_directory().unwrap(), PathBuf::from("/somewhere/target"));
        assert!(Metadata::parse("{}").unwrap().target_directory().is_err());
    }

    #[test]
    fn garbage_is_refused() {
        assert!(Metadata::parse("not json").is_err());
        assert!(Metadata::parse("{}").unwrap().features("plant-core").is_err());
    }
}
