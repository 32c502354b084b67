//! What the firmware's `sim` says, on this machine: `trace VEHICLE [BLOCK]`.
//!
//! `fields NAMES`, then `block N HASH HASH` (plant, estimators) after each block; with a BLOCK also every frame in it.

use plant_core::battery::Pack;
use plant_core::control::driver::Steering;
use plant_core::powertrain::Drives;
use plant_core::powertrain::ledger::NoLedger;
use voltstep_trace::{
    BMW_I3, BMW_I3_CONSTANT, BMW_I3_CONSTANT_MONITOR, BMW_I3_MONITOR, BMW_I3_PMSM, BMW_I3_THERMAL,
    EPOWERTRAIN, EPOWERTRAIN_MONITOR, Frame, Monitor, Rig, Run, TWO_AXLED, Words,
};

const VEHICLES: &str = "epowertrain-udds|bmw-i3-60ah|bmw-i3-60ah-constant|bmw-i3-60ah-pmsm|bmw-i3-60ah-thermal|two-axles";

fn main() {
    let mut words = std::env::args().skip(1);
    let (vehicle, block) = (words.next(), words.next().and_then(|word| word.parse().ok()));
    match vehicle.as_deref() {
        Some("epowertrain-udds") => print(&EPOWERTRAIN, &EPOWERTRAIN_MONITOR, block),
        Some("bmw-i3-60ah") => print(&BMW_I3, &BMW_I3_MONITOR, block),
        Some("bmw-i3-60ah-constant") => {
            print(&BMW_I3_CONSTANT, &BMW_I3_CONSTANT_MONITOR, block);
        }
        Some("bmw-i3-60ah-pmsm") => print(&BMW_I3_PMSM, &BMW_I3_CONSTANT_MONITOR, block),
        Some("bmw-i3-60ah-thermal") => print(&BMW_I3_THERMAL, &BMW_I3_CONSTANT_MONITOR, block),
        Some("two-axles") => print(&TWO_AXLED, &BMW_I3_CONSTANT_MONITOR, block),
        _ => {
            eprintln!("usage: trace {VEHICLES} [BLOCK]");
            std::process::exit(2);
        }
    }
}

fn print<B: Pack, D: Drives, C: Steering<D>>(
    rig: &Rig<NoLedger, B, D, C>,
    monitor: &Monitor,
    wanted: Option<u32>,
) where
    B::State: Words,
    D::State: Words,
{
    let mut run = Run::new(rig, monitor).expect("the preset starts");
    println!("fields {}", Frame::fields::<B::State, D::State>().collect::<Vec<_>>().join(" "));
    let mut block = 0;
    while !run.ended() {
        let step = run.steps();
        let frame = run.step(rig, monitor);
        if wanted == Some(block) {
            println!("{}", frame.line(step));
        }
        if let Some(completed) = run.block_completed() {
            println!("{}", run.block());
            block = completed + 1;
        }
    }
    println!("{}", run.result(monitor));
}
