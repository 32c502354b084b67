//! Driving cycles: built in, or from a file.

use serde::Deserialize;

use crate::read::error::{self, InputError, nearest, shown, stem};

/// The columns of a cycle's file, with their units.
pub(crate) const COLUMNS: [&str; 2] = ["time_s", "speed_m_s"];
/// No cycle asks for more than this \[m/s\].
const LARGEST_SPEED_M_S: f32 = 150.0;
/// Nor is one longer; beyond this single precision no longer tells times apart \[s\].
const LARGEST_TIME_S: f32 = 1e6;

/// Every built-in cycle: its name and its file.
const BUILT_IN: [(&str, &str); 5] = [
    ("udds", include_str!("../../data/cycles/udds.csv")),
    ("hwfet", include_str!("../../data/cycles/hwfet.csv")),
    ("us06", include_str!("../../data/cycles/us06.csv")),
    ("wltc3b", include_str!("../../data/cycles/wltc3b.csv")),
    ("nedc", include_str!("../../data/cycles/nedc.csv")),
];
/// Where they come from.
const SOURCES: &str = include_str!("../../data/cycles/SOURCE.toml");

/// A speed over time, linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Its name, in a command or of a file.
    pub name: String,
    /// Its full name.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// Two points at least: time \[s\], rising from 0 or above, and speed \[m/s\].
    pub points: Vec<(f32, f32)>,
}

impl Cycle {
    /// From the first point to the last \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => f64::from(last.0) - f64::from(first.0),
            _ => 0.0,
        }
    }

    /// The distance driven, by trapezoids \[km\].
    #[must_use]
    pub fn distance_km(&self) -> f64 {
        let trapezoid = |p: &[(f32, f32)]| {
            let dt_s = f64::from(p[1].0) - f64::from(p[0].0);
            0.5 * dt_s * (f64::from(p[0].1) + f64::from(p[1].1))
        };
        self.points.windows(2).map(trapezoid).sum::<f64>() / 1000.0
    }
}

/// What SOURCE.toml says about a cycle, as far as a user of it wants to know.
#[derive(Deserialize)]
struct About {
    title: String,
    origin: String,
}

/// The names of the built-in cycles.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILT_IN.iter().map(|(name, _)| *name)
}

/// The built-in cycles.
#[must_use]
pub fn builtin() -> Vec<Cycle> {
    names().filter_map(by_name).collect()
}

/// The built-in cycle of that name.
#[must_use]
pub fn by_name(name: &str) -> Option<Cycle> {
    let (name, text) = BUILT_IN.iter().find(|(n, _)| *n == name)?;
    let mut sources: toml::Table = SOURCES.parse().ok()?;
    let about: About = sources.remove(*name)?.try_into().ok()?;
    let cycle = parse(name, text.as_bytes()).ok()?;
    Some(Cycle { title: about.title, source: about.origin, ..cycle })
}

/// A cycle from the bytes of a CSV file with the columns `time_s` and `speed_m_s`, named as the file
/// is.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Cycle, InputError> {
    let sheet = Sheet { file, text: error::text(file, bytes)? };
    let mut rows = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(sheet.text.as_bytes())
        .into_records();
    let mut next = || rows.next().transpose().map_err(|e| sheet.unreadable(&e));

    let header = next()?.ok_or_else(|| {
        InputError::at(file, sheet.text, 0, "empty file: expected the header `time_s,speed_m_s`")
    })?;
    let columns = sheet.columns(&header)?;
    let mut points: Vec<(f32, f32)> = Vec::new();
    while let Some(row) = next()? {
        points.push(sheet.point(&row, columns, points.last().copied())?);
    }
    if points.len() < 2 {
        let message = format!("expected two rows of numbers at least, found {}", points.len());
        return Err(InputError::at(file, sheet.text, sheet.text.len(), message));
    }
    let name = stem(file);
    Ok(Cycle { name: name.clone(), title: name, source: file.to_owned(), points })
}

/// A CSV file, for messages about it.
#[derive(Clone, Copy)]
struct Sheet<'a> {
    file: &'a str,
    text: &'a str,
}

impl Sheet<'_> {
    fn unreadable(&self, error: &csv::Error) -> InputError {
        let offset = error.position().map_or(0, |p| usize::try_from(p.byte()).unwrap_or(0));
        InputError::at(self.file, self.text, offset, format!("not a CSV file: {error}"))
    }

    /// About one field of a row; about the row's end where it has no such field.
    fn error(&self, row: &csv::StringRecord, field: usize, message: String) -> InputError {
        let start = row.position().map_or(0, |p| usize::try_from(p.byte()).unwrap_or(0));
        let offset = start + field_offset(self.text.get(start..).unwrap_or(""), field);
        InputError::at(self.file, self.text, offset, message)
    }

    /// Where each of [`COLUMNS`] stands.
    fn columns(&self, header: &csv::StringRecord) -> Result<[usize; 2], InputError> {
        for (i, name) in header.iter().enumerate() {
            if !COLUMNS.contains(&name) {
                let advice = nearest(name, COLUMNS)
                    .map_or("expected the header `time_s,speed_m_s`".to_owned(), |near| {
                        format!("did you mean `{near}`?")
                    });
                let message = format!("unknown column `{}`; {advice}", shown(name));
                return Err(self.error(header, i, message));
            }
            if header.iter().take(i).any(|earlier| earlier == name) {
                return Err(self.error(header, i, format!("second column `{name}`")));
            }
        }
        let find = |name: &str| {
            header.iter().position(|n| n == name).ok_or_else(|| {
                let message = format!("missing column `{name}`: expected `time_s,speed_m_s`");
                self.error(header, header.len(), message)
            })
        };
        Ok([find(COLUMNS[0])?, find(COLUMNS[1])?])
    }

    /// One row; its time must lie after that of the row before.
    fn point(
        &self,
        row: &csv::StringRecord,
        columns: [usize; 2],
        before: Option<(f32, f32)>,
    ) -> Result<(f32, f32), InputError> {
        if row.len() != COLUMNS.len() {
            let message = format!("expected {} fields, found {}", COLUMNS.len(), row.len());
            return Err(self.error(row, COLUMNS.len().min(row.len()), message));
        }
        let [time_s, speed_m_s] =
            [self.number(row, columns[0], COLUMNS[0])?, self.number(row, columns[1], COLUMNS[1])?];
        let refused = |field: usize, rule: String| {
            let found = shown(row.get(columns[field]).unwrap_or(""));
            let message = format!("`{}` must {rule}, found {found}", COLUMNS[field]);
            Err(self.error(row, columns[field], message))
        };
        match before {
            None if time_s < 0.0 => refused(0, "start at 0 or above".to_owned()),
            Some((last_s, _)) if time_s <= last_s => {
                refused(0, format!("increase from row to row (the row before has {last_s})"))
            }
            _ if time_s > LARGEST_TIME_S => refused(0, format!("be at most {LARGEST_TIME_S} s")),
            _ if speed_m_s.abs() > LARGEST_SPEED_M_S => {
                refused(1, format!("lie within ±{LARGEST_SPEED_M_S} m/s"))
            }
            _ => Ok((time_s, speed_m_s)),
        }
    }

    fn number(
        &self,
        row: &csv::StringRecord,
        field: usize,
        column: &str,
    ) -> Result<f32, InputError> {
        let text = row.get(field).unwrap_or("");
        let found =
            if text.is_empty() { "nothing".to_owned() } else { format!("`{}`", shown(text)) };
        match text.parse::<f32>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => {
                Err(self.error(row, field, format!("`{column}` must be finite, found {found}")))
            }
            Err(_) => {
                let message = format!("expected a number in column `{column}`, found {found}");
                Err(self.error(row, field, message))
            }
        }
    }
}

/// How far into `rows` the given field of the first row that is not blank begins; the end of the
/// row where it has no such field.
fn field_offset(rows: &str, field: usize) -> usize {
    let line_end = |c| c == '\n' || c == '\r';
    let start = rows.find(|c| !line_end(c)).unwrap_or(rows.len());
    let (mut commas, mut quoted) = (0, false);
    for (i, c) in rows[start..].char_indices() {
        if commas == field && c != ' ' && c != '\t' {
            return start + i;
        }
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => commas += 1,
            c if line_end(c) && !quoted => return start + i,
            _ => {}
        }
    }
    rows.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name, duration \[s\], distance \[km\] of every built-in cycle.
    const KNOWN: [(&str, f64, f64); 5] = [
        ("udds", 1369.0, 11.990),
        ("hwfet", 765.0, 16.507),
        ("us06", 600.0, 12.888),
        ("wltc3b", 1800.0, 23.266),
        ("nedc", 1180.0, 10.931),
    ];

    #[track_caller]
    fn says(text: &str, expected: &str) {
        assert_eq!(
            parse("x.csv", text.as_bytes()).unwrap_err().to_string(),
            format!("x.csv:{expected}")
        );
    }

    #[test]
    fn every_built_in_cycle_has_its_length_and_its_source() {
        let cycles = builtin();
        assert_eq!(cycles.len(), KNOWN.len());
        for (cycle, (name, duration_s, distance_km)) in cycles.iter().zip(KNOWN) {
            assert_eq!((cycle.name.as_str(), cycle.duration_s()), (name, duration_s));
            assert!((cycle.distance_km() - distance_km).abs() < 1e-3, "{name}");
            assert!(cycle.title.len() > 10 && cycle.source.len() > 10, "{name}");
            assert_eq!(by_name(name).as_ref(), Some(cycle));
        }
        let udds = by_name("udds").unwrap();
        assert_eq!(udds.title, "EPA Urban Dynamometer Driving Schedule (UDDS, FTP-72)");
        assert_eq!(udds.source, "US Environmental Protection Agency, 40 CFR part 86, appendix I");
        assert_eq!(by_name("UDDS"), None);
    }

    #[test]
    fn every_cycle_that_has_a_source_is_built_in_and_agrees_with_it() {
        let sources: toml::Table = SOURCES.parse().unwrap();
        let mut built_in: Vec<_> = names().collect();
        built_in.sort_unstable();
        assert_eq!(sources.keys().collect::<Vec<_>>(), built_in);
        for cycle in builtin() {
            let stated_km = sources[&cycle.name]["distance_km"].as_float().unwrap();
            assert!((cycle.distance_km() - stated_km).abs() < 1e-5, "{}", cycle.name);
        }
    }

    #[test]
    fn reads_a_file_with_its_columns_in_any_order() {
        let points = vec![(0.5, 0.0), (1.5, 10.0)];
        for text in [
            "time_s,speed_m_s\n0.5,0\n1.5,10\n",
            "\u{feff}time_s,speed_m_s\r\n0.5,0\r\n1.5,10",
            "speed_m_s,time_s\n0,0.5\n10,1.5\n",
            "\n\"time_s\", speed_m_s\n\n0.5 , 0\n\n\"1.5\",1e1\n\n",
        ] {
            assert_eq!(parse("x", text.as_bytes()).unwrap().points, points, "{text:?}");
        }
        assert_eq!(parse("some/where/own.csv", b"time_s,speed_m_s\n0,0\n1,1").unwrap().name, "own");
    }

    #[test]
    fn an_empty_file_or_one_without_its_columns() {
        says("", "1:1: empty file: expected the header `time_s,speed_m_s`");
        says("\n\n", "1:1: empty file: expected the header `time_s,speed_m_s`");
        says("time_s\n0\n", "1:7: missing column `speed_m_s`: expected `time_s,speed_m_s`");
        says("0,0\n1,1\n", "1:1: unknown column `0`; expected the header `time_s,speed_m_s`");
        says("time_s,speed_ms\n", "1:8: unknown column `speed_ms`; did you mean `speed_m_s`?");
        says(
            "time_s;speed_m_s\n0;0\n",
            "1:1: unknown column `time_s;speed_m_s`; expected the header `time_s,speed_m_s`",
        );
        says("time_s,speed_m_s,time_s\n", "1:18: second column `time_s`");
        says(
            "time_s,speed_m_s,grade\n0,0,0\n",
            "1:18: unknown column `grade`; expected the header `time_s,speed_m_s`",
        );
    }

    #[test]
    fn too_few_rows_or_fields() {
        says("time_s,speed_m_s\n", "2:1: expected two rows of numbers at least, found 0");
        says("time_s,speed_m_s\n0,0", "2:4: expected two rows of numbers at least, found 1");
        says("time_s,speed_m_s\n0,0\n1\n", "3:2: expected 2 fields, found 1");
        says("time_s,speed_m_s\n0,0\n1,2,3\n", "3:5: expected 2 fields, found 3");
    }

    #[test]
    fn what_is_no_number() {
        let rows = |row: &str| format!("time_s,speed_m_s\n0,0\n{row}\n2,0\n");
        let number = |column: &str, found: &str| {
            format!("expected a number in column `{column}`, found {found}")
        };
        says(&rows("1,fast"), &format!("3:3: {}", number("speed_m_s", "`fast`")));
        says(&rows("\r\nx1, 2"), &format!("4:1: {}", number("time_s", "`x1`")));
        says(&rows("1,  1 000"), &format!("3:5: {}", number("speed_m_s", "`1 000`")));
        says(&rows("1,"), &format!("3:3: {}", number("speed_m_s", "nothing")));
        says(&rows("\"1\n,1\",x"), &format!("3:1: {}", number("time_s", "`1\u{FFFD},1`")));
        for bad in ["nan", "inf", "-inf", "1e39"] {
            let expected = format!("3:3: `speed_m_s` must be finite, found `{bad}`");
            says(&rows(&format!("1,{bad}")), &expected);
        }
        let error = parse("x", b"time_s,speed_m_s\n0,0\n1,\xB5\n").unwrap_err();
        assert_eq!(error.to_string(), "x:3:3: not a text: expected UTF-8");
    }

    #[test]
    fn times_and_speeds_out_of_range() {
        let rule = "`time_s` must increase from row to row (the row before has";
        says("time_s,speed_m_s\n0,0\n0,1\n", &format!("3:1: {rule} 0), found 0"));
        says("speed_m_s,time_s\n0,2\n0,1.5\n", &format!("3:3: {rule} 2), found 1.5"));
        says("time_s,speed_m_s\n-1,0\n0,1\n", "2:1: `time_s` must start at 0 or above, found -1");
        says(
            "time_s,speed_m_s\n0,0\n2e6,1\n",
            "3:1: `time_s` must be at most 1000000 s, found 2e6",
        );
        for speed in ["150.1", "-151", "1e30"] {
            says(
                &format!("time_s,speed_m_s\n0,{speed}\n1,1\n"),
                &format!("2:3: `speed_m_s` must lie within ±150 m/s, found {speed}"),
            );
        }
        assert!(parse("x", b"time_s,speed_m_s\n0,-150\n1,150\n").is_ok());
    }

    #[test]
    fn no_damage_makes_it_panic() {
        let sound = b"time_s,speed_m_s\r\n0,0\n\n1,\"1\"\n2,2\n";
        for i in 0..sound.len() {
            let _ = parse("x", &sound[..i]);
            for byte in 0..=255 {
                let mut damaged = sound.to_vec();
                damaged[i] = byte;
                let _ = parse("x", &damaged);
            }
        }
    }
}
