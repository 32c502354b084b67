//! What the samples of a run come to.

use serde::Serialize;

/// A flag may come so much later than the truth has left \[s\].
const LATE_S: f64 = 60.0;

/// What an estimator says at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    /// What it is asked for.
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// It says that something contradicts.
    pub contradicted: bool,
    /// It says that it is outside what it knows.
    pub outside_known: bool,
}

/// Counts of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Tally {
    samples: f64,
    inside: f64,
    silent: f64,
    flagged: f64,
    sum_sd: f64,
    sum_square: f64,
    outside_s: f64,
    /// The largest error in standard deviations.
    pub worst: f64,
}

impl Tally {
    /// One sample, `dt_s` after the last.
    pub fn book(&mut self, said: Said, truth: f64, dt_s: f64) {
        let Said { value, sd, contradicted, outside_known } = said;
        let apart = (value - truth).abs() / sd;
        let flagged = contradicted || outside_known;
        let inside = apart <= 3.0;
        self.outside_s = if inside { 0.0 } else { self.outside_s + dt_s };
        let count = |yes: bool| f64::from(u8::from(yes));
        self.samples += 1.0;
        self.inside += count(inside);
        self.silent += count(self.outside_s > LATE_S && !flagged);
        self.flagged += count(contradicted);
        self.sum_sd += sd;
        self.sum_square += (apart * sd) * (apart * sd);
        self.worst = self.worst.max(apart);
    }

    /// Share of the samples with the truth inside three standard deviations.
    #[must_use]
    pub fn inside(&self) -> f64 {
        self.inside / self.samples
    }

    /// Share of the samples outside for more than a minute, without a flag.
    #[must_use]
    pub fn silent(&self) -> f64 {
        self.silent / self.samples
    }

    /// Share of the samples that are flagged.
    #[must_use]
    pub fn flagged(&self) -> f64 {
        self.flagged / self.samples
    }

    /// The mean standard deviation.
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.sum_sd / self.samples
    }

    /// The mean square of the error.
    #[must_use]
    pub fn mean_square(&self) -> f64 {
        self.sum_square / self.samples
    }
}
