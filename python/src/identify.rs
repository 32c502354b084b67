//! Batteries and vehicles from measurements.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use voltstep::identify::{self as identification, Options, VehicleOptions};

use crate::vehicle::{Battery, Vehicle};
use crate::work;

/// The names of the files: folders say where they lie on one machine.
fn named(files: &[PathBuf]) -> String {
    let names = files.iter().filter_map(|path| path.file_name());
    names.map(|name| name.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// A battery from trips, or from tests of one cell.
#[pyfunction]
#[pyo3(signature = (files, *, name, description, source, capacity_ah, discharge_limit_a,
    charge_limit_a, folds, seed, progress))]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub fn identify_battery(
    py: Python<'_>,
    files: Vec<PathBuf>,
    name: String,
    description: String,
    source: String,
    capacity_ah: Option<f64>,
    discharge_limit_a: f64,
    charge_limit_a: f64,
    folds: usize,
    seed: u64,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Battery, Vec<String>)> {
    for (name, value) in [
        ("capacity_ah", capacity_ah),
        ("discharge_limit_a", Some(discharge_limit_a)),
        ("charge_limit_a", Some(charge_limit_a)),
    ] {
        if !value.is_none_or(|value| value > 0.0) {
            return Err(PyValueError::new_err(format!("{name} must be above 0")));
        }
    }
    if !(2..=100).contains(&folds) {
        return Err(PyValueError::new_err(format!("folds must lie in 2..100, found {folds}")));
    }
    let command =
        format!("voltstep.identify_battery: {}, folds {folds}, seed {seed}", named(&files));
    let options = Options {
        name,
        description,
        source,
        command,
        capacity_ah,
        discharge_limit_a,
        charge_limit_a,
        folds,
        seed,
    };
    work::run(py, progress, |teller| {
        let tick = |stage: &str| teller.stage(stage);
        let found = identification::identify(&files, options, &tick)?;
        Ok((Battery::of("the identified battery", found.to_toml())?, found.notes))
    })
}

/// A vehicle from trips.
#[pyfunction]
#[pyo3(signature = (files, *, vehicle, name, progress))]
pub fn identify_vehicle(
    py: Python<'_>,
    files: Vec<PathBuf>,
    vehicle: String,
    name: String,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vehicle, Vec<String>)> {
    let command = format!("voltstep.identify_vehicle: {}, vehicle {vehicle}", named(&files));
    let options = VehicleOptions { name, command, template: vehicle };
    work::run(py, progress, |teller| {
        let tick = |stage: &str| teller.stage(stage);
        let found = identification::identify_vehicle(&files, options, &tick)?;
        Ok((Vehicle::of("the identified vehicle", found.toml)?, found.notes))
    })
}
