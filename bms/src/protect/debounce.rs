//! From samples to a trip: count, delay, heal.

/// One judgement of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Sample {
    /// Within the limit by more than the hysteresis.
    Good,
    /// Within the limit, by less than the hysteresis: not bad, and no sign of healing either.
    Near,
    /// Beyond the limit.
    Bad,
    /// Nobody knows.
    Missing,
}

/// When a row trips and heals, in judgements.
///
/// A bad sample adds one, a good or near one takes one back, between 0 and `count`. At `count` the
/// row is active; `delay` judgements later, unless all were taken back, it trips. So an event that stays
/// trips the row at the judgement `count + delay` after it: with judgements every P, at a time t
/// with (count − 1)·P + D < t ≤ count·P + D, D = delay·P.
///
/// Once tripped it heals after `heal` good samples without another between them, when all bad ones
/// are taken back. A missing sample heals nothing; it counts as `missing` bad ones, and as one at least where
/// the last sample that was seen was bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Debounce {
    /// Bad samples until it is active, at least 1.
    pub count: u16,
    /// Judgements from there until it trips.
    pub delay: u16,
    /// Good samples in a row that heal it, at least 1.
    pub heal: u16,
    /// How many bad samples a missing one counts as.
    pub missing: u8,
}

/// The state of a [`Debounce`]; the default has seen nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct DebounceState {
    bad: u16,
    good: u16,
    late: u16,
    last_bad: bool,
    active: bool,
    tripped: bool,
}

impl DebounceState {
    /// Before the first sample.
    pub const NEW: Self =
        Self { bad: 0, good: 0, late: 0, last_bad: false, active: false, tripped: false };

    /// Whether it has tripped and not healed since.
    #[must_use]
    pub const fn tripped(&self) -> bool {
        self.tripped
    }

    /// Whether samples since were bad: none, or all taken back.
    #[must_use]
    pub const fn quiet(&self) -> bool {
        self.bad == 0 && !self.active
    }
}

impl DebounceState {
    /// Whether nothing but a bad sample can change what it says: no sample counts against it, the last
    /// that was seen was not bad.
    pub(super) const fn rests(&self) -> bool {
        self.quiet() && !self.last_bad
    }
}

impl Debounce {
    /// One judgement; whether the row has tripped.
    pub const fn step(&self, state: &mut DebounceState, sample: Sample) -> bool {
        let was_active = state.active;
        let bad = match sample {
            Sample::Bad => 1,
            Sample::Missing if state.last_bad && self.missing == 0 => 1,
            Sample::Missing => self.missing as u16,
            Sample::Good | Sample::Near => 0,
        };
        match sample {
            Sample::Bad => {
                state.last_bad = true;
                state.good = 0;
            }
            Sample::Missing => state.good = 0,
            Sample::Near => {
                state.last_bad = false;
                state.good = 0;
                state.bad = state.bad.saturating_sub(1);
            }
            Sample::Good => {
                state.last_bad = false;
                state.bad = state.bad.saturating_sub(1);
                if state.good < self.heal {
                    state.good += 1;
                }
            }
        }
        state.bad = state.bad.saturating_add(bad);
        if state.bad >= self.count {
            state.bad = self.count;
            state.active = true;
        }
        // Before it trips, to have taken back every bad one is enough.
        if state.active && state.bad == 0 && (!state.tripped || state.good >= self.heal) {
            *state = DebounceState { good: state.good, ..DebounceState::NEW };
        }
        if state.active {
            if was_active && state.late < self.delay {
                state.late += 1;
            }
            if state.late >= self.delay {
                state.tripped = true;
            }
        }
        state.tripped
    }
}
