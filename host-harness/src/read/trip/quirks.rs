//! What looks wrong in a trip's samples, though each of them may be true.

use super::{Trip, integral};

/// Samples further apart than this are a gap \[s\].
const GAP_S: f64 = 2.0;
/// How many gaps are named one by one.
const NAMED_GAPS: usize = 5;
/// The state of charge must change by this for a comparison with the ampere-hours.
const TELLING_SOC: f64 = 0.05;
/// … and by this to tell the sign of the current.
const SIGN_SOC: f64 = 0.008;
/// How far the capacity that a trip implies may lie from the battery's, as a ratio.
const CAPACITY_TOLERANCE: f64 = 0.15;
/// Three samples of a line lie this close to it: two roundings to two decimals \[V, A, km/h\].
const STRAIGHT: f64 = 0.0201;
/// A line in speed, voltage and current at once is no driving if it lasts this long \[s\] …
const STRAIGHT_S: f64 = 5.0;
/// … and the current does not merely stand still \[A\].
const STRAIGHT_CHANGE_A: f64 = 2.0;
/// At standstill, powers that exceed the battery's by this were not drawn from it \[W\].
const PHANTOM_W: f64 = 500.0;

impl Trip {
    /// What looks wrong, in words, for a battery of `capacity_ah`:
    /// - missing samples of the state of charge,
    /// - gaps in time above 2 s,
    /// - gaps that were filled with straight lines,
    /// - a change of the state of charge, 5 points at least, that does not fit the ampere-hours to
    ///   15 %,
    /// - heating and air conditioning above what the battery gives at standstill although they were
    ///   [screened](Self::screened), or below 0.
    #[must_use]
    pub fn quirks(&self, capacity_ah: f64) -> Vec<String> {
        let mut quirks = Vec::new();
        let missing = self.missing_soc();
        if missing > 0 {
            quirks.push(format!("{} missing", counted(missing, "SoC sample")));
        }
        self.gaps(&mut quirks);
        self.straight_lines(&mut quirks);
        quirks.extend(self.soc_reference(capacity_ah));
        self.auxiliaries(&mut quirks);
        quirks
    }

    /// Why a comparison with this trip would say nothing of the model, in words: measurements that
    /// were not measured, a state of charge that does not fit the ampere-hours.
    #[must_use]
    pub fn unfit(&self, capacity_ah: f64) -> Vec<String> {
        let mut reasons = Vec::new();
        self.straight_lines(&mut reasons);
        reasons.extend(self.soc_reference(capacity_ah));
        reasons
    }

    fn gaps(&self, quirks: &mut Vec<String>) {
        let mut gaps = self.time_s.windows(2).filter(|t| t[1] - t[0] > GAP_S);
        for t in gaps.by_ref().take(NAMED_GAPS) {
            let start_s = t[0];
            quirks.push(format!(
                "time gap of {} s at {} s",
                rounded(t[1] - start_s),
                rounded(start_s)
            ));
        }
        let more = gaps.count();
        if more > 0 {
            quirks.push(format!("{} more", counted(more, "time gap")));
        }
    }

    /// Speed, voltage and current that run along straight lines together were not measured.
    fn straight_lines(&self, quirks: &mut Vec<String>) {
        let bend = |values: &[f64], i: usize| {
            let t = &self.time_s;
            let along = (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1]);
            (values[i] - values[i - 1] - along * (values[i + 1] - values[i - 1])).abs()
        };
        let straight = |i: usize| {
            bend(&self.battery_a, i) < STRAIGHT
                && bend(&self.battery_v, i) < STRAIGHT
                && bend(&self.speed_m_s, i) * 3.6 < STRAIGHT
        };
        let n = self.len();
        let mut start = 0;
        for i in 1..n {
            if i + 1 < n && straight(i) {
                continue;
            }
            let (from_s, to_s) = (self.time_s[start], self.time_s[i]);
            let change_a = (self.battery_a[i] - self.battery_a[start]).abs();
            // Three samples at least, or any gap would be a line.
            if i > start + 1 && to_s - from_s >= STRAIGHT_S && change_a >= STRAIGHT_CHANGE_A {
                quirks.push(format!(
                    "speed, voltage and current follow straight lines from {} s to {} s: \
                     a gap that was filled in, not measured",
                    rounded(from_s),
                    rounded(to_s),
                ));
            }
            start = i;
        }
    }

    /// Whether the change of the state of charge fits the ampere-hours meanwhile.
    fn soc_reference(&self, capacity_ah: f64) -> Option<String> {
        let first = self.soc.iter().position(|s| s.is_finite())?;
        let last = self.soc.iter().rposition(|s| s.is_finite())?;
        let drop = self.soc[first] - self.soc[last];
        let ampere_hours =
            integral(&self.time_s[first..=last], &self.battery_a[first..=last]) / 3600.0;
        let implied_ah = ampere_hours / drop;
        let fits = (implied_ah - capacity_ah).abs() <= CAPACITY_TOLERANCE * capacity_ah;
        let tells = drop.abs() >= TELLING_SOC && !fits;
        // A sign shows sooner than a scale, and is no matter of a few percent.
        if drop.abs() >= SIGN_SOC && (-2.0..=-0.5).contains(&(implied_ah / capacity_ah)) {
            return Some(format!(
                "the sign of the current is reversed: the SoC drops by {:.1} points while {:.1} Ah \
                 flow in; expected a current that is positive when charging",
                100.0 * drop,
                -ampere_hours
            ));
        }
        tells.then(|| {
            format!(
                "SoC drop does not fit the ampere-hours: {:.1} points for {ampere_hours:.1} Ah \
                 ({implied_ah:.0} Ah per 100 %)",
                100.0 * drop,
            )
        })
    }

    fn auxiliaries(&self, quirks: &mut Vec<String>) {
        let negative =
            (0..self.len()).filter(|&i| self.heating_w[i] < 0.0 || self.aircon_w[i] < 0.0).count();
        if negative > 0 {
            quirks.push(format!(
                "heating or air conditioning below 0 in {}, taken as 0",
                counted(negative, "sample")
            ));
        }
        let standing = (0..self.len()).filter(|&i| self.speed_m_s[i] == 0.0);
        let auxiliary_w = self.screened().auxiliary_w;
        let phantom =
            |&i: &usize| auxiliary_w[i] > self.battery_v[i] * self.battery_a[i] + PHANTOM_W;
        let (standing, phantoms) =
            standing.fold((0, 0), |(n, k), i| (n + 1, k + usize::from(phantom(&i))));
        if phantoms > 0 {
            quirks.push(format!(
                "heating and air conditioning exceed what the battery gives in {phantoms} of {} \
                 at standstill",
                counted(standing, "sample")
            ));
        }
    }
}

/// A count with its noun.
fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// To a tenth, without a needless zero.
fn rounded(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
}
