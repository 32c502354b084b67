//! The whole BMS of `voltstep-bms`: a description, one state, a tick.

mod board;
mod convert;
mod handle;
mod params;
mod refusals;
mod report;
mod rows;
mod run;

pub use board::{VoltstepBmsFeedback, VoltstepBmsInputs, VoltstepBmsOutputs};
pub use handle::{
    VOLTSTEP_BMS_STATE_WORDS, VOLTSTEP_BMS_WORDS, VoltstepBms, VoltstepBmsState, voltstep_bms_init,
    voltstep_bms_params_typical, voltstep_bms_sheet_example, voltstep_bms_start,
};
pub use params::*;
pub use report::*;
pub use rows::*;
pub use run::*;

/// Cells in series that this library is built for.
pub(crate) const CELLS: usize =
    chosen(option_env!("VOLTSTEP_BMS_CELLS"), 18, VOLTSTEP_BMS_CELLS_MAX);
/// Temperatures that this library is built for.
pub(crate) const SENSORS: usize =
    chosen(option_env!("VOLTSTEP_BMS_SENSORS"), 4, VOLTSTEP_BMS_SENSORS_MAX);

/// A number from the environment of the build, checked while compiling.
const fn chosen(text: Option<&str>, or: usize, most: usize) -> usize {
    let Some(text) = text else { return or };
    let digits = text.as_bytes();
    let (mut number, mut i) = (0, 0);
    while i < digits.len() {
        assert!(digits[i].is_ascii_digit(), "VOLTSTEP_BMS_...: not a number");
        number = 10 * number + (digits[i] - b'0') as usize;
        assert!(number <= most, "VOLTSTEP_BMS_...: more than the interface has places for");
        i += 1;
    }
    assert!(number >= 1, "VOLTSTEP_BMS_...: at least 1");
    number
}
