//! Random numbers that are the same everywhere.

use crate::num::{Real, ln, sin_cos_turns, sqrt};

/// A generator of 2⁶⁴ numbers, PCG32 \[Oneill2014\].
///
/// ```
/// use plant_core::signal::faults::Random;
///
/// let (mut one, mut other) = (Random::new(1), Random::new(1));
/// assert_eq!(one.bits(), other.bits());
/// assert_ne!(one.bits(), Random::new(2).bits());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Random {
    state: u64,
}

const MULTIPLIER: u64 = 6_364_136_223_846_793_005;
/// Which of its sequences: any odd number.
const INCREMENT: u64 = 1_442_695_040_888_963_407;
/// 2⁻²⁴.
const UNIT: Real = 1.0 / 16_777_216.0;

impl Random {
    /// The sequence of a seed.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        let seeded = INCREMENT.wrapping_add(seed as u64);
        Self { state: seeded.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT) }
    }

    /// The next 32 bits.
    #[inline]
    pub const fn bits(&mut self) -> u32 {
        let state = self.state;
        self.state = state.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT);
        #[expect(clippy::cast_possible_truncation, reason = "the generator cuts it here")]
        let mixed = (((state >> 18) ^ state) >> 27) as u32;
        mixed.rotate_right((state >> 59) as u32)
    }

    /// The next number, even over 0..1, 1 not included.
    #[inline]
    #[cfg_attr(
        not(feature = "twin-f64"),
        expect(clippy::cast_precision_loss, reason = "24 bits fit")
    )]
    pub const fn ratio(&mut self) -> Real {
        (self.bits() >> 8) as Real * UNIT
    }

    /// The next number of a normal distribution with mean 0 and standard deviation 1
    /// \[BoxMuller1958\], within ±5.8.
    #[inline]
    pub fn normal(&mut self) -> Real {
        // Never zero, so that its logarithm is finite.
        let (radius, turns) = (1.0 - self.ratio(), self.ratio());
        sqrt(-2.0 * ln(radius)) * sin_cos_turns(turns).1
    }
}
