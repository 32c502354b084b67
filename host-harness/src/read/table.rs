//! The one reader of tables: separated columns with a header, whoever wrote them.
//!
//! Commas, semicolons or tabs between fields, decimal points or decimal commas, quotes, blank
//! lines, separators at the end of a line, lines before the header; columns by their names in any
//! order, with their units converted.

use std::borrow::Cow;

use csv::{ByteRecord, ReaderBuilder};

use crate::read::error::{self, InputError};
use crate::read::stamp::{Clock, count_from_first, merge_equal};
use crate::read::unit::{Dimension, Unit, is_unit};

/// A column that is looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    /// Its name in messages.
    pub(crate) name: &'static str,
    /// Its names, in small letters with `_` for what is no letter; before a unit.
    pub(crate) names: &'static [&'static str],
    pub(crate) dimension: Dimension,
    /// Its unit where the header says none.
    pub(crate) unit: &'static str,
    pub(crate) needed: Needed,
    /// What is not absurd, in that unit.
    pub(crate) range: (f64, f64),
}

/// How much of a column must be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needed {
    /// Every sample.
    Samples,
    /// The column; samples may be missing.
    Column,
    /// Nothing.
    Nothing,
}

/// Where a column stands, and its unit there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bound {
    pub(crate) place: usize,
    pub(crate) unit: Unit,
}

/// What was read: SI units, time from 0 and rising.
#[derive(Debug)]
pub(crate) struct Table {
    /// Of each column that was looked for, its samples, NaN where missing.
    pub(crate) columns: Vec<Option<Vec<f64>>>,
    /// Names of columns that were not used.
    pub(crate) unused: Vec<String>,
    /// What was assumed or repaired, in words.
    pub(crate) notes: Vec<String>,
}

/// The header lies within so many lines of the start.
const HEADER_LINES: usize = 60;
/// A header with more columns than this is not repeated in a message.
const LISTED: usize = 12;

/// A file whose header was found.
pub(crate) struct Sheet<'a> {
    pub(crate) file: &'a str,
    text: Cow<'a, str>,
    separator: u8,
    /// Where the header starts.
    start: usize,
    /// The header's fields.
    pub(crate) header: Vec<String>,
}

impl<'a> Sheet<'a> {
    /// Finds the header: the first line that `is_header` takes, or else the first that is not
    /// blank.
    ///
    /// # Errors
    /// An empty file, one that is no text.
    pub(crate) fn open(
        file: &'a str,
        bytes: &'a [u8],
        is_header: impl Fn(&[String]) -> bool,
    ) -> Result<Self, InputError> {
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            let message = "UTF-16: save the file as UTF-8 or Latin-1";
            return Err(InputError::of_file(file, message));
        }
        let text = decoded(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes));
        let mut offset = 0;
        let mut first = None;
        for line in text.split_inclusive('\n').take(HEADER_LINES) {
            let start = offset;
            offset += line.len();
            if line.trim().is_empty() {
                continue;
            }
            let separator = separator_of(line);
            let header = fields(line, separator);
            let found = is_header(&header);
            if found || first.is_none() {
                first = Some((start, separator, header));
            }
            if found {
                break;
            }
        }
        let Some((start, separator, header)) = first else {
            let message = "the file is empty; expected a header and samples";
            return Err(InputError::of_file(file, message));
        };
        Ok(Self { file, text, separator, start, header })
    }

    /// An error at a field of the header.
    pub(crate) fn header_error(&self, place: usize, message: impl Into<String>) -> InputError {
        let rows = &self.text[self.start..];
        let offset = self.start + field_offset(rows, place, self.separator);
        InputError::at(self.file, &self.text, offset, message)
    }

    /// Where each column stands.
    ///
    /// # Errors
    /// One that is needed is not there, is there twice, or has a unit that is not known.
    pub(crate) fn bind(&self, columns: &[Column]) -> Result<Vec<Option<Bound>>, InputError> {
        columns.iter().map(|column| self.bind_one(column)).collect()
    }

    fn bind_one(&self, column: &Column) -> Result<Option<Bound>, InputError> {
        let mut unknown = None;
        for (place, (_, found)) in matches(column, &self.header) {
            match found {
                Found::Unit(unit) => {
                    let same = |other: &String| other.eq_ignore_ascii_case(&self.header[place]);
                    let second = self.header.iter().skip(place + 1).position(same);
                    if let Some(more) = second.filter(|_| column.needed == Needed::Samples) {
                        let message =
                            format!("second column `{}`", error::shown(&self.header[place]));
                        return Err(self.header_error(place + 1 + more, message));
                    }
                    return Ok(Some(Bound { place, unit }));
                }
                Found::Unknown { text, in_brackets } => {
                    if in_brackets || column.needed != Needed::Nothing || is_unit(&text) {
                        unknown = unknown.or(Some((place, text)));
                    }
                }
            }
        }
        if let Some((place, text)) = unknown {
            let header = &self.header[place];
            let near = error::nearest(header, [column.name]).filter(|near| near.contains('_'));
            let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            let message = format!(
                "unknown unit `{}` of column `{}`; expected {}{near}",
                error::shown(&text),
                error::shown(header),
                column.dimension.units()
            );
            return Err(self.header_error(place, message));
        }
        if column.needed == Needed::Nothing {
            return Ok(None);
        }
        let label = column.label();
        let message = format!("no column `{label}`; {}", self.instead_of(&label));
        Err(self.header_error(0, message))
    }

    /// What the header has instead of a column.
    fn instead_of(&self, label: &str) -> String {
        let names: Vec<String> = self.header.iter().map(|field| split(field).0).collect();
        let shown: Vec<String> = names.iter().map(|n| error::shown(n)).collect();
        let listed = || error::listed(shown.iter().map(String::as_str));
        match (names.len(), error::nearest(&split(label).0, names.iter().map(String::as_str))) {
            (1..=LISTED, _) => format!("found {}", listed()),
            (_, Some(near)) => format!("found `{}`", error::shown(near)),
            (n, None) => format!("found none like it among {n} columns"),
        }
    }

    /// Reads the samples. A first column that is a time is made to rise from 0.
    ///
    /// # Errors
    /// [`InputError`] with line and column: a row with another number of fields than the header, what
    /// is no number or absurd, an empty field where every sample is needed, time that falls, fewer
    /// than two samples.
    pub(crate) fn read(&self, columns: &[Column]) -> Result<Table, InputError> {
        let bound = self.bind(columns)?;
        let width = self.header.iter().rposition(|f| !f.trim().is_empty()).map_or(0, |i| i + 1);
        let mut reader = ReaderBuilder::new()
            .delimiter(self.separator)
            .flexible(true)
            .has_headers(false)
            .from_reader(self.text[self.start..].as_bytes());
        let mut record = ByteRecord::new();
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
        let mut style = Style::default();
        let timed = columns.first().is_some_and(|c| c.dimension == Dimension::Time);
        let mut clock = Clock::default();
        let mut is_header = true;
        let (mut line, mut counted) = (1, 0);
        loop {
            match reader.read_byte_record(&mut record) {
                Ok(false) => break,
                Ok(true) => {}
                Err(e) => {
                    return Err(InputError::of_file(self.file, format!("cannot be read: {e}")));
                }
            }
            if record.iter().all(|field| field.trim_ascii().is_empty()) {
                continue;
            }
            if std::mem::take(&mut is_header) {
                continue;
            }
            let spare = |field: &[u8]| field.trim_ascii().is_empty();
            if record.len() < width || record.iter().skip(self.header.len()).any(|f| !spare(f)) {
                let message =
                    format!("{} fields; expected {width}, as in the header", record.len());
                return Err(self.error(&record, width.min(record.len()), message));
            }
            for (k, (column, bound)) in columns.iter().zip(&bound).enumerate() {
                let Some(bound) = bound else { continue };
                let value = if k == 0 && timed {
                    let at = self.start_of(&record);
                    line += self.text[counted..at].matches('\n').count();
                    counted = at;
                    let field = error::shown(&String::from_utf8_lossy(&record[bound.place]));
                    let number = style.number(&record[bound.place]).ok();
                    let number = number.filter(|_| !field.is_empty()).map(|n| bound.unit.si(n));
                    clock
                        .read(&field, number, line)
                        .map_err(|message| self.error(&record, bound.place, message))?
                } else {
                    self.sample(column, *bound, &record, &mut style)?
                };
                values[k].push(value);
            }
        }
        let mut notes = Vec::new();
        if timed && bound[0].is_some() {
            count_from_first(&mut values[0]);
            notes.extend(clock.notes());
            notes.extend(merge_equal(&mut values));
        }
        let rows = values.iter().map(Vec::len).max().unwrap_or(0);
        if rows < 2 {
            let message = format!("{rows} samples; expected two at least");
            return Err(InputError::of_file(self.file, message));
        }
        let used = |place: usize| bound.iter().flatten().any(|b| b.place == place);
        let unused = self
            .header
            .iter()
            .enumerate()
            .filter(|(place, name)| !used(*place) && !name.trim().is_empty());
        let unused = unused.map(|(_, name)| error::shown(name)).collect();
        let columns =
            values.into_iter().zip(&bound).map(|(v, b)| b.is_some().then_some(v)).collect();
        Ok(Table { columns, unused, notes })
    }

    /// One sample, in SI units.
    #[inline]
    fn sample(
        &self,
        column: &Column,
        bound: Bound,
        record: &ByteRecord,
        style: &mut Style,
    ) -> Result<f64, InputError> {
        let field = record[bound.place].trim_ascii();
        if column.dimension == Dimension::Direction {
            return Ok(direction(field));
        }
        let (low, high) = column.range_in(&bound.unit);
        match style.number(field) {
            Ok(number) if (low..=high).contains(&number) => Ok(bound.unit.si(number)),
            Ok(number) if number.is_nan() && column.needed != Needed::Samples => Ok(f64::NAN),
            found => {
                let shown = error::shown(&String::from_utf8_lossy(field));
                let (name, unit) = (column.name, bound.unit.name);
                let message = match found {
                    _ if field.is_empty() => format!("{name} is empty; expected a number"),
                    Ok(number) if number.is_finite() => {
                        format!("{name} of {shown} {unit}; expected {low} to {high} {unit}")
                    }
                    Ok(_) => format!("`{shown}` for {name}; expected a number"),
                    Err(why) => format!("`{shown}` for {name}; expected {why}"),
                };
                Err(self.error(record, bound.place, message))
            }
        }
    }

    /// Where a record starts: after the line ends that the reader leaves before it.
    fn start_of(&self, record: &ByteRecord) -> usize {
        let start = record.position().map_or(0, csv::Position::byte);
        let start = (self.start + usize::try_from(start).unwrap_or(0)).min(self.text.len());
        let ends = self.text.as_bytes()[start..].iter().take_while(|b| matches!(b, b'\n' | b'\r'));
        start + ends.count()
    }

    /// An error at the start of a field, or at the end of a record without it.
    #[cold]
    fn error(&self, record: &ByteRecord, place: usize, message: impl Into<String>) -> InputError {
        let start = self.start_of(record);
        let offset = start + field_offset(&self.text[start..], place, self.separator);
        InputError::at(self.file, &self.text, offset, message)
    }
}

/// What a word says of a current without a sign: 1 out of the cell, -1 into it, 0 neither; NaN where it
/// is none.
fn direction(word: &[u8]) -> f64 {
    match word.first().map(u8::to_ascii_uppercase) {
        Some(b'D') => 1.0,
        Some(b'C') => -1.0,
        Some(letter) if letter.is_ascii_alphabetic() => 0.0,
        _ => f64::NAN,
    }
}

/// A number's text: which mark it has before its decimals is one thing in a whole file.
#[derive(Default)]
struct Style {
    mark: Option<u8>,
}

impl Style {
    /// The number that stands in a field, NaN for an empty one; or else what was expected.
    #[inline]
    fn number(&mut self, field: &[u8]) -> Result<f64, &'static str> {
        let field = field.trim_ascii();
        if field.is_empty() {
            return Ok(f64::NAN);
        }
        let text = std::str::from_utf8(field).map_err(|_| "a number")?;
        let mark = field.iter().copied().find(|b| matches!(b, b'.' | b','));
        let number = if mark == Some(b',') {
            text.replacen(',', ".", 1).parse()
        } else {
            text.parse::<f64>()
        };
        let number = number.map_err(|_| "a number")?;
        match (mark, self.mark) {
            (Some(b','), Some(b'.')) => Err("a number with a decimal point, as before it"),
            (Some(b'.'), Some(b',')) => Err("a number with a decimal comma, as before it"),
            (Some(_), None) => {
                self.mark = mark;
                Ok(number)
            }
            _ => Ok(number),
        }
    }
}

impl Column {
    pub(crate) const fn new(
        name: &'static str,
        names: &'static [&'static str],
        dimension: Dimension,
        unit: &'static str,
        needed: Needed,
        range: (f64, f64),
    ) -> Self {
        Self { name, names, dimension, unit, needed, range }
    }

    /// How its header is written.
    pub(crate) fn label(&self) -> String {
        if self.name.contains('_') {
            self.name.to_owned()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }

    /// What is not absurd, as numbers with another unit.
    fn range_in(&self, unit: &Unit) -> (f64, f64) {
        let (low, high) = self.range;
        match Unit::named(self.dimension, self.unit) {
            Some(own) if own != *unit => (unit.of_si(own.si(low)), unit.of_si(own.si(high))),
            _ => (low, high),
        }
    }
}

/// How a field of the header fits a column.
enum Found {
    Unit(Unit),
    Unknown { text: String, in_brackets: bool },
}

/// The fields of a header that may be a column, the best first.
fn matches<'h>(
    column: &'h Column,
    header: &'h [String],
) -> impl Iterator<Item = (usize, (usize, Found))> + 'h {
    let mut found: Vec<(usize, (usize, Found))> = header
        .iter()
        .enumerate()
        .filter_map(|(place, field)| fits(column, field).map(|fit| (place, fit)))
        .collect();
    found.sort_by_key(|(place, (rank, _))| (*rank, *place));
    found.into_iter()
}

/// Whether a field of a header is a column: the rank of its name, and its unit.
fn fits(column: &Column, field: &str) -> Option<(usize, Found)> {
    let (name, unit) = split(field);
    let name = plain(&name);
    let named = |text: &str| Unit::named(column.dimension, text);
    for (rank, own) in column.names.iter().enumerate() {
        let Some(rest) = name.strip_prefix(own) else { continue };
        if rest.is_empty() {
            let text = unit.unwrap_or_default();
            let stated = if text.is_empty() { column.unit } else { &text };
            return Some(match named(stated) {
                Some(unit) => (rank, Found::Unit(unit)),
                None => (rank, Found::Unknown { text, in_brackets: true }),
            });
        }
        let Some(suffix) = rest.strip_prefix('_').filter(|_| unit.is_none()) else { continue };
        if let Some(unit) = named(suffix) {
            return Some((rank, Found::Unit(unit)));
        }
        if !suffix.contains('_') && suffix.len() <= 6 {
            return Some((rank, Found::Unknown { text: suffix.to_owned(), in_brackets: false }));
        }
    }
    None
}

/// Whether a header has a column, whatever its unit.
pub(crate) fn has(column: &Column, header: &[String]) -> bool {
    header.iter().any(|field| fits(column, field).is_some())
}

/// A header's field as name and unit: `Name [unit]`, `Name (unit)`, `Name / unit`.
fn split(field: &str) -> (String, Option<String>) {
    if let Some((name, rest)) = field.split_once(['[', '(']) {
        let unit = rest.split([']', ')']).next().unwrap_or_default();
        return (name.trim().to_owned(), Some(unit.trim().to_owned()));
    }
    if let Some((name, unit)) = field.rsplit_once(" / ") {
        return (name.trim().to_owned(), Some(unit.trim().to_owned()));
    }
    (field.trim().to_owned(), None)
}

/// A name in small letters, with one `_` for whatever is no letter.
fn plain(name: &str) -> String {
    let small = name.to_lowercase().replace('%', " percent ");
    let words = small.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// What separates the columns of a line: a tab, else a semicolon, else a comma.
fn separator_of(line: &str) -> u8 {
    let mut quoted = false;
    let mut best = b',';
    for byte in line.bytes() {
        match byte {
            b'"' => quoted = !quoted,
            b'\t' if !quoted => return b'\t',
            b';' if !quoted => best = b';',
            _ => {}
        }
    }
    best
}

/// The fields of a header's line.
fn fields(line: &str, separator: u8) -> Vec<String> {
    let mut reader =
        ReaderBuilder::new().delimiter(separator).has_headers(false).from_reader(line.as_bytes());
    let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
    record.iter().map(|field| field.trim().trim_matches('"').trim().to_owned()).collect()
}

/// UTF-8 where it is, Latin-1 else.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    std::str::from_utf8(bytes)
        .map_or_else(|_| bytes.iter().map(|b| char::from(*b)).collect(), Cow::Borrowed)
}

/// How far into `rows` the given field of the first row that is not blank begins; the end of the
/// row where it has no such field.
fn field_offset(rows: &str, field: usize, separator: u8) -> usize {
    let line_end = |c| c == '\n' || c == '\r';
    let start = rows.find(|c| !line_end(c)).unwrap_or(rows.len());
    let (mut passed, mut quoted, mut begin) = (0, false, start);
    for (i, c) in rows[start..].char_indices() {
        let at = start + i;
        let ends = (line_end(c) || c == char::from(separator)) && !quoted;
        if passed == field && c != ' ' {
            // A field of blanks begins where it does.
            return if ends { begin } else { at };
        }
        match c {
            '"' => quoted = !quoted,
            c if line_end(c) && !quoted => return at,
            _ if ends => {
                passed += 1;
                begin = at + 1;
            }
            _ => {}
        }
    }
    rows.len()
}
