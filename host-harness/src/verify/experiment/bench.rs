//! The converter bench.

use super::Role::{Reference, Simulated};
use super::{Experiment, Panel, Record, checks, line};
use crate::verify::Check;
use crate::verify::bench::{CASES, Energy, STEPS_PER_S, Seen, Wave, bench};

pub(super) const BENCH: Experiment = Experiment {
    name: "converter-bench",
    title: "a motor behind a converter follows a square wave and a sine",
    source: "EPowertrain2025, section 5.2.3, figures 5.5 to 5.7",
    run,
};

const PANELS: &[Panel] = &[
    Panel {
        title: "Speed, square wave",
        unit: "rad/s",
        lines: &[
            line("square_reference_rad_s", "reference", Reference),
            line("square_speed_rad_s", "simulated", Simulated),
        ],
    },
    Panel {
        title: "Speed, sine",
        unit: "rad/s",
        lines: &[
            line("sine_reference_rad_s", "reference", Reference),
            line("sine_speed_rad_s", "simulated", Simulated),
        ],
    },
    Panel {
        title: "Duty",
        unit: "",
        lines: &[
            line("square_duty", "square wave", Simulated),
            line("sine_duty", "sine", Simulated),
        ],
    },
    Panel {
        title: "Winding current",
        unit: "A",
        lines: &[
            line("square_current_a", "square wave", Simulated),
            line("sine_current_a", "sine", Simulated),
        ],
    },
    Panel {
        title: "Energy out of the supply",
        unit: "kJ",
        lines: &[
            line("square_supply_kj", "square wave", Simulated),
            line("sine_supply_kj", "sine", Simulated),
        ],
    },
    Panel {
        title: "Energy that the balance does not explain",
        unit: "J",
        lines: &[
            line("square_residual_j", "square wave", Simulated),
            line("sine_residual_j", "sine", Simulated),
        ],
    },
];

/// Steps from one kept row to the next: 10 ms.
const PER_ROW: u32 = 100;

fn run() -> anyhow::Result<(Vec<Check>, Record)> {
    let mut record = Record::new(PANELS);
    record.energy_unit = "kJ";
    let (mut found, mut traces) = (Vec::new(), Vec::new());
    let waves = [(Wave::Square, "square wave"), (Wave::Sine, "sine")];
    for (case, (wave, name)) in CASES.iter().zip(waves) {
        let (mut trace, mut energy) = (Vec::new(), Energy::default());
        found.extend(checks(case.name, |checks| {
            bench(checks, wave, |number, seen| {
                if number % PER_ROW == 0 {
                    trace.push((f64::from(number) / f64::from(STEPS_PER_S), row(seen)));
                }
                energy = seen.energy;
            })
        })?);
        traces.push(trace);
        for (term, joules) in [
            ("supply", energy.supply),
            ("copper", energy.copper),
            ("friction", energy.friction),
            ("made by Kt > Ke", -energy.conversion),
        ] {
            record.energy.push((format!("{name}: {term}"), joules / 1000.0));
        }
    }
    for ((time_s, square), (_, sine)) in traces[0].iter().zip(&traces[1]) {
        let mut all = [0.0; 12];
        for (n, (a, b)) in square.iter().zip(sine).enumerate() {
            // Reference and speed of a wave share a panel, all else is one panel for both.
            let (x, y) = if n < 2 { (n, n + 2) } else { (2 * n, 2 * n + 1) };
            (all[x], all[y]) = (*a, *b);
        }
        record.keep(*time_s, all);
    }
    Ok((found, record))
}

fn row(seen: &Seen) -> [f64; 6] {
    let Seen { reference, speed_rad_s, duty, current_a, energy } = seen;
    [*reference, *speed_rad_s, *duty, *current_a, energy.supply / 1000.0, seen.residual()]
}
