//! UDDS in closed loop with its energy balance over time.

use anyhow::Context;
use plant_core::Dt;
use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::mechanics::body::Road;
use plant_core::powertrain::{Feedback, Powertrain, PowertrainInput};
use plant_core::presets::EPOWERTRAIN_UDDS;

use super::Role::{Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::read::cycle;
use crate::simulate::figures::J_PER_KWH;
use crate::simulate::route::Route;
use crate::verify::Check;
use crate::verify::tolerance::{NUMERICAL_100US, UDDS_EXPERIMENT};
use crate::verify::udds::widen;

pub(super) const ENERGY: Experiment = Experiment {
    name: "udds-energy",
    title: "UDDS in closed loop, its energy balance and the rate of its state of charge",
    source: "EPowertrain2025, section 5.3, figure 5.9",
    run,
};

const PANELS: &[Panel] = &[
    Panel {
        title: "Speed",
        unit: "km/h",
        lines: &[
            line("reference_km_h", "reference", Reference),
            line("speed_km_h", "simulated", Simulated),
        ],
    },
    Panel {
        title: "Motor torque",
        unit: "N·m",
        lines: &[
            line("motor_torque_max_nm", "highest within 0.1 s", Simulated),
            line("motor_torque_min_nm", "lowest", Simulated),
        ],
    },
    Panel {
        title: "Battery current (discharge positive)",
        unit: "A",
        lines: &[
            line("battery_current_max_a", "highest within 0.1 s", Simulated),
            line("battery_current_min_a", "lowest", Simulated),
        ],
    },
    Panel {
        title: "State of charge",
        unit: "%",
        lines: &[line("soc_percent", "simulated", Simulated)],
    },
    Panel {
        title: "Rate of the state of charge",
        unit: "%/min",
        lines: &[line("soc_rate_percent_per_min", "simulated", Simulated)],
    },
    Panel {
        title: "Energy",
        unit: "kWh",
        lines: &[
            line("electrochemical_kwh", "battery's chemistry", Reference),
            line("motion_kwh", "motion", Simulated),
            line("resistance_kwh", "air and tyres", Simulated),
            line("heat_kwh", "heat", Simulated),
        ],
    },
    Panel {
        title: "Energy that the balance does not explain",
        unit: "J",
        lines: &[line("residual_j", "simulated", Simulated)],
    },
];

/// The step \[s\]: shorter than that of a replay, so that the peaks of the ringing are caught.
const DT_S: f32 = 1e-4;

/// Kept rows are those of the route, 0.1 s apart: extremes and the rate of the state of charge are
/// those since the row before.
fn run() -> anyhow::Result<(Vec<Check>, Record)> {
    let mut record = Record::new(PANELS);
    let found = checks("UDDS, epowertrain-udds, in steps of 0.1 ms", |checks| {
        let dt = Dt::from_s(DT_S)?;
        let plant = Powertrain::new(EPOWERTRAIN_UDDS.powertrain, dt)?.with_ledger();
        let driver = Driver::new(EPOWERTRAIN_UDDS.driver, &EPOWERTRAIN_UDDS.powertrain, dt)?;
        let route = Route::of_cycle(&cycle::by_name("udds").context("no cycle `udds`")?);
        let start = plant.at_rest(EPOWERTRAIN_UDDS.initial_soc)?;
        let (mut state, mut driving) = (start, DriverState::default());
        let mut seen = plant.feedback(&start);
        let [mut torque, mut current] = [(0.0, 0.0); 2];
        let mut largest_error = 0.0_f64;
        for pair in route.rows.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let soc = f64::from(seen.soc);
            let (first, rate) =
                (from.speed_m_s, (to.speed_m_s - from.speed_m_s) / (to.time_s - from.time_s));
            let steps = steps(to.time_s) - steps(from.time_s);
            let [mut torque_nm, mut battery_a] = [(f64::INFINITY, f64::NEG_INFINITY); 2];
            for number in 0..steps {
                let reference = first + rate * f64::from(DT_S) * f64::from(number);
                largest_error = largest_error.max((reference - f64::from(seen.speed_m_s)).abs());
                let command = driver.step(&mut driving, input(reference, rate, seen));
                let out = plant.step(
                    &mut state,
                    PowertrainInput {
                        road: Road { brake_n: command.brake_n, ..Road::default() },
                        ..PowertrainInput::on(command.duty)
                    },
                );
                anyhow::ensure!(!out.rejected, "the plant refused its input at {} s", to.time_s);
                seen = Feedback::from(&out);
                widen(&mut torque_nm, out.drives.motor_nm.into());
                widen(&mut battery_a, out.battery_a.into());
            }
            for (whole, part) in [(&mut torque, torque_nm), (&mut current, battery_a)] {
                widen(whole, part.0);
                widen(whole, part.1);
            }
            let energy = plant.energy(&start, &state);
            let kwh = |joules: f32| f64::from(joules) / J_PER_KWH;
            record.keep(
                to.time_s,
                [
                    3.6 * to.speed_m_s,
                    3.6 * f64::from(seen.speed_m_s),
                    torque_nm.1,
                    torque_nm.0,
                    battery_a.1,
                    battery_a.0,
                    100.0 * f64::from(seen.soc),
                    100.0 * 60.0 * (f64::from(seen.soc) - soc) / (to.time_s - from.time_s),
                    kwh(energy.electrochemical),
                    kwh(energy.kinetic),
                    kwh(energy.drag + energy.rolling),
                    kwh(energy.series_joule + energy.polarisation_joule + energy.copper),
                    energy.residual.into(),
                ],
            );
        }
        let energy = plant.energy(&start, &state);
        let figures = [
            f64::from(seen.soc),
            f64::from(energy.electrochemical) / J_PER_KWH,
            torque.0,
            torque.1,
            current.0,
            current.1,
            largest_error,
        ];
        for (bound, figure) in UDDS_EXPERIMENT.iter().zip(figures) {
            checks.add(bound, figure);
        }
        checks.ledger(&energy, &NUMERICAL_100US);
        Ok(())
    })?;
    Ok((found, record))
}

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
const fn input(reference: f64, rate: f64, vehicle: Feedback) -> DriverInput {
    DriverInput { reference_m_s: reference as f32, reference_m_s2: rate as f32, vehicle }
}

/// The number of the step that begins nearest to a time.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
fn steps(time_s: f64) -> u32 {
    (time_s / f64::from(DT_S)).round() as u32
}
