#![no_std]
#![no_main]
//! The coupled plant with its driver, closed loop over UDDS at 1 kHz, in the `SysTick` interrupt; and
//! beside it the estimators of a battery management system, for which the plant is the pack: they
//! see it through noisy, coarse sensors and are told a state of charge that is 10 % wrong.
//!
//! QEMU does not keep time, so the interrupt asks for itself again at once. With
//! `VOLTSTEP_BLOCK=N` at build time, each block of 1000 steps ends with its hashes, and block N
//! shows every frame.

use core::cell::RefCell;

use cortex_m::interrupt::Mutex;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{entry, exception};
use panic_halt as _;
use plant_core::powertrain::ledger::NoLedger;
use semihosting::process::ExitCode;
use semihosting::{eprintln, println};
use voltstep_trace::Run;

// The vehicle, checked and discretised by the compiler, and the estimators of its battery.
#[cfg(feature = "bmw-i3")]
use voltstep_trace::{BMW_I3 as RIG, BMW_I3_MONITOR as MONITOR};
#[cfg(feature = "bmw-i3-constant")]
use voltstep_trace::{BMW_I3_CONSTANT as RIG, BMW_I3_CONSTANT_MONITOR as MONITOR};
#[cfg(feature = "bmw-i3-pmsm")]
use voltstep_trace::{BMW_I3_CONSTANT_MONITOR as MONITOR, BMW_I3_PMSM as RIG};
#[cfg(feature = "bmw-i3-thermal")]
use voltstep_trace::{BMW_I3_CONSTANT_MONITOR as MONITOR, BMW_I3_THERMAL as RIG};
#[cfg(feature = "two-axles")]
use voltstep_trace::{BMW_I3_CONSTANT_MONITOR as MONITOR, TWO_AXLED as RIG};
#[cfg(not(any(
    feature = "bmw-i3",
    feature = "bmw-i3-constant",
    feature = "bmw-i3-pmsm",
    feature = "bmw-i3-thermal",
    feature = "two-axles"
)))]
use voltstep_trace::{EPOWERTRAIN as RIG, EPOWERTRAIN_MONITOR as MONITOR};

#[cfg(not(feature = "bmw-i3"))]
use plant_core::battery::BatteryState;
#[cfg(feature = "bmw-i3")]
use plant_core::battery::MappedBatteryState as BatteryState;

// What the drives remember.
#[cfg(not(any(feature = "bmw-i3-pmsm", feature = "bmw-i3-thermal", feature = "two-axles")))]
use plant_core::Accum as DrivesState;
#[cfg(feature = "bmw-i3-pmsm")]
use plant_core::machine::pmsm::DqCurrents as DrivesState;
#[cfg(feature = "bmw-i3-thermal")]
type DrivesState = plant_core::machine::heated::HeatedState<plant_core::Accum>;
#[cfg(feature = "two-axles")]
type DrivesState = (plant_core::machine::pmsm::DqCurrents, plant_core::Accum);

/// The loop, between the interrupt and `main`.
static RUN: Mutex<RefCell<Option<Run<NoLedger, BatteryState, DrivesState>>>> =
    Mutex::new(RefCell::new(None));

/// The block whose frames are shown.
const SHOWN: Option<&str> = option_env!("VOLTSTEP_BLOCK");

#[entry]
fn main() -> ! {
    let Ok(run) = Run::new(&RIG, &MONITOR) else {
        eprintln!("the preset does not start");
        ExitCode::FAILURE.exit_process();
    };
    cortex_m::interrupt::free(|cs| RUN.borrow(cs).replace(Some(run)));
    loop {
        // The interrupt runs a whole block before it lets this go on.
        SCB::set_pendst();
        cortex_m::asm::isb();
        let Some(run) = cortex_m::interrupt::free(|cs| *RUN.borrow(cs).borrow()) else { continue };
        if SHOWN.is_some() {
            println!("{}", run.block());
        }
        if run.ended() {
            println!("{}", run.result(&MONITOR));
            ExitCode::SUCCESS.exit_process();
        }
    }
}

/// The control loop: one step per tick.
#[exception]
fn SysTick() {
    cortex_m::interrupt::free(|cs| {
        if let Some(run) = RUN.borrow(cs).borrow_mut().as_mut() {
            let (step, block) = (run.steps(), run.steps() / voltstep_trace::STEPS_PER_BLOCK);
            let frame = run.step(&RIG, &MONITOR);
            if SHOWN.is_some_and(|shown| shown.parse() == Ok(block)) {
                println!("{}", frame.line(step));
            }
            if run.block_completed().is_none() {
                SCB::set_pendst();
            }
        }
    });
}
