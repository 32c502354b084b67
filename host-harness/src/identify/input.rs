//! What an identification reads, and the capacity it starts from.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use rayon::prelude::*;

use super::capacity::{self, Estimate};
use super::series::Measured;
use crate::read::cell::CellRecord;
use crate::read::error::InputError;
use crate::read::input::{self, Measurement};
use crate::read::trip::Trip;

/// The measurements do not tell the capacity, and it was not given: which ones would.
#[derive(Debug, thiserror::Error)]
#[error("{0}, or the capacity")]
pub struct NoCapacity(pub &'static str);

/// Reads trips or tests of a cell: files, and the CSV files in folders, each once.
///
/// # Errors
/// A folder without any, a file that is neither; both kinds together.
pub fn read(inputs: &[PathBuf]) -> anyhow::Result<(Vec<Trip>, Vec<CellRecord>)> {
    let mut paths: Vec<_> = input::files(inputs)?.into_iter().map(|(path, _)| path).collect();
    paths.sort_unstable();
    paths.dedup();
    let found: Result<Vec<Measurement>, InputError> =
        paths.par_iter().map(|path| input::measurement(path)).collect();
    let (mut trips, mut cells) = (Vec::new(), Vec::new());
    for measurement in found? {
        match measurement {
            Measurement::Trip(trip) => trips.push(*trip),
            Measurement::Cell(record) => cells.push(record),
        }
    }
    ensure!(
        trips.is_empty() || cells.is_empty(),
        "trips and tests of a cell together: they are not of one battery"
    );
    Ok((trips, cells))
}

/// The capacity, and the trips that can be trusted.
pub fn from_trips(
    trips: Vec<Trip>,
    given_ah: Option<f64>,
    notes: &mut Vec<String>,
) -> anyhow::Result<(Estimate, Vec<Measured>)> {
    let rough = given_ah.or_else(|| capacity::rough(&trips));
    let rough = rough.context("no trip moves the state of charge enough to tell the capacity")?;
    let mut fit = Vec::new();
    for trip in trips {
        let reasons = trip.unfit(rough);
        if trip.first_soc().is_none() {
            notes.push(format!("{}: left out: no state of charge", trip.name));
        } else if reasons.is_empty() {
            fit.push(trip);
        } else {
            notes.push(format!("{}: left out: {}", trip.name, reasons.join("; ")));
        }
    }
    let capacity = match given_ah {
        Some(value) => Estimate { value, error: f64::NAN },
        None => capacity::of_trips(&fit)
            .context(NoCapacity("fewer than three trips tell the capacity: give more"))?,
    };
    if fit.iter().any(|t| t.battery_c.iter().all(|c| c.is_nan())) {
        notes.push("trips without a battery temperature are taken at 25 °C".to_owned());
    }
    Ok((capacity, fit.iter().map(|t| Measured::of_trip(t, capacity.value)).collect()))
}

/// The capacity, and the tests.
pub fn from_cells(
    cells: &[CellRecord],
    given_ah: Option<f64>,
    notes: &mut Vec<String>,
) -> anyhow::Result<(Estimate, Vec<Measured>)> {
    let sweep = cells.iter().find_map(|c| Some((c, capacity::of_sweep(c)?)));
    let capacity = match (given_ah, sweep) {
        (Some(value), _) => Estimate { value, error: f64::NAN },
        (None, Some((record, capacity))) => {
            let before_ah = -record.discharged_ah[0];
            if before_ah > 3.0 * capacity.error {
                notes.push(format!(
                    "{}: the sweep begins {:.1} % above full (where the counter is 0): the \
                     capacity counts from full",
                    record.name,
                    100.0 * before_ah / capacity.value
                ));
            }
            capacity
        }
        (None, None) => {
            let said =
                "no slow discharge of a full cell among the tests tells the capacity: give one";
            return Err(NoCapacity(said).into());
        }
    };
    Ok((capacity, cells.iter().map(|c| Measured::of_cell(c, capacity.value)).collect()))
}
