//! Numpy arrays in and out.

use numpy::{AllowTypeChange, Element, PyArray1, PyArrayLike1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Any sequence of numbers.
pub type Numbers<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// The numbers of a sequence, wherever they lie in memory.
pub fn numbers(values: &Numbers<'_>) -> Vec<f64> {
    values.as_array().to_vec()
}

/// Fails unless every column is as long as the first.
pub fn check_lengths(columns: &[(&str, &[f64])]) -> PyResult<()> {
    let Some(((first, samples), rest)) = columns.split_first().map(|(f, r)| ((f.0, f.1.len()), r))
    else {
        return Ok(());
    };
    match rest.iter().find(|(_, values)| values.len() != samples) {
        None => Ok(()),
        Some((name, values)) => Err(PyValueError::new_err(format!(
            "{name} has {} values, {first} has {samples}; expected the same",
            values.len()
        ))),
    }
}

/// Gives a column to Python; the array owns the values, nothing is copied.
pub fn give<T: Element>(columns: &Bound<'_, PyDict>, name: &str, values: Vec<T>) -> PyResult<()> {
    columns.set_item(name, PyArray1::from_vec(columns.py(), values))
}
