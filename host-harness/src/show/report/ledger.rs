//! Where the energy went: a flow from its sources over groups of losses to each of them, and the
//! same as a table.

use std::fmt::Write;

use plant_core::powertrain::ledger::EnergyReport;

use super::page::{Cell, escaped, table};
use crate::simulate::figures::J_PER_KWH;

/// What is no term of the balance: a sum, its rest, and parts of what came out of the chemistry.
const BESIDE: [&str; 4] = ["throughput", "residual", "overcharge", "open_circuit_explicit"];
/// What the battery gave; the others are what became of it.
const GIVEN: &str = "electrochemical";
/// Less than this share of the whole is not worth a line.
const LEAST: f64 = 2e-5;
/// … and less than this not a band of the flow.
const THINNEST: f64 = 1e-3;

/// Where a term belongs: the class of its colour, its name.
const GROUPS: [(&str, &str); 5] = [
    ("road", "Road"),
    ("drive", "Drive"),
    ("auxiliary", "Auxiliary"),
    ("battery", "Battery"),
    ("other", "Step"),
];

fn group(term: &str) -> usize {
    match term {
        "drag" | "rolling" | "brake" | "potential" | "kinetic" => 0,
        "converter" | "copper" | "iron" | "field" | "inductive" | "viscous" | "coulomb"
        | "gear" | "conversion" => 1,
        "auxiliary" => 2,
        "series_joule" | "polarisation_joule" | "capacitive" | GIVEN => 3,
        _ => 4,
    }
}

/// A part of the flow, never negative.
#[derive(Clone)]
struct Part {
    name: String,
    kwh: f64,
    group: usize,
}

/// Sources and sinks of a balance: what is negative goes the other way.
fn parts(energy: &EnergyReport) -> (Vec<Part>, Vec<Part>) {
    let (mut sources, mut sinks) = (Vec::new(), Vec::new());
    for (term, joules) in energy.terms() {
        let kwh = f64::from(joules) / J_PER_KWH;
        if BESIDE.contains(&term) || !kwh.is_finite() {
            continue;
        }
        let comes = (term == GIVEN) == (kwh > 0.0);
        let name = match (term, comes) {
            (GIVEN, true) => "battery".to_owned(),
            (GIVEN, false) => "charged into the battery".to_owned(),
            ("potential", true) => "height lost".to_owned(),
            ("potential", false) => "height gained".to_owned(),
            ("kinetic", true) => "motion at the start".to_owned(),
            ("kinetic", false) => "motion at the end".to_owned(),
            (other, _) => other.replace('_', " "),
        };
        let part = Part { name, kwh: kwh.abs(), group: group(term) };
        if comes { sources.push(part) } else { sinks.push(part) }
    }
    let whole: f64 = sources.iter().map(|part| part.kwh).sum();
    for parts in [&mut sources, &mut sinks] {
        parts.retain(|part| part.kwh > LEAST * whole);
        parts.sort_by(|a, b| a.group.cmp(&b.group).then(b.kwh.total_cmp(&a.kwh)));
    }
    (sources, sinks)
}

/// The flow and the table; nothing where nothing flowed.
pub fn html(energy: &EnergyReport) -> String {
    let (sources, sinks) = parts(energy);
    let whole: f64 = sources.iter().map(|part| part.kwh).sum();
    if whole <= 0.0 {
        return String::new();
    }
    let row = |part: &Part, side: &str, class: &str| {
        vec![
            Cell::Text(side.to_owned()),
            Cell::Text(part.name.clone()),
            Cell::of(Some(part.kwh), 4),
            Cell::of(Some(100.0 * part.kwh / whole), 2),
            bar(class, part.kwh / whole),
        ]
    };
    let rows: Vec<_> = (sources.iter().map(|part| row(part, "from", "source")))
        .chain(sinks.iter().map(|part| row(part, GROUPS[part.group].1, GROUPS[part.group].0)))
        .collect();
    let closes = f64::from(energy.residual_rel()).abs();
    format!(
        "{}{}<p class=\"quiet\">Net amounts from start to end; what was recuperated is subtracted from what the \
         battery gave. The balance closes to {closes:.1e} of what the battery exchanged, {:.4} kWh.</p>\n",
        sankey(&sources, &sinks, whole),
        table(&["", "what", "kWh", "share [%]", ""], (2, 2), &rows, false),
        f64::from(energy.throughput) / J_PER_KWH,
    )
}

/// A bar of a share of the widest.
fn bar(class: &str, share: f64) -> Cell {
    let percent = 100.0 * share;
    Cell::Html(format!(
        "<td class=\"bar\" aria-hidden=\"true\"><span class=\"{class}\" style=\"width:{percent:.2}%\"></span></td>"
    ))
}

/// What the terms of an experiment come to, as bars.
pub fn bars(terms: &[(String, f64)], unit: &str) -> String {
    let most = terms.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    if most <= 0.0 {
        return String::new();
    }
    let rows: Vec<_> = (terms.iter())
        .map(|(name, value)| {
            let class = if *value < 0.0 { "source" } else { "drive" };
            vec![
                Cell::Text(name.clone()),
                Cell::of(Some(*value), 4),
                bar(class, value.abs() / most),
            ]
        })
        .collect();
    table(&["", unit, ""], (1, 1), &rows, false)
}

/// Height of the whole flow, width of a node, least distance of two lines of text, in pixels.
const FLOW: f64 = 250.0;
const NODE: f64 = 14.0;
const PITCH: f64 = 19.0;
/// Where the nodes of sources, groups and sinks stand, and the width of all.
const COLUMNS: [f64; 3] = [165.0, 430.0, 690.0];
const WIDTH: f64 = 900.0;
const TOP: f64 = 12.0;

/// Where nodes stand one below the other: top and height of each, and the bottom of the last.
fn stacked(sizes: &[f64], per_kwh: f64) -> (Vec<(f64, f64)>, f64) {
    let mut top = TOP;
    let mut nodes = Vec::new();
    for kwh in sizes {
        let height = (kwh * per_kwh).max(1.0);
        nodes.push((top, height));
        top += (height + 6.0).max(PITCH);
    }
    (nodes, top)
}

fn sankey(sources: &[Part], sinks: &[Part], whole: f64) -> String {
    // What is thinner than a line stands in the table alone.
    let seen = |parts: &[Part]| -> Vec<Part> {
        parts.iter().filter(|part| part.kwh > THINNEST * whole).cloned().collect()
    };
    let (sources, sinks) = (&seen(sources)[..], &seen(sinks)[..]);
    let per_kwh = FLOW / whole;
    let sums: Vec<(usize, f64)> = (0..GROUPS.len())
        .map(|g| (g, sinks.iter().filter(|part| part.group == g).map(|part| part.kwh).sum()))
        .filter(|(_, kwh)| *kwh > 0.0)
        .collect();
    let sizes = |parts: &[Part]| parts.iter().map(|part| part.kwh).collect::<Vec<_>>();
    let (left, left_end) = stacked(&sizes(sources), per_kwh);
    let (middle, middle_end) =
        stacked(&sums.iter().map(|(_, kwh)| *kwh).collect::<Vec<_>>(), per_kwh);
    let (right, right_end) = stacked(&sizes(sinks), per_kwh);
    let height = left_end.max(middle_end).max(right_end) + TOP;
    // The shorter columns stand in the middle.
    let shift = |nodes: Vec<(f64, f64)>, end: f64| -> Vec<(f64, f64)> {
        let by = (height - TOP - end) / 2.0;
        nodes.into_iter().map(|(top, size)| (top + by, size)).collect()
    };
    let (left, middle, right) =
        (shift(left, left_end), shift(middle, middle_end), shift(right, right_end));

    let mut svg = format!(
        "<svg class=\"sankey\" viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" \
         aria-label=\"Flow of energy; the table below has the same figures\">\n"
    );
    let mut leaving: Vec<f64> = left.iter().map(|node| node.0).collect();
    let mut outgoing: Vec<f64> = middle.iter().map(|node| node.0).collect();
    for (m, (g, kwh)) in sums.iter().enumerate() {
        let mut into = middle[m].0;
        for (s, source) in sources.iter().enumerate() {
            // Nobody can tell which source a loss was fed from: each feeds all alike.
            let size = source.kwh / whole * kwh * per_kwh;
            ribbon(&mut svg, 0, leaving[s], into, size, GROUPS[*g].0);
            leaving[s] += size;
            into += size;
        }
    }
    for (r, sink) in sinks.iter().enumerate() {
        let Some(m) = sums.iter().position(|(g, _)| *g == sink.group) else { continue };
        let size = sink.kwh * per_kwh;
        ribbon(&mut svg, 1, outgoing[m], right[r].0, size, GROUPS[sink.group].0);
        outgoing[m] += size;
    }
    for (part, node) in sources.iter().zip(&left) {
        box_of(&mut svg, 0, *node, "source", &part.name, part.kwh);
    }
    for ((g, kwh), node) in sums.iter().zip(&middle) {
        box_of(&mut svg, 1, *node, GROUPS[*g].0, GROUPS[*g].1, *kwh);
    }
    for (part, node) in sinks.iter().zip(&right) {
        box_of(&mut svg, 2, *node, GROUPS[part.group].0, &part.name, part.kwh);
    }
    svg + "</svg>\n"
}

/// A band from a column to the next.
fn ribbon(svg: &mut String, column: usize, from: f64, to: f64, size: f64, class: &str) {
    let (x, end) = (COLUMNS[column] + NODE, COLUMNS[column + 1]);
    let half = f64::midpoint(x, end);
    let (below, below_end) = (from + size, to + size);
    let _ = writeln!(
        svg,
        "<path class=\"flow {class}\" d=\"M{x:.1} {from:.1}C{half:.1} {from:.1} {half:.1} {to:.1} {end:.1} {to:.1}\
         V{below_end:.1}C{half:.1} {below_end:.1} {half:.1} {below:.1} {x:.1} {below:.1}Z\"/>"
    );
}

/// A node with its name: left of the first column, right of the others.
fn box_of(svg: &mut String, column: usize, node: (f64, f64), class: &str, name: &str, kwh: f64) {
    let (top, height) = node;
    let x = COLUMNS[column];
    let (at, anchor) = if column == 0 { (x - 6.0, "end") } else { (x + NODE + 6.0, "start") };
    let middle = top + height / 2.0 + 4.5;
    let name = escaped(name);
    let _ = writeln!(
        svg,
        "<rect class=\"node {class}\" x=\"{x}\" y=\"{top:.1}\" width=\"{NODE}\" height=\"{height:.1}\"/>\
         <text x=\"{at}\" y=\"{middle:.1}\" text-anchor=\"{anchor}\">{name} \
         <tspan class=\"quiet\">{kwh:.3} kWh</tspan></text>"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energy() -> EnergyReport {
        EnergyReport {
            electrochemical: 3.6e6,
            drag: 2.0e6,
            copper: 1.0e6,
            auxiliary: 1.0e6,
            potential: -0.4e6,
            throughput: 5e6,
            ..EnergyReport::default()
        }
    }

    #[test]
    fn what_comes_is_what_goes() {
        let (sources, sinks) = parts(&energy());
        let sum = |parts: &[Part]| parts.iter().map(|part| part.kwh).sum::<f64>();
        assert!((sum(&sources) - 4.0 / 3.6).abs() < 1e-6);
        assert!((sum(&sources) - sum(&sinks)).abs() < 1e-6);
        let names = |parts: &[Part]| parts.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&sources), ["height lost", "battery"]);
        assert_eq!(names(&sinks), ["drag", "copper", "auxiliary"]);
        let html = html(&energy());
        for text in ["height lost", "0.5556", "50.00", "class=\"flow road\"", "1.3889 kWh"] {
            assert!(html.contains(text), "{text}: {html}");
        }
    }

    #[test]
    fn a_battery_that_was_charged_is_no_source() {
        let charged =
            EnergyReport { electrochemical: -1e6, potential: -3e6, rolling: 2e6, ..energy() };
        let charged = EnergyReport { drag: 0.0, copper: 0.0, auxiliary: 0.0, ..charged };
        let (sources, sinks) = parts(&charged);
        assert_eq!(sources.len(), 1);
        assert!(sinks.iter().any(|part| part.name == "charged into the battery"));
        assert_eq!(html(&EnergyReport::default()), "");
    }
}
