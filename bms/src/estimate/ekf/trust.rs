//! Whether what the voltage has taught adds up.

use plant_core::num::{Real, lag_gain, max, min};

use super::{CONSISTENT, Ekf, EkfState};

/// The corrections are summed over this time \[s\] … Chosen: a drive.
const SUMMED_S: Real = 3600.0;
/// … where the standard deviation is below this … Chosen: before, the filter
/// still looks for the state of charge.
const KNOWN_SD: Real = 0.1;
/// … and this variance of their sum is none. Chosen: 0.3 % of charge.
const SMALL_VARIANCE: Real = 1e-5;
/// The mean magnitude of the current follows over this time \[s\]. Chosen: some time constants of a
/// slow branch.
pub(super) const LOAD_MEMORY_S: Real = 300.0;
/// The residuals of a second are looked at over this time \[s\] … Chosen: that over which the load is
/// remembered.
const SQUARES_S: Real = LOAD_MEMORY_S;
/// … and remembered over this \[s\]: a rest proves nothing. Chosen: a drive.
const REMEMBERED_S: Real = 3600.0;
/// Their mean square may be so many times that of the model's error. Chosen: errors are correlated, so
/// such a mean is one of a few; measured cells in the cold reach 0.7.
const MOST_SQUARE: Real = 2.0;
/// A single one counts up to this. Chosen: ten standard deviations.
const LARGEST_SQUARE: Real = 100.0;

/// What the voltage has added to the state of charge in the last hour or so, and the variance that
/// this should have had: that by which it has reduced the variance of the state of charge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Trust {
    sum: Real,
    variance: Real,
    /// The variance of the state of charge after the last refresh.
    variance_then: Real,
    /// Mean square of the residual over that of the model's error.
    square: Real,
}

impl Trust {
    pub(super) const NONE: Self = Self { sum: 0.0, variance: 0.0, variance_then: 1.0, square: 0.0 };

    /// The variance of the state of charge after the last refresh.
    pub(super) const fn variance_then(&self) -> Real {
        self.variance_then
    }

    pub(super) fn is_earned(&self) -> bool {
        self.square <= MOST_SQUARE
            && self.sum * self.sum <= CONSISTENT * CONSISTENT * (self.variance + SMALL_VARIANCE)
    }
}

impl Ekf {
    /// Books the corrections since the last refresh, and its mean residual.
    pub(super) fn follow_trust(&self, state: &mut EkfState, residual_v: Real, mean_a: Real) {
        let open_v2 = state.slow.trust.variance_then * state.tangent_v * state.tangent_v;
        let load_v = state.slow.dynamics_ohm * mean_a;
        let error_sd_v = state.slow.error_sd_v;
        let expected_v2 = error_sd_v * error_sd_v + load_v * load_v + open_v2;
        // Where the curve is flat a residual alone says where the battery has gone.
        let square = if self.is_flat(state) {
            0.0
        } else {
            min(residual_v * residual_v / expected_v2, LARGEST_SQUARE)
        };
        let more = square - state.slow.trust.square;
        let over_s = if more > 0.0 { SQUARES_S } else { REMEMBERED_S };
        state.slow.trust.square += lag_gain(self.dt_s * self.steps() / over_s) * more;
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
        state.slow.reaction.mark(state.error_v);
    }
}
