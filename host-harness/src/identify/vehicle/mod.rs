//! The identification of a vehicle from trips: what it weighs, what resists it, what its drive
//! loses.
//!
//! `F = (m + m_turning)·a + m·g·sin α + F₀(T) + W·e^(−x/d) + ½·ρ·C_d·A·v²` at the road, the motor's
//! torque behind a gear that loses a share of it, and `P = T·ω + c₂·T² + c₁·|T| + c_ω·ω² + P_moving +
//! base + auxiliaries` at the battery. `samples` takes means over short windows, `regress` finds the
//! parameters one group after the other; errors come from leaving trips out.

mod regress;
mod samples;
mod write;

use std::path::PathBuf;

use anyhow::{Context, ensure};
use rayon::prelude::*;
use serde::Serialize;

use super::input;
use crate::identify::Tick;
use crate::read::trip::Trip;
use crate::read::vehicle::{self, TripConditions, Vehicle};
use crate::simulate::mode::Mode;
use crate::simulate::progress::Unseen;
use crate::simulate::replay;
use crate::simulate::statistics::{Spread, Spreads, spread};
use regress::Found;
use samples::{Known, Prepared};

/// A trip that is further from its own torque is not fitted, as a share of the energy exchanged.
const CONTRADICTION: f64 = 0.06;
/// Fewer trips tell no errors.
const LEAST_TRIPS: usize = 3;
/// The step of the replays of trips that are left out \[s\].
const STEP_S: f64 = 0.01;
/// How trips are read, where the vehicle's file does not say.
const SPEED_SMOOTHING_S: f64 = 0.15;
const HEIGHT_SMOOTHING_M: f64 = 600.0;
/// Distance over which tyres get warm \[m\].
const WARM_UP_M: f64 = 2500.0;
/// Temperatures for which the rolling resistance is told \[°C\].
const TOLD_C: [f64; 3] = [0.0, 15.0, 30.0];

/// The name of the base load.
const BASE: &str = "base_w";

/// What is known beforehand.
#[derive(Clone, Debug)]
pub struct VehicleOptions {
    /// Name of the vehicle to write.
    pub name: String,
    /// The command, for the file.
    pub command: String,
    /// The vehicle that gives what trips do not tell: a built-in one or a file.
    pub template: String,
}

/// A parameter with its standard error.
#[derive(Clone, Debug, Serialize)]
pub struct Parameter {
    /// Its name, with the unit.
    pub name: String,
    /// What it is.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// How far the vehicle that the other trips make is from a trip.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOut {
    /// The trip.
    pub name: String,
    /// Net energy at the battery, relative to the measured one.
    pub energy_rel: f64,
    /// Motor torque \[N·m\].
    pub torque_rmse_nm: Option<f64>,
    /// State of charge, 0..1.
    pub soc_rmse: f64,
    /// Why the trip does not count and was never fitted; empty where it does and was.
    pub doubts: Vec<String>,
}

/// A vehicle, and how well it is known.
#[derive(Clone, Debug, Serialize)]
pub struct IdentifiedVehicle {
    /// Its name.
    pub name: String,
    /// The command that found it.
    pub command: String,
    /// Each parameter that was found.
    pub parameters: Vec<Parameter>,
    /// Each trip against what the others found.
    pub left_out: Vec<LeftOut>,
    /// What to expect of a new trip: those that count.
    pub expected: Spreads,
    /// With those that do not count.
    pub expected_of_all: Spreads,
    /// Standard deviation over trips of the force that is left unexplained \[N\].
    pub unexplained_n: f64,
    /// What the reader should know.
    pub notes: Vec<String>,
    /// The vehicle's file.
    #[serde(skip)]
    pub toml: String,
}

/// Identifies a vehicle from trip files, and from the CSV files in folders.
///
/// # Errors
/// A file that cannot be read or is no trip, trips that do not tell a vehicle; what `tick` says.
pub fn identify_vehicle(
    inputs: &[PathBuf],
    options: VehicleOptions,
    tick: Tick,
) -> anyhow::Result<IdentifiedVehicle> {
    tick("reading")?;
    let (trips, cells) = input::read(inputs)?;
    ensure!(cells.is_empty(), "tests of a cell tell no vehicle: give trips");
    vehicle_of_trips(trips, options, tick)
}

/// Identifies a vehicle from trips.
///
/// # Errors
/// Trips that do not tell a vehicle; what `tick` says.
pub fn vehicle_of_trips(
    trips: Vec<Trip>,
    options: VehicleOptions,
    tick: Tick,
) -> anyhow::Result<IdentifiedVehicle> {
    let template = Template::new(&options)?;
    let known = Known::of(&template.vehicle, WARM_UP_M)?;
    tick("screening")?;
    let mut trips: Vec<Prepared> =
        trips.into_par_iter().map(|t| Prepared::new(t, &template.vehicle, &known)).collect();
    for trip in &mut trips {
        if trip.road.is_empty() {
            trip.doubts.push("no torque of the motor while it drives".to_owned());
        }
    }
    contradictions(&mut trips, &known)?;
    let trips = trips;
    let fitted: Vec<&Prepared> = trips.iter().filter(|t| t.doubts.is_empty()).collect();
    tick("fitting")?;
    let found = Found::from(&fitted, &known)?;
    let without: Vec<Found> = (0..fitted.len())
        .into_par_iter()
        .map(|out| {
            tick("leaving trips out of the fit")?;
            let mut rest = fitted.clone();
            rest.remove(out);
            Found::from(&rest, &known).with_context(|| format!("without {}", fitted[out].trip.name))
        })
        .collect::<anyhow::Result<_>>()?;
    let parameters = jackknife(&found, &without);
    let mut notes: Vec<String> = fitted
        .iter()
        .flat_map(|t| t.trip.screened().notes.into_iter().map(|n| format!("{}: {n}", t.trip.name)))
        .collect();
    notes.extend(notes_of(&fitted, &found));

    let vehicles = without
        .iter()
        .map(|found| template.with(found, &known))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let whole = template.with(&found, &known)?;
    let mut vehicles = vehicles.into_iter();
    let judged: Vec<(&Prepared, Vehicle)> = trips
        .iter()
        .map(|t| {
            let own = if t.doubts.is_empty() { vehicles.next() } else { None };
            (t, own.unwrap_or_else(|| whole.clone()))
        })
        .collect();
    let left_out: Vec<LeftOut> = judged
        .into_par_iter()
        .map(|(trip, vehicle)| {
            tick("replaying trips that were left out")?;
            replayed(trip, vehicle)
        })
        .collect::<anyhow::Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect();
    let mut identified = IdentifiedVehicle {
        name: options.name,
        command: options.command,
        parameters,
        expected: spreads(left_out.iter().filter(|r| r.doubts.is_empty())),
        expected_of_all: spreads(left_out.iter()),
        left_out,
        unexplained_n: found.unexplained_n,
        notes,
        toml: String::new(),
    };
    identified.toml = template.file(&found, &known, &identified)?;
    Ok(identified)
}

/// Marks the trips whose power and torque contradict each other.
fn contradictions(trips: &mut [Prepared], known: &Known) -> anyhow::Result<()> {
    let sound: Vec<&Prepared> = trips.iter().filter(|t| t.doubts.is_empty()).collect();
    let enough = |n: usize| {
        ensure!(
            n >= LEAST_TRIPS,
            "{n} trips that can be trusted; a vehicle wants {LEAST_TRIPS} at least"
        );
        Ok(())
    };
    enough(sound.len())?;
    let first = Found::from(&sound, known)?;
    for trip in trips.iter_mut().filter(|t| t.doubts.is_empty()) {
        let share = first.unexplained_energy(trip);
        if share > CONTRADICTION {
            trip.doubts.push(format!(
                "power and torque contradict each other by {:.1} % of the energy",
                100.0 * share
            ));
        }
    }
    enough(trips.iter().filter(|t| t.doubts.is_empty()).count())
}

/// What the trips do not tell.
fn notes_of(fitted: &[&Prepared], found: &Found) -> Vec<String> {
    let mut notes = Vec::new();
    if fitted.iter().all(|t| t.standing_w.is_none()) {
        notes.push("no trip stands still: the base load is that of the vehicle given".to_owned());
    }
    if found.regeneration.is_none() {
        notes.push(
            "no pedal is released: the limits of regeneration are those of the vehicle given"
                .to_owned(),
        );
    }
    let (low, high) = found.rolling.seen_c;
    if low >= high {
        notes.push(
            "the air's temperature does not vary: the rolling resistance is one for all".to_owned(),
        );
    }
    notes
}

fn replayed(trip: &Prepared, vehicle: Vehicle) -> anyhow::Result<Option<LeftOut>> {
    if trip.trip.first_soc().is_none() {
        return Ok(None);
    }
    let options = replay::Options { mode: Mode::Vehicle, dt_s: STEP_S, ledger: false };
    let replay = replay::of_trip(vehicle, trip.trip.clone(), options, &Unseen)
        .with_context(|| trip.trip.name.clone())?;
    let error = replay.summary.error.context("no comparison")?;
    Ok(Some(LeftOut {
        name: trip.trip.name.clone(),
        energy_rel: error.energy_rel,
        torque_rmse_nm: error.torque_rmse_nm,
        soc_rmse: error.soc_rmse,
        doubts: trip.doubts.clone(),
    }))
}

fn spreads<'a>(rows: impl Iterator<Item = &'a LeftOut> + Clone) -> Spreads {
    let spreads: Vec<Spread> = [
        spread("energy_rel", rows.clone().map(|r| Some(r.energy_rel))),
        spread("torque_rmse_nm", rows.clone().map(|r| r.torque_rmse_nm)),
        spread("soc_rmse", rows.clone().map(|r| Some(r.soc_rmse))),
    ]
    .into_iter()
    .flatten()
    .collect();
    Spreads { count: rows.count(), spreads }
}

/// Each parameter by name.
fn named(found: &Found) -> Vec<(String, f64)> {
    let [squared, size, speed, moving] = found.losses;
    let mut all = vec![
        ("mass_kg".to_owned(), found.mass_kg),
        ("drag_area_m2".to_owned(), found.drag_area_m2),
        ("gear_efficiency".to_owned(), found.efficiency),
        ("warm_up_n".to_owned(), found.warm_up_n),
    ];
    all.extend(TOLD_C.map(|c| (format!("rolling_at_{c:.0}_c_n"), found.rolling.at(c))));
    all.extend([
        (BASE.to_owned(), found.base_w),
        ("loss_w_per_nm2".to_owned(), squared),
        ("loss_w_per_nm".to_owned(), size),
        ("loss_w_s2_per_rad2".to_owned(), speed),
        ("loss_moving_w".to_owned(), moving),
    ]);
    if let Some(r) = found.regeneration {
        all.extend([
            ("regen_torque_nm".to_owned(), r.torque_nm),
            ("regen_power_w".to_owned(), r.power_w),
            ("regen_fade_m_s".to_owned(), r.fade_m_s),
        ]);
    }
    all
}

/// Standard errors from what each parameter would be without one of the trips.
fn jackknife(found: &Found, without: &[Found]) -> Vec<Parameter> {
    let samples: Vec<Vec<(String, f64)>> = without.iter().map(named).collect();
    #[expect(clippy::cast_precision_loss, reason = "a count")]
    let n = samples.len() as f64;
    named(found)
        .into_iter()
        .map(|(name, value)| {
            let of: Vec<f64> = (samples.iter())
                .filter_map(|s| s.iter().find(|(other, _)| *other == name).map(|(_, v)| *v))
                .collect();
            let mean = of.iter().sum::<f64>() / n;
            if name == BASE {
                return Parameter { name, value, standard_error: found.base_error_w };
            }
            let squares: f64 = of.iter().map(|v| (v - mean).powi(2)).sum();
            Parameter { name, value, standard_error: ((n - 1.0) / n * squares).sqrt() }
        })
        .collect()
}

/// The vehicle that gives what trips do not tell.
struct Template {
    /// Its file's name: a battery beside it is found by that.
    file: String,
    table: toml::Table,
    vehicle: Vehicle,
    name: String,
}

impl Template {
    fn new(options: &VehicleOptions) -> anyhow::Result<Self> {
        let (file, text) = vehicle::text(&options.template)?;
        let mut vehicle = vehicle::parse(&file, text.as_bytes())?;
        let table = text.parse().with_context(|| file.clone())?;
        vehicle.trips = Some(vehicle.trips.unwrap_or(TripConditions {
            speed_smoothing_s: SPEED_SMOOTHING_S,
            height_smoothing_m: HEIGHT_SMOOTHING_M,
            rolling_factor: vec![(regress::REFERENCE_C, 1.0)],
            warm_up_factor: 0.0,
            warm_up_m: WARM_UP_M,
            moving_power_w: 0.0,
        }));
        Ok(Self { file, table, vehicle, name: options.name.clone() })
    }
}
