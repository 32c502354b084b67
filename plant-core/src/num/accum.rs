//! Compensated sums.

use super::Real;

/// A sum that keeps what each addition rounds away \[Kahan1965\].
///
/// A step adds increments a million times smaller than the value; a plain f32 drops them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Accum {
    value: Real,
    lost: Real,
}

impl Accum {
    /// Starts at `value`.
    #[inline]
    #[must_use]
    pub const fn new(value: Real) -> Self {
        Self { value, lost: 0.0 }
    }

    /// The sum so far.
    #[inline]
    #[must_use]
    pub const fn get(self) -> Real {
        self.value
    }

    /// Adds `increment`.
    #[inline]
    pub const fn add(&mut self, increment: Real) {
        let wanted = increment - self.lost;
        let sum = self.value + wanted;
        self.lost = (sum - self.value) - wanted;
        self.value = sum;
    }

    /// Holds it between two values.
    #[inline]
    pub const fn clamp(&mut self, low: Real, high: Real) {
        if self.value < low {
            *self = Self::new(low);
        } else if self.value > high {
            *self = Self::new(high);
        }
    }

    /// This sum minus `earlier`, with what both have kept back: exact to the last bit of the
    /// difference where the two are close.
    #[inline]
    #[must_use]
    pub const fn since(self, earlier: Self) -> Real {
        (self.value - earlier.value) - (self.lost - earlier.lost)
    }

    /// Adds another sum, with what it has kept back.
    #[inline]
    pub const fn add_sum(&mut self, other: Self) {
        self.add(other.value);
        self.add(-other.lost);
    }

    /// This sum times `factor`, with what it has kept back.
    #[inline]
    #[must_use]
    pub const fn scaled(self, factor: Real) -> Self {
        Self { value: self.value * factor, lost: self.lost * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn keeps_what_a_plain_sum_drops() {
        let (mut sum, mut plain): (Accum, Real) = (Accum::new(1.0), 1.0);
        for _ in 0..1_000_000 {
            sum.add(1e-8);
            plain += 1e-8;
        }
        assert!((sum.get() - 1.01).abs() < 2e-7);
        if cfg!(not(feature = "twin-f64")) {
            assert!((plain - 1.0).abs() < 1e-7, "the plain sum must be seen to fail");
        }
    }

    #[test]
    fn holds_between_its_ends() {
        for (value, held) in [(-0.1, 0.0), (0.4, 0.4), (1.5, 1.0)] {
            let mut sum = Accum::new(value);
            sum.clamp(0.0, 1.0);
            assert_eq!(sum, Accum::new(held));
        }
    }

    #[test]
    fn differences_and_sums_keep_the_rest() {
        let start = Accum::new(0.8);
        let mut end = start;
        end.add(-1e-9);
        assert!((end.since(start) + 1e-9).abs() < 1e-15);
        let mut total = Accum::new(-0.8);
        total.add_sum(end);
        assert!((total.get() + 1e-9).abs() < 1e-15);
    }
}
