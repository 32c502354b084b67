//! `voltstep bms SCENARIO.toml` on a terminal.

use std::fmt::Write;

use crate::evaluate::campaign::Verdict;
use crate::evaluate::campaign::scenario::Judged;
use crate::show::campaign::words;
use crate::show::table::{number, table};

/// The faults and what came of them, what was recorded, what was felt, the judgement.
pub fn render(judged: &Judged) -> String {
    let mut text = String::new();
    if !judged.faults.is_empty() {
        let header =
            ["fault", "at [s]", "amount", "place", "first row after [ms]", "result", "rows"];
        let mut rows = table(&header);
        for of in &judged.faults {
            let planted = &of.planted;
            let result = of.verdict.map_or("after opening", words);
            let amount =
                if planted.fault.has_amount() { planted.much.to_string() } else { "–".into() };
            rows.add_row([
                format!("{:?}", planted.fault),
                seconds(planted.from_ms),
                amount,
                planted.place().map_or_else(|| "–".into(), |at| at.to_string()),
                of.noticed_ms.map_or_else(|| "–".into(), |ms| ms.to_string()),
                of.reason.map_or_else(|| result.to_owned(), |why| format!("{result}: {why}")),
                of.rows.join(" "),
            ]);
        }
        let _ = writeln!(text, "{rows}");
    }
    if !judged.recorded.is_empty() {
        let header = ["recorded at [s]", "row", "", "pack [A]", "cells [V]", "hottest [°C]"];
        let mut rows = table(&header);
        for event in &judged.recorded {
            let [low, high] = event.cell_v.map(|v| number(v.map(f64::from), 3));
            rows.add_row([
                seconds(event.at_ms),
                event.row.clone(),
                event.what.to_owned(),
                number(event.current_a.map(f64::from), 1),
                format!("{low}..{high}"),
                number(event.hottest_c.map(f64::from), 1),
            ]);
        }
        let _ = writeln!(text, "{rows}");
    }
    felt(&mut text, judged);
    for trip in &judged.false_trips {
        let _ = writeln!(text, "without a fault: {trip}");
    }
    let name = &judged.name;
    let verdict = match judged.verdict {
        Verdict::Noticed if judged.faults.is_empty() => "no fault",
        verdict => words(verdict),
    };
    let _ = writeln!(text, "{name}: {verdict} in {} s", seconds(judged.driven_ms));
    text
}

fn felt(text: &mut String, judged: &Judged) {
    let felt = &judged.felt;
    if let Some(less_ms) = felt.less_ms {
        let _ = writeln!(
            text,
            "felt: less than asked for from {} s on, by up to {:.0} A, taken back by up to {:.0} A/s",
            seconds(less_ms),
            felt.most_a,
            felt.fastest_a_per_s,
        );
    }
    if let Some(opened_ms) = judged.opened_ms {
        let _ = writeln!(
            text,
            "the contactors were told to open at {} s, cause {}, while {} A flowed",
            seconds(opened_ms),
            judged.cause,
            number(felt.interrupted_a.map(f64::from), 1),
        );
        let _ = match judged.before_harm_ms {
            Some(ms) => writeln!(
                text,
                "{ms} ms before a cell would have left its absolute limits, had they stayed closed"
            ),
            None => writeln!(text, "no cell would have left its absolute limits in the next 40 s"),
        };
    } else if felt.less_ms.is_none() {
        let _ = writeln!(text, "felt: nothing");
    }
    if let Some((harm, at_ms)) = judged.harm {
        let _ = writeln!(text, "a cell was harmed at {} s: {harm:?}", seconds(at_ms));
    }
}

fn seconds(ms: u32) -> String {
    format!("{:.3}", f64::from(ms) / 1000.0)
}
