//! The offset of the current sensor and the capacity's error: what is wrong alike all the time.

use plant_core::num::{Real, max, min};

use super::{Ekf, EkfState, UNKNOWN_SD};

/// Where the voltage says much, the drift is as good as a random walk that reaches it after this
/// time \[s\]. Chosen: a drive.
const HORIZON_S: Real = 3600.0;

/// What one standard deviation of the drift has made of the estimate \[Schmidt1966\]: a
/// quantity that is not estimated, but whose correlation with the estimate is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Drift {
    of_soc: Real,
    /// Of the model's error \[V\].
    pub(super) of_error_v: Real,
    /// The own part of the state of charge's variance after the last refresh.
    own_then: Real,
}

impl Drift {
    pub(super) const NONE: Self = Self { of_soc: 0.0, of_error_v: 0.0, own_then: 0.0 };

    /// The estimate was taken from the voltage alone.
    pub(super) const fn forget(&mut self) {
        (self.of_soc, self.of_error_v) = (0.0, 0.0);
    }
}

impl Ekf {
    /// What the corrections since the last refresh have left of the drift. Without process noise
    /// in between, the product of all `I − K·H` is `I − J·P·Hᵀ·H` with the information J that came.
    pub(super) fn correct_drift(state: &mut EkfState) {
        let Drift { of_soc, of_error_v, own_then } = state.slow.drift;
        let (slope_v, own) = (state.slope_v, state.own_variance);
        if own < own_then && slope_v > 0.0 {
            let information = (own_then - own) / (own_then * own * slope_v * slope_v);
            let error_v2 = state.error_variance_v2 * (state.shared_per_v * slope_v + 1.0);
            let seen = information * (slope_v * of_soc + of_error_v);
            let drift = &mut state.slow.drift;
            drift.of_soc -= seen * (own * slope_v + state.shared_per_v * error_v2);
            drift.of_error_v -= seen * error_v2;
        }
    }

    /// What the drift of `drift_a` adds in the time between two refreshes: as a random walk, or,
    /// where the voltage has not held it, as the offset that it is, which adds up.
    pub(super) fn add_drift(&self, state: &mut EkfState, drift_a: Real) {
        let step = drift_a * state.soc_per_a * self.steps();
        let times = HORIZON_S / (self.dt_s * self.steps());
        let drift = &mut state.slow.drift;
        let more = max(step * step * times, step * (2.0 * drift.of_soc + step));
        drift.of_soc = min(drift.of_soc + step, UNKNOWN_SD);
        Self::widen(state, more);
        state.slow.drift.own_then = state.own_variance;
    }

    /// Adds to the own part of the variance; no more can be unknown than everything.
    pub(super) fn widen(state: &mut EkfState, variance: Real) {
        let most = max(state.own_variance, UNKNOWN_SD * UNKNOWN_SD);
        state.own_variance = min(state.own_variance + variance, most);
    }
}
