//! Published PID controllers beside ours.

use std::fmt::Write;

use anyhow::{Context, Result, ensure};

use super::{Cost, Measured};
use crate::firmware;
use crate::qemu::line;

/// Ours and theirs: the item, what its row says, the item it is compared with, and the one whose
/// behaviour is its own.
const ROWS: &[(&str, &str, &str, &str)] = &[
    ("pi", "Voltstep", "pi", "pi"),
    ("pi_idsp", "`idsp` {idsp}", "pi", "pi_idsp"),
    ("pi_ram", "Voltstep, parameters in RAM", "pi_ram", "pi"),
    ("pi_idsp_ram", "`idsp` {idsp}, coefficients in RAM", "pi_ram", "pi_idsp"),
    ("pi_pid", "`pid` {pid}, parameters in RAM", "pi_ram", "pi_pid"),
];
/// Packages whose versions the rows name.
const PACKAGES: [&str; 2] = ["idsp", "pid"];

/// How far theirs may be from ours over UDDS, in shares of the limit, to have done the same job.
/// Their integral is one step ahead.
const SAME: f64 = 1e-3;

pub fn table(measured: &Measured) -> Result<String> {
    let mut text = String::from(
        "\n| Proportional and integral part within limits | mean | least | most | times ours | \
         flash | RAM | after saturation | after a NaN |\n|---|--:|--:|--:|--:|--:|--:|--:|---|\n",
    );
    for (item, about, beside, behaves_as) in ROWS {
        let (c, ours): (Cost, Cost) = (measured.cost(item)?, measured.cost(beside)?);
        let (after_saturation, finite) = hard(&measured.said, behaves_as)?;
        let mut about = String::from(*about);
        for package in PACKAGES {
            about = about.replace(&format!("{{{package}}}"), &firmware::version(package)?);
        }
        let _ = writeln!(
            text,
            "| {about} | {:.1} | {} | {} | {:.2} | {} | {} | {after_saturation} | {} |",
            c.mean,
            c.min,
            c.max,
            c.mean / ours.mean,
            c.flash,
            c.state,
            if finite { "refused, goes on" } else { "NaN from then on" }
        );
        same_job(&measured.said, behaves_as)?;
    }
    text += "\nThe job: the output of a PI controller held within ±1, at every step of UDDS and 1000 \
             in saturation; one number is kept of what each says. *After saturation*: the output at an \
             error of −0.01 after 10 s at +1; its proportional part is −0.02. Ours stops its \
             integral in saturation, `pid` only bounds it, `idsp` holds the output of its \
             recursion. Only ours looks for NaN and absurd values, sums its integral with \
             compensation and says whether it saturates. Dead zone, smoothed output and saturation \
             further down the loop, which the others do not have, are not part of the job; the row *PID* \
             above has them.\n";
    Ok(text)
}

/// The output after saturation, and whether it is a number after one that was none.
fn hard<'a>(said: &'a str, item: &str) -> Result<(&'a str, bool)> {
    let (output, finite) =
        line(said, &format!("hard {item}"))?.split_once(' ').context("half a hard case")?;
    Ok((output, finite.parse()?))
}

fn same_job(said: &str, item: &str) -> Result<()> {
    let apart: f64 = line(said, &format!("apart {item}"))?.parse()?;
    ensure!(apart <= SAME, "`{item}` is {apart} away from ours: it does another job");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_image_says_is_read() {
        let said = "apart pi_pid 0.0001\nhard pi_pid 0.98 false\n";
        assert_eq!(hard(said, "pi_pid").unwrap(), ("0.98", false));
        assert!(hard(said, "pi").is_err());
        assert!(same_job(said, "pi_pid").is_ok());
        assert!(same_job("apart pi_pid 0.1\n", "pi_pid").is_err());
    }
}
