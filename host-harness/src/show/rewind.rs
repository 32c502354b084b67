//! `voltstep rewind` on a terminal.

use std::fmt::Write;

use crate::evaluate::rewind::{Change, History, Report, What};

/// What happened, and beside it what would have.
pub fn render(report: &Report, changes: &[Change]) -> String {
    let (cells, sensors) = report.size;
    let mut text = format!(
        "{cells} cells, {sensors} temperatures, {} calls in {:.3} s: {}\n\n",
        report.calls,
        report.seconds,
        if report.same { "the same bits" } else { "NOT the same bits" },
    );
    history(&mut text, "As it was", &report.was);
    if let Some(supposed) = &report.supposed {
        let changes: Vec<_> = changes.iter().map(ToString::to_string).collect();
        text.push('\n');
        history(&mut text, &format!("With {}", changes.join(", ")), supposed);
        let _ = writeln!(text, "\n{}", verdict(report.was.trips_s, supposed.trips_s));
    }
    text
}

fn history(text: &mut String, title: &str, history: &History) {
    let _ = writeln!(text, "{title}:");
    if history.events.is_empty() {
        text.push_str("  nothing happened\n");
    }
    for event in &history.events {
        let what = match &event.what {
            What::Tripped(row) => format!("{row} tripped"),
            What::Healed(row) => format!("{row} healed"),
            What::Phase(phase, cause) if cause == "None" => phase.clone(),
            What::Phase(phase, cause) => format!("{phase}, cause {cause}"),
        };
        let _ = writeln!(text, "  {:9.3} s  {what}", event.at_s);
    }
    if let Some(apart_s) = history.apart_s {
        let _ =
            writeln!(text, "  {apart_s:9.3} s  the contactors do otherwise; the rest is not known");
    }
}

/// Whether and when it would have tripped.
fn verdict(was_s: Option<f64>, supposed_s: Option<f64>) -> String {
    match (was_s, supposed_s) {
        (None, None) => "It did not trip, and would not have.".to_owned(),
        (None, Some(s)) => format!("It did not trip, and would have after {s:.3} s."),
        (Some(s), None) => format!("It tripped after {s:.3} s, and would not have by then."),
        (Some(was_s), Some(s)) => {
            let ms = 1000.0 * (s - was_s);
            let when = match ms.round() {
                0.0 => "at the same time".to_owned(),
                ms if ms < 0.0 => format!("{} ms earlier", -ms),
                ms => format!("{ms} ms later"),
            };
            format!("It tripped after {was_s:.3} s, and would have {when}.")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_whether_and_when() {
        assert_eq!(verdict(None, Some(1.5)), "It did not trip, and would have after 1.500 s.");
        assert_eq!(
            verdict(Some(2.0), None),
            "It tripped after 2.000 s, and would not have by then."
        );
        let both = |was, supposed| verdict(Some(was), Some(supposed));
        assert_eq!(both(2.0, 1.96), "It tripped after 2.000 s, and would have 40 ms earlier.");
        assert_eq!(both(2.0, 2.02), "It tripped after 2.000 s, and would have 20 ms later.");
        assert!(both(2.0, 2.0).ends_with("at the same time."));
        assert_eq!(verdict(None, None), "It did not trip, and would not have.");
    }
}
