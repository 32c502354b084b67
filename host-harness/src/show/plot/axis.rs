//! Axis ranges and ticks.

use super::text;

/// Larger values count as missing, so that no difference of two overflows.
const LARGEST: f64 = 1e100;
/// A range narrower than this part of its values is that of a constant ...
const FLAT_RELATIVE: f64 = 1e-6;
/// ... and so is one narrower than this.
const FLAT: f64 = 1e-12;

/// Whether a value can be drawn.
pub(super) fn is_drawable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// A range of values on an axis; `low` is less than `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Range {
    /// The smallest and the largest of the drawable values.
    fn extremes(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
        values.filter(|v| is_drawable(*v)).fold(None, |range, v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
    }

    fn is_flat(low: f64, high: f64) -> bool {
        high - low <= FLAT.max(FLAT_RELATIVE * low.abs().max(high.abs()))
    }

    /// A range for values, with some air above and below.
    pub(super) fn of_values(values: impl Iterator<Item = f64>) -> Self {
        let Some((low, high)) = Self::extremes(values) else {
            return Self { low: 0.0, high: 1.1 };
        };
        let air = if !Self::is_flat(low, high) {
            0.06 * (high - low)
        } else if low.abs().max(high.abs()) <= FLAT {
            1.1
        } else {
            0.11 * low.abs().max(high.abs())
        };
        Self { low: low - air, high: high + air }
    }

    /// A range for times, without air.
    pub(super) fn of_times(times: impl Iterator<Item = f64>) -> Self {
        match Self::extremes(times) {
            None => Self { low: 0.0, high: 1.0 },
            Some((low, high)) if high - low <= f64::EPSILON * 1e3 * high.abs().max(low.abs()) => {
                Self { low, high: low + low.abs().max(1.0) }
            }
            Some((low, high)) => Self { low, high },
        }
    }

    /// A range from zero to the values, without air.
    pub(super) fn from_zero(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = Self::extremes(values.chain([0.0])).unwrap_or((0.0, 0.0));
        if low < high { Self { low, high } } else { Self { low: 0.0, high: 1.0 } }
    }

    /// Length of the range.
    pub(super) fn span(self) -> f64 {
        self.high - self.low
    }

    /// Where a value lies: 0 at `low`, 1 at `high`.
    pub(super) fn part(self, value: f64) -> f64 {
        (value - self.low) / self.span()
    }
}

/// A tick: the value and its label.
pub(super) type Tick = (f64, String);

/// Ticks at round values (1, 2, or 5 times a power of ten), at most `most`.
pub(super) fn ticks(range: Range, most: f64) -> Vec<Tick> {
    let raw = range.span() / most;
    let power = raw.log10().floor();
    let unit = 10_f64.powf(power);
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * unit >= raw * (1.0 - 1e-9));
    // A factor of 10 is the next power of ten.
    let (power, step) = factor.map_or((power + 1.0, 10.0 * unit), |f| (power, f * unit));

    let largest = range.low.abs().max(range.high.abs());
    let label = |value: f64| {
        if largest >= 1e7 || power < -5.0 {
            text::scientific(value, whole(largest.log10().floor() - power))
        } else {
            text::fixed(value, whole(-power))
        }
    };
    let mut ticks = Vec::new();
    let mut index = (range.low / step - 1e-6).ceil();
    while index <= range.high / step + 1e-6 && ticks.len() < 100 {
        let value = index * step;
        ticks.push((value, label(value)));
        index += 1.0;
    }
    ticks
}

/// A number of decimals; negative ones count as none.
fn whole(decimals: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, reason = "a float to int `as` saturates")]
    #[expect(clippy::cast_sign_loss, reason = "negative values become zero")]
    let decimals = decimals.min(12.0) as usize;
    decimals
}
