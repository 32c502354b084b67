//! One correction of an [`Ekf`](super::Ekf) by a voltage, as its header gives it.

use plant_core::num::Real;

use super::{EkfOutput, EkfState};

/// The terms of one correction with a given slope of the open-circuit curve \[Bierman1977, V.3\].
pub(super) struct Correction {
    pub slope_v: Real,
    /// Variance of the residual but for the model's error \[V²\].
    partial_v2: Real,
    /// One over the variance of the residual \[1/V²\].
    pub per_total: Real,
    /// What the residual has in common with the own part of the state of charge \[V\], times the
    /// weight that it gives the model's error.
    cross_v: Real,
    /// Correction of the state of charge for each volt of residual \[1/V\].
    pub soc_per_v: Real,
    /// Correction of the model's error, likewise.
    pub error_gain: Real,
}

impl Correction {
    #[inline(always)]
    pub(super) fn new(state: &EkfState, slope: Real, noise_v2: Real) -> Self {
        let weight = state.shared_per_v * slope + 1.0;
        let own_v = state.own_variance * slope;
        let error_v2 = state.error_variance_v2 * weight;
        let partial_v2 = noise_v2 + slope * own_v;
        let per_total = 1.0 / (partial_v2 + weight * error_v2);
        Self {
            slope_v: slope,
            partial_v2,
            per_total,
            cross_v: own_v * weight,
            soc_per_v: (own_v + state.shared_per_v * error_v2) * per_total,
            error_gain: error_v2 * per_total,
        }
    }

    /// What it does to the covariance.
    #[inline(always)]
    pub(super) fn shrink(&self, state: &mut EkfState, noise_v2: Real) {
        let per_partial = 1.0 / self.partial_v2;
        state.shared_per_v -= self.cross_v * per_partial;
        state.own_variance *= noise_v2 * per_partial;
        state.error_variance_v2 *= self.partial_v2 * self.per_total;
    }

    /// Corrects state and covariance by a residual.
    #[inline(always)]
    pub(super) fn apply(
        &self,
        state: &mut EkfState,
        residual_v: Real,
        noise_v2: Real,
    ) -> EkfOutput {
        state.residual_sum_v += residual_v;
        let correction = self.soc_per_v * residual_v;
        state.rise += correction;
        state.corrected += correction;
        state.error_v += self.error_gain * residual_v;
        self.shrink(state, noise_v2);
        EkfOutput { residual_v, rejected: false }
    }
}
