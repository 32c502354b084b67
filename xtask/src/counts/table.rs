//! The tables, and where they are published.

use std::fmt::Write;

use anyhow::{Result, ensure};

use super::Cost;
use crate::documents;
use crate::firmware::TARGET;

const BEGIN: &str = "<!-- counts:begin -->";
const END: &str = "<!-- counts:end -->";

/// Clocks for which the time of a step is estimated \[MHz\], and the loops it is a share of \[kHz\].
const CLOCKS: [f64; 3] = [48.0, 100.0, 168.0];
/// Cycles per instruction, assumed: loads and branches take 2, divisions 14, the rest 1.
const CYCLES_PER_INSTRUCTION: f64 = 1.5;
/// The shares shown: a loop of 1 kHz at the slowest clock, one of 10 kHz at the second.
const LOOPS: [(f64, f64); 2] = [(1.0, 48.0), (10.0, 100.0)];
/// The largest share of the first that the items below may take.
const LARGEST_SHARE: f64 = 0.1;

pub fn table(rows: &[(&str, Cost)]) -> String {
    let mut text = String::from(
        "| One step of | mean | least | most | flash | state | stack |\n\
         |---|--:|--:|--:|--:|--:|--:|\n",
    );
    for (about, c) in rows {
        let _ = writeln!(
            text,
            "| {about} | {:.1} | {} | {} | {} | {} | {} |",
            c.mean, c.min, c.max, c.flash, c.state, c.stack
        );
    }
    let _ = write!(
        text,
        "\nInstructions per step on a Cortex-M4F (`{TARGET}`, opt-level 3), counted exactly in \
         QEMU at every step of UDDS at 1 kHz, from the first of the function to its return; flash, state and \
         stack in bytes. The plants' stack is the most over UDDS and a run through every battery limit, an \
         empty and a full battery, standstill, plug braking and refused inputs. QEMU counts instructions, not cycles: a load takes more than \
         one, a division 14. Made by `cargo xtask counts`.\n"
    );
    text
}

/// Puts the table between its markers, in the documents that have them.
pub fn publish(table: &str) -> Result<()> {
    let mut places = 0;
    for document in documents::all()? {
        if let Some(text) = between_markers(&document.text, table) {
            document.replace(&text)?;
            places += 1;
        }
    }
    ensure!(places > 0, "no document has a place for the table: {BEGIN}");
    Ok(())
}

fn between_markers(text: &str, table: &str) -> Option<String> {
    let start = text.find(BEGIN)? + BEGIN.len();
    let end = start + text[start..].find(END)?;
    Some(format!("{}\n{table}{}", &text[..start], &text[end..]))
}

/// The share of a loop of 1 kHz at the slowest clock that so many instructions take, estimated.
pub fn share_of_1_khz(instructions: f64) -> f64 {
    let (khz, mhz) = LOOPS[0];
    share(instructions, khz, mhz)
}

fn share(instructions: f64, khz: f64, mhz: f64) -> f64 {
    instructions * CYCLES_PER_INSTRUCTION / mhz * khz * 1e-3
}

/// How long the step of an item takes, as an estimate.
pub fn times(rows: &[(&str, Cost)]) -> Result<String> {
    let mut text = String::from("\n| Estimated time of one step |");
    for mhz in CLOCKS {
        let _ = write!(text, " {mhz} MHz |");
    }
    for (khz, mhz) in LOOPS {
        let _ = write!(text, " of {khz} kHz at {mhz} MHz |");
    }
    let _ = writeln!(text, "\n|---|{}", "--:|".repeat(CLOCKS.len() + LOOPS.len()));
    for (about, cost) in rows {
        let _ = write!(text, "| {about} |");
        for mhz in CLOCKS {
            let _ = write!(text, " {:.1} µs |", cost.mean * CYCLES_PER_INSTRUCTION / mhz);
        }
        for (i, (khz, mhz)) in LOOPS.into_iter().enumerate() {
            let share = share(cost.mean, khz, mhz);
            ensure!(i > 0 || share <= LARGEST_SHARE, "{about} takes {share:.3} of the loop");
            let _ = write!(text, " {:.1} % |", 100.0 * share);
        }
        text.push('\n');
    }
    let _ = write!(
        text,
        "\nAn estimate, not a measurement: the mean count above times {CYCLES_PER_INSTRUCTION} \
         cycles per instruction, an assumption that flash wait states can spoil.\n"
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COST: Cost = Cost { min: 90, mean: 100.0, max: 110, flash: 1000, state: 16, stack: 40 };

    #[test]
    fn the_table_lands_between_its_markers_twice_the_same() {
        let page = format!("before\n{BEGIN}\nold\n{END}\nafter\n");
        let new = table(&[("battery", COST)]);
        assert!(new.contains("| battery | 100.0 | 90 | 110 | 1000 | 16 | 40 |"));
        let once = between_markers(&page, &new).unwrap();
        assert_eq!(between_markers(&once, &new).unwrap(), once);
        assert!(once.starts_with("before\n") && once.ends_with("after\n"));
        assert!(between_markers("no markers", &new).is_none());
    }

    #[test]
    fn times_are_estimated_and_held_against_the_loop() {
        let text = times(&[("battery", COST)]).unwrap();
        assert!(text.contains("| battery | 3.1 µs | 1.5 µs | 0.9 µs | 0.3 % | 1.5 % |"), "{text}");
        assert!(times(&[("slow", Cost { mean: 3300.0, ..COST })]).is_err());
    }
}
