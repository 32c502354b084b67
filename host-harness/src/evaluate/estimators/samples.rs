//! A measurement as a battery management system samples it: at an even rate, current as the mean
//! over the interval, and a state of charge to compare with.

use anyhow::Context;

use crate::read::cell;
use crate::read::input::Measurement;

/// What was measured, evenly sampled; not a number within gaps of the logger.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// The file's name without its extension.
    pub name: String,
    /// The time between two samples \[s\].
    pub dt_s: f64,
    /// Mean current since the sample before \[A\], positive when discharging.
    pub current_a: Vec<f64>,
    /// Voltage \[V\].
    pub voltage_v: Vec<f64>,
    /// Temperature \[°C\].
    pub temperature_c: Vec<f64>,
    /// The state of charge to compare with, 0..1.
    pub soc: Vec<f64>,
    /// It begins with a battery that has rested: a test bench waits for that, a driver does not.
    pub starts_rested: bool,
    /// What the reader should know.
    pub notes: Vec<String>,
    /// The state of charge cannot be trusted.
    pub reference_doubtful: bool,
}

/// Samples a measurement every `dt_s`, the current shifted by `delay_s`; `capacity_ah` turns the charge
/// counter of a cell test into a state of charge.
///
/// # Errors
/// A record that is shorter than two samples.
pub fn sampled(
    measured: &Measurement,
    dt_s: f64,
    delay_s: f64,
    capacity_ah: f64,
) -> anyhow::Result<Samples> {
    let (name, time_s, current_a, voltage_v, temperature_c, soc, notes) = match measured {
        Measurement::Cell(r) => {
            let soc: Vec<f64> = (0..r.time_s.len()).map(|i| r.soc(i, capacity_ah)).collect();
            (&r.name, &r.time_s, &r.current_a, &r.voltage_v, &r.cell_c, soc, r.notes.clone())
        }
        Measurement::Trip(t) => {
            let notes = t.unfit(capacity_ah);
            let soc = t.soc.clone();
            (&t.name, &t.time_s, &t.battery_a, &t.battery_v, &t.battery_c, soc, notes)
        }
    };
    let start_s = *time_s.first().context("an empty record")?;
    let end_s = *time_s.last().context("an empty record")?;
    let charge_c = cell::charge_c(time_s, current_a);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let count = ((end_s - start_s) / dt_s).floor() as usize;
    anyhow::ensure!(count >= 2, "{name}: shorter than two samples of {dt_s} s");
    let mut samples = Samples {
        name: name.clone(),
        dt_s,
        current_a: Vec::with_capacity(count),
        voltage_v: Vec::with_capacity(count),
        temperature_c: Vec::with_capacity(count),
        soc: Vec::with_capacity(count),
        starts_rested: matches!(measured, Measurement::Cell(_)),
        reference_doubtful: matches!(measured, Measurement::Trip(_)) && !notes.is_empty(),
        notes,
    };
    let gap_s = cell::gap_s(time_s);
    let mut reader = Reader { time_s, at: 0, gap_s };
    let mut delayed = Reader { time_s, at: 0, gap_s };
    // Before the first sample its current flowed.
    let first_a = current_a.first().copied().unwrap_or_default();
    let mut flowed_c =
        |at_s: f64| delayed.read(&charge_c, at_s) + first_a * (at_s - start_s).min(0.0);
    let mut before_c = flowed_c(start_s - delay_s);
    for k in 1..=count {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let now_s = start_s + k as f64 * dt_s;
        let now_c = flowed_c(now_s - delay_s);
        let logged = reader.logged(now_s);
        let or_gap = |value: f64| if logged { value } else { f64::NAN };
        samples.current_a.push(or_gap((now_c - before_c) / dt_s));
        samples.voltage_v.push(or_gap(reader.read(voltage_v, now_s)));
        samples.temperature_c.push(reader.read(temperature_c, now_s));
        samples.soc.push(or_gap(reader.read(&soc, now_s)));
        before_c = now_c;
    }
    Ok(samples)
}

/// Reads columns at rising times, linear between rows.
struct Reader<'a> {
    time_s: &'a [f64],
    at: usize,
    /// Samples further apart are a gap \[s\].
    gap_s: f64,
}

impl Reader<'_> {
    /// Moves to the interval that holds a time; how far along it that is.
    fn seek(&mut self, at_s: f64) -> f64 {
        let t = self.time_s;
        while self.at + 2 < t.len() && t[self.at + 1] < at_s {
            self.at += 1;
        }
        let (from_s, to_s) = (t[self.at], t[(self.at + 1).min(t.len() - 1)]);
        if to_s > from_s { ((at_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0) } else { 0.0 }
    }

    fn read(&mut self, column: &[f64], at_s: f64) -> f64 {
        let along = self.seek(at_s);
        let (from, to) = (column[self.at], column[(self.at + 1).min(column.len() - 1)]);
        // At a sample its own value holds, whatever its neighbour is.
        if along == 0.0 {
            from
        } else if along == 1.0 {
            to
        } else {
            from + along * (to - from)
        }
    }

    fn logged(&mut self, at_s: f64) -> bool {
        self.seek(at_s);
        let t = self.time_s;
        t[(self.at + 1).min(t.len() - 1)] - t[self.at] <= self.gap_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::cell::CellRecord;

    fn record() -> Measurement {
        Measurement::Cell(CellRecord {
            name: "x".to_owned(),
            time_s: vec![0.0, 0.5, 1.0, 2.0, 12.0, 13.0],
            current_a: vec![1.0, 1.0, 3.0, 3.0, 3.0, 1.0],
            voltage_v: vec![4.0, 3.9, 3.8, 3.7, 3.6, 3.5],
            discharged_ah: vec![0.0, 0.1, 0.2, 0.3, 1.0, 1.1],
            cell_c: vec![20.0; 6],
            chamber_c: vec![20.0; 6],
            notes: Vec::new(),
        })
    }

    #[test]
    fn keeps_the_charge_and_marks_gaps() {
        let s = sampled(&record(), 1.0, 0.0, 2.0).unwrap();
        assert_eq!(s.current_a.len(), 13);
        assert!((s.current_a[0] - 1.5).abs() < 1e-12, "{:?}", s.current_a);
        assert!((s.current_a[1] - 3.0).abs() < 1e-12);
        assert_eq!((s.voltage_v[0], s.voltage_v[1]), (3.8, 3.7));
        assert!((s.soc[0] - 0.9).abs() < 1e-12);
        assert!(s.current_a[2..11].iter().all(|a| a.is_nan()), "{:?}", s.current_a);
        assert!(s.voltage_v[5].is_nan() && s.soc[5].is_nan() && s.temperature_c[5] == 20.0);
        assert!((s.current_a[12] - 2.0).abs() < 1e-12);
    }

    #[test]
    fn delays_the_current() {
        let s = sampled(&record(), 1.0, 1.0, 2.0).unwrap();
        assert!((s.current_a[0] - 1.0).abs() < 1e-12, "the first current flowed before, too");
        assert!((s.current_a[1] - 1.5).abs() < 1e-12);
        assert!(sampled(&record(), 20.0, 0.0, 2.0).is_err());
    }
}
