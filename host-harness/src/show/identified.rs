//! `voltstep identify battery` on a terminal and as JSON.

use serde::Serialize;

use crate::identify::{Estimate, HeldOut, Identified};
use crate::show::table::{number, table};

/// A value with its standard error, null where there is none.
#[derive(Serialize)]
struct Value {
    value: f64,
    standard_error: Option<f64>,
}

impl From<Estimate> for Value {
    fn from(e: Estimate) -> Self {
        Self { value: e.value, standard_error: Some(e.error).filter(|e| e.is_finite()) }
    }
}

#[derive(Serialize)]
struct Point {
    soc: f64,
    #[serde(flatten)]
    value: Value,
}

#[derive(Serialize)]
struct Branch {
    resistance_ohm: Vec<Point>,
    activation_k: Value,
    time_constant_s: Option<Value>,
}

#[derive(Serialize)]
struct Json<'a> {
    name: &'a str,
    source: &'a str,
    command: &'a str,
    files: &'a [String],
    capacity_ah: Value,
    open_circuit_v: Vec<Point>,
    series: Branch,
    polarisation: Branch,
    second_polarisation: Option<Branch>,
    heat_capacity_j_per_k: Option<Value>,
    cooling_w_per_k: Option<Value>,
    current_delay_s: f64,
    soc: [f64; 2],
    temperature_c: [f64; 2],
    voltage_rmse_v: f64,
    temperature_rmse_k: Option<f64>,
    folds: usize,
    seed: u64,
    held_out: &'a [HeldOut],
    held_out_voltage_rmse_v_median: Option<f64>,
    held_out_voltage_rmse_v_p90: Option<f64>,
    held_out_voltage_rmse_v_max: Option<f64>,
    notes: &'a [String],
}

/// The JSON text, with a line end.
///
/// # Errors
/// None that is known of.
pub fn json(found: &Identified) -> anyhow::Result<String> {
    let points = |values: Vec<(f64, Estimate)>| {
        values.into_iter().map(|(soc, e)| Point { soc, value: e.into() }).collect()
    };
    let branch = |b: usize| Branch {
        resistance_ohm: points(found.resistances(b)),
        activation_k: found.activation_k(b).into(),
        time_constant_s: (b > 0).then(|| found.time_constant(b).into()),
    };
    let o = &found.options;
    let spread = found.held_out_spread();
    let json = Json {
        name: &o.name,
        source: &o.source,
        command: &o.command,
        files: &found.files,
        capacity_ah: found.capacity.into(),
        open_circuit_v: points(found.open_circuit()),
        series: branch(0),
        polarisation: branch(1),
        second_polarisation: found.second_branch.then(|| branch(2)),
        heat_capacity_j_per_k: found.thermal.map(|n| n.heat_capacity_j_per_k.into()),
        cooling_w_per_k: found.thermal.map(|n| n.cooling_w_per_k.into()),
        current_delay_s: found.current_delay_s,
        soc: found.soc.into(),
        temperature_c: found.celsius.into(),
        voltage_rmse_v: found.voltage_rmse_v,
        temperature_rmse_k: found.thermal.map(|n| n.rmse_k),
        folds: o.folds,
        seed: o.seed,
        held_out: &found.held_out,
        held_out_voltage_rmse_v_median: spread.map(|s| s.median),
        held_out_voltage_rmse_v_p90: spread.map(|s| s.p90),
        held_out_voltage_rmse_v_max: spread.map(|s| s.max),
        notes: &found.notes,
    };
    super::json(&json)
}

/// Each parameter, how far the battery is from what it was not fitted to, and notes.
pub fn render(found: &Identified) -> String {
    let mut rows = table(&[found.options.name.as_str(), "value", "standard error"]);
    let mut row = |name: &str, e: Estimate, digits: usize| {
        let error =
            if e.error.is_finite() { format!("{:.digits$}", e.error) } else { "–".to_owned() };
        rows.add_row([name.to_owned(), format!("{:.digits$}", e.value), error]);
    };
    row("capacity [A·h]", found.capacity, 4);
    for (soc, e) in found.open_circuit() {
        row(&format!("open-circuit voltage at {:.1} % [V]", 100.0 * soc), e, 4);
    }
    let names = ["series", "first RC", "second RC"];
    for (b, name) in names.iter().enumerate().take(found.branches()) {
        for (soc, e) in found.resistances(b) {
            row(&format!("{name} resistance at {:.1} % [Ω]", 100.0 * soc), e, 5);
        }
        if b > 0 {
            row(&format!("{name} time constant [s]"), found.time_constant(b), 2);
        }
        row(&format!("{name} activation temperature [K]"), found.activation_k(b), 0);
    }
    if let Some(node) = &found.thermal {
        row("heat capacity [J/K]", node.heat_capacity_j_per_k, 2);
        row("cooling [W/K]", node.cooling_w_per_k, 4);
    }
    // A pack's voltages in volts, a cell's in millivolts.
    let (unit, factor, digits) = if found.of_trips { ("V", 1.0, 2) } else { ("mV", 1e3, 1) };
    let mut text = format!("{rows}\n");
    if !found.held_out.is_empty() {
        let (all, low, high) = (
            format!("voltage [{unit}]"),
            format!("above 15 % [{unit}]"),
            format!("above 25 % [{unit}]"),
        );
        let mut rows = table(&["left out of the fit", "parts", &all, &low, &high]);
        let of = |v: Option<f64>| number(v.map(|v| factor * v), digits);
        for r in &found.held_out {
            rows.add_row([
                r.name.clone(),
                r.parts.to_string(),
                of(Some(r.voltage_rmse_v)),
                of(r.voltage_rmse_v_above_15_soc),
                of(r.voltage_rmse_v_above_25_soc),
            ]);
        }
        text += &format!("{rows}\n");
        if let Some(s) = found.held_out_spread() {
            text += &format!(
                "left out of the fit, RMS: median {}, 90th percentile {}, worst {} {unit}\n",
                of(Some(s.median)),
                of(Some(s.p90)),
                of(Some(s.max))
            );
        }
    }
    let rmse = factor * found.voltage_rmse_v;
    text += &format!("{} files, {rmse:.digits$} {unit} RMS over all\n", found.files.len());
    for note in &found.notes {
        text += &format!("note: {note}\n");
    }
    text
}
