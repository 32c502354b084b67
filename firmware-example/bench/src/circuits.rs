//! Switched circuits with their machines: an H-bridge with a DC motor, a three-phase bridge with a
//! synchronous one.

use voltstep_trace::circuits::{Driven, gates};

use crate::call;
use crate::stack::Stack;

/// An H-bridge and a DC motor; the input is its gates, the output its current.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_h_bridge(state: &mut Driven<6>, gates: &u32, current_a: &mut f32) {
    *current_a = state.step(*gates);
}

/// A three-phase bridge and a synchronous machine, the same.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_three_phase(state: &mut Driven<10>, gates: &u32, current_a: &mut [f32; 3]) {
    *current_a = state.step(*gates);
}

/// Switches both for 50 ms.
pub fn run(h_stack: &mut Stack, three_stack: &mut Stack) -> (Driven<6>, Driven<10>) {
    let (mut h, mut three) = (Driven::default(), Driven::default());
    for step in 0..5000_u32 {
        let (of_h, of_three) = gates(step);
        call!(h_stack, bench_h_bridge, &mut h, &of_h);
        call!(three_stack, bench_three_phase, &mut three, &of_three);
    }
    (h, three)
}
