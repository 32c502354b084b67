//! `voltstep bms` on a terminal.

use std::fmt::Write;

use crate::evaluate::campaign::{Judged, Report, Verdict};
use crate::read::scenario::Fault;
use crate::show::table::table;

/// What became of a case, in words.
pub const VERDICTS: [(Verdict, &str); 6] = [
    (Verdict::InTime, "opened in time"),
    (Verdict::Noticed, "noticed"),
    (Verdict::Harmless, "harmless"),
    (Verdict::BeyondContactors, "beyond contactors"),
    (Verdict::Missed, "missed"),
    (Verdict::Late, "late"),
];

/// A verdict in words.
pub fn words(verdict: Verdict) -> &'static str {
    VERDICTS.iter().find(|(known, _)| *known == verdict).map_or("", |(_, words)| words)
}

/// A row for each fault, what failed, the margins.
pub fn render(report: &Report) -> String {
    let mut header = vec!["fault", "cases"];
    header.extend(VERDICTS.map(|(_, words)| words));
    header.extend(["opened after [ms]", "least margin [ms]"]);
    let mut rows = table(&header);
    for fault in Fault::ALL {
        let of: Vec<&Judged> = report.cases.iter().filter(|j| j.case.fault == fault).collect();
        if of.is_empty() {
            continue;
        }
        let mut row = vec![format!("{fault:?}"), of.len().to_string()];
        for (verdict, _) in VERDICTS {
            let count = of.iter().filter(|judged| judged.verdict == verdict).count();
            row.push(if count > 0 { count.to_string() } else { String::new() });
        }
        let after = of.iter().filter_map(|judged| judged.opened_ms);
        row.push(match (after.clone().min(), after.max()) {
            (Some(least), Some(most)) => format!("{least}..{most}"),
            _ => String::new(),
        });
        let margin = of.iter().filter_map(|judged| judged.before_harm_ms).min();
        row.push(margin.map_or_else(String::new, |ms| ms.to_string()));
        rows.add_row(row);
    }
    let mut text = format!("{rows}\n");
    let failed = |judged: &&Judged| matches!(judged.verdict, Verdict::Late | Verdict::Missed);
    for judged in report.cases.iter().filter(failed).take(20) {
        let case = &judged.case;
        let _ = writeln!(
            text,
            "{:?} {:?} of {} at {} %, {} °C{}: {:?}, rows {}",
            judged.verdict,
            case.fault,
            case.much,
            100.0 * case.soc,
            case.temperature_c,
            if case.charging { ", charging" } else { "" },
            judged.harm,
            judged.rows.join(" "),
        );
    }
    for trip in report.false_trips.iter().take(20) {
        let _ = writeln!(text, "without a fault: {trip}");
    }
    let margins = report.margins_ms();
    if let (Some(least), Some(middle)) = (margins.first(), margins.get(margins.len() / 2)) {
        let _ = writeln!(
            text,
            "a cell would have left its absolute limits in {} cases, had the contactors stayed closed: \
             {least} ms after they opened at the least, {middle} ms in the median",
            margins.len(),
        );
    }
    let cases = report.cases.len();
    let counts: Vec<String> = VERDICTS
        .iter()
        .map(|(verdict, words)| format!("{} {words}", report.count(*verdict)))
        .collect();
    let _ = writeln!(text, "{cases} cases: {}", counts.join(", "));
    let _ = writeln!(
        text,
        "{} h of driving without a fault: {} false trips",
        report.hours,
        report.false_trips.len()
    );
    text
}
