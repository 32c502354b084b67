//! What is true of the models for any input and any parameters.
//!
//! | Module | What it holds |
//! |---|---|
//! | [`finite`], [`finite_plant`] | no input and no parameter makes a state or an output infinite; what is rejected changes nothing |
//! | [`passivity`] | without a source the stored energy never rises |
//! | [`charge`] | the state of charge stays within 0..1, and every coulomb is booked or refused |
//! | [`circuit`] | networks of any elements are refused by name, or settle in balance |
//! | [`drives`] | all of this for composed plants of two drives |
//! | [`limits`] | a battery limit holds wherever a duty can keep it |
//! | [`mapped`] | the same of a battery with maps, alone and in the plant |
//! | [`standstill`] | friction holds a vehicle on a slope exactly, up to its limit |
//! | [`ledger`] | the energy ledger closes, in `f32` and in its f64 twin |
//! | [`symmetry`] | mirrored inputs give the mirrored motion, bit for bit |
//! | [`monotony`] | more current, brake or duty acts in the direction that it should |
//! | [`refusal`] | every `new` refuses each bad field by name and takes what is valid |
//! | [`steady`] | the steady state does not depend on the step |
//!
//! [`draw`] makes up parameters, [`check`] inputs and what every model must keep. A failure prints
//! its smallest case. `PROPTEST_CASES` sets how many cases there are (256 by default; each
//! property scales it by its cost), `PROPTEST_RNG_SEED` makes a run repeatable.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "values are drawn and judged in f64, the models take f32"
)]

mod charge;
mod check;
mod circuit;
mod draw;
mod drives;
mod finite;
mod finite_plant;
mod ledger;
mod limits;
mod mapped;
mod monotony;
mod passivity;
mod refusal;
mod standstill;
mod steady;
mod symmetry;
