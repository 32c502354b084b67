#![no_std]
#![no_main]
//! The pack of `own_pack`, recorded: the bytes in hexadecimal, the same as those of the example of
//! `voltstep-bms`. `voltstep rewind` runs them again.
#![allow(clippy::large_stack_arrays, reason = "it is what a static begins with")]
#![allow(dead_code, reason = "the pack is driven by another loop here")]

#[path = "../../../bms/examples/own_pack/hardware.rs"]
mod hardware;
#[path = "../../../bms/examples/own_pack/pack.rs"]
mod pack;
#[path = "../../../bms/examples/own_pack/recorded.rs"]
mod recorded;

use cortex_m_rt::entry;
use panic_halt as _;
use semihosting::process::ExitCode;
use semihosting::{print, println};

#[entry]
fn main() -> ! {
    let Some(memory) = cortex_m::singleton!(: [u8; 1 << 16] = [0; 1 << 16]) else {
        ExitCode::FAILURE.exit_process()
    };
    let there = recorded::drive(memory, |bytes| {
        for byte in bytes {
            print!("{byte:02x}");
        }
    });
    println!();
    if there == Ok(true) { ExitCode::SUCCESS } else { ExitCode::FAILURE }.exit_process()
}
