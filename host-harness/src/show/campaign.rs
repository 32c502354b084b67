//! `voltstep bms` on a terminal.

use std::fmt::Write;

use crate::evaluate::campaign::{Case, Judged, Report, Verdict};
use crate::show::table::table;

/// A verdict in words.
pub const fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::InTime => "opened in time",
        Verdict::Noticed => "noticed",
        Verdict::Harmless => "harmless",
        Verdict::BeyondContactors => "beyond contactors",
        Verdict::Missed => "missed",
        Verdict::Late => "late",
    }
}

/// How many cases ended how, in words.
pub fn counts(report: &Report) -> String {
    Verdict::ALL.map(|one| format!("{} {}", report.count(one), words(one))).join(", ")
}

/// What was not noticed, as a share of all cases \[%\].
pub fn harmless_percent(report: &Report) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few thousand")]
    let share = report.count(Verdict::Harmless) as f64 / report.cases.len().max(1) as f64;
    100.0 * share
}

/// A row for each fault, why what was not noticed need not be, what failed, the margins.
pub fn render(report: &Report) -> String {
    let mut header = vec!["fault", "cases"];
    header.extend(Verdict::ALL.map(words));
    header.extend(["opened after [ms]", "least margin [ms]"]);
    let mut rows = table(&header);
    for kind in &report.kinds {
        let mut row = vec![format!("{:?}", kind.fault), kind.cases().to_string()];
        let count = |count: usize| if count > 0 { count.to_string() } else { String::new() };
        row.extend(kind.ended.map(count));
        let after = kind.opened_ms.map(|(least, most)| format!("{least}..{most}"));
        row.push(after.unwrap_or_default());
        row.push(kind.least_before_harm_ms.map_or_else(String::new, |ms| ms.to_string()));
        rows.add_row(row);
    }
    let mut text = format!("{rows}\n");
    if !report.unnoticed.is_empty() {
        let mut rows = table(&["harmless", "cases", "why it need not be noticed"]);
        for of in &report.unnoticed {
            let fault = format!("{:?}", of.fault);
            rows.add_row([fault, of.cases.to_string(), of.reason.to_owned()]);
        }
        let _ = writeln!(text, "{rows}");
    }
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
    let ended = report.cases.iter().filter(|judged| judged.at_the_end).count();
    let _ = writeln!(text, "of what was noticed {ended} only when the drive had ended");
    for judged in report.cases.iter().filter(|judged| !judged.without.is_empty()).take(20) {
        let Case { soc, temperature_c, .. } = judged.case;
        let rows = judged.without.join(" ");
        let _ = writeln!(text, "without the fault, {} %, {temperature_c} °C: {rows}", 100.0 * soc);
    }
    let _ = writeln!(
        text,
        "{} cases: {}; {:.1} % harmless",
        report.cases.len(),
        counts(report),
        harmless_percent(report),
    );
    let _ = writeln!(
        text,
        "{} h of driving without a fault: {} false trips",
        report.hours,
        report.false_trips.len()
    );
    text
}
