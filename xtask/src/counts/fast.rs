//! What `num::fast` saves, and what it costs in error.

use std::fmt::Write;

use anyhow::{Result, bail};

use super::Measured;
use crate::qemu::line;

const FUNCTIONS: [&str; 2] = ["sqrt", "exp"];

pub fn table(on_m4f: &Measured, on_m0: &Measured) -> Result<String> {
    let mut text = String::from(
        "\n| `num::fast` beside `num` | range | largest error | Cortex-M4F | saved | \
         Cortex-M0+ | saved | flash, Cortex-M4F |\n|---|---|--:|--:|--:|--:|--:|--:|\n",
    );
    for function in FUNCTIONS {
        let words: Vec<_> = line(&on_m4f.said, &format!("error {function}"))?.split(' ').collect();
        let [low, high, error] = words[..] else { bail!("cannot read {words:?}") };
        let (low, high, error): (f64, f64, f64) = (low.parse()?, high.parse()?, error.parse()?);
        let _ = write!(text, "| `{function}` | {low:e} … {high:e} | {:.2} % |", 100.0 * error);
        for measured in [on_m4f, on_m0] {
            let exact = measured.cost(&format!("num_{function}"))?.mean;
            let fast = measured.cost(&format!("fast_{function}"))?.mean;
            let _ = write!(text, " {fast:.1} for {exact:.1} | {:.1} |", exact - fast);
        }
        let exact = on_m4f.cost(&format!("num_{function}"))?.flash;
        let fast = on_m4f.cost(&format!("fast_{function}"))?.flash;
        let _ = writeln!(text, " {fast} for {exact} |");
    }
    text += "\nMean instructions, error relative to the exact function, both evenly over the range. \
             The feature `micromath` only adds these functions, nothing calls them; its documentation \
             says how to decide.\n";
    Ok(text)
}
