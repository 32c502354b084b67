//! `voltstep check` on a terminal.

use crate::read::check::{Checked, TableFacts};
use crate::show::table::{number, table};

/// Gaps that are named one by one.
const NAMED_GAPS: usize = 5;

/// What a file is, its columns, what is to be known of it, and what can be done with it.
pub fn render(checked: &Checked) -> String {
    let Checked { file, kind, known_by, about, .. } = checked;
    let mut text = format!("{file}: a {}, by {known_by}\n", kind.name());
    for line in about.iter().filter(|line| !line.is_empty()) {
        text += &format!("  {line}\n");
    }
    if let Some(facts) = &checked.table {
        text += &of_table(facts);
    }
    for note in &checked.notes {
        text += &format!("  note: {note}\n");
    }
    for doubt in &checked.doubts {
        text += &format!("  doubt: {doubt}\n");
    }
    for command in &checked.commands {
        text += &format!("  try: {command}\n");
    }
    text
}

fn of_table(facts: &TableFacts) -> String {
    let mut rows =
        table(&["column", "taken for", "unit", "in", "missing", "least", "largest", "resolves"]);
    for column in &facts.columns {
        rows.add_row([
            column.header.clone(),
            column.quantity.to_owned(),
            column.unit.to_owned(),
            column.converted_to.to_owned(),
            column.missing.to_string(),
            number(Some(column.least), 3),
            number(Some(column.largest), 3),
            number(Some(column.resolution), 4),
        ]);
    }
    let [shortest, usual, longest] = facts.step_s.map(|s| number(Some(s), 3));
    let mut text = format!(
        "{rows}\n  {} samples over {:.1} s, a sample every {usual} s ({shortest} to {longest})\n",
        facts.samples, facts.duration_s
    );
    for gap in facts.gaps.iter().take(NAMED_GAPS) {
        text += &format!("  gap of {:.1} s at {:.1} s\n", gap.for_s, gap.at_s);
    }
    let more = facts.gaps.len().saturating_sub(NAMED_GAPS);
    if more > 0 {
        text += &format!("  {more} more gaps\n");
    }
    if !facts.unused.is_empty() {
        text += &format!("  not used: {}\n", facts.unused.join(", "));
    }
    text
}
