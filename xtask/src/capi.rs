//! The C interface: its header is up to date, and C programs on it give the golden bits of the plant
//! and those of the estimators and the BMS in Rust, on this machine and on a Cortex-M4F in QEMU.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::firmware::{TARGET, root};
use crate::image::is_panic;
use crate::metadata::Metadata;
use crate::qemu::{self, MPS2_AN386};
use crate::shell::{cargo, output, program, run};

const CRATE: &str = "capi";
const PACKAGE: &str = "voltstep-capi";
const LIBRARY: &str = "libvoltstep_capi.a";
const HEADER: &str = "capi/include/voltstep.h";
const GOLDEN: &str = "firmware-example/golden.toml";
/// The vehicles that the example drives. The interface has no battery with a map.
const VEHICLES: &[&str] = &[
    "epowertrain-udds",
    "bmw-i3-60ah-constant",
    "bmw-i3-60ah-pmsm",
    "bmw-i3-60ah-thermal",
    "two-axles",
];
/// How many of them, the first, have one DC drive.
const OF_ONE_DC: usize = 2;
const CYCLE: &str = "data/cycles/udds.csv";
/// The examples, and what goes with them here and on target.
const PLANT: &str = "capi/example/main.c";
const ESTIMATORS: &str = "capi/example/estimators.c";
const BMS: &str = "capi/example/bms.c";
/// Those that are examples in Rust, too, by their names.
const IN_RUST: &[(&str, &str)] = &[("estimators", ESTIMATORS), ("bms", BMS)];
pub const HERE: &str = "capi/example/host.c";
/// Reset and memory map of a C program in QEMU.
pub const STARTUP: &str = "capi/example/mps2.c";
pub const MAP: &str = "capi/example/mps2.ld";

pub const WARNINGS: &[&str] = &["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic"];
/// A fused multiply-add rounds differently where it is not in hardware.
const SAME_BITS: &str = "-ffp-contract=off";
/// The compiler's words for the Cortex-M4F.
pub const CORTEX_M4F: &[&str] =
    &["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"];

/// Header, library, example, here and on target.
pub fn capi() -> Result<()> {
    header()?;
    run(cargo()
        .args(["test", "--quiet", "-p", PACKAGE, "--no-default-features"])
        .args(["--test", "not_built_in"]))?;
    let folder = folder()?;
    let golden = fs::read_to_string(root().join(GOLDEN)).context(GOLDEN)?;
    let small = library(Some(TARGET), Kinds::OneDc)?;
    compare(&on_target(&folder, PLANT, &small)?, &golden, &VEHICLES[..OF_ONE_DC])?;
    let (library_here, library_there) =
        (library(None, Kinds::All)?, library(Some(TARGET), Kinds::All)?);
    for said in [here(&folder, PLANT, &library_here)?, on_target(&folder, PLANT, &library_there)?] {
        compare(&said, &golden, VEHICLES)?;
    }
    for (name, example) in IN_RUST {
        let in_rust = output(cargo().args(["run", "--quiet", "-p", PACKAGE, "--example", name]))?;
        let wanted = said_hash(&in_rust, name)?;
        demand(&here(&folder, example, &library_here)?, wanted)?;
        demand(&on_target(&folder, example, &library_there)?, wanted)?;
    }
    Ok(())
}

/// Makes the header anew; fails where it was not up to date, so that a stale one cannot pass.
fn header() -> Result<()> {
    let path = root().join(CRATE);
    let config = cbindgen::Config::from_file(path.join("cbindgen.toml"))
        .map_err(|error| anyhow::anyhow!("cbindgen.toml: {error}"))?;
    let mut made = Vec::new();
    cbindgen::Builder::new().with_crate(&path).with_config(config).generate()?.write(&mut made);
    let old = fs::read(root().join(HEADER)).unwrap_or_default();
    if made != old {
        fs::write(root().join(HEADER), made).context(HEADER)?;
    }
    let old = String::from_utf8_lossy(&old).into_owned();
    let new = fs::read_to_string(root().join(HEADER)).context(HEADER)?;
    ensure!(new == old, "{HEADER} was out of date; it is brought up to date now: commit it");
    // As a C++ compiler sees it.
    run(program("cc").args(["-x", "c++", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", HEADER]))
}

/// Where C programs are built, with the cycle as a header in it.
pub fn folder() -> Result<PathBuf> {
    let folder = Metadata::load()?.target_directory()?.join("xtask-capi");
    fs::create_dir_all(&folder)?;
    let csv = fs::read_to_string(root().join(CYCLE)).context(CYCLE)?;
    fs::write(folder.join("udds.h"), table(&csv)?)?;
    Ok(folder)
}

/// A cycle as a table in C.
fn table(csv: &str) -> Result<String> {
    let mut text = format!("/* Made from {CYCLE}. */\nstatic const float UDDS[][2] = {{\n");
    for line in csv.lines().skip(1) {
        let (time, speed) =
            line.split_once(',').with_context(|| format!("cannot read `{line}`"))?;
        let (time, speed): (f32, f32) = (time.trim().parse()?, speed.trim().parse()?);
        // The shortest text that reads back as the same bits.
        writeln!(text, "    {{ {time:?}f, {speed:?}f }},")?;
    }
    text.push_str("};\n");
    Ok(text)
}

/// What is built into a library.
#[derive(Clone, Copy, PartialEq)]
pub enum Kinds {
    /// Every feature.
    All,
    /// None: plants with one DC drive.
    OneDc,
}

/// The library built for a target, or for this machine.
pub fn library(target: Option<&str>, kinds: Kinds) -> Result<PathBuf> {
    let mut command = cargo();
    command.args(["build", "--quiet", "--release", "-p", PACKAGE]);
    let folder = Metadata::load()?.target_directory()?;
    let folder = match target {
        Some(target) => {
            command.args(["--target", target]);
            folder.join(target)
        }
        None => folder,
    };
    let library = folder.join("release").join(LIBRARY);
    match kinds {
        Kinds::All => {
            run(&mut command)?;
            Ok(library)
        }
        Kinds::OneDc => {
            run(command.arg("--no-default-features"))?;
            // The next one is built in the same place.
            let small = library.with_extension("dc.a");
            fs::copy(&library, &small).context(LIBRARY)?;
            Ok(small)
        }
    }
}

fn here(folder: &Path, example: &str, library: &Path) -> Result<String> {
    let binary = folder.join("example");
    run(program("cc")
        .args(WARNINGS)
        .args(["-O2", SAME_BITS, "-Icapi/include", "-I"])
        .arg(folder)
        .args([example, HERE])
        .arg(library)
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&binary))?;
    output(&mut program(&binary.to_string_lossy()))
}

fn on_target(folder: &Path, example: &str, library: &Path) -> Result<String> {
    let elf = folder.join("example.elf");
    run(program("arm-none-eabi-gcc")
        .args(WARNINGS)
        .args(CORTEX_M4F)
        .args(["-O2", SAME_BITS, "-ffunction-sections", "-Wl,--gc-sections"])
        .args(["-Icapi/include", "-I"])
        .arg(folder)
        .args([example, STARTUP])
        .arg(library)
        .args(["-nostdlib", "-lgcc", "-Wl,-z,noexecstack", "-T", MAP, "-o"])
        .arg(&elf))?;
    let symbols = output(program("arm-none-eabi-nm").arg("-C").arg(&elf))?;
    let panics: Vec<_> = symbols.lines().filter(|line| is_panic(line)).collect();
    ensure!(panics.is_empty(), "the example links a panic: {panics:?}");
    qemu::run(MPS2_AN386, &elf, &[""; 0])
}

/// A program said `NAME hash HASH` of each vehicle as the golden file does.
fn compare(said: &str, golden: &str, vehicles: &[&str]) -> Result<()> {
    for name in vehicles {
        let (_, section) = golden
            .split_once(&format!("\n[{name}]\n"))
            .with_context(|| format!("{GOLDEN} has no `{name}`"))?;
        let hash = section.split('"').nth(1).context("a section has no hash")?;
        demand(said, &format!("{name} hash {hash}"))?;
    }
    Ok(())
}

/// The line in which a program said its hash of something.
fn said_hash<'a>(said: &'a str, name: &str) -> Result<&'a str> {
    let start = format!("{name} hash ");
    said.lines()
        .find(|line| line.starts_with(&start))
        .with_context(|| format!("no hash of `{name}` in:\n{said}"))
}

/// A program said this line.
fn demand(said: &str, wanted: &str) -> Result<()> {
    ensure!(said.lines().any(|line| line == wanted), "wanted `{wanted}`, found:\n{said}");
    println!("{wanted}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_compared() {
        let golden = "# text\n\n[a]\nhash = \"01\"\nsoc = \"0.5\"\n\n[b]\nhash = \"02\"\n";
        let compare = |said, golden| compare(said, golden, &["a", "b"]);
        assert!(compare("a hash 01\nb hash 02\n", golden).is_ok());
        assert!(compare("a hash 01\nb hash 03\n", golden).is_err());
        assert!(compare("a hash 01\n", golden).is_err());
        assert!(compare("a hash 01\nb hash 02\n", "").is_err());
        assert_eq!(said_hash("a soc 1\na hash 01\n", "a").unwrap(), "a hash 01");
        assert!(said_hash("b hash 01\n", "a").is_err());
        assert!(demand("a hash 01\n", "a hash 01").is_ok());
        assert!(demand("a hash 02\n", "a hash 01").is_err());
    }

    #[test]
    fn a_cycle_becomes_a_table() {
        let text = table("time_s,speed_m_s\n0,0\n1, 0.1\n").unwrap();
        assert!(text.contains("{ 0.0f, 0.0f },\n    { 1.0f, 0.1f },"), "{text}");
        assert!(table("time_s\n0\n").is_err());
    }
}
