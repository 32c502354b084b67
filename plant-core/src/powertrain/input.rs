//! What a plant is told in each step.

use crate::battery::CurrentLimits;
use crate::converter::Gates;
use crate::mechanics::body::Road;
use crate::num::Real;

/// Input of a [`Powertrain`](super::Powertrain); `C` commands its drives. By default gates are off, the
/// road is flat, no limit is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainInput<C = Gates> {
    /// Command of the converter, or of all.
    pub gates: C,
    /// Slope, wind and friction brake.
    pub road: Road,
    /// Auxiliary power beside the parameter \[W\], ≥ 0.
    pub auxiliary_w: Real,
    /// What the battery's management allows; the lower of this and the battery's own holds.
    pub limits: CurrentLimits,
}

impl PowertrainInput {
    /// A duty on a flat road.
    #[inline]
    #[must_use]
    pub fn on(duty: Real) -> Self {
        Self::with(Gates::On(duty))
    }
}

impl<C: Default> PowertrainInput<C> {
    /// A command on a flat road.
    #[inline]
    #[must_use]
    pub fn with(gates: C) -> Self {
        Self { gates, ..Self::default() }
    }
}
