//! What a file is, what is in it and what can be done with it: `voltstep check`.
//!
//! Each kind of file is read by its own reader, whose notes and doubts are repeated; of a table also
//! what each column was taken for.

use std::path::Path;

use serde::Serialize;
use voltstep_bms::manage::recorder::Recording;

use crate::read::cell::{self, CellRecord, Kind};
use crate::read::error::{self, InputError};
use crate::read::recognise::{FileKind, recognise};
use crate::read::table::{Column, Sheet, Table};
use crate::read::trip::{self, Trip};
use crate::read::{battery, cycle, netlist, profile, scenario, vehicle};

/// What was found in a file.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// Its path.
    pub file: String,
    /// What it is.
    pub kind: FileKind,
    /// By what it is known.
    pub known_by: &'static str,
    /// Of a table, what is in it.
    pub table: Option<TableFacts>,
    /// Of what is no table, in a few words.
    pub about: Vec<String>,
    /// What was assumed, repaired or not used.
    pub notes: Vec<String>,
    /// Why its figures cannot be trusted as they are.
    pub doubts: Vec<String>,
    /// What can be done with it.
    pub commands: Vec<String>,
}

/// Samples over time, and columns.
#[derive(Clone, Debug, Serialize)]
pub struct TableFacts {
    /// Samples.
    pub samples: usize,
    /// From the first to the last \[s\].
    pub duration_s: f64,
    /// Times between two samples \[s\]: the shortest, the usual (median), the longest.
    pub step_s: [f64; 3],
    /// Gaps: usual steps many times over.
    pub gaps: Vec<Gap>,
    /// What the columns are.
    pub columns: Vec<ColumnFacts>,
    /// Columns that are not used.
    pub unused: Vec<String>,
}

/// No samples for a while.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Gap {
    /// When it begins \[s\].
    pub at_s: f64,
    /// How long it is \[s\].
    pub for_s: f64,
}

/// A column: how it was taken, and its samples in SI units (charge in A·h, temperature in °C).
#[derive(Clone, Debug, Serialize)]
pub struct ColumnFacts {
    /// As its header is written.
    pub header: String,
    /// What it was taken for.
    pub quantity: &'static str,
    /// The unit that its numbers have.
    pub unit: &'static str,
    /// The unit that they are converted to.
    pub converted_to: &'static str,
    /// Samples without a number.
    pub missing: usize,
    /// The least.
    pub least: f64,
    /// The largest.
    pub largest: f64,
    /// The smallest change from one sample to the next: what the file resolves.
    pub resolution: f64,
}

/// Checks a file; a trip against a battery of `capacity_ah`.
///
/// # Errors
/// [`InputError`], or that of its reader, says why it cannot be read and what was looked for.
pub fn check(path: &Path, capacity_ah: f64) -> anyhow::Result<Checked> {
    let file = path.to_string_lossy().into_owned();
    let bytes = error::read(path)?;
    parse(&file, &bytes, capacity_ah)
}

/// The same of the bytes of a file called `file`.
///
/// # Errors
/// As [`check`].
pub fn parse(file: &str, bytes: &[u8], capacity_ah: f64) -> anyhow::Result<Checked> {
    let kind = recognise(file, bytes, &FileKind::ALL)?;
    let mut found = Findings::default();
    match kind {
        FileKind::Cycle => {
            let sheet = cycle::open(file, bytes)?;
            let columns = cycle::columns(&sheet.header);
            let (table, facts) = read(&sheet, &columns)?;
            let cycle = cycle::of_table(&sheet, table)?;
            let time_s: Vec<f64> = cycle.points.iter().map(|(t, _)| f64::from(*t)).collect();
            found.table = Some(facts.over(&time_s));
            found.notes = cycle.notes;
        }
        FileKind::Trip => {
            let sheet = trip::open(file, bytes)?;
            let (table, facts) = read(&sheet, &trip::COLUMNS)?;
            let trip = trip::of_table(&sheet, table);
            found = Findings::of_trip(&trip, capacity_ah);
            found.table = Some(facts.over(&trip.time_s));
        }
        FileKind::Cell => {
            let sheet = cell::open(file, bytes)?;
            let (table, facts) = read(&sheet, &cell::COLUMNS)?;
            let record = cell::of_table(&sheet, table)?;
            found = Findings::of_cell(&record);
            found.table = Some(facts.over(&record.time_s));
        }
        FileKind::Profile => {
            let sheet = profile::open(file, bytes)?;
            let (table, facts) = read(&sheet, &profile::COLUMNS)?;
            let profile = profile::of_table(&sheet, table)?;
            found.table = Some(facts.over(&profile.time_s));
            found.notes = profile.notes;
        }
        FileKind::Vehicle => {
            let vehicle = vehicle::parse(file, bytes)?;
            found.about = vec![vehicle.name, vehicle.description, vehicle.source];
        }
        FileKind::Battery => {
            let battery = battery::parse(file, bytes)?;
            found.about = vec![battery.name, battery.description, battery.source];
        }
        FileKind::Circuit => {
            let circuit = netlist::parse(file, bytes)?;
            let (elements, nodes) = (circuit.parts.len(), circuit.nodes.len());
            let size = format!("{elements} elements, {nodes} nodes, {} steps", circuit.steps);
            found.about = vec![circuit.name, circuit.description, size];
        }
        FileKind::Scenario => {
            scenario::parse(file, bytes)?;
        }
        FileKind::Recording => {
            let (cells, sensors) = Recording::read(bytes)
                .map_err(|error| InputError::of_file(file, error.to_string()))?
                .size();
            found.about = vec![format!("a pack of {cells} cells with {sensors} temperatures")];
        }
    }
    let Findings { table, about, notes, doubts } = found;
    Ok(Checked {
        commands: commands(kind, file),
        file: file.to_owned(),
        kind,
        known_by: kind.mark(),
        table,
        about,
        notes,
        doubts,
    })
}

/// What a reader says of a file.
#[derive(Default)]
struct Findings {
    table: Option<TableFacts>,
    about: Vec<String>,
    notes: Vec<String>,
    doubts: Vec<String>,
}

impl Findings {
    fn of_trip(trip: &Trip, capacity_ah: f64) -> Self {
        let doubts = trip.marked(capacity_ah);
        let mut notes = trip.notes.clone();
        notes.extend(trip.quirks(capacity_ah).into_iter().filter(|quirk| !doubts.contains(quirk)));
        Self { notes, doubts, ..Self::default() }
    }

    fn of_cell(record: &CellRecord) -> Self {
        let mut notes = record.notes.clone();
        let range = |values: &[f64]| {
            let of = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick);
            of(f64::max).zip(of(f64::min)).map_or(0.0, |(high, low)| high - low)
        };
        let spanned_ah = range(&record.discharged_ah);
        if spanned_ah > 0.0 {
            let (kind, why) = record.kind(spanned_ah);
            let kind = match kind {
                Kind::Sweep => "a slow sweep",
                Kind::Pulses => "pulses",
                Kind::Cycle => "a drive cycle",
            };
            let why = if why.is_empty() { why } else { format!(" ({why})") };
            notes.push(format!("by the {spanned_ah:.3} A·h that it spans, {kind}{why}"));
        }
        Self { notes, doubts: record.counter_fault().into_iter().collect(), ..Self::default() }
    }
}

/// A table as read, and what its columns hold.
fn read(sheet: &Sheet<'_>, columns: &[Column]) -> Result<(Table, Columns), InputError> {
    let bound = sheet.bind(columns)?;
    let table = sheet.read(columns)?;
    let seen = columns.iter().zip(&bound).zip(&table.columns);
    let seen = seen.filter_map(|((column, bound), values)| {
        let (bound, values) = (bound.as_ref()?, values.as_ref()?);
        let finite = || values.iter().copied().filter(|x| x.is_finite());
        let changes = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        Some(ColumnFacts {
            header: error::shown(&sheet.header[bound.place]),
            quantity: column.name,
            unit: bound.unit.name,
            converted_to: column.dimension.si(),
            missing: values.len() - finite().count(),
            least: finite().fold(f64::INFINITY, f64::min),
            largest: finite().fold(f64::NEG_INFINITY, f64::max),
            resolution: changes.filter(|change| *change > 1e-9).fold(f64::INFINITY, f64::min),
        })
    });
    let columns = Columns { columns: seen.collect(), unused: table.unused.clone() };
    Ok((table, columns))
}

/// What the columns of a table hold.
struct Columns {
    columns: Vec<ColumnFacts>,
    unused: Vec<String>,
}

impl Columns {
    /// With the times of the samples \[s\].
    fn over(self, time_s: &[f64]) -> TableFacts {
        let steps = cell::steps(time_s);
        let gap_s = cell::gap_s(time_s);
        let gaps = time_s.windows(2).filter(|t| t[1] - t[0] > gap_s);
        TableFacts {
            columns: self.columns,
            samples: time_s.len(),
            duration_s: time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first),
            step_s: [0, steps.len() / 2, steps.len().saturating_sub(1)]
                .map(|at| steps.get(at).copied().unwrap_or(f64::NAN)),
            gaps: gaps.map(|t| Gap { at_s: t[0], for_s: t[1] - t[0] }).collect(),
            unused: self.unused,
        }
    }
}

fn commands(kind: FileKind, file: &str) -> Vec<String> {
    let with: &[&str] = match kind {
        FileKind::Cycle | FileKind::Profile => &["replay {}"],
        FileKind::Trip => &[
            "replay {}",
            "replay {} --mode battery",
            "soc {}",
            "identify battery {}",
            "identify vehicle {}",
        ],
        FileKind::Cell => &["identify battery {}", "soc {} --cell BATTERY.toml"],
        FileKind::Vehicle => &["replay udds --vehicle {}"],
        FileKind::Battery => &["soc TEST.csv --cell {}"],
        FileKind::Circuit => &["circuit {}"],
        FileKind::Scenario => &["bms {}"],
        FileKind::Recording => &["rewind {}"],
    };
    let file = if file.contains(' ') { format!("'{file}'") } else { file.to_owned() };
    with.iter().map(|words| format!("voltstep {}", words.replace("{}", &file))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(file: &str, text: &str) -> Checked {
        parse(file, text.as_bytes(), 60.0).unwrap()
    }

    #[test]
    fn a_table_is_taken_apart() {
        let text = "time_ms;speed_km_h;grade_%;remark\n0;0;1,0;a\n1000;36;;b\n2000;36,5;1,5;c\n60000;0;0;d\n";
        let found = checked("a b.csv", text);
        assert_eq!(found.kind, FileKind::Cycle);
        let table = found.table.unwrap();
        assert_eq!((table.samples, table.duration_s, table.step_s), (4, 60.0, [1.0, 1.0, 58.0]));
        assert_eq!(table.unused, ["remark"]);
        assert_eq!(table.gaps.len(), 1);
        assert_eq!((table.gaps[0].at_s, table.gaps[0].for_s), (2.0, 58.0));
        let [time, speed, grade] = &table.columns[..] else { panic!("{:?}", table.columns) };
        assert_eq!((time.unit, time.converted_to), ("ms", "s"));
        assert_eq!((speed.header.as_str(), speed.unit, speed.missing), ("speed_km_h", "km/h", 0));
        assert!((speed.largest - 36.5 / 3.6).abs() < 1e-9, "{speed:?}");
        assert!((speed.resolution - 0.5 / 3.6).abs() < 1e-9, "{speed:?}");
        assert_eq!((grade.missing, grade.largest), (1, 0.015));
        assert_eq!(found.commands, ["voltstep replay 'a b.csv'"]);
        assert!(found.doubts.is_empty());
    }

    #[test]
    fn a_cycle_over_distance_has_the_times_of_its_speeds() {
        let table = checked("x", "distance_m,speed_m_s\n0,0\n10,2\n30,2\n").table.unwrap();
        assert_eq!((table.duration_s, table.step_s), (20.0, [10.0; 3]));
        assert_eq!((table.columns[0].unit, table.columns[0].largest), ("m", 30.0));
    }

    #[test]
    fn what_only_begins_like_a_recording_is_refused() {
        let refused = parse("x", b"VSRC\x01\0and so on", 60.0).unwrap_err().to_string();
        assert!(refused.starts_with("x: "), "{refused}");
    }

    #[test]
    fn a_reversed_current_is_a_doubt() {
        let rows = (0..200).map(|i| format!("{i},-2,3.7,{}\n", f64::from(i) * 2.0 / 3600.0));
        let text =
            format!("time_s,current_a,voltage_v,discharged_ah\n{}", rows.collect::<String>());
        let found = checked("c.csv", &text);
        assert_eq!((found.kind, found.doubts.len()), (FileKind::Cell, 1));
        assert!(found.doubts[0].contains("sign of the current is reversed"), "{:?}", found.doubts);
        let right = checked("c.csv", &text.replace(",-2,", ",2,"));
        assert!(right.doubts.is_empty(), "{:?}", right.doubts);
        assert!(
            right.notes.iter().any(|note| note.ends_with("a drive cycle")),
            "{:?}",
            right.notes
        );
    }

    #[test]
    fn parameters_circuits_and_scenarios_are_known() {
        for (text, kind, command) in [
            (
                include_str!("../../data/vehicles/bmw-i3-60ah.toml"),
                FileKind::Vehicle,
                "replay udds",
            ),
            (include_str!("../../data/batteries/bmw-i3-60ah.toml"), FileKind::Battery, "soc TEST"),
            (include_str!("../../../data/circuits/buck.toml"), FileKind::Circuit, "circuit x"),
            (
                "[start]\nsoc = 0.8\ntemperature_c = 30.0\n[drive]\ncharge_a = 20.0\nseconds = 9.0\n",
                FileKind::Scenario,
                "bms x",
            ),
        ] {
            let found = checked("x", text);
            assert_eq!(found.kind, kind);
            assert!(found.commands[0].contains(command), "{:?}", found.commands);
            assert!(found.table.is_none());
        }
        let refused = parse("x", b"[run]\nstep_s = 1\n", 60.0).unwrap_err();
        assert!(refused.to_string().starts_with("x:"), "{refused:#}");
    }
}
