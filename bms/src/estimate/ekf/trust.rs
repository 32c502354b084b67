//! Whether what the voltage has taught adds up.

use plant_core::num::{Real, lag_gain, max};

use super::{CONSISTENT, Ekf, EkfState};

/// The corrections are summed over this time \[s\] …
const SUMMED_S: Real = 3600.0;
/// … where the standard deviation is below this …
const KNOWN_SD: Real = 0.1;
/// … and this variance of their sum is none.
const SMALL_VARIANCE: Real = 1e-5;

/// What the voltage has added to the state of charge in the last hour or so, and the variance that
/// this should have had: that by which it has reduced the variance of the state of charge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Trust {
    sum: Real,
    variance: Real,
    /// The variance of the state of charge after the last refresh.
    variance_then: Real,
}

impl Trust {
    pub(super) const NONE: Self = Self { sum: 0.0, variance: 0.0, variance_then: 1.0 };

    pub(super) fn is_earned(&self) -> bool {
        self.sum * self.sum <= CONSISTENT * CONSISTENT * (self.variance + SMALL_VARIANCE)
    }
}

impl Ekf {
    /// Books the corrections since the last refresh.
    pub(super) fn follow_trust(&self, state: &mut EkfState) {
        let reduced = max(state.slow.trust.variance_then - state.variance(), 0.0);
        let keep = 1.0 - lag_gain(self.dt_s * self.steps() / SUMMED_S);
        let trust = &mut state.slow.trust;
        if trust.variance_then < KNOWN_SD * KNOWN_SD {
            trust.sum = keep * trust.sum + state.corrected;
            trust.variance = keep * keep * trust.variance + reduced;
        } else {
            (trust.sum, trust.variance) = (0.0, 0.0);
        }
        state.corrected = 0.0;
    }

    /// Marks where the next corrections start from.
    pub(super) fn mark_trust(state: &mut EkfState) {
        state.slow.trust.variance_then = state.variance();
    }
}
