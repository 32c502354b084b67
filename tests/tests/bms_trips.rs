//! Nothing trips on a road: the measured current of real trips, through simulated cells that a whole BMS
//! manages behind sensors with noise.
//!
//! Real measurements are not part of the project: `VOLTSTEP_DATA` names the folder that has them in
//! `bmw-i3-trips/*.csv`. The pack is that of `voltstep bms`, the current the trip's for its capacity, as
//! far as the BMS allows it. With `--nocapture` every trip prints a row.

use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::prelude::*;
use voltstep::evaluate::campaign::scenario::{Judged, judge};
use voltstep::read::input::{self, Drive};
use voltstep::read::scenario::{Course, Fault, Planted, Scenario};
use voltstep::read::vehicle;
use voltstep::simulate::replay::DEFAULT_VEHICLE;

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
fn driven(path: &Path, planted: Vec<Planted>) -> Judged {
    let trip = input::trip(path).unwrap_or_else(|e| panic!("{e}"));
    let vehicle = Box::new(vehicle::load(DEFAULT_VEHICLE).unwrap());
    let scenario = Scenario {
        name: trip.name.clone(),
        soc: trip.first_soc().unwrap() as f32,
        temperature_c: trip.battery_c.iter().copied().find(|c| c.is_finite()).unwrap() as f32,
        course: Course::Driven(Drive::Trip(Box::new(trip)), vehicle),
        seconds: None,
        planted,
    };
    judge(&scenario).unwrap_or_else(|e| panic!("{}: {e:#}", scenario.name))
}

/// Nothing tripped, no cell was harmed, the contactors are still closed: driven to its end.
#[track_caller]
fn quiet(paths: &[PathBuf]) {
    let start = Instant::now();
    let judged: Vec<Judged> = paths.par_iter().map(|path| driven(path, Vec::new())).collect();
    let mut hours = 0.0;
    for of in &judged {
        println!(
            "{:9} {:6.1} s: {} false trips, up to {:5.1} A less than measured",
            of.name,
            f64::from(of.driven_ms) / 1000.0,
            of.false_trips.len(),
            of.felt.most_a,
        );
        hours += f64::from(of.driven_ms) / 3.6e6;
        assert!(of.is_good() && of.harm.is_none(), "{of:?}");
        assert_eq!(of.felt.interrupted_a, None, "{}: opened on the way", of.name);
    }
    println!("{hours:.2} h of {} trips in {:.0} s", judged.len(), start.elapsed().as_secs_f64());
}

fn synthetic() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/trips/synthetic.csv")
}

#[test]
fn nothing_trips_on_the_synthetic_trip() {
    quiet(&[synthetic()]);
}

#[test]
fn nothing_trips_on_real_trips() {
    let paths = voltstep_tests::real_files("bmw-i3-trips");
    if !paths.is_empty() {
        quiet(&paths);
    }
}

/// The same road with a fault: what says that nothing tripped would see it.
#[test]
fn what_is_planted_on_the_way_trips() {
    let judged = driven(&synthetic(), vec![Planted::new(Fault::CellWireOpen, 1.0, 60_000)]);
    assert!(judged.felt.interrupted_a.is_some() && judged.opened_ms.is_some(), "{judged:?}");
    assert!(judged.false_trips.is_empty() && judged.is_good(), "{judged:?}");
}
