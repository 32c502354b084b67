//! `voltstep validate --trips` and `--cells`: the models against every measurement in a folder,
//! one row each and a summary.

pub mod cells;
pub mod estimators;
mod statistics;
pub mod trips;

use std::path::{Path, PathBuf};

use anyhow::Context;

pub(crate) use statistics::spread;
pub use statistics::{Spread, Summary};

/// The CSV files of a folder, by name.
///
/// # Errors
/// A folder that cannot be read, or has none.
pub(crate) fn csv_files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let shown = folder.display();
    let entries = std::fs::read_dir(folder).with_context(|| format!("{shown}: cannot be read"))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("{shown}: cannot be read"))?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            files.push(path);
        }
    }
    anyhow::ensure!(!files.is_empty(), "{shown}: no .csv file in it");
    files.sort_unstable();
    Ok(files)
}

pub(crate) fn number(x: Option<f64>, digits: usize) -> String {
    x.filter(|x| x.is_finite()).map_or_else(|| "–".to_owned(), |x| format!("{x:.digits$}"))
}
