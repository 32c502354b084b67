//! A three-phase bridge switch by switch.

use super::Role::{Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::verify::Check;
use crate::verify::bridge::{CASES, Drive, WITH_DEAD_TIME, WITH_ONE_OPEN, WITH_ONE_SHORTED, run};

pub(super) const START: Experiment = Experiment {
    name: "bridge-start",
    title: "a three-phase bridge, switch by switch with dead time, starts a synchronous machine",
    source: "EPowertrain2025, PMSM with its defaults; 300 V, 10 kHz and 2 µs chosen here",
    run: || record(1, WITH_DEAD_TIME),
};

pub(super) const OPEN: Experiment = Experiment {
    name: "bridge-open-transistor",
    title: "the same bridge, and from 75 ms on its first transistor does not close",
    source: "EPowertrain2025, PMSM with its defaults; 300 V, 10 kHz and 2 µs chosen here",
    run: || record(2, WITH_ONE_OPEN),
};

pub(super) const SHORTED: Experiment = Experiment {
    name: "bridge-shorted-transistor",
    title: "the same bridge, its first transistor shorted from 75 ms on",
    source: "EPowertrain2025, PMSM with its defaults; 300 V, 10 kHz and 2 µs chosen here",
    run: || record(3, WITH_ONE_SHORTED),
};

const PANELS: &[Panel] = &[
    Panel {
        title: "Speed",
        unit: "rad/s",
        lines: &[
            line("averaged_rad_s", "averaged", Reference),
            line("speed_rad_s", "switched", Simulated),
        ],
    },
    Panel {
        title: "Torque, mean of a switching period",
        unit: "N·m",
        lines: &[
            line("averaged_nm", "averaged", Reference),
            line("torque_nm", "switched", Simulated),
        ],
    },
    Panel {
        title: "Phase currents",
        unit: "A",
        lines: &[
            line("a_a", "a", Simulated),
            line("b_a", "b", Simulated),
            line("c_a", "c", Simulated),
        ],
    },
    Panel {
        title: "Current of the source, mean of a switching period",
        unit: "A",
        lines: &[line("bus_a", "switched", Simulated)],
    },
];

fn record(case: usize, drive: Drive) -> anyhow::Result<(Vec<Check>, Record)> {
    let mut record = Record::new(PANELS);
    run(drive, |period, seen| {
        let [a, b, c] = seen.current_a;
        record.keep(
            1e-4 * f64::from(period + 1),
            [
                seen.averaged_rad_s,
                seen.speed_rad_s,
                seen.averaged_nm,
                seen.torque_nm,
                a,
                b,
                c,
                seen.bus_a,
            ],
        );
    })?;
    Ok((checks(CASES[case].name, CASES[case].run)?, record))
}
