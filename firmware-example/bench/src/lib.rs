#![no_std]
//! What is counted, and the stacks on which it is called.

pub mod circuits;
pub mod common;
pub mod estimators;
pub mod fast;
pub mod items;
pub mod kalman;
pub mod manage;
pub mod pack;
pub mod pids;
pub mod stack;

pub use cortex_m_semihosting::hprintln;

use cortex_m_semihosting::debug;

/// Ends QEMU; `None` is a failure.
pub fn end(result: Option<()>) -> ! {
    if result.is_none() {
        hprintln!("failed");
        debug::exit(debug::EXIT_FAILURE);
    }
    debug::exit(debug::EXIT_SUCCESS);
    loop {
        cortex_m::asm::wfi();
    }
}
