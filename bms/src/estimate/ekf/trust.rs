//! Whether what the voltage has taught adds up.

use plant_core::num::{Real, lag_gain, max, min};

use super::{CONSISTENT, Ekf, EkfState};

/// The corrections are summed over this time \[s\] … Chosen: a drive.
const SUMMED_S: Real = 3600.0;
/// … where the standard deviation is below this … Chosen: before, the filter still looks for the state of charge.
const KNOWN_SD: Real = 0.1;
/// … and this variance of their sum is none. Chosen: 0.3 % of charge.
const SMALL_VARIANCE: Real = 1e-5;
/// The residuals of a second are looked at over this time \[s\], and remembered over this \[s\]: a
/// rest proves nothing. Their mean square may be so many times that of the model's error.
/// Chosen.
const SQUARES_S: Real = 300.0;
const REMEMBERED_S: Real = 3600.0;
const MOST_SQUARE: Real = 2.0;
/// A change of current or voltage counts where it is above the noise by so many standard deviations.
const CHANGE_SDS: Real = 3.0;
/// So many changes are remembered: a rest has none, and proves nothing. Chosen: the doubt in a mean of
/// so many squares is a third of it.
const CHANGES: Real = 16.0;
/// The mean square of what was not expected may be so many times what it should be, or that times
/// [`CHANGES`] over the changes there were. Chosen: with [`LARGEST_CHANGE`] a single spike, which is
/// two changes, is no contradiction, five in a row are.
const MOST_REACTION: Real = 4.0;
/// A correction by more than this says nothing of the voltage's change. Chosen: two points of the
/// curve's table are further apart.
const FAR_SOC: Real = 0.01;
/// A single one counts up to this.
const LARGEST_CHANGE: Real = 16.0;
/// A single one counts up to this. Chosen: ten standard deviations.
const LARGEST_SQUARE: Real = 100.0;

/// What the voltage has added to the state of charge in the last hour or so, and the variance that
/// this should have had: that by which it has reduced the variance of the state of charge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Trust {
    sum: Real,
    variance: Real,
    /// The variance of the state of charge after the last refresh.
    variance_then: Real,
    /// Mean square of the residual over that of the model's error.
    square: Real,
    reaction: Reaction,
}

/// How the voltage reacts where the current changes: within a second the open-circuit voltage stays,
/// whatever the curve is. A sensor that is dead, stuck or the wrong way round shows here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Reaction {
    /// How many changes, each counting less with every later one; the sum of the squares of what the
    /// voltage did and the model did not expect \[V²\], and of what this should be, likewise.
    count: Real,
    seen_v2: Real,
    expected_v2: Real,
    /// As of the last refresh: the mean current \[A\], infinite where there is none to compare with,
    /// and the residual less what was corrected \[V\].
    current_a: Real,
    left_v: Real,
    error_v: Real,
}

impl Reaction {
    const NONE: Self = Self {
        count: 0.0,
        seen_v2: 0.0,
        expected_v2: 0.0,
        current_a: Real::INFINITY,
        left_v: 0.0,
        error_v: 0.0,
    };
}

impl Trust {
    pub(super) const NONE: Self =
        Self { sum: 0.0, variance: 0.0, variance_then: 1.0, square: 0.0, reaction: Reaction::NONE };

    pub(super) fn is_earned(&self) -> bool {
        let Reaction { count, seen_v2, expected_v2, .. } = self.reaction;
        self.square <= MOST_SQUARE
            && seen_v2 * count <= MOST_REACTION * CHANGES * expected_v2
            && self.sum * self.sum <= CONSISTENT * CONSISTENT * (self.variance + SMALL_VARIANCE)
    }
}

impl Trust {
    /// The estimate was taken from the voltage alone: there is no residual to compare the next with.
    pub(super) const fn forget_reaction(&mut self) {
        self.reaction.current_a = Real::INFINITY;
    }
}

impl Ekf {
    /// Compares the voltage's change since the last refresh with that of the current.
    pub(super) fn follow_reaction(&self, state: &mut EkfState, residual_v: Real, current_a: Real) {
        let corrected_v =
            state.error_v - state.slow.trust.reaction.error_v + state.tangent_v * state.corrected;
        let noise_v2 =
            2.0 * self.params.uncertainty.voltage_sd_v * self.params.uncertainty.voltage_sd_v;
        let (total_ohm, dynamics_ohm) = (state.slow.total_ohm, state.slow.dynamics_ohm);
        let reaction = &mut state.slow.trust.reaction;
        let change_v = residual_v - reaction.left_v;
        let change_a = current_a - reaction.current_a;
        let known = change_a.is_finite();
        (reaction.current_a, reaction.left_v) = (current_a, residual_v - corrected_v);
        if residual_v == 0.0 || state.corrected.abs() > FAR_SOC {
            // Nothing was measured, or the tangent does not reach so far.
            reaction.current_a = Real::INFINITY;
        }
        let largest_v = max(change_v.abs(), (total_ohm * change_a).abs());
        if known && largest_v * largest_v > CHANGE_SDS * CHANGE_SDS * noise_v2 {
            let expected_v = dynamics_ohm * change_a;
            let expected_v2 = noise_v2 + expected_v * expected_v;
            let seen_v2 = min(change_v * change_v, LARGEST_CHANGE * expected_v2);
            let keep = 1.0 - 1.0 / CHANGES;
            reaction.count = keep * reaction.count + 1.0;
            reaction.seen_v2 = keep * reaction.seen_v2 + seen_v2;
            reaction.expected_v2 = keep * reaction.expected_v2 + expected_v2;
        }
    }

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
        state.slow.trust.reaction.error_v = state.error_v;
    }
}
