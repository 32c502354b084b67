//! The stepping loops: the whole vehicle, the battery alone.

use std::time::{Duration, Instant};

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use plant_core::battery::{Battery, BatteryInput, MappedBattery, MappedBatteryInput, Pack};
use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::mechanics::body::Road;
use plant_core::powertrain::Feedback;
use plant_core::powertrain::ledger::{Book, EnergyLedger, EnergyReport};
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainState};
use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams, TimeTableState};
use plant_core::{Dt, num};

use crate::read::vehicle::{Vehicle, VehicleBattery};
use crate::simulate::route::{Route, Row};

/// A run that takes longer than this shows its progress on a terminal.
const SHOW_PROGRESS_AFTER: Duration = Duration::from_secs(1);

/// One kept row of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceRow {
    /// Time from the start \[s\].
    pub time_s: f64,
    /// The speed to follow \[m/s\].
    pub reference_m_s: f32,
    /// Speed \[m/s\].
    pub speed_m_s: f32,
    /// Distance \[m\].
    pub distance_m: f32,
    /// Sine of the slope.
    pub slope_sin: f32,
    /// Duty applied.
    pub duty: f32,
    /// Air-gap torque \[N·m\].
    pub motor_torque_nm: f32,
    /// Friction brake \[N\].
    pub brake_n: f32,
    /// Winding current \[A\].
    pub motor_current_a: f32,
    /// Battery current \[A\], positive when discharging.
    pub battery_current_a: f32,
    /// Voltage at the battery's terminals \[V\].
    pub battery_voltage_v: f32,
    /// State of charge, 0..1.
    pub soc: f32,
}

/// The extremes and sums over every step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// Sum of the squared speed errors \[m²/s²\].
    pub speed_error_squares: f64,
    /// Largest speed error \[m/s\].
    pub speed_error_max_m_s: f32,
    /// Air-gap torque \[N·m\]: lowest, highest.
    pub motor_torque_nm: (f32, f32),
    /// Battery current \[A\]: lowest, highest.
    pub battery_current_a: (f32, f32),
    /// Lowest battery voltage \[V\].
    pub battery_voltage_min_v: f32,
    /// Net energy at the battery's terminals \[J\].
    pub battery_energy_j: f64,
    /// Steps in which a battery limit changed the duty or refused current.
    pub limited_steps: u64,
    /// Charge that the battery refused \[C\], without its sign (battery mode).
    pub refused_charge_c: f64,
}

impl Default for Totals {
    fn default() -> Self {
        let none = (f32::INFINITY, f32::NEG_INFINITY);
        Self {
            speed_error_squares: 0.0,
            speed_error_max_m_s: 0.0,
            motor_torque_nm: none,
            battery_current_a: none,
            battery_voltage_min_v: f32::INFINITY,
            battery_energy_j: 0.0,
            limited_steps: 0,
            refused_charge_c: 0.0,
        }
    }
}

/// A finished run.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The step \[s\].
    pub dt_s: f64,
    /// How many steps.
    pub steps: u64,
    /// Time spent stepping.
    pub wall: Duration,
    /// The kept rows: one at each row of the route, the first before the first step.
    pub trace: Vec<TraceRow>,
    /// Extremes and sums over every step.
    pub totals: Totals,
    /// The energy ledger, where it was kept.
    pub energy: Option<EnergyReport>,
}

/// Shows how far a long run is, on a terminal only.
struct Progress {
    started: Instant,
    bar: Option<ProgressBar>,
    rows: u64,
    wanted: bool,
}

impl Progress {
    fn new(rows: usize, wanted: bool) -> Self {
        Self { started: Instant::now(), bar: None, rows: rows as u64, wanted }
    }

    fn at(&mut self, row: usize) {
        if !self.wanted || !row.is_multiple_of(256) {
            return;
        }
        if self.bar.is_none() && self.started.elapsed() > SHOW_PROGRESS_AFTER {
            let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left");
            self.bar = style.ok().map(|s| ProgressBar::new(self.rows).with_style(s));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(row as u64);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// The number of the step that begins nearest to a time.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "times are ≥ 0")]
fn step_at(time_s: f64, dt_s: f64) -> u64 {
    (time_s / dt_s).round() as u64
}

/// Drives a vehicle along a route, with or without the energy ledger.
///
/// # Errors
/// A parameter that is out of range, or a plant that refused a step.
pub fn vehicle(
    vehicle: &Vehicle,
    route: &Route,
    start_soc: f32,
    dt_s: f64,
    ledger: bool,
    show_progress: bool,
) -> anyhow::Result<Run> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s(dt_s as f32)?;
    let drive = Drive { vehicle, route, start_soc, dt, dt_s, show_progress };
    let params = vehicle.powertrain;
    match (params.battery, ledger) {
        (VehicleBattery::Constant(battery), false) => {
            Ok(drive.along(&Powertrain::new(params.with_battery(battery), dt)?)?.0)
        }
        (VehicleBattery::Constant(battery), true) => {
            drive.with_ledger(&Powertrain::with_ledger(params.with_battery(battery), dt)?)
        }
        (VehicleBattery::Mapped(battery), false) => {
            Ok(drive.along(&Powertrain::mapped(params.with_battery(battery), dt)?)?.0)
        }
        (VehicleBattery::Mapped(battery), true) => {
            drive.with_ledger(&Powertrain::mapped_with_ledger(params.with_battery(battery), dt)?)
        }
    }
}

struct Drive<'a> {
    vehicle: &'a Vehicle,
    route: &'a Route,
    start_soc: f32,
    dt: Dt,
    dt_s: f64,
    show_progress: bool,
}

impl Drive<'_> {
    fn with_ledger<B: Pack>(&self, plant: &Powertrain<EnergyLedger, B>) -> anyhow::Result<Run> {
        let (mut run, start, end) = self.along(plant)?;
        run.energy = Some(plant.energy(&start, &end));
        Ok(run)
    }

    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    fn along<L: Book, B: Pack>(
        &self,
        plant: &Powertrain<L, B>,
    ) -> anyhow::Result<Driven<L, B::State>> {
        let driver = Driver::new(self.vehicle.driver, &self.vehicle.powertrain, self.dt)?;
        let rows = &self.route.rows;
        let first = rows.first().context("an empty route")?;
        let mut start = plant.at_speed(self.start_soc, first.speed_m_s as f32)?;
        plant.battery().set_temperature(&mut start.battery, first.battery_c);
        let mut trace = Vec::with_capacity(rows.len());
        trace.push(TraceRow {
            reference_m_s: first.speed_m_s as f32,
            speed_m_s: first.speed_m_s as f32,
            battery_voltage_v: start.battery_v,
            soc: self.start_soc,
            slope_sin: first.grade.sin,
            ..TraceRow::default()
        });
        let mut loop_state = Loop {
            plant: start,
            driver: DriverState::default(),
            feedback: plant.feedback(&start),
            totals: Totals::default(),
        };
        let mut progress = Progress::new(rows.len(), self.show_progress);
        let mut steps = 0;
        let started = Instant::now();
        for (number, pair) in rows.windows(2).enumerate() {
            let (row, next) = (&pair[0], &pair[1]);
            let until = step_at(next.time_s, self.dt_s);
            let mut kept = TraceRow {
                time_s: next.time_s,
                reference_m_s: next.speed_m_s as f32,
                slope_sin: row.grade.sin,
                ..trace[number]
            };
            if until > steps {
                plant.battery().set_temperature(&mut loop_state.plant.battery, row.battery_c);
                let stretch = Stretch::new(row, next, steps, until, self.dt_s);
                let sound = loop_state.along(plant, &driver, &stretch, &mut kept);
                anyhow::ensure!(
                    sound,
                    "the plant refused its input before {:.3} s: the run diverged; try a shorter step",
                    next.time_s
                );
                steps = until;
            }
            trace.push(kept);
            progress.at(number);
        }
        let wall = started.elapsed();
        let Loop { plant: end, totals, .. } = loop_state;
        let run = Run { dt_s: self.dt_s, steps, wall, trace, totals, energy: None };
        Ok((run, start, end))
    }
}

/// A run, and the states at its start and its end.
type Driven<L, S> = (Run, PowertrainState<L, S>, PowertrainState<L, S>);

/// The steps between two rows: the reference is a line, the rest holds.
struct Stretch {
    steps: u64,
    dt_s: f64,
    first_m_s: f32,
    per_step_m_s: f32,
    rate_m_s2: f32,
    road: Road,
    auxiliary_w: f32,
}

impl Stretch {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_precision_loss,
        reason = "the plant computes in f32; counts stay below 2^53"
    )]
    fn new(row: &Row, next: &Row, from: u64, until: u64, dt_s: f64) -> Self {
        let rate = (next.speed_m_s - row.speed_m_s) / (next.time_s - row.time_s);
        let first = row.speed_m_s + rate * (from as f64 * dt_s - row.time_s);
        Self {
            steps: until - from,
            dt_s,
            first_m_s: first as f32,
            per_step_m_s: (rate * dt_s) as f32,
            rate_m_s2: rate as f32,
            road: Road { grade: row.grade, ..Road::default() },
            auxiliary_w: row.auxiliary_w,
        }
    }
}

/// What the stepping loop carries along.
struct Loop<L, S> {
    plant: PowertrainState<L, S>,
    driver: DriverState,
    feedback: Feedback,
    totals: Totals,
}

impl<L: Book, S: Copy> Loop<L, S> {
    /// The loop itself. Whether every step was accepted; `kept` gets the end of the last one.
    fn along<B: Pack<State = S>>(
        &mut self,
        plant: &Powertrain<L, B>,
        driver: &Driver,
        stretch: &Stretch,
        kept: &mut TraceRow,
    ) -> bool {
        // Locals, so that they live in registers.
        let (mut state, mut driving, mut feedback) = (self.plant, self.driver, self.feedback);
        let mut totals = self.totals;
        let mut road = stretch.road;
        let (mut squares, mut energy_w) = (0.0_f32, 0.0_f32);
        let mut number = 0.0_f32;
        let mut sound = true;
        for _ in 0..stretch.steps {
            let reference_m_s = stretch.first_m_s + stretch.per_step_m_s * number;
            number += 1.0;
            let error = reference_m_s - feedback.speed_m_s;
            squares += error * error;
            totals.speed_error_max_m_s = num::max(totals.speed_error_max_m_s, error.abs());
            let command = driver.step(
                &mut driving,
                DriverInput { reference_m_s, reference_m_s2: stretch.rate_m_s2, vehicle: feedback },
            );
            road.brake_n = command.brake_n;
            let out = plant.step(
                &mut state,
                PowertrainInput {
                    road,
                    auxiliary_w: stretch.auxiliary_w,
                    ..PowertrainInput::on(command.duty)
                },
            );
            feedback = Feedback::from(&out);
            energy_w += out.battery_v * out.battery_a;
            widen(&mut totals.motor_torque_nm, out.motor_nm);
            widen(&mut totals.battery_current_a, out.battery_a);
            totals.battery_voltage_min_v = num::min(totals.battery_voltage_min_v, out.battery_v);
            totals.limited_steps += u64::from(feedback.limited);
            sound &= !out.rejected;
            kept.speed_m_s = out.speed_m_s;
            kept.distance_m = out.distance_m;
            kept.duty = out.duty;
            kept.motor_torque_nm = out.motor_nm;
            kept.brake_n = command.brake_n;
            kept.motor_current_a = out.motor_a;
            kept.battery_current_a = out.battery_a;
            kept.battery_voltage_v = out.battery_v;
            kept.soc = out.soc;
        }
        totals.speed_error_squares += f64::from(squares);
        totals.battery_energy_j += f64::from(energy_w) * stretch.dt_s;
        *self = Self { plant: state, driver: driving, feedback, totals };
        sound
    }
}

/// A battery that is stepped on its own.
trait Alone: Pack {
    /// One step: state of charge, voltage, current, refused charge \[C\].
    fn fed(&self, state: &mut Self::State, current_a: f32) -> (f32, f32, f32, f32);
}

impl Alone for Battery {
    fn fed(&self, state: &mut Self::State, current_a: f32) -> (f32, f32, f32, f32) {
        let out = self.step(state, BatteryInput { current_a });
        (out.soc, out.terminal_v, out.current_a, out.refused_charge_c)
    }
}

impl Alone for MappedBattery {
    fn fed(&self, state: &mut Self::State, current_a: f32) -> (f32, f32, f32, f32) {
        let out = self.step(state, MappedBatteryInput { current_a });
        (out.soc, out.terminal_v, out.current_a, out.refused_charge_c)
    }
}

/// What a battery was measured to do, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Time from 0 \[s\].
    pub time_s: f32,
    /// Current, linear to the next \[A\].
    pub current_a: f32,
    /// Temperature \[°C\]; NaN where it was not measured.
    pub temperature_c: f32,
}

/// Runs a vehicle's battery alone on measured current and temperature, with a trace row at each
/// sample.
///
/// # Errors
/// A parameter that is out of range, or fewer than two samples.
pub fn battery(
    vehicle: &Vehicle,
    load: &[Load],
    start_soc: f32,
    dt_s: f64,
    show_progress: bool,
) -> anyhow::Result<Run> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s(dt_s as f32)?;
    match vehicle.powertrain.battery {
        VehicleBattery::Constant(battery) => {
            alone(&Battery::new(battery, dt)?, load, start_soc, dt_s, dt, show_progress)
        }
        VehicleBattery::Mapped(battery) => {
            alone(&MappedBattery::new(battery, dt)?, load, start_soc, dt_s, dt, show_progress)
        }
    }
}

fn alone<B: Alone>(
    battery: &B,
    load: &[Load],
    start_soc: f32,
    dt_s: f64,
    dt: Dt,
    show_progress: bool,
) -> anyhow::Result<Run> {
    let current: Vec<_> = load.iter().map(|l| (l.time_s, l.current_a)).collect();
    let table = held(&current, dt)?;
    let mut clock = TimeTableState::default();
    let mut state = battery.rested(start_soc)?;
    let mut totals = Totals { motor_torque_nm: (0.0, 0.0), ..Totals::default() };
    let (first_a, first_c) =
        load.first().map_or((0.0, f32::NAN), |l| (l.current_a, l.temperature_c));
    battery.set_temperature(&mut state, first_c);
    let mut trace = Vec::with_capacity(load.len());
    trace.push(TraceRow {
        battery_current_a: first_a,
        battery_voltage_v: battery.offer(&state).0.voltage_v(first_a),
        soc: start_soc,
        ..TraceRow::default()
    });
    let mut progress = Progress::new(load.len(), show_progress);
    let mut steps = 0;
    let started = Instant::now();
    for (number, pair) in load.windows(2).enumerate() {
        let time_s = f64::from(pair[1].time_s);
        let until = step_at(time_s, dt_s);
        let mut row = TraceRow { time_s, ..trace[number] };
        battery.set_temperature(&mut state, pair[0].temperature_c);
        while steps < until {
            let (soc, terminal_v, current_a, refused_charge_c) =
                battery.fed(&mut state, table.step(&mut clock, ()).value);
            totals.battery_energy_j += f64::from(terminal_v * current_a) * dt_s;
            totals.limited_steps += u64::from(refused_charge_c != 0.0);
            totals.refused_charge_c += f64::from(refused_charge_c.abs());
            widen(&mut totals.battery_current_a, current_a);
            totals.battery_voltage_min_v = num::min(totals.battery_voltage_min_v, terminal_v);
            steps += 1;
            row.battery_current_a = current_a;
            row.battery_voltage_v = terminal_v;
            row.soc = soc;
        }
        trace.push(row);
        progress.at(number);
    }
    let wall = started.elapsed();
    Ok(Run { dt_s, steps, wall, trace, totals, energy: None })
}

/// Points over time whose last value holds.
fn held(points: &[(f32, f32)], dt: Dt) -> anyhow::Result<TimeTable<'_>> {
    Ok(TimeTable::new(TimeTableParams { points, at_end: AtEnd::Hold }, dt)?)
}

#[inline]
fn widen(range: &mut (f32, f32), value: f32) {
    *range = (num::min(range.0, value), num::max(range.1, value));
}
