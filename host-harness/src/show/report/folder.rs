//! Overviews: how the figures of many runs are spread, and each in a table that sorts and leads to
//! its own report.

use super::histogram;
use super::page::{Cell, Page, table};
use crate::evaluate::campaign::{self, Verdict};
use crate::evaluate::cells::{CellRow, CellsReport};
use crate::evaluate::estimators::{EstimatorReport, EstimatorRun, honesty};
use crate::evaluate::trips::{TripRow, TripsReport};
use crate::show::campaign::{counts, harmless_percent, words};
use crate::simulate::mode::Mode;

/// The overview's own file.
pub const NAME: &str = "report.html";

/// Where a trip's report lies, from the overview.
pub fn of_trip(name: &str, mode: Mode) -> String {
    format!("{}/{name}.html", mode.name())
}

/// Where a cell's report lies, from the overview.
pub fn of_cell(name: &str) -> String {
    format!("cells/{name}.html")
}

/// Where the report of an estimator's run lies, from the overview.
pub fn of_run(place: usize, name: &str) -> String {
    format!("runs/{:04}-{name}.html", place + 1)
}

/// A figure of a row: its heading, its decimals.
type Figure<R> = (&'static str, usize, fn(&R) -> Option<f64>);

const TRIPS: [Figure<TripRow>; 7] = [
    ("voltage [V]", 2, |r| Some(r.voltage_rmse_v)),
    ("SOC [%]", 3, |r| Some(100.0 * r.soc_rmse)),
    ("SOC drop [%]", 1, |r| Some(100.0 * r.soc_drop_rel)),
    ("current [A]", 2, |r| Some(r.current_rmse_a)),
    ("torque [N·m]", 1, |r| r.torque_rmse_nm),
    ("energy [%]", 1, |r| Some(100.0 * r.energy_rel)),
    ("speed [m/s]", 4, |r| r.speed_error_rms_m_s),
];

const CELLS: [Figure<CellRow>; 6] = [
    ("ambient [°C]", 1, |r| Some(r.ambient_c)),
    ("SOC at the end [%]", 1, |r| Some(100.0 * r.soc_end)),
    ("voltage [mV]", 1, |r| Some(r.voltage_rmse_mv)),
    ("above 15 % [mV]", 1, |r| r.voltage_rmse_mv_above_15_soc),
    ("above 25 % [mV]", 1, |r| r.voltage_rmse_mv_above_25_soc),
    ("temperature [K]", 2, |r| r.temperature_rmse_k),
];

const RUNS: [Figure<EstimatorRun>; 8] = [
    ("RMS [%]", 2, |r| Some(100.0 * r.figures.soc_rmse)),
    ("largest [%]", 2, |r| Some(100.0 * r.figures.soc_max)),
    ("after 5 min [%]", 2, |r| Some(100.0 * r.figures.soc_max_after_300_s)),
    ("end [%]", 2, |r| Some(100.0 * r.figures.soc_error_end)),
    ("σ at the end [%]", 2, |r| Some(100.0 * r.figures.soc_sd_end)),
    ("within 2 % [s]", 0, |r| r.figures.convergence_s),
    ("inside 3σ [%]", 1, |r| r.figures.inside_3_sigma_identified.map(|share| 100.0 * share)),
    ("beyond 5 % [s]", 0, |r| Some(r.figures.outside_5_percent_s)),
];

/// What leads a row of a table, by its place and what it is.
type Lead<'a, R> = &'a dyn Fn(usize, &R) -> Vec<Cell>;

/// Distributions of some figures over some rows; nothing where there is no value.
fn spreads<R>(rows: &[&R], figures: &[Figure<R>]) -> String {
    let one = |(name, digits, pick): &Figure<R>| {
        histogram::html(name, *digits, rows.iter().map(|row| pick(row)))
    };
    let figures: String = figures.iter().map(one).collect();
    if figures.is_empty() {
        figures
    } else {
        format!("<div class=\"histograms\">\n{figures}</div>\n")
    }
}

/// A table that sorts: what leads a row, its figures, what follows them.
fn sorted<R>(
    rows: &[&R],
    leading: &[&str],
    lead: Lead<'_, R>,
    figures: &[Figure<R>],
    last: (&str, &dyn Fn(&R) -> String),
) -> String {
    let seen = |(_, _, pick): &&Figure<R>| rows.iter().any(|row| pick(row).is_some());
    let figures: Vec<_> = figures.iter().filter(seen).collect();
    let mut header = leading.to_vec();
    header.extend(figures.iter().map(|(name, ..)| *name));
    header.push(last.0);
    let rows: Vec<_> = (rows.iter().enumerate())
        .map(|(place, row)| {
            let mut cells = lead(place, row);
            cells.extend(figures.iter().map(|(_, digits, pick)| Cell::of(pick(row), *digits)));
            cells.push(Cell::Text(last.1(row)));
            cells
        })
        .collect();
    table(&header, (leading.len(), figures.len()), &rows, true)
}

fn yes_or_no(yes: bool) -> String {
    if yes { "yes" } else { "no" }.to_owned()
}

/// The measurements that are left out, as notes.
fn note_skipped(page: &mut Page, skipped: &[String]) {
    let skipped: Vec<_> = skipped.iter().map(|why| format!("no drive cycle: {why}")).collect();
    page.notes(skipped.iter());
}

/// The overview of `voltstep validate --trips`.
pub fn trips(report: &TripsReport) -> Vec<u8> {
    let count = report.trips.len() / 2;
    let marked = report.trips.iter().filter(|r| !r.counts).count() / 2;
    let mut lead = vec![
        format!("{count} trips, each in steps of {} ms.", 1000.0 * report.dt_s),
        "RMS of simulated less measured; drop and energy relative to the measured ones.".to_owned(),
    ];
    if marked > 0 {
        lead.push(format!(
            "{marked} trips are marked for reasons that do not look at the result; the distributions are without \
             them, the tables with."
        ));
    }
    let mut page = Page::new(&format!("Trips · {}", report.vehicle), &lead);
    for (mode, spread_id, spread, table_id, heading) in [
        (
            Mode::Vehicle,
            "vehicle-spread",
            "The whole vehicle",
            "vehicle",
            "The whole vehicle, by trip",
        ),
        (
            Mode::Battery,
            "battery-spread",
            "The battery alone",
            "battery",
            "The battery alone, by trip",
        ),
    ] {
        let rows: Vec<_> = report.trips.iter().filter(|r| r.mode == mode).collect();
        let counted: Vec<_> = rows.iter().copied().filter(|r| r.counts).collect();
        page.section(spread_id, spread, &spreads(&counted, &TRIPS));
        let link = |_, r: &TripRow| vec![Cell::Link(r.name.clone(), of_trip(&r.name, r.mode))];
        let notes = |r: &TripRow| r.notes.join("; ");
        let html = sorted(&rows, &["trip"], &link, &TRIPS, ("notes", &notes));
        page.section(table_id, heading, &html);
    }
    page.bytes()
}

/// The overview of `voltstep validate --cells`.
pub fn cells(report: &CellsReport) -> Vec<u8> {
    let lead = [
        format!("{} drive cycles in steps of {} ms.", report.cells.len(), 1000.0 * report.dt_s),
        "RMS of simulated less measured, on the measured current and temperature.".to_owned(),
    ];
    let mut page = Page::new(&format!("Cells · {}", report.cell), &lead);
    let rows: Vec<_> = report.cells.iter().collect();
    page.section("spread", "How far off", &spreads(&rows, &CELLS[2..]));
    let link = |_, r: &CellRow| vec![Cell::Link(r.name.clone(), of_cell(&r.name))];
    let html = sorted(
        &rows,
        &["drive cycle"],
        &link,
        &CELLS,
        ("notes", &|r: &CellRow| r.notes.join("; ")),
    );
    page.section("table", "By drive cycle", &html);
    note_skipped(&mut page, &report.skipped);
    page.bytes()
}

/// The overview of `voltstep soc` over measurements.
pub fn estimators(report: &EstimatorReport) -> Vec<u8> {
    let lead = [
        format!("{} runs at {} Hz.", report.runs.len(), report.rate_hz),
        "Estimated less counted state of charge; inside 3σ where the model's range holds."
            .to_owned(),
    ];
    let mut page = Page::new(&format!("State of charge · {:?}", report.estimator), &lead);
    let rows: Vec<_> = report.runs.iter().collect();
    page.section("spread", "How far off", &spreads(&rows, &RUNS));
    let link = |place, r: &EstimatorRun| {
        vec![
            Cell::Link(r.name.clone(), of_run(place, &r.name)),
            Cell::Text(r.case.name.to_owned()),
            Cell::Text(yes_or_no(r.is_honest())),
        ]
    };
    let notes = |r: &EstimatorRun| r.notes.join("; ");
    let html = sorted(&rows, &["measurement", "case", "honest"], &link, &RUNS, ("notes", &notes));
    page.section("table", "By run", &html);
    note_skipped(&mut page, &report.skipped);
    page.bytes()
}

const GROUPS: [Figure<honesty::Group>; 7] = [
    ("inside 3σ [%]", 2, |g| Some(100.0 * g.inside().0)),
    ("at worst [%]", 2, |g| Some(100.0 * g.inside().1)),
    ("silent [%]", 2, |g| Some(100.0 * g.silent())),
    ("flagged [%]", 2, |g| Some(100.0 * g.flagged())),
    ("largest error [σ]", 1, |g| Some(g.worst())),
    ("σ [%]", 2, |g| Some(100.0 * g.sd())),
    ("RMS error / σ", 2, |g| Some(g.ratio())),
];

/// The overview of `voltstep soc --matrix` on simulated batteries.
pub fn honesty(report: &honesty::Report) -> Vec<u8> {
    let lead =
        ["Simulated batteries with something wrong; silent: outside for more than a minute \
                 without a flag."
            .to_owned()];
    let mut page = Page::new("State of charge · honesty of its σ", &lead);
    let rows: Vec<_> = report.groups.iter().collect();
    page.section("spread", "Distributions over the groups", &spreads(&rows, &GROUPS));
    let words = |_, g: &honesty::Group| {
        vec![Cell::Text(g.kind.words().to_owned()), Cell::Text(g.chemistry.word().to_owned())]
    };
    let honest = |g: &honesty::Group| yes_or_no(g.is_honest());
    let html = sorted(&rows, &["what is wrong", "battery"], &words, &GROUPS, ("honest", &honest));
    page.section("table", "By group", &html);
    page.bytes()
}

#[expect(clippy::cast_precision_loss, reason = "small numbers")]
const CASES: [Figure<campaign::Judged>; 3] = [
    ("opened after [ms]", 0, |j| j.opened_ms.map(f64::from)),
    ("before harm [ms]", 0, |j| j.before_harm_ms.map(f64::from)),
    ("severity", 0, |j| Some(j.case.severity as f64)),
];

/// The faults of a campaign, each with how its cases ended.
fn kinds(report: &campaign::Report) -> String {
    let mut header = vec!["fault", "cases"];
    header.extend(Verdict::ALL.map(words));
    header.extend(["opened from [ms]", "to [ms]", "least before harm [ms]", "why harmless"]);
    let number = |count: usize| Cell::of(u32::try_from(count).ok().map(f64::from), 0);
    let rows: Vec<_> = (report.kinds.iter())
        .map(|kind| {
            let why = report.unnoticed.iter().filter(|of| of.fault == kind.fault);
            let why: Vec<_> = why.map(|of| format!("{}: {}", of.cases, of.reason)).collect();
            let mut row = vec![Cell::Text(format!("{:?}", kind.fault)), number(kind.cases())];
            row.extend(kind.ended.map(number));
            let opened_ms = kind.opened_ms;
            for ms in [
                opened_ms.map(|(least, _)| least),
                opened_ms.map(|(_, most)| most),
                kind.least_before_harm_ms,
            ] {
                row.push(Cell::of(ms.map(f64::from), 0));
            }
            row.push(Cell::Text(why.join("; ")));
            row
        })
        .collect();
    table(&header, (1, header.len() - 2), &rows, true)
}

/// The overview of `voltstep bms`.
pub fn campaign(report: &campaign::Report) -> Vec<u8> {
    let lead = [
        format!(
            "{} cases: {}; {:.1} % harmless.",
            report.cases.len(),
            counts(report),
            harmless_percent(report)
        ),
        format!(
            "{} h of driving without a fault: {} false trips.",
            report.hours,
            report.false_trips.len()
        ),
    ];
    let mut page = Page::new("Battery management · faults planted in a pack", &lead);
    page.notes(report.false_trips.iter());
    let rows: Vec<_> = report.cases.iter().collect();
    page.section("spread", "How soon the contactors opened", &spreads(&rows, &CASES[..2]));
    page.section("kinds", "By fault", &kinds(report));
    let lead = |_, j: &campaign::Judged| {
        let much = f64::from(j.case.much);
        vec![
            Cell::Text(format!("{:?}", j.case.fault)),
            Cell::Number(j.case.much.to_string(), Some(much)),
            Cell::of(Some(100.0 * f64::from(j.case.soc)), 0),
            Cell::of(Some(f64::from(j.case.temperature_c)), 0),
            Cell::Text(if j.case.charging { "charging" } else { "driving" }.to_owned()),
            Cell::Text(words(j.verdict).to_owned()),
        ]
    };
    let last = |j: &campaign::Judged| {
        let harm = j.harm.map(|harm| format!("{harm:?}"));
        let said = j.rows.iter().cloned().chain(harm).chain(j.reason.map(str::to_owned));
        said.collect::<Vec<_>>().join("; ")
    };
    let header = ["fault", "much", "SOC [%]", "temperature [°C]", "while", "verdict"];
    let html = sorted(&rows, &header, &lead, &CASES[..2], ("rows, harm, reason", &last));
    page.section("table", "By case", &html);
    page.bytes()
}
