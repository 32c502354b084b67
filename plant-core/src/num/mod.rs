//! The scalar, its functions, compensated sums, lookup tables. The only place that calls `libm`.
//!
//! `f32::max`, `f32::min` and `f32::clamp` become library calls or pull in a panic on target;
//! the functions here do not. Every function gives the same bits on every machine.

mod accum;
#[cfg(not(feature = "twin-f64"))]
mod root;
mod table;
#[cfg(feature = "serde")]
mod table_serde;
mod trig;
#[cfg(feature = "serde")]
pub mod unlimited;

pub use accum::Accum;
pub use table::{SOC_POINTS, SocTable};
pub use trig::{sin_cos_turns, wrap_turns};

#[cfg(all(feature = "micromath", not(feature = "twin-f64")))]
pub mod fast;

/// The scalar of every model: `f32`. The f64 twin compiles the same sources with `f64`.
#[cfg(not(feature = "twin-f64"))]
pub type Real = f32;
/// The scalar of every model, in the f64 twin.
#[cfg(feature = "twin-f64")]
pub type Real = f64;

/// The largest magnitude of an input or a state that is not refused as absurd.
pub const LARGEST: Real = 1e9;
/// The smallest magnitude of a parameter that must be above zero.
pub const SMALLEST_PARAM: Real = 1e-12;
/// The largest magnitude of a parameter.
pub const LARGEST_PARAM: Real = 1e12;
/// π.
#[cfg(not(feature = "twin-f64"))]
pub const PI: Real = core::f32::consts::PI;
/// π.
#[cfg(feature = "twin-f64")]
pub const PI: Real = core::f64::consts::PI;
/// Standard gravity \[m/s²\].
pub const GRAVITY_M_S2: Real = 9.80665;

/// The larger of two values; `b` where either is not a number.
#[inline]
#[must_use]
pub const fn max(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

/// The smaller of two values; `b` where either is not a number.
#[inline]
#[must_use]
pub const fn min(a: Real, b: Real) -> Real {
    if a < b { a } else { b }
}

/// `x` held between `low` and `high`; `x` where it is not a number. Where `low > high`, `low`.
#[inline]
#[must_use]
pub const fn clamp(x: Real, low: Real, high: Real) -> Real {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// Whether a magnitude is neither NaN nor infinite nor absurdly large.
#[inline]
#[must_use]
pub const fn sane(x: Real) -> bool {
    x.abs() <= LARGEST
}

/// The same for a sum of magnitudes, which is not negative.
#[inline]
#[must_use]
pub const fn sound(magnitude: Real) -> bool {
    magnitude <= LARGEST
}

/// −1, 0 or 1.
#[inline]
#[must_use]
pub const fn sign(x: Real) -> Real {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The gain of an implicit lag over `steps` = h/τ: `k = (h/τ)/(1 + h/τ)`, stepped as `x += k·(u − x)`.
#[inline]
#[must_use]
pub const fn lag_gain(steps: Real) -> Real {
    steps / (1.0 + steps)
}

/// Square root, correctly rounded.
#[inline]
#[must_use]
pub fn sqrt(x: Real) -> Real {
    #[cfg(not(feature = "twin-f64"))]
    return root::sqrt(x);
    #[cfg(feature = "twin-f64")]
    return libm::sqrt(x);
}

/// Exponential.
#[inline]
#[must_use]
pub fn exp(x: Real) -> Real {
    #[cfg(not(feature = "twin-f64"))]
    return libm::expf(x);
    #[cfg(feature = "twin-f64")]
    return libm::exp(x);
}

/// Natural logarithm.
#[inline]
#[must_use]
pub fn ln(x: Real) -> Real {
    #[cfg(not(feature = "twin-f64"))]
    return libm::logf(x);
    #[cfg(feature = "twin-f64")]
    return libm::log(x);
}

/// The largest whole number not above `x`.
#[inline]
#[must_use]
pub fn floor(x: Real) -> Real {
    #[cfg(not(feature = "twin-f64"))]
    return libm::floorf(x);
    #[cfg(feature = "twin-f64")]
    return libm::floor(x);
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn picks_and_holds_as_the_standard_functions_do() {
        for (a, b) in [(1.0, 2.0), (2.0, 1.0), (-0.5, -0.5), (Real::INFINITY, 0.0)] {
            assert_eq!((max(a, b), min(a, b)), (a.max(b), a.min(b)));
        }
        for x in [-2.0, -1.0, 0.3, 1.0, 7.0] {
            assert_eq!(clamp(x, -1.0, 1.0), x.clamp(-1.0, 1.0));
        }
        assert!(clamp(Real::NAN, -1.0, 1.0).is_nan());
        assert_eq!((sign(-3.0), sign(0.0), sign(0.1)), (-1.0, 0.0, 1.0));
    }

    #[test]
    fn knows_absurd_values() {
        for x in [Real::NAN, Real::INFINITY, -Real::INFINITY, 1.1e9, -1e38] {
            assert!(!sane(x), "{x}");
        }
        for x in [0.0, -1e9, 1e9, 1e-38] {
            assert!(sane(x), "{x}");
        }
    }

    #[test]
    fn roots_and_floors() {
        assert_eq!((sqrt(9.0), floor(-1.5), floor(2.0)), (3.0, -2.0, 2.0));
        assert!((lag_gain(1e9) - 1.0).abs() < 1e-6 && (lag_gain(1e-9) - 1e-9).abs() < 1e-15);
    }
}
