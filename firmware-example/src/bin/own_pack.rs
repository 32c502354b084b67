#![no_std]
#![no_main]
//! The whole BMS of an own pack, beside a simulated one: the files are those of the example of
//! `voltstep-bms`, and so are the bits.

#[path = "../../../bms/examples/own_pack/hardware.rs"]
mod hardware;
#[path = "../../../bms/examples/own_pack/pack.rs"]
mod pack;
#[path = "../../../bms/examples/own_pack/says.rs"]
mod says;

use cortex_m_rt::entry;
use panic_halt as _;
use semihosting::process::ExitCode;
use semihosting::{eprintln, println};

#[entry]
fn main() -> ! {
    let Ok(said) = says::drive(60_000) else {
        eprintln!("the pack does not start");
        ExitCode::FAILURE.exit_process();
    };
    println!("{}", said.line());
    if said.closed { ExitCode::SUCCESS } else { ExitCode::FAILURE }.exit_process()
}
