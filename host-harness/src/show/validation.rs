//! `voltstep validate` on a terminal.

use comfy_table::{CellAlignment, Table, presets};

use crate::verify::{Check, ValidationReport};

/// Places of a figure.
const DIGITS: usize = 6;

fn number(x: Option<f64>) -> String {
    let Some(x) = x.filter(|x| x.is_finite()) else { return "–".to_owned() };
    let size = x.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{x:.2e}");
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small")]
    let before = if size >= 1.0 { size.log10().floor() as usize + 1 } else { 1 };
    format!("{x:.*}", DIGITS.saturating_sub(before))
}

/// Whether it passed, in a word.
pub fn verdict(check: &Check) -> &'static str {
    match (check.pass, check.obtained) {
        (Some(true), _) => "pass",
        (Some(false), _) => "FAIL",
        (None, Some(_)) => "shown",
        (None, None) => "SKIPPED",
    }
}

/// What was published, the target, what was obtained, how far it may be off.
pub fn numbers(check: &Check) -> [String; 4] {
    let bounded = check.target.is_none() && check.tolerance.is_some();
    let sign = if bounded { "≤ " } else { "± " };
    [
        check.published.unwrap_or("").to_owned(),
        check.target.map_or_else(String::new, |t| number(Some(t))),
        number(check.obtained),
        check.tolerance.map_or_else(String::new, |t| format!("{sign}{}", number(Some(t)))),
    ]
}

/// A row for each check; a line for each that failed or was skipped.
pub fn figures(checks: &[Check]) -> (Table, String) {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED);
    table.set_header([
        "quantity",
        "published",
        "target",
        "obtained",
        "tolerance",
        "verdict",
        "source of the target",
    ]);
    for column in table.column_iter_mut().skip(1).take(4) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let mut case = "";
    let mut notes = String::new();
    for check in checks {
        if check.name != case {
            case = &check.name;
            table.add_row([format!("▸ {case}")]);
        }
        let [published, target, obtained, tolerance] = numbers(check);
        table.add_row([
            format!("  {}", check.quantity),
            published,
            target,
            obtained,
            tolerance,
            verdict(check).to_owned(),
            check.source.to_owned(),
        ]);
        if check.pass == Some(false) || check.obtained.is_none() {
            let (name, quantity, reason) = (&check.name, &check.quantity, &check.reason);
            notes += &format!("{}: {name}: {quantity}: {reason}\n", verdict(check));
        }
    }
    (table, notes)
}

/// The table, then what failed or was skipped.
pub fn render(report: &ValidationReport) -> String {
    let (table, notes) = figures(&report.cases);
    format!(
        "{table}\n\
         published: what the source work prints where that contradicts itself or its own \
         equations; shown, no target.\n\
         {notes}{} passed, {} failed, {} skipped, in {:.1} s\n",
        report.passed, report.failed, report.skipped, report.wall_s
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_lie() {
        for (x, text) in [
            (0.742_092_8, "0.74209"),
            (-1043.24, "-1043.24"),
            (1e-7, "1.00e-7"),
            (0.0, "0.00000"),
            (3.2e8, "3.20e8"),
        ] {
            assert_eq!(number(Some(x)), text);
        }
        assert_eq!((number(None), number(Some(f64::NAN))), ("–".to_owned(), "–".to_owned()));
    }

    #[test]
    fn what_failed_or_was_skipped_is_said_below_the_table() {
        let cases = vec![
            Check::without("broken", "the run", Some(false), "on purpose".to_owned()),
            Check::without("absent", "SKIPPED", None, "nothing there".to_owned()),
        ];
        let report = ValidationReport {
            cases,
            covered: Vec::new(),
            passed: 0,
            failed: 1,
            skipped: 1,
            wall_s: 0.0,
        };
        let text = render(&report);
        for line in [
            "FAIL: broken: the run: on purpose",
            "SKIPPED: absent: SKIPPED: nothing there",
            "0 passed, 1 failed, 1 skipped",
        ] {
            assert!(text.contains(line), "{text}");
        }
    }

    #[test]
    fn a_row_says_target_tolerance_and_verdict() {
        let row = |target, tolerance, pass| {
            let check = Check {
                target,
                tolerance,
                obtained: Some(1.5),
                ..Check::without("case", "figure", pass, String::new())
            };
            let report = ValidationReport {
                cases: vec![check],
                covered: Vec::new(),
                passed: 1,
                failed: 0,
                skipped: 0,
                wall_s: 0.0,
            };
            let text = render(&report);
            text.lines().find(|line| line.contains("figure")).unwrap().to_owned()
        };
        for (row, words) in [
            (row(Some(1.25), Some(0.5), Some(true)), ["1.25000", "± 0.50000", "pass"]),
            (row(None, Some(2.0), Some(true)), ["1.50000", "≤ 2.00000", "pass"]),
            (row(None, None, None), ["", "1.50000", "shown"]),
        ] {
            assert!(words.iter().all(|word| row.contains(word)), "{row}");
        }
    }
}
