//! The report of a single run: of a replay, of an experiment.

use super::page::{Cell, Page, escaped, table};
use super::{ledger, parameters};
use crate::evaluate::cells::{CellRow, CellTrace};
use crate::evaluate::estimators::{EstimatorRun, EstimatorTrace};
use crate::read::vehicle::Vehicle;
use crate::show::plot::{Kind, Panel, Series, Sheet};
use crate::show::sheet::of as sheet_of;
use crate::show::{experiment, summary, validation};
use crate::simulate::mode::Replayed;
use crate::simulate::replay::Replay;
use crate::verify::experiment::Outcome;

/// The vehicle of a replay, with the texts of its parameter files: title, text.
pub struct Parameters<'a> {
    /// The vehicle.
    pub vehicle: &'a Vehicle,
    /// What its parameters are read from: what each is, and its text.
    pub files: &'a [(String, String)],
}

/// The report of a replay.
pub fn replay(replay: &Replay, parameters: &Parameters<'_>) -> anyhow::Result<Vec<u8>> {
    let s = &replay.summary;
    let sheet = sheet_of(replay);
    let what = match s.mode {
        Replayed::Cycle => "The whole vehicle follows a driving cycle",
        Replayed::Trip => {
            "The whole vehicle on the measured speed, height and auxiliary power of a trip"
        }
        Replayed::Battery => "The battery alone on the measured current of a trip",
        Replayed::Profile => "The battery alone on a profile of current or power",
    };
    let mut lead = vec![format!("{what}, in {} steps of {} ms.", s.steps, 1000.0 * s.dt_s)];
    lead.extend(sheet.subtitle.iter().cloned());
    let mut page = Page::new(&sheet.title, &lead);
    page.notes(s.notes.iter());

    let measured = s.measured.is_some();
    let rows: Vec<_> = (summary::figures(s).into_iter())
        .map(|[name, ours, theirs]| {
            let mut row = vec![Cell::Text(name), Cell::Number(ours, None)];
            row.extend(measured.then_some(Cell::Number(theirs, None)));
            row
        })
        .collect();
    let header: &[&str] =
        if measured { &["", "simulated", "measured"] } else { &["", "simulated"] };
    let mut figures = format!("<div>{}</div>\n", table(header, (1, 2), &rows, false));
    if let Some(error) = &s.error {
        let rows: Vec<_> = (summary::errors(error).into_iter())
            .map(|(name, value)| vec![Cell::Text(name.to_owned()), Cell::Number(value, None)])
            .collect();
        figures += &format!(
            "<div>{}</div>\n",
            table(&["simulated less measured", ""], (1, 1), &rows, false)
        );
    }
    page.section("figures", "Figures", &format!("<div class=\"beside\">\n{figures}</div>\n"));
    page.plots(&sheet)?;
    let energy = replay.run.energy.as_ref().map_or_else(String::new, ledger::html);
    page.section("energy", "Where the energy went", &energy);
    page.section("parameters", "Parameters and their sources", &sources(parameters));
    Ok(page.bytes())
}

fn sources(of: &Parameters<'_>) -> String {
    let Vehicle { name, description, source, .. } = of.vehicle;
    let mut html = format!(
        "<p><b>{}</b>: {}</p>\n<p>Source: {}</p>\n",
        escaped(name),
        escaped(description),
        escaped(source)
    );
    for (title, text) in of.files {
        let table = parameters::html(text);
        html += &format!("<details><summary>{}</summary>\n{table}</details>\n", escaped(title));
    }
    html
}

/// The report of an experiment.
pub fn experiment(outcome: &Outcome) -> anyhow::Result<Vec<u8>> {
    let sheet: Sheet = experiment::sheet(outcome);
    let lead = format!("An experiment of the reference system. Source: {}.", outcome.source);
    let mut page = Page::new(&sheet.title, &[lead]);
    let off: Vec<String> = (outcome.figures.iter())
        .filter(|check| check.pass == Some(false) || check.obtained.is_none())
        .map(|check| {
            format!(
                "{}: {}: {}: {}",
                validation::verdict(check),
                check.name,
                check.quantity,
                check.reason
            )
        })
        .collect();
    page.notes(off.iter());
    let rows: Vec<_> = (outcome.figures.iter())
        .map(|check| {
            let [published, target, obtained, tolerance] = validation::numbers(check);
            let class = match check.pass {
                Some(true) => "pass",
                Some(false) => "fail",
                None => "quiet",
            };
            vec![
                Cell::Text(check.name.clone()),
                Cell::Text(check.quantity.clone()),
                Cell::Number(published, None),
                Cell::Number(target, None),
                Cell::Number(obtained, None),
                Cell::Number(tolerance, None),
                Cell::Html(format!("<td class=\"{class}\">{}</td>", validation::verdict(check))),
                Cell::Text(check.source.to_owned()),
            ]
        })
        .collect();
    let header =
        ["case", "quantity", "published", "target", "obtained", "tolerance", "verdict", "source"];
    let figures = table(&header, (2, 4), &rows, false);
    page.section("figures", "Figures", &figures);
    page.plots(&sheet)?;
    let energy = ledger::bars(&outcome.record.energy, outcome.record.energy_unit);
    page.section("energy", "Where the energy went", &energy);
    Ok(page.bytes())
}

/// The plots of a run of a folder.
fn sheet(title: String, time_s: Vec<f64>, panels: Vec<Panel>) -> Sheet {
    Sheet {
        title,
        subtitle: Vec::new(),
        time_s,
        panels,
        bars_title: String::new(),
        bars_unit: String::new(),
        bars: Vec::new(),
    }
}

fn panel(title: &str, unit: &str, series: Vec<Series>) -> Panel {
    Panel { title: title.into(), unit: unit.into(), series }
}

fn percent(values: Vec<f64>) -> Vec<f64> {
    values.into_iter().map(|v| 100.0 * v).collect()
}

/// The report of a drive cycle of a cell.
pub fn cell(cell: &str, row: &CellRow, trace: CellTrace) -> anyhow::Result<Vec<u8>> {
    let both = |[measured, simulated]: [Vec<f64>; 2]| {
        let mut series = vec![Series::new("measured", Kind::Measured, measured)];
        if !simulated.is_empty() {
            series.push(Series::new("simulated", Kind::Simulated, simulated));
        }
        series
    };
    let measured = |values| vec![Series::new("measured", Kind::Measured, values)];
    let panels = vec![
        panel("Voltage", "V", both(trace.voltage_v)),
        panel("Temperature", "°C", both(trace.temperature_c)),
        panel("Current (discharge positive)", "A", measured(trace.current_a)),
        panel("State of charge by the counter", "%", measured(percent(trace.soc))),
    ];
    let mut lead = vec![
        "Voltage on the measured current and temperature; temperature from the thermal node alone."
            .to_owned(),
        format!("Voltage {:.1} mV RMS.", row.voltage_rmse_mv),
    ];
    lead.extend(row.temperature_rmse_k.map(|k| format!("Temperature {k:.2} K RMS.")));
    let sheet = sheet(format!("{} · {cell}", row.name), trace.time_s, panels);
    let mut page = Page::new(&sheet.title, &lead);
    page.notes(row.notes.iter());
    page.plots(&sheet)?;
    Ok(page.bytes())
}

/// The report of an estimator's run.
pub fn estimator(run: &EstimatorRun, trace: EstimatorTrace) -> anyhow::Result<Vec<u8>> {
    let EstimatorTrace { time_s, soc: [counted, estimated], sd, current_a, voltage_v } = trace;
    let reach = estimated.iter().zip(&sd).map(|(soc, sd)| (soc - 3.0 * sd, soc + 3.0 * sd));
    let extremes = reach.map(|(low, high)| (100.0 * low, 100.0 * high)).collect();
    let estimated = Series::new("estimated", Kind::Simulated, percent(estimated));
    let panels = vec![
        panel(
            "State of charge, with three standard deviations",
            "%",
            vec![
                Series::new("counted", Kind::Measured, percent(counted)),
                Series { extremes, ..estimated },
            ],
        ),
        panel("Standard deviation", "%", vec![Series::new("σ", Kind::Simulated, percent(sd))]),
        panel("Voltage", "V", vec![Series::new("measured", Kind::Measured, voltage_v)]),
        panel(
            "Current (discharge positive)",
            "A",
            vec![Series::new("measured", Kind::Measured, current_a)],
        ),
    ];
    let f = &run.figures;
    let lead = [
        format!("Battery {}, case: {}.", run.battery, run.case.name),
        format!(
            "Error {:.2} % RMS, largest {:.2} %, {:+.2} % at the end with a σ of {:.2} %.",
            100.0 * f.soc_rmse,
            100.0 * f.soc_max,
            100.0 * f.soc_error_end,
            100.0 * f.soc_sd_end
        ),
    ];
    let sheet = sheet(format!("{} · {}", run.name, run.case.name), time_s, panels);
    let mut page = Page::new(&sheet.title, &lead);
    page.notes(run.notes.iter());
    page.plots(&sheet)?;
    Ok(page.bytes())
}
