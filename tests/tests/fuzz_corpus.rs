//! Every file of the fuzz corpus, seeds and what was found, through the fuzz targets' own functions.

#[path = "../../fuzz/src/lib.rs"]
mod targets;

use std::path::Path;

use voltstep::read::recognise::FileKind;

/// Runs every file of a target's corpus.
fn run(target: &str, body: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus").join(target);
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        body(&std::fs::read(entry.unwrap().path()).unwrap());
        count += 1;
    }
    assert!(count > 0, "no corpus for {target}");
}

#[test]
fn readers() {
    run("cycle", targets::cycle);
    run("trip", targets::trip);
    run("vehicle", targets::vehicle);
    run("battery", targets::battery);
    run("cell", targets::cell);
    run("netlist", targets::netlist);
    run("check", targets::check);
}

#[test]
fn steps() {
    run("step", |data| {
        targets::step(data);
    });
}

/// And each seed is a network that takes them.
#[test]
fn networks() {
    run("circuit", |data| assert!(targets::circuit(data)));
}

/// Each kind of plant takes steps on some file of the corpus: one that refuses them all tests
/// nothing.
#[test]
fn every_plant_steps() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/step");
    let mut all = targets::Stepped::default();
    for entry in std::fs::read_dir(folder).unwrap() {
        let stepped = targets::step(&std::fs::read(entry.unwrap().path()).unwrap());
        all.plain |= stepped.plain;
        all.mapped |= stepped.mapped;
        for (all, one) in all.synchronous.iter_mut().zip(stepped.synchronous) {
            *all |= one;
        }
        for (all, one) in all.pairs.iter_mut().zip(stepped.pairs) {
            *all |= one;
        }
    }
    assert!(all.plain && all.mapped, "{all:?}");
    assert!(all.synchronous == [true; 2] && all.pairs == [true; 5], "{all:?}");
}

/// A seed that is refused at once would test nothing.
#[test]
fn the_seeds_are_taken() {
    let seed = |path: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
        std::fs::read(folder.join(path)).unwrap()
    };
    assert!(voltstep::read::cycle::parse("x.csv", &seed("cycle/udds-head.csv")).is_ok());
    assert!(voltstep::read::trip::parse("x.csv", &seed("trip/synthetic-head.csv")).is_ok());
    assert!(
        voltstep::read::vehicle::parse("x.toml", &seed("vehicle/epowertrain-udds.toml")).is_ok()
    );
    assert!(
        voltstep::read::battery::parse("x", &seed("battery/panasonic-ncr18650pf.toml")).is_ok()
    );
    assert!(voltstep::read::netlist::parse("x.toml", &seed("netlist/buck.toml")).is_ok());
    assert!(voltstep::read::cell::parse("x.csv", &seed("cell/three.csv")).is_ok());
    for (name, kind) in [
        ("buck.toml", FileKind::Circuit),
        ("cell.csv", FileKind::Cell),
        ("distance.csv", FileKind::Cycle),
        ("heated-cell.toml", FileKind::Scenario),
        ("maccor.txt", FileKind::Cell),
        ("profile.csv", FileKind::Profile),
    ] {
        let found = voltstep::read::check::parse(name, &seed(&format!("check/{name}")), 60.0);
        assert_eq!(found.unwrap().kind, kind, "{name}");
    }
}
