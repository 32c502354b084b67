//! The square root, correctly rounded, so it has the bits of every machine's own instruction.

/// Square root: Newton's method, then the last bit by integers.
///
/// Where the machine has an instruction, safe code cannot reach it without the standard library,
/// and `libm`'s routine for the others takes 0.5 kB of flash. Nothing takes a root in every step,
/// so this one is made to be small.
pub fn sqrt(x: f32) -> f32 {
    if !(x > 0.0 && x < f32::INFINITY) {
        return if x < 0.0 { f32::NAN } else { x };
    }
    // A subnormal has no leading one; both factors are powers of four, so nothing is rounded.
    let (x, back) = if x < f32::MIN_POSITIVE { (x * 16_777_216.0, 1.0 / 4096.0) } else { (x, 1.0) };
    // x = 4^half · y with y in 1..4, and the mantissa of y as an integer, y·2^23.
    let exponent = (x.to_bits() >> 23).cast_signed() - 127;
    let half = exponent >> 1;
    let y = f32::from_bits(x.to_bits().wrapping_sub(half.cast_unsigned() << 24));
    let mantissa = (x.to_bits() & 0x007f_ffff | 0x0080_0000) << (exponent & 1);
    // A line within 3 %, then to half a millionth of a millionth but for rounding.
    let mut root = 0.35 * y + 0.68;
    root = 0.5 * (root + y / root);
    root = 0.5 * (root + y / root);
    root = 0.5 * (root + y / root);
    // Below 2, so that it has the exponent of 1; one unit in the last place is put right now:
    // with r = root·2^23 the nearest is r where y·2^46 lies between (r − ½)² and (r + ½)². The
    // difference is small, so its last 32 bits are all of it.
    let r = root.to_bits().min(0x3fff_ffff) - 0x3f00_0000;
    let beyond = (mantissa << 23).wrapping_sub(r.wrapping_mul(r)).cast_signed();
    let r = if beyond > r.cast_signed() {
        r + 1
    } else if beyond <= -r.cast_signed() {
        r - 1
    } else {
        r
    };
    f32::from_bits(r + ((half + 126).cast_unsigned() << 23)) * back
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
