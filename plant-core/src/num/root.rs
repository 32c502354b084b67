//! The square root, correctly rounded, so it has the bits of every machine's own instruction.

/// Square root: Newton's method, then the last bit by integers.
///
/// Where the machine has an instruction, safe code cannot reach it without the standard library,
/// and `libm`'s routine for the others takes 0.5 kB of flash.
pub fn sqrt(x: f32) -> f32 {
    let bits = x.to_bits();
    let is_normal = bits.wrapping_sub(0x0080_0000) < 0x7f00_0000;
    if is_normal { normal(bits) } else { rare(x) }
}

/// The root of zero, of what is subnormal, and of what has none.
#[cold]
#[inline(never)]
fn rare(x: f32) -> f32 {
    if x > 0.0 && x < f32::INFINITY {
        // Has no leading one. Both factors are powers of four, so nothing is rounded.
        normal((x * 16_777_216.0).to_bits()) * (1.0 / 4096.0)
    } else if x < 0.0 {
        f32::NAN
    } else {
        x
    }
}

#[inline]
const fn normal(bits: u32) -> f32 {
    // x = 4^half · y with y in 1..4.
    let exponent = bits.wrapping_sub(0x3f80_0000);
    let half = exponent & 0xff00_0000;
    let y = f32::from_bits(bits.wrapping_sub(half));
    // A parabola within 0.6 %, then to a ten thousandth of a millionth but for rounding.
    let mut root = (0.526 - 0.03954 * y) * y + 0.5186;
    root = 0.5 * (root + y / root);
    root = 0.5 * (root + y / root);
    // One unit in the last place is put right: with r = root·2^23 the nearest is r where y·2^46
    // lies between (r − ½)² and (r + ½)². The difference is small, so its last 32 bits are all of
    // it; those of y·2^46 are the last of the mantissa.
    let r = root.to_bits() - 0x3f00_0000;
    let square = bits << 23 << (exponent >> 23 & 1);
    let beyond = square.wrapping_sub(r.wrapping_mul(r)).cast_signed();
    let r = if beyond > r.cast_signed() {
        r + 1
    } else if beyond <= -r.cast_signed() {
        r - 1
    } else {
        r
    };
    let half = (half.cast_signed() >> 1).cast_unsigned();
    f32::from_bits(r.wrapping_add(half).wrapping_add(126 << 23))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn has_the_bits_of_the_machine() {
        // A step that is prime visits every exponent and all kinds of mantissas.
        let all = (0..0x7f80_0000_u32).step_by(1009);
        for x in all.chain(0..2000).chain([0x7f7f_ffff, 0x007f_ffff, 0x0080_0000]) {
            let x = f32::from_bits(x);
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
        }
        // Neighbours of squares, where rounding is hardest.
        for n in (1..4096_u32).map(|n| n as f32) {
            for x in [(n * n).next_down(), n * n, (n * n).next_up()] {
                assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
            }
        }
    }

    #[test]
    fn what_has_no_root() {
        assert!(sqrt(f32::NAN).is_nan() && sqrt(-1.0).is_nan() && sqrt(-f32::INFINITY).is_nan());
        assert_eq!((sqrt(-0.0).to_bits(), sqrt(0.0).to_bits()), (0x8000_0000, 0));
        assert_eq!(sqrt(f32::INFINITY), f32::INFINITY);
    }

    /// All of them: `cargo test --release -p plant-core -- --ignored every_root`.
    #[test]
    #[ignore = "ten minutes unless optimised"]
    fn every_root() {
        for x in (0..0x7f80_0000_u32).map(f32::from_bits) {
            assert_eq!(sqrt(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
        }
    }
}
