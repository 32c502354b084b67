//! Approximations from `micromath`, for those who choose them at the call site.
//!
//! Nothing in this crate uses them. How to decide: take one where its error below is small beside
//! what else you do not know, and the instructions that it saves on your core, which
//! `cargo xtask counts` puts into the book, are worth it. Not in a feedback loop or a sum, where
//! a bias adds up.

use micromath::F32Ext;

/// The range over which [`SQRT_ERROR`] is measured.
pub const SQRT_RANGE: (f32, f32) = (1e-6, 1e6);
/// The largest relative error of [`sqrt`] there; it is never too small.
pub const SQRT_ERROR: f32 = 0.0607;
/// The range over which [`EXP_ERROR`] is measured.
pub const EXP_RANGE: (f32, f32) = (-10.0, 10.0);
/// The largest relative error of [`exp`] there.
pub const EXP_ERROR: f32 = 0.0024;

/// Square root, within [`SQRT_ERROR`].
#[inline]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    F32Ext::sqrt(x)
}

/// Exponential, within [`EXP_ERROR`].
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    F32Ext::exp(x)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// The lowest and highest relative error at some numbers.
    fn errors(
        numbers: impl Iterator<Item = f32>,
        fast: fn(f32) -> f32,
        exact: fn(f32) -> f32,
    ) -> (f32, f32) {
        numbers.fold((0.0, 0.0), |(lowest, highest), x| {
            let error = fast(x) / exact(x) - 1.0;
            (error.min(lowest), error.max(highest))
        })
    }

    /// Neither more nor much less than stated.
    fn is_stated(largest: f32, stated: f32) -> bool {
        largest <= stated && largest > 0.99 * stated
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn the_errors_are_those_stated() {
        let (low, high) = SQRT_RANGE;
        let numbers = (low.to_bits()..=high.to_bits()).step_by(997).map(f32::from_bits);
        let (lowest, highest) = errors(numbers, sqrt, libm::sqrtf);
        assert!(lowest == 0.0 && is_stated(highest, SQRT_ERROR), "{lowest} {highest}");
        let (low, high) = EXP_RANGE;
        let numbers = (0..=1_000_000).map(|n| low + (high - low) * (n as f32 * 1e-6));
        let (lowest, highest) = errors(numbers, exp, libm::expf);
        assert!(-lowest < highest && is_stated(highest, EXP_ERROR), "{lowest} {highest}");
    }
}
