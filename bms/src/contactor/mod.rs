//! Contactors: when they close and open, as a pure state machine, and a thin driver.
//!
//! [`classify`](LinkTrend::of) and its like turn measurements into classes, [`PrechargeWatch`] judges
//! the link while it is charged, [`ContactorControl::step`] sees only such classes and gives coils:
//! so a walk over every state and every class of input is a walk over the code itself, and a test
//! takes it. [`Contactors`] puts coils on pins and reads the feedback.
//!
//! One string of cells, one main contactor at either pole, a precharge resistor with a contactor of
//! its own across the positive one.
//!
//! | Phase | Closed | Leaves when |
//! |---|---|---|
//! | `Start` | – | all show open → `Standby`, or `Fault` where one is remembered; limit → `Fault` |
//! | `Standby` | – | request renewed since reset or fault, permit, resistor cool → `CloseMinus` |
//! | `CloseMinus` | minus | minus shows closed, settled → `Precharge`; link rises → out |
//! | `Precharge` | minus, precharge | charged, both show closed → `ClosePlus`; short, open, slow, limit → out |
//! | `ClosePlus` | all | plus shows closed → `OpenPrecharge`; limit → out |
//! | `OpenPrecharge` | minus, plus | precharge shows open → `Closed`; limit → out |
//! | `Closed` | minus, plus | request ends, trip, one drops → `Shed` |
//! | `Shed` | minus, plus | the current can be broken, or was waited for long enough → `OpenFirst` |
//! | `OpenFirst` | minus | plus shows open, or limit → `OpenSecond` |
//! | `OpenSecond` | – | all show open, or limit → `WeldCheck` |
//! | `WeldCheck` | – | the link falls; limit → `Cooldown`, or `Fault` where one shows closed |
//! | `Cooldown` | – | time → `Standby` |
//! | `Fault` | – | cleared as its cause needs, no request, no trip → `Standby` |
//!
//! It is ours. Tests: `tests` below.

mod classify;
mod driver;
mod machine;
mod precharge;
mod state;

pub use classify::{LinkTrend, LinkTrendParams, LinkTrendState, current_class};
pub use driver::{Contactors, PinFaults};
pub use machine::{ContactorControl, ContactorParams};
pub use precharge::{PrechargeInput, PrechargeParams, PrechargeState, PrechargeWatch};
pub use state::{
    Cause, Coils, ContactorInput, ContactorState, CurrentClass, Feedback, LinkClass, Phase, Watch,
};

#[cfg(test)]
mod tests;
