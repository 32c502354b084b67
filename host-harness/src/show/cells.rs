//! `voltstep validate --cells` on a terminal.

use crate::evaluate::cells::CellsReport;
use crate::show::table::{number, table};

/// A row for each drive cycle, then what the reader should know.
pub fn render(report: &CellsReport) -> String {
    let mut rows = table(&[
        "drive cycle",
        "ambient [°C]",
        "SOC at the end [%]",
        "voltage [mV]",
        "above 15 % [mV]",
        "above 25 % [mV]",
        "temperature [K]",
    ]);
    for r in &report.cells {
        rows.add_row([
            r.name.clone(),
            format!("{:.1}", r.ambient_c),
            format!("{:.1}", 100.0 * r.soc_end),
            number(Some(r.voltage_rmse_mv), 1),
            number(r.voltage_rmse_mv_above_15_soc, 1),
            number(r.voltage_rmse_mv_above_25_soc, 1),
            number(r.temperature_rmse_k, 2),
        ]);
    }
    let mut text = format!("{rows}\nRMS of simulated minus measured\n");
    for r in &report.cells {
        for note in &r.notes {
            text += &format!("{}: {note}\n", r.name);
        }
    }
    for why in &report.skipped {
        text += &format!("no drive cycle: {why}\n");
    }
    text + &format!(
        "{} in steps of {} ms, in {:.1} s\n",
        report.cell,
        1000.0 * report.dt_s,
        report.wall_s
    )
}
