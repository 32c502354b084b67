//! `num::fast` beside the functions that it approximates: what is saved, and what it costs in error.

use plant_core::num::{self, fast};

use crate::hprintln;

/// Functions of one number.
macro_rules! function {
    ($($name:ident: $function:path;)+) => {$(
        #[doc = concat!("`", stringify!($function), "`.")]
        #[unsafe(no_mangle)]
        #[inline(never)]
        pub extern "C" fn $name(_: &mut (), x: &f32, y: &mut f32) {
            *y = $function(*x);
        }
    )+};
}

function! {
    bench_num_sqrt: num::sqrt;
    bench_fast_sqrt: fast::sqrt;
    bench_num_exp: num::exp;
    bench_fast_exp: fast::exp;
}

/// Arguments that are counted.
pub const COUNTED: u32 = 1000;
/// Arguments at which the error is looked at.
const LOOKED_AT: u32 = 200_000;

/// The n-th of `of` numbers over a range, evenly spaced.
#[must_use]
#[allow(clippy::cast_precision_loss, reason = "there are few of them")]
pub fn along((low, high): (f32, f32), n: u32, of: u32) -> f32 {
    low + (high - low) * (n as f32 / of as f32)
}

/// Calls each function along its range, on these stacks.
#[macro_export]
macro_rules! call_functions {
    ($num_sqrt:ident, $fast_sqrt:ident, $num_exp:ident, $fast_exp:ident) => {
        for n in 0..=$crate::fast::COUNTED {
            let x =
                $crate::fast::along(plant_core::num::fast::SQRT_RANGE, n, $crate::fast::COUNTED);
            $crate::call!($num_sqrt, $crate::fast::bench_num_sqrt, &mut (), &x);
            $crate::call!($fast_sqrt, $crate::fast::bench_fast_sqrt, &mut (), &x);
            let x = $crate::fast::along(plant_core::num::fast::EXP_RANGE, n, $crate::fast::COUNTED);
            $crate::call!($num_exp, $crate::fast::bench_num_exp, &mut (), &x);
            $crate::call!($fast_exp, $crate::fast::bench_fast_exp, &mut (), &x);
        }
    };
}

/// Says, for each function, the range and the largest relative error found there.
pub fn say_errors() {
    let sqrt = largest(fast::SQRT_RANGE, fast::sqrt, num::sqrt);
    let exp = largest(fast::EXP_RANGE, fast::exp, num::exp);
    hprintln!("error sqrt {:?} {:?} {}", fast::SQRT_RANGE.0, fast::SQRT_RANGE.1, sqrt);
    hprintln!("error exp {:?} {:?} {}", fast::EXP_RANGE.0, fast::EXP_RANGE.1, exp);
}

fn largest(range: (f32, f32), fast: fn(f32) -> f32, exact: fn(f32) -> f32) -> f32 {
    (0..=LOOKED_AT)
        .map(|n| along(range, n, LOOKED_AT))
        .fold(0.0, |most, x| num::max(most, (fast(x) / exact(x) - 1.0).abs()))
}
