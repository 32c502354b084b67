//! A scenario for a BMS: what a pack is asked for, and what goes wrong.
//!
//! `data/scenarios/*.toml` are examples.

mod fault;

pub use fault::{Fault, Part, Planted, When};

use std::path::Path;

use serde::Deserialize;

use crate::read::cycle;
use crate::read::document::Document;
use crate::read::error::{self, InputError, stem};
use crate::read::input::{self, Drive};
use crate::read::vehicle::{self, Vehicle};

/// Cells in series of the pack that scenarios are about, and its temperature sensors.
pub const CELLS: usize = 14;
/// See [`CELLS`].
pub const SENSORS: usize = 3;
const NO_AMOUNT: &str = "has no meaning: this fault is there or not";
/// No scenario lasts longer \[s\].
const LONGEST_S: f64 = 36_000.0;

/// What is done with a pack, and what goes wrong.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The file's name without its extension.
    pub name: String,
    /// State of charge at the start, 0..1.
    pub soc: f32,
    /// Temperature of cells and surroundings \[°C\].
    pub temperature_c: f32,
    /// What is asked for.
    pub course: Course,
    /// How long it lasts \[s\]; none: as long as the course, or some time after the last fault.
    pub seconds: Option<f64>,
    /// What goes wrong, the first first.
    pub planted: Vec<Planted>,
}

/// What a pack is asked for.
#[derive(Clone, Debug)]
pub enum Course {
    /// The battery current of a vehicle on a cycle, or as it was measured on a trip.
    Driven(Drive, Box<Vehicle>),
    /// A charger's current \[A\], above zero.
    Charged(f32),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    start: Start,
    drive: Driven,
    #[serde(default)]
    fault: Vec<Wrong>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Start {
    soc: f32,
    temperature_c: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Driven {
    cycle: Option<String>,
    vehicle: Option<String>,
    charge_a: Option<f32>,
    seconds: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wrong {
    kind: Fault,
    at_s: f64,
    severity: Option<u16>,
    amount: Option<f32>,
    cell: Option<u16>,
    sensor: Option<u16>,
}

/// Reads a scenario; a cycle's or vehicle's path counts from the folder of the file.
///
/// # Errors
/// [`InputError`] says what is wrong and where, of the scenario or of a file that it names.
pub fn load(path: &Path) -> anyhow::Result<Scenario> {
    let file = path.to_string_lossy();
    parse(&file, &error::read(path)?)
}

/// A scenario from the bytes of a file; `file` is for messages and for the folder of what it names.
///
/// # Errors
/// As [`load`].
pub fn parse(file: &str, bytes: &[u8]) -> anyhow::Result<Scenario> {
    let document = Document::parse(file, bytes)?;
    let File { start, drive, fault } = document.read::<File>()?;
    let rule = |kept: bool, field: &str, rule: &str| {
        if kept { Ok(()) } else { Err(document.refusal(field, rule)) }
    };
    rule((0.0..=1.0).contains(&start.soc), "start.soc", "must lie in 0..1")?;
    let celsius = (-40.0..=80.0).contains(&start.temperature_c);
    rule(celsius, "start.temperature_c", "must lie in -40..80")?;
    let long = drive.seconds.is_none_or(|s| (1.0..=LONGEST_S).contains(&s));
    rule(long, "drive.seconds", "must lie in 1..36000")?;
    let course = course(&document, file, &drive)?;
    let mut planted = Vec::new();
    for (index, wrong) in fault.iter().enumerate() {
        planted.push(plant(&document, index, wrong)?);
    }
    for (index, one) in planted.iter().enumerate() {
        let twice = planted[..index].iter().any(|p| p.fault == one.fault && p.at == one.at);
        let again = "stands twice in the same place: it would not end in between";
        rule(!twice, &format!("fault.{index}.kind"), again)?;
        let whole = one.fault.part() == Part::Pack || one.fault.when() == When::Before;
        let other = planted[..index].iter().any(|p| p.fault == one.fault);
        rule(!(whole && other), &format!("fault.{index}.kind"), again)?;
    }
    planted.sort_by_key(|p| p.from_ms);
    let Start { soc, temperature_c } = start;
    let seconds = drive.seconds;
    Ok(Scenario { name: stem(file), soc, temperature_c, course, seconds, planted })
}

fn course(document: &Document<'_>, file: &str, drive: &Driven) -> anyhow::Result<Course> {
    // A name that is built in, or else a file.
    let found = |key: &str, name: &str, names: &[&str]| {
        let path = Path::new(file).parent().unwrap_or(Path::new("")).join(name);
        if names.contains(&name) {
            Ok(name.to_owned())
        } else if path.is_file() {
            Ok(path.to_string_lossy().into_owned())
        } else {
            let built_in = names.join(", ");
            let rule = format!("must be a file beside this one or built in ({built_in})");
            Err(document.refusal(&format!("drive.{key}"), &rule))
        }
    };
    match (&drive.cycle, drive.charge_a) {
        (Some(cycle), None) => {
            let Some(wanted) = &drive.vehicle else {
                return Err(document.refusal("drive.cycle", "needs a `vehicle` beside it").into());
            };
            let cycle = found("cycle", cycle, &cycle::names().collect::<Vec<_>>())?;
            let vehicle = found("vehicle", wanted, &vehicle::names().collect::<Vec<_>>())?;
            let vehicle = Box::new(vehicle::load(&vehicle)?);
            Ok(Course::Driven(input::drive(&cycle)?, vehicle))
        }
        (None, Some(charge_a)) => {
            if !(charge_a > 0.0 && charge_a <= 1000.0) {
                let rule = "must be above 0, up to 1000";
                return Err(document.refusal("drive.charge_a", rule).into());
            }
            if drive.vehicle.is_some() {
                let rule = "has no meaning without `cycle`";
                return Err(document.refusal("drive.vehicle", rule).into());
            }
            Ok(Course::Charged(charge_a))
        }
        (Some(_), Some(_)) => {
            Err(document.refusal("drive.charge_a", "cannot stand beside `cycle`").into())
        }
        (None, None) => Err(document.refusal("drive", "needs `cycle` or `charge_a`").into()),
    }
}

/// A fault of the list, checked.
fn plant(document: &Document<'_>, index: usize, wrong: &Wrong) -> Result<Planted, InputError> {
    let refuse =
        |key: &str, rule: &str| Err(document.refusal(&format!("fault.{index}.{key}"), rule));
    let Wrong { kind, at_s, severity, amount, cell, sensor } = *wrong;
    if !(0.0..=LONGEST_S).contains(&at_s) {
        return refuse("at_s", "must lie in 0..36000");
    }
    let much = match (severity, amount) {
        (Some(_), Some(_)) => return refuse("amount", "cannot stand beside `severity`"),
        (Some(_), None) if !kind.has_amount() => return refuse("severity", NO_AMOUNT),
        (None, Some(_)) if !kind.has_amount() => return refuse("amount", NO_AMOUNT),
        (None, Some(much)) if much > 0.0 && much.is_finite() => much,
        (None, Some(_)) => return refuse("amount", "must be above 0"),
        (Some(level @ 1..=4), None) => kind.severities()[usize::from(level) - 1],
        (Some(_), None) => return refuse("severity", "must lie in 1..4"),
        (None, None) => kind.severities()[3],
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    let mut planted = Planted::new(kind, much, (at_s * 1000.0).round() as u32);
    let part = kind.part();
    for (key, given, of, count) in
        [("cell", cell, Part::Cell, CELLS), ("sensor", sensor, Part::Sensor, SENSORS)]
    {
        let Some(at) = given.map(usize::from) else { continue };
        if part != of {
            return refuse(key, "has no meaning for this fault");
        }
        if at >= count {
            return refuse(key, &format!("must lie in 0..{}", count - 1));
        }
        planted.at = at;
    }
    Ok(planted)
}

#[cfg(test)]
mod tests;
