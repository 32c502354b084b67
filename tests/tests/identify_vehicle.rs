//! `voltstep identify vehicle`: a synthetic fleet whose parameters are known, and real trips, each
//! half of them judged by the other, where `VOLTSTEP_DATA` says they are.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "the plant computes in f32; counts are small"
)]

use std::path::PathBuf;

use voltstep::evaluate::trips;
use voltstep::identify::{IdentifiedVehicle, VehicleOptions, identify_vehicle, vehicle_of_trips};
use voltstep::read::trip::Trip;
use voltstep::read::vehicle::{self, Vehicle};
use voltstep::simulate::progress::Unseen;
use voltstep::simulate::route::{Route, Row};
use voltstep::simulate::run;

/// Trips that a vehicle of the fleet drives, and how long each is \[s\].
const TRIPS: u32 = 14;
const TRIP_S: u32 = 700;
/// What a trip's wind, load and tyres add, over trips: standard deviation \[N\].
const UNEXPLAINED_N: f64 = 20.0;
/// What wind and road add along a trip \[N\], and how long that lasts \[s\].
const GUSTS_N: f64 = 25.0;
const GUST_S: f64 = 30.0;
/// The base load differs between trips \[W\].
const BASE_SPREAD_W: f64 = 30.0;

/// A random number of mean 0 and variance 1.
fn normal(random: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| random.f64()).sum::<f64>() - 6.0
}

fn between(random: &mut fastrand::Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * random.f64()
}

/// One vehicle of the fleet: its parameters by the names of the identification.
struct Truth {
    parameters: Vec<(&'static str, f64)>,
    /// Rolling resistance: of powers of (temperature − 15 °C)/10 K \[N\].
    rolling: [f64; 3],
}

impl Truth {
    fn new(random: &mut fastrand::Rng) -> Self {
        let rolling = [
            between(random, 130.0, 180.0),
            between(random, -40.0, -20.0),
            between(random, 5.0, 12.0),
        ];
        let parameters = vec![
            ("mass_kg", between(random, 1350.0, 1700.0)),
            ("drag_area_m2", between(random, 0.5, 0.75)),
            ("gear_efficiency", between(random, 0.92, 0.97)),
            ("warm_up_n", between(random, 40.0, 100.0)),
            ("base_w", between(random, 300.0, 700.0)),
            ("loss_w_per_nm2", between(random, 0.03, 0.08)),
            ("loss_w_per_nm", between(random, 3.0, 10.0)),
            ("loss_w_s2_per_rad2", between(random, 0.5e-3, 2e-3)),
            ("rolling_at_0_c_n", at(rolling, 0.0)),
            ("rolling_at_15_c_n", at(rolling, 15.0)),
            ("rolling_at_30_c_n", at(rolling, 30.0)),
        ];
        Self { parameters, rolling }
    }

    fn get(&self, name: &str) -> f64 {
        self.parameters.iter().find(|(other, _)| *other == name).unwrap().1
    }

    /// The vehicle without its base load, which differs from trip to trip.
    fn vehicle(&self) -> Vehicle {
        let (file, text) = vehicle::text("bmw-i3-60ah").unwrap();
        let mut table: toml::Table = text.parse().unwrap();
        let mut set = |path: &[&str], value: f64| {
            let (key, tables) = path.split_last().unwrap();
            let place = tables.iter().fold(&mut table, |t, name| t[*name].as_table_mut().unwrap());
            place.insert((*key).to_owned(), toml::Value::Float(value));
        };
        let (mass_kg, kt) = (self.get("mass_kg"), 0.27);
        set(&["auxiliary", "power_w"], 0.0);
        set(&["converter", "resistance_ohm"], 1e-3);
        set(&["converter", "voltage_drop_v"], self.get("loss_w_per_nm") * kt);
        set(&["motor", "resistance_ohm"], self.get("loss_w_per_nm2") * kt * kt - 1e-3);
        set(&["motor", "viscous_nm_s_per_rad"], self.get("loss_w_s2_per_rad2"));
        set(&["gearbox", "efficiency"], self.get("gear_efficiency"));
        set(&["body", "mass_kg"], mass_kg);
        let physical = |key| ["body", "resistance", "physical", key];
        set(&physical("drag_coefficient"), self.get("drag_area_m2") / 2.38);
        set(&physical("rolling_coefficient"), self.rolling[0] / (mass_kg * 9.806_65));
        let text = toml::to_string(&table).unwrap();
        vehicle::parse(&file, text.as_bytes()).unwrap()
    }
}

fn at(rolling: [f64; 3], celsius: f64) -> f64 {
    let u = (celsius - 15.0) / 10.0;
    rolling[0] + rolling[1] * u + rolling[2] * u * u
}

/// Speeds of a drive through town, land and motorway \[m/s\], ten a second.
fn speeds(random: &mut fastrand::Rng) -> Vec<f64> {
    let mut speeds = vec![0.0; 100];
    let mut now = 0.0;
    while speeds.len() < (TRIP_S * 10) as usize {
        let target = [0.0, 30.0, 50.0, 70.0, 100.0, 125.0][random.usize(0..6)] / 3.6;
        let ramp_s = 1.5 * f64::abs(target - now) / between(random, 0.6, 2.2);
        let rows = (ramp_s * 10.0).ceil().max(1.0);
        // Without a jerk at either end.
        speeds.extend((1..=rows as usize).map(|i| {
            let x = i as f64 / rows;
            now + (target - now) * x * x * (3.0 - 2.0 * x)
        }));
        now = target;
        speeds.extend(std::iter::repeat_n(now, random.usize(50..400)));
    }
    speeds.truncate((TRIP_S * 10) as usize);
    speeds
}

/// A trip that the vehicle drives, as its sensors see it.
fn driven(truth: &Truth, vehicle: &Vehicle, number: u32, random: &mut fastrand::Rng) -> Trip {
    let ambient_c = -2.0 + 34.0 * f64::from(number) / f64::from(TRIPS - 1);
    let air = vehicle::air_density_kg_m3(ambient_c, 500.0) / 1.2;
    let own_n = UNEXPLAINED_N * normal(random);
    let base_w = truth.get("base_w") + BASE_SPREAD_W * normal(random);
    let heating_w = between(random, 0.0, 2000.0);
    let (phase, length_m) = (random.f64(), between(random, 5000.0, 8000.0));
    // 2 % at its steepest.
    let hill_m = 0.02 * length_m / std::f64::consts::TAU;
    let turns = |m: f64| std::f64::consts::TAU * (m / length_m + phase);
    let mut distance_m = 0.0;
    let mut heights_m = Vec::new();
    let (keep, mut gust_n) = (f64::exp(-0.1 / GUST_S), 0.0);
    let rows: Vec<Row> = (speeds(random).into_iter().enumerate())
        .map(|(i, speed_m_s)| {
            heights_m.push(500.0 + hill_m * turns(distance_m).sin());
            let slope = 0.02 * turns(distance_m).cos();
            let cold_n = truth.get("warm_up_n") * f64::exp(-distance_m / 2500.0);
            gust_n = keep * gust_n + GUSTS_N * (1.0 - keep * keep).sqrt() * normal(random);
            let rolling_n = at(truth.rolling, ambient_c) + own_n + gust_n + cold_n;
            distance_m += 0.1 * speed_m_s;
            Row {
                time_s: 0.1 * i as f64,
                speed_m_s,
                grade: plant_core::mechanics::slope::Grade::from_sin(slope as f32),
                auxiliary_w: (heating_w + base_w) as f32,
                air_density_factor: air as f32,
                rolling_factor: (rolling_n / truth.rolling[0]).max(0.0) as f32,
                ..Row::FLAT
            }
        })
        .collect();
    let run = run::vehicle(vehicle, &Route { rows }, 0.85, 0.01, false, &Unseen).unwrap();
    let rad_per_m = 9.665 / 0.340;
    let n = run.trace.len();
    let mut trip = Trip::empty(&format!("{number}"), n);
    for (i, row) in run.trace.iter().enumerate() {
        let speed = f64::from(row.speed_m_s);
        let still = speed < 0.02;
        trip.time_s[i] = row.time_s;
        trip.speed_m_s[i] = if still { 0.0 } else { speed + 0.005 * normal(random) };
        trip.elevation_m[i] = heights_m[i] + 0.3 * normal(random);
        // What a car tells is the torque of the shaft.
        let friction_nm = truth.get("loss_w_s2_per_rad2") * speed * rad_per_m;
        trip.motor_torque_nm[i] =
            f64::from(row.motor_torque_nm) - friction_nm + 0.3 * normal(random);
        trip.battery_v[i] = f64::from(row.battery_voltage_v) + 0.03 * normal(random);
        trip.battery_a[i] = f64::from(row.battery_current_a) + 0.1 * normal(random);
        trip.soc[i] = f64::from(row.soc);
        trip.heating_w[i] = heating_w;
        trip.aircon_w[i] = 0.0;
        trip.ambient_c[i] = ambient_c;
        trip.throttle[i] = if row.brake_n > 0.0 { 0.0 } else { 0.1 };
    }
    // The first row is before the first step.
    trip.motor_torque_nm[0] = 0.0;
    trip
}

fn options(name: &str, template: &str) -> VehicleOptions {
    VehicleOptions { name: name.to_owned(), command: String::new(), template: template.to_owned() }
}

/// A vehicle of the fleet, and the trips that it drives.
fn fleet(seed: u64) -> (Truth, Vec<Trip>) {
    let mut random = fastrand::Rng::with_seed(seed);
    let truth = Truth::new(&mut random);
    let vehicle = truth.vehicle();
    let trips = (0..TRIPS).map(|i| driven(&truth, &vehicle, i, &mut random)).collect();
    (truth, trips)
}

fn found(trips: Vec<Trip>) -> IdentifiedVehicle {
    let folder = tempfile::tempdir().unwrap();
    let template = folder.path().join("fleet.toml");
    // The fleet's heights are sound: they need little smoothing.
    let mut text: toml::Table = vehicle::text("bmw-i3-60ah").unwrap().1.parse().unwrap();
    let trips_table = "speed_smoothing_s = 0.15\nheight_smoothing_m = 40.0\nrolling_factor = [[15, 1]]\n\
                       warm_up_factor = 0\nwarm_up_m = 2500\nmoving_power_w = 0\n";
    text.insert("trips".into(), trips_table.parse::<toml::Table>().unwrap().into());
    std::fs::write(&template, toml::to_string(&text).unwrap()).unwrap();
    vehicle_of_trips(trips, options("fleet", template.to_str().unwrap()), &|_| Ok(())).unwrap()
}

/// What is found of one vehicle of the fleet: how many standard errors each parameter is off.
fn offs(seed: u64) -> Vec<(&'static str, f64)> {
    let (truth, trips) = fleet(seed);
    let found = found(trips);
    assert_eq!(found.expected.count, TRIPS as usize, "seed {seed}: a trip is marked");
    let parameter = |name: &str| found.parameters.iter().find(|p| p.name == name).unwrap().clone();
    (truth.parameters.iter())
        .map(|(name, value)| {
            let found = parameter(name);
            println!(
                "seed {seed} {name}: {value:.5}, found {:.5} ± {:.5}",
                found.value, found.standard_error
            );
            (*name, (found.value - value) / found.standard_error)
        })
        .collect()
}

/// Nine in ten of all parameters lie within two standard errors; of 50 seeds each parameter alone
/// does, but for the scatter of so few.
fn recovered(seeds: std::ops::Range<u64>) {
    let all: Vec<Vec<(&str, f64)>> = seeds.map(offs).collect();
    let share = |of: &dyn Fn(&str) -> bool| {
        let offs: Vec<f64> =
            all.iter().flatten().filter(|(name, _)| of(name)).map(|(_, off)| off.abs()).collect();
        offs.iter().filter(|off| **off <= 2.0).count() as f64 / offs.len() as f64
    };
    for (name, _) in &all[0] {
        println!(
            "{name}: {:.0} % within two standard errors",
            100.0 * share(&|other| other == *name)
        );
    }
    let whole = share(&|_| true);
    assert!(whole >= 0.9, "{:.1} % within two standard errors", 100.0 * whole);
}

#[test]
fn a_synthetic_fleet_is_found_again() {
    recovered(0..4);
}

#[test]
#[ignore = "minutes: cargo test --release -p voltstep-tests --test identify_vehicle -- --ignored"]
fn a_synthetic_fleet_of_fifty_is_found_again() {
    recovered(0..50);
}

#[test]
fn a_trip_that_contradicts_itself_is_marked_and_never_fitted() {
    let (_, mut trips) = fleet(7);
    trips[3].battery_v.iter_mut().for_each(|v| *v *= 1.2);
    let with = found(trips.clone());
    trips.remove(3);
    let without = found(trips);
    let marked: Vec<_> = with.left_out.iter().filter(|r| !r.doubts.is_empty()).collect();
    assert!(marked.len() == 1 && marked[0].name == "3", "{marked:?}");
    assert!(marked[0].doubts[0].contains("contradict each other"), "{marked:?}");
    assert_eq!((with.expected.count, with.expected_of_all.count), (13, 14));
    let values = |of: &IdentifiedVehicle| of.parameters.iter().map(|p| p.value).collect::<Vec<_>>();
    assert_eq!(values(&with), values(&without));
}

/// The built-in vehicle is what the command makes of the real trips, and stays so when it is the one
/// to start from.
#[test]
fn the_built_in_vehicle_is_what_the_trips_tell() {
    let files = voltstep_tests::real_files("bmw-i3-trips");
    if files.is_empty() {
        return;
    }
    let options = options("bmw-i3-60ah", "bmw-i3-60ah");
    let found = identify_vehicle(&files, options, &|_| Ok(())).unwrap().toml;
    let mut found: toml::Table = found.parse().unwrap();
    let mut kept: toml::Table = vehicle::text("bmw-i3-60ah").unwrap().1.parse().unwrap();
    let of = |fit: Option<toml::Value>, key: &str| fit.unwrap()[key].clone();
    let (found_fit, kept_fit) = (found.remove("fit"), kept.remove("fit"));
    assert_eq!(of(found_fit.clone(), "trips"), of(kept_fit.clone(), "trips"));
    assert_eq!(of(found_fit, "not_fitted"), of(kept_fit, "not_fitted"));
    for text in ["description", "source"] {
        found.remove(text);
        kept.remove(text);
    }
    assert_eq!(found, kept);
}

/// Identified from one half of the real trips; judged on the other.
#[test]
fn real_trips_are_followed_by_what_others_told() {
    let files = voltstep_tests::real_files("bmw-i3-trips");
    if files.is_empty() {
        return;
    }
    let half =
        |odd: usize| -> Vec<PathBuf> { files.iter().skip(odd).step_by(2).cloned().collect() };
    let (mut energy, mut torque, mut volts) = (Vec::new(), Vec::new(), Vec::new());
    for (fitted, judged) in [(half(0), half(1)), (half(1), half(0))] {
        let identified = |name| {
            let options = options(name, "bmw-i3-60ah");
            identify_vehicle(&fitted, options, &|_| Ok(())).unwrap()
        };
        let found: IdentifiedVehicle = identified("half");
        assert_eq!(found.toml, identified("half").toml, "the same from the same");
        let vehicle = vehicle::parse("half", found.toml.as_bytes()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for file in judged {
            std::fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
        }
        let report = trips::run(folder.path(), &vehicle, 0.01).unwrap();
        for row in report.trips.iter().filter(|r| r.counts) {
            match row.torque_rmse_nm {
                Some(nm) => {
                    energy.push(row.energy_rel.abs());
                    torque.push(nm);
                }
                None => volts.push(row.voltage_rmse_v),
            }
        }
    }
    let quantile = |values: &mut Vec<f64>, share: f64| {
        values.sort_unstable_by(f64::total_cmp);
        values[((values.len() - 1) as f64 * share).ceil() as usize]
    };
    let median = quantile(&mut energy, 0.5);
    let most = quantile(&mut energy, 0.9);
    let (nm, volt) = (quantile(&mut torque, 0.5), quantile(&mut volts, 0.5));
    println!(
        "{} trips: energy {:.1} % / {:.1} %, torque {nm:.2} N·m, voltage {volt:.2} V",
        energy.len(),
        100.0 * median,
        100.0 * most
    );
    assert!(energy.len() >= 20 && median <= 0.04 && most <= 0.09, "{median} {most}");
    assert!(nm <= 8.0 && volt <= 1.0, "{nm} {volt}");
}
