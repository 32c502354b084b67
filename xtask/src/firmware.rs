//! The workspace in `firmware-example`: its own checks, and the same bits on every machine.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::board;
use crate::qemu::{self, MPS2_AN386, line};
use crate::shell::{TOOLS, cargo, output, program, run};

/// The microcontroller target: Cortex-M4F.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// A microcontroller without floating point: Cortex-M0+.
pub const SMALL_TARGET: &str = "thumbv6m-none-eabi";
const FOLDER: &str = "firmware-example";
/// The least firmware, and what it says.
const MINIMAL: (&str, &str) = ("minimal", "src/bin/minimal.out");

/// What is built for a board.
const BOARDS: [&str; 2] = ["board", "board_bms"];
/// Switched circuits, on both sides.
const CIRCUITS: &str = "circuits";
/// The whole BMS of a pack, on both sides.
const OWN_PACK: &str = "own_pack";
/// The same pack, recorded.
const RECORDED: &str = "recorded";

/// The vehicles of `sim`, with the features that choose them.
const VEHICLES: &[(&str, &[&str])] = &[
    ("epowertrain-udds", &[]),
    ("bmw-i3-60ah-constant", &["--features", "bmw-i3-constant"]),
    ("bmw-i3-60ah", &["--features", "bmw-i3"]),
    ("bmw-i3-60ah-pmsm", &["--features", "bmw-i3-pmsm"]),
    ("bmw-i3-60ah-thermal", &["--features", "bmw-i3-thermal"]),
    ("two-axles", &["--features", "two-axles"]),
];

/// Where the same bits must come out: opt-level, processor, QEMU's words for the machine.
const MACHINES: &[(&str, &str, &[&str])] = &[
    ("2", "Cortex-M4F", MPS2_AN386),
    ("3", "Cortex-M4F", MPS2_AN386),
    ("s", "Cortex-M4F", MPS2_AN386),
    ("3", "Cortex-M7", &["-cpu", "cortex-m7", "-machine", "mps2-an500"]),
];

/// The workspace's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in a folder")
}

/// Cargo in the firmware's workspace.
fn firmware_cargo() -> Command {
    let mut command = cargo();
    command.current_dir(root().join(FOLDER));
    command
}

/// Builds for the target, optimised.
pub fn build(args: &[&str], variables: &[(&str, &str)]) -> Result<()> {
    run(firmware_cargo()
        .args(["build", "--quiet", "--release", "--locked"])
        .args(args)
        .envs(variables.iter().copied()))
}

/// A binary built for the target.
pub fn binary(name: &str) -> Result<PathBuf> {
    binary_for(TARGET, name)
}

/// A binary built for one of the targets.
pub fn binary_for(target: &str, name: &str) -> Result<PathBuf> {
    let args = ["metadata", "--no-deps", "--format-version", "1"];
    let metadata: Value = serde_json::from_str(&output(firmware_cargo().args(args))?)?;
    let folder = metadata["target_directory"].as_str().context("cargo names no target folder")?;
    Ok([folder, target, "release", name].iter().collect())
}

/// The version of a package that the firmware's workspace uses.
pub fn version(package: &str) -> Result<String> {
    let id = output(firmware_cargo().args(["pkgid", "--locked", package]))?;
    Ok(String::from(id.trim().rsplit('@').next().unwrap_or_default()))
}

/// The triple of this machine, as rustc says it.
fn host() -> Result<String> {
    let text = output(program("rustc").arg("-vV"))?;
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(String::from(host.context("rustc names no host")?))
}

/// Formatting, lints, host tests, every binary, the sensor run, what is built for a board.
pub fn firmware() -> Result<()> {
    run(firmware_cargo().args(["fmt", "--all", "--", "--check"]))?;
    let host = host()?;
    let strict = ["--", "-D", "warnings"];
    run(firmware_cargo()
        .args(["clippy", "--workspace", "--bins", "--features", "recorder", "--locked"])
        .args(strict))?;
    run(firmware_cargo()
        .args(["clippy", "-p", "voltstep-trace", "--all-targets", "--target", &host])
        .args(strict))?;
    for name in BOARDS {
        let board = ["--no-default-features", "--features", "board", "--bin", name];
        run(firmware_cargo().arg("clippy").args(board).args(strict))?;
        build(&board, &[])?;
        board::check(&binary(name)?)?;
    }
    run(firmware_cargo().args(["test", "--release", "-p", "voltstep-trace", "--target", &host]))?;
    minimal()?;
    run(firmware_cargo().args(["run", "--release", "--locked", "--bin", "sensor"]))
}

/// The least firmware says what it always said.
fn minimal() -> Result<()> {
    let (name, file) = MINIMAL;
    let expected = root().join(FOLDER).join(file);
    let expected = fs::read_to_string(&expected).context(file)?;
    let run = ["run", "--quiet", "--release", "--locked", "--bin", name];
    let said = output(firmware_cargo().args(run))?;
    ensure!(said == expected, "`{name}` says, other than {file}:\n{said}");
    Ok(())
}

/// The same bits after every step on this machine and in QEMU, at each opt-level.
pub fn bits() -> Result<()> {
    for (vehicle, features) in VEHICLES {
        let here = host_trace(vehicle, None)?;
        let expected = line(&here, "result")?;
        println!("{vehicle} here: {expected}");
        for (machine, there) in MACHINES.iter().zip(on_every_machine("sim", features)?) {
            let (opt_level, processor, _) = machine;
            let found = line(&there, "result")?;
            println!("{vehicle} at opt-level {opt_level} on {processor}: {found}");
            ensure!(
                found == expected,
                "{vehicle} at opt-level {opt_level} on {processor} differs: {}",
                first_difference(vehicle, features, machine)?
            );
        }
    }
    same_text(CIRCUITS, trace_example(CIRCUITS)?)?;
    same_text(OWN_PACK, own_pack())?;
    recorded()
}

/// What an image says on each of the machines. It runs on one while it is built for the next.
fn on_every_machine(name: &str, features: &[&str]) -> Result<Vec<String>> {
    thread::scope(|scope| {
        let mut runs = Vec::new();
        for (opt_level, _, machine) in MACHINES {
            let level = [("CARGO_PROFILE_RELEASE_OPT_LEVEL", *opt_level)];
            build(&[&["--bin", name], features].concat(), &level)?;
            let built = binary(name)?;
            let elf = built.with_file_name(format!("{name}-{opt_level}"));
            fs::copy(&built, &elf).with_context(|| elf.display().to_string())?;
            runs.push(scope.spawn(move || qemu::run(machine, &elf, &[""; 0])));
        }
        runs.into_iter().map(|run| run.join().expect("a run that panics is a bug here")).collect()
    })
}

/// What the whole BMS was given, recorded there, is byte for byte what is recorded here, and
/// `voltstep rewind` comes to the same bits with it.
fn recorded() -> Result<()> {
    let features = ["--features", "recorder"];
    let example = ["run", "-q", "--release", "--locked", "-p", "voltstep-bms"];
    let here = output(cargo().args(example).args(features).args(["--example", RECORDED]))?;
    let file = crate::metadata::Metadata::load()?.target_directory()?.join("xtask-recorded.vsrc");
    for (machine, there) in MACHINES.iter().zip(on_every_machine(RECORDED, &features)?) {
        let at = format!("{RECORDED} at opt-level {} on {}", machine.0, machine.1);
        ensure!(there.trim() == here.trim(), "{at}: other bytes than here");
        fs::write(&file, bytes(there.trim())?).with_context(|| file.display().to_string())?;
        let rewind = ["run", "-q", "--release", "--locked", "--", "rewind"];
        let said = output(cargo().args(rewind).arg(&file))?;
        ensure!(said.contains(": the same bits"), "{at}: {said}");
        println!("{at}: {}", said.lines().next().unwrap_or_default());
    }
    Ok(())
}

/// The bytes of a text of hexadecimal digits.
fn bytes(text: &str) -> Result<Vec<u8>> {
    let pair = |at: usize| text.get(at..at + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok());
    let bytes: Option<Vec<u8>> = (0..text.len()).step_by(2).map(pair).collect();
    bytes.filter(|bytes| !bytes.is_empty()).context("not hexadecimal digits")
}

/// An image says what an example says here.
fn same_text(name: &str, mut example: Command) -> Result<()> {
    let here = output(&mut example)?;
    println!("{name} here: {}", here.trim());
    for (machine, there) in MACHINES.iter().zip(on_every_machine(name, &[])?) {
        let at = format!("{name} at opt-level {} on {}", machine.0, machine.1);
        ensure!(there.trim() == here.trim(), "{at} differs: {there}");
        println!("{at}: the same");
    }
    Ok(())
}

/// The whole BMS of a pack, of the workspace.
fn own_pack() -> Command {
    let mut command = cargo();
    command.args([
        "run",
        "-q",
        "--release",
        "--locked",
        "-p",
        "voltstep-bms",
        "--example",
        OWN_PACK,
    ]);
    command
}

/// An example of what runs on both sides, here.
fn trace_example(name: &str) -> Result<Command> {
    let mut command = firmware_cargo();
    command.args(["run", "--quiet", "--release", "--locked"]).args([
        "-p",
        "voltstep-trace",
        "--example",
        name,
        "--target",
        &host()?,
    ]);
    Ok(command)
}

/// What the host says of a vehicle.
pub fn host_trace(vehicle: &str, block: Option<&str>) -> Result<String> {
    output(trace_example("trace")?.args(["--", vehicle]).args(block))
}

/// Every frame of a block, as the firmware says it in QEMU.
fn sim(
    features: &[&str],
    (opt_level, _, machine): &(&str, &str, &[&str]),
    block: &str,
) -> Result<String> {
    let variables = [("CARGO_PROFILE_RELEASE_OPT_LEVEL", *opt_level), ("VOLTSTEP_BLOCK", block)];
    build(&[&["--bin", "sim"], features].concat(), &variables)?;
    qemu::run(machine, &binary("sim")?, &[""; 0])
}

/// Names the first step and field that differ: by the hashes of the blocks, then frame by frame.
fn first_difference(
    vehicle: &str,
    features: &[&str],
    machine: &(&str, &str, &[&str]),
) -> Result<String> {
    let here = host_trace(vehicle, None)?;
    let there = sim(features, machine, "0")?;
    let block = first_differing(&lines(&here, "block "), &lines(&there, "block "))
        .context("the results differ, the blocks do not")?;
    let block = block.to_string();
    let here = host_trace(vehicle, Some(&block))?;
    let there = sim(features, machine, &block)?;
    let fields = line(&here, "fields")?;
    let (here, there) = (lines(&here, "frame "), lines(&there, "frame "));
    let at = first_differing(&here, &there).context("the block differs, its frames do not")?;
    Ok(describe(fields, here[at], there.get(at).copied().unwrap_or("nothing")))
}

/// The rest of the lines that begin with a word.
fn lines<'a>(said: &'a str, word: &str) -> Vec<&'a str> {
    said.lines().filter_map(|line| line.strip_prefix(word)).collect()
}

fn first_differing(a: &[&str], b: &[&str]) -> Option<usize> {
    let unequal = |i: &usize| a.get(*i) != b.get(*i);
    (0..a.len().max(b.len())).find(unequal)
}

/// Which field of two frames differs first.
fn describe(fields: &str, here: &str, there: &str) -> String {
    fn words(frame: &str) -> Vec<&str> {
        frame.split([' ', ',', '[', ']']).filter(|word| !word.is_empty()).collect()
    }
    let (here, there) = (words(here), words(there));
    let Some(at) = first_differing(&here, &there) else { return String::from("nowhere") };
    let word = |frame: &[&str]| String::from(frame.get(at).copied().unwrap_or("nothing"));
    let field = at.checked_sub(1).and_then(|i| fields.split(' ').nth(i)).unwrap_or("step");
    let step = here.first().copied().unwrap_or("?");
    format!("first at step {step}, field {field}: {} here, {} there", word(&here), word(&there))
}

fn is_there(tool: &str) -> bool {
    program(tool).arg("--version").output().is_ok()
}

/// Installs what runs the firmware, where it may; else says what is missing.
pub fn setup() -> Result<()> {
    let mut updated = false;
    for (tool, package) in TOOLS {
        if is_there(tool) {
            continue;
        }
        let root = output(program("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
        ensure!(
            root && is_there("apt-get"),
            "`{tool}` is not installed: install Debian's package `{package}` (as root, this command \
             installs it by itself)"
        );
        if !updated {
            run(program("apt-get").args(["update", "-qq"]))?;
            updated = true;
        }
        let quiet = ["install", "-y", "-qq", "--no-install-recommends"];
        run(program("apt-get").args(quiet).arg(package).env("DEBIAN_FRONTEND", "noninteractive"))
            .with_context(|| format!("cannot install Debian's package `{package}`"))?;
        ensure!(is_there(tool), "`{tool}` is still missing after installing `{package}`");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_difference_is_named() {
        let here = "17 [00000001, 00000002, 3f800000, 0, 0, 0, 0, 0, 0, 0, 0, 0]";
        let fields = "current_a current_a.lost speed_m_s speed_m_s.lost";
        assert_eq!(describe(fields, here, here), "nowhere");
        let there = "17 [00000001, 00000002, 3f800001, 0, 0, 0, 0, 0, 0, 0, 0, 0]";
        assert_eq!(
            describe(fields, here, there),
            "first at step 17, field speed_m_s: 3f800000 here, 3f800001 there"
        );
        assert!(describe(fields, here, "nothing").contains("field step"));
    }

    #[test]
    fn lines_are_found_and_compared() {
        assert_eq!(lines("block 0 aa\nresult hash ff\nblock 1 bb\n", "block "), ["0 aa", "1 bb"]);
        assert_eq!(first_differing(&["a", "b"], &["a", "c"]), Some(1));
        assert_eq!(first_differing(&["a"], &["a", "c"]), Some(1));
        assert_eq!(first_differing(&["a"], &["a"]), None);
    }
}
