//! Counting in QEMU: the items of an image, one after the other.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use super::{Cost, Measured, missing};
use crate::firmware;
use crate::shell::{output, program, run};

/// An empty function: `push`, `mov`, `pop`. The target keeps frame pointers.
const NOTHING: (&str, u64) = ("nothing", 3);

/// The crate of the items.
const PACKAGE: &str = "voltstep-bench";
/// The names of the counted functions begin with this.
const PREFIX: &str = "bench_";

/// So do those of steps in which a limit acts.
const LIMITED: &str = "limited_";

/// Instructions per call: least, mean, most.
pub type Counted = (u64, f64, u64);

/// A processor on which items are counted.
pub struct Machine {
    /// What it is compiled for.
    target: &'static str,
    /// The program that calls the items.
    binary: &'static str,
    /// QEMU's words for it.
    qemu: &'static [&'static str],
}

/// The processor of the firmware example.
pub const M4F: Machine = Machine {
    target: firmware::TARGET,
    binary: "voltstep-bench",
    qemu: &["-cpu", "cortex-m4", "-machine", "mps2-an386"],
};

/// One without floating point. QEMU has a Cortex-M0, which has the same instructions as the M0+;
/// the machine gets more memory than the real one has, for the painted stacks.
pub const M0: Machine = Machine {
    target: firmware::SMALL_TARGET,
    binary: "small",
    qemu: &["-cpu", "cortex-m0", "-machine", "microbit", "-global", "nrf51-soc.sram-size=4194304"],
};

impl Machine {
    /// Runs the image under the plugin and sizes one image per item.
    pub fn measure(&self) -> Result<Measured> {
        let target = ["--target", self.target];
        firmware::build(&[&["-p", PACKAGE, "--bin", self.binary], &target[..]].concat(), &[])?;
        let elf = firmware::binary_for(self.target, self.binary)?;
        let nm = output(program("arm-none-eabi-nm").arg(&elf))?;
        let log = elf.with_extension("counts");
        let mut argument = plugin(&elf)?.display().to_string();
        for (name, address) in functions(&nm) {
            let _ = write!(argument, ",item={name}@{address}");
        }
        let said = output(
            program("qemu-system-arm")
                .args(self.qemu)
                .args(["-nographic", "-semihosting-config", "enable=on,target=native", "-kernel"])
                .arg(&elf)
                .args(["-d", "plugin", "-D"])
                .arg(&log)
                .args(["-plugin", &argument]),
        )?;
        let counted = fs::read_to_string(&log).context("the plugin wrote no log")?;
        let empty = self.flash("none")?;
        let mut costs: BTreeMap<String, Cost> = BTreeMap::new();
        let mut limited = Vec::new();
        for (name, (min, mean, max)) in parse_counts(&counted)? {
            if name == NOTHING.0 {
                ensure!((min, max) == (NOTHING.1, NOTHING.1), "an empty function: {min}..{max}");
                continue;
            }
            if let Some(plant) = name.strip_prefix(LIMITED) {
                // Another name of a plant: the branch to it is no part of it.
                limited.push((
                    name.clone(),
                    format!("plant_{plant}"),
                    (min - 1, mean - 1.0, max - 1),
                ));
                continue;
            }
            let (state, stack) = parse_item(&said, &name).with_context(|| missing(&name))?;
            let flash = self.flash(&format!("{PREFIX}{name}"))? - empty;
            ensure!(flash > 0, "`{name}` is not in the image of `flash.rs`");
            costs.insert(name, Cost { min, mean, max, flash, state, stack });
        }
        for (name, plant, (min, mean, max)) in limited {
            let same = *costs.get(&plant).with_context(|| missing(&plant))?;
            costs.insert(name, Cost { min, mean, max, ..same });
        }
        Ok(Measured { costs, said })
    }

    /// Bytes of flash of an image with one item in it.
    fn flash(&self, item: &str) -> Result<u64> {
        let args = ["-p", PACKAGE, "--bin", "flash", "--target", self.target];
        firmware::build(&args, &[("VOLTSTEP_ITEM", item)])?;
        let elf = firmware::binary_for(self.target, "flash")?;
        let sizes = output(program("arm-none-eabi-size").arg("-A").arg(elf))?;
        section_bytes(&sizes, &[".text", ".rodata", ".data"])
    }
}

/// Compiles the plugin beside the image.
pub fn plugin(elf: &Path) -> Result<PathBuf> {
    let plugin = elf.with_file_name("count.so");
    run(program("cc")
        .args(["-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&plugin)
        .arg("xtask/qemu/count.c"))?;
    Ok(plugin)
}

/// The counted functions in the output of nm, with their addresses.
fn functions(nm: &str) -> Vec<(&str, String)> {
    nm.lines()
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            let (address, _, symbol) = (words.next()?, words.next()?, words.next()?);
            Some((symbol.strip_prefix(PREFIX)?, format!("0x{address}")))
        })
        .collect()
}

/// Minimum, mean and maximum of each item, from the plugin's log.
pub fn parse_counts(log: &str) -> Result<Vec<(String, Counted)>> {
    log.lines()
        .filter_map(|line| line.strip_prefix("count "))
        .map(|line| {
            let words: Vec<_> = line.split(' ').collect();
            let [name, figures @ ..] = &words[..] else { bail!("cannot read `{line}`") };
            let figures: Vec<u64> =
                figures.iter().map(|word| word.parse()).collect::<Result<_, _>>()?;
            let [calls, sum, min, max, _at] = figures[..] else { bail!("cannot read `{line}`") };
            ensure!(calls > 0, "`{name}` was never called, or is one function with another item");
            #[expect(clippy::cast_precision_loss, reason = "sums stay below 2^53")]
            let mean = sum as f64 / calls as f64;
            // As many places as the table shows, so that baseline and table agree.
            Ok((String::from(*name), (min, (mean * 10.0).round() / 10.0, max)))
        })
        .collect()
}

/// Bytes of state and stack of an item, from what the image says.
pub fn parse_item(said: &str, name: &str) -> Option<(u64, u64)> {
    let line = said.lines().find_map(|line| line.strip_prefix(&format!("item {name} ")))?;
    let (state, stack) = line.split_once(' ')?;
    Some((state.parse().ok()?, stack.trim().parse().ok()?))
}

/// The sum of some sections in the output of `size -A`.
pub fn section_bytes(sizes: &str, sections: &[&str]) -> Result<u64> {
    let mut sum = 0;
    for line in sizes.lines() {
        let mut words = line.split_whitespace();
        if let (Some(section), Some(bytes)) = (words.next(), words.next())
            && sections.contains(&section)
        {
            sum += bytes.parse::<u64>().with_context(|| format!("cannot read `{line}`"))?;
        }
    }
    ensure!(sum > 0, "the image is empty");
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_are_read() {
        let counts = parse_counts("count battery 4 402 100 101 2\nrun 40 7\n").unwrap();
        assert_eq!(counts, [(String::from("battery"), (100, 100.5, 101))]);
        assert!(parse_counts("count battery 0 0 0 0 0").is_err(), "never called");
        assert!(parse_counts("count battery 4").is_err());
        assert_eq!(parse_item("item battery 16 8\n", "battery"), Some((16, 8)));
        assert_eq!(parse_item("item battery2 16 8\n", "battery"), None);
        let nm = "00004711 T bench_battery\n00000400 t other\n         U hole\n";
        assert_eq!(functions(nm), [("battery", String::from("0x00004711"))]);
        let sizes = ".text   100  1024\n.rodata 20 0\n.debug 9999 0\n.data 4 0\nTotal 1\n";
        assert_eq!(section_bytes(sizes, &[".text", ".rodata", ".data"]).unwrap(), 124);
        assert!(section_bytes("", &[".text"]).is_err());
    }
}
