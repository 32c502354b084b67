//! A circuit's run: its figures on a terminal, its plot sheet, its trace.

use crate::read::netlist::Netlist;
use crate::show::plot::{Kind, Panel, Series, Sheet, render as draw};
use crate::show::table::table;
use crate::show::trace::number;
use crate::simulate::circuit::CircuitRun;

/// The figures of each element.
pub fn render(netlist: &Netlist, run: &CircuitRun) -> String {
    let mut figures = table(&[
        "element",
        "least [V]",
        "mean [V]",
        "largest [V]",
        "least [A]",
        "mean [A]",
        "largest [A]",
    ]);
    for element in &run.elements {
        let (v, a) = (element.voltage_v, element.current_a);
        let numbers = [v.least, v.mean, v.largest, a.least, a.mean, a.largest];
        let row = numbers.map(|x| format!("{x:.5}"));
        figures.add_row([element.name.clone()].into_iter().chain(row));
    }
    let end = match run.unsettled_steps {
        0 => "every step settled".to_owned(),
        n => format!("{n} steps did NOT settle: take a shorter step"),
    };
    format!(
        "{}: {}\n{figures}\n{} steps; power balances to {:.1e} of what flows; {end}\n",
        run.name, netlist.description, run.steps, run.balance_rel
    )
}

/// The plot sheet as SVG.
pub fn sheet(netlist: &Netlist, run: &CircuitRun) -> anyhow::Result<String> {
    let panel = |e: &usize, title: &str, unit: &str, columns: &[Vec<f64>]| Panel {
        title: format!("{title} of {}", netlist.parts[*e].name),
        unit: unit.into(),
        series: vec![Series::new(&netlist.parts[*e].name, Kind::Simulated, columns[*e].clone())],
    };
    let voltages = netlist.plotted_v.iter().map(|e| panel(e, "Voltage", "V", &run.voltage_v));
    let currents = netlist.plotted_a.iter().map(|e| panel(e, "Current", "A", &run.current_a));
    draw(&Sheet {
        title: run.name.clone(),
        subtitle: vec![netlist.description.clone()],
        time_s: run.time_s.clone(),
        panels: voltages.chain(currents).collect(),
        bars_title: String::new(),
        bars_unit: String::new(),
        bars: Vec::new(),
    })
}

/// The trace as CSV: voltage and current of each element.
pub fn csv(run: &CircuitRun) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names =
        run.elements.iter().flat_map(|e| ["v", "a"].map(|unit| format!("{}_{unit}", e.name)));
    writer.write_record(["time_s".to_owned()].into_iter().chain(names))?;
    for (i, time_s) in run.time_s.iter().enumerate() {
        let row = (run.voltage_v.iter().zip(&run.current_a)).flat_map(|(v, a)| [v[i], a[i]]);
        writer.write_record([*time_s].into_iter().chain(row).map(number))?;
    }
    writer.into_inner().map_err(|e| anyhow::anyhow!("writing the trace: {e}"))
}
