//! The vehicle file that an identification comes to; `read::vehicle` reads it.

use anyhow::Context;
use toml::{Table, Value};

use super::regress::{Found, REFERENCE_C};
use super::samples::Known;
use super::{IdentifiedVehicle, Template};
use crate::identify::write::short;
use crate::read::vehicle::{self, TripConditions, Vehicle};

/// Points of the rolling resistance over the temperature are this far apart \[K\].
const POINTS_K: f64 = 5.0;
const HEADER: &str = "# A vehicle as trips tell it, written by `voltstep identify vehicle`. What they do not tell is that \
     of the\n# vehicle given with --vehicle.\n\n";

impl Template {
    /// The vehicle with what was found in its place.
    pub(super) fn with(&self, found: &Found, known: &Known) -> anyhow::Result<Vehicle> {
        let text = toml::to_string(&self.table(found, known)?)?;
        Ok(vehicle::parse(&self.file, text.as_bytes())?)
    }

    /// The whole file, with how it was found.
    pub(super) fn file(
        &self,
        found: &Found,
        known: &Known,
        identified: &IdentifiedVehicle,
    ) -> anyhow::Result<String> {
        let mut table = self.table(found, known)?;
        let mut errors = Table::new();
        for p in &identified.parameters {
            errors.insert(p.name.clone(), number(p.standard_error, 2));
        }
        table.insert("standard_error".to_owned(), Value::Table(errors));
        let mut fit = Table::new();
        fit.insert("command".to_owned(), identified.command.as_str().into());
        fit.insert("unexplained_n".to_owned(), number(identified.unexplained_n, 3));
        let (trips, doubtful): (Vec<_>, Vec<_>) =
            identified.left_out.iter().partition(|r| r.doubts.is_empty());
        let names = |rows: Vec<&super::LeftOut>| {
            Value::Array(rows.into_iter().map(|r| r.name.as_str().into()).collect())
        };
        fit.insert("trips".to_owned(), names(trips));
        fit.insert("not_fitted".to_owned(), names(doubtful));
        for s in &identified.expected.spreads {
            for (suffix, value) in [("median", s.median), ("p90", s.p90)] {
                fit.insert(format!("left_out_{}_{suffix}", s.name), number(value, 3));
            }
        }
        table.insert("fit".to_owned(), Value::Table(fit));
        let text = format!("{HEADER}{}", toml::to_string(&table)?);
        // What was found must be a vehicle.
        vehicle::parse(&self.file, text.as_bytes())?;
        Ok(text)
    }

    fn table(&self, found: &Found, known: &Known) -> anyhow::Result<Table> {
        let mut table = self.table.clone();
        let conditions = self.vehicle.trips.as_ref().context("no conditions")?;
        let reference_n = found.rolling.at(REFERENCE_C);
        let weight_n = found.mass_kg * f64::from(plant_core::num::GRAVITY_M_S2);
        let [squared, size, speed, moving] = found.losses;
        let kt = known.torque_nm_per_a;
        let winding_ohm = squared * kt * kt - known.converter_ohm;
        // The winding's resistance must be above zero; what the converter takes beyond is its own.
        let (winding_ohm, converter_ohm) = if winding_ohm > 1e-5 {
            (winding_ohm, known.converter_ohm)
        } else {
            (1e-5, (squared * kt * kt - 1e-5).max(0.0))
        };
        let mut set = |path: &[&str], value: f64| set(&mut table, path, number(value, 5));
        set(&["auxiliary", "power_w"], found.base_w)?;
        set(&["converter", "resistance_ohm"], converter_ohm)?;
        set(&["converter", "voltage_drop_v"], size * kt)?;
        set(&["motor", "resistance_ohm"], winding_ohm)?;
        set(&["motor", "viscous_nm_s_per_rad"], speed)?;
        set(&["motor", "coulomb_nm"], 0.0)?;
        set(&["gearbox", "efficiency"], found.efficiency)?;
        set(&["wheel", "viscous_nm_s_per_rad"], 0.0)?;
        set(&["body", "mass_kg"], found.mass_kg)?;
        let physical = ["body", "resistance", "physical"];
        let in_physical = |key| [physical[0], physical[1], physical[2], key];
        set(&in_physical("drag_coefficient"), found.drag_area_m2 / known.area_m2)?;
        set(&in_physical("rolling_coefficient"), reference_n / weight_n)?;
        if let Some(r) = found.regeneration {
            set(&["driver", "torque", "regen_torque_nm"], r.torque_nm)?;
            set(&["driver", "torque", "regen_power_w"], r.power_w)?;
            set(&["driver", "torque", "regen_fade_m_s"], r.fade_m_s)?;
        }
        let (low, high) = found.rolling.seen_c;
        let mut points_c = vec![low];
        let mut next = (low / POINTS_K).floor() * POINTS_K + POINTS_K;
        while next < high {
            points_c.push(next);
            next += POINTS_K;
        }
        if high > low {
            points_c.push(high);
        }
        let factor = |c: f64| rounded(found.rolling.at(c) / reference_n, 4);
        let trips = TripConditions {
            rolling_factor: points_c.into_iter().map(|c| (rounded(c, 4), factor(c))).collect(),
            warm_up_factor: rounded(found.warm_up_n / reference_n, 4),
            moving_power_w: rounded(moving, 4),
            ..conditions.clone()
        };
        table.insert("trips".to_owned(), Value::try_from(trips)?);
        table.insert("name".to_owned(), self.name.as_str().into());
        let described = format!("{}, identified from trips", self.vehicle.name);
        table.insert("description".to_owned(), described.into());
        table.remove("fit");
        table.remove("standard_error");
        Ok(table)
    }
}

/// Puts a value where the template has one, or its table.
fn set(table: &mut Table, path: &[&str], value: Value) -> anyhow::Result<()> {
    let (key, tables) = path.split_last().context("an empty path")?;
    let mut at = table;
    for name in tables {
        let inner = at.entry(*name).or_insert_with(|| Value::Table(Table::new()));
        at = inner.as_table_mut().with_context(|| format!("{name} is no table"))?;
    }
    at.insert((*key).to_owned(), value);
    Ok(())
}

fn rounded(value: f64, digits: usize) -> f64 {
    short(value, digits).parse().unwrap_or(value)
}

fn number(value: f64, digits: usize) -> Value {
    Value::Float(rounded(value, digits))
}
