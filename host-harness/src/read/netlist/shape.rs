//! What drives an element over time.

use std::f64::consts::TAU;

use serde::Deserialize;

/// A value over time.
#[derive(Clone, Debug, PartialEq)]
pub enum Wave {
    /// Always the same.
    Constant(f64),
    /// `offset + amplitude·sin(2π·frequency·t + phase)`.
    Sine {
        /// Mean.
        offset: f64,
        /// Peak above the mean.
        amplitude: f64,
        /// Frequency \[Hz\].
        frequency_hz: f64,
        /// Phase \[°\].
        phase_deg: f64,
    },
    /// One value, from a time on another.
    Step {
        /// The first.
        before: f64,
        /// The other.
        after: f64,
        /// When it changes \[s\].
        at_s: f64,
    },
    /// High and low in turn.
    Square {
        /// The value that it begins with.
        low: f64,
        /// The other.
        high: f64,
        /// When it is high.
        pulse: Pulse,
    },
    /// Straight lines between points of time \[s\] and value, and level before and after.
    Table(Vec<(f64, f64)>),
}

/// On for a part of each period.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_field_names, reason = "all of them are seconds")]
pub struct Pulse {
    /// Period \[s\].
    pub period_s: f64,
    /// How long it is on in each \[s\].
    pub on_s: f64,
    /// When it is on for the first time \[s\].
    #[serde(default)]
    pub delay_s: f64,
}

impl Pulse {
    fn is_on(self, time_s: f64) -> bool {
        time_s >= self.delay_s && (time_s - self.delay_s).rem_euclid(self.period_s) < self.on_s
    }

    /// The key that is out of range, and its rule.
    pub(super) fn fault(self) -> Option<(&'static str, &'static str)> {
        if !(self.period_s > 0.0 && self.period_s.is_finite()) {
            Some(("period_s", "must be above zero and finite"))
        } else if !(0.0..=self.period_s).contains(&self.on_s) {
            Some(("on_s", "must lie in 0..period_s"))
        } else if !(self.delay_s >= 0.0 && self.delay_s.is_finite()) {
            Some(("delay_s", "must be zero or more and finite"))
        } else {
            None
        }
    }
}

impl Wave {
    /// Its value in the step of `step_s` that ends at `end_s`: where it jumps, that of the middle of
    /// the step, so that an edge on the grid is one.
    #[must_use]
    pub fn at(&self, end_s: f64, step_s: f64) -> f64 {
        let middle_s = end_s - 0.5 * step_s;
        match self {
            Self::Constant(value) => *value,
            Self::Sine { offset, amplitude, frequency_hz, phase_deg } => {
                offset + amplitude * (TAU * (frequency_hz * end_s + phase_deg / 360.0)).sin()
            }
            Self::Step { before, after, at_s } => {
                if middle_s < *at_s {
                    *before
                } else {
                    *after
                }
            }
            Self::Square { low, high, pulse } => {
                if pulse.is_on(middle_s) {
                    *high
                } else {
                    *low
                }
            }
            Self::Table(points) => between(points, end_s),
        }
    }

    /// Whether every number in it is finite and its times rise.
    pub(super) fn is_sound(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_finite(),
            Self::Sine { offset, amplitude, frequency_hz, phase_deg } => {
                [offset, amplitude, frequency_hz, phase_deg].iter().all(|x| x.is_finite())
            }
            Self::Step { before, after, at_s } => {
                [before, after, at_s].iter().all(|x| x.is_finite())
            }
            Self::Square { low, high, .. } => low.is_finite() && high.is_finite(),
            Self::Table(points) => {
                !points.is_empty()
                    && points.iter().all(|(t, x)| t.is_finite() && x.is_finite())
                    && points.windows(2).all(|pair| pair[0].0 < pair[1].0)
            }
        }
    }
}

fn between(points: &[(f64, f64)], time_s: f64) -> f64 {
    let after = points.partition_point(|(t, _)| *t <= time_s);
    match (after.checked_sub(1).and_then(|i| points.get(i)), points.get(after)) {
        (Some((t0, x0)), Some((t1, x1))) => x0 + (x1 - x0) * (time_s - t0) / (t1 - t0),
        (Some((_, x)), None) | (None, Some((_, x))) => *x,
        (None, None) => 0.0,
    }
}

/// When a gate is on.
#[derive(Clone, Debug, PartialEq)]
pub enum Gate {
    /// Off at first, and changes at each of these times \[s\], which rise.
    Toggles(Vec<f64>),
    /// On for a part of each period.
    Pulse(Pulse),
}

impl Gate {
    /// Always off.
    pub(super) const OFF: Self = Self::Toggles(Vec::new());

    /// Whether it is on in the step of `step_s` that ends at `end_s`: in its middle.
    #[must_use]
    pub fn is_on(&self, end_s: f64, step_s: f64) -> bool {
        let middle_s = end_s - 0.5 * step_s;
        match self {
            Self::Toggles(times) => times.partition_point(|t| *t <= middle_s) % 2 == 1,
            Self::Pulse(pulse) => pulse.is_on(middle_s),
        }
    }
}
