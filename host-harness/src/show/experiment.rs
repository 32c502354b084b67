//! An experiment: its figures on a terminal, its plot sheet, its trace.

use crate::show::plot::{Bar, Kind, Panel, Series, Sheet};
use crate::show::trace::number;
use crate::show::validation::figures;
use crate::verify::experiment::{EXPERIMENTS, Outcome, Role};

/// The experiments that there are.
pub fn list() -> String {
    let longest = EXPERIMENTS.iter().map(|e| e.name.len()).max().unwrap_or(0);
    let line = |name: &str, title: &str, source: &str| {
        format!("{name:longest$}  {title}\n{:longest$}  {source}\n", "")
    };
    EXPERIMENTS.iter().map(|e| line(e.name, e.title, e.source)).collect()
}

/// The figures beside their targets.
pub fn render(outcome: &Outcome) -> String {
    let Outcome { name, title, source, .. } = outcome;
    let (table, notes) = figures(&outcome.figures);
    format!("{name}: {title}\n{source}\n{table}\n{notes}")
}

/// The plots, what they are called above them and the energy below.
pub fn sheet(outcome: &Outcome) -> Sheet {
    let record = &outcome.record;
    let mut columns = record.columns.iter();
    let panels = record.panels.iter().map(|panel| Panel {
        title: panel.title.into(),
        unit: panel.unit.into(),
        series: (panel.lines.iter().zip(columns.by_ref()))
            .map(|(line, values)| {
                let kind = match line.role {
                    Role::Reference => Kind::Reference,
                    Role::Measured => Kind::Measured,
                    Role::Simulated => Kind::Simulated,
                };
                Series::new(line.label, kind, values.clone())
            })
            .collect(),
    });
    Sheet {
        title: format!("{} · {}", outcome.name, outcome.title),
        subtitle: vec![outcome.source.to_owned()],
        time_s: record.time_s.clone(),
        panels: panels.collect(),
        bars_title: "Where the energy went".into(),
        bars_unit: record.energy_unit.into(),
        bars: (record.energy.iter())
            .map(|(name, value)| Bar { name: name.clone(), value: *value })
            .collect(),
    }
}

/// The trace as CSV; a missing value is empty.
pub fn csv(outcome: &Outcome) -> anyhow::Result<Vec<u8>> {
    let record = &outcome.record;
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["time_s"].into_iter().chain(record.lines().map(|l| l.column)))?;
    for (i, time_s) in record.time_s.iter().enumerate() {
        let row = record.columns.iter().map(|c| c.get(i).copied().unwrap_or(f64::NAN));
        writer.write_record([*time_s].into_iter().chain(row).map(number))?;
    }
    writer.into_inner().map_err(|e| anyhow::anyhow!("writing the trace: {e}"))
}
