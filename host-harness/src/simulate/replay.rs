//! A replay, end to end: read, run, compare, write.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::cli::Mode;
use crate::read::cycle::{self, Cycle};
use crate::read::error::{self, nearest};
use crate::read::trip::{self, Trip};
use crate::read::vehicle::{self, Vehicle};
use crate::show::files;
use crate::show::sheet;
use crate::simulate::comparison::compare;
use crate::simulate::route::Route;
use crate::simulate::run::{self, Load, Run};
use crate::simulate::summary::Summary;

/// The vehicle where none is named.
pub const DEFAULT_VEHICLE: &str = "bmw-i3-60ah";
/// The longest step that makes sense for a vehicle \[ms\].
const LONGEST_STEP_MS: f64 = 1000.0;
/// The shortest: below, single-precision time has no meaning \[ms\].
const SHORTEST_STEP_MS: f64 = 1e-4;

/// How to replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// A built-in vehicle's name, or a file.
    pub vehicle: String,
    /// What of a trip.
    pub mode: Mode,
    /// Length of a step \[ms\].
    pub dt_ms: f64,
    /// Whether to keep the energy ledger.
    pub ledger: bool,
    /// Whether a long run shows its progress on a terminal.
    pub show_progress: bool,
}

/// What can be replayed.
#[derive(Clone, Debug)]
pub enum Input {
    /// A driving cycle.
    Cycle(Cycle),
    /// A measured trip.
    Trip(Box<Trip>),
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

/// Finds an input by a cycle's name, or reads a cycle or trip file.
///
/// # Errors
/// No such name or file; a file that is neither.
pub fn open(input: &str) -> anyhow::Result<Input> {
    if let Some(cycle) = cycle::by_name(input) {
        return Ok(Input::Cycle(cycle));
    }
    let path = Path::new(input);
    if !path.exists() {
        let nearest = nearest(input, cycle::names())
            .map(|n| format!(" (did you mean `{n}`?)"))
            .unwrap_or_default();
        bail!(
            "`{input}` is neither a file nor a built-in cycle{nearest}; there are: {}",
            cycle::names().collect::<Vec<_>>().join(", ")
        );
    }
    // Once: a pipe cannot be read again.
    let bytes = error::read(path)?;
    // Trip files separate their columns by semicolons, cycle files by commas.
    let head = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    Ok(if head.contains(&b';') {
        Input::Trip(Box::new(trip::parse(input, &bytes)?))
    } else {
        Input::Cycle(cycle::from_bytes(path, &bytes)?)
    })
}

/// Reads what is named and runs it.
///
/// # Errors
/// Bad input, by file, line and column where it is a file; a run that diverged.
pub fn replay(input: &str, options: &Options) -> anyhow::Result<Replay> {
    check_step(options.dt_ms)?;
    let vehicle = vehicle::load(&options.vehicle)?;
    match (open(input)?, options.mode) {
        (Input::Cycle(cycle), Mode::Vehicle) => of_cycle(&vehicle, &cycle, options),
        (Input::Cycle(cycle), Mode::Battery) => bail!(
            "`{}` is a driving cycle and has no measured current: --mode battery needs a trip",
            cycle.name
        ),
        (Input::Trip(trip), mode) => of_trip(vehicle, *trip, mode, options),
    }
}

/// Whether a step given on the command line makes sense.
///
/// # Errors
/// One that does not.
pub fn check_step(dt_ms: f64) -> anyhow::Result<()> {
    if !(SHORTEST_STEP_MS..=LONGEST_STEP_MS).contains(&dt_ms) {
        bail!("--dt-ms must lie in {SHORTEST_STEP_MS}..{LONGEST_STEP_MS}, not {dt_ms}");
    }
    Ok(())
}

fn of_cycle(vehicle: &Vehicle, cycle: &Cycle, options: &Options) -> anyhow::Result<Replay> {
    let route = Route::of_cycle(cycle);
    let dt_s = options.dt_ms / 1000.0;
    let soc = vehicle.initial_soc;
    let run = run::vehicle(vehicle, &route, soc, dt_s, options.ledger, options.show_progress)?;
    check_stepped(&run, &cycle.name, route.duration_s())?;
    let summary = Summary::new(&vehicle.name, &cycle.name, "cycle", &run, route.duration_s());
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
/// A trip without a state of charge to start from; a run that diverged.
#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
pub fn of_trip(
    mut vehicle: Vehicle,
    trip: Trip,
    mode: Mode,
    options: &Options,
) -> anyhow::Result<Replay> {
    let dt_s = options.dt_ms / 1000.0;
    let soc = trip
        .first_soc()
        .with_context(|| format!("{}: no state of charge to start from", trip.name))?;
    let route = Route::of_trip(&trip);
    let (run, mode) = match mode {
        Mode::Vehicle => {
            // The measured power takes the place of a resistor that stands for its mean.
            vehicle.powertrain.auxiliary.resistance_ohm = f32::INFINITY;
            let (ledger, progress) = (options.ledger, options.show_progress);
            (run::vehicle(&vehicle, &route, soc as f32, dt_s, ledger, progress)?, "trip")
        }
        Mode::Battery => {
            let load: Vec<_> = (route.rows.iter().zip(&trip.battery_a))
                .map(|(row, a)| Load {
                    time_s: row.time_s as f32,
                    current_a: *a as f32,
                    temperature_c: row.battery_c,
                })
                .collect();
            let progress = options.show_progress;
            (run::battery(&vehicle, &load, soc as f32, dt_s, progress)?, "battery")
        }
    };
    let duration_s = route.duration_s();
    check_stepped(&run, &trip.name, duration_s)?;
    let mut summary = Summary::new(&vehicle.name, &trip.name, mode, &run, duration_s);
    let (measured, deviation) = compare(&run, &trip);
    if mode == "battery" {
        summary.figures.distance_km = measured.distance_km;
        summary.figures.consumption_wh_per_km = measured
            .consumption_wh_per_km
            .map(|_| summary.figures.battery_energy_kwh * 1000.0 / measured.distance_km);
    }
    summary.notes.extend(trip.notes.iter().cloned());
    summary.notes.extend(trip.quirks(f64::from(vehicle.powertrain.battery.capacity_ah())));
    summary.measured = Some(measured);
    summary.error = Some(deviation);
    Ok(Replay { summary, run, trip: Some(trip) })
}

/// Writes summary, trace and plot sheet into `folder`, by default `out/<name>/`; all of them or
/// none. Gives the folder.
///
/// # Errors
/// A folder or file that cannot be written.
pub fn write(replay: &Replay, folder: Option<PathBuf>) -> anyhow::Result<PathBuf> {
    let folder = folder.unwrap_or_else(|| Path::new("out").join(&replay.summary.input));
    let files = [
        ("summary.json", replay.summary.to_json()?.into_bytes()),
        ("trace.csv", files::trace_csv(&replay.run, replay.trip.as_ref())?),
        ("report.svg", sheet::render(replay)?.into_bytes()),
    ];
    files::write_all(&folder, &files)?;
    Ok(folder)
}
