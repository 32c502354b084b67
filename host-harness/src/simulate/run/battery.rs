//! A vehicle's battery alone, on a current or a power.

use std::time::Instant;

use plant_core::battery::{Battery, BatteryInput, MappedBattery, MappedBatteryInput, Pack};
use plant_core::port::Source;
use plant_core::powertrain::Limited;
use plant_core::signal::sources::{AtEnd, TimeTable, TimeTableParams, TimeTableState};
use plant_core::{Dt, num};

use super::{Extremes, Run, Totals, TraceRow, step_at, tell};
use crate::read::vehicle::{Vehicle, VehicleBattery};
use crate::simulate::progress::Progress;

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

/// What a load is given as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Current \[A\].
    Current,
    /// Power at the terminals \[W\].
    Power,
}

impl Of {
    /// The current that flows \[A\]; of a power beyond what the source has, that of its most.
    fn current_a(self, demand: f32, source: Source) -> f32 {
        match self {
            Self::Current => demand,
            Self::Power => {
                let Source { emf_v, resistance_ohm } = source;
                let root = num::sqrt(num::max(emf_v * emf_v - 4.0 * resistance_ohm * demand, 0.0));
                let most = emf_v / (2.0 * resistance_ohm);
                num::min(2.0 * demand / (emf_v + root), most)
            }
        }
    }
}

/// What a battery was measured to do, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Time from 0 \[s\].
    pub time_s: f32,
    /// Current \[A\] or power \[W\], linear to the next.
    pub demand: f32,
    /// Temperature \[°C\]; NaN where it was not measured.
    pub temperature_c: f32,
}

/// Runs a vehicle's battery alone on a load and its temperature, with a trace row at each
/// sample.
///
/// # Errors
/// A parameter that is out of range, or fewer than two samples.
pub fn battery(
    vehicle: &Vehicle,
    (load, of): (&[Load], Of),
    start_soc: f32,
    dt_s: f64,
    progress: &dyn Progress,
) -> anyhow::Result<Run> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s(dt_s as f32)?;
    match vehicle.powertrain.battery {
        VehicleBattery::Constant(battery) => {
            alone(&Battery::new(battery, dt)?, (load, of), start_soc, dt_s, dt, progress)
        }
        VehicleBattery::Mapped(battery) => {
            alone(&MappedBattery::new(battery, dt)?, (load, of), start_soc, dt_s, dt, progress)
        }
    }
}

fn alone<B: Alone>(
    battery: &B,
    (load, of): (&[Load], Of),
    start_soc: f32,
    dt_s: f64,
    dt: Dt,
    progress: &dyn Progress,
) -> anyhow::Result<Run> {
    let demand: Vec<_> = load.iter().map(|l| (l.time_s, l.demand)).collect();
    let table = held(&demand, dt)?;
    let mut clock = TimeTableState::default();
    let mut state = battery.rested(start_soc)?;
    let mut totals = Totals { motor_torque_nm: (0.0, 0.0), ..Totals::default() };
    let (first, first_c) = load.first().map_or((0.0, f32::NAN), |l| (l.demand, l.temperature_c));
    battery.set_temperature(&mut state, first_c);
    let source = battery.offer(&state).0;
    let first_a = of.current_a(first, source);
    let mut trace = Vec::with_capacity(load.len());
    let start_row = TraceRow {
        battery_current_a: first_a,
        battery_voltage_v: source.voltage_v(first_a),
        soc: start_soc,
        ..TraceRow::default()
    };
    trace.push(TraceRow { extremes: Extremes::of(&start_row), ..start_row });
    let mut steps = 0;
    let started = Instant::now();
    for (number, pair) in load.windows(2).enumerate() {
        let time_s = f64::from(pair[1].time_s);
        let until = step_at(time_s, dt_s);
        let mut row = TraceRow { time_s, ..trace[number] };
        row.extremes = if steps < until { Extremes::default() } else { Extremes::of(&row) };
        battery.set_temperature(&mut state, pair[0].temperature_c);
        while steps < until {
            let asked_a = of.current_a(table.step(&mut clock, ()).value, battery.offer(&state).0);
            let (soc, terminal_v, current_a, refused_charge_c) = battery.fed(&mut state, asked_a);
            totals.battery_energy_j += f64::from(terminal_v * current_a) * dt_s;
            if refused_charge_c != 0.0 {
                let limit = if asked_a > 0.0 { Limited::Discharge } else { Limited::Charge };
                totals.limited.count(limit);
            }
            totals.refused_charge_c += f64::from(refused_charge_c.abs());
            row.extremes.see(0.0, current_a, terminal_v);
            steps += 1;
            row.battery_current_a = current_a;
            row.battery_voltage_v = terminal_v;
            row.soc = soc;
        }
        totals.widen(&row.extremes);
        trace.push(row);
        tell(progress, number, load.len());
    }
    let wall = started.elapsed();
    Ok(Run { dt_s, steps, wall, trace, totals, energy: None })
}

/// Points over time whose last value holds.
fn held(points: &[(f32, f32)], dt: Dt) -> anyhow::Result<TimeTable<'_>> {
    Ok(TimeTable::new(TimeTableParams { points, at_end: AtEnd::Hold }, dt)?)
}
