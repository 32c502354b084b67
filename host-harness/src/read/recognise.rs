//! What a file is: the one place that decides it, by what stands at its head.

use serde::Serialize;
use voltstep_bms::manage::recorder::MAGIC;

use crate::read::error::{self, InputError};
use crate::read::table::{Sheet, has};
use crate::read::{cell, cycle, profile, trip};

/// What a file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FileKind {
    /// A driving cycle: speed over time.
    Cycle,
    /// A trip that a car recorded.
    Trip,
    /// A test of one cell.
    Cell,
    /// A load of a battery alone.
    Profile,
    /// A vehicle's parameters.
    Vehicle,
    /// A battery's parameters.
    Battery,
    /// A circuit and how it is run.
    Circuit,
    /// A drive or charge of a managed pack, and what goes wrong on it.
    Scenario,
    /// What a BMS was given.
    Recording,
}

impl FileKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Cycle,
        Self::Trip,
        Self::Cell,
        Self::Profile,
        Self::Vehicle,
        Self::Battery,
        Self::Circuit,
        Self::Scenario,
        Self::Recording,
    ];

    /// In words.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Cycle => "driving cycle",
            Self::Trip => "trip",
            Self::Cell => "test of a cell",
            Self::Profile => "profile of current or power",
            Self::Vehicle => "vehicle",
            Self::Battery => "battery",
            Self::Circuit => "circuit",
            Self::Scenario => "scenario of a BMS",
            Self::Recording => "recording of a BMS",
        }
    }

    /// By what it is known.
    pub(crate) const fn mark(self) -> &'static str {
        match self {
            Self::Cycle => "columns `time_s` or `distance_m`, and `speed_m_s` or `speed_km_h`",
            Self::Trip => "columns `Time [s]`, `Velocity [km/h]`, `Battery Voltage [V]`, …",
            Self::Cell => "columns `time_s`, `current_a`, `voltage_v`, …",
            Self::Profile => "columns `time_s`, and `current_a` or `power_w`, without a voltage",
            Self::Vehicle => "TOML with [body]",
            Self::Battery => "TOML with [battery.open_circuit]",
            Self::Circuit => "TOML with [run]",
            Self::Scenario => "TOML with [start] and [drive]",
            Self::Recording => "begins with `VSRC`",
        }
    }
}

/// What the file called `file` is, which must be one of `wanted`.
///
/// # Errors
/// [`InputError`] lists what was looked for: an empty file, one that is none of the kinds, one
/// that is another kind than wanted.
pub fn recognise(file: &str, bytes: &[u8], wanted: &[FileKind]) -> Result<FileKind, InputError> {
    let looked_for = || {
        let each = wanted.iter().map(|kind| format!("a {} ({})", kind.name(), kind.mark()));
        each.collect::<Vec<_>>().join(" or ")
    };
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let at_line = |line: usize, message: String| InputError {
        line: u64::try_from(line + 1).ok(),
        column: Some(1),
        ..InputError::of_file(file, message)
    };
    if bytes.starts_with(&MAGIC) && wanted.contains(&FileKind::Recording) {
        return Ok(FileKind::Recording);
    }
    let mut lines = bytes.split(|byte| *byte == b'\n').enumerate();
    let Some((line, first)) = lines.find(|(_, line)| !is_blank(line)) else {
        return Err(at_line(0, format!("empty file: expected {}", looked_for())));
    };
    let found = if is_toml(first) { of_toml(bytes) } else { of_table(file, bytes)? };
    match found {
        Some(kind) if wanted.contains(&kind) => Ok(kind),
        Some(kind) => {
            Err(at_line(line, format!("this is a {}; expected {}", kind.name(), looked_for())))
        }
        None => {
            error::text(file, bytes)?;
            Err(at_line(line, format!("not recognised; expected {}", looked_for())))
        }
    }
}

/// A table of TOML, or a key with its value: no header of columns.
fn is_toml(first: &[u8]) -> bool {
    first.trim_ascii().first() == Some(&b'[') || first.contains(&b'=')
}

/// Blank, or a comment of TOML.
fn is_blank(line: &[u8]) -> bool {
    matches!(line.trim_ascii().first(), None | Some(b'#'))
}

/// What a circuit's and a scenario's file has.
const CIRCUIT_ONLY: &str = "run]";
const SCENARIO_ONLY: &str = "start]";
/// What a vehicle's file has and a battery's has not.
const VEHICLE_ONLY: [&str; 5] = ["body", "wheel", "gearbox", "motor", "initial_soc"];

/// What a table is, by its columns; only half of them are one, too: what it lacks is said where
/// it is read.
///
/// # Errors
/// Text in an encoding that nobody here reads.
fn of_table(file: &str, bytes: &[u8]) -> Result<Option<FileKind>, InputError> {
    let header = Sheet::open(file, bytes, is_header)?.header;
    Ok(match (has(&cycle::COLUMNS[1], &header), electric(&header)) {
        (true, true) => Some(FileKind::Trip),
        (false, true) if measures_voltage(&header) => Some(FileKind::Cell),
        (false, _) if profile::is_load(&header) => Some(FileKind::Profile),
        (false, true) => Some(FileKind::Cell),
        (true, false) => Some(FileKind::Cycle),
        (false, false) => timed(&header).then_some(FileKind::Cycle),
    })
}

/// Whether a line is the header of any of the tables.
fn is_header(header: &[String]) -> bool {
    timed(header)
        && (has(&cycle::COLUMNS[1], header) || electric(header) || profile::is_load(header))
}

fn measures_voltage(header: &[String]) -> bool {
    has(&cell::COLUMNS[2], header) || has(&trip::COLUMNS[4], header)
}

fn electric(header: &[String]) -> bool {
    let of_cell = cell::COLUMNS[1..4].iter().any(|column| has(column, header));
    of_cell || trip::COLUMNS[4..6].iter().any(|column| has(column, header))
}

fn timed(header: &[String]) -> bool {
    [&cycle::COLUMNS[0], &cell::COLUMNS[0], &cycle::DISTANCE].iter().any(|c| has(c, header))
}

fn of_toml(bytes: &[u8]) -> Option<FileKind> {
    // A table, or a key of it that is written out. Half a file is one, too: what it lacks is said
    // where it is read.
    let holds = |table: &str| {
        bytes.split(|byte| *byte == b'\n').any(|line| {
            let line = line.trim_ascii_start();
            line.strip_prefix(b"[").unwrap_or(line).starts_with(table.as_bytes())
        })
    };
    if holds(CIRCUIT_ONLY) {
        Some(FileKind::Circuit)
    } else if holds(SCENARIO_ONLY) {
        Some(FileKind::Scenario)
    } else if VEHICLE_ONLY.iter().any(|table| holds(table)) {
        Some(FileKind::Vehicle)
    } else {
        holds("battery").then_some(FileKind::Battery)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VEHICLE: &str = include_str!("../../data/vehicles/bmw-i3-60ah.toml");
    const BATTERY: &str = include_str!("../../data/batteries/bmw-i3-60ah.toml");
    const TRIP: &[u8] = include_bytes!("../../data/trips/synthetic.csv");
    const CELL: &str =
        "voltage_v, \"time_s\",current_a,discharged_ah,cell_temperature_c\n4,0,1,0,25\n";

    #[test]
    fn knows_each_kind_and_refuses_it_where_another_is_wanted() {
        let cycle = "\u{feff}\n\ntime_s,speed_m_s\n0,0\n";
        for (bytes, kind) in [
            (cycle.as_bytes(), FileKind::Cycle),
            (b"time_s,speed_ms\n", FileKind::Cycle),
            (b"\"speed_m_s\", \"time_s\"\n", FileKind::Cycle),
            (b"motor.inertia_kg_m2 = 1\n", FileKind::Vehicle),
            (b"battery = { capacity_ah = 3 }\n", FileKind::Battery),
            (TRIP, FileKind::Trip),
            (b"Time [s];Velocity;Battery Current [A]\n", FileKind::Trip),
            (b"Time [s];Velocity [km/h]\n", FileKind::Cycle),
            (b"\xef\xbb\xbftime_s;speed_m_s\r\n0;0,0\r\n", FileKind::Cycle),
            (b"made by\nsome cycler\n\nTest_Time(s)\tCurrent(A)\tVoltage(V)\n", FileKind::Cell),
            (CELL.as_bytes(), FileKind::Cell),
            (b"time_s,current_a\n", FileKind::Profile),
            (b"time_s,power_kw,remark\n", FileKind::Profile),
            (b"time_s,voltage_v\n", FileKind::Cell),
            (VEHICLE.as_bytes(), FileKind::Vehicle),
            (BATTERY.as_bytes(), FileKind::Battery),
            (b"name = 'x'\n[run]\n", FileKind::Circuit),
            (b"[start]\nsoc = 1\n[drive]\ncycle = 'udds'\n", FileKind::Scenario),
            (b"VSRC\x01\0", FileKind::Recording),
        ] {
            assert_eq!(recognise("x", bytes, &FileKind::ALL), Ok(kind));
            let others = FileKind::ALL.map(|k| if k == kind { FileKind::ALL[0] } else { k });
            if kind != FileKind::ALL[0] {
                let error = recognise("x", bytes, &others).unwrap_err();
                // Bytes that begin like a recording are no text of another kind.
                if kind == FileKind::Recording {
                    continue;
                }
                assert!(
                    error.message.starts_with(&format!("this is a {}; expected ", kind.name()))
                );
                assert!(error.line.is_some() && error.column == Some(1), "{error}");
            }
        }
    }

    #[test]
    fn says_what_it_looked_for() {
        let wanted = [FileKind::Cycle, FileKind::Trip];
        let refused = |bytes: &[u8]| recognise("x", bytes, &wanted).unwrap_err().to_string();
        let expected = "expected a driving cycle (columns `time_s` or `distance_m`, and `speed_m_s` or `speed_km_h`) \
                        or a trip (columns `Time [s]`, `Velocity [km/h]`, `Battery Voltage [V]`, …)";
        assert_eq!(refused(b""), format!("x:1:1: empty file: {expected}"));
        assert_eq!(refused(b"\n# a comment\n\n"), format!("x:1:1: empty file: {expected}"));
        let unknown = format!("not recognised; {expected}");
        assert_eq!(refused(b"\n\n0,0\n1,1\n"), format!("x:3:1: {unknown}"));
        assert_eq!(refused(b"key = 1\n"), format!("x:1:1: {unknown}"));
        assert_eq!(
            refused(CELL.as_bytes()),
            format!("x:1:1: this is a test of a cell; {expected}")
        );
        let utf_16 = "x: UTF-16: save the file as UTF-8 or Latin-1";
        assert_eq!(refused(b"\xff\xfet\0i\0m\0e\0"), utf_16);
        assert_eq!(refused(b"\x7fELF\n\xff\xfe"), "x:2:1: not a text: expected UTF-8");
    }
}
