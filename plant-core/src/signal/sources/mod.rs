//! Sources: inputs over time; and two helpers that stand between a source and a model.
//!
//! A source says its value at the **current** instant, then its time moves on by one step: the
//! first call gives the value at time zero. None of them adds up absolute time for ever: events
//! are counted down to, waves keep their phase, tables the time within a segment, so an hour in
//! `f32` is as exact as a second.

mod edges;
mod signal;
mod table;
mod waves;

pub use edges::{ElapsedState, Ramp, RampParams, Step, StepParams};
pub use signal::{
    Saturation, SaturationOutput, SaturationParams, UnitDelay, UnitDelayOutput, UnitDelayParams,
    UnitDelayState,
};
pub use table::{AtEnd, TimeTable, TimeTableOutput, TimeTableParams, TimeTableState};
pub use waves::{PhaseState, Sine, SineParams, Square, SquareParams};
