//! The same items on a Cortex-M0+, which calculates floating point in software.

use std::fmt::Write;

use anyhow::{Context, Result, ensure};

use super::table::share_of_1_khz;
use super::{ITEMS, Measured};
use crate::firmware::{self, SMALL_TARGET};
use crate::qemu::line;

/// What is counted there.
const COUNTED: &[&str] = &[
    "plant_pid_off",
    "plant_pid_on",
    "plant_torque_off",
    "battery",
    "rc_branch",
    "dc_motor",
    "pid",
];
/// The vehicle of the first of them, whose bits are compared.
const VEHICLE: &str = "epowertrain-udds";
/// Their names in the baseline begin with this.
pub const PREFIX: &str = "m0_";

/// The last block of UDDS that was driven, and the hash of all states up to there.
fn block(said: &str) -> Result<(u32, &str)> {
    let (block, hash) = line(said, "block")?.split_once(' ').context("a block without a hash")?;
    Ok((block.parse()?, hash))
}

/// Fails unless every state there was the one here, bit for bit.
pub fn same_bits(said: &str) -> Result<()> {
    compare(said, &firmware::host_trace(VEHICLE, None)?)
}

fn compare(said: &str, here: &str) -> Result<()> {
    let (block, hash) = block(said)?;
    // The plant's hash; that of the estimators, which do not run there, stands behind it.
    let wanted = line(here, &format!("block {block}"))?.split(' ').next().unwrap_or_default();
    ensure!(hash == wanted, "other bits on {SMALL_TARGET}: {hash} there, {wanted} here");
    Ok(())
}

pub fn table(measured: &Measured, on_m4f: &Measured) -> Result<String> {
    let mut text = String::from(
        "\n| One step on a Cortex-M0+, in software floating point | mean | least | most | \
         times a Cortex-M4F | of 1 kHz at 48 MHz | flash | stack |\n\
         |---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    for (name, about) in ITEMS.iter().filter(|(name, _)| COUNTED.contains(name)) {
        let (c, m4f) = (measured.cost(name)?, on_m4f.cost(name)?);
        let _ = writeln!(
            text,
            "| {about} | {:.1} | {} | {} | {:.0} | {:.0} % | {} | {} |",
            c.mean,
            c.min,
            c.max,
            c.mean / m4f.mean,
            100.0 * share_of_1_khz(c.mean),
            c.flash,
            c.stack
        );
    }
    let (block, _) = block(&measured.said)?;
    let _ = write!(
        text,
        "\nCounted as above (`{SMALL_TARGET}`, on QEMU's Cortex-M0, which has the same \
         instructions), but only over the first {} s of UDDS, which hold its highest speed; the \
         share of a loop is an estimate as above, the flash includes the software floating point. \
         The states of the first row are bit for bit those of a PC.\n",
        block + 1
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_block_is_found() {
        assert_eq!(block("item pid 36 104\nblock 339 78ab\n").unwrap(), (339, "78ab"));
        assert!(block("item pid 36 104\n").is_err());
    }

    #[test]
    fn other_bits_are_noticed() {
        let here = "block 338 aaaa\nblock 339 78ab\n";
        assert!(compare("block 339 78ab\n", here).is_ok());
        assert!(compare("block 339 78ac\n", here).unwrap_err().to_string().contains("other bits"));
        assert!(compare("block 340 78ab\n", here).is_err());
    }

    #[test]
    fn each_is_an_item() {
        assert!(COUNTED.iter().all(|name| ITEMS.iter().any(|(item, _)| item == name)));
    }
}
