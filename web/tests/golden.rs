//! What the page runs: the bits of the firmware, and what its knobs do.

use plant_core::Dt;
use voltstep_web::car::{CARS, Car, Knobs};
use voltstep_web::cycle::CYCLES;
use voltstep_web::run::{COLUMNS, Going, ROWS_PER_S};

const GOLDEN: &str = include_str!("../../firmware-example/golden.toml");

const PRESET: Knobs =
    Knobs { mass: 1.0, drag: 1.0, capacity: 1.0, resistance: 1.0, temperature_c: f32::NAN };

/// The knobs that leave a vehicle as it is.
fn preset(car: &dyn Car) -> Knobs {
    let temperature_c = car.sheet().temperature.map_or(f32::NAN, |(_, celsius)| celsius);
    Knobs { temperature_c, ..PRESET }
}

/// A run to its end, so many rows at a time.
fn whole(car: &dyn Car, knobs: Knobs, cycle: usize, dt_s: f32, rows: u32) -> Box<dyn Going> {
    let mut run = car.set_out(knobs, &CYCLES[cycle], Dt::from_s(dt_s).unwrap()).unwrap();
    while !run.advance(rows).unwrap() {}
    run
}

/// A number of the result.
fn number(run: &dyn Going, name: &str) -> f64 {
    let text = run.result();
    let (_, rest) = text.split_once(&format!("\"{name}\":")).unwrap_or_else(|| panic!("{text}"));
    rest.split([',', '}']).next().unwrap().parse().unwrap()
}

#[test]
fn every_vehicle_has_the_bits_of_the_microcontroller() {
    for car in CARS {
        let sheet = car.sheet();
        let run = whole(car, preset(car), 0, 1e-3, 600);
        let (_, golden) = GOLDEN.split_once(&format!("[{}]\nhash = \"", sheet.name)).unwrap();
        let hash = golden.split('"').next().unwrap();
        assert!(run.result().contains(&format!("\"hash\":\"{hash}\"")), "{}", run.result());
        assert_eq!(number(&*run, "steps"), 1_369_000.0);
        assert_eq!(run.rows().len(), (1369 * ROWS_PER_S as usize + 1) * COLUMNS);
        assert!(number(&*run, "residual_rel").abs() < 1e-6);
    }
}

#[test]
fn every_vehicle_drives_every_cycle_in_long_steps() {
    for car in CARS {
        for (place, cycle) in CYCLES.iter().enumerate() {
            let run = whole(car, preset(car), place, 1e-2, 600);
            let name = (car.sheet().name, cycle.name);
            assert_eq!(run.rows().len() / COLUMNS, cycle.points.len() * 10 - 9, "{name:?}");
            assert!(number(&*run, "residual_rel").abs() < 1e-5, "{name:?}: {}", run.result());
            assert!(number(&*run, "distance_m") > 5000.0, "{name:?}: {}", run.result());
        }
    }
}

#[test]
fn a_run_in_pieces_is_the_run_in_one() {
    let [one, pieces] = [u32::MAX, 7].map(|rows| whole(CARS[0], preset(CARS[0]), 1, 1e-2, rows));
    assert_eq!((one.result(), one.rows()), (pieces.result(), pieces.rows()));
}

#[test]
fn power_and_speed_of_the_rows_are_those_of_the_run() {
    let run = whole(CARS[0], preset(CARS[0]), 0, 1e-2, 600);
    let rows: Vec<_> = run.rows().chunks(COLUMNS).collect();
    let tenth = 1.0 / f64::from(ROWS_PER_S);
    let joules: f64 = rows.iter().map(|row| f64::from(row[2]) * tenth).sum();
    assert!((joules / number(&*run, "energy_j") - 1.0).abs() < 1e-6, "{joules}");
    let metres: f64 = rows.iter().map(|row| f64::from(row[1]) * tenth).sum();
    assert!((metres / number(&*run, "distance_m") - 1.0).abs() < 1e-3, "{metres}");
    assert!((f64::from(rows[rows.len() - 1][3]) - number(&*run, "soc")).abs() < 1e-7);
    for (cycle_s, speed_m_s) in &CYCLES[0].points {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index")]
        let row = rows[(cycle_s * 10.0) as usize];
        assert!((row[0] - speed_m_s).abs() < 1e-4, "{cycle_s} s: {row:?}");
    }
}

#[test]
fn each_knob_does_what_it_says() {
    for car in CARS {
        let sheet = car.sheet();
        let plain = preset(car);
        let run = |knobs| whole(car, knobs, 0, 1e-2, 600);
        let (base, name) = (run(plain), sheet.name);
        let more = |knobs, what| {
            let (now, before) = (number(&*run(knobs), what), number(&*base, what));
            assert!(now > before, "{name}: {what} {before} becomes {now}");
        };
        more(Knobs { mass: 1.3, ..plain }, "rolling");
        more(Knobs { mass: 1.3, ..plain }, "energy_j");
        more(Knobs { drag: 1.3, ..plain }, "drag");
        more(Knobs { capacity: 1.3, ..plain }, "soc");
        more(Knobs { resistance: 1.3, ..plain }, "series_joule");
        match sheet.temperature {
            Some(("battery", celsius)) => {
                more(Knobs { temperature_c: celsius - 20.0, ..plain }, "series_joule");
            }
            Some((_, celsius)) => {
                more(Knobs { temperature_c: celsius + 20.0, ..plain }, "copper");
            }
            None => {}
        }
    }
    let warm = CARS.iter().filter(|car| car.sheet().temperature.is_some());
    assert_eq!(warm.count(), 2);
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let dt = Dt::from_s(1e-2).unwrap();
    let refused = |knobs| CARS[1].set_out(knobs, &CYCLES[0], dt).err().unwrap().field();
    assert_eq!(refused(Knobs { mass: 0.0, ..PRESET }), "body.mass_kg");
    assert_eq!(refused(Knobs { capacity: f32::NAN, ..PRESET }), "battery.capacity_ah");
}
