//! Sine and cosine of an angle counted in turns, without double precision.
//!
//! `libm::sinf` computes in f64, which a single-precision core must emulate.

use super::{PI, Real, floor};

/// Brings an angle in turns into 0..1.
#[inline]
#[must_use]
pub fn wrap_turns(turns: Real) -> Real {
    let wrapped = turns - floor(turns);
    // A tiny negative angle rounds up to a whole turn.
    if wrapped < 1.0 { wrapped } else { 0.0 }
}

/// Sine and cosine of `turns` whole turns, to 2e-7 in f32 (about 1e-8 in the f64 twin).
#[must_use]
pub fn sin_cos_turns(turns: Real) -> (Real, Real) {
    let quarters = 4.0 * wrap_turns(turns);
    let nearest = floor(quarters + 0.5);
    let x = (quarters - nearest) * (0.5 * PI); // within ±π/4
    let x2 = x * x;
    // Taylor series, cut where the next term is below 1e-8 at π/4.
    let sin = x * (1.0 - x2 / 6.0 * (1.0 - x2 / 20.0 * (1.0 - x2 / 42.0 * (1.0 - x2 / 72.0))));
    let cos = 1.0
        - x2 / 2.0 * (1.0 - x2 / 12.0 * (1.0 - x2 / 30.0 * (1.0 - x2 / 56.0 * (1.0 - x2 / 90.0))));
    // 0, 1, 2, 3 or 4 quarter turns were taken off.
    if !(0.5..=3.5).contains(&nearest) {
        (sin, cos)
    } else if nearest < 1.5 {
        (cos, -sin)
    } else if nearest < 2.5 {
        (-sin, -cos)
    } else {
        (-cos, sin)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn agrees_with_the_standard_functions() {
        for i in -2000..2000 {
            let turns = i as Real / 777.0;
            let angle = f64::from(turns) * std::f64::consts::TAU;
            let (s, c) = sin_cos_turns(turns);
            // A negative angle is rounded when it is wrapped.
            let within = if turns < 0.0 { 5e-7 } else { 2e-7 };
            assert!((f64::from(s) - angle.sin()).abs() < within, "sin {turns}");
            assert!((f64::from(c) - angle.cos()).abs() < within, "cos {turns}");
        }
    }

    #[test]
    fn wraps_into_one_turn() {
        for t in [-3.25, -1e-9, 0.0, 0.999, 1.0, 17.5] {
            assert!((0.0..1.0).contains(&wrap_turns(t)), "{t}");
        }
        assert_eq!(wrap_turns(-3.25), 0.75);
    }
}
