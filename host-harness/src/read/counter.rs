//! A cell test's charge counter against the integral of its current: conventions are checked, not
//! believed.

use super::cell::{CellRecord, charge_ah, gap_s};

/// The charge that was logged without gaps tells something where it is this share of what the
/// counter spans.
const TELLING: f64 = 0.02;
/// … over this many steps.
const TELLING_STEPS: usize = 50;
/// Counter over integral: as close to 1 as sampling lets it be …
const AGREES: (f64, f64) = (0.8, 1.25);
/// … and for charging that is not counted, this close to 0, where it is this share of the
/// discharging.
const UNCOUNTED: f64 = 0.2;
/// A counter restarts where it falls to this share of its span from well above.
const RESTARTED: f64 = 0.02;

impl CellRecord {
    /// What is wrong with the counter or the sign of the current, in words, and what to do.
    pub(crate) fn counter_fault(&self) -> Option<String> {
        let integral = charge_ah(&self.time_s, &self.current_a);
        let gap_s = gap_s(&self.time_s);
        let counter = &self.discharged_ah;
        let (low, high) = (counter.iter().copied())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(q), h.max(q)));
        let span_ah = high - low;
        // Out and back: by the current, by the counter.
        let (mut out, mut back) = ((0.0, 0.0), (0.0, 0.0));
        let (mut restarts, mut compared) = (Vec::new(), 0);
        for i in 1..counter.len() {
            if self.time_s[i] - self.time_s[i - 1] > gap_s {
                continue;
            }
            let (flowed, counted) = (integral[i] - integral[i - 1], counter[i] - counter[i - 1]);
            let jumps = (counted - flowed).abs() > RESTARTED * span_ah + 10.0 * flowed.abs();
            if jumps && counter[i].abs() <= RESTARTED * span_ah {
                restarts.push(self.time_s[i]);
                continue;
            }
            compared += 1;
            if flowed > 0.0 {
                out = (out.0 + flowed, out.1 + counted);
            } else {
                back = (back.0 - flowed, back.1 - counted);
            }
        }
        if let Some(first_s) = restarts.first() {
            return Some(format!(
                "the charge counter restarts at {first_s:.1} s ({} times in all); expected one \
                 count from full: add what was counted before, or leave the column out",
                restarts.len()
            ));
        }
        let flowed_ah = out.0 + back.0;
        if compared < TELLING_STEPS || flowed_ah <= TELLING * span_ah || flowed_ah <= 0.0 {
            return None;
        }
        let ratio = (out.1 + back.1) / flowed_ah;
        let agrees = |ratio: f64| (AGREES.0..=AGREES.1).contains(&ratio);
        if agrees(-ratio) {
            return Some(
                "the sign of the current is reversed: the charge counter rises while the current is \
                 negative; expected a current that is positive when discharging: multiply it by -1"
                    .to_owned(),
            );
        }
        if back.0 > UNCOUNTED * out.0
            && out.0 > UNCOUNTED * back.0
            && agrees(out.1 / out.0)
            && (back.1 / back.0).abs() < UNCOUNTED
        {
            return Some(format!(
                "the charge counter counts discharging only: {:.3} A·h that were charged are not in \
                 it; expected the net charge: leave the column out",
                back.0
            ));
        }
        (!agrees(ratio)).then(|| {
            format!(
                "the charge counter says {ratio:.2} times what the current says ({:.3} against \
                 {flowed_ah:.3} A·h): one of both has the wrong scale",
                ratio * flowed_ah
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An hour of 2 A out, a pause, half an hour of 2 A back.
    fn record(counter: impl Fn(f64, f64) -> f64, sign: f64) -> CellRecord {
        let n = 700_u16;
        let time_s: Vec<f64> = (0..n).map(|i| f64::from(i) * 10.0).collect();
        let amps = |t: f64| match t {
            t if t < 3600.0 => 2.0,
            t if t < 4800.0 => 0.0,
            _ => -2.0,
        };
        let truth: Vec<f64> = time_s.iter().map(|t| amps(*t)).collect();
        let charge = charge_ah(&time_s, &truth);
        CellRecord {
            discharged_ah: time_s.iter().zip(&charge).map(|(t, q)| counter(*t, *q)).collect(),
            current_a: truth.iter().map(|a| sign * a).collect(),
            time_s,
            ..CellRecord::default()
        }
    }

    #[test]
    fn a_counter_that_agrees_is_not_refused_and_others_are_named() {
        let fault = |counter: fn(f64, f64) -> f64, sign| record(counter, sign).counter_fault();
        assert_eq!(fault(|_, q| q, 1.0), None);
        assert_eq!(fault(|_, q| 1.05 * q + 0.3, 1.0), None);
        for (counter, sign, expected) in [
            ((|_, q| q) as fn(f64, f64) -> f64, -1.0, "sign of the current is reversed"),
            (|_, q| 2.0 * q, 1.0, "says 2.00 times"),
            (|_, q| q / 1000.0, 1.0, "says 0.00 times"),
            (|t, q| if t < 4000.0 { q } else { 2.0 }, 1.0, "counts discharging only"),
            (
                |t, q| q - 2.0 * (t / 1800.0).floor().min(2.0) / 2.0,
                1.0,
                "restarts at 1800.0 s (2 times",
            ),
        ] {
            let said = fault(counter, sign).unwrap_or_default();
            assert!(said.contains(expected), "{expected}: {said}");
        }
    }
}
