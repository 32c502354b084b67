//! What a [`CoulombCounter`] makes of the samples since its last review, and of a time without any.

use plant_core::num::{LARGEST_PARAM, clamp, max, min, sane};
use plant_core::{Accum, Real};

use crate::Health;

use super::{CoulombCounter, CoulombState, real};

/// A gap up to this is bridged \[s\]. Chosen: the usual time between two reviews.
const SINGLE_S: Real = 1.0;
/// A current has become any other after this time \[s\]. Chosen: that over
/// which the filter bridges a current.
const CHANGES_S: Real = 5.0;
/// A rest may miss this share of its samples. Chosen: what
/// a current of a tenth of the capacity in an hour brings in them, 0.1 % of it, is less than the curve
/// leaves open.
const REST_MISSED: Real = 0.02;
/// A time that nobody knows counts as this long for what may have flowed \[s\]. Chosen: a month.
const UNKNOWN_S: Real = 2.6e6;

impl CoulombCounter {
    /// Takes over a capacity that was learnt, where it is known better than was declared. What is not
    /// finite or not above zero is not taken.
    pub fn adopt(&self, state: &mut CoulombState, health: &Health) {
        let (capacity_ah, sd) = (health.capacity_ah, health.capacity_sd_ah / health.capacity_ah);
        if sane(capacity_ah) && capacity_ah > 0.0 && (0.0..=self.capacity_sd).contains(&sd) {
            state.per_capacity = self.capacity_ah / capacity_ah;
            state.capacity_sd = Some(sd);
        }
    }

    /// Says that the battery stood for `elapsed_s` \[s\] without a current while nothing was
    /// counted; the standard deviation of what flows all the same is `standby_sd_a` \[A\]. It is a
    /// rest. `None`, or what is no time, is an unknown one, and no rest.
    pub fn pause(&self, state: &mut CoulombState, elapsed_s: Option<Real>, standby_sd_a: Real) {
        let known = elapsed_s.filter(|seconds| (0.0..=LARGEST_PARAM).contains(seconds));
        let charge_as = max(standby_sd_a, 0.0) * known.unwrap_or(UNKNOWN_S);
        state.unseen_soc.add(min(charge_as * self.soc_per_a / self.dt_s, 1.0));
        match known {
            Some(seconds) => state.rested_s.add(seconds),
            None => state.rested_s = Accum::new(0.0),
        }
    }

    /// Books what was counted; whether the battery rested.
    pub(super) fn book(&self, state: &mut CoulombState) -> bool {
        let (steps, missed_steps) = (real(state.steps), real(state.missed_steps));
        let (elapsed_s, missed_s) =
            (min(steps * self.dt_s, LARGEST_PARAM), min(missed_steps * self.dt_s, LARGEST_PARAM));
        let seen = steps - missed_steps;
        // Single missing samples are taken for the mean of those around them.
        let bridges = 2.0 * missed_steps <= steps && missed_s <= SINGLE_S;
        let bridged = if bridges && seen > 0.0 { steps / seen } else { 1.0 };
        let taken_soc = bridged * self.taken_soc(state);
        state.soc.add(-taken_soc);
        // The truth lies within 0..1, so this only brings the count nearer to it.
        if !(0.0..=1.0).contains(&state.soc.get()) {
            state.soc = Accum::new(clamp(state.soc.get(), 0.0, 1.0));
        }
        state.taken_soc.add(taken_soc);
        state.moved_soc.add(taken_soc.abs());
        let unseen_soc = min(missed_steps * (self.largest_current_a * self.soc_per_a), 1.0);
        if bridges {
            // From one gap to the next another error; within a short one the current hardly moves.
            state.bridged_variance += unseen_soc * unseen_soc * (missed_s / CHANGES_S);
        } else {
            state.unseen_soc.add(unseen_soc);
        }
        state.counted_s.add(elapsed_s);
        state.rested_s.add(elapsed_s);
        state.rest_missed_s += missed_s;
        // The mean, and one sample of it: a ripple without a mean would bend the voltage too. What
        // was missed neither proves a rest nor ends it.
        let saw_nothing = seen <= 0.0;
        let resting = missed_s <= SINGLE_S
            && !(saw_nothing && state.saw_nothing)
            && state.rest_missed_s <= REST_MISSED * state.rested_s.get() + SINGLE_S
            && state.net_a().abs() <= self.rest_current_a * seen
            && state.last_a.abs() <= self.rest_current_a;
        state.saw_nothing = saw_nothing;
        (state.earlier_a, state.last_a) = (0.0, 0.0);
        (state.steps, state.missed_steps) = (0, 0);
        resting
    }
}
