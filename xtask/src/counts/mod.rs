//! What a step costs on a Cortex-M4F: instructions, counted in QEMU over UDDS at 1 kHz; flash,
//! state and stack in bytes. Beside it: the same plant in C, published PID controllers, a
//! Cortex-M0+, approximate functions. No figure is written by hand.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};

use crate::compare;
use crate::firmware;

mod estimators;
mod fast;
mod measure;
mod pids;
mod small;
mod table;

use measure::{M0, M4F, parse_item, plugin};
use table::{publish, table, times};

/// What is counted, and its row in the table.
const ITEMS: &[(&str, &str)] = &[
    ("plant_pid_off", "coupled plant + PID driver (`epowertrain-udds`)"),
    ("plant_pid_on", "the same with the energy ledger"),
    ("plant_torque_off", "coupled plant + torque driver (`bmw-i3-60ah-constant`)"),
    ("plant_torque_on", "the same with the energy ledger"),
    ("plant_mapped_off", "coupled plant + torque driver (`bmw-i3-60ah`)"),
    ("plant_mapped_on", "the same with the energy ledger"),
    ("plant_pmsm_off", "coupled plant + torque driver and loop (`bmw-i3-60ah-pmsm`)"),
    ("plant_axles_off", "coupled plant + torque driver and loops (`two-axles`)"),
    ("plant_dc_off", "coupled plant + torque driver and loop (`bmw-i3-60ah-constant`)"),
    ("plant_dcs_off", "the same car with two DC drives"),
    ("limited_pid_off", "coupled plant + PID driver, steps in which a battery limit acts"),
    ("limited_torque_off", "coupled plant + torque driver (`bmw-i3-60ah-constant`), the same"),
    ("limited_mapped_off", "coupled plant + torque driver (`bmw-i3-60ah`), the same"),
    ("powertrain", "coupled plant alone (`bmw-i3-60ah-constant`), every output kept"),
    ("limited_pmsm_off", "`bmw-i3-60ah-pmsm`, steps in which a battery limit acts"),
    ("limited_axles_off", "`two-axles`, the same"),
    ("limited_dcs_off", "two DC drives, the same"),
    ("battery", "battery"),
    ("mapped_battery", "battery with a map"),
    ("rc_branch", "RC branch"),
    ("auxiliary", "auxiliary load"),
    ("converter", "converter"),
    ("dc_motor", "DC motor"),
    ("gearbox", "gearbox"),
    ("wheel", "wheel"),
    ("body", "body"),
    ("rotational_load", "rotational load"),
    ("axis", "axis"),
    ("slope", "slope"),
    ("pid", "PID"),
    ("torque_driver", "torque driver"),
    ("voltage_sensor", "voltage sensor"),
    ("current_sensor", "current sensor"),
    ("speed_sensor", "axial speed sensor"),
    ("time_table", "time table (UDDS, 11 kB, in its flash)"),
    ("sine", "sine"),
    ("h_bridge", "switched H-bridge with a DC motor, steps of 10 µs, 10 kHz with dead time"),
    ("three_phase", "switched three-phase bridge with a synchronous machine, the same"),
];

/// How many of them are whole plants that a loop has time for.
const PLANTS: usize = 14;

/// What a second DC drive may add to a step.
const SECOND_DC: f64 = 190.0;

/// What a step of a switched circuit may take in the mean, commutation included: within 10 µs.
const SWITCHED: &[(&str, f64)] = &[("h_bridge", 400.0), ("three_phase", 1000.0)];

/// What the same plant in C is compared with.
const COMPARED: &str = "plant_pid_off";

/// How much worse than the baseline a figure may be.
const ALLOWED: f64 = 1.02;

/// Committed: what the last accepted code cost.
const BASELINE: &str = "firmware-example/baseline.json";
/// Set to accept what the code costs now.
const ACCEPT: &str = "VOLTSTEP_ACCEPT_COUNTS";

/// The plants are sent through this, and each of them must have come to it.
const PATHS: &[&str] = &["discharge", "charge", "refused", "standstill"];
/// All but this one also have auxiliary loads to starve.
const WITHOUT_LOADS: &str = "plant_pid";
const STARVED: &str = "starved";
/// How many plants there are, with and without a ledger.
const WORST_CASES: usize = 10;
/// A function that uses this much stack on purpose: the report has to show it.
const DEEP: (&str, u64) = ("deep", 256);

/// What one item costs.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost {
    min: u64,
    mean: f64,
    max: u64,
    flash: u64,
    state: u64,
    stack: u64,
}

impl Cost {
    /// The figures that the gate watches.
    fn watched(self) -> [(&'static str, f64); 5] {
        #[expect(clippy::cast_precision_loss, reason = "figures are far below 2^53")]
        let real = |figure: u64| figure as f64;
        [
            ("mean", self.mean),
            ("max", real(self.max)),
            ("flash", real(self.flash)),
            ("state", real(self.state)),
            ("stack", real(self.stack)),
        ]
    }

    fn to_json(self) -> Value {
        let watched = self.watched().map(|(name, figure)| (String::from(name), json!(figure)));
        Value::Object(watched.into_iter().collect())
    }
}

/// What a machine's items cost, and what its program said.
struct Measured {
    costs: BTreeMap<String, Cost>,
    said: String,
}

impl Measured {
    fn cost(&self, name: &str) -> Result<Cost> {
        self.costs.get(name).copied().with_context(|| missing(name))
    }
}

/// Counts, writes the tables, compares with the baseline.
pub fn counts() -> Result<()> {
    let measured = M4F.measure()?;
    check_paths(&measured.said)?;
    let rows: Vec<(&str, Cost)> = ITEMS
        .iter()
        .map(|(name, about)| Ok((*about, measured.cost(name)?)))
        .collect::<Result<_>>()?;
    second_dc(measured.cost("plant_dc_off")?, measured.cost("plant_dcs_off")?)?;
    for (item, most) in SWITCHED {
        let mean = measured.cost(item)?.mean;
        ensure!(mean <= *most, "`{item}` takes {mean:.1} instructions, not {most}");
    }
    let ours = measured.cost(COMPARED)?;
    let plugin = plugin(&firmware::binary("voltstep-bench")?)?;
    let compared = compare::table((ours.mean, ours.flash, ours.state), &plugin)?;
    let on_m0 = M0.measure()?;
    small::same_bits(&on_m0.said)?;
    publish(
        &[
            table(&rows),
            times(&rows[..PLANTS])?,
            compared,
            estimators::table(&measured)?,
            pids::table(&measured)?,
            small::table(&on_m0, &measured)?,
            fast::table(&measured, &on_m0)?,
        ]
        .concat(),
    )?;
    let mut costs = measured.costs;
    costs.extend(
        on_m0.costs.into_iter().map(|(name, cost)| (format!("{}{name}", small::PREFIX), cost)),
    );
    let path = firmware::root().join(BASELINE);
    if std::env::var_os(ACCEPT).is_some() {
        let all: serde_json::Map<_, _> =
            costs.iter().map(|(name, cost)| (name.clone(), cost.to_json())).collect();
        fs::write(&path, format!("{:#}\n", Value::Object(all)))?;
        println!("{BASELINE} is accepted");
        return Ok(());
    }
    let baseline = fs::read_to_string(&path)
        .with_context(|| format!("no {BASELINE}; {ACCEPT}=1 cargo xtask counts makes it"))?;
    gate(&serde_json::from_str(&baseline).context(BASELINE)?, &costs)
}

fn missing(name: &str) -> String {
    format!("`{name}` was not measured")
}

/// A second drive costs little beside the first.
fn second_dc(one: Cost, two: Cost) -> Result<()> {
    let more = two.mean - one.mean;
    ensure!(more <= SECOND_DC, "a second DC drive takes {more:.1} instructions more");
    Ok(())
}

/// Each plant went through everything that UDDS does not come to, and stack that is used is seen.
fn check_paths(said: &str) -> Result<()> {
    let mut plants = 0;
    for line in said.lines().filter_map(|line| line.strip_prefix("came ")) {
        plants += 1;
        let starving = (!line.starts_with(WITHOUT_LOADS)).then_some(STARVED);
        for path in PATHS.iter().copied().chain(starving) {
            let came = line.split(' ').any(|word| word == format!("{path}=true"));
            ensure!(came, "the worst case did not come to `{path}`: {line}");
        }
    }
    ensure!(plants == WORST_CASES, "{plants} plants went through the worst case");
    let (_, deep) = parse_item(said, DEEP.0).with_context(|| missing(DEEP.0))?;
    ensure!(deep >= DEEP.1, "a function that uses {} bytes of stack shows {deep}", DEEP.1);
    Ok(())
}

/// Fails where a figure is worse than the baseline allows, or an item is not in it.
fn gate(baseline: &Value, costs: &BTreeMap<String, Cost>) -> Result<()> {
    let mut worse = String::new();
    for (name, cost) in costs {
        for (figure, now) in cost.watched() {
            match baseline[name][figure].as_f64() {
                Some(then) if now <= then * ALLOWED => {}
                Some(then) => {
                    let _ = write!(worse, "\n  {name}: {figure} {then} → {now}");
                }
                None => {
                    let _ = write!(worse, "\n  {name}: {figure} is not in the baseline");
                }
            }
        }
    }
    ensure!(
        worse.is_empty(),
        "worse than {BASELINE} by more than 2 %:{worse}\nif that is wanted: {ACCEPT}=1 cargo xtask counts"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const COST: Cost = Cost { min: 90, mean: 100.0, max: 110, flash: 1000, state: 16, stack: 40 };

    fn baseline() -> Value {
        json!({ "battery": COST.to_json() })
    }

    fn costs(cost: Cost) -> BTreeMap<String, Cost> {
        BTreeMap::from([(String::from("battery"), cost)])
    }

    #[test]
    fn the_gate_lets_two_percent_pass_and_no_more() {
        assert!(gate(&baseline(), &costs(COST)).is_ok());
        assert!(gate(&baseline(), &costs(Cost { mean: 102.0, max: 1, ..COST })).is_ok());
        for worse in [
            Cost { mean: 102.1, ..COST },
            Cost { max: 113, ..COST },
            Cost { flash: 1021, ..COST },
            Cost { state: 20, ..COST },
            Cost { stack: 48, ..COST },
        ] {
            let error = gate(&baseline(), &costs(worse)).unwrap_err().to_string();
            assert!(error.contains("battery"), "{error}");
        }
        assert!(gate(&json!({}), &costs(COST)).is_err(), "not in the baseline");
    }

    #[test]
    fn the_worst_case_has_to_be_one() {
        let path = "discharge=true charge=true starved=true refused=true standstill=true";
        let said = |path: &str, deep: u32| {
            let plants =
                ["pid", "torque", "mapped", "pmsm", "dc"].map(|plant| [plant, plant]).concat();
            let came: Vec<_> = plants.iter().map(|p| format!("came plant_{p} {path}")).collect();
            format!("{}\nitem deep 0 {deep}\n", came.join("\n"))
        };
        assert!(check_paths(&said(path, 280)).is_ok());
        assert!(check_paths(&said(path, 8)).is_err(), "the control is not seen");
        for word in ["discharge", "starved", "refused"] {
            let missed = path.replace(&format!("{word}=true"), &format!("{word}=false"));
            assert!(check_paths(&said(&missed, 280)).is_err(), "{word}");
        }
        assert!(check_paths("item deep 0 280").is_err(), "no plant");
    }

    #[test]
    fn a_second_drive_costs_little() {
        assert!(second_dc(COST, Cost { mean: 290.0, ..COST }).is_ok());
        let dear = second_dc(COST, Cost { mean: 290.1, ..COST }).unwrap_err().to_string();
        assert!(dear.contains("190.1"), "{dear}");
    }

    #[test]
    fn item_names_are_unique() {
        for (i, (name, _)) in ITEMS.iter().enumerate() {
            assert!(ITEMS[..i].iter().all(|other| other.0 != *name), "{name}");
        }
    }
}
