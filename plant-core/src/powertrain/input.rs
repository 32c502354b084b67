//! What a plant is told in each step.

use crate::battery::CurrentLimits;
use crate::converter::Gates;
use crate::mechanics::body::Road;
use crate::num::Real;

/// Input of a [`Powertrain`](super::Powertrain). By default gates are off, the road is flat, no limit is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PowertrainInput {
    /// Command of the converter.
    pub gates: Gates,
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
        Self { gates: Gates::On(duty), ..Self::default() }
    }
}
