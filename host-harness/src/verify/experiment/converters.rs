//! Precharge, buck and boost converter, H-bridge with a DC motor, switch by switch.

use super::Role::{Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::verify::converters::{BOOST, BUCK, CASES, Stage, motor, precharge, stage};
use crate::verify::{Check, Checks};

pub(super) const PRECHARGE: Experiment = Experiment {
    name: "precharge",
    title: "a relay charges the link through 40 Ω, then the main contactor closes",
    source: "circuit of EPowertrain2025's elements; 355 V, 0.96 mF chosen here",
    run: || {
        let mut record = Record::new(PRECHARGE_PANELS);
        let figures =
            of_case(0, |checks| precharge(checks, |time_s, row| record.keep(time_s, row)))?;
        Ok((figures, record))
    },
};

pub(super) const BUCK_CONVERTER: Experiment = Experiment {
    name: "buck-converter",
    title: "a buck converter starts, switched and averaged",
    source: "circuit of EPowertrain2025's elements; 400 V, duty 0.4, 10 kHz chosen here",
    run: || stepped(1, &BUCK),
};

pub(super) const BOOST_CONVERTER: Experiment = Experiment {
    name: "boost-converter",
    title: "a boost converter starts, switched and averaged",
    source: "circuit of EPowertrain2025's elements; 200 V, duty 0.5, 10 kHz chosen here",
    run: || stepped(2, &BOOST),
};

pub(super) const H_BRIDGE: Experiment = Experiment {
    name: "h-bridge-motor",
    title: "an H-bridge with dead time turns a DC motor forward, then backward",
    source: "EPowertrain2025, section 5.2.1 (motor, Pasek); 400 V, 10 kHz and 2 µs chosen here",
    run: || {
        let mut record = Record::new(MOTOR_PANELS);
        let figures = of_case(3, |checks| motor(checks, |time_s, row| record.keep(time_s, row)))?;
        Ok((figures, record))
    },
};

const PRECHARGE_PANELS: &[Panel] = &[
    Panel {
        title: "Voltage of the link",
        unit: "V",
        lines: &[line("exact_v", "closed form", Reference), line("link_v", "circuit", Simulated)],
    },
    Panel {
        title: "Current of the source",
        unit: "A",
        lines: &[line("source_a", "circuit", Simulated)],
    },
];

const STAGE_PANELS: &[Panel] = &[
    Panel {
        title: "Output voltage",
        unit: "V",
        lines: &[
            line("averaged_v", "averaged", Reference),
            line("output_v", "switched", Simulated),
        ],
    },
    Panel {
        title: "Current of the coil",
        unit: "A",
        lines: &[line("averaged_a", "averaged", Reference), line("coil_a", "switched", Simulated)],
    },
];

const MOTOR_PANELS: &[Panel] = &[
    Panel {
        title: "Speed",
        unit: "rad/s",
        lines: &[
            line("averaged_rad_s", "averaged", Reference),
            line("speed_rad_s", "switched", Simulated),
        ],
    },
    Panel {
        title: "Current, mean of a switching period",
        unit: "A",
        lines: &[
            line("averaged_a", "averaged", Reference),
            line("current_a", "switched", Simulated),
        ],
    },
];

fn of_case(
    case: usize,
    run: impl FnOnce(&mut Checks) -> anyhow::Result<()>,
) -> anyhow::Result<Vec<Check>> {
    checks(CASES[case].name, run)
}

/// The start of a converter; it goes on for 30 ms, until it is steady.
fn stepped(case: usize, of: &Stage) -> anyhow::Result<(Vec<Check>, Record)> {
    const KEPT_S: f64 = 0.01;
    let mut record = Record::new(STAGE_PANELS);
    let figures = of_case(case, |checks| {
        stage(of, checks, |time_s, row| {
            if time_s <= KEPT_S {
                record.keep(time_s, row);
            }
        })
    })?;
    Ok((figures, record))
}
