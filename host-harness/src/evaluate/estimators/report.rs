//! The runs of an estimator, for a terminal and as JSON.

use anyhow::Context;
use serde::{Serialize, Serializer};

use super::{Case, Estimator, Figures, HONEST};
use crate::show::table::table;

/// One case over one measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
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
}

impl Run {
    /// Whether the standard deviation was honest where the model's range holds, which only says
    /// something where the reference is good.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        !self.notes.is_empty()
            || self.figures.inside_3_sigma_identified.is_none_or(|share| share >= HONEST)
    }
}

/// Every run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The estimator.
    #[serde(serialize_with = "in_lower_case")]
    pub estimator: Estimator,
    /// Samples per second.
    pub rate_hz: f64,
    /// A run for each measurement and case.
    pub runs: Vec<Run>,
    /// Files that are no drive cycle, and why.
    pub skipped: Vec<String>,
}

fn in_lower_case<S: Serializer>(estimator: &Estimator, s: S) -> Result<S::Ok, S::Error> {
    s.serialize_str(match estimator {
        Estimator::Coulomb => "coulomb",
        Estimator::Ekf => "ekf",
    })
}

impl Report {
    /// Whether every run's standard deviation was honest.
    #[must_use]
    pub fn is_honest(&self) -> bool {
        self.runs.iter().all(Run::is_honest)
    }

    /// For a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let mut rows = table(&[
            "measurement",
            "case",
            "RMS [%]",
            "largest [%]",
            "after 5 min [%]",
            "end [%]",
            "σ at the end [%]",
            "within 2 % [s]",
            "inside 3σ [%]",
            "beyond 5 % [s]",
        ]);
        let percent = |share: f64, digits: usize| format!("{:.digits$}", 100.0 * share);
        for run in &self.runs {
            let f = &run.figures;
            let mark = if run.is_honest() { "" } else { " !" };
            rows.add_row([
                run.name.clone(),
                run.case.name.to_owned(),
                percent(f.soc_rmse, 2),
                percent(f.soc_max, 2),
                percent(f.soc_max_after_300_s, 2),
                format!("{:+.2}", 100.0 * f.soc_error_end),
                percent(f.soc_sd_end, 2),
                f.convergence_s.map_or_else(|| "never".to_owned(), |s| format!("{s:.0}")),
                format!("{}{mark}", percent(f.inside_3_sigma_identified.unwrap_or(1.0), 1)),
                format!("{:.0}", f.outside_5_percent_s),
            ]);
        }
        let mut text = format!(
            "{rows}\nestimated less measured state of charge; inside 3σ where the model's range \
             holds, ! where below {:.0} %\n",
            100.0 * HONEST
        );
        let mut before = "";
        for run in self.runs.iter().filter(|run| !run.notes.is_empty()) {
            if run.name != before {
                for note in &run.notes {
                    text += &format!("{}: {note}\n", run.name);
                }
            }
            before = &run.name;
        }
        for why in &self.skipped {
            text += &format!("no drive cycle: {why}\n");
        }
        text
    }

    /// The JSON text, with a line end.
    ///
    /// # Errors
    /// None that is known of.
    pub fn to_json(&self) -> anyhow::Result<String> {
        let mut text = serde_json::to_string_pretty(self).context("writing JSON")?;
        text.push('\n');
        Ok(text)
    }
}
