//! Batteries with parameters over state of charge and temperature: built in, or from a file.
//!
//! `data/batteries/*.toml` are the examples; `voltstep identify battery` writes such files.

use plant_core::battery::{MappedBattery, MappedBatteryParams};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::read::builtin::BuiltIn;
use crate::read::document::{CHECK_DT, Document};
use crate::read::error::{self, InputError};
use crate::read::recognise::FileKind;

/// Every built-in battery.
const BUILT_IN: BuiltIn = BuiltIn {
    kind: FileKind::Battery,
    files: &[
        ("bmw-i3-60ah", include_str!("../../data/batteries/bmw-i3-60ah.toml")),
        ("panasonic-ncr18650pf", include_str!("../../data/batteries/panasonic-ncr18650pf.toml")),
    ],
};

/// A battery and where it comes from; its parameters are sound.
#[derive(Clone, Debug, PartialEq)]
pub struct BatteryFile {
    /// Its name.
    pub name: String,
    /// What it is, in one line.
    pub description: String,
    /// Where the measurements come from.
    pub source: String,
    /// By how much the measured current leads the measured voltage \[s\]: a quirk of the logger,
    /// not of the battery.
    pub current_delay_s: f64,
    /// Its parameters.
    pub battery: MappedBatteryParams,
}

/// A battery as its file is laid out.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    description: String,
    source: String,
    #[serde(default, rename = "command")]
    _command: Option<IgnoredAny>,
    #[serde(default)]
    fit: Fit,
    #[serde(default, rename = "standard_error")]
    _standard_error: Option<IgnoredAny>,
    battery: MappedBatteryParams,
}

/// How the parameters were found; what is not used here may stand beside it.
#[derive(Default, Deserialize)]
struct Fit {
    #[serde(default)]
    current_delay_s: f64,
}

/// The names of the built-in batteries.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.names()
}

/// The built-in batteries.
#[must_use]
pub fn builtin() -> Vec<BatteryFile> {
    BUILT_IN.all(parse)
}

/// A built-in battery by its name, or one from a file: a path that ends in `.toml` or names a
/// folder.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn load(name_or_path: &str) -> Result<BatteryFile, InputError> {
    BUILT_IN.load(name_or_path, parse)
}

/// The text of a battery's file, built in or not.
///
/// # Errors
/// As [`load`].
pub fn text(name_or_path: &str) -> Result<String, InputError> {
    BUILT_IN.load(name_or_path, |file, bytes| Ok(error::text(file, bytes)?.to_owned()))
}

/// A battery from the bytes of a file; `file` is for messages.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<BatteryFile, InputError> {
    let document = Document::parse(file, bytes)?;
    let File { name, description, source, fit, battery, .. } = document.read::<File>()?;
    if !(0.0..=10.0).contains(&fit.current_delay_s) {
        return Err(document.refusal("fit.current_delay_s", "must lie in 0..10"));
    }
    MappedBattery::new(battery, CHECK_DT)
        .map_err(|error| document.refusal(error.field(), error.message()))?;
    let current_delay_s = fit.current_delay_s;
    Ok(BatteryFile { name, description, source, current_delay_s, battery })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_battery_is_sound_and_named_as_its_file() {
        let found: Vec<_> = builtin().into_iter().map(|b| b.name).collect();
        assert_eq!(found, names().collect::<Vec<_>>());
    }

    /// To the bit: a polyline in the file and one in the source end on the same grid.
    #[test]
    fn built_in_batteries_are_the_presets() {
        use plant_core::presets::{BMW_I3_60AH_PACK, PANASONIC_NCR18650PF};
        let [pack, cell] =
            ["bmw-i3-60ah", "panasonic-ncr18650pf"].map(|n| load(n).unwrap().battery);
        assert_eq!(pack, BMW_I3_60AH_PACK);
        assert_eq!(cell, PANASONIC_NCR18650PF);
    }

    #[test]
    fn says_where_a_file_is_wrong() {
        let (_, text) = BUILT_IN.files[1];
        let line_of = |key: &str| text.lines().find(|l| l.starts_with(key)).unwrap();
        for (from, to, message) in [
            (
                line_of("capacity_ah"),
                "capacity_ah = -1",
                "must be finite and between 1e-12 and 1e12",
            ),
            (
                line_of("activation_k"),
                "activation_k = 1e9",
                "`activation_k` in [battery.series] must lie",
            ),
            ("[battery.thermal]", "[battery.thermic]", "did you mean [battery.thermal]?"),
            (line_of("current_delay_s"), "current_delay_s = -0.1", "must lie in 0..10"),
        ] {
            assert!(text.contains(from), "{from}");
            let error = parse("x.toml", text.replace(from, to).as_bytes()).unwrap_err();
            assert!(error.message.contains(message), "{error}");
            let line = text.lines().position(|l| l.contains(from)).unwrap() as u64 + 1;
            assert_eq!(error.line, Some(line), "{error}");
        }
        let error = load("panasonic").unwrap_err().to_string();
        assert!(error.contains("no such battery"), "{error}");
        let vehicle = concat!(env!("CARGO_MANIFEST_DIR"), "/data/vehicles/bmw-i3-60ah.toml");
        let error = load(vehicle).unwrap_err();
        assert!(error.message.starts_with("this is a vehicle; expected a battery"), "{error}");
    }
}
