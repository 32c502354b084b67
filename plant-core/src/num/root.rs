//! The square root, correctly rounded, so it has the bits of every machine's own instruction.

/// Square root, bit by bit (the method of fdlibm's `e_sqrtf.c`).
///
/// Where the machine has an instruction, safe code cannot reach it without the standard library,
/// and `libm`'s routine for the others takes 0.5 kB of flash. Nothing takes a root in every step,
/// so this one is made to be small: 25 turns of a short loop, no division, no table.
pub fn sqrt(x: f32) -> f32 {
    if !(x > 0.0 && x < f32::INFINITY) {
        return if x < 0.0 { f32::NAN } else { x };
    }
    // A subnormal has no leading one; both factors are powers of four, so nothing is rounded.
    let (x, back) = if x < f32::MIN_POSITIVE { (x * 16_777_216.0, 1.0 / 4096.0) } else { (x, 1.0) };
    let bits = x.to_bits();
    let exponent = (bits >> 23).cast_signed() - 127;
    let mut rest = (bits & 0x007f_ffff | 0x0080_0000) << (1 + (exponent & 1));
    let (mut root, mut twice, mut bit) = (0_u32, 0_u32, 0x0100_0000_u32);
    // Once nothing is left the root is exact; this also keeps the compiler from writing the loop out.
    while bit != 0 && rest != 0 {
        let tried = twice + bit;
        if tried <= rest {
            twice = tried + bit;
            rest -= tried;
            root += bit;
        }
        rest <<= 1;
        bit >>= 1;
    }
    // One bit more than a mantissa has: it rounds. Never a tie: a root of 25 bits squares to 49.
    root = (root >> 1) + (root & 1);
    f32::from_bits(root + (((exponent >> 1) + 126).cast_unsigned() << 23)) * back
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
