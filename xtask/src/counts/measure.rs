//! Counting in QEMU: the items of an image, one after the other.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use anyhow::{Context, Result, ensure};

use super::{Cost, Measured, missing};
use crate::counted::{parse_counts, section_bytes};
use crate::firmware;
use crate::qemu::{self, line};
use crate::shell::{output, program, run};

/// An empty function: `push`, `mov`, `pop`. The target keeps frame pointers.
const NOTHING: (&str, u64) = ("nothing", 3);

/// The crate of the items.
const PACKAGE: &str = "voltstep-bench";
/// The names of the counted functions begin with this.
const PREFIX: &str = "bench_";

/// So do those of steps in which a limit acts.
const LIMITED: &str = "limited_";

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
pub const M4F: Machine =
    Machine { target: firmware::TARGET, binary: "voltstep-bench", qemu: qemu::MPS2_AN386 };

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
        let log_to = [OsStr::new("-d"), OsStr::new("plugin"), OsStr::new("-D"), log.as_os_str()];
        let plugin = [OsStr::new("-plugin"), OsStr::new(&argument)];
        // The images of the single items are built while the one of all runs.
        let (said, flash) = thread::scope(|scope| {
            let run = scope.spawn(|| qemu::run(self.qemu, &elf, &[&log_to[..], &plugin].concat()));
            let flash = self.flash_of(functions(&nm).into_iter().map(|(name, _)| name));
            (run.join().expect("a run that panics is a bug here"), flash)
        });
        let (said, flash) = (said?, flash?);
        let counted = fs::read_to_string(&log).context("the plugin wrote no log")?;
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
            let flash = *flash.get(&name).with_context(|| missing(&name))?;
            costs.insert(name, Cost { min, mean, max, flash, state, stack });
        }
        for (name, plant, (min, mean, max)) in limited {
            let same = *costs.get(&plant).with_context(|| missing(&plant))?;
            costs.insert(name, Cost { min, mean, max, ..same });
        }
        Ok(Measured { costs, said })
    }

    /// Bytes of flash that an item takes at opt-level s.
    pub fn flash_at_s(&self, item: &str) -> Result<u64> {
        let size = [("CARGO_PROFILE_RELEASE_OPT_LEVEL", "s")];
        let item = format!("{PREFIX}{item}");
        Ok(self.flash_with(&item, &size)? - self.flash_with("none", &size)?)
    }

    /// Bytes of flash that each item takes.
    fn flash_of<'a>(&self, items: impl Iterator<Item = &'a str>) -> Result<BTreeMap<String, u64>> {
        let empty = self.flash_with("none", &[])?;
        items
            .filter(|name| *name != NOTHING.0 && !name.starts_with(LIMITED))
            .map(|name| {
                let flash = self.flash_with(&format!("{PREFIX}{name}"), &[])? - empty;
                ensure!(flash > 0, "`{name}` is not in the image of `flash.rs`");
                Ok((String::from(name), flash))
            })
            .collect()
    }

    /// Bytes of flash of an image with one item in it.
    fn flash_with(&self, item: &str, env: &[(&str, &str)]) -> Result<u64> {
        let args = ["-p", PACKAGE, "--bin", "flash", "--target", self.target];
        firmware::build(&args, &[&[("VOLTSTEP_ITEM", item)], env].concat())?;
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

/// Bytes of state and stack of an item, from what the image says.
pub fn parse_item(said: &str, name: &str) -> Option<(u64, u64)> {
    let (state, stack) = line(said, &format!("item {name}")).ok()?.split_once(' ')?;
    Some((state.parse().ok()?, stack.trim().parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_and_functions_are_read() {
        assert_eq!(parse_item("item battery 16 8\n", "battery"), Some((16, 8)));
        assert_eq!(parse_item("item battery2 16 8\n", "battery"), None);
        let nm = "00004711 T bench_battery\n00000400 t other\n         U hole\n";
        assert_eq!(functions(nm), [("battery", String::from("0x00004711"))]);
    }
}
