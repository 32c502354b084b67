//! How the voltage reacts where the current changes.
//!
//! Within a second the open-circuit voltage stays, whatever the curve is: a step of the current shows
//! as a step of the voltage, as large as the resistances make it. An ammeter that is dead, stuck or
//! the wrong way round shows here, on a flat curve too.

use plant_core::num::{Real, max, min};

use super::{Ekf, EkfState};

/// A change of current or voltage counts where it is above the noise by so many standard deviations.
/// Chosen: noise alone counts once in 400 samples.
const CHANGE_SDS: Real = 3.0;
/// So many changes are remembered: a rest has none, and proves nothing. Chosen: the doubt in a mean of
/// so many squares is a third of it.
const CHANGES: Real = 16.0;
/// The mean square of what was not expected may be so many times what it should be, or that times
/// [`CHANGES`] over the changes there were. Chosen: three standard deviations of the resistance; with
/// [`LARGEST`] a single spike, which is two changes, is no contradiction, five in a row are.
const MOST: Real = 9.0;
/// A single square counts up to this. Chosen: see [`MOST`].
const LARGEST: Real = 36.0;
/// A correction by more than this says nothing of the voltage's change. Chosen: less than a table's
/// point, so the tangent reaches as far.
const FAR_SOC: Real = 0.01;

/// What the changes have come to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Reaction {
    /// How many changes, each counting less with every later one; the sum of the squares of what the
    /// voltage did and the model did not expect \[V²\], and of what this should be, likewise.
    count: Real,
    seen_v2: Real,
    expected_v2: Real,
    /// As of the last refresh: the mean current \[A\], infinite where there is none to compare with;
    /// the residual less what was corrected; the model's error after it \[V\].
    current_a: Real,
    left_v: Real,
    error_v: Real,
}

impl Reaction {
    pub(super) const NONE: Self = Self {
        count: 0.0,
        seen_v2: 0.0,
        expected_v2: 0.0,
        current_a: Real::INFINITY,
        left_v: 0.0,
        error_v: 0.0,
    };

    /// Whether the voltage does what the current lets expect.
    pub(super) fn is_expected(&self) -> bool {
        self.seen_v2 * self.count <= MOST * CHANGES * self.expected_v2
    }

    /// The estimate was taken from the voltage alone: there is no residual to compare the next with.
    pub(super) const fn forget(&mut self) {
        self.current_a = Real::INFINITY;
    }

    /// Marks what the next corrections start from.
    pub(super) const fn mark(&mut self, error_v: Real) {
        self.error_v = error_v;
    }
}

impl Ekf {
    /// Compares the voltage's change since the last refresh with that of the current.
    pub(super) fn follow_reaction(&self, state: &mut EkfState, residual_v: Real, current_a: Real) {
        let noise_v = self.params.uncertainty.voltage_sd_v;
        let noise_v2 = 2.0 * noise_v * noise_v;
        let [fast_ohm, slow_ohm] = state.branch_ohm;
        let prompt_ohm = state.series_ohm + self.steps() * (fast_ohm + slow_ohm);
        // How a resistance is split into prompt and slow is known less than all of it.
        let prompt = 0.5 * (prompt_ohm / state.slow.total_ohm + 1.0);
        let unknown_ohm = state.slow.dynamics_ohm * prompt;
        let reaction = &mut state.slow.reaction;
        let corrected_v = state.error_v - reaction.error_v + state.tangent_v * state.corrected;
        let change_v = residual_v - reaction.left_v;
        let change_a = current_a - reaction.current_a;
        (reaction.current_a, reaction.left_v) = (current_a, residual_v - corrected_v);
        if residual_v == 0.0 || state.corrected.abs() > FAR_SOC {
            // Nothing was measured, or the tangent does not reach so far.
            reaction.forget();
        }
        let largest_v = max(change_v.abs(), (prompt_ohm * change_a).abs());
        if change_a.is_finite() && largest_v * largest_v > CHANGE_SDS * CHANGE_SDS * noise_v2 {
            let expected_v = unknown_ohm * change_a;
            let expected_v2 = noise_v2 + expected_v * expected_v;
            let seen_v2 = min(change_v * change_v, LARGEST * expected_v2);
            let keep = 1.0 - 1.0 / CHANGES;
            reaction.count = keep * reaction.count + 1.0;
            reaction.seen_v2 = keep * reaction.seen_v2 + seen_v2;
            reaction.expected_v2 = keep * reaction.expected_v2 + expected_v2;
        }
    }
}
