//! What a vehicle is to follow: a name, a file, or arrays.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use voltstep::read::cycle;
use voltstep::read::input::{self, Drive};

use crate::arrays::{Numbers, check_lengths, numbers};
use crate::vehicle::path;
use crate::work::refused;

/// The columns of a tuple of arrays.
const COLUMNS: [&str; 3] = ["time_s", "speed_m_s", "grade"];

/// The name of a built-in cycle, the path of a cycle or trip file, or `(time_s, speed_m_s[, grade])`.
pub fn drive(given: &Bound<'_, PyAny>) -> PyResult<Drive> {
    if let Ok(arrays) = given.cast::<PyTuple>() {
        return of_arrays(arrays);
    }
    input::drive(&path(given, "a cycle")?).map_err(refused)
}

/// Takes the way of a file, so that arrays are held to the same rules.
fn of_arrays(arrays: &Bound<'_, PyTuple>) -> PyResult<Drive> {
    if !(2..=3).contains(&arrays.len()) {
        let message =
            format!("expected (time_s, speed_m_s[, grade]), found {} arrays", arrays.len());
        return Err(PyTypeError::new_err(message));
    }
    let columns = arrays
        .iter()
        .map(|array| Ok(numbers(&array.extract::<Numbers<'_>>()?)))
        .collect::<PyResult<Vec<_>>>()?;
    let named: Vec<_> = COLUMNS.into_iter().zip(columns.iter().map(Vec::as_slice)).collect();
    check_lengths(&named)?;
    let header: Vec<_> = named.iter().map(|(name, _)| *name).collect();
    let mut text = header.join(",") + "\n";
    for sample in 0..columns[0].len() {
        let row: Vec<_> = columns.iter().map(|column| column[sample].to_string()).collect();
        text += &(row.join(",") + "\n");
    }
    cycle::parse("arrays", text.as_bytes()).map(Drive::Cycle).map_err(|error| {
        // The header is line 1.
        let place = error.line.map_or(String::new(), |line| format!(" in sample {}", line - 2));
        PyValueError::new_err(format!("arrays:{place} {}", error.message))
    })
}
