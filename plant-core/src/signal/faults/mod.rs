//! What goes wrong between a value and its reading: noise, drift, delay, and lapses (samples that
//! are missing, a reading that sticks, a wire that is open).
//!
//! Each takes a value and gives one, so they stand one after the other, before or behind a sensor of
//! [`sensors`](super::sensors) and its quantum. What is random comes from a seed in the parameters:
//! the same run gives the same bits on every machine. They are ours; the generator is PCG32
//! \[Oneill2014\], the normal distribution by \[BoxMuller1958\].
//!
//! Tests: below; properties `finite`, `refusal`; case "sensor faults".
//!
//! ```
//! use plant_core::signal::faults::{Delay, Lapse, LapseKind, LapseParams, Noise, NoiseParams};
//! use plant_core::{Dt, ParamError, must};
//!
//! const DT: Dt = must!(Dt::from_s(0.01));
//! const NOISE: Noise = must!(Noise::new(NoiseParams { sd: 0.002, seed: 7 }));
//! // A sample in a hundred is missing.
//! const GAPS: Lapse = must!(Lapse::new(
//!     LapseParams { kind: LapseKind::Missing, from_s: 0.0, chance: 0.01, length_s: 0.01, seed: 8 },
//!     DT,
//! ));
//! const LATE: Delay<3> = must!(Delay::new());
//!
//! let (mut noise, mut gaps, mut late) = (NOISE.start(), GAPS.start(), LATE.start(3.7)?);
//! let (mut missing, mut last) = (0, 0.0);
//! for _ in 0..10_000 {
//!     let noisy = NOISE.step(&mut noise, 3.7).value;
//!     let reading = GAPS.step(&mut gaps, LATE.step(&mut late, noisy).value);
//!     missing += u32::from(reading.missing);
//!     last = reading.value;
//! }
//! assert!((50..200).contains(&missing) && (last - 3.7_f32).abs() < 0.02);
//! # Ok::<(), ParamError>(())
//! ```

mod lapse;
mod random;
mod shift;

pub use lapse::{Lapse, LapseKind, LapseParams, LapseState};
pub use random::Random;
pub use shift::{
    Delay, DelayState, Drift, DriftParams, DriftState, Noise, NoiseParams, NoiseState,
};

use crate::num::Real;

/// What a fault makes of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Disturbed {
    /// The value that is read, in the unit of the one that came in.
    pub value: Real,
    /// No sample came: the value is the last one, and who reads it is told.
    pub missing: bool,
    /// The input was not finite or absurd: the value is the last one, the state is unchanged.
    pub rejected: bool,
}

#[cfg(test)]
mod tests;
