#![no_std]
#![no_main]
//! Switched circuits and curved elements on the microcontroller: what `voltstep-trace` says of them on a PC.

use cortex_m_rt::entry;
use panic_halt as _;
use semihosting::println;
use semihosting::process::ExitCode;
use voltstep_trace::circuits::{STEPS, switched};

#[entry]
fn main() -> ! {
    println!("{}", switched(STEPS));
    ExitCode::SUCCESS.exit_process();
}
