//! A measured test of one cell: current, voltage, charge and temperature over time.
//!
//! [`parse`] reads columns, found by their names in any order: `time_s,current_a,voltage_v` and, where
//! they were measured, `discharged_ah`, `cell_temperature_c` and `chamber_temperature_c`; current
//! positive when discharging. Cyclers' own names are known, too.

use crate::read::error::{InputError, stem};
use crate::read::table::{Column, Needed, Sheet, Table, has};
use crate::read::unit::Dimension;

/// Samples further apart than this are a gap: what happened in between was not logged \[s\] …
const GAP_S: f64 = 5.0;
/// … but not where the file is sampled so slowly that this many usual steps are longer.
const GAP_SAMPLINGS: f64 = 3.0;

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
    /// What was assumed, in words.
    pub notes: Vec<String>,
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
        sampling_s(&self.time_s)
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
        let gap_s = gap_s(&self.time_s);
        steps.filter(|(t, _)| t[1] - t[0] > gap_s).map(|(_, q)| (q[1] - q[0]).abs()).sum()
    }
}

/// The times between two samples \[s\], the shortest first.
pub(crate) fn steps(time_s: &[f64]) -> Vec<f64> {
    let mut steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    steps
}

/// The median time between two samples \[s\].
pub(crate) fn sampling_s(time_s: &[f64]) -> f64 {
    let steps = steps(time_s);
    steps.get(steps.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Samples further apart than this are a gap, by the record's own sampling \[s\].
pub(crate) fn gap_s(time_s: &[f64]) -> f64 {
    let steps = steps(time_s);
    // Of an even number the lower: a single gap beside a single step remains one.
    let usual_s = steps.get(steps.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
    GAP_S.max(GAP_SAMPLINGS * usual_s)
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

/// Temperature of a cell of which none was measured \[°C\].
const ASSUMED_C: f64 = 25.0;

/// What a cell's test may have.
pub(crate) const COLUMNS: [Column; 8] = {
    use Dimension::{Charge, Current, Direction, Temperature, Time, Voltage};
    use Needed::{Nothing, Samples};
    let degrees = (-100.0, 200.0);
    let counted = (-1e5, 1e5);
    [
        Column::new("time_s", &["time", "test_time", "testtime"], Time, "s", Samples, (0.0, 0.0)),
        Column::new("current_a", &["current", "amps"], Current, "A", Samples, (-1e4, 1e4)),
        Column::new(
            "voltage_v",
            &["voltage", "terminal_voltage", "cell_voltage", "volts"],
            Voltage,
            "V",
            Samples,
            (-10.0, 2000.0),
        ),
        Column::new(
            "discharged_ah",
            &["discharged", "discharge_capacity", "discharging_capacity"],
            Charge,
            "A·h",
            Nothing,
            counted,
        ),
        Column::new(
            "charged_ah",
            &["charged", "charge_capacity", "charging_capacity"],
            Charge,
            "A·h",
            Nothing,
            counted,
        ),
        Column::new(
            "cell_temperature_c",
            &[
                "cell_temperature",
                "surface_temperature",
                "x_averaged_cell_temperature",
                "temperature",
                "temperature_t1",
            ],
            Temperature,
            "°C",
            Nothing,
            degrees,
        ),
        Column::new(
            "chamber_temperature_c",
            &["chamber_temperature", "ambient_temperature"],
            Temperature,
            "°C",
            Nothing,
            degrees,
        ),
        Column::new("state", &["state", "md", "mode"], Direction, "", Nothing, (-1.0, 1.0)),
    ]
};

/// Reads a test from the bytes of a file called `file`. Without a counter the charge is the integral
/// of the current from a full cell, without a temperature it is 25 °C: the notes say so.
///
/// Cyclers that call their time `Test Time` (Arbin, the Battery Data Format, cellpy) count
/// charging positive: their currents are turned around. Maccor's have no sign: the column `State` says
/// which way they flow.
///
/// # Errors
/// [`InputError`] with line and column: a missing column, fewer than two rows, a row with another
/// number of fields than the header, what is no number or absurd, time that falls.
pub fn parse(file: &str, bytes: &[u8]) -> Result<CellRecord, InputError> {
    let sheet = open(file, bytes)?;
    let table = sheet.read(&COLUMNS)?;
    of_table(&sheet, table)
}

/// A test's table before it is read.
pub(crate) fn open<'a>(file: &'a str, bytes: &'a [u8]) -> Result<Sheet<'a>, InputError> {
    Sheet::open(file, bytes, |header| COLUMNS[..3].iter().all(|c| has(c, header)))
}

/// A test from its table as read.
pub(crate) fn of_table(sheet: &Sheet<'_>, table: Table) -> Result<CellRecord, InputError> {
    let time = sheet.bind(&COLUMNS)?[0].map(|bound| sheet.header[bound.place].to_lowercase());
    let charging_positive = time.is_some_and(|name| name.starts_with("test"));
    let mut notes = table.notes;
    let mut found = table.columns.into_iter();
    let mut next = || found.next().flatten();
    let (time_s, mut current_a) = (next().unwrap_or_default(), next().unwrap_or_default());
    let voltage_v = next().unwrap_or_default();
    let (discharged, charged, cell, chamber) = (next(), next(), next(), next());
    let unsigned = current_a.iter().all(|a| *a >= 0.0);
    let directions = next().filter(|words| unsigned && words.iter().any(|w| w.abs() == 1.0));
    if let Some(directions) = directions {
        for (a, direction) in current_a.iter_mut().zip(directions) {
            *a *= if direction.is_nan() { 0.0 } else { direction };
        }
        notes.push(
            "the currents have no sign: the column `state` says which way they flow".to_owned(),
        );
    } else if charging_positive {
        for a in &mut current_a {
            *a = -*a;
        }
        notes.push("a cycler's file: its currents count charging positive".to_owned());
    }
    let full = |values: &Vec<f64>| values.iter().all(|x| x.is_finite());
    let discharged_ah = match (discharged.filter(full), charged.filter(full)) {
        (Some(out), Some(back)) => out.iter().zip(&back).map(|(out, back)| out - back).collect(),
        (Some(out), None) => out,
        (None, _) => {
            notes.push(
                "no charge counter: the integral of the current, from a full cell".to_owned(),
            );
            charge_ah(&time_s, &current_a)
        }
    };
    let rows = time_s.len();
    let mut cell_c = cell.unwrap_or_default();
    if cell_c.iter().all(|c| c.is_nan()) {
        notes.push(format!("no temperature of the cell: {ASSUMED_C} °C taken"));
        cell_c = vec![ASSUMED_C; rows];
    }
    // A slow sensor leaves fields empty between its readings.
    let mut last_c = cell_c.iter().copied().find(|c| c.is_finite()).unwrap_or(ASSUMED_C);
    for c in &mut cell_c {
        last_c = if c.is_finite() { *c } else { last_c };
        *c = last_c;
    }
    Ok(CellRecord {
        name: stem(sheet.file),
        time_s,
        current_a,
        voltage_v,
        discharged_ah,
        cell_c,
        chamber_c: chamber.unwrap_or_else(|| vec![f64::NAN; rows]),
        notes,
    })
}

/// The charge that flowed out until each sample, by the trapezoidal rule \[C\].
pub(crate) fn charge_c(time_s: &[f64], current_a: &[f64]) -> Vec<f64> {
    let mut sum_c = 0.0;
    let steps = time_s.windows(2).zip(current_a.windows(2));
    let sums = steps.map(|(t, a)| {
        sum_c += 0.5 * (a[0] + a[1]) * (t[1] - t[0]);
        sum_c
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// The same \[A·h\].
pub(crate) fn charge_ah(time_s: &[f64], current_a: &[f64]) -> Vec<f64> {
    charge_c(time_s, current_a).into_iter().map(|c| c / 3600.0).collect()
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
        let record = parse("b.csv", fewer.as_bytes()).unwrap();
        assert!(record.chamber_c[1].is_nan() && record.notes.is_empty());
    }

    #[test]
    fn what_is_missing_is_assumed_and_said() {
        let text =
            "\u{feff}\"time_s\";\"current_ma\";\"voltage_mv\"\r\n0;0,5;4100\r\n7200;500;3900\r\n";
        let record = parse("b.csv", text.as_bytes()).unwrap();
        assert_eq!((record.cell_c.as_slice(), record.notes.len()), (&[25.0, 25.0][..], 2));
        assert!((record.voltage_v[1] - 3.9).abs() < 1e-12);
        assert!((record.discharged_ah[1] - 0.5005).abs() < 1e-12, "{:?}", record.discharged_ah);
        let empty = TEXT.replace("25.0,nan", ",nan").replace("25.1,", ",").replace("3,25,", "3,,");
        let record = parse("b.csv", empty.as_bytes()).unwrap();
        assert_eq!((record.cell_c.as_slice(), record.notes.len()), (&[25.0; 3][..], 1));
    }

    #[test]
    fn the_gap_follows_the_sampling() {
        let times = |step_s: f64| (0..9).map(|i| f64::from(i) * step_s).collect::<Vec<_>>();
        assert_eq!([0.1, 6.0].map(|step_s| gap_s(&times(step_s))), [5.0, 18.0]);
    }

    #[test]
    fn cyclers_names_and_signs_are_known() {
        for text in [
            "Data_Point,Test_Time(s),Current(A),Voltage(V),Charge_Capacity(Ah),Discharge_Capacity(Ah)\n1,0,0,4,0,0\n2,3600,-1,3.9,0,0.5\n",
            "Test Time / s,Voltage / V,Current / A,Discharging Capacity / Ah,Charging Capacity / Ah\n0,4,0,0,0\n3600,3.9,-1,0.5,0\n",
            "Time [s],Current [A],Voltage [V],Discharge capacity [A.h]\n0,0,4,0\n3600,1,3.9,0.5\n",
            ",test_time,current,voltage,charge_capacity,discharge_capacity\n0,0,0,4,0,0\n1,3600,-1,3.9,0,0.5\n",
        ] {
            let record =
                parse("b.csv", text.as_bytes()).map_err(|e| format!("{text} {e}")).unwrap();
            assert_eq!(record.current_a, [0.0, 1.0], "{text}");
            assert_eq!(record.discharged_ah, [0.0, 0.5], "{text}");
        }
    }

    #[test]
    fn a_state_says_which_way_a_current_without_a_sign_flows() {
        let text = "Today's Date 11/27/2026\nRec#\tCyc#\tStep\tTestTime\tStepTime\tAmp-hr\tAmps\tVolts\tState\n\
            1\t0\t1\t0d 00:00:00.00\t0\t0\t0\t4.0\tR\n2\t0\t2\t0d 00:30:00.00\t0\t0.5\t1\t3.9\tD\n\
            3\t0\t2\t0d 01:00:00.00\t0\t1\t1\t3.8\tD\n4\t0\t3\t0d 23:30:00.00\t0\t0.5\t1\t4.0\tC\n5\t0\t4\t1d 02:00:00.00\t0\t0\t0\t3.95\tS\n";
        let record = parse("m.txt", text.as_bytes()).unwrap();
        assert_eq!(record.current_a, [0.0, 1.0, 1.0, -1.0, 0.0]);
        assert_eq!(record.time_s, [0.0, 1800.0, 3600.0, 84_600.0, 93_600.0]);
        assert!(record.notes[0].contains("`state`"), "{:?}", record.notes);
        // Where currents have signs the words say nothing.
        let signed = text.replace("\t1\t4.0\tC", "\t-1\t4.0\tC");
        let record = parse("m.txt", signed.as_bytes()).unwrap();
        assert_eq!(record.current_a, [0.0, -1.0, -1.0, 1.0, 0.0]);
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (from, to, expected) in [
            ("2.0,4.0", "two,4.0", "x.csv:3:5: `two` for current_a; expected a number"),
            ("2.0,4.0", "2e4,4.0", "x.csv:3:5: current_a of 2e4 A; expected -10000 to 10000 A"),
            ("60.1,0,", "0.05,0,", "x.csv:5:1: time does not rise: 0.05 after 0.1 in line 3;"),
            ("25.1,25.0", "25.1", "x.csv:3:24: 5 fields; expected 6, as in the header"),
            ("voltage_v", "tension", "x.csv:1:1: no column `voltage_v`; found `time_s`"),
            ("voltage_v", "voltage_kv", "x.csv:1:18: unknown unit `kv` of column `voltage_kv`"),
            (
                "current_a",
                "Current [C]",
                "x.csv:1:8: unknown unit `C` of column `Current [C]`; expected A, mA",
            ),
        ] {
            let error = parse("x.csv", TEXT.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(error.to_string().starts_with(expected), "{error}");
        }
        assert!(parse("x.csv", b"").unwrap_err().message.contains("empty"));
        let header = TEXT.lines().next().unwrap();
        assert!(parse("x.csv", header.as_bytes()).unwrap_err().message.contains("0 samples"));
    }
}
