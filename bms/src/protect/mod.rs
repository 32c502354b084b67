//! What must not be, and what follows where it is: diagnosis as a table of typed rows.
//!
//! [`PackSheet`] describes the pack in the terms of its data sheets. [`Table::new`] derives from it,
//! when compiling, one [`Row`] for each [`Id`]: threshold, hysteresis, count, delay, severity,
//! reaction, and who may end it. [`Protection::step`] looks at the measurements, a share of the cells
//! in each call, and lets each row judge what it watches; a [`Debounce`] turns samples into trips.
//!
//! How the limits follow from the sheet: MOL is the limit of operation. MSL is the absolute limit less
//! three times the sensor's error and less what the quantity moves until the contactors are open at
//! its worst credible rate. RSL lies between. Those of current, voltage and temperature trip within
//! [`CURRENT_BUDGET_S`], [`VOLTAGE_BUDGET_S`] and [`TEMPERATURE_BUDGET_S`], missing data within
//! [`STALE_BUDGET_S`]. The three levels are those of \[FoxBms2\]; the derivation is ours.
//!
//! Tests: `tests` below.

mod debounce;
mod derive;
mod example;
mod id;
mod look;
mod protection;
mod row;
mod sheet;
mod signals;
mod steady;
mod table;
mod warming;

pub use debounce::{Debounce, DebounceState, Sample};
pub use derive::{CURRENT_BUDGET_S, STALE_BUDGET_S, TEMPERATURE_BUDGET_S, VOLTAGE_BUDGET_S};
pub use example::EXAMPLE;
pub use id::{Contactor, Faults, Flow, Id, Level, PrechargeFault, ROWS, Side, Source};
pub use protection::{Protection, ProtectionState};
pub use row::{Clear, Pace, Reaction, Row, Seen, Trip};
pub use sheet::{
    Actuators, CellSheet, Currents, Layout, PackSheet, Sensing, Sensor, VoltageWindow,
};
pub use signals::{Signals, Verdict};
pub use table::Table;

#[cfg(test)]
mod tests;
