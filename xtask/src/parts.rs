//! The parts, in the order in which they run.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::data;
use crate::firmware;
use crate::generate;
use crate::metadata::Metadata;
use crate::shell::{cargo, output, program, run};

/// One part of the checks.
pub struct Part {
    /// What to type after `cargo xtask`.
    pub name: &'static str,
    /// What it does, in one line.
    pub about: &'static str,
    /// Whether some of it is skipped where the real measurements are absent.
    pub needs_data: bool,
    /// Does it.
    pub run: fn() -> Result<()>,
}

/// Every part.
pub const PARTS: &[Part] = &[
    part("setup", "install what the other parts need", setup),
    part("format", "formatting is that of rustfmt", format),
    part("arrows", "each module uses only those below it", crate::arrows::arrows),
    part("paths", "what documents link to, name and cite is there", paths),
    part("clippy", "no warning from the compiler or clippy", clippy),
    Part { needs_data: true, ..part("tests", "unit, workspace and doc tests on the host", tests) },
    part("examples", "each example runs and shows what it asserts", crate::examples::examples),
    part("docs", "rustdoc and the book build without a warning", docs),
    part("live", "the book's live page in a browser: golden bits, keys, times", crate::live::live),
    part("thumb", "what runs on target compiles for Cortex-M4F and M0+, with each feature", thumb),
    part("replay", "the command replays a driving cycle and writes its files", replay),
    Part {
        needs_data: true,
        ..part("validate", "every published experiment and an independent solution", validate)
    },
    part(
        "firmware",
        "the firmware passes its own checks and builds for a board",
        firmware::firmware,
    ),
    part(
        "bits",
        "the same bits after every step here and in QEMU, at each opt-level",
        firmware::bits,
    ),
    part("image", "nothing that panics, allocates or is double is linked", crate::image::image),
    part(
        "capi",
        "the C header is up to date; C gives the same bits here and in QEMU",
        crate::capi::capi,
    ),
    part("dbc", "cantools reads the CAN messages as the code writes them", crate::dbc::dbc),
    part(
        "python",
        "the Python wheel builds; it gives the bits of the command",
        crate::python::python,
    ),
    part("counts", "what each step costs on target is no more than before", crate::counts::counts),
    part(
        "generated",
        "the figures in the documents are those of this code",
        crate::generated::generated,
    ),
];

/// Parts that take long, need more tools or write files of the workspace; `test` leaves them out.
pub const LONG: &[Part] = &[
    part("miri", "unit tests in an interpreter that sees undefined behaviour", miri),
    part(
        "fuzz",
        "arbitrary bytes for the readers, arbitrary bits for the step (VOLTSTEP_FUZZ_S)",
        fuzz,
    ),
    part(
        "mutants",
        "changes plant-core and what protects in bms; tests notice 9 of 10 (VOLTSTEP_MUTANTS_SHARD, …_OF)",
        crate::mutants::mutants,
    ),
    part(
        "fastsim",
        "times a replay against FASTSim (VOLTSTEP_PYTHON names a Python that has it)",
        fastsim,
    ),
    part("presets", "writes the batteries of plant-core from their files", generate::presets),
    part("trip", "writes the synthetic trip and its true parameters", generate::trip),
    part(
        "picture",
        "draws the report of a trip and the live page for the documents",
        crate::picture::picture,
    ),
];

/// What each fuzz target gets \[s\], and the variable that says otherwise.
const FUZZ_S: (&str, &str) = ("VOLTSTEP_FUZZ_S", "60");
const FUZZ_TARGETS: [&str; 9] =
    ["cycle", "trip", "vehicle", "battery", "cell", "netlist", "check", "step", "circuit"];

fn miri() -> Result<()> {
    let packages = ON_TARGET.iter().flat_map(|package| ["-p", package]);
    run(rustup_cargo("nightly").args(["miri", "test", "--lib"]).args(packages))
        .context("`rustup component add --toolchain nightly miri` installs it")
}

fn fuzz() -> Result<()> {
    let seconds = std::env::var(FUZZ_S.0).unwrap_or_else(|_| FUZZ_S.1.to_owned());
    for target in FUZZ_TARGETS {
        // New inputs go to a folder beside the committed corpus, which stays small.
        let found = format!("target/fuzz-corpus/{target}");
        fs::create_dir_all(&found)?;
        run(rustup_cargo("nightly")
            .args(["fuzz", "run", target, &found, &format!("fuzz/corpus/{target}"), "--"])
            .arg(format!("-max_total_time={seconds}")))
        .context("`cargo install cargo-fuzz` installs it; it needs a nightly toolchain")?;
    }
    Ok(())
}

/// The Python that has the package.
const PYTHON: &str = "VOLTSTEP_PYTHON";

fn fastsim() -> Result<()> {
    run(cargo().args(["build", "--release", "-p", "voltstep"]))?;
    let command = Metadata::load()?.target_directory()?.join("release/voltstep");
    let python = std::env::var(PYTHON).unwrap_or_else(|_| "python3".to_owned());
    run(program(&python).arg("xtask/time_fastsim.py").arg(command))
}

/// Cargo of another toolchain.
fn rustup_cargo(toolchain: &str) -> std::process::Command {
    let mut command = program("rustup");
    command.args(["run", toolchain, "cargo"]);
    command
}

const fn part(name: &'static str, about: &'static str, run: fn() -> Result<()>) -> Part {
    Part { name, about, needs_data: false, run }
}

/// The microcontrollers: Cortex-M4F, and Cortex-M0+ without floating point.
const TARGETS: [&str; 2] = [firmware::TARGET, firmware::SMALL_TARGET];

/// The packages that run on them.
const ON_TARGET: [&str; 2] = ["plant-core", "voltstep-bms"];

/// The twins in double precision: the same sources.
const TWINS: [&str; 2] = ["plant-core-f64", "voltstep-bms-f64"];

fn setup() -> Result<()> {
    for component in ["rustfmt", "clippy"] {
        rustup("component", component)?;
    }
    for target in TARGETS.into_iter().chain([crate::web::TARGET]) {
        rustup("target", target)?;
    }
    crate::book::setup()?;
    firmware::setup()
}

/// Has rustup add a component or target that is not installed yet.
fn rustup(kind: &str, name: &str) -> Result<()> {
    let installed = output(program("rustup").args([kind, "list", "--installed"]))
        .with_context(|| format!("cannot ask rustup for its {kind}s (see https://rustup.rs)"))?;
    if lists(&installed, name) {
        println!("{kind} {name} is installed");
        return Ok(());
    }
    run(program("rustup").args([kind, "add", name]))
        .with_context(|| format!("cannot install the {kind} {name}"))
}

/// Whether a list from rustup holds a name. It writes `clippy` as `clippy-<host>`.
fn lists(installed: &str, name: &str) -> bool {
    installed.lines().any(|line| {
        line.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
    })
}

fn format() -> Result<()> {
    run(cargo().args(["fmt", "--all", "--", "--check"]))
}

fn clippy() -> Result<()> {
    run(cargo()
        .args(["clippy", "--workspace", "--all-targets", "--all-features"])
        .args(["--", "-D", "warnings"]))?;
    // The parsers and the identification need no command line, tables or plots.
    run(cargo()
        .args(["clippy", "-p", "voltstep", "--no-default-features", "--lib"])
        .args(["--", "-D", "warnings"]))
}

/// What the property tests draw their cases from.
const SEED: &str = "PROPTEST_RNG_SEED";

fn tests() -> Result<()> {
    let mut command = cargo();
    command.args(["test", "--workspace", "--all-features"]);
    // A check that is red now and then for a case that nobody can repeat helps nobody; to look
    // for new cases, set another seed.
    if std::env::var_os(SEED).is_none() {
        command.env(SEED, "1");
    }
    if let Some(folder) = data::folder() {
        command.env(data::VARIABLE, data::absolute(folder)?);
    } else {
        command.env_remove(data::VARIABLE);
        print!("{}", data::NOTICE);
    }
    run(&mut command)
}

fn docs() -> Result<()> {
    run(cargo()
        .args(["doc", "--workspace", "--no-deps", "--all-features"])
        .args(TWINS.iter().flat_map(|twin| ["--exclude", twin]))
        .env("RUSTDOCFLAGS", "-D warnings"))?;
    crate::book::build()
}

fn paths() -> Result<()> {
    let mut documents = crate::documents::all()?;
    crate::links::check(&documents)?;
    documents.extend(crate::documents::comments()?);
    crate::paths::check(&documents)?;
    crate::citations::check(&documents)
}

fn thumb() -> Result<()> {
    let metadata = Metadata::load()?;
    for package in ON_TARGET {
        for features in feature_sets(&metadata.features(package)?) {
            for target in TARGETS {
                // Programs are linked for it by other parts.
                let check = ["check", "-p", package, "--target", target];
                run(cargo().args(check).args(&features)).context("does not build on target")?;
            }
        }
    }
    Ok(())
}

/// Cargo's arguments for: no feature, each feature alone, all features.
fn feature_sets(features: &[String]) -> Vec<Vec<&str>> {
    let none = vec!["--no-default-features"];
    let alone = features.iter().map(|name| vec!["--no-default-features", "--features", name]);
    let all = vec!["--all-features"];
    std::iter::once(none).chain(alone).chain([all]).collect()
}

fn replay() -> Result<()> {
    let out = Metadata::load()?.target_directory()?.join("xtask-replay");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("cannot empty {}", out.display()))?;
    }
    run(cargo().args(["run", "--release", "--", "replay", "udds", "--out"]).arg(&out))?;
    check_replay(&out)
}

fn validate() -> Result<()> {
    let mut command = cargo();
    command.args(["run", "--release", "-p", "voltstep", "--", "validate"]);
    if let Some(folder) = data::folder() {
        command.env(data::VARIABLE, data::absolute(folder)?);
    } else {
        command.env_remove(data::VARIABLE);
    }
    run(&mut command)
}

/// The folder holds a summary, a trace and both reports, none of them empty.
fn check_replay(out: &Path) -> Result<()> {
    let entries = fs::read_dir(out)
        .with_context(|| format!("the replay left no folder {}", out.display()))?
        .collect::<std::io::Result<Vec<_>>>()?;
    for wanted in ["summary.json", "trace.csv", "report.html", "report.svg"] {
        let found = entries.iter().find(|entry| entry.file_name() == wanted);
        let Some(file) = found else { bail!("the replay wrote no `{wanted}`") };
        if file.metadata()?.len() == 0 {
            bail!("the replay left {} empty", file.file_name().to_string_lossy());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rustup_lists() {
        let installed = "cargo-x86_64-unknown-linux-gnu\nthumbv7em-none-eabihf\n";
        assert!(lists(installed, "cargo"));
        assert!(lists(installed, firmware::TARGET));
        assert!(!lists(installed, "clippy"));
        assert!(!lists(installed, "thumbv7em-none-eabi"));
        assert!(!lists("", firmware::TARGET));
    }

    #[test]
    fn no_feature_each_alone_all() {
        let features = [String::from("defmt"), String::from("serde")];
        let expected: [&[&str]; 4] = [
            &["--no-default-features"],
            &["--no-default-features", "--features", "defmt"],
            &["--no-default-features", "--features", "serde"],
            &["--all-features"],
        ];
        assert_eq!(feature_sets(&features), expected);
        assert_eq!(feature_sets(&[]), [["--no-default-features"], ["--all-features"]]);
    }

    #[test]
    fn a_replay_needs_its_four_files() {
        let out = std::env::temp_dir().join(format!("voltstep-xtask-{}", std::process::id()));
        assert!(check_replay(&out).is_err());
        fs::create_dir_all(&out).unwrap();
        for name in ["summary.json", "trace.csv", "report.html", "report.svg"] {
            let error = check_replay(&out).unwrap_err().to_string();
            assert_eq!(Some(name), error.split('`').nth(1), "{error}");
            fs::write(out.join(name), "text").unwrap();
        }
        check_replay(&out).unwrap();
        fs::write(out.join("trace.csv"), "").unwrap();
        assert!(check_replay(&out).unwrap_err().to_string().contains("empty"));
        fs::remove_dir_all(&out).unwrap();
    }
}
