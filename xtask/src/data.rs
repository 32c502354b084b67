//! Where the real measurements lie. They are not part of the project.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

/// The environment variable that names their folder.
pub const VARIABLE: &str = "VOLTSTEP_DATA";

/// Printed wherever tests run without them.
pub const NOTICE: &str = "
********************************************************************************
*  SKIPPED: the tests on real measurements. VOLTSTEP_DATA is not set.          *
*                                                                              *
*  To run them, name the folder that holds the measurements:                   *
*      VOLTSTEP_DATA=/path/to/data cargo xtask test                            *
********************************************************************************
";

/// What the environment says; an empty value counts as none.
pub fn folder() -> Option<OsString> {
    std::env::var_os(VARIABLE).filter(|value| !value.is_empty())
}

/// The absolute path of the folder: tests run in their own package's folder.
pub fn absolute(folder: impl AsRef<Path>) -> Result<PathBuf> {
    let folder = folder.as_ref();
    let path = folder
        .canonicalize()
        .with_context(|| format!("{VARIABLE} names {}, which is not there", folder.display()))?;
    if !path.is_dir() {
        bail!("{VARIABLE} names {}, which is not a folder", folder.display());
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_becomes_absolute() {
        assert!(absolute("src").unwrap().is_absolute());
    }

    #[test]
    fn what_is_no_folder_is_refused() {
        assert!(absolute("no-such-folder").is_err());
        assert!(absolute("Cargo.toml").is_err());
    }
}
