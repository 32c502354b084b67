//! What the firmware's `sim` says, on this machine: `trace VEHICLE [BLOCK]`.
//!
//! `fields NAMES`, then `block N HASH HASH` (plant, estimators) after each block; with a BLOCK also every frame in it.

use plant_core::battery::Pack;
use plant_core::powertrain::ledger::NoLedger;
use voltstep_trace::{
    BMW_I3, BMW_I3_CONSTANT, BMW_I3_CONSTANT_MONITOR, BMW_I3_MONITOR, EPOWERTRAIN,
    EPOWERTRAIN_MONITOR, Frame, Monitor, Rig, Run, Words,
};

fn main() {
    let mut words = std::env::args().skip(1);
    let (vehicle, block) = (words.next(), words.next().and_then(|word| word.parse().ok()));
    match vehicle.as_deref() {
        Some("epowertrain-udds") => print(&EPOWERTRAIN, &EPOWERTRAIN_MONITOR, block),
        Some("bmw-i3-60ah") => print(&BMW_I3, &BMW_I3_MONITOR, block),
        Some("bmw-i3-60ah-constant") => {
            print(&BMW_I3_CONSTANT, &BMW_I3_CONSTANT_MONITOR, block);
        }
        _ => {
            eprintln!("usage: trace epowertrain-udds|bmw-i3-60ah|bmw-i3-60ah-constant [BLOCK]");
            std::process::exit(2);
        }
    }
}

fn print<B: Pack>(rig: &Rig<NoLedger, B>, monitor: &Monitor, wanted: Option<u32>)
where
    B::State: Words,
{
    let mut run = Run::new(rig, monitor).expect("the preset starts");
    println!("fields {}", Frame::fields::<B::State>().collect::<Vec<_>>().join(" "));
    let mut block = 0;
    while !run.ended() {
        let step = run.steps();
        let frame = run.step(rig, monitor);
        if wanted == Some(block) {
            println!("frame {step} {:08x?}", frame.words());
        }
        if let Some(completed) = run.block_completed() {
            println!("block {completed} {:016x} {:016x}", run.hash(), run.estimators_hash());
            block = completed + 1;
        }
    }
    let believed = monitor.ekf.estimate(&run.monitor.ekf);
    println!(
        "result hash {:016x} {:016x} soc {} distance_m {} rejected {} ekf {} ± {} counted {}",
        run.hash(),
        run.estimators_hash(),
        B::soc(&run.state.plant.battery),
        run.state.plant.body.distance_m.get(),
        run.rejected(),
        believed.soc,
        believed.soc_sd,
        monitor.counter.soc(&run.monitor.counter)
    );
}
