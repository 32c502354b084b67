#![no_std]
#![no_main]
//! The coupled plant with its driver, closed loop over UDDS at 1 kHz, in the `SysTick` interrupt; and
//! beside it the estimators of a battery management system, for which the plant is the pack: they
//! see it through noisy, coarse sensors and are told a state of charge that is 10 % wrong.
//!
//! QEMU does not keep time, so the interrupt asks for itself again at once. Each block of 1000
//! steps ends with its hash (`DEFMT_LOG=debug`); with `VOLTSTEP_BLOCK=N` at build time, block N
//! shows every frame (`DEFMT_LOG=trace`).

use core::cell::RefCell;

use cortex_m::interrupt::Mutex;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{entry, exception};
use defmt_semihosting as _;
use panic_halt as _;
use plant_core::powertrain::ledger::NoLedger;
use semihosting::process::ExitCode;
use voltstep_trace::Run;

// The vehicle, checked and discretised by the compiler, and the estimators of its battery.
#[cfg(feature = "bmw-i3")]
use voltstep_trace::{BMW_I3 as RIG, BMW_I3_MONITOR as MONITOR};
#[cfg(feature = "bmw-i3-constant")]
use voltstep_trace::{BMW_I3_CONSTANT as RIG, BMW_I3_CONSTANT_MONITOR as MONITOR};
#[cfg(not(any(feature = "bmw-i3", feature = "bmw-i3-constant")))]
use voltstep_trace::{EPOWERTRAIN as RIG, EPOWERTRAIN_MONITOR as MONITOR};

#[cfg(not(feature = "bmw-i3"))]
use plant_core::battery::BatteryState;
#[cfg(feature = "bmw-i3")]
use plant_core::battery::MappedBatteryState as BatteryState;

/// The loop, between the interrupt and `main`.
static RUN: Mutex<RefCell<Option<Run<NoLedger, BatteryState>>>> = Mutex::new(RefCell::new(None));

/// The block whose frames are shown.
const SHOWN: Option<&str> = option_env!("VOLTSTEP_BLOCK");

#[entry]
fn main() -> ! {
    let Ok(run) = Run::new(&RIG, &MONITOR) else {
        defmt::error!("the preset does not start");
        ExitCode::FAILURE.exit_process();
    };
    cortex_m::interrupt::free(|cs| RUN.borrow(cs).replace(Some(run)));
    loop {
        // The interrupt runs a whole block before it lets this go on.
        SCB::set_pendst();
        cortex_m::asm::isb();
        let Some(run) = cortex_m::interrupt::free(|cs| *RUN.borrow(cs).borrow()) else { continue };
        if let Some(block) = run.block_completed() {
            defmt::debug!(
                "block {=u32} {=u64:016x} {=u64:016x}",
                block,
                run.hash(),
                run.estimators_hash()
            );
        }
        if run.ended() {
            let believed = MONITOR.ekf.estimate(&run.monitor.ekf);
            defmt::info!(
                "result hash {=u64:016x} {=u64:016x} soc {=f32} distance_m {=f32} rejected {=bool} \
                 ekf {=f32} ± {=f32} counted {=f32}",
                run.hash(),
                run.estimators_hash(),
                run.state.plant.battery.soc.get(),
                run.state.plant.body.distance_m.get(),
                run.rejected(),
                believed.soc,
                believed.soc_sd,
                MONITOR.counter.soc(&run.monitor.counter)
            );
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
                defmt::trace!("frame {=u32} {:08x}", step, frame.words());
            }
            if run.block_completed().is_none() {
                SCB::set_pendst();
            }
        }
    });
}
