//! The battery file that an identification comes to; `read::battery` reads it.

use std::fmt::Write as _;

use super::battery::Identified;
use super::layout::{ACTIVATION_UNIT_K, BRANCHES};

/// How many points stand on a line of a table.
const POINTS_PER_LINE: usize = 5;
const BRANCH_NAMES: [&str; BRANCHES] = ["series", "polarisation", "second_polarisation"];

impl Identified {
    /// Digits after the point of a voltage: a tenth of a millivolt for a cell, a millivolt for a
    /// pack.
    fn voltage_digits(&self) -> usize {
        if self.parameters[0] < 20.0 { 4 } else { 3 }
    }

    /// The file's text.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let o = &self.options;
        let mut text = String::new();
        for (key, value) in [
            ("name", &o.name),
            ("description", &o.description),
            ("source", &o.source),
            ("command", &o.command),
        ] {
            let _ = writeln!(text, "{key} = {}", toml::Value::from(value.as_str()));
        }
        text +=
            "\n# How it was found, and how far it is from files that it was not fitted to [V].\n";
        self.fit(&mut text);
        self.battery(&mut text);
        self.standard_error(&mut text);
        text
    }

    fn fit(&self, text: &mut String) {
        let _ = writeln!(text, "[fit]\ncurrent_delay_s = {:?}", self.current_delay_s);
        let _ = writeln!(text, "voltage_rmse_v = {}", short(self.voltage_rmse_v, 3));
        if let Some(node) = &self.thermal {
            let _ = writeln!(text, "temperature_rmse_k = {}", short(node.rmse_k, 3));
        }
        let names = |names: &[String]| {
            let quoted: Vec<_> =
                names.iter().map(|n| toml::Value::from(n.as_str()).to_string()).collect();
            lines(&quoted)
        };
        let _ = writeln!(text, "files = [{}]", names(&self.files));
        if !self.notes.is_empty() {
            let _ = writeln!(text, "notes = [");
            for note in &self.notes {
                let _ = writeln!(text, "    {},", toml::Value::from(note.as_str()));
            }
            let _ = writeln!(text, "]");
        }
        if !self.held_out.is_empty() {
            let _ = writeln!(
                text,
                "\n[fit.cross_validation]\nfolds = {}\nseed = {}",
                self.options.folds, self.options.seed
            );
            if let Some(s) = self.held_out_spread() {
                let _ = writeln!(
                    text,
                    "voltage_rmse_v_median = {}\nvoltage_rmse_v_p90 = {}",
                    short(s.median, 3),
                    short(s.p90, 3)
                );
            }
            let row = |r: &super::cross::HeldOut| {
                let number = |v: Option<f64>| v.map_or("nan".to_owned(), |v| short(v, 3));
                let (name, parts) = (toml::Value::from(r.name.as_str()), r.parts);
                format!(
                    "\n    {{ name = {name}, parts = {parts}, voltage_rmse_v = {}, above_15_soc = {}, above_25_soc = {} }},",
                    short(r.voltage_rmse_v, 3),
                    number(r.voltage_rmse_v_above_15_soc),
                    number(r.voltage_rmse_v_above_25_soc),
                )
            };
            let rows: String = self.held_out.iter().map(row).collect();
            let _ = writeln!(text, "held_out = [{rows}\n]");
        }
    }

    fn battery(&self, text: &mut String) {
        let o = &self.options;
        let _ = writeln!(
            text,
            "\n[battery]\ncapacity_ah = {}\ndischarge_limit_a = {:?}\ncharge_limit_a = {:?}\n\
             refresh_s = 1.0",
            short(self.capacity.value, 4),
            o.discharge_limit_a,
            o.charge_limit_a
        );
        let digits = self.voltage_digits();
        let volts = self.parameters[self.layout.voltages()].iter().map(|v| format!("{v:.digits$}"));
        let _ = writeln!(
            text,
            "\n[battery.open_circuit]\ntable = [{}]",
            points(&self.layout.ocv, volts.collect())
        );
        for (b, name) in BRANCH_NAMES.iter().enumerate().take(self.branches()) {
            let _ = writeln!(text, "\n[battery.{name}]");
            let activation = self.parameters[self.layout.activation(b)] * ACTIVATION_UNIT_K;
            let _ = writeln!(text, "activation_k = {activation:.0}");
            if b > 0 {
                let tau_s = self.parameters[self.layout.log_tau(b)].exp();
                let _ = writeln!(text, "time_constant_s = {}", short(tau_s, 4));
            }
            let ohms =
                self.parameters[self.layout.resistances(b)].iter().map(|r| short(r.max(0.0), 4));
            let _ = writeln!(
                text,
                "resistance_ohm.table = [{}]",
                points(&self.layout.ohm, ohms.collect())
            );
        }
        if let Some(node) = &self.thermal {
            let _ = writeln!(
                text,
                "\n[battery.thermal]\nheat_capacity_j_per_k = {}\ncooling_w_per_k = {}\n\
                 ambient_c = {:.1}",
                short(node.heat_capacity_j_per_k.value, 4),
                short(node.cooling_w_per_k.value, 4),
                node.ambient_c
            );
        }
        let _ = writeln!(
            text,
            "\n[battery.identified]\nsoc_min = {:.4}\nsoc_max = {:.4}\ntemperature_min_c = {:.1}\n\
             temperature_max_c = {:.1}",
            self.soc.0, self.soc.1, self.celsius.0, self.celsius.1
        );
    }

    fn standard_error(&self, text: &mut String) {
        *text += "\n# One standard error of each value, in the order of its points; nan where it was given,\n\
                  # held, or is at its bound of zero.\n[standard_error]\n";
        let _ = writeln!(text, "capacity_ah = {}", error(self.capacity.error));
        let list = |range: std::ops::Range<usize>| {
            lines(&self.errors[range].iter().map(|e| error(*e)).collect::<Vec<_>>())
        };
        let _ = writeln!(text, "open_circuit.table = [{}]", list(self.layout.voltages()));
        for (b, name) in BRANCH_NAMES.iter().enumerate().take(self.branches()) {
            let at = self.layout.activation(b);
            let _ = writeln!(
                text,
                "{name}.activation_k = {}",
                error(self.errors[at] * ACTIVATION_UNIT_K)
            );
            if b > 0 {
                let tau = self.time_constant(b);
                let _ = writeln!(text, "{name}.time_constant_s = {}", error(tau.error));
            }
            let _ = writeln!(
                text,
                "{name}.resistance_ohm.table = [{}]",
                list(self.layout.resistances(b))
            );
        }
        if let Some(node) = &self.thermal {
            for (key, value) in [
                ("heat_capacity_j_per_k", node.heat_capacity_j_per_k),
                ("cooling_w_per_k", node.cooling_w_per_k),
            ] {
                let _ = writeln!(text, "thermal.{key} = {}", error(value.error));
            }
        }
    }
}

/// To so many significant digits, without an exponent where that is short.
pub(super) fn short(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    // As TOML knows it: with a point.
    format!("{rounded:?}")
}

fn error(value: f64) -> String {
    if value.is_finite() { short(value, 2) } else { "nan".to_owned() }
}

/// `[soc, value]` pairs, a few to a line.
fn points(soc: &[f64], values: Vec<String>) -> String {
    let pairs: Vec<String> = soc.iter().zip(values).map(|(s, v)| format!("[{s:?}, {v}]")).collect();
    lines(&pairs)
}

fn lines(items: &[String]) -> String {
    let rows = items.chunks(POINTS_PER_LINE).map(|row| format!("\n    {},", row.join(", ")));
    rows.collect::<String>() + "\n"
}
