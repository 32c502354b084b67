//! The table of verdicts.

use std::fmt::Write;
use std::time::Duration;

/// How a part ended.
pub enum Verdict {
    Passed(Duration),
    Failed(Duration),
    NotRun,
}

/// One line per part: name, verdict, time.
pub fn table(rows: &[(&str, Verdict)]) -> String {
    let mut text = format!("{:<10}{:<10}{:>9}\n", "part", "verdict", "time");
    for (name, verdict) in rows {
        let (word, time) = match verdict {
            Verdict::Passed(time) => ("ok", seconds(*time)),
            Verdict::Failed(time) => ("FAILED", seconds(*time)),
            Verdict::NotRun => ("not run", String::from("-")),
        };
        let _ = writeln!(text, "{name:<10}{word:<10}{time:>9}");
    }
    text
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_per_part() {
        let rows = [
            ("format", Verdict::Passed(Duration::from_millis(1234))),
            ("clippy", Verdict::Failed(Duration::from_secs(62))),
            ("docs", Verdict::NotRun),
        ];
        let expected = "\
part      verdict        time
format    ok            1.2 s
clippy    FAILED       62.0 s
docs      not run           -
";
        assert_eq!(table(&rows), expected);
    }
}
