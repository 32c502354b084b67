//! Closed loop along a trip (`EPowertrain2025`, sections 5.4 and 5.5): the synthetic one that is part
//! of the project, and `TripA01` where `VOLTSTEP_DATA` says it is.

use std::path::Path;

use anyhow::Context;

use super::adaptive::Clock;
use super::composed::sets::I3;
use super::composed::{Command, ComposedReference, Description, ENERGY, Gates, MOST, SOC, V};
use super::tolerance as t;
use super::{Case, Checks};
use crate::read::trip::{self, Trip};
use crate::read::{input, vehicle};
use crate::simulate::mode::Mode;
use crate::simulate::progress::Unseen;
use crate::simulate::replay::{self, Options};
use crate::simulate::route::{Route, Row};
use crate::simulate::run;

const VEHICLE: &str = "bmw-i3-60ah-epowertrain";
const SYNTHETIC: &[u8] = include_bytes!("../../data/trips/synthetic.csv");
const TOLERANCE: f64 = 1e-8;
const DT_S: f64 = 1e-3;

pub(super) const CASES: [Case; 2] = [
    Case {
        name: "trip, synthetic, bmw-i3-60ah-epowertrain",
        models: &["Powertrain", "Driver", "Pid", "Battery"],
        run: |checks| against_adaptive(checks, &trip::parse("synthetic", SYNTHETIC)?),
    },
    Case {
        name: "trip, TripA01, bmw-i3-60ah-epowertrain",
        models: &["Powertrain", "Driver", "Pid", "Battery", "TimeTable"],
        run: real,
    },
];

/// Speed, state of charge at each row, energy at the end \[kWh\].
struct Solution {
    speed: Vec<f64>,
    soc: Vec<f64>,
    energy_kwh: f64,
}

/// The adaptive solution along a trip's speed, slope and auxiliary power.
fn solve(route: &Route, soc: f64) -> anyhow::Result<Solution> {
    let first = route.rows.first().context("an empty trip")?;
    // The measured power takes the place of the resistor.
    let mut vehicle = ComposedReference::new(Description { load_s: 0.0, ..I3 })?;
    let mut y = vehicle.rolling_at(first.speed_m_s, soc);
    let mut found = Solution { speed: vec![y[V]], soc: vec![soc], energy_kwh: 0.0 };
    for pair in route.rows.windows(2) {
        let (row, next): (&Row, &Row) = (&pair[0], &pair[1]);
        let command = Command {
            gates: [Gates::ControlledDuty; MOST],
            from_s: row.time_s,
            reference: row.speed_m_s,
            rate: (next.speed_m_s - row.speed_m_s) / (next.time_s - row.time_s),
            sin: f64::from(row.grade.sin),
            auxiliary_w: f64::from(row.auxiliary_w),
            ..Command::default()
        };
        let span = (row.time_s, next.time_s);
        let mut clock = Clock::never();
        vehicle.advance(&mut y, &command, span, TOLERANCE, &mut clock, |_, _, _| {})?;
        found.speed.push(y[V]);
        found.soc.push(y[SOC]);
    }
    found.energy_kwh = y[ENERGY];
    Ok(found)
}

fn against_adaptive(checks: &mut Checks, trip: &Trip) -> anyhow::Result<()> {
    let route = Route::of_trip(trip);
    let soc = trip.first_soc().context("no state of charge to start from")?;
    let mut vehicle = vehicle::load(VEHICLE)?;
    vehicle.powertrain.auxiliary.resistance_ohm = f32::INFINITY;
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let (exact, run) = rayon::join(
        || solve(&route, soc),
        || run::vehicle(&vehicle, &route, soc as f32, DT_S, true, &Unseen),
    );
    let (exact, run) = (exact?, run?);
    let energy = run.energy.context("a run without a ledger")?;
    let (mut squares, mut worst, mut count) = (0.0, 0.0_f64, 0.0);
    for ((row, v), soc) in run.trace.iter().zip(&exact.speed).zip(&exact.soc) {
        squares += (f64::from(row.speed_m_s) - v).powi(2);
        worst = worst.max((f64::from(row.soc) - soc).abs());
        count += 1.0;
    }
    checks.add(&t::TRIP_SOC, worst);
    let ours_kwh = f64::from(energy.electrochemical) / 3.6e6;
    checks.against(&t::TRIP_ENERGY, exact.energy_kwh, ours_kwh);
    checks.add(&t::TRIP_SPEED, f64::sqrt(squares / count));
    checks.ledger(&energy, &t::TRIP_NUMERICAL);
    Ok(())
}

fn real(checks: &mut Checks) -> anyhow::Result<()> {
    let Some(folder) = std::env::var_os("VOLTSTEP_DATA").filter(|v| !v.is_empty()) else {
        checks.skipped("VOLTSTEP_DATA is not set: it names the folder that has the real trips");
        return Ok(());
    };
    let trip = input::trip(&Path::new(&folder).join("bmw-i3-trips").join("TripA01.csv"))?;
    let replayed = |mode| {
        let options = Options { mode, dt_s: DT_S, ledger: true };
        replay::of_trip(vehicle::load(VEHICLE)?, trip.clone(), options, &Unseen)
    };
    let (battery, whole) = rayon::join(|| replayed(Mode::Battery), || replayed(Mode::Vehicle));
    let battery = battery?.summary.error.context("no comparison")?;
    checks.add(&t::TRIP_A01_BATTERY[0], battery.soc_final);
    checks.add(&t::TRIP_A01_BATTERY[1], battery.voltage_rmse_v);
    let summary = whole?.summary;
    let error = summary.error.context("no comparison")?;
    for (bound, figure) in t::TRIP_A01_VEHICLE.iter().zip([
        summary.figures.soc_final,
        error.soc_drop_rel,
        error.energy_rel,
        error.current_rmse_a,
        error.torque_rmse_nm.unwrap_or(f64::NAN),
        summary.speed_error_max_m_s.unwrap_or(f64::NAN),
    ]) {
        checks.add(bound, figure);
    }
    against_adaptive(checks, &trip)
}
