//! `--out` of the commands that look at many runs: an overview, with a report of each.

use std::path::PathBuf;

use crate::show::files::{self, Stage};
use crate::show::report::folder::NAME;

/// What every overview has beside it.
const SUMMARY: &str = "summary.json";

/// Where the reports go; nowhere without `--out`.
pub struct Out(Option<(PathBuf, Stage)>);

impl Out {
    /// Looks at the folder before anything is computed.
    pub fn new(folder: Option<PathBuf>) -> anyhow::Result<Self> {
        let Some(folder) = folder else { return Ok(Self(None)) };
        files::check(&folder, &[NAME, SUMMARY])?;
        let stage = Stage::new(&folder)?;
        Ok(Self(Some((folder, stage))))
    }

    /// What takes the runs; nothing where nobody wants them.
    pub fn keep<T>(&self, keep: T) -> Option<T> {
        self.0.is_some().then_some(keep)
    }

    /// Adds the report of one run.
    pub fn put(
        &self,
        name: &str,
        report: impl FnOnce() -> anyhow::Result<Vec<u8>>,
    ) -> anyhow::Result<()> {
        match &self.0 {
            Some((_, stage)) => stage.put(name, &report()?),
            None => Ok(()),
        }
    }

    /// Writes everything, the overview last; what is said about it.
    pub fn publish(self, overview: impl FnOnce() -> Vec<u8>, json: &str) -> anyhow::Result<String> {
        let Some((folder, stage)) = self.0 else { return Ok(String::new()) };
        stage.put(NAME, &overview())?;
        stage.put(SUMMARY, json.as_bytes())?;
        stage.publish()?;
        Ok(format!("{NAME} and {SUMMARY} are in {}\n", folder.display()))
    }
}
