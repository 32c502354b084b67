//! Driving cycles: built in, or from a file.

use serde::Deserialize;

use crate::read::error::{InputError, listed, shown, stem};
use crate::read::table::{Column, Needed, Sheet, Table, has};
use crate::read::unit::Dimension;

/// No cycle asks for more than this \[m/s\].
const LARGEST_SPEED_M_S: f64 = 150.0;
/// Nor is one longer; beyond this single precision no longer tells times apart \[s\].
const LARGEST_TIME_S: f64 = 1e6;

/// What a cycle's file may have: speed over time, and the road's slope or height.
pub(crate) const COLUMNS: [Column; 4] = [
    Column {
        name: "time_s",
        names: &["time", "cycsecs", "t"],
        dimension: Dimension::Time,
        unit: "s",
        needed: Needed::Samples,
        range: (0.0, 0.0),
    },
    SPEED,
    Column {
        name: "grade",
        names: &["grade", "slope", "gradient", "road_grade", "cycgrade"],
        dimension: Dimension::Ratio,
        unit: "ratio",
        needed: Needed::Nothing,
        range: (-0.5, 0.5),
    },
    Column {
        name: "elevation_m",
        names: &["elevation", "altitude", "height"],
        dimension: Dimension::Length,
        unit: "m",
        needed: Needed::Nothing,
        range: (-1000.0, 10_000.0),
    },
];

const SPEED: Column = Column {
    name: "speed_m_s",
    names: &["speed", "velocity", "vehicle_speed", "target_speed", "cycmps"],
    dimension: Dimension::Speed,
    unit: "m/s",
    needed: Needed::Samples,
    range: (-LARGEST_SPEED_M_S, LARGEST_SPEED_M_S),
};

/// Distance in place of the time.
pub(crate) const DISTANCE: Column = Column {
    name: "distance_m",
    names: &["distance", "position"],
    dimension: Dimension::Length,
    unit: "m",
    needed: Needed::Samples,
    range: (-1e9, 1e9),
};

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
    /// Two points at least: time \[s\], rising from 0, and speed \[m/s\].
    pub points: Vec<(f32, f32)>,
    /// Rise of the road over the way along it, at each point; empty where the file has none.
    pub grade: Vec<f64>,
    /// Height \[m\] at each point; empty where the file has none.
    pub elevation_m: Vec<f64>,
    /// What was assumed or not used, in words.
    pub notes: Vec<String>,
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

/// A cycle from the bytes of a table with a speed over time (`time_s`, `speed_m_s`) or over distance
/// (`distance_m`), and perhaps the slope (`grade`) or the height (`elevation_m`); named as the file
/// is. Units may be others: `speed_km_h`, `Speed [mph]`.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Cycle, InputError> {
    let sheet = open(file, bytes)?;
    let table = sheet.read(&columns(&sheet.header))?;
    of_table(&sheet, table)
}

/// The columns of a file with this header.
pub(crate) fn columns(header: &[String]) -> [Column; 4] {
    let mut columns = COLUMNS;
    if is_of_distance(header) {
        columns[0] = DISTANCE;
    }
    columns
}

/// Whether the speed stands over distance: where there is no time.
fn is_of_distance(header: &[String]) -> bool {
    !has(&COLUMNS[0], header) && has(&DISTANCE, header)
}

/// A cycle's table before it is read.
pub(crate) fn open<'a>(file: &'a str, bytes: &'a [u8]) -> Result<Sheet<'a>, InputError> {
    let is_header = |header: &[String]| COLUMNS[..2].iter().all(|c| has(c, header));
    let sheet = Sheet::open(file, bytes, is_header)?;
    // A speed in small letters says its unit; a bare `Speed` may be anything.
    if let Some(place) = sheet.bind(&columns(&sheet.header))?[1].map(|bound| bound.place)
        && is_bare(&sheet.header[place])
    {
        let message = format!(
            "no unit of column `{}`; expected m/s, km/h or mph in brackets, or `speed_m_s`",
            shown(&sheet.header[place])
        );
        return Err(sheet.header_error(place, message));
    }
    Ok(sheet)
}

/// A cycle from its table as read.
#[expect(clippy::cast_possible_truncation, reason = "cycles are in single precision")]
pub(crate) fn of_table(sheet: &Sheet<'_>, table: Table) -> Result<Cycle, InputError> {
    let file = sheet.file;
    let of_distance = is_of_distance(&sheet.header);
    let mut notes = table.notes;
    if !table.unused.is_empty() {
        notes.push(format!("not used: {}", listed(table.unused.iter().map(String::as_str))));
    }
    let mut found = table.columns.into_iter();
    let mut next = || found.next().flatten();
    let (mut time_s, speed_m_s) = (next().unwrap_or_default(), next().unwrap_or_default());
    if of_distance {
        time_s = times(&time_s, &speed_m_s).map_err(|row| {
            let message = format!(
                "in sample {} the distance {}; expected one that rises at a speed above 0",
                row + 1,
                if time_s[row] < time_s[row - 1] { "falls" } else { "rises at standstill" }
            );
            InputError::of_file(file, message)
        })?;
        notes.push("speed over distance: no time is spent at a stop".to_owned());
    }
    if let Some(last_s) = time_s.last().filter(|t| **t > LARGEST_TIME_S) {
        let message = format!("lasts {last_s} s; a cycle must last {LARGEST_TIME_S} s at most");
        return Err(InputError::of_file(file, message));
    }
    let points: Vec<(f32, f32)> =
        time_s.iter().zip(&speed_m_s).map(|(t, v)| (*t as f32, *v as f32)).collect();
    if points.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
        let message = "times lie too close together: single precision does not tell them apart";
        return Err(InputError::of_file(file, message));
    }
    let (grade, elevation_m) = (next(), next());
    let holes = [&grade, &elevation_m].into_iter().flatten().flatten().any(|x| x.is_nan());
    if holes {
        notes.push("where slope or height are missing the road is flat".to_owned());
    }
    let filled = |values: Option<Vec<f64>>, last: bool| {
        let mut before = 0.0;
        let fill = |x: f64| {
            let value = if x.is_nan() { if last { before } else { 0.0 } } else { x };
            before = value;
            value
        };
        values.unwrap_or_default().into_iter().map(fill).collect()
    };
    let name = stem(file);
    Ok(Cycle {
        name: name.clone(),
        title: name,
        source: file.to_owned(),
        points,
        grade: filled(grade, false),
        elevation_m: filled(elevation_m, true),
        notes,
    })
}

/// A header's name without any unit.
fn is_bare(header: &str) -> bool {
    header.chars().all(char::is_alphabetic)
}

/// The time at each distance; or the sample where there is none.
fn times(distance_m: &[f64], speed_m_s: &[f64]) -> Result<Vec<f64>, usize> {
    let mut time_s = vec![0.0];
    for i in 1..distance_m.len() {
        let way_m = distance_m[i] - distance_m[i - 1];
        let mean_m_s = 0.5 * (speed_m_s[i] + speed_m_s[i - 1]);
        if !(way_m > 0.0 && mean_m_s > 0.0) {
            return Err(i);
        }
        time_s.push(time_s[i - 1] + way_m / mean_m_s);
    }
    Ok(time_s)
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
        let points = vec![(0.0, 0.0), (1.0, 10.0)];
        for text in [
            "time_s,speed_m_s\n0.5,0\n1.5,10\n",
            "\u{feff}time_s,speed_m_s\r\n0.5,0\r\n1.5,10",
            "speed_m_s,time_s\n0,0.5\n10,1.5\n",
            "\n\"time_s\", speed_m_s\n\n0.5 , 0\n\n\"1.5\",1e1\n\n",
            "time_s;speed_m_s\r\n0,5;0,0\r\n1,5;10,0\r\n",
            "time_s\tspeed_m_s\n0.5\t0\n1.5\t10\n",
            "time_s,speed_m_s,,\n0.5,0,,\n1.5,10,,\n,,,\n",
            "Time [ms];Speed (km/h)\n500;0\n1500;36\n",
            "time_s,speed_km_h\n1700000000.5,0\n1700000001.5,36\n",
            "made by a logger\n\ntime_s,speed_m_s\n10:00:00,0\n10:00:01,10\n",
            "time,speed_m_s,note_x\n2026-11-27T10:00:00Z,0,5\n2026-11-27T10:00:01Z,10,5\n",
            "time_s,speed_m_s\n0,0\n1,9\n1,11\n",
        ] {
            let cycle = parse("x", text.as_bytes()).map_err(|e| format!("{text:?}: {e}")).unwrap();
            assert_eq!(cycle.points, points, "{text:?}");
        }
        let mph = parse("x", b"time_s,speed_mph\n0,0\n1,100\n").unwrap();
        assert_eq!(mph.points[1].1, 44.704);
        let named = parse("some/where/own.csv", b"time_s,speed_m_s,x\n0,0,1\n1,1,2").unwrap();
        assert_eq!(
            (named.name.as_str(), named.notes.as_slice()),
            ("own", &["not used: `x`".to_owned()][..])
        );
    }

    #[test]
    fn a_drive_is_the_same_wherever_its_time_begins() {
        let drive = |first: u32| {
            let rows = (0..200).map(|i| format!("{}.{},{}\n", first + i / 10, i % 10, i));
            let text = format!("time_s,speed_km_h\n{}", rows.collect::<String>());
            parse("x", text.as_bytes()).unwrap().points
        };
        assert_eq!(drive(700_000), drive(0));
        assert_eq!(drive(1_700_000_000), drive(0));
    }

    #[test]
    fn slope_and_height_and_speed_over_distance() {
        let of = |text: &str| parse("x", text.as_bytes()).unwrap();
        let cycle = of("time_s,speed_m_s,grade_%\n0,0,5\n1,1,-2\n");
        assert_eq!(cycle.grade, [0.05, -0.02]);
        assert_eq!(of("time_s,speed_m_s,grade\n0,0,0.05\n1,1,\n").grade, [0.05, 0.0]);
        let cycle = of("time_s,speed_m_s,elevation_ft\n0,0,10\n1,1,\n");
        assert!((cycle.elevation_m[1] - 3.048).abs() < 1e-12 && cycle.notes.len() == 1);
        let cycle = of("distance_m,speed_m_s\n0,0\n10,2\n30,2\n");
        assert_eq!(cycle.points, [(0.0, 0.0), (10.0, 2.0), (20.0, 2.0)]);
        says(
            "distance_m,speed_m_s\n0,0\n10,0\n",
            " in sample 2 the distance rises at standstill; expected one that rises at a speed above 0",
        );
    }

    #[test]
    fn an_empty_file_or_one_without_its_columns() {
        says("", " the file is empty; expected a header and samples");
        says("\n\n", " the file is empty; expected a header and samples");
        says("time_s\n0\n", "1:1: no column `speed_m_s`; found `time_s`");
        says("0,0\n1,1\n", "1:1: no column `time_s`; found `0`, `0`");
        says(
            "time_s,speed_ms\n",
            "1:8: unknown unit `ms` of column `speed_ms`; expected m/s, km/h, mph; did you mean `speed_m_s`?",
        );
        says(
            "Time [s],Speed [knots]\n",
            "1:10: unknown unit `knots` of column `Speed [knots]`; expected m/s, km/h, mph",
        );
        says(
            "Time,Speed\n0,0\n1,1\n",
            "1:6: no unit of column `Speed`; expected m/s, km/h or mph in brackets, or `speed_m_s`",
        );
        says("time_s,speed_m_s,time_s\n", "1:18: second column `time_s`");
    }

    #[test]
    fn too_few_rows_or_fields() {
        says("time_s,speed_m_s\n", " 0 samples; expected two at least");
        says("time_s,speed_m_s\n0,0", " 1 samples; expected two at least");
        says("time_s,speed_m_s\n0,0\n1\n", "3:2: 1 fields; expected 2, as in the header");
        says("time_s,speed_m_s\n0,0\n1,2,3\n", "3:5: 3 fields; expected 2, as in the header");
    }

    #[test]
    fn what_is_no_number() {
        let rows = |row: &str| format!("time_s,speed_m_s\n0,0\n{row}\n2,0\n");
        let number = |found: &str| format!("`{found}` for speed_m_s; expected a number");
        says(&rows("1,fast"), &format!("3:3: {}", number("fast")));
        says(&rows("1,  1 000"), &format!("3:5: {}", number("1 000")));
        says(&rows("1,"), "3:3: speed_m_s is empty; expected a number");
        for bad in ["nan", "inf", "-inf"] {
            says(&rows(&format!("1,{bad}")), &format!("3:3: {}", number(bad)));
        }
        let error = parse("x", rows("\r\nx1, 2").as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("x:4:1: `x1` for Time; expected a number, a date"), "{error}");
    }

    #[test]
    fn times_and_speeds_out_of_range() {
        let error = parse("x", b"speed_m_s,time_s\n0,2\n0,1.5\n").unwrap_err().to_string();
        assert!(error.starts_with("x:3:3: time does not rise: 1.5 after 2 in line 2;"), "{error}");
        says(
            "time_s,speed_m_s\n0,0\n2e6,1\n",
            " lasts 2000000 s; a cycle must last 1000000 s at most",
        );
        for speed in ["150.1", "-151", "1e30"] {
            says(
                &format!("time_s,speed_m_s\n0,{speed}\n1,1\n"),
                &format!("2:3: speed_m_s of {speed} m/s; expected -150 to 150 m/s"),
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
