//! What is true of the pack's measurements, coulomb counter, cells and record for any input.
//!
//! | Module | What it holds |
//! |---|---|
//! | [`finite`] | no input makes a state or an output infinite; what is missing is flagged |
//! | [`coulomb`] | the count's standard deviation covers what it does not know |
//! | [`cells`] | so does that of each cell |
//! | [`record`] | a torn write, a wrong bit, a power cut give the older record or none |
//! | [`power_cut`] | nor does the whole BMS lose more than the running interval, at any step of a drive |
//!
//! [`draw`] makes up inputs. `PROPTEST_CASES` sets how many cases there are.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "values are drawn and judged in f64, the models take f32"
)]

mod cells;
mod coulomb;
mod draw;
mod finite;
mod flash;
mod power_cut;
mod record;

// The pack of the example, and its board.
#[path = "../../../bms/examples/own_pack/hardware.rs"]
mod hardware;
#[path = "../../../bms/examples/own_pack/pack.rs"]
#[allow(dead_code, reason = "another loop drives it here")]
mod pack;
