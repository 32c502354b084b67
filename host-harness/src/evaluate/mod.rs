//! The models and the estimators against measurements: every trip ([`trips`]) and every drive cycle
//! of a cell ([`cells`]) of a folder, the state of charge as it is estimated ([`estimators`]), a
//! recording of a BMS ([`rewind`]). Each gives a report of plain figures.

pub mod campaign;
pub mod cells;
pub mod estimators;
pub mod rewind;
pub mod trips;
