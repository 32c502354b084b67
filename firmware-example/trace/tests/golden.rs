//! This machine ends where the golden file says, with the same bits all the way.

use plant_core::powertrain::ledger::NoLedger;
use voltstep_trace::{
    BLOCKS, BMW_I3, BMW_I3_MONITOR, CYCLE, EPOWERTRAIN, EPOWERTRAIN_MONITOR, Fnv1a, Monitor, Rig,
    Run,
};

const GOLDEN: &str = include_str!("../../golden.toml");

/// The section that a run would have in the golden file.
fn section(name: &str, rig: &Rig<NoLedger>, monitor: &Monitor) -> String {
    let mut run = Run::new(rig, monitor).unwrap();
    while !run.ended() {
        run.step(rig, monitor);
    }
    assert!(!run.rejected());
    let plant = run.state.plant;
    format!(
        "[{name}]\nhash = \"{:016x}\"\nestimators = \"{:016x}\"\nsoc = \"{}\"\ndistance_m = \"{}\"\n",
        run.hash(),
        run.estimators_hash(),
        plant.battery.soc.get(),
        plant.body.distance_m.get()
    )
}

#[test]
fn the_bits_are_golden() {
    for (name, rig, monitor) in [
        ("epowertrain-udds", EPOWERTRAIN, EPOWERTRAIN_MONITOR),
        ("bmw-i3-60ah", BMW_I3, BMW_I3_MONITOR),
    ] {
        let found = section(name, &rig, &monitor);
        assert!(GOLDEN.contains(&found), "golden.toml does not say:\n{found}");
    }
}

#[test]
fn one_bit_changes_the_hash() {
    let mut runs = [Run::new(&EPOWERTRAIN, &EPOWERTRAIN_MONITOR).unwrap(); 2];
    let soc = &mut runs[1].state.plant.battery.soc;
    *soc = plant_core::Accum::new(soc.get().next_up());
    let frames = runs.each_mut().map(|run| run.step(&EPOWERTRAIN, &EPOWERTRAIN_MONITOR));
    assert_ne!(frames[0], frames[1]);
    assert_ne!(runs[0].hash(), runs[1].hash());
}

/// The plant is the pack: estimators that see it through bad sensors find its state of charge.
#[test]
fn the_estimators_find_the_state_of_charge() {
    for (rig, monitor) in [(EPOWERTRAIN, EPOWERTRAIN_MONITOR), (BMW_I3, BMW_I3_MONITOR)] {
        let mut run = Run::new(&rig, &monitor).unwrap();
        while !run.ended() {
            run.step(&rig, &monitor);
        }
        let truth = run.state.plant.battery.soc.get();
        let believed = monitor.ekf.estimate(&run.monitor.ekf);
        let error = (believed.soc - truth).abs();
        assert!(error < 0.03 && error < 3.0 * believed.soc_sd, "{truth} {believed:?}");
        let counted = monitor.counter.soc(&run.monitor.counter);
        assert!((0.08..0.12).contains(&(truth - counted)), "{truth} {counted}: cannot know");
    }
}

#[test]
fn the_hash_is_fnv_1a() {
    // Published: FNV-1a of "foobar" is 0x85944171f73967e8; of four bytes computed alike.
    let mut hash = Fnv1a::default();
    assert_eq!(hash.get(), 0xcbf2_9ce4_8422_2325);
    hash.word(u32::from_le_bytes(*b"foob"));
    let mut bytes = 0xcbf2_9ce4_8422_2325_u64;
    for byte in b"foob" {
        bytes = (bytes ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    }
    assert_eq!(hash.get(), bytes);
}

#[test]
fn the_cycle_is_whole() {
    assert_eq!(CYCLE.len(), 1370);
    assert_eq!(CYCLE.last().map(|point| point.0), Some(f32::from(u16::try_from(BLOCKS).unwrap())));
}
