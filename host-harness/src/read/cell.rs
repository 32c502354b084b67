//! A measured test of one cell: current, voltage, charge and temperature over time.
//!
//! [`parse`] reads comma separated columns, found by their names in any order:
//! `time_s,current_a,voltage_v,discharged_ah,cell_temperature_c` and, where it was measured,
//! `chamber_temperature_c`; current positive when discharging.

use crate::read::error::{self, InputError, shown, stem};

/// Samples further apart than this are a gap: what happened in between was not logged \[s\].
pub const GAP_S: f64 = 5.0;

/// A drive cycle is sampled at least this often \[s\] …
const CYCLE_SAMPLING_S: f64 = 2.0;
/// … and logged whole, but for this share of the capacity.
const UNLOGGED: f64 = 0.01;

/// What kind of test a record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Slow, and sampled slowly: it tells the open-circuit voltage and the capacity.
    Sweep,
    /// Pulses with rests; what flowed in between was not logged.
    Pulses,
    /// A drive cycle, logged whole.
    Cycle,
}

/// What a test bench recorded, a row per sample. Time rises from row to row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellRecord {
    /// The file's name without its extension.
    pub name: String,
    /// Time \[s\].
    pub time_s: Vec<f64>,
    /// Current \[A\], positive when discharging.
    pub current_a: Vec<f64>,
    /// Voltage \[V\].
    pub voltage_v: Vec<f64>,
    /// The bench's own charge counter \[A·h\], rising when discharging.
    pub discharged_ah: Vec<f64>,
    /// Temperature of the cell \[°C\].
    pub cell_c: Vec<f64>,
    /// Temperature of the chamber \[°C\]; NaN where it was not measured.
    pub chamber_c: Vec<f64>,
}

impl CellRecord {
    /// The state of charge at sample `i` for a cell of `capacity_ah` that was full where the
    /// counter was 0.
    #[must_use]
    pub fn soc(&self, i: usize, capacity_ah: f64) -> f64 {
        1.0 - self.discharged_ah.get(i).copied().unwrap_or(f64::NAN) / capacity_ah
    }

    /// The median time between two samples \[s\].
    #[must_use]
    pub fn sampling_s(&self) -> f64 {
        let mut steps: Vec<f64> = self.time_s.windows(2).map(|t| t[1] - t[0]).collect();
        steps.sort_unstable_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// What kind of test it is, for a cell of `capacity_ah`; and for what is no drive cycle, why.
    #[must_use]
    pub fn kind(&self, capacity_ah: f64) -> (Kind, String) {
        let sampling_s = self.sampling_s();
        let unlogged = self.unlogged_ah() / capacity_ah;
        if sampling_s > CYCLE_SAMPLING_S {
            (Kind::Sweep, format!("sampled every {sampling_s:.0} s"))
        } else if unlogged > UNLOGGED {
            let percent = 100.0 * unlogged;
            (Kind::Pulses, format!("{percent:.0} % of the capacity flowed within gaps"))
        } else {
            (Kind::Cycle, String::new())
        }
    }

    /// The current at each sample as it was `delay_s` before, linear between samples \[A\].
    #[must_use]
    pub fn delayed_a(&self, delay_s: f64) -> Vec<f64> {
        delayed(&self.time_s, &self.current_a, delay_s)
    }

    /// The charge that the counter moved by within gaps \[A·h\], without its sign.
    #[must_use]
    pub fn unlogged_ah(&self) -> f64 {
        let steps = self.time_s.windows(2).zip(self.discharged_ah.windows(2));
        steps.filter(|(t, _)| t[1] - t[0] > GAP_S).map(|(_, q)| (q[1] - q[0]).abs()).sum()
    }
}

/// Values at each time as they were `delay_s` before, linear between samples.
pub(crate) fn delayed(time_s: &[f64], values: &[f64], delay_s: f64) -> Vec<f64> {
    let Some(&start_s) = time_s.first() else { return Vec::new() };
    let mut before = 0;
    let early = |t: &f64| {
        let wanted_s = (t - delay_s).max(start_s);
        while before + 2 < time_s.len() && time_s[before + 1] <= wanted_s {
            before += 1;
        }
        let along = (wanted_s - time_s[before]) / (time_s[before + 1] - time_s[before]);
        values[before] + along * (values[before + 1] - values[before])
    };
    time_s.iter().map(early).collect()
}

/// Names of the columns; the last may be missing.
pub(crate) const COLUMNS: [&str; 6] = [
    "time_s",
    "current_a",
    "voltage_v",
    "discharged_ah",
    "cell_temperature_c",
    "chamber_temperature_c",
];
const CHAMBER: usize = 5;
/// What is not absurd.
const RANGES: [(f64, f64); 6] =
    [(-1e9, 1e9), (-1e4, 1e4), (-10.0, 2000.0), (-1e5, 1e5), (-100.0, 200.0), (-100.0, 200.0)];

/// Reads a test from the bytes of a file called `file`.
///
/// # Errors
/// [`InputError`] with line and column: a missing column, fewer than two rows, a row with another
/// number of fields than the header, what is no number or absurd, time that does not rise.
pub fn parse(file: &str, bytes: &[u8]) -> Result<CellRecord, InputError> {
    let text = error::text(file, bytes)?;
    let mut lines = Lines { text, offset: 0 };
    let Some((_, header)) = lines.next() else {
        return Err(InputError::of_file(file, "the file is empty; expected a header and samples"));
    };
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    let mut places = [None; COLUMNS.len()];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = names.iter().position(|n| *n == name);
        if place.is_none() && name != COLUMNS[CHAMBER] {
            let message = format!("no column `{name}`; expected {}", COLUMNS.join(","));
            return Err(InputError::at(file, text, 0, message));
        }
    }
    let mut columns: [Vec<f64>; COLUMNS.len()] = Default::default();
    let mut before_s = f64::NEG_INFINITY;
    for (start, line) in lines {
        let fields: Vec<&str> = line.split(',').collect();
        if fields.len() != names.len() {
            let (found, expected) = (fields.len(), names.len());
            let message = format!("{found} fields; expected {expected}, as in the header");
            return Err(InputError::at(file, text, start, message));
        }
        for (k, column) in columns.iter_mut().enumerate() {
            let Some(place) = places[k] else {
                column.push(f64::NAN);
                continue;
            };
            let offset = start + fields[..place].iter().map(|f| f.len() + 1).sum::<usize>();
            let value = number(fields[place], k)
                .map_err(|message| InputError::at(file, text, offset, message))?;
            if k == 0 {
                if value <= before_s {
                    let message = format!("time must rise, found {value} after {before_s}");
                    return Err(InputError::at(file, text, offset, message));
                }
                before_s = value;
            }
            column.push(value);
        }
    }
    let [time_s, current_a, voltage_v, discharged_ah, cell_c, chamber_c] = columns;
    if time_s.len() < 2 {
        return Err(InputError::of_file(file, "fewer than two samples"));
    }
    Ok(CellRecord {
        name: stem(file),
        time_s,
        current_a,
        voltage_v,
        discharged_ah,
        cell_c,
        chamber_c,
    })
}

fn number(field: &str, column: usize) -> Result<f64, String> {
    let field = field.trim();
    let value: f64 = field
        .parse()
        .map_err(|_| format!("{}: expected a number, found `{}`", COLUMNS[column], shown(field)))?;
    if column == CHAMBER && value.is_nan() {
        return Ok(value);
    }
    let (low, high) = RANGES[column];
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(format!("{}: {value} is not in {low}..{high}", COLUMNS[column]))
    }
}

/// Lines that are not blank, with the offset where each starts.
struct Lines<'a> {
    text: &'a str,
    offset: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let rest = self.text.get(self.offset..).filter(|rest| !rest.is_empty())?;
            let start = self.offset;
            let line = rest.split('\n').next().unwrap_or(rest);
            self.offset += line.len() + 1;
            let line = line.trim_end_matches('\r');
            if !line.trim().is_empty() {
                return Some((start, line));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "time_s,current_a,voltage_v,discharged_ah,cell_temperature_c,chamber_temperature_c\n\
        0.0,1.0,4.1,0.0,25.0,nan\n0.1,2.0,4.0,0.0003,25.1,25.0\n\n60.1,0,4.05,0.1003,25,25\n";

    #[test]
    fn reads_columns_by_name() {
        let record = parse("a/b.csv", TEXT.as_bytes()).unwrap();
        assert_eq!((record.name.as_str(), record.time_s.len()), ("b", 3));
        assert_eq!(record.current_a, [1.0, 2.0, 0.0]);
        assert!(record.chamber_c[0].is_nan() && record.chamber_c[1] == 25.0);
        assert!((record.soc(2, 2.0) - 0.94985).abs() < 1e-12);
        assert!((record.unlogged_ah() - 0.1).abs() < 1e-12);
        assert_eq!(record.sampling_s(), 60.0);
        let fewer = TEXT.replace(",chamber_temperature_c", "").replace(",nan", "");
        let fewer = fewer.replace("25.1,25.0", "25.1").replace("25,25", "25");
        assert!(parse("b.csv", fewer.as_bytes()).unwrap().chamber_c[1].is_nan());
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (from, to, expected) in [
            ("2.0,4.0", "two,4.0", "x.csv:3:5: current_a: expected a number, found `two`"),
            ("25.1,25.0", "nan,25.0", "x.csv:3:20: cell_temperature_c: NaN is not in -100..200"),
            ("0.1,2.0", "0.0,2.0", "x.csv:3:1: time must rise, found 0 after 0"),
            ("25.1,25.0", "25.1", "x.csv:3:1: 5 fields; expected 6, as in the header"),
            ("voltage_v", "volts", "x.csv:1:1: no column `voltage_v`; expected time_s"),
        ] {
            let error = parse("x.csv", TEXT.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(error.to_string().starts_with(expected), "{error}");
        }
        assert!(parse("x.csv", b"").unwrap_err().message.contains("empty"));
        let header = TEXT.lines().next().unwrap();
        assert!(parse("x.csv", header.as_bytes()).unwrap_err().message.contains("fewer than two"));
    }
}
