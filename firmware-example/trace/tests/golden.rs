//! This machine ends where the golden file says, with the same bits all the way.

use plant_core::Accum;
use plant_core::battery::{BatteryState, Pack};
use plant_core::control::driver::Steering;
use plant_core::machine::pmsm::DqCurrents;
use plant_core::powertrain::Drives;
use plant_core::powertrain::ledger::{Book, NoLedger};
use voltstep_trace::circuits::{STEPS, switched};
use voltstep_trace::{
    BLOCKS, BMW_I3, BMW_I3_CONSTANT, BMW_I3_CONSTANT_MONITOR, BMW_I3_MONITOR, BMW_I3_PMSM,
    BMW_I3_PMSM_LEDGER, BMW_I3_THERMAL, CYCLE, EPOWERTRAIN, EPOWERTRAIN_MONITOR, Fnv1a, Frame,
    Monitor, Rig, Run, TWO_AXLED, TWO_AXLED_LEDGER, Words,
};

const GOLDEN: &str = include_str!("../../golden.toml");

/// A run along the whole cycle.
fn whole<L: Book, B: Pack, D: Drives, C: Steering<D>>(
    rig: &Rig<L, B, D, C>,
    monitor: &Monitor,
) -> Run<L, B::State, D::State>
where
    B::State: Words,
    D::State: Words,
{
    let mut run = Run::new(rig, monitor).unwrap();
    while !run.ended() {
        run.step(rig, monitor);
    }
    assert!(!run.rejected());
    run
}

/// The golden file has the section that a run would have.
#[track_caller]
fn is_golden<B: Pack, D: Drives, C: Steering<D>>(
    name: &str,
    rig: &Rig<NoLedger, B, D, C>,
    monitor: &Monitor,
) where
    B::State: Words,
    D::State: Words,
{
    let run = whole(rig, monitor);
    let plant = run.state.plant;
    let found = format!(
        "[{name}]\nhash = \"{:016x}\"\nestimators = \"{:016x}\"\nsoc = \"{}\"\ndistance_m = \"{}\"\n",
        run.hash(),
        run.estimators_hash(),
        B::soc(&plant.battery),
        plant.body.distance_m.get()
    );
    assert!(GOLDEN.contains(&found), "golden.toml does not say:\n{found}");
}

#[test]
fn the_bits_are_golden() {
    is_golden("epowertrain-udds", &EPOWERTRAIN, &EPOWERTRAIN_MONITOR);
    is_golden("bmw-i3-60ah-constant", &BMW_I3_CONSTANT, &BMW_I3_CONSTANT_MONITOR);
    is_golden("bmw-i3-60ah", &BMW_I3, &BMW_I3_MONITOR);
    is_golden("bmw-i3-60ah-pmsm", &BMW_I3_PMSM, &BMW_I3_CONSTANT_MONITOR);
    is_golden("bmw-i3-60ah-thermal", &BMW_I3_THERMAL, &BMW_I3_CONSTANT_MONITOR);
    is_golden("two-axles", &TWO_AXLED, &BMW_I3_CONSTANT_MONITOR);
}

/// The hash and where the circuits end, as the golden file has them; and that is where they should be.
#[test]
fn the_bits_of_circuits_are_golden() {
    let said = switched(STEPS).to_string();
    assert!(GOLDEN.contains(&format!("[circuits]\nsaid = \"{said}\"\n")), "golden.toml: {said}");
    let words: Vec<_> = said.split(' ').collect();
    let after = |name: &str| words[words.iter().position(|word| *word == name).unwrap() + 1];
    assert_eq!(after("settled"), "true");
    let rectified_v: f32 = after("rectified_v").parse().unwrap();
    assert!((90.0..100.0).contains(&rectified_v), "{rectified_v}");
    // The gate ends high.
    let inverted_v: f32 = after("inverted_v").parse().unwrap();
    assert!(inverted_v.abs() < 0.1, "{inverted_v}");
    assert_ne!(said, switched(STEPS - 1).to_string());
}

/// Every word has a name, so none was left out for want of room; both machines are among them.
#[test]
fn the_frame_holds_every_drive() {
    let mut run = Run::new(&TWO_AXLED, &BMW_I3_CONSTANT_MONITOR).unwrap();
    let frame = run.step(&TWO_AXLED, &BMW_I3_CONSTANT_MONITOR);
    let fields: Vec<_> = Frame::fields::<BatteryState, (DqCurrents, Accum)>().collect();
    assert_eq!(fields.len(), frame.words().len());
    for field in ["d_a", "q_a", "current_a", "counter.soc"] {
        assert!(fields.contains(&field), "{field}");
    }
}

/// A ledger changes nothing of what it books.
#[test]
fn books_change_no_bit() {
    let battery = &BMW_I3_CONSTANT_MONITOR;
    assert_eq!(whole(&BMW_I3_PMSM, battery).hash(), whole(&BMW_I3_PMSM_LEDGER, battery).hash());
    assert_eq!(whole(&TWO_AXLED, battery).hash(), whole(&TWO_AXLED_LEDGER, battery).hash());
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
    find_it(&EPOWERTRAIN, &EPOWERTRAIN_MONITOR);
    find_it(&BMW_I3_CONSTANT, &BMW_I3_CONSTANT_MONITOR);
    find_it(&BMW_I3, &BMW_I3_MONITOR);
    find_it(&BMW_I3_PMSM, &BMW_I3_CONSTANT_MONITOR);
    find_it(&TWO_AXLED, &BMW_I3_CONSTANT_MONITOR);
}

#[track_caller]
fn find_it<B: Pack, D: Drives, C: Steering<D>>(rig: &Rig<NoLedger, B, D, C>, monitor: &Monitor)
where
    B::State: Words,
    D::State: Words,
{
    let run = whole(rig, monitor);
    let truth = B::soc(&run.state.plant.battery);
    let believed = monitor.ekf.estimate(&run.monitor.ekf);
    let error = (believed.soc - truth).abs();
    assert!(error < 0.03 && error < 3.0 * believed.soc_sd, "{truth} {believed:?}");
    let counted = monitor.counter.soc(&run.monitor.counter);
    assert!((0.08..0.12).contains(&(truth - counted)), "{truth} {counted}: cannot know");
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
