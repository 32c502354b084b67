//! What commands are given: names, files and folders of recordings.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use crate::read::cell::{self, CellRecord};
use crate::read::cycle::{self, Cycle};
use crate::read::error::{self, InputError, nearest};
use crate::read::profile::{self, Profile};
use crate::read::recognise::{FileKind, recognise};
use crate::read::trip::{self, Trip};

/// What a vehicle can follow.
#[derive(Clone, Debug)]
pub enum Drive {
    /// A driving cycle.
    Cycle(Cycle),
    /// A measured trip.
    Trip(Box<Trip>),
    /// A load of the battery alone.
    Profile(Profile),
}

impl Drive {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Cycle(cycle) => &cycle.name,
            Self::Trip(trip) => &trip.name,
            Self::Profile(profile) => &profile.name,
        }
    }
}

/// What was measured of a battery.
#[derive(Clone, Debug)]
pub enum Measurement {
    /// A trip, of a whole pack.
    Trip(Box<Trip>),
    /// A test of one cell.
    Cell(CellRecord),
}

/// Finds a cycle by its name, or reads a file with a cycle, a trip or a profile.
///
/// # Errors
/// No such name or file; a file that is none of them.
pub fn drive(input: &str) -> anyhow::Result<Drive> {
    if let Some(cycle) = cycle::by_name(input) {
        return Ok(Drive::Cycle(cycle));
    }
    let path = Path::new(input);
    if !path.exists() {
        let nearest = nearest(input, cycle::names())
            .map(|n| format!(" (did you mean `{n}`?)"))
            .unwrap_or_default();
        bail!(
            "`{input}` is neither a file nor a built-in cycle{nearest}; there are: {}",
            cycle::names().collect::<Vec<_>>().join(", ")
        );
    }
    let wanted = [FileKind::Cycle, FileKind::Trip, FileKind::Profile];
    let File { name, bytes, kind } = File::read(path, &wanted)?;
    Ok(match kind {
        FileKind::Profile => Drive::Profile(profile::parse(&name, &bytes)?),
        FileKind::Trip => Drive::Trip(Box::new(trip::parse(&name, &bytes)?)),
        _ => Drive::Cycle(cycle::parse(&name, &bytes)?),
    })
}

/// Reads a trip or a test of a cell, whichever the file is.
///
/// # Errors
/// [`InputError`] says what is wrong and where; a cell's counter must agree with its current.
pub fn measurement(path: &Path) -> Result<Measurement, InputError> {
    let File { name, bytes, kind } = File::read(path, &[FileKind::Trip, FileKind::Cell])?;
    Ok(match kind {
        FileKind::Trip => Measurement::Trip(Box::new(trip::parse(&name, &bytes)?)),
        _ => Measurement::Cell(checked(&name, &bytes)?),
    })
}

/// Reads a trip.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn trip(path: &Path) -> Result<Trip, InputError> {
    let file = File::read(path, &[FileKind::Trip])?;
    trip::parse(&file.name, &file.bytes)
}

/// Reads a test of a cell.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn cell(path: &Path) -> Result<CellRecord, InputError> {
    let file = File::read(path, &[FileKind::Cell])?;
    checked(&file.name, &file.bytes)
}

/// A test of a cell whose counter and current agree.
fn checked(file: &str, bytes: &[u8]) -> Result<CellRecord, InputError> {
    let record = cell::parse(file, bytes)?;
    match record.counter_fault() {
        Some(fault) => Err(InputError::of_file(file, fault)),
        None => Ok(record),
    }
}

/// A file in memory: a pipe cannot be read again.
struct File {
    name: String,
    bytes: Vec<u8>,
    kind: FileKind,
}

impl File {
    fn read(path: &Path, wanted: &[FileKind]) -> Result<Self, InputError> {
        let name = path.to_string_lossy().into_owned();
        let bytes = error::read(path)?;
        let kind = recognise(&name, &bytes, wanted)?;
        Ok(Self { name, bytes, kind })
    }
}

/// The CSV files of a folder, by name.
///
/// # Errors
/// A folder that cannot be read, or has none.
pub fn csv_files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let shown = folder.display();
    let entries = std::fs::read_dir(folder).with_context(|| format!("{shown}: cannot be read"))?;
    let mut files = Vec::new();
    for entry in entries {
        let path = entry.with_context(|| format!("{shown}: cannot be read"))?.path();
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
            files.push(path);
        }
    }
    ensure!(!files.is_empty(), "{shown}: no .csv file in it");
    files.sort_unstable();
    Ok(files)
}

/// The files that `inputs` name: files, and the CSV files in folders; and whether each was found in
/// a folder.
///
/// # Errors
/// A folder that cannot be read, or has no CSV file.
pub fn files(inputs: &[PathBuf]) -> anyhow::Result<Vec<(PathBuf, bool)>> {
    let mut files = Vec::new();
    for input in inputs {
        if input.is_dir() {
            files.extend(csv_files(input)?.into_iter().map(|file| (file, true)));
        } else {
            files.push((input.clone(), false));
        }
    }
    Ok(files)
}
