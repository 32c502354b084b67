//! Parameters as Python's dictionaries, laid out and named as in the TOML files.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::{Table, Value};

/// A table as a dictionary.
pub fn to_dict<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, value) in table {
        dict.set_item(key, to_python(py, value)?)?;
    }
    Ok(dict)
}

fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Integer(n) => n.into_pyobject(py)?.into_any(),
        Value::Float(x) => PyFloat::new(py, *x).into_any(),
        Value::Boolean(b) => PyBool::new(py, *b).to_owned().into_any(),
        Value::Datetime(date) => PyString::new(py, &date.to_string()).into_any(),
        Value::Table(table) => to_dict(py, table)?.into_any(),
        Value::Array(values) => {
            let list = PyList::empty(py);
            for value in values {
                list.append(to_python(py, value)?)?;
            }
            list.into_any()
        }
    })
}

/// A dictionary as a table.
pub fn to_table(dict: &Bound<'_, PyDict>) -> PyResult<Table> {
    dict.iter().map(|(key, value)| Ok((key.extract()?, to_toml(&value)?))).collect()
}

/// A value as TOML writes it; numbers of numpy, too.
pub fn to_toml(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(Value::Table(to_table(dict)?));
    }
    if value.is_instance_of::<PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(Value::Integer(value.extract()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        return value
            .try_iter()?
            .map(|item| to_toml(&item?))
            .collect::<PyResult<_>>()
            .map(Value::Array);
    }
    value.extract().map(Value::Float).map_err(|_| {
        PyTypeError::new_err(format!("expected a number, a text, a list or a dict, found {value}"))
    })
}

/// Sets `a.b.c`; tables that are not there are made, a number counts those of a list.
pub fn set(table: &mut Table, path: &str, value: Value) -> PyResult<()> {
    let (tables, key) = path.rsplit_once('.').unwrap_or(("", path));
    let mut at = table;
    let mut parts = tables.split('.').filter(|part| !part.is_empty());
    let wrong = |part: &str| PyValueError::new_err(format!("`{path}`: `{part}` is no table"));
    while let Some(part) = parts.next() {
        let entry = at.entry(part).or_insert_with(|| Value::Table(Table::new()));
        at = match entry {
            Value::Table(inner) => inner,
            Value::Array(list) => {
                let number = parts.next().and_then(|n| n.parse::<usize>().ok());
                let item = number.and_then(|n| list.get_mut(n)).and_then(Value::as_table_mut);
                item.ok_or_else(|| wrong(part))?
            }
            _ => return Err(wrong(part)),
        };
    }
    at.insert(key.to_owned(), value);
    Ok(())
}
