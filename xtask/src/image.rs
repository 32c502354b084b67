//! What was linked for the target: no panic, no double precision, no allocator, in an image that
//! keeps every public function of the crates that run there. Each check is run on an image that
//! must fail it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::firmware;
use crate::shell::{output, program};

const PACKAGE: &str = "voltstep-keep-all";
/// The crates that it must hold, and where their sources lie.
const CRATES: &[(&str, &str)] = &[("plant_core", "plant-core/src"), ("voltstep_bms", "bms/src")];
const LIST: &str = "firmware-example/keep-all/src/main.rs";

/// One thing that must not be linked.
struct Check {
    about: &'static str,
    /// The feature of the image that puts one in.
    control: &'static str,
    forbids: fn(&str) -> bool,
}

const CHECKS: &[Check] = &[
    Check { about: "a panic", control: "control-panic", forbids: is_panic },
    Check { about: "double precision", control: "control-double", forbids: is_double },
    Check { about: "an allocator", control: "control-alloc", forbids: is_alloc },
];

/// Public functions that are for the compiler, not for the target.
const NOT_FOR_TARGET: &[&str] = &["ParamError::text", "CircuitError::text", "ErrorText::as_str"];
/// Types that the list names otherwise: by an alias or, made by a macro, by each of its names.
const OTHERWISE: &[(&str, &[&str])] = &[
    ("Powertrain", &["Powertrain", "Plain", "Ledgered", "Mapped", "MappedLedgered", "Composed"]),
    ("PowertrainParams", &["PowertrainParams", "WithBattery"]),
    ("$sensor", &["VoltageSensor", "CurrentSensor"]),
];
/// Files that only a feature compiles.
const OPTIONAL: &[&str] = &[
    "plant-core/src/num/fast.rs",
    "plant-core/src/num/table_serde.rs",
    "plant-core/src/num/unlimited.rs",
    "bms/src/comm/smart_battery.rs",
];
/// Modules whose functions belong to no type.
const MODULES: &[&str] =
    &["num", "port", "error", "transform", "battery", "contactor", "limit", "can", "circuit"];

pub fn is_panic(symbol: &str) -> bool {
    symbol.contains("core::panicking") || symbol.contains("rust_begin_unwind")
}

/// The names that compilers give to double-precision routines (`__aeabi_dmul`, `__muldf3`,
/// `__aeabi_f2d`, …).
fn is_double(symbol: &str) -> bool {
    let name = symbol.rsplit("::").next().unwrap_or(symbol);
    let aeabi = name.strip_prefix("__aeabi_").is_some_and(|rest| {
        rest.starts_with('d') || rest.starts_with("cd") || rest.ends_with("2d")
    });
    // The division of integers is called `__aeabi_idiv`, so it is none of these.
    aeabi || name.starts_with("__") && name.contains("df")
}

fn is_alloc(symbol: &str) -> bool {
    symbol.starts_with("alloc::") || symbol.contains("__rust_alloc") || symbol.contains("__rdl_")
}

/// Checks the image and its controls, and that nothing public is missing in it.
pub fn image() -> Result<()> {
    let missing = missing()?;
    ensure!(missing.is_empty(), "{LIST} does not keep {}", missing.join(", "));
    let mut found = String::new();
    let symbols = symbols(None)?;
    for (name, _) in CRATES {
        ensure!(symbols.iter().any(|s| s.contains(name)), "the image has nothing of {name}");
    }
    for check in CHECKS {
        let here: Vec<_> = symbols.iter().filter(|s| (check.forbids)(s)).collect();
        if !here.is_empty() {
            found.push_str(&format!("\n  {}: {here:?}", check.about));
        }
        let control = self::symbols(Some(check.control))?;
        let extra = control.iter().filter(|s| (check.forbids)(s) && !symbols.contains(s)).count();
        let caught = extra > 0 || !here.is_empty();
        ensure!(caught, "the check for {} misses the one put in on purpose", check.about);
        println!("linked {}: {}; the control is caught", check.about, here.len());
    }
    ensure!(found.is_empty(), "linked, and not allowed:{found}");
    Ok(())
}

/// The demangled symbols of the image, with one control in it or none.
fn symbols(control: Option<&str>) -> Result<Vec<String>> {
    let mut args = vec!["-p", PACKAGE];
    args.extend(control.iter().flat_map(|feature| ["--features", feature]));
    firmware::build(&args, &[])?;
    let nm = output(program("arm-none-eabi-nm").arg("-C").arg(firmware::binary(PACKAGE)?))?;
    Ok(nm.lines().filter_map(symbol).map(String::from).collect())
}

/// The name in a line of nm: address, kind, name.
fn symbol(line: &str) -> Option<&str> {
    Some(line.split_once(' ')?.1.trim_start().split_once(' ')?.1)
}

/// The public functions that the image does not keep.
fn missing() -> Result<Vec<String>> {
    let list = fs::read_to_string(firmware::root().join(LIST)).context(LIST)?;
    let list = without_type_arguments(&list);
    let root = firmware::root();
    let mut files = Vec::new();
    for (_, sources) in CRATES {
        files.extend(rust_files(&root.join(sources))?);
    }
    let mut missing = Vec::new();
    for file in files {
        let name = file.strip_prefix(root).unwrap_or(&file).to_string_lossy().into_owned();
        if OPTIONAL.contains(&name.as_str()) || name.contains("/tests/") {
            continue;
        }
        for function in public_functions(&fs::read_to_string(&file)?) {
            if !is_kept(&list, &function) {
                missing.push(format!("{name}: {function}"));
            }
        }
    }
    Ok(missing)
}

fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.ends_with("tests") {
            continue;
        }
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// `Drive::new` for `Drive::<Pmsm>::new`.
fn without_type_arguments(list: &str) -> String {
    let mut short = String::new();
    let mut rest = list;
    while let Some((before, after)) = rest.split_once("::<") {
        short.push_str(before);
        let mut depth = 1;
        let end = after.find(|c| {
            depth += i32::from(c == '<') - i32::from(c == '>');
            depth == 0
        });
        rest = end.map_or("", |end| &after[end + 1..]);
    }
    short + rest
}

/// `Type::function` or `function` for each public function above a file's tests, but for those of
/// types that nobody outside sees.
fn public_functions(source: &str) -> Vec<String> {
    let code = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or(source);
    let mut of = String::new();
    let mut functions = Vec::new();
    for line in code.lines() {
        let text = line.trim_start();
        if line.starts_with('}') {
            of.clear();
        } else if text.starts_with("impl") {
            of = implemented(text);
        } else if let Some(rest) =
            text.strip_prefix("pub const fn ").or(text.strip_prefix("pub fn "))
        {
            let name: String =
                rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if of.is_empty() {
                functions.push(name);
            } else if !is_private(code, &of) {
                functions.push(format!("{of}::{name}"));
            }
        }
    }
    functions
}

/// Whether a file declares the type for its own crate only.
fn is_private(code: &str, of: &str) -> bool {
    code.lines().any(|line| {
        line.strip_prefix("pub(")
            .and_then(|rest| rest.split_once(") struct "))
            .is_some_and(|(_, rest)| implemented(rest) == of)
    })
}

/// The type of `impl<L: Book> Trait for Type<L> {`.
fn implemented(text: &str) -> String {
    let mut rest = text.trim_start_matches("impl").trim_start();
    if rest.starts_with('<') {
        rest = rest.split_once("> ").map_or(rest, |parts| parts.1);
    }
    let of = rest.split_once(" for ").map_or(rest, |parts| parts.1);
    of.chars().take_while(|c| c.is_alphanumeric() || "_$".contains(*c)).collect()
}

fn is_kept(list: &str, function: &str) -> bool {
    let listed = |name: &str| {
        list.match_indices(name).any(|(at, _)| {
            let after = list[at + name.len()..].chars().next();
            let before = list[..at].chars().next_back();
            let word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
            !word(after) && !word(before)
        })
    };
    if NOT_FOR_TARGET.contains(&function) {
        return true;
    }
    let Some((of, name)) = function.split_once("::") else {
        return MODULES.iter().any(|module| listed(&format!("{module}::{function}")));
    };
    match OTHERWISE.iter().find(|(known, _)| *known == of) {
        Some((_, names)) if of.starts_with('$') => {
            names.iter().all(|of| listed(&format!("{of}::{name}")))
        }
        Some((_, names)) => names.iter().any(|of| listed(&format!("{of}::{name}"))),
        None => listed(function),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_what_is_not_allowed() {
        for name in ["core::panicking::panic_bounds_check", "__rustc::rust_begin_unwind"] {
            assert!(is_panic(name));
        }
        for name in ["__aeabi_dmul", "__aeabi_f2d", "__aeabi_cdcmple", "a::float::mul::__muldf3"] {
            assert!(is_double(name), "{name}");
        }
        for name in ["__aeabi_fmul", "__aeabi_idiv", "__aeabi_d2", "__addsf3", "held_f"] {
            assert_eq!(is_double(name), name == "__aeabi_d2", "{name}");
        }
        assert!(is_alloc("alloc::boxed::box_new_uninit") && !is_alloc("core::alloc_me"));
        assert_eq!(symbol("00000400 T a::b<c d>"), Some("a::b<c d>"));
    }

    #[test]
    fn public_functions_are_found_with_their_types() {
        let source = "#[cfg(test)]\nmod tests;\npub const fn free(a: f32) {}\nimpl<L: Book> Model for Plant<L> {\n    pub fn \
                      step(&self) {}\n    fn private() {}\n    pub(crate) fn inner() {}\n}\npub fn \
                      last() {}\n#[cfg(test)]\nmod tests {\n pub fn hidden() {}\n}\n";
        assert_eq!(public_functions(source), ["free", "Plant::step", "last"]);
        let inner = "pub(super) struct Loads {\n}\nimpl Loads {\n    pub fn times(&self) {}\n}\n";
        assert!(public_functions(inner).is_empty());
        assert_eq!(public_functions(&inner.replace("pub(super)", "pub")), ["Loads::times"]);
        assert_eq!(implemented("impl<'a> TimeTable<'a> {"), "TimeTable");
        assert_eq!(implemented("impl $sensor {"), "$sensor");
    }

    #[test]
    fn a_function_that_is_not_in_the_list_is_noticed() {
        let list = "keep!(Pid::new, num::max, Plain::step, VoltageSensor::step)";
        assert!(is_kept(list, "Pid::new") && is_kept(list, "max"));
        let long = without_type_arguments("Axles::<Drive<Pmsm>>::and::<(A, B)>, Gates::<f32>::on");
        assert_eq!(long, "Axles::and, Gates::on");
        assert!(is_kept(list, "Powertrain::step") && !is_kept(list, "Powertrain::new"));
        assert!(!is_kept(list, "Pid::ne") && !is_kept(list, "id::new"));
        assert!(!is_kept(list, "$sensor::step"), "both sensors");
    }
}
