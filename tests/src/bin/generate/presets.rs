//! Writes `plant-core/src/presets/batteries.rs` from `data/batteries/*.toml`: one set of numbers.

use std::fmt::Write as _;
use std::path::Path;

use toml::{Table, Value};

const HEADER: &str = "\
//! Batteries identified from measurements, with parameters over state of charge and temperature.
//!
//! Made from `data/batteries/*.toml` by `cargo xtask presets`; those files hold the figures of the
//! fit and the command that made them, and a test keeps the two equal.
#![expect(clippy::unreadable_literal, reason = \"as in the files\")]

use crate::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap, ThermalParams, VoltageLimits,
};
use crate::must;
use crate::num::SocTable;
";

const PRESETS: [(&str, &str, &str); 2] = [
    (
        "bmw-i3-60ah",
        "BMW_I3_60AH_PACK",
        "The pack of a BMW i3 60 Ah, 96 cells in series: least squares on the trips of \"Battery and\n\
         /// Heating Data in Real Driving Cycles\" (TU Munich, DOI 10.21227/6jr9-5235).",
    ),
    (
        "panasonic-ncr18650pf",
        "PANASONIC_NCR18650PF",
        "One Panasonic NCR18650PF cell: least squares on the tests of \"Panasonic 18650PF Li-ion Battery\n\
         /// Data\" (P. Kollmeyer, University of Wisconsin-Madison, DOI 10.17632/wykht8y7tg.1).",
    ),
];

/// Writes the file below the root of the workspace.
pub fn write(root: &Path) {
    let mut text = HEADER.to_owned();
    for (file, name, doc) in PRESETS {
        let path = root.join(format!("data/batteries/{file}.toml"));
        let table: Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
        write!(text, "\n/// {doc}\npub const {name}: MappedBatteryParams = ").unwrap();
        battery(&mut text, table["battery"].as_table().unwrap());
        text += ";\n";
    }
    std::fs::write(root.join("plant-core/src/presets/batteries.rs"), text).unwrap();
}

fn battery(text: &mut String, battery: &Table) {
    let numbers = |table: &Table, keys: &[&str]| -> String {
        let fields = keys.iter().map(|key| format!("{key}: {}", number(&table[*key])));
        fields.collect::<Vec<_>>().join(", ")
    };
    let part = |key: &str| battery[key].as_table().unwrap();
    let keys = ["capacity_ah", "discharge_limit_a", "charge_limit_a", "refresh_s"];
    let ocv = points("battery.open_circuit.table", &part("open_circuit")["table"]);
    write!(
        text,
        "MappedBatteryParams {{ {}, open_circuit: OpenCircuit::Table({ocv}), \
         hysteresis: HysteresisParams::NONE, voltage_limits: {}, ",
        numbers(battery, &keys),
        voltage_limits(battery)
    )
    .unwrap();
    for (key, kind, keys) in [
        ("series", "ResistanceMap", &["activation_k"][..]),
        ("polarisation", "BranchMap", &["activation_k", "time_constant_s"]),
        ("second_polarisation", "BranchMap", &["activation_k", "time_constant_s"]),
    ] {
        let field = format!("battery.{key}.resistance_ohm");
        let ohm = points(&field, &part(key)["resistance_ohm"]["table"]);
        let rest = numbers(part(key), keys);
        write!(text, "{key}: {kind} {{ resistance_ohm: OverSoc::Table({ohm}), {rest} }}, ")
            .unwrap();
    }
    let keys = ["heat_capacity_j_per_k", "cooling_w_per_k", "ambient_c"];
    let thermal = battery.get("thermal").and_then(Value::as_table).map_or_else(
        || "ThermalParams::FIXED".to_owned(),
        |node| format!("ThermalParams {{ {} }}", numbers(node, &keys)),
    );
    let keys = ["soc_min", "soc_max", "temperature_min_c", "temperature_max_c"];
    let range = numbers(part("identified"), &keys);
    write!(text, "thermal: {thermal}, identified: IdentifiedRange {{ {range} }} }}").unwrap();
}

fn voltage_limits(battery: &Table) -> String {
    let Some(Value::Table(limits)) = battery.get("voltage_limits") else {
        return "VoltageLimits::NONE".to_owned();
    };
    let fields = limits.iter().map(|(key, value)| format!("{key}: {}, ", number(value)));
    format!("VoltageLimits {{ {}..VoltageLimits::NONE }}", fields.collect::<String>())
}

#[expect(clippy::cast_precision_loss, reason = "a short number")]
fn number(value: &Value) -> String {
    let value = value.as_float().or_else(|| value.as_integer().map(|i| i as f64)).unwrap();
    if value.is_infinite() { "crate::num::Real::INFINITY".to_owned() } else { format!("{value:?}") }
}

fn points(field: &str, table: &Value) -> String {
    let mut text = format!("must!(SocTable::from_points(\"{field}\", &[");
    for point in table.as_array().unwrap() {
        write!(text, "({}, {}), ", number(&point[0]), number(&point[1])).unwrap();
    }
    text + "]))"
}
