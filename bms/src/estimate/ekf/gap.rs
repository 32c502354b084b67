//! Samples that are missing.

use plant_core::num::{Real, max, min, sqrt};

use super::{Ekf, EkfOutput, EkfState, UNKNOWN_SD};

/// A current that is not seen is taken to go on as it was, and to fade over this time \[s\]. Chosen:
/// in a drive it is another one by then.
const BRIDGED_S: Real = 5.0;
/// What an outlier adds to the standard deviation of the state of charge, per square root of a
/// second: what keeps on contradicting the filter wins. Chosen: 2 % in a minute.
const DISTRUST: Real = 0.003;

/// The time without a current that is going on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Gap {
    /// How long it has lasted \[s\], and what it leaves open of the state of charge.
    seconds: Real,
    sd: Real,
    /// The sum of the residuals during it \[V\]: another one ends it. Infinite: none goes on.
    residual_sum_v: Real,
}

impl Gap {
    pub(super) const NONE: Self = Self { seconds: 0.0, sd: 0.0, residual_sum_v: Real::INFINITY };

    /// The residuals are summed anew.
    pub(super) fn refresh(&mut self, residual_sum_v: Real) {
        let going_on = self.residual_sum_v == residual_sum_v;
        self.residual_sum_v = if going_on { 0.0 } else { Real::INFINITY };
    }
}

impl Ekf {
    /// A step without a voltage, or without a current.
    #[cold]
    #[inline(never)]
    pub(super) fn miss(&self, state: &mut EkfState, current_a: Real) -> EkfOutput {
        let seen = current_a.abs() <= self.largest_a;
        let current_a = if seen { current_a } else { self.bridge(state) };
        state.current_sum_a += current_a;
        let current_a = current_a - state.current_offset_a;
        self.polarise(state, current_a);
        state.rise -= current_a * state.soc_per_a;
        EkfOutput { residual_v: 0.0, rejected: true }
    }

    /// The current that probably flows \[A\], and what is not known of it: its error is the same
    /// within a gap, another one in the next.
    fn bridge(&self, state: &mut EkfState) -> Real {
        if state.slow.gap.residual_sum_v != state.residual_sum_v {
            state.slow.gap = Gap { residual_sum_v: state.residual_sum_v, ..Gap::NONE };
        }
        let gap = &mut state.slow.gap;
        gap.seconds += self.dt_s;
        let gone = min(gap.seconds / BRIDGED_S, 1.0);
        let unseen_a = min(self.params.unseen_current_a, self.largest_a) * sqrt(gone);
        let sd = unseen_a * state.soc_per_a;
        let more = sd * (2.0 * gap.sd + sd);
        gap.sd = min(gap.sd + sd, UNKNOWN_SD);
        let [fast_ohm, slow_ohm] = state.branch_ohm;
        let sd_v = state.slow.polarisation_sd_v;
        let most_v = unseen_a * state.slow.polarisation_ohm;
        state.slow.polarisation_sd_v =
            max(sd_v, min(sd_v + unseen_a * (fast_ohm + slow_ohm), most_v));
        Self::widen(state, more);
        (1.0 - gone) * state.last_a
    }

    /// A voltage that contradicts the filter is not used, but makes it less sure.
    pub(super) fn distrust(&self, state: &mut EkfState) {
        Self::widen(state, DISTRUST * DISTRUST * self.dt_s);
    }
}
