//! From bytes to a [`Trip`].

use std::borrow::Cow;

use csv::{ByteRecord, ReaderBuilder, Terminator};

use super::Trip;
use crate::read::error::{self, InputError};

/// A file's column that is used.
struct Column {
    /// Its name, as far as the unit in brackets.
    name: &'static str,
    unit: &'static str,
    needed: Needed,
    /// Factor from the file's unit.
    factor: f64,
    /// What is not absurd, in the file's unit.
    range: (f64, f64),
}

/// How much of a column must be there.
#[derive(Clone, Copy, PartialEq)]
enum Needed {
    /// Every sample.
    Samples,
    /// The column; samples may be missing.
    Column,
    /// Nothing; this stands for a whole column.
    Nothing(f64),
    /// Nothing, and few files have it: that it is not there is no news.
    Spare,
}

const TIME: usize = 0;
const COLUMNS: [Column; 14] = [
    column("Time", "s", Needed::Samples, 1.0, (-1e9, 1e9)),
    column("Velocity", "km/h", Needed::Samples, 1.0 / 3.6, (-400.0, 400.0)),
    column("Elevation", "m", Needed::Samples, 1.0, (-1000.0, 10_000.0)),
    column("Motor Torque", "Nm", Needed::Nothing(f64::NAN), 1.0, (-1e5, 1e5)),
    column("Battery Voltage", "V", Needed::Samples, 1.0, (-2000.0, 2000.0)),
    column("Battery Current", "A", Needed::Samples, -1.0, (-5000.0, 5000.0)),
    column("Battery Temperature", "°C", Needed::Nothing(f64::NAN), 1.0, (-200.0, 1000.0)),
    column("SoC", "%", Needed::Column, 0.01, (0.0, 100.0)),
    column("Heating Power CAN", "kW", Needed::Nothing(0.0), 1e3, (-1e3, 1e3)),
    column("AirCon Power", "kW", Needed::Nothing(0.0), 1e3, (-1e3, 1e3)),
    column("Ambient Temperature", "°C", Needed::Nothing(f64::NAN), 1.0, (-200.0, 200.0)),
    column("Throttle", "%", Needed::Spare, 0.01, (-100.0, 1000.0)),
    column("Heating Power LIN", "W", Needed::Spare, 1.0, (-1e6, 1e6)),
    column("Requested Heating Power", "W", Needed::Spare, 1.0, (-1e6, 1e6)),
];

const fn column(
    name: &'static str,
    unit: &'static str,
    needed: Needed,
    factor: f64,
    range: (f64, f64),
) -> Column {
    Column { name, unit, needed, factor, range }
}

/// A header with more columns than this is not repeated in a message.
const LISTED: usize = 12;

/// Reads a trip from the bytes of a file called `file`.
///
/// # Errors
/// [`InputError`] with the line, and for a field the column: characters from 1 to where the field
/// starts. Refused are an empty file, a missing column, fewer than two rows, a row with another
/// number of fields than the header, text or NaN or infinity for a number, an empty field where
/// every sample is needed, absurd values, and time that does not rise.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Trip, InputError> {
    Source { file, bytes: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes) }.trip()
}

/// The bytes, and what is needed to say where in them something is wrong.
struct Source<'a> {
    file: &'a str,
    bytes: &'a [u8],
}

impl Source<'_> {
    fn trip(&self) -> Result<Trip, InputError> {
        if self.bytes.starts_with(b"\xff\xfe") || self.bytes.starts_with(b"\xfe\xff") {
            return Err(self.error("UTF-16: save the file as UTF-8 or Latin-1"));
        }
        // No quoting: names and numbers need none, and positions stay exact.
        let mut reader = ReaderBuilder::new()
            .delimiter(b';')
            .terminator(Terminator::Any(b'\n'))
            .quoting(false)
            .flexible(true)
            .has_headers(false)
            .from_reader(self.bytes);
        let mut record = ByteRecord::new();
        let mut next = move |record: &mut ByteRecord| loop {
            match reader.read_byte_record(record) {
                Ok(true) if is_blank(record) => {}
                other => return other.map_err(|e| self.error(format!("cannot be read: {e}"))),
            }
        };
        if !next(&mut record)? {
            return Err(self.error("the file is empty; expected a header and samples"));
        }
        let fields = record.len();
        let (places, notes) = self.places(&record)?;
        let rows = self.bytes.len() / record.as_slice().len().max(1) + 1;
        let mut values: [Vec<f64>; COLUMNS.len()] =
            std::array::from_fn(|_| Vec::with_capacity(rows));
        while next(&mut record)? {
            if record.len() != fields {
                let message =
                    format!("{} fields; expected {fields}, as in the header", record.len());
                return Err(self.error_at(&record, fields.min(record.len()), &message));
            }
            for ((column, place), values) in COLUMNS.iter().zip(places).zip(&mut values) {
                if let Some(place) = place {
                    values.push(self.sample(column, &record, place)?);
                }
            }
            if let ([.., before, now], Some(place)) = (values[TIME].as_slice(), places[TIME])
                && now <= before
            {
                let message = format!("time does not rise: {now} s after {before} s");
                return Err(self.error_at(&record, place, &message));
            }
        }
        let rows = values[TIME].len();
        if rows < 2 {
            return Err(self.error(format!("{rows} samples; expected two at least")));
        }
        for (column, values) in COLUMNS.iter().zip(&mut values) {
            match column.needed {
                Needed::Nothing(absent) if values.is_empty() => values.resize(rows, absent),
                Needed::Spare if values.is_empty() => values.resize(rows, f64::NAN),
                _ => {}
            }
        }
        let mut values = values.into_iter();
        let mut next = || values.next().unwrap_or_default();
        // In the order of the columns.
        Ok(Trip {
            name: error::stem(self.file),
            time_s: next(),
            speed_m_s: next(),
            elevation_m: next(),
            motor_torque_nm: next(),
            battery_v: next(),
            battery_a: next(),
            battery_c: next(),
            soc: next(),
            heating_w: next(),
            aircon_w: next(),
            ambient_c: next(),
            throttle: next(),
            heating_lin_w: next(),
            heating_requested_w: next(),
            notes,
        })
    }

    /// Where each column is; what is not there, in words.
    fn places(
        &self,
        header: &ByteRecord,
    ) -> Result<([Option<usize>; COLUMNS.len()], Vec<String>), InputError> {
        let found: Vec<String> = header.iter().map(name_of).collect();
        let mut places = [None; COLUMNS.len()];
        let mut notes = Vec::new();
        for (Column { name, unit, needed, .. }, place) in COLUMNS.iter().zip(&mut places) {
            *place = found.iter().position(|n| n.eq_ignore_ascii_case(name));
            match needed {
                _ if place.is_some() => {}
                Needed::Spare => {}
                Needed::Nothing(absent) if absent.is_nan() => {
                    notes.push(format!("no column `{name} [{unit}]`"));
                }
                Needed::Nothing(_) => {
                    notes.push(format!("no column `{name} [{unit}]`, taken as 0"));
                }
                _ => {
                    let found = instead_of(name, &found);
                    let message = format!("no column `{name} [{unit}]`; {found}");
                    return Err(self.error_at(header, 0, &message));
                }
            }
        }
        Ok((places, notes))
    }

    /// One sample, in SI units.
    #[inline]
    fn sample(
        &self,
        column: &Column,
        record: &ByteRecord,
        place: usize,
    ) -> Result<f64, InputError> {
        let field = record[place].trim_ascii();
        let (low, high) = column.range;
        match number(field) {
            Some(value) if (low..=high).contains(&value) => Ok(value * column.factor),
            None if field.is_empty() && column.needed != Needed::Samples => Ok(f64::NAN),
            bad => {
                let Column { name, unit, .. } = column;
                let shown = error::shown(&decoded(field));
                let message = if field.is_empty() {
                    format!("{name} is empty; expected a number")
                } else if bad.is_some() {
                    format!("{name} of {shown} {unit}; expected {low} to {high} {unit}")
                } else if field.contains(&b',') {
                    format!("`{shown}` for {name}; expected a number with a decimal point")
                } else {
                    format!("`{shown}` for {name}; expected a number")
                };
                Err(self.error_at(record, place, &message))
            }
        }
    }

    fn error(&self, message: impl Into<String>) -> InputError {
        InputError::of_file(self.file, message)
    }

    /// An error at the start of a field, or at the end of a record without it. Counts from the bytes: blank lines move the reader's own
    /// count.
    #[cold]
    fn error_at(&self, record: &ByteRecord, place: usize, message: &str) -> InputError {
        let start = record.position().map_or(0, csv::Position::byte);
        let mut start = usize::try_from(start).unwrap_or(0).min(self.bytes.len());
        start += self.bytes[start..].iter().take_while(|b| **b == b'\n').count();
        let line = self.bytes[..start].split(|b| *b == b'\n').count();
        let all = record.as_slice().trim_ascii_end().len() + record.len().saturating_sub(1);
        let into = record.range(place).map_or(all, |r| r.start + place);
        let before = self.bytes.get(start..start + into).unwrap_or_default();
        InputError {
            line: u64::try_from(line).ok(),
            column: u64::try_from(decoded(before).chars().count() + 1).ok(),
            ..self.error(message)
        }
    }
}

fn is_blank(record: &ByteRecord) -> bool {
    record.as_slice().trim_ascii().is_empty() && record.len() <= 1
}

/// A number that is finite as it stands.
#[inline]
fn number(field: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(field).ok()?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// UTF-8 where it is, Latin-1 else.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    std::str::from_utf8(bytes)
        .map_or_else(|_| bytes.iter().map(|b| char::from(*b)).collect(), Cow::Borrowed)
}

/// The name of a column: what is before the unit.
fn name_of(field: &[u8]) -> String {
    let text = decoded(field);
    text.split('[').next().unwrap_or_default().trim().to_owned()
}

/// What a header has instead of `name`.
fn instead_of(name: &str, found: &[String]) -> String {
    let shown: Vec<_> = found.iter().map(|n| error::shown(n)).collect();
    let listed = || error::listed(shown.iter().map(String::as_str));
    match (found.len(), error::nearest(name, found.iter().map(String::as_str))) {
        (1, _) => format!("found only {}; columns are separated by `;`", listed()),
        (2..=LISTED, _) => format!("found {}", listed()),
        (_, Some(near)) => format!("found `{}`", error::shown(near)),
        (n, None) => format!("found none like it among {n} columns"),
    }
}
