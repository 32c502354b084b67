//! The DC motor's step.

use super::Role::{Measured, Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::verify::Check;
use crate::verify::motor::{DT_S, PER_SAMPLE, RPM_PER_RAD_S, SETS, step};
use crate::verify::tolerance::MOTOR_MEASURED;

pub(super) const STEP: Experiment = Experiment {
    name: "motor-step",
    title: "a DC motor's voltage steps from 60 to 248 V",
    source: "EPowertrain2025, section 5.2.1, figure 5.1",
    run,
};

/// Of each parameter set the steady values before, those after, and nothing between.
const PANELS: &[Panel] = &[
    Panel {
        title: "Voltage",
        unit: "V",
        lines: &[line("voltage_v", "at the terminals", Reference)],
    },
    Panel {
        title: "Current",
        unit: "A",
        lines: &[
            line("measured_current_a", "measured, steady", Measured),
            line("pasek_current_a", "Pasek", Simulated),
            line("moments_current_a", "Moments", Simulated),
        ],
    },
    Panel {
        title: "Speed",
        unit: "rpm",
        lines: &[
            line("measured_speed_rpm", "measured, steady", Measured),
            line("pasek_speed_rpm", "Pasek", Simulated),
            line("moments_speed_rpm", "Moments", Simulated),
        ],
    },
];

/// Steps that are kept before and after that of the voltage.
const BEFORE: i32 = 5_000;
const AFTER: i32 = 50_000;
/// It is steady from here on.
const STEADY: i32 = 40_000;

fn run() -> anyhow::Result<(Vec<Check>, Record)> {
    let (mut found, mut traces) = (Vec::new(), Vec::new());
    for set in &SETS {
        let mut trace = Vec::new();
        found.extend(checks(set.name, |checks| {
            step(checks, set, |number, out| {
                if number % PER_SAMPLE == 0 && (-BEFORE..=AFTER).contains(&number) {
                    let rpm = f64::from(out.speed_rad_s) * RPM_PER_RAD_S;
                    trace.push((number, [f64::from(out.current_a), rpm]));
                }
            })
        })?);
        traces.push(trace);
    }
    let [before_a, after_a, before_rpm, after_rpm] =
        [0, 1, 2, 3].map(|k| MOTOR_MEASURED[k].target.unwrap_or(f64::NAN));
    let mut record = Record::new(PANELS);
    // With static torque, as measured.
    for ((number, pasek), (_, moments)) in traces[0].iter().zip(&traces[2]) {
        let (volts, measured) = match *number {
            ..=0 => (60.0, [before_a, before_rpm]),
            STEADY.. => (248.0, [after_a, after_rpm]),
            _ => (248.0, [f64::NAN; 2]),
        };
        let [(a, rpm), (pasek_a, pasek_rpm), (moments_a, moments_rpm)] =
            [measured, *pasek, *moments].map(|[a, rpm]| (a, rpm));
        record.keep(
            f64::from(*number) * DT_S,
            [volts, a, pasek_a, moments_a, rpm, pasek_rpm, moments_rpm],
        );
    }
    Ok((found, record))
}
