//! What a step costs on a Cortex-M4F: instructions, counted in QEMU over UDDS at 1 kHz; flash,
//! state and stack in bytes. No figure is written by hand.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde_json::{Value, json};

use crate::compare;
use crate::firmware;
use crate::shell::{output, program, run};

mod table;

use table::{publish, table, times};

/// What is counted, and its row in the table.
const ITEMS: &[(&str, &str)] = &[
    ("plant_pid_off", "coupled plant + PID driver (`epowertrain-udds`)"),
    ("plant_pid_on", "the same with the energy ledger"),
    ("plant_torque_off", "coupled plant + torque driver (`bmw-i3-60ah`)"),
    ("plant_torque_on", "the same with the energy ledger"),
    ("limited_pid_off", "coupled plant + PID driver, steps in which a battery limit acts"),
    ("limited_torque_off", "coupled plant + torque driver, the same"),
    ("powertrain", "coupled plant alone (`bmw-i3-60ah`), every output kept"),
    ("battery", "battery"),
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
];

/// How many of them are whole plants.
const PLANTS: usize = 7;

/// What the same plant in C is compared with.
const COMPARED: &str = "plant_pid_off";

/// An empty function: `push`, `mov`, `pop`. The target keeps frame pointers.
const NOTHING: (&str, u64) = ("nothing", 3);

/// The names of the counted functions begin with this.
const PREFIX: &str = "bench_";

/// So do those of steps in which a limit acts.
const LIMITED: &str = "limited_";

/// How much worse than the baseline a figure may be.
const ALLOWED: f64 = 1.02;

/// Committed: what the last accepted code cost.
const BASELINE: &str = "firmware-example/baseline.json";
/// Set to accept what the code costs now.
const ACCEPT: &str = "VOLTSTEP_ACCEPT_COUNTS";

/// The plants are sent through this, and each of them must have come to it.
const PATHS: &[&str] = &["discharge", "charge", "refused", "standstill"];
/// These also have auxiliary loads to starve.
const STARVING: (&str, &str) = ("plant_torque", "starved");
/// A function that uses this much stack on purpose: the report has to show it.
const DEEP: (&str, u64) = ("deep", 256);

/// Instructions per call: least, mean, most.
pub type Counted = (u64, f64, u64);

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

/// Counts, writes the table, compares with the baseline.
pub fn counts() -> Result<()> {
    let costs = measure()?;
    let rows: Vec<(&str, Cost)> = ITEMS
        .iter()
        .map(|(name, about)| Ok((*about, *costs.get(*name).with_context(|| missing(name))?)))
        .collect::<Result<_>>()?;
    let ours = costs.get(COMPARED).with_context(|| missing(COMPARED))?;
    let plugin = plugin(&firmware::binary("voltstep-bench")?)?;
    let compared = compare::table((ours.mean, ours.flash, ours.state), &plugin)?;
    publish(&(table(&rows) + &times(&rows[..PLANTS])? + &compared))?;
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

/// Runs the bench image under the plugin and sizes one image per item.
fn measure() -> Result<BTreeMap<String, Cost>> {
    firmware::build(&["-p", "voltstep-bench", "--bin", "voltstep-bench"], &[])?;
    let elf = firmware::binary("voltstep-bench")?;
    let nm = output(program("arm-none-eabi-nm").arg(&elf))?;
    let functions = functions(&nm);
    let log = elf.with_extension("counts");
    let plugin = plugin(&elf)?;
    let mut items = String::new();
    for (name, address) in &functions {
        let _ = write!(items, ",item={name}@{address}");
    }
    let said = output(
        program("qemu-system-arm")
            .args(["-cpu", "cortex-m4", "-machine", "mps2-an386", "-nographic"])
            .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
            .arg(&elf)
            .args(["-d", "plugin", "-D"])
            .arg(&log)
            .arg("-plugin")
            .arg(format!("{}{items}", plugin.display())),
    )?;
    let counted = fs::read_to_string(&log).context("the plugin wrote no log")?;
    check_paths(&said)?;
    let empty = flash("none")?;
    let mut costs: BTreeMap<String, Cost> = BTreeMap::new();
    let mut limited = Vec::new();
    for (name, (min, mean, max)) in parse_counts(&counted)? {
        if name == NOTHING.0 {
            ensure!((min, max) == (NOTHING.1, NOTHING.1), "an empty function counts {min}..{max}");
            continue;
        }
        if let Some(plant) = name.strip_prefix(LIMITED) {
            // Another name of a plant: the branch to it is no part of it.
            limited.push((name.clone(), format!("plant_{plant}"), (min - 1, mean - 1.0, max - 1)));
            continue;
        }
        let (state, stack) = parse_item(&said, &name).with_context(|| missing(&name))?;
        let flash = flash(&format!("{PREFIX}{name}"))? - empty;
        costs.insert(name, Cost { min, mean, max, flash, state, stack });
    }
    for (name, plant, (min, mean, max)) in limited {
        let same = *costs.get(&plant).with_context(|| missing(&plant))?;
        costs.insert(name, Cost { min, mean, max, ..same });
    }
    Ok(costs)
}

/// Each plant went through everything that UDDS does not come to, and stack that is used is seen.
fn check_paths(said: &str) -> Result<()> {
    let mut plants = 0;
    for line in said.lines().filter_map(|line| line.strip_prefix("came ")) {
        plants += 1;
        let starving = line.starts_with(STARVING.0).then_some(STARVING.1);
        for path in PATHS.iter().copied().chain(starving) {
            let came = line.split(' ').any(|word| word == format!("{path}=true"));
            ensure!(came, "the worst case did not come to `{path}`: {line}");
        }
    }
    ensure!(plants == 4, "{plants} plants went through the worst case");
    let (_, deep) = parse_item(said, DEEP.0).with_context(|| missing(DEEP.0))?;
    ensure!(deep >= DEEP.1, "a function that uses {} bytes of stack shows {deep}", DEEP.1);
    Ok(())
}

/// Compiles the plugin beside the image.
fn plugin(elf: &Path) -> Result<PathBuf> {
    let plugin = elf.with_file_name("count.so");
    run(program("cc")
        .args(["-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "-o"])
        .arg(&plugin)
        .arg("xtask/qemu/count.c"))?;
    Ok(plugin)
}

/// The counted functions in the output of nm, with their addresses.
fn functions(nm: &str) -> Vec<(&str, String)> {
    nm.lines()
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            let (address, _, symbol) = (words.next()?, words.next()?, words.next()?);
            Some((symbol.strip_prefix(PREFIX)?, format!("0x{address}")))
        })
        .collect()
}

/// Minimum, mean and maximum of each item, from the plugin's log.
pub fn parse_counts(log: &str) -> Result<Vec<(String, Counted)>> {
    log.lines()
        .filter_map(|line| line.strip_prefix("count "))
        .map(|line| {
            let words: Vec<_> = line.split(' ').collect();
            let [name, figures @ ..] = &words[..] else { bail!("cannot read `{line}`") };
            let figures: Vec<u64> =
                figures.iter().map(|word| word.parse()).collect::<Result<_, _>>()?;
            let [calls, sum, min, max, _at] = figures[..] else { bail!("cannot read `{line}`") };
            ensure!(calls > 0, "`{name}` was never called, or is one function with another item");
            #[expect(clippy::cast_precision_loss, reason = "sums stay below 2^53")]
            let mean = sum as f64 / calls as f64;
            // As many places as the table shows, so that baseline and table agree.
            Ok((String::from(*name), (min, (mean * 10.0).round() / 10.0, max)))
        })
        .collect()
}

/// Bytes of state and stack of an item, from what the image says.
fn parse_item(said: &str, name: &str) -> Option<(u64, u64)> {
    let line = said.lines().find_map(|line| line.strip_prefix(&format!("item {name} ")))?;
    let (state, stack) = line.split_once(' ')?;
    Some((state.parse().ok()?, stack.trim().parse().ok()?))
}

/// Bytes of flash of an image with one item in it.
fn flash(item: &str) -> Result<u64> {
    firmware::build(&["-p", "voltstep-bench", "--bin", "flash"], &[("VOLTSTEP_ITEM", item)])?;
    let sizes = output(program("arm-none-eabi-size").arg("-A").arg(firmware::binary("flash")?))?;
    section_bytes(&sizes, &[".text", ".rodata", ".data"])
}

/// The sum of some sections in the output of `size -A`.
pub fn section_bytes(sizes: &str, sections: &[&str]) -> Result<u64> {
    let mut sum = 0;
    for line in sizes.lines() {
        let mut words = line.split_whitespace();
        if let (Some(section), Some(bytes)) = (words.next(), words.next())
            && sections.contains(&section)
        {
            sum += bytes.parse::<u64>().with_context(|| format!("cannot read `{line}`"))?;
        }
    }
    ensure!(sum > 0, "the image is empty");
    Ok(sum)
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
    fn logs_are_read() {
        let counts = parse_counts("count battery 4 402 100 101 2\nrun 40 7\n").unwrap();
        assert_eq!(counts, [(String::from("battery"), (100, 100.5, 101))]);
        assert!(parse_counts("count battery 0 0 0 0 0").is_err(), "never called");
        assert!(parse_counts("count battery 4").is_err());
        assert_eq!(parse_item("item battery 16 8\n", "battery"), Some((16, 8)));
        assert_eq!(parse_item("item battery2 16 8\n", "battery"), None);
        let nm = "00004711 T bench_battery\n00000400 t other\n         U hole\n";
        assert_eq!(functions(nm), [("battery", String::from("0x00004711"))]);
        let sizes = ".text   100  1024\n.rodata 20 0\n.debug 9999 0\n.data 4 0\nTotal 1\n";
        assert_eq!(section_bytes(sizes, &[".text", ".rodata", ".data"]).unwrap(), 124);
        assert!(section_bytes("", &[".text"]).is_err());
    }

    #[test]
    fn the_worst_case_has_to_be_one() {
        let path = "discharge=true charge=true starved=true refused=true standstill=true";
        let said = |path: &str, deep: u32| {
            let plants = ["pid_off", "pid_on", "torque_off", "torque_on"];
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
    fn item_names_are_unique() {
        for (i, (name, _)) in ITEMS.iter().enumerate() {
            assert!(ITEMS[..i].iter().all(|other| other.0 != *name), "{name}");
        }
    }
}
