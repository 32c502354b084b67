//! Approximations from `micromath`, for those who choose them at the call site.
//!
//! Nothing in this crate uses them. Errors: `sqrt` up to 6 %, `exp` 0.24 %.

use micromath::F32Ext;

/// Square root, within 6 %.
#[inline]
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    F32Ext::sqrt(x)
}

/// Exponential, within 0.24 %.
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    F32Ext::exp(x)
}
