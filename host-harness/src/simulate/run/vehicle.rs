//! The whole vehicle along a route.

use std::time::Instant;

use anyhow::Context;
use plant_core::battery::{Battery, MappedBattery, Pack};
use plant_core::control::driver::{
    Driver, DriverInput, DriverParams, DriverState, Steered, Steering, TorqueDriver,
};
use plant_core::mechanics::body::Road;
use plant_core::powertrain::ledger::{Book, NoLedger};
use plant_core::powertrain::{
    Axles, Drives, Feedback, Powertrain, PowertrainInput, PowertrainState,
};
use plant_core::{Dt, num};

use super::drives::axle;
use super::{Extremes, Run, Totals, TraceRow, step_at, tell};
use crate::read::vehicle::{DriveKind, Vehicle, VehicleBattery};
use crate::simulate::progress::Progress;
use crate::simulate::route::{Route, Row};

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
    progress: &dyn Progress,
) -> anyhow::Result<Run> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s(dt_s as f32)?;
    let drive = Drive { vehicle, route, start_soc, dt, dt_s, progress };
    match vehicle.powertrain.battery {
        VehicleBattery::Constant(battery) => drive.with_battery(Battery::new(battery, dt)?, ledger),
        VehicleBattery::Mapped(battery) => {
            drive.with_battery(MappedBattery::new(battery, dt)?, ledger)
        }
    }
}

struct Drive<'a> {
    vehicle: &'a Vehicle,
    route: &'a Route,
    start_soc: f32,
    dt: Dt,
    dt_s: f64,
    progress: &'a dyn Progress,
}

impl Drive<'_> {
    fn with_battery<B: Pack>(&self, battery: B, ledger: bool) -> anyhow::Result<Run> {
        let (params, dt) = (&self.vehicle.powertrain, self.dt);
        let axle = |kind| axle(kind, params.wheel, dt);
        match params.drives.as_slice() {
            [Some(DriveKind::Dc(drive)), ..] if params.drives.count() == 1 => {
                let driver = Driver::new(self.vehicle.driver, &params.with_drives(*drive), dt)?;
                self.with_drives(battery, drive.on(params.wheel, dt)?, ledger, |_| Ok(driver))
            }
            [Some(one), None, ..] => {
                self.with_drives(battery, axle(*one)?, ledger, |plant| self.torque_driver(plant))
            }
            [Some(one), Some(two), None, ..] => {
                let axles = axle(*one)?.and(axle(*two)?);
                self.with_drives(battery, axles, ledger, |plant| self.torque_driver(plant))
            }
            [Some(one), Some(two), Some(three), None] => {
                let axles = axle(*one)?.and(axle(*two)?.and(axle(*three)?));
                self.with_drives(battery, axles, ledger, |plant| self.torque_driver(plant))
            }
            [Some(one), Some(two), Some(three), Some(four)] => {
                let axles = axle(*one)?.and(axle(*two)?).and(axle(*three)?.and(axle(*four)?));
                self.with_drives(battery, axles, ledger, |plant| self.torque_driver(plant))
            }
            _ => anyhow::bail!("a vehicle without a drive"),
        }
    }

    /// A driver whose demand is a torque, for any plant.
    fn torque_driver<B: Pack, D: Drives>(
        &self,
        plant: &Powertrain<NoLedger, B, D>,
    ) -> anyhow::Result<TorqueDriver> {
        let DriverParams::Torque(driver) = self.vehicle.driver else {
            anyhow::bail!("driver.duty drives one DC machine only");
        };
        Ok(TorqueDriver::fitted(
            driver,
            plant.motor_rad_per_m(),
            self.vehicle.powertrain.body.mass_kg,
            plant.moving_mass_kg(),
            self.dt,
        )?)
    }

    fn with_drives<B: Pack, D: Drives, S: Steering<D>>(
        &self,
        battery: B,
        axles: Axles<D>,
        ledger: bool,
        driver: impl FnOnce(&Powertrain<NoLedger, B, D>) -> anyhow::Result<S>,
    ) -> anyhow::Result<Run> {
        let plant = Powertrain::of(battery, axles, &self.vehicle.powertrain, self.dt)?;
        let driver = driver(&plant)?;
        if !ledger {
            return Ok(self.along(&plant, &driver)?.0);
        }
        let plant = plant.with_ledger();
        let (mut run, start, end) = self.along(&plant, &driver)?;
        run.energy = Some(plant.energy(&start, &end));
        Ok(run)
    }

    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    fn along<L: Book, B: Pack, D: Drives>(
        &self,
        plant: &Powertrain<L, B, D>,
        driver: &impl Steering<D>,
    ) -> anyhow::Result<Driven<L, B::State, D::State>> {
        let rows = &self.route.rows;
        let first = rows.first().context("an empty route")?;
        let mut start = plant.at_speed(self.start_soc, first.speed_m_s as f32)?;
        plant.battery().set_temperature(&mut start.battery, first.battery_c);
        let mut trace = Vec::with_capacity(rows.len());
        let start_row = TraceRow {
            reference_m_s: first.speed_m_s as f32,
            speed_m_s: first.speed_m_s as f32,
            battery_voltage_v: start.battery_v,
            soc: self.start_soc,
            slope_sin: first.grade.sin,
            temperatures: plant.temperatures(&start),
            ..TraceRow::default()
        };
        trace.push(TraceRow { extremes: Extremes::of(&start_row), ..start_row });
        let mut loop_state = Loop {
            plant: start,
            driver: DriverState::default(),
            feedback: plant.feedback(&start),
            totals: Totals::default(),
        };
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
            kept.extremes = Extremes::of(&kept);
            if until > steps {
                plant.battery().set_temperature(&mut loop_state.plant.battery, row.battery_c);
                let stretch = Stretch::new(row, next, steps, until, self.dt_s);
                let sound = loop_state.along(plant, driver, &stretch, &mut kept);
                anyhow::ensure!(
                    sound,
                    "the plant refused its input before {:.3} s: the run diverged; try a shorter step",
                    next.time_s
                );
                steps = until;
            }
            trace.push(kept);
            tell(self.progress, number, rows.len());
        }
        let wall = started.elapsed();
        let Loop { plant: end, totals, .. } = loop_state;
        let run = Run { dt_s: self.dt_s, steps, wall, trace, totals, energy: None };
        Ok((run, start, end))
    }
}

/// A run, and the states at its start and its end.
type Driven<L, S, E> = (Run, PowertrainState<L, S, E>, PowertrainState<L, S, E>);

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
            road: Road {
                grade: row.grade,
                air_density_factor: row.air_density_factor,
                rolling_factor: row.rolling_factor,
                ..Road::default()
            },
            auxiliary_w: row.auxiliary_w,
        }
    }
}

/// What the stepping loop carries along.
struct Loop<L, S, E> {
    plant: PowertrainState<L, S, E>,
    driver: DriverState,
    feedback: Feedback,
    totals: Totals,
}

impl<L: Book, S: Copy, E: Copy> Loop<L, S, E> {
    /// The loop itself. Whether every step was accepted; `kept` gets the end of the last one.
    fn along<B: Pack<State = S>, D: Drives<State = E>>(
        &mut self,
        plant: &Powertrain<L, B, D>,
        driver: &impl Steering<D>,
        stretch: &Stretch,
        kept: &mut TraceRow,
    ) -> bool {
        // Locals, so that they live in registers.
        let (mut state, mut driving, mut feedback) = (self.plant, self.driver, self.feedback);
        let mut totals = self.totals;
        let mut road = stretch.road;
        let mut extremes = Extremes::default();
        let (mut squares, mut energy_w) = (0.0_f32, 0.0_f32);
        let mut number = 0.0_f32;
        let mut sound = true;
        for _ in 0..stretch.steps {
            let reference_m_s = stretch.first_m_s + stretch.per_step_m_s * number;
            number += 1.0;
            let error = reference_m_s - feedback.speed_m_s;
            squares += error * error;
            totals.speed_error_max_m_s = num::max(totals.speed_error_max_m_s, error.abs());
            let seen =
                DriverInput { reference_m_s, reference_m_s2: stretch.rate_m_s2, vehicle: feedback };
            let Steered { command, brake_n, .. } = driver.steer(&mut driving, seen, plant.drives());
            road.brake_n = brake_n;
            let out = plant.step(
                &mut state,
                PowertrainInput {
                    road,
                    auxiliary_w: stretch.auxiliary_w,
                    ..PowertrainInput::with(command)
                },
            );
            feedback = plant.seen_of(&out);
            energy_w += out.battery_v * out.battery_a;
            extremes.see(feedback.motor_nm, out.battery_a, out.battery_v);
            totals.limited.count(out.limited);
            totals.limit_exceeded_a = num::max(totals.limit_exceeded_a, out.limit_exceeded_a);
            sound &= !out.rejected;
            kept.speed_m_s = out.speed_m_s;
            kept.distance_m = out.distance_m;
            kept.duty = feedback.duty;
            kept.motor_torque_nm = feedback.motor_nm;
            kept.brake_n = brake_n;
            kept.motor_current_a = feedback.motor_a;
            kept.battery_current_a = out.battery_a;
            kept.battery_voltage_v = out.battery_v;
            kept.soc = out.soc;
            kept.temperatures = D::temperatures(&out.drives);
            totals.temperatures = match (totals.temperatures, kept.temperatures) {
                (Some(worst), Some(now)) => Some(worst.worse(now)),
                (worst, now) => worst.or(now),
            };
        }
        totals.widen(&extremes);
        kept.extremes = extremes;
        totals.speed_error_squares += f64::from(squares);
        totals.battery_energy_j += f64::from(energy_w) * stretch.dt_s;
        *self = Self { plant: state, driver: driving, feedback, totals };
        sound
    }
}
