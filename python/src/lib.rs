//! What the Python package `voltstep` is made of: the library behind the command, over numpy arrays.
//!
//! `voltstep/__init__.pyi` says what each function takes and gives, for people and type checkers.

// Python's own calling convention is unsafe; only pyo3's macros write it.
#![deny(unsafe_code)]

mod arrays;
mod drive;
mod estimate;
mod identify;
mod parameters;
mod simulate;
mod vehicle;
mod work;

use pyo3::prelude::*;
use voltstep::read::{battery, cycle, vehicle as vehicles};

/// The names of the built-in cycles, vehicles and batteries.
#[pyfunction]
fn names() -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    (cycle::names().collect(), vehicles::names().collect(), battery::names().collect())
}

#[pymodule]
fn _voltstep(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<vehicle::Vehicle>()?;
    module.add_class::<vehicle::Battery>()?;
    module.add_class::<simulate::Simulation>()?;
    module.add_class::<simulate::Sweep>()?;
    for function in [
        wrap_pyfunction!(names, module)?,
        wrap_pyfunction!(vehicle::vehicle, module)?,
        wrap_pyfunction!(vehicle::battery, module)?,
        wrap_pyfunction!(vehicle::vehicle_of_text, module)?,
        wrap_pyfunction!(vehicle::battery_of_text, module)?,
        wrap_pyfunction!(simulate::simulate, module)?,
        wrap_pyfunction!(simulate::simulate_many, module)?,
        wrap_pyfunction!(estimate::estimate_soc, module)?,
        wrap_pyfunction!(identify::identify_battery, module)?,
        wrap_pyfunction!(identify::identify_vehicle, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
