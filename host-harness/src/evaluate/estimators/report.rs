//! What the runs of an estimator came to.

use serde::Serialize;

use super::{Case, Estimator, Figures, HONEST};

/// One case over one measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimatorRun {
    /// The measurement.
    pub name: String,
    /// The battery whose parameters were used.
    pub battery: String,
    /// What was made wrong.
    pub case: Case,
    /// Highest less lowest state of charge.
    pub soc_span: f64,
    /// How good it was.
    #[serde(flatten)]
    pub figures: Figures,
    /// What the reader should know.
    pub notes: Vec<String>,
    /// The reference cannot be trusted: the measurement contradicts itself.
    pub reference_doubtful: bool,
}

impl EstimatorRun {
    /// Whether the standard deviation was honest where the model's range holds, which only says
    /// something where the reference is good.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        self.reference_doubtful
            || self.figures.inside_3_sigma_identified.is_none_or(|share| share >= HONEST)
    }
}

/// Every run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EstimatorReport {
    /// The estimator.
    pub estimator: Estimator,
    /// Samples per second.
    pub rate_hz: f64,
    /// A run for each measurement and case.
    pub runs: Vec<EstimatorRun>,
    /// Files that are no drive cycle, and why.
    pub skipped: Vec<String>,
}

impl EstimatorReport {
    /// Whether every run's standard deviation was honest.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        self.runs.iter().all(EstimatorRun::is_honest)
    }
}
