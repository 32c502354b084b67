//! The same plant in hand-written C, counted in the same way: what the library costs beside it.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use crate::capi::{self, CORTEX_M4F, STARTUP, WARNINGS};
use crate::counted::{Counted, parse_counts, section_bytes};
use crate::firmware::TARGET;
use crate::qemu::{self, MPS2_AN386};
use crate::shell::{output, program, run};

const FOLDER: &str = "firmware-example/compare";
const SOURCES: &[&str] = &["main", "semi_implicit", "euler"];

/// What is counted: the function, and what its row says.
const STEPS: &[(&str, &str)] = &[
    ("semi_implicit_step", "plain C, semi-implicit, without gates and asked limits"),
    ("euler_step", "plain C, explicit Euler"),
    ("voltstep_step", "Voltstep through its C interface, every kind of plant built in"),
];
const SEMI: &str = STEPS[0].0;
const EULER: &str = STEPS[1].0;
const API: &str = STEPS[2].0;
/// What a step through it may take in the mean, parameters read from memory and pointers checked:
/// what it took when the interface had this one kind of plant, and 1 % more.
const API_AT_MOST: f64 = 560.0;
/// The flash that a step through it may take where only plants with one DC drive are built in \[bytes\].
const ONE_DC_FLASH: u64 = 16 * 1024;
/// An empty function: `bx lr`.
const NOTHING: &str = "nothing";

/// How far the semi-implicit C may be from the library: its largest difference over UDDS, relative
/// to what the quantity comes to \[parts per billion\].
const AGREES_PPB: u64 = 10_000;
/// The same of the current. The loop of this vehicle rings: rounding in another order shifts the phase,
/// by which the currents part up to here while state of charge and speed agree to 2e-7.
const CURRENT_PPB: u64 = 500_000;
/// What the library may take, in instructions of the semi-implicit C: that has no gates to open, no
/// limits asked for from outside, no winding limit, and does not look ahead at a field that grows.
const AT_MOST: f64 = 1.15;
/// Explicit Euler counts as stable where its speed stays this close \[parts per billion\].
const STABLE_PPB: u64 = 10_000_000;
/// Steps per millisecond that are tried for it.
const EULER_STEPS: std::ops::RangeInclusive<u64> = 1..=20;
/// Steps per second of the others.
const STEPS_PER_S: f64 = 1000.0;

/// How the compiler may treat `a·b + c`.
const CONTRACTIONS: &[(&str, &str)] = &[("off", ""), ("fast", ", fused multiply-add")];

/// The table; `ours` is the library's mean in Rust, with its flash and state.
pub fn table(ours: (f64, u64, u64), plugin: &Path) -> Result<String> {
    let folder = capi::folder()?;
    let (euler_steps, euler_soc) = stable(&folder)?;
    let mut text = String::from(
        "\n| The coupled plant + PID driver (`epowertrain-udds`) | mean | least | most | \
         per simulated second | times ours | flash | state |\n|---|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let (mean, flash, state) = ours;
    let per_s = mean * STEPS_PER_S;
    let _ = writeln!(
        text,
        "| Voltstep in Rust | {mean:.1} | | | {per_s:.0} | 1.00 | {flash} | {state} |"
    );
    let small = capi::library(Some(TARGET), capi::Kinds::OneDc)?;
    let small = Built::new(&folder, &small, "off", euler_steps)?;
    let (counted, said) = small.count(plugin)?;
    let (min, mean_c, max) = of(&counted, API)?;
    let flash = small.flash(API)?;
    ensure!(flash <= ONE_DC_FLASH, "through C one DC drive takes {flash} bytes of flash");
    let c_per_s = mean_c * STEPS_PER_S;
    let _ = writeln!(
        text,
        "| the same through its C interface, one DC drive built in, parameters not known to the compiler | \
         {mean_c:.1} | {min} | {max} | {c_per_s:.0} | {:.2} | {flash} | {} |",
        c_per_s / per_s,
        value(&said, &format!("state {API}"))?
    );
    let library = capi::library(Some(TARGET), capi::Kinds::All)?;
    for (contraction, note) in CONTRACTIONS {
        let built = Built::new(&folder, &library, contraction, euler_steps)?;
        let (counted, said) = built.count(plugin)?;
        if contraction == &"off" {
            agrees(&said)?;
        }
        for (name, about) in STEPS {
            let (min, c_mean, max) = of(&counted, name)?;
            if *name == API && contraction != &"off" {
                continue; // not compiled by this compiler
            }
            let own = if *name == EULER { euler_steps } else { 1 };
            #[expect(clippy::cast_precision_loss, reason = "at most 20")]
            let c_per_s = c_mean * STEPS_PER_S * own as f64;
            let at = if *name == EULER {
                format!(" at its largest stable step, 1/{euler_steps} ms")
            } else {
                String::new()
            };
            let _ = writeln!(
                text,
                "| {about}{at}{note} | {c_mean:.1} | {min} | {max} | {c_per_s:.0} | {:.2} | {} | {} |",
                c_per_s / per_s,
                built.flash(name)?,
                value(&said, &format!("state {name}"))?
            );
            if *name == API {
                ensure!(c_mean <= API_AT_MOST, "a step through C takes {c_mean:.1} instructions");
            }
            if *name == SEMI && contraction == &"off" {
                ensure!(
                    mean <= AT_MOST * c_mean,
                    "{mean} instructions, hand-written C takes {c_mean}"
                );
            }
        }
    }
    let _ = write!(
        text,
        "\nC by `arm-none-eabi-gcc -O3 -mcpu=cortex-m4`, without fused multiply-add unless noted \
         (with it the bits differ from those of a PC), counted in the same run over UDDS \
         (`{FOLDER}`). The semi-implicit C agrees with Voltstep to {} parts per billion in \
         every step. Explicit Euler needs {euler_steps} steps per millisecond or diverges, even with \
         the battery's RC branch and the controller's smoothing taken as settled (as they are \
         they would need 2 ns); its state of charge is then up to {:.4} off, for want of compensated \
         sums.\n",
        agreement(&said_here(&folder, euler_steps)?)?,
        ppb(euler_soc)
    );
    Ok(text)
}

/// What was counted of a step.
fn of(counted: &[(String, Counted)], name: &str) -> Result<Counted> {
    let found = counted.iter().find(|(counted, _)| counted == name);
    found.map(|(_, count)| *count).with_context(|| format!("`{name}` was not counted"))
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
fn ppb(parts: u64) -> f64 {
    parts as f64 * 1e-9
}

/// The number after a name in what the program said.
fn value(said: &str, name: &str) -> Result<u64> {
    qemu::line(said, name)?.trim().parse().context("no number")
}

/// The largest difference of the semi-implicit C from the library, but for the current.
fn agreement(said: &str) -> Result<u64> {
    let mut most = 0;
    for quantity in ["soc", "speed", "battery_v"] {
        most = most.max(value(said, &format!("semi {quantity}"))?);
    }
    Ok(most)
}

fn agrees(said: &str) -> Result<()> {
    let most = agreement(said)?;
    ensure!(most <= AGREES_PPB, "the semi-implicit C is {most} ppb away from the library");
    let current = value(said, "semi current")?;
    ensure!(current <= CURRENT_PPB, "its current is {current} ppb away from the library's");
    Ok(())
}

/// The fewest steps per millisecond at which explicit Euler is stable, and the largest error of its
/// state of charge there, found on this machine.
fn stable(folder: &Path) -> Result<(u64, u64)> {
    for steps in EULER_STEPS {
        let said = said_here(folder, steps)?;
        agrees(&said)?;
        if value(&said, "euler speed")? <= STABLE_PPB {
            return Ok((steps, value(&said, "euler soc")?));
        }
    }
    bail!("explicit Euler is not stable at any of {EULER_STEPS:?} steps per millisecond")
}

/// What the program says on this machine.
fn said_here(folder: &Path, euler_steps: u64) -> Result<String> {
    let binary = folder.join(format!("compare-{euler_steps}"));
    run(program("cc")
        .args(WARNINGS)
        .args(["-O2", "-ffp-contract=off", "-Icapi/include", "-Icapi/example", "-I"])
        .arg(folder)
        .arg(format!("-DEULER_STEPS={euler_steps}"))
        .args(SOURCES.iter().map(|source| format!("{FOLDER}/{source}.c")))
        .arg(capi::HERE)
        .arg(capi::library(None, capi::Kinds::All)?)
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&binary))?;
    output(&mut program(&binary.to_string_lossy()))
}

/// The program for the target.
struct Built {
    elf: PathBuf,
    objects: Vec<PathBuf>,
    library: PathBuf,
}

impl Built {
    fn new(folder: &Path, library: &Path, contraction: &str, euler_steps: u64) -> Result<Self> {
        let mut objects = Vec::new();
        for source in SOURCES {
            let object = folder.join(format!("{source}-{contraction}.o"));
            run(program("arm-none-eabi-gcc")
                .args(WARNINGS)
                .args(CORTEX_M4F)
                .args(["-O3", "-fno-math-errno", "-ffunction-sections", "-c"])
                .arg(format!("-ffp-contract={contraction}"))
                .arg(format!("-DEULER_STEPS={euler_steps}"))
                .args(["-Icapi/include", "-Icapi/example", "-I"])
                .arg(folder)
                .args([format!("{FOLDER}/{source}.c"), String::from("-o")])
                .arg(&object))?;
            objects.push(object);
        }
        let elf = folder.join(format!("compare-{contraction}.elf"));
        let built = Self { elf, objects, library: library.to_owned() };
        built.link(&built.elf, &[STARTUP])?;
        Ok(built)
    }

    fn link(&self, elf: &Path, more: &[&str]) -> Result<()> {
        run(program("arm-none-eabi-gcc")
            .args(CORTEX_M4F)
            .args(["-O3", "-nostdlib", "-Wl,--gc-sections", "-Wl,-z,noexecstack"])
            .args(more)
            .args(&self.objects)
            .arg(&self.library)
            .args(["-lgcc", "-T", capi::MAP, "-o"])
            .arg(elf))
    }

    /// Instructions per call of each step, and what the program said.
    fn count(&self, plugin: &Path) -> Result<(Vec<(String, Counted)>, String)> {
        let nm = output(program("arm-none-eabi-nm").arg(&self.elf))?;
        let mut argument = plugin.display().to_string();
        for name in STEPS.iter().map(|(name, _)| *name).chain([NOTHING]) {
            let line = nm.lines().find(|line| line.split(' ').nth(2) == Some(name));
            let address = line.and_then(|line| line.split(' ').next());
            let address = address.with_context(|| format!("the image has no `{name}`"))?;
            let _ = write!(argument, ",item={name}@0x{address}");
        }
        let log = self.elf.with_extension("counts");
        let (d, file) = (String::from("-D"), log.display().to_string());
        let more = ["-d".into(), "plugin".into(), d, file, "-plugin".into(), argument];
        let said = qemu::run(MPS2_AN386, &self.elf, &more)?;
        let counted = parse_counts(&fs::read_to_string(&log).context("the plugin wrote no log")?)?;
        let nothing = counted.iter().find(|(name, _)| name == NOTHING);
        ensure!(
            nothing.is_some_and(|(_, (min, _, max))| (*min, *max) == (1, 1)),
            "an empty function counts {nothing:?}"
        );
        Ok((counted, said))
    }

    /// Bytes of flash of one step and all that it calls.
    fn flash(&self, name: &str) -> Result<u64> {
        let elf = self.elf.with_extension("one");
        self.link(&elf, &[&format!("-Wl,-e,{name}")])?;
        let sizes = output(program("arm-none-eabi-size").arg("-A").arg(&elf))?;
        section_bytes(&sizes, &[".text", ".rodata", ".data"])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAID: &str = "semi soc 3\nsemi speed 0\nsemi battery_v 12\nsemi current 1\neuler soc 7\n";

    #[test]
    fn numbers_are_found_by_their_names() {
        assert_eq!((value(SAID, "euler soc").unwrap(), agreement(SAID).unwrap()), (7, 12));
        assert!(value(SAID, "euler speed").is_err() && value(SAID, "euler").is_err());
    }

    #[test]
    fn a_c_plant_that_does_other_work_is_noticed() {
        assert!(agrees(SAID).is_ok());
        assert!(agrees(&SAID.replace("semi speed 0", "semi speed 10001")).is_err());
    }
}
