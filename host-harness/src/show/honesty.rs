//! `voltstep soc --matrix` without files, on a terminal.

use crate::evaluate::estimators::honesty::Report;
use crate::show::table::table;

/// A row for each kind of trouble on each battery.
pub fn render(report: &Report) -> String {
    let mut rows = table(&[
        "what is wrong",
        "battery",
        "inside 3σ [%]",
        "at worst [%]",
        "silent [%]",
        "flagged [%]",
        "largest error [σ]",
        "σ [%]",
        "RMS error / σ",
    ]);
    let percent = |share: f64| format!("{:.2}", 100.0 * share);
    for group in &report.groups {
        let (mean, worst) = group.inside();
        let mark = if group.is_honest() { "" } else { " !" };
        rows.add_row([
            format!("{}{mark}", group.kind.words()),
            group.chemistry.word().to_owned(),
            percent(mean),
            percent(worst),
            percent(group.silent()),
            percent(group.flagged()),
            format!("{:.1}", group.worst()),
            percent(group.sd()),
            format!("{:.2}", group.ratio()),
        ]);
    }
    format!(
        "{rows}\nstate of charge of simulated batteries; silent: outside for more than a minute \
         without a flag; ! where it is not as honest as it must be\n"
    )
}
