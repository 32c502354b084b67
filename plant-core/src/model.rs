//! The shape that every model shares, and the fixed step.

use crate::error::{ParamError, positive};
use crate::num::Real;

/// A model that advances a state by one fixed step, chosen when the model was made.
///
/// Pure: the same state and input give the same result, bit for bit, on every machine.
/// The trait is for wrappers (tracing, faults, replay) that work on any model; the models also
/// have `step` as a method of their own.
pub trait Model {
    /// What the model remembers: small and `Copy`, so a snapshot or a what-if run is a copy.
    type State: Copy;
    /// What comes in with each step.
    type Input: Copy;
    /// What comes out, at the end of the step.
    type Output: Copy;

    /// Advances `state` by one step.
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Output;
}

/// Ties a model's own `step` to the trait.
macro_rules! impl_model {
    ($model:ty, $state:ty, $input:ty, $output:ty) => {
        impl $crate::model::Model for $model {
            type State = $state;
            type Input = $input;
            type Output = $output;

            #[inline]
            fn step(&self, state: &mut $state, input: $input) -> $output {
                <$model>::step(self, state, input)
            }
        }
    };
}
pub(crate) use impl_model;

/// A fixed step \[s\], between 1e-12 and 1e12.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Dt(Real);

impl Dt {
    /// Checks a step given in seconds.
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] unless it is finite and in range.
    pub const fn from_s(seconds: Real) -> Result<Self, ParamError> {
        match positive("dt_s", seconds) {
            Ok(s) => Ok(Self(s)),
            Err(e) => Err(e),
        }
    }

    /// The step in seconds.
    #[must_use]
    pub const fn s(self) -> Real {
        self.0
    }
}
