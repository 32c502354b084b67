//! What the estimators of `voltstep-bms` cost, and a published filter beside them.

use std::fmt::Write;

use anyhow::{Result, ensure};

use super::measure::M4F;
use super::{Cost, Measured};
use crate::firmware;
use crate::qemu::line;

/// What a step may take at most.
#[derive(Clone, Copy)]
enum Most {
    /// In the mean.
    Mean(f64),
    /// Ever: what runs beside other things must not hold them up.
    Ever(u64),
    /// It is work for several calls, each of them a row of its own.
    Whole,
}
use Most::{Ever, Mean, Whole};

/// The most instructions that a slice of what is done once a second may take. Chosen: 1 ms of a
/// Cortex-M4F at 48 MHz, of which one comes each millisecond.
const SLICE: Most = Ever(30_000);

/// The item, what its row says, and the most that it may take.
const ROWS: &[(&str, &str, Most)] = &[
    ("ekf_update", "Kalman filter: two states, RC2 model, each sample", Mean(120.0)),
    ("ekf_refresh", "Kalman filter: once a second (temperature, load, model error)", Mean(1500.0)),
    ("counter_step", "coulomb counter: each sample", Mean(22.0)),
    ("counter_review", "coulomb counter: once a second", Mean(500.0)),
    ("cells", "state of charge of each of 18 cells", Mean(1600.0)),
    ("resistance", "resistance: each sample", Whole),
    ("capacity", "capacity: each pair of rests", SLICE),
    ("energy_step", "energy left: each sample", Whole),
    ("energy_walk", "energy left: one of five slices", SLICE),
    ("energy_report", "energy left: all five at once", Whole),
    ("power_walk", "state of power: a horizon and direction", SLICE),
    ("power_ahead", "state of power: all six at once", Whole),
    ("power_cells_walk", "state of power of 96 cells: one of eighteen slices", SLICE),
    ("power_cells", "state of power of 96 cells: all eighteen at once", Whole),
    ("cell_resistances", "resistance of each of 96 cells: each sample", SLICE),
    ("series", "96 cells in series, all tied: each sample; the most once a second", SLICE),
    ("bms", "the whole BMS of 18 cells: a tick, a report, a record", Whole),
    ("bms_fast", "the whole BMS of 18 cells: every millisecond", Mean(1500.0)),
    ("bms_filter", "the same: ten times a second", Whole),
    ("bms_slow", "the same: a slice", SLICE),
    ("bms_fast_96", "the whole BMS of 96 cells: every millisecond", Mean(6000.0)),
    ("bms_filter_96", "the same: ten times a second", Whole),
    ("bms_slow_96", "the same: a slice", SLICE),
    ("kalman", "`minikalman` {minikalman}: the same two states and model, each sample", Whole),
];
/// The whole BMS of 18 cells at opt-level s, and the most that it may take in bytes: flash, RAM, stack.
const WHOLE: (&str, [u64; 3]) = ("bms", [64 * 1024, 8 * 1024, 4 * 1024]);
/// Our filter takes less than this share of what the published one takes.
const OF_PUBLISHED: f64 = 0.5;
/// How far either may be from the truth at the end, to have done the job.
const FOUND: f64 = 0.03;
/// How far the resistance may be from that of the battery at the end, as a ratio.
const RESISTANCE_FOUND: f64 = 0.03;

pub fn table(measured: &Measured) -> Result<String> {
    let mut text = String::from(
        "\n| One step of | mean | least | most | flash | state | stack |\n|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for (item, about, most) in ROWS {
        let c: Cost = measured.cost(item)?;
        within(item, c, *most)?;
        let about = about.replace("{minikalman}", &firmware::version("minikalman")?);
        let _ = writeln!(
            text,
            "| {about} | {:.1} | {} | {} | {} | {} | {} |",
            c.mean, c.min, c.max, c.flash, c.state, c.stack
        );
    }
    let (whole, most) = WHOLE;
    let cost = measured.cost(whole)?;
    let takes = [M4F.flash_at_s(whole)?, cost.state, cost.stack];
    ensure!(
        takes.iter().zip(most).all(|(takes, most)| *takes <= most),
        "`{whole}` takes {takes:?}"
    );
    let share = measured.cost("ekf_update")?.mean / measured.cost("kalman")?.mean;
    ensure!(share < OF_PUBLISHED, "our filter takes {share:.2} of the published one");
    for (estimator, found) in [("ekf", FOUND), ("kalman", FOUND), ("resistance", RESISTANCE_FOUND)]
    {
        let error: f64 = line(&measured.said, &format!("error {estimator}"))?.parse()?;
        ensure!(error <= found, "`{estimator}` ends {error} away from the truth");
    }
    let _ = write!(
        text,
        "\nInstructions as above, over UDDS at 10 Hz from a state of charge that is 10 % wrong; the \
         battery is the map of a Panasonic NCR18650PF. Energy left and state of power once a second, and from \
         nearly empty to nearly full, −25 to 44 °C, new and aged, polarised either way; no slice of them \
         may take more than 30 000. The most of the filter's update is that of \
         a large correction, which it makes along the bent curve. Ours takes {share:.2} of what \
         `minikalman` takes; that predicts its covariance at each sample, ours once a second, and \
         looks for no missing sample.\n\
         \nThe whole BMS of 18 cells takes {} bytes of flash at opt-level s, {} of RAM and {} of stack. It \
         drives a pack for 12 s; its calls include what its board copies.\n",
        takes[0], takes[1], takes[2]
    );
    Ok(text)
}

/// Fails where an item takes more than it may.
fn within(item: &str, cost: Cost, most: Most) -> Result<()> {
    match most {
        Mean(most) => {
            ensure!(cost.mean <= most, "`{item}` takes {} instructions, not {most}", cost.mean);
        }
        Ever(most) => {
            ensure!(cost.max <= most, "`{item}` takes up to {} instructions, not {most}", cost.max);
        }
        Whole => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_more_than_it_may_is_named() {
        let cost = Cost { min: 90, mean: 100.0, max: 110, flash: 1000, state: 16, stack: 40 };
        for good in [Mean(100.0), Ever(110), Whole] {
            assert!(within("cells", cost, good).is_ok());
        }
        for bad in [Mean(99.9), Ever(109)] {
            let said = within("cells", cost, bad).unwrap_err().to_string();
            assert!(said.contains("`cells` takes"), "{said}");
        }
    }
}
