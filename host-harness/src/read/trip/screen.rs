//! Which of a trip's channels can be believed, by rules that look at the measurement alone: never
//! at how well a model follows it.

use super::{Trip, mean};

/// A pulse of the heating's power lasts this long at most \[s\] …
const PULSE_S: f64 = 2.0;
/// … stands out by this \[W\] …
const PULSE_W: f64 = 1000.0;
/// … and is none of the heating's if as many have the very same height.
const EQUAL_PULSES: usize = 3;
/// At standstill the battery gives more than is reported: in the median by this \[W\] …
const LEAST_MEDIAN_W: f64 = 100.0;
/// … and in nine samples of ten by this; readings come at different times \[W\].
const LEAST_TENTH_W: f64 = -300.0;
/// Fewer samples at standstill tell nothing.
const LEAST_STANDING: usize = 50;
/// Heating that was asked for, above what is reported, by this on average \[W\]: where did it go?
const UNREPORTED_W: f64 = 1000.0;
/// A car that moves on constant voltage and current for this long \[s\] was not measured …
const FROZEN_S: f64 = 10.0;
/// … if the readings are dense enough that one of them should have differed.
const FROZEN_SAMPLES: usize = 20;

/// What a trip's auxiliary loads drew, as far as can be believed.
#[derive(Clone, Debug, PartialEq)]
pub struct Screened {
    /// Heating and air conditioning at each sample \[W\], never below 0.
    pub auxiliary_w: Vec<f64>,
    /// What was repaired, in words.
    pub notes: Vec<String>,
    /// Why the trip's energy cannot be judged by them, in words.
    pub doubts: Vec<String>,
}

impl Trip {
    /// Heating and air conditioning, repaired:
    /// - three or more pulses of the heating of the same height, none longer than 2 s, are held at
    ///   the value before each,
    /// - the heating is the first of what the buses LIN and CAN report, what was asked for, or
    ///   none, that leaves the battery something to give at standstill: 100 W in the median, −300 W
    ///   in the 10th percentile.
    ///
    /// Doubtful is a trip where none of these does, and one with more heating asked for than
    /// reported by 1 kW on average.
    #[must_use]
    pub fn screened(&self) -> Screened {
        let (mut notes, mut doubts) = (Vec::new(), Vec::new());
        let aircon: Vec<f64> = self.aircon_w.iter().map(|w| w.max(0.0)).collect();
        let sources = [
            ("LIN bus", &self.heating_lin_w),
            ("CAN bus", &self.heating_w),
            ("request", &self.heating_requested_w),
        ];
        let mut found: Vec<(&str, Vec<f64>, Option<String>)> = (sources.into_iter())
            .filter(|(_, heating)| heating.iter().any(|w| w.is_finite()))
            .map(|(name, heating)| {
                let (heating, repaired) = self.without_pulses(heating);
                (name, heating, repaired)
            })
            .collect();
        found.push(("none", vec![0.0; self.len()], None));
        let fits = |heating: &[f64]| self.leaves_something(&aircon, heating);
        let chosen = found.iter().position(|(_, heating, _)| fits(heating));
        if chosen.is_none() {
            doubts.push(
                "no report of the heating fits what the battery gives at standstill".to_owned(),
            );
        }
        let chosen = chosen.unwrap_or(0);
        let (name, heating, repaired) = found.swap_remove(chosen);
        if chosen > 0 && name != "CAN bus" {
            notes.push(format!(
                "heating by its {name}: what is reported does not fit what the battery gives at \
                 standstill"
            ));
        }
        notes.extend(repaired);
        let unreported =
            (heating.iter().zip(&self.heating_requested_w)).map(|(w, asked)| asked - w);
        if let Some(w) = mean(unreported).filter(|w| *w > UNREPORTED_W) {
            doubts.push(format!("{:.1} kW of heating asked for and not reported", w / 1000.0));
        }
        let auxiliary_w = aircon.iter().zip(&heating).map(|(a, h)| a + h).collect();
        Screened { auxiliary_w, notes, doubts }
    }

    /// Why a comparison with this trip would say little of a model, in words: [`unfit`](Self::unfit),
    /// and what is doubtful of its auxiliary loads.
    #[must_use]
    pub fn marked(&self, capacity_ah: f64) -> Vec<String> {
        let mut reasons = self.unfit(capacity_ah);
        reasons.extend(self.screened().doubts);
        reasons
    }

    /// A report of the heating, 0 where missing and never below 0, without pulses of equal height;
    /// what was repaired.
    fn without_pulses(&self, heating: &[f64]) -> (Vec<f64>, Option<String>) {
        let mut heating: Vec<f64> = heating.iter().map(|w| w.max(0.0)).collect();
        // Where the value changes: first sample of each run.
        let mut starts: Vec<usize> =
            (0..heating.len()).filter(|&i| i == 0 || heating[i] != heating[i - 1]).collect();
        starts.push(heating.len());
        let pulses: Vec<(usize, usize)> = starts
            .windows(2)
            .map(|run| (run[0], run[1]))
            .filter(|&(from, to)| from > 0 && to < heating.len())
            .filter(|&(from, to)| {
                let out = |other: f64| heating[from] - other > PULSE_W;
                out(heating[from - 1])
                    && out(heating[to])
                    && self.time_s[to] - self.time_s[from] <= PULSE_S
            })
            .collect();
        let equal = |&(from, _): &(usize, usize)| {
            let height = heating[from];
            pulses.iter().filter(|(other, _)| heating[*other] == height).count()
        };
        let wrong: Vec<(usize, usize)> =
            pulses.iter().copied().filter(|pulse| equal(pulse) >= EQUAL_PULSES).collect();
        let note = wrong.first().map(|&(from, _)| {
            format!(
                "{} pulses of the heating of the same height, {:.2} kW at first: held at the \
                 value before",
                wrong.len(),
                heating[from] / 1000.0
            )
        });
        for (from, to) in wrong {
            let before = heating[from - 1];
            heating[from..to].fill(before);
        }
        (heating, note)
    }

    /// Whether the battery gives at standstill what the auxiliary loads are said to draw.
    fn leaves_something(&self, aircon: &[f64], heating: &[f64]) -> bool {
        let mut rest: Vec<f64> = (0..self.len())
            .filter(|&i| self.speed_m_s[i] == 0.0)
            .map(|i| self.battery_v[i] * self.battery_a[i] - aircon[i] - heating[i])
            .collect();
        rest.sort_unstable_by(f64::total_cmp);
        let n = rest.len();
        n < LEAST_STANDING || rest[n / 2] > LEAST_MEDIAN_W && rest[n / 10] > LEAST_TENTH_W
    }

    /// The trip without the samples in which it moved while voltage and current stood still for
    /// 10 s or more, and what was cut. At the ends the trip gets shorter, in between it gets a gap.
    #[must_use]
    pub fn without_frozen(mut self) -> Self {
        let stands = |i: usize| {
            self.speed_m_s[i] > 0.0
                && self.battery_v[i] == self.battery_v[i - 1]
                && self.battery_a[i] == self.battery_a[i - 1]
        };
        let n = self.len();
        let mut keep = vec![true; n];
        let mut notes = Vec::new();
        let mut start = 0;
        for i in 1..=n {
            if i < n && stands(i) {
                continue;
            }
            let (from_s, to_s) = (self.time_s[start], self.time_s[i - 1]);
            if to_s - from_s >= FROZEN_S && i - start >= FROZEN_SAMPLES {
                // The first was measured.
                keep[start + 1..i].fill(false);
                notes.push(format!(
                    "voltage and current stand still from {from_s:.1} s to {to_s:.1} s while it \
                     moves: cut"
                ));
            }
            start = i;
        }
        if notes.is_empty() || keep.iter().filter(|k| **k).count() < 2 {
            return self;
        }
        for channel in self.channels() {
            let mut keep = keep.iter();
            channel.retain(|_| *keep.next().unwrap_or(&true));
        }
        self.notes.extend(notes);
        self
    }

    /// Every channel, to cut them alike.
    fn channels(&mut self) -> [&mut Vec<f64>; 14] {
        [
            &mut self.time_s,
            &mut self.speed_m_s,
            &mut self.elevation_m,
            &mut self.motor_torque_nm,
            &mut self.battery_v,
            &mut self.battery_a,
            &mut self.battery_c,
            &mut self.soc,
            &mut self.heating_w,
            &mut self.aircon_w,
            &mut self.ambient_c,
            &mut self.throttle,
            &mut self.heating_lin_w,
            &mut self.heating_requested_w,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 s at 10 Hz, at standstill for the first half, the battery giving 500 W beside what the
    /// auxiliary loads truly draw.
    fn trip(heating_w: impl Fn(usize) -> f64) -> Trip {
        let n = 1000;
        let truth: Vec<f64> = (0..n).map(heating_w).collect();
        Trip {
            time_s: (0..n).map(|i| i as f64 * 0.1).collect(),
            speed_m_s: (0..n).map(|i| if i < 500 { 0.0 } else { 10.0 }).collect(),
            battery_v: (0..n).map(|i| 390.0 + (i % 3) as f64).collect(),
            battery_a: (0..n).map(|i| (500.0 + truth[i]) / (390.0 + (i % 3) as f64)).collect(),
            heating_w: truth,
            ..Trip::empty("t", n)
        }
    }

    #[test]
    fn a_sound_trip_stays_as_it_is() {
        let t = trip(|i| if i % 300 < 100 { 2000.0 } else { 400.0 });
        let s = t.screened();
        assert_eq!((&s.auxiliary_w, s.notes.len(), s.doubts.len()), (&t.heating_w, 0, 0));
        assert_eq!(t.clone().without_frozen().len(), t.len());
    }

    #[test]
    fn pulses_of_one_height_are_held_at_the_value_before() {
        let mut t = trip(|_| 300.0);
        let pulse = |t: &mut Trip, at: usize| t.heating_w[at..at + 10].fill(5520.0);
        pulse(&mut t, 20);
        pulse(&mut t, 600);
        assert_eq!(t.screened().auxiliary_w[605], 5520.0, "two may be true");
        pulse(&mut t, 800);
        let s = t.screened();
        assert!(s.auxiliary_w.iter().all(|w| *w == 300.0), "{:?}", s.notes);
        assert!(s.notes[0].starts_with("3 pulses"), "{:?}", s.notes);
    }

    #[test]
    fn a_report_that_the_battery_does_not_know_of_gives_way_to_the_next() {
        let mut t = trip(|_| 300.0);
        t.heating_requested_w = t.heating_w.clone();
        t.heating_w = (0..1000).map(|i| 2000.0 + f64::from(i)).collect();
        let s = t.screened();
        assert!(s.auxiliary_w.iter().all(|w| *w == 300.0) && s.notes[0].contains("request"));
        t.heating_requested_w = vec![f64::NAN; 1000];
        let s = t.screened();
        assert!(s.auxiliary_w.iter().all(|w| *w == 0.0) && s.notes[0].contains("none"));
        // Even none does not fit.
        t.battery_a = vec![0.0; 1000];
        assert_eq!(t.screened().doubts.len(), 1);
    }

    #[test]
    fn heating_that_was_asked_for_and_not_reported_makes_a_trip_doubtful() {
        let mut t = trip(|_| 300.0);
        t.heating_requested_w = vec![1200.0; 1000];
        assert!(t.screened().doubts.is_empty());
        t.heating_requested_w = vec![1400.0; 1000];
        assert!(t.screened().doubts[0].contains("1.1 kW"));
    }

    #[test]
    fn frozen_stretches_are_cut_and_named() {
        let mut t = trip(|_| 300.0);
        for i in 700..850 {
            t.battery_v[i] = 380.0;
            t.battery_a[i] = 20.0;
        }
        let cut = t.clone().without_frozen();
        assert_eq!((cut.len(), cut.soc.len()), (851, 851));
        assert!(cut.notes[0].contains("from 70.0 s to 84.9 s"), "{:?}", cut.notes);
        // A car that stands may well draw the same for a while.
        t.speed_m_s = vec![0.0; 1000];
        assert_eq!(t.without_frozen().len(), 1000);
    }
}
