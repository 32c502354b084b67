//! A load of a battery alone: current or power over time, positive when discharging.

use crate::read::error::{InputError, listed, stem};
use crate::read::table::{Column, Needed, Sheet, Table, has};
use crate::read::unit::Dimension;

/// What a profile may have.
pub(crate) const COLUMNS: [Column; 4] = {
    use Dimension::{Current, Power, Temperature, Time};
    use Needed::{Nothing, Samples};
    [
        Column::new("time_s", &["time", "t", "test_time"], Time, "s", Samples, (0.0, 0.0)),
        Column::new("current_a", &["current", "amps"], Current, "A", Nothing, (-1e4, 1e4)),
        Column::new("power_w", &["power"], Power, "W", Nothing, (-1e7, 1e7)),
        Column::new(
            "temperature_c",
            &["temperature", "battery_temperature", "cell_temperature"],
            Temperature,
            "°C",
            Nothing,
            (-100.0, 200.0),
        ),
    ]
};

/// What is asked of a battery over time, linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// The file's name without its extension.
    pub name: String,
    /// Time \[s\], rising from 0.
    pub time_s: Vec<f64>,
    /// What is asked of it at each time.
    pub demand: Demand,
    /// Temperature of the battery \[°C\]; NaN where there is none.
    pub temperature_c: Vec<f64>,
    /// What was assumed or not used, in words.
    pub notes: Vec<String>,
}

/// What a profile asks for; positive when discharging.
#[derive(Clone, Debug, PartialEq)]
pub enum Demand {
    /// Current \[A\].
    Current(Vec<f64>),
    /// Power at the terminals \[W\].
    Power(Vec<f64>),
}

/// A profile from the bytes of a table. Of current and power the current counts.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Profile, InputError> {
    let sheet = open(file, bytes)?;
    let table = sheet.read(&COLUMNS)?;
    of_table(&sheet, table)
}

/// A profile's table before it is read.
pub(crate) fn open<'a>(file: &'a str, bytes: &'a [u8]) -> Result<Sheet<'a>, InputError> {
    Sheet::open(file, bytes, |header| has(&COLUMNS[0], header) && is_load(header))
}

/// A profile from its table as read.
pub(crate) fn of_table(sheet: &Sheet<'_>, table: Table) -> Result<Profile, InputError> {
    let mut found = table.columns.into_iter();
    let mut next = || found.next().flatten();
    let (time_s, current_a, power_w) = (next().unwrap_or_default(), next(), next());
    let mut notes = table.notes;
    if !table.unused.is_empty() {
        notes.push(format!("not used: {}", listed(table.unused.iter().map(String::as_str))));
    }
    let demand = match (current_a, power_w) {
        (Some(current_a), power_w) => {
            if power_w.is_some() {
                notes.push("`power_w` is not used: the current says it".to_owned());
            }
            Demand::Current(current_a)
        }
        (None, Some(power_w)) => Demand::Power(power_w),
        (None, None) => {
            return Err(sheet.header_error(0, "no column `current_a` or `power_w`"));
        }
    };
    let values = match &demand {
        Demand::Current(values) | Demand::Power(values) => values,
    };
    if let Some(hole) = values.iter().position(|x| x.is_nan()) {
        let message = format!("sample {} is empty; expected a number in each", hole + 1);
        return Err(InputError::of_file(sheet.file, message));
    }
    let rows = time_s.len();
    let temperature_c = next().unwrap_or_else(|| vec![f64::NAN; rows]);
    Ok(Profile { name: stem(sheet.file), time_s, demand, temperature_c, notes })
}

/// Whether a header has what loads a battery.
pub(crate) fn is_load(header: &[String]) -> bool {
    COLUMNS[1..3].iter().any(|column| has(column, header))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn current_or_power_over_time() {
        let of = |text: &str| parse("a/p.csv", text.as_bytes());
        let profile = of("time_min,current_ma\n0,500\n1,-1500\n").unwrap();
        assert_eq!(profile.demand, Demand::Current(vec![0.5, -1.5]));
        assert_eq!((profile.time_s.as_slice(), profile.name.as_str()), (&[0.0, 60.0][..], "p"));
        assert!(profile.temperature_c.iter().all(|c| c.is_nan()) && profile.notes.is_empty());
        let profile = of("Time [s];Power [kW];Temperature [°C]\n0;1,5;20\n1;-2;21\n").unwrap();
        assert_eq!(profile.demand, Demand::Power(vec![1500.0, -2000.0]));
        assert_eq!(profile.temperature_c, [20.0, 21.0]);
        let both = of("time_s,current_a,power_w\n0,1,4\n1,1,4\n").unwrap();
        assert_eq!((both.demand, both.notes.len()), (Demand::Current(vec![1.0, 1.0]), 1));
        for (text, expected) in [
            ("time_s,remark\n0,0\n1,1\n", "p.csv:1:1: no column `current_a` or `power_w`"),
            ("time_s,current_a\n0,1\n1,\n", "p.csv: sample 2 is empty"),
            ("time_s,power_hp\n0,1\n1,1\n", "p.csv:1:8: unknown unit `hp`"),
        ] {
            let error = of(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
