//! Replays: one with its trace, or many with their figures.

use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Context;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use serde_json::Value;
use voltstep::simulate::columns::{columns, measured};
use voltstep::simulate::mode::Mode;
use voltstep::simulate::progress::Unseen;
use voltstep::simulate::replay::{self, Options, Replay};

use crate::arrays::give;
use crate::vehicle::of_any;
use crate::{drive, work};

/// A finished replay.
#[pyclass(frozen, module = "voltstep", name = "Result")]
pub struct Simulation {
    /// The trace by its names with units, a numpy array each, ready for a data frame.
    #[pyo3(get)]
    columns: Py<PyDict>,
    /// The figures, as in summary.json.
    #[pyo3(get)]
    summary: Py<PyAny>,
    /// What to know about it.
    #[pyo3(get)]
    notes: Vec<String>,
}

/// Many finished replays.
#[pyclass(frozen, module = "voltstep")]
pub struct Sweep {
    /// The figures of the summaries by their names with units, a value per vehicle.
    #[pyo3(get)]
    columns: Py<PyDict>,
    /// Why a vehicle could not be run; none where it was.
    #[pyo3(get)]
    errors: Vec<Option<String>>,
    /// What to know about it.
    #[pyo3(get)]
    notes: Vec<String>,
}

#[pymethods]
impl Simulation {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let summary = self.summary.bind(py);
        let (vehicle, input) = (summary.get_item("vehicle")?, summary.get_item("input")?);
        Ok(format!("<voltstep.Result: {vehicle} on {input}>"))
    }
}

#[pymethods]
impl Sweep {
    fn __len__(&self) -> usize {
        self.errors.len()
    }

    fn __repr__(&self) -> String {
        format!("<voltstep.Sweep of {}>", self.errors.len())
    }
}

fn options(dt_s: f64, mode: &str, ledger: bool) -> PyResult<Options> {
    // The range of the command's --dt-ms.
    if !(1e-7..=1.0).contains(&dt_s) {
        return Err(PyValueError::new_err(format!("dt_s must lie in 1e-7..1, not {dt_s}")));
    }
    let known = [Mode::Vehicle, Mode::Battery];
    let mode = known.into_iter().find(|known| known.name() == mode).ok_or_else(|| {
        PyValueError::new_err(format!("mode must be `vehicle` or `battery`, found `{mode}`"))
    })?;
    Ok(Options { mode, dt_s, ledger })
}

/// The summary as its JSON, which is what the command prints.
fn json(replay: &Replay) -> anyhow::Result<String> {
    serde_json::to_string(&replay.summary).context("writing JSON")
}

/// Replays one vehicle.
#[pyfunction]
#[pyo3(signature = (drive, vehicle, dt_s, *, mode, ledger, progress))]
pub fn simulate(
    py: Python<'_>,
    drive: &Bound<'_, PyAny>,
    vehicle: &Bound<'_, PyAny>,
    dt_s: f64,
    mode: &str,
    ledger: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Simulation> {
    let options = options(dt_s, mode, ledger)?;
    let (drive, vehicle) = (drive::drive(drive)?, of_any(vehicle)?);
    let replay =
        work::run(py, progress, |teller| replay::replay(&vehicle, drive, options, teller))?;
    let dict = PyDict::new(py);
    let trace = &replay.run.trace;
    for (name, value) in columns(&replay.run) {
        if *name == "time_s" {
            give(&dict, name, trace.iter().map(value).collect::<Vec<f64>>())?;
        } else {
            #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
            give(&dict, name, trace.iter().map(|row| value(row) as f32).collect())?;
        }
    }
    for (name, values) in replay.trip.as_ref().map(measured).unwrap_or_default() {
        give(&dict, name, values.to_vec())?;
    }
    let text = json(&replay).map_err(work::refused)?;
    Ok(Simulation {
        columns: dict.unbind(),
        summary: py.import("json")?.call_method1("loads", (text,))?.unbind(),
        notes: replay.summary.notes,
    })
}

/// What is kept of one replay among many: the numbers of its summary, by name.
fn figures(replay: &Replay) -> anyhow::Result<Vec<(String, f64)>> {
    let Value::Object(summary) = serde_json::to_value(&replay.summary)? else {
        anyhow::bail!("a summary without figures");
    };
    let number = |(name, value): (String, Value)| match value {
        Value::Number(number) => Some((name, number.as_f64()?)),
        // A figure that this replay does not have, others may.
        Value::Null => Some((name, f64::NAN)),
        _ => None,
    };
    // How long a run took says nothing where runs share the cores.
    let timed = |name: &str| matches!(name, "run_wall_s" | "realtime_factor");
    Ok(summary.into_iter().filter_map(number).filter(|(name, _)| !timed(name)).collect())
}

/// Replays many vehicles on all cores.
#[pyfunction]
#[pyo3(signature = (drive, vehicles, dt_s, *, mode, ledger, keep_errors, progress))]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub fn simulate_many(
    py: Python<'_>,
    drive: &Bound<'_, PyAny>,
    vehicles: &Bound<'_, PyAny>,
    dt_s: f64,
    mode: &str,
    ledger: bool,
    keep_errors: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Sweep> {
    let options = options(dt_s, mode, ledger)?;
    let drive = drive::drive(drive)?;
    let vehicles =
        vehicles.try_iter()?.map(|vehicle| of_any(&vehicle?)).collect::<PyResult<Vec<_>>>()?;
    let (rows, notes) = work::run(py, progress, |teller| {
        // What a long step costs is told once: it takes longer than the run itself.
        let coarse = dt_s > replay::DEFAULT_STEP_S && options.mode == Mode::Vehicle;
        let notes = match vehicles.first().filter(|_| coarse) {
            Some(first) => match replay::replay(first, drive.clone(), options, &Unseen) {
                Ok(told) => told.summary.notes,
                Err(error) if keep_errors => vec![format!("{error:#}")],
                Err(error) => return Err(error.context("vehicle 0")),
            },
            None => Vec::new(),
        };
        let done = AtomicUsize::new(0);
        let one = |(number, vehicle)| {
            // An error ends the others, unwinding would not.
            teller.go_on()?;
            let row = replay::once(vehicle, drive.clone(), options, &Unseen)
                .and_then(|replay| figures(&replay));
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            teller.tell(done, vehicles.len());
            match row {
                Ok(row) => Ok(Ok(row)),
                Err(error) if keep_errors => Ok(Err(format!("{error:#}"))),
                Err(error) => Err(error.context(format!("vehicle {number}"))),
            }
        };
        let rows: Vec<_> =
            vehicles.par_iter().enumerate().map(one).collect::<anyhow::Result<_>>()?;
        Ok((rows, notes))
    })?;
    let dict = PyDict::new(py);
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten().flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    for name in names {
        let of = |row: &Result<Vec<(String, f64)>, String>| {
            let row = row.as_ref().ok()?;
            row.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
        };
        give(&dict, name, rows.iter().map(|row| of(row).unwrap_or(f64::NAN)).collect())?;
    }
    let errors = rows.into_iter().map(Result::err).collect();
    Ok(Sweep { columns: dict.unbind(), errors, notes })
}
