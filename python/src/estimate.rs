//! Estimators over arrays.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use voltstep::evaluate::estimators::Estimator;
use voltstep::evaluate::estimators::follow::{Start, follow};
use voltstep::read::cell::CellRecord;

use crate::arrays::{Numbers, check_lengths, give, numbers};
use crate::vehicle::battery_of_any;
use crate::work;

/// State of charge and its standard deviation after each sample.
#[pyfunction]
#[pyo3(signature = (time_s, current_a, voltage_v, temperature_c, battery, *, estimator, initial_soc,
    initial_soc_sd, rested, rate_hz, current_delay_s))]
#[expect(clippy::too_many_arguments, reason = "named in Python")]
pub fn estimate_soc<'py>(
    py: Python<'py>,
    time_s: Numbers<'py>,
    current_a: Numbers<'py>,
    voltage_v: Numbers<'py>,
    temperature_c: Numbers<'py>,
    battery: &Bound<'py, PyAny>,
    estimator: &str,
    initial_soc: f64,
    initial_soc_sd: f64,
    rested: bool,
    rate_hz: f64,
    current_delay_s: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let estimator = match estimator {
        "ekf" => Estimator::Ekf,
        "coulomb" => Estimator::Coulomb,
        other => {
            let message = format!("estimator must be `ekf` or `coulomb`, found `{other}`");
            return Err(PyValueError::new_err(message));
        }
    };
    let battery = battery_of_any(battery)?;
    let record = CellRecord {
        name: "arrays".to_owned(),
        time_s: numbers(&time_s),
        current_a: numbers(&current_a),
        voltage_v: numbers(&voltage_v),
        cell_c: numbers(&temperature_c),
        ..CellRecord::default()
    };
    check_lengths(&[
        ("time_s", &record.time_s),
        ("current_a", &record.current_a),
        ("voltage_v", &record.voltage_v),
        ("temperature_c", &record.cell_c),
    ])?;
    // Not a number rises nowhere.
    if let Some(i) = record.time_s.windows(2).position(|t| !(t[0] < t[1] && t[1].is_finite())) {
        let message = format!("time_s does not rise at sample {}", i + 1);
        return Err(PyValueError::new_err(message));
    }
    let start =
        Start { soc: initial_soc, soc_sd: initial_soc_sd, rested, rate_hz, current_delay_s };
    let found = work::run(py, None, |_| follow(&battery, record, estimator, start))?;
    let columns = PyDict::new(py);
    give(&columns, "time_s", found.time_s)?;
    give(&columns, "soc", found.soc)?;
    give(&columns, "soc_sd", found.soc_sd)?;
    give(&columns, "contradicted", found.contradicted)?;
    Ok(columns)
}
