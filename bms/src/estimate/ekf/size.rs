//! How large the model's error is, beside what was declared of it.

use plant_core::num::{Real, clamp, lag_gain, max, min, sqrt};

use super::{CONSISTENT, Ekf, EkfState};

/// It is looked at over so many times the charge after which it is another one. Chosen: fewer say
/// little of a mean square, more come late.
const ERRORS: Real = 6.0;
/// Its mean square may be so many times what was declared. Chosen: 2 % of the means of six squares lie
/// beyond, and most of them are of errors that are smaller than they were declared.
const MOST: Real = 2.5;
/// A start is doubted where it needs an error whose square is larger by this. Chosen: 5 % of all are.
const DOUBTED: Real = 4.0;
/// Doubt takes this long \[s\]. Chosen: what is outside for a minute should have been said.
const DOUBT_S: Real = 30.0;
/// A start is doubted until so many times the charge after which the error is another one has moved.
/// Chosen: two errors of it have then been seen.
const STARTS: Real = 2.0;
/// An error of which this share is not yet known tells of nothing else. Chosen: it keeps a quotient
/// of two small numbers finite.
const LEAST_LEARNT: Real = 0.01;

/// Mean square of the model's error over the charge that has moved \[Mehra1970\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Size {
    /// As it is estimated, and what that should be: what of its variance the voltage has taken away
    /// \[V²\]. Negative before the first.
    seen_v2: Real,
    expected_v2: Real,
    /// How many times larger its square is than was declared, at least 1.
    pub(super) factor2: Real,
    /// How much the start is still only what was told, 1 to 0.
    doubt: Real,
}

impl Size {
    pub(super) const NONE: Self =
        Self { seen_v2: -1.0, expected_v2: 0.0, factor2: 1.0, doubt: 1.0 };

    /// Whether it is about as large as was declared.
    pub(super) fn is_expected(&self) -> bool {
        self.factor2 <= MOST
    }
}

impl Ekf {
    /// Looks at the model's error after the state of charge has moved by `moved`, without its sign. One
    /// that is larger than was declared counts as such from then on.
    pub(super) fn follow_size(&self, state: &mut EkfState, mean_a: Real, moved: Real) {
        let known = &self.params.uncertainty;
        let size = state.slow.size;
        let error_v2 = state.slow.error_sd_v * state.slow.error_sd_v;
        let declared_v2 = error_v2 / size.factor2;
        let (seen_v, expected_v2) = if self.is_flat(state) {
            // Nothing is corrected: all that the voltage is off. More, and it leaves the flat part.
            let open_v2 = state.slow.trust.variance_then() * state.tangent_v * state.tangent_v;
            let v2 = declared_v2 + open_v2;
            let most_v = CONSISTENT * sqrt(v2);
            (clamp(state.error_v + state.slow.residual_v, -most_v, most_v), v2)
        } else {
            let learnt = max(1.0 - state.error_variance_v2 / error_v2, LEAST_LEARNT);
            self.doubt_start(state, declared_v2, learnt, mean_a);
            (state.error_v, declared_v2 * learnt)
        };
        let size = &mut state.slow.size;
        size.doubt *= 1.0 - lag_gain(moved / (STARTS * known.correlation_soc));
        if size.seen_v2 < 0.0 {
            // As if so many errors had been as declared.
            let v2 = known.open_circuit_sd_v * known.open_circuit_sd_v;
            (size.seen_v2, size.expected_v2) = (v2, v2);
        }
        let gain = lag_gain(moved / (ERRORS * known.correlation_soc));
        size.seen_v2 += gain * (seen_v * seen_v - size.seen_v2);
        size.expected_v2 += gain * (expected_v2 - size.expected_v2);
        size.factor2 = max(size.seen_v2 / size.expected_v2, 1.0);
    }

    /// A start that needs a large error of the model may as well be wrong itself.
    fn doubt_start(&self, state: &mut EkfState, declared_v2: Real, learnt: Real, mean_a: Real) {
        let load_v = state.slow.dynamics_ohm * mean_a;
        let expected_v2 = declared_v2 * learnt + load_v * load_v;
        let over = state.error_v * state.error_v / (DOUBTED * expected_v2) - 1.0;
        if over > 0.0 {
            // The residual's variance, in terms of the state of charge.
            let total = declared_v2 / (learnt * state.slope_v * state.slope_v);
            let gain = state.slow.size.doubt * lag_gain(self.dt_s * self.steps() / DOUBT_S);
            Self::widen(state, gain * over * min(total, 1.0));
        }
    }
}
