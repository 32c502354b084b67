//! Vehicles and batteries: built in, from a file, from a dictionary, or changed.

use std::path::PathBuf;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use toml::{Table, Value};
use voltstep::read::battery::{self as batteries, BatteryFile, parse as parse_battery};
use voltstep::read::error::InputError;
use voltstep::read::vehicle::{self as vehicles, parse as parse_vehicle};

use crate::arrays::Numbers;
use crate::parameters::{set, to_dict, to_table, to_toml};

/// What the command says.
fn wrong(error: InputError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A dictionary has no lines; the message names the key.
fn wrong_of_dict(error: InputError) -> PyErr {
    wrong(InputError { line: None, column: None, ..error })
}

/// A name or a path.
pub fn path(given: &Bound<'_, PyAny>, what: &str) -> PyResult<String> {
    if let Ok(name) = given.extract::<String>() {
        return Ok(name);
    }
    let path: PathBuf = given.extract().map_err(|_| {
        PyTypeError::new_err(format!("expected the name or the path of {what}, found {given}"))
    })?;
    path.into_os_string().into_string().map_err(|_| PyValueError::new_err("the path is no Unicode"))
}

fn table(text: &str) -> PyResult<Table> {
    toml::from_str(text.trim_start_matches('\u{feff}'))
        .map_err(|error| PyValueError::new_err(error.to_string()))
}

fn text(table: &Table) -> PyResult<String> {
    toml::to_string(table).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The text with what `changes` sets.
fn changed(base: &str, changes: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut table = table(base)?;
    for (key, value) in changes {
        set(&mut table, &key.extract::<String>()?, to_toml(&value)?)?;
    }
    text(&table)
}

/// A vehicle with its driver; its parameters are sound.
#[pyclass(frozen, module = "voltstep")]
pub struct Vehicle {
    /// Where a battery's file is looked for, and what messages name.
    file: String,
    text: String,
    pub model: vehicles::Vehicle,
}

/// A battery with parameters over state of charge and temperature; they are sound.
#[pyclass(frozen, module = "voltstep")]
pub struct Battery {
    file: String,
    text: String,
    pub model: BatteryFile,
}

/// What vehicles and batteries have in common for Python, and what only one of them has.
macro_rules! parameter_set {
    ($Set:ident, $parse:ident, $of_text:literal, { $($more:tt)* }) => {
        impl $Set {
            pub fn of(file: &str, text: String) -> Result<Self, InputError> {
                let model = $parse(file, text.as_bytes())?;
                Ok(Self { file: file.to_owned(), text, model })
            }

            fn of_dict(file: &str, text: String) -> PyResult<Self> {
                Self::of(file, text).map_err(wrong_of_dict)
            }
        }

        #[pymethods]
        impl $Set {
            /// Its name.
            #[getter]
            fn name(&self) -> &str {
                &self.model.name
            }

            /// A copy of the parameters, laid out and named as in a TOML file.
            #[getter]
            fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
                to_dict(py, &table(&self.text)?)
            }

            /// A changed copy; keys are paths such as `body.mass_kg`, each with its unit.
            fn replace(&self, changes: &Bound<'_, PyDict>) -> PyResult<Self> {
                Self::of_dict(&self.file, changed(&self.text, changes)?)
            }

            $($more)*

            /// The text of its file.
            fn to_toml(&self) -> &str {
                &self.text
            }

            fn __repr__(&self) -> String {
                let (name, description) = (&self.model.name, &self.model.description);
                format!(concat!("<voltstep.", stringify!($Set), " {}: {}>"), name, description)
            }

            fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
                other.cast::<Self>().is_ok_and(|other| other.get().model == self.model)
            }

            fn __reduce__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<(Bound<'py, PyAny>, (&str, &str))> {
                let module = py.import("voltstep._voltstep")?;
                Ok((module.getattr($of_text)?, (&self.file, &self.text)))
            }
        }
    };
}

parameter_set!(Battery, parse_battery, "battery_of_text", {});
parameter_set!(Vehicle, parse_vehicle, "vehicle_of_text", {
    /// A changed copy for each row of the arrays, which are of one length; made on all cores.
    fn variants(&self, py: Python<'_>, changes: &Bound<'_, PyDict>) -> PyResult<Vec<Self>> {
        let base = table(&self.text)?;
        let mut columns = Vec::new();
        for (key, values) in changes {
            let values = crate::arrays::numbers(&values.extract::<Numbers<'_>>()?);
            columns.push((key.extract::<String>()?, values));
        }
        let named: Vec<_> = columns.iter().map(|(k, v)| (k.as_str(), v.as_slice())).collect();
        crate::arrays::check_lengths(&named)?;
        let count = columns.first().map_or(0, |(_, values)| values.len());
        py.detach(|| {
            (0..count)
                .into_par_iter()
                .map(|row| {
                    let mut table = base.clone();
                    for (key, values) in &columns {
                        set(&mut table, key, Value::Float(values[row]))?;
                    }
                    let read = Self::of(&self.file, text(&table)?);
                    read.map_err(|error| {
                        let message = format!("variant {row}: {}", error.message);
                        wrong_of_dict(InputError { message, ..error })
                    })
                })
                .collect()
        })
    }
});

/// A vehicle by its name, from a file, or from a dictionary.
#[pyfunction]
pub fn vehicle(source: &Bound<'_, PyAny>) -> PyResult<Vehicle> {
    if let Ok(dict) = source.cast::<PyDict>() {
        return Vehicle::of_dict("vehicle", text(&to_table(dict)?)?);
    }
    let (file, text) = vehicles::text(&path(source, "a vehicle, or a dict")?).map_err(wrong)?;
    Vehicle::of(&file, text).map_err(wrong)
}

/// A battery by its name, from a file, or from a dictionary.
#[pyfunction]
pub fn battery(source: &Bound<'_, PyAny>) -> PyResult<Battery> {
    if let Ok(dict) = source.cast::<PyDict>() {
        return Battery::of_dict("battery", text(&to_table(dict)?)?);
    }
    let file = path(source, "a battery, or a dict")?;
    let text = batteries::text(&file).map_err(wrong)?;
    Battery::of(&file, text).map_err(wrong)
}

/// A vehicle that comes from another process.
#[pyfunction]
pub fn vehicle_of_text(file: &str, text: String) -> PyResult<Vehicle> {
    Vehicle::of(file, text).map_err(wrong)
}

/// A battery that comes from another process.
#[pyfunction]
pub fn battery_of_text(file: &str, text: String) -> PyResult<Battery> {
    Battery::of(file, text).map_err(wrong)
}

/// A vehicle, or what makes one.
pub fn of_any(given: &Bound<'_, PyAny>) -> PyResult<vehicles::Vehicle> {
    match given.cast::<Vehicle>() {
        Ok(vehicle) => Ok(vehicle.get().model.clone()),
        Err(_) => Ok(vehicle(given)?.model),
    }
}

/// A battery, or what makes one.
pub fn battery_of_any(given: &Bound<'_, PyAny>) -> PyResult<BatteryFile> {
    match given.cast::<Battery>() {
        Ok(battery) => Ok(battery.get().model.clone()),
        Err(_) => Ok(battery(given)?.model),
    }
}
