//! The synchronous machine under field-oriented control.

use super::Role::{Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::verify::Check;
use crate::verify::field_oriented::{
    CASES, DT_S, PER_SAMPLE, Seen, longest_v, ramp, start, weakened,
};

pub(super) const START: Experiment = Experiment {
    name: "pmsm-start",
    title: "a synchronous machine starts under field-oriented control and is loaded",
    source: "EPowertrain2025, PMSM with its defaults; controllers chosen here",
    run: starting,
};

pub(super) const WEAKENING: Experiment = Experiment {
    name: "pmsm-field-weakening",
    title: "a synchronous machine holds its torque far above base speed",
    source: "EPowertrain2025, PMSM with its defaults; controllers chosen here",
    run: weakening,
};

const START_PANELS: &[Panel] = &[
    Panel {
        title: "Speed",
        unit: "rad/s",
        lines: &[
            line("reference_rad_s", "reference", Reference),
            line("speed_rad_s", "simulated", Simulated),
        ],
    },
    TORQUE,
    Panel {
        title: "Winding current",
        unit: "A",
        lines: &[line("d_a", "d axis", Simulated), line("q_a", "q axis", Simulated)],
    },
    VOLTAGE,
];

const TORQUE: Panel = Panel {
    title: "Torque",
    unit: "N·m",
    lines: &[
        line("wanted_torque_nm", "asked for", Reference),
        line("torque_nm", "in the air gap", Simulated),
    ],
};

const VOLTAGE: Panel = Panel {
    title: "Voltage, peak of a phase",
    unit: "V",
    lines: &[
        line("longest_v", "longest that is steady", Reference),
        line("voltage_v", "at the terminals", Simulated),
    ],
};

const WEAKENING_PANELS: &[Panel] = &[
    Panel {
        title: "Speed (imposed)",
        unit: "rad/s",
        lines: &[line("speed_rad_s", "simulated", Simulated)],
    },
    TORQUE,
    Panel {
        title: "Winding current",
        unit: "A",
        lines: &[
            line("closed_form_d_a", "d axis, closed form", Reference),
            line("d_a", "d axis", Simulated),
            line("q_a", "q axis", Simulated),
        ],
    },
    VOLTAGE,
    Panel {
        title: "Power",
        unit: "W",
        lines: &[
            line("electrical_w", "into the terminals", Simulated),
            line("shaft_w", "through the air gap", Simulated),
        ],
    },
];

fn starting() -> anyhow::Result<(Vec<Check>, Record)> {
    let mut record = Record::new(START_PANELS);
    let found = checks(CASES[2].name, |checks| {
        start(checks, |number, seen| {
            if number % PER_SAMPLE == 0 {
                let [torque_nm, d, q, volts] = common(seen);
                record.keep(
                    DT_S * f64::from(number),
                    [
                        seen.reference,
                        seen.machine.speed_rad_s.into(),
                        seen.torque_nm,
                        torque_nm,
                        d,
                        q,
                        longest_v(),
                        volts,
                    ],
                );
            }
        })
    })?;
    Ok((found, record))
}

fn weakening() -> anyhow::Result<(Vec<Check>, Record)> {
    let mut record = Record::new(WEAKENING_PANELS);
    let mut found = checks(CASES[0].name, weakened)?;
    found.extend(checks(CASES[1].name, |checks| {
        ramp(checks, |number, seen| {
            if number % (10 * PER_SAMPLE) == 0 {
                let [torque_nm, d, q, volts] = common(seen);
                record.keep(
                    DT_S * f64::from(number),
                    [
                        seen.reference,
                        seen.torque_nm,
                        torque_nm,
                        seen.d_a,
                        d,
                        q,
                        longest_v(),
                        volts,
                        seen.machine.electrical_w.into(),
                        seen.machine.air_gap_w.into(),
                    ],
                );
            }
        })
    })?);
    Ok((found, record))
}

/// Torque, currents, voltage.
fn common(seen: &Seen) -> [f64; 4] {
    let current = seen.machine.current_a;
    [seen.machine.torque_nm, current.d, current.q, seen.control.voltage_v.length()].map(f64::from)
}
