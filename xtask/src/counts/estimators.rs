//! What the estimators of `voltstep-bms` cost, and a published filter beside them.

use std::fmt::Write;

use anyhow::{Result, ensure};

use super::{Cost, Measured};
use crate::firmware;
use crate::qemu::line;

/// The item, what its row says, and the most instructions that a step of it may take.
const ROWS: &[(&str, &str, f64)] = &[
    ("ekf_update", "Kalman filter: two states, RC2 model, each sample", 120.0),
    ("ekf_refresh", "Kalman filter: once a second (temperature, load, model error)", 1500.0),
    ("counter_step", "coulomb counter: each sample", 22.0),
    ("counter_review", "coulomb counter: once a second", 500.0),
    ("cells", "state of charge of each of 18 cells", 1600.0),
    ("kalman", "`minikalman` {minikalman}: the same two states and model, each sample", f64::MAX),
];
/// Our filter takes less than this share of what the published one takes.
const OF_PUBLISHED: f64 = 0.5;
/// How far either may be from the truth at the end, to have done the job.
const FOUND: f64 = 0.03;

pub fn table(measured: &Measured) -> Result<String> {
    let mut text = String::from(
        "\n| One step of | mean | least | most | flash | state | stack |\n|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for (item, about, most) in ROWS {
        let c: Cost = measured.cost(item)?;
        ensure!(c.mean <= *most, "`{item}` takes {} instructions, not {most}", c.mean);
        let about = about.replace("{minikalman}", &firmware::version("minikalman")?);
        let _ = writeln!(
            text,
            "| {about} | {:.1} | {} | {} | {} | {} | {} |",
            c.mean, c.min, c.max, c.flash, c.state, c.stack
        );
    }
    let share = measured.cost("ekf_update")?.mean / measured.cost("kalman")?.mean;
    ensure!(share < OF_PUBLISHED, "our filter takes {share:.2} of the published one");
    for filter in ["ekf", "kalman"] {
        let error: f64 = line(&measured.said, &format!("error {filter}"))?.parse()?;
        ensure!(error <= FOUND, "`{filter}` ends {error} away from the truth");
    }
    let _ = write!(
        text,
        "\nInstructions as above, over UDDS at 10 Hz from a state of charge that is 10 % wrong; the \
         battery is the map of a Panasonic NCR18650PF. The most of the filter's update is that of \
         a large correction, which it makes along the bent curve. Ours takes {share:.2} of what \
         `minikalman` takes; that predicts its covariance at each sample, ours once a second, and \
         looks for no missing sample.\n"
    );
    Ok(text)
}
