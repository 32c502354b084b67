//! `voltstep soc` on a terminal.

use crate::evaluate::estimators::{EstimatorReport, HONEST};
use crate::show::table::table;

/// A row for each run, then what the reader should know.
pub fn render(report: &EstimatorReport) -> String {
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
    for run in &report.runs {
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
    for run in report.runs.iter().filter(|run| !run.notes.is_empty()) {
        if run.name != before {
            for note in &run.notes {
                text += &format!("{}: {note}\n", run.name);
            }
        }
        before = &run.name;
    }
    for why in &report.skipped {
        text += &format!("no drive cycle: {why}\n");
    }
    text
}
