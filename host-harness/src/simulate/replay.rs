//! A replay: a vehicle on a cycle or a trip, and how far it is from what was measured.

use anyhow::{Context, bail};

use crate::read::cycle::Cycle;
use crate::read::input::Drive;
use crate::read::profile::{Demand, Profile};
use crate::read::trip::Trip;
use crate::read::vehicle::Vehicle;
use crate::simulate::comparison::compare;
use crate::simulate::mode::{Mode, Replayed};
use crate::simulate::progress::Progress;
use crate::simulate::route::Route;
use crate::simulate::run::{self, Load, Of, Run};
use crate::simulate::summary::{StepError, Summary};

/// The vehicle where none is named.
pub const DEFAULT_VEHICLE: &str = "bmw-i3-60ah";

/// The step where none is named \[s\]; a longer one is compared with it.
pub const DEFAULT_STEP_S: f64 = 1e-3;
/// An error of the energy from here on is worth a note, and from here on useless, as a share.
const NOTED: f64 = 0.005;
const USELESS: f64 = 0.1;
/// Less net energy than this share of what the battery exchanged is no measure of an error.
const LEAST_NET: f64 = 0.25;

/// How to replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What of a trip.
    pub mode: Mode,
    /// Length of a step \[s\].
    pub dt_s: f64,
    /// Whether to keep the energy ledger.
    pub ledger: bool,
}

/// A finished replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// What it came to.
    pub summary: Summary,
    /// The run behind it.
    pub run: Run,
    /// The trip, where it was one.
    pub trip: Option<Trip>,
}

/// Runs a vehicle on a cycle or a trip. What a step that is longer than the default costs is said.
///
/// # Errors
/// A cycle where a measured current is asked for; a step so long that the result is useless; as
/// [`of_trip`].
pub fn replay(
    vehicle: &Vehicle,
    drive: Drive,
    options: Options,
    progress: &dyn Progress,
) -> anyhow::Result<Replay> {
    let alone = options.mode == Mode::Battery || matches!(drive, Drive::Profile(_));
    if alone || options.dt_s <= DEFAULT_STEP_S {
        return once(vehicle, drive, options, progress);
    }
    let mut replay = once(vehicle, drive.clone(), options, progress)?;
    let fine = Options { dt_s: DEFAULT_STEP_S, ledger: false, ..options };
    let error = StepError::between(&replay, &once(vehicle, drive, fine, progress)?);
    let said = format!(
        "in steps of {} ms the energy at the battery is off by {:+.1} %, the speed by {:.2} m/s RMS, \
         against steps of {} ms",
        1000.0 * options.dt_s,
        100.0 * error.energy_rel,
        error.speed_rms_m_s,
        1000.0 * DEFAULT_STEP_S
    );
    // Not a number is no small error.
    let within = |share| error.energy_rel.abs() <= share;
    anyhow::ensure!(within(USELESS), "{}: {said}: useless; try a shorter step", vehicle.name);
    if !within(NOTED) {
        replay.summary.notes.push(format!("{said}: choose a shorter one"));
    }
    replay.summary.step_error = Some(error);
    Ok(replay)
}

impl StepError {
    fn between(coarse: &Replay, fine: &Replay) -> Self {
        let net = |replay: &Replay| replay.run.totals.battery_energy_j;
        let exchanged: f64 = (fine.run.trace.windows(2))
            .map(|pair| {
                let watts = f64::from(pair[1].battery_voltage_v * pair[1].battery_current_a);
                watts.abs() * (pair[1].time_s - pair[0].time_s)
            })
            .sum();
        let squares: Vec<_> = (coarse.run.trace.iter().zip(&fine.run.trace))
            .map(|(a, b)| f64::from(a.speed_m_s - b.speed_m_s).powi(2))
            .collect();
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        let rows = squares.len() as f64;
        Self {
            energy_rel: (net(coarse) - net(fine)) / net(fine).abs().max(LEAST_NET * exchanged),
            speed_rms_m_s: (squares.iter().sum::<f64>() / rows).sqrt(),
        }
    }
}

/// As [`replay`], without the comparison of a long step.
///
/// # Errors
/// As [`replay`].
pub fn once(
    vehicle: &Vehicle,
    drive: Drive,
    options: Options,
    progress: &dyn Progress,
) -> anyhow::Result<Replay> {
    match (drive, options.mode) {
        (Drive::Cycle(cycle), Mode::Vehicle) => of_cycle(vehicle, &cycle, options, progress),
        (Drive::Cycle(cycle), Mode::Battery) => bail!(
            "`{}` is a driving cycle and has no measured current: the battery alone needs a trip",
            cycle.name
        ),
        (Drive::Profile(profile), _) => of_profile(vehicle, &profile, options, progress),
        (Drive::Trip(trip), _) => of_trip(vehicle.clone(), *trip, options, progress),
    }
}

fn of_cycle(
    vehicle: &Vehicle,
    cycle: &Cycle,
    options: Options,
    progress: &dyn Progress,
) -> anyhow::Result<Replay> {
    let route = Route::of_cycle(cycle);
    let Options { dt_s, ledger, .. } = options;
    let run = run::vehicle(vehicle, &route, vehicle.initial_soc, dt_s, ledger, progress)?;
    check_stepped(&run, &cycle.name, route.duration_s())?;
    let (name, duration_s) = (&vehicle.name, route.duration_s());
    let mut summary = Summary::new(name, &cycle.name, Replayed::Cycle, &run, duration_s);
    summary.notes.extend(route.cut());
    summary.notes.extend(cycle.notes.iter().cloned());
    Ok(Replay { summary, run, trip: None })
}

/// Trace rows of a profile are no further apart than this \[s\], but for points hours apart.
const PROFILE_ROW_S: f32 = 1.0;

/// The battery alone, from the vehicle's initial state of charge.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the plant computes in f32; counts of rows saturate"
)]
fn of_profile(
    vehicle: &Vehicle,
    profile: &Profile,
    options: Options,
    progress: &dyn Progress,
) -> anyhow::Result<Replay> {
    let (of, demand) = match &profile.demand {
        Demand::Current(demand) => (Of::Current, demand),
        Demand::Power(demand) => (Of::Power, demand),
    };
    let mut load: Vec<Load> = Vec::new();
    for ((time_s, demand), temperature_c) in
        profile.time_s.iter().zip(demand).zip(&profile.temperature_c)
    {
        let point = Load {
            time_s: *time_s as f32,
            demand: *demand as f32,
            temperature_c: *temperature_c as f32,
        };
        if let Some(before) = load.last().copied() {
            let rows = ((point.time_s - before.time_s) / PROFILE_ROW_S).ceil() as u16;
            load.extend((1..rows).map(|row| {
                let along = f32::from(row) / f32::from(rows);
                Load {
                    time_s: before.time_s + along * (point.time_s - before.time_s),
                    demand: before.demand + along * (point.demand - before.demand),
                    ..before
                }
            }));
        }
        load.push(point);
    }
    let run = run::battery(vehicle, (&load, of), vehicle.initial_soc, options.dt_s, progress)?;
    let duration_s = profile.time_s.last().copied().unwrap_or_default();
    check_stepped(&run, &profile.name, duration_s)?;
    let (name, input) = (&vehicle.name, &profile.name);
    let mut summary = Summary::new(name, input, Replayed::Profile, &run, duration_s);
    summary.notes.push(format!("starts at a state of charge of {} %", 100.0 * vehicle.initial_soc));
    if profile.temperature_c.iter().all(|c| c.is_nan()) {
        summary.notes.push("no battery temperature: 25 °C taken".to_owned());
    }
    summary.notes.extend(profile.notes.iter().cloned());
    Ok(Replay { summary, run, trip: None })
}

/// A run without a step has no figures.
fn check_stepped(run: &Run, name: &str, duration_s: f64) -> anyhow::Result<()> {
    let duration_ms = duration_s * 1000.0;
    anyhow::ensure!(run.steps > 0, "`{name}` lasts {duration_ms:.4} ms: shorter than a step");
    Ok(())
}

/// Runs a trip and compares it with what was measured.
///
/// # Errors
/// A trip without a state of charge to start from, or shorter than a step; a run that diverged.
#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub fn of_trip(
    mut vehicle: Vehicle,
    trip: Trip,
    options: Options,
    progress: &dyn Progress,
) -> anyhow::Result<Replay> {
    let Options { mode, dt_s, ledger } = options;
    let soc = trip
        .first_soc()
        .with_context(|| format!("{}: no state of charge to start from", trip.name))?;
    let trip = trip.without_frozen();
    let route = Route::of_trip_for(&trip, &vehicle);
    let (run, replayed) = match mode {
        Mode::Vehicle => {
            // The measured power takes the place of a resistor that stands for its mean.
            vehicle.powertrain.auxiliary.resistance_ohm = f32::INFINITY;
            let run = run::vehicle(&vehicle, &route, soc as f32, dt_s, ledger, progress)?;
            (run, Replayed::Trip)
        }
        Mode::Battery => {
            let load: Vec<_> = (route.rows.iter().zip(&trip.battery_a))
                .map(|(row, a)| Load {
                    time_s: row.time_s as f32,
                    demand: *a as f32,
                    temperature_c: row.battery_c,
                })
                .collect();
            let run = run::battery(&vehicle, (&load, Of::Current), soc as f32, dt_s, progress)?;
            (run, Replayed::Battery)
        }
    };
    let duration_s = route.duration_s();
    check_stepped(&run, &trip.name, duration_s)?;
    let mut summary = Summary::new(&vehicle.name, &trip.name, replayed, &run, duration_s);
    let (measured, deviation) = compare(&run, &trip);
    if mode == Mode::Battery {
        summary.figures.distance_km = measured.distance_km;
        summary.figures.consumption_wh_per_km = measured
            .consumption_wh_per_km
            .map(|_| summary.figures.battery_energy_kwh * 1000.0 / measured.distance_km);
    }
    if mode == Mode::Vehicle {
        summary.notes.extend(route.cut());
    }
    if trip.battery_c.iter().all(|c| c.is_nan()) {
        summary.notes.push("no battery temperature: 25 °C taken".to_owned());
    }
    if let Some(i) = trip.soc.iter().position(|s| s.is_finite()).filter(|i| *i > 0) {
        summary.notes.push(format!(
            "no state of charge at the start: that of {:.1} s taken",
            trip.time_s[i] - trip.time_s[0]
        ));
    }
    summary.notes.extend(trip.notes.iter().cloned());
    let screened = trip.screened();
    summary.notes.extend(screened.notes);
    summary.notes.extend(screened.doubts);
    summary.notes.extend(trip.quirks(f64::from(vehicle.powertrain.battery.capacity_ah())));
    summary.measured = Some(measured);
    summary.error = Some(deviation);
    Ok(Replay { summary, run, trip: Some(trip) })
}
