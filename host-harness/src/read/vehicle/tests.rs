use plant_core::battery::OpenCircuit;
use plant_core::presets;

use super::*;

mod built_in;

/// A sound file; tests change one line of it.
const EXAMPLE: &str = r#"name = "cart"
description = "a cart"
source = "made up"
initial_soc = 0.5

[battery]
capacity_ah = 10
series_resistance_ohm = 0.1
discharge_limit_a = 100.0
charge_limit_a = inf

[battery.open_circuit.linear]
empty_v = 40.0
full_v = 50.0

[battery.polarisation]
resistance_ohm = 0.01
capacitance_f = 1_000.0

[motor]
resistance_ohm = 0.1
inductance_h = 1e-4
back_emf_v_s_per_rad = 0.1
torque_nm_per_a = 0.1
inertia_kg_m2 = 1e-3
viscous_nm_s_per_rad = 0
coulomb_nm = 0

[gearbox]
ratio = 5.0
efficiency = 0.95
inertia_kg_m2 = 0.0

[wheel]
radius_m = 0.2
inertia_kg_m2 = 0.0
viscous_nm_s_per_rad = 0.0

[body]
mass_kg = 200.0

[body.resistance.coast-down]
a_n = 20.0
b_n_s_per_m = 0.5
c_n_s2_per_m2 = 0.3

[driver.duty]
proportional = 0.5
output_min = -1.0
output_max = 1.0
anti_windup = "freeze"
"#;

/// What is said about the example with `from` replaced by `to`.
fn said(from: &str, to: &str) -> String {
    assert_eq!(EXAMPLE.matches(from).count(), 1, "{from}");
    parse("x.toml", EXAMPLE.replace(from, to).as_bytes()).unwrap_err().to_string()
}

#[track_caller]
fn says(from: &str, to: &str, expected: &str) {
    assert_eq!(said(from, to), format!("x.toml:{expected}"));
}

/// The battery of a vehicle that has it inline.
#[track_caller]
fn constant(vehicle: &Vehicle) -> BatteryParams {
    let VehicleBattery::Constant(battery) = vehicle.powertrain.battery else { panic!("mapped") };
    battery
}

#[test]
fn reads_the_example_and_fills_in_what_may_be_left_out() {
    let cart = parse("x.toml", EXAMPLE.as_bytes()).unwrap();
    assert_eq!(cart.powertrain.auxiliary, AuxiliaryParams::NONE);
    assert_eq!(cart.powertrain.drives.one_dc().unwrap().converter, ConverterParams::IDEAL);
    assert_eq!(constant(&cart).polarisation.capacitance_f.to_bits(), 1000_f32.to_bits());
    let windows = EXAMPLE.replace('\n', "\r\n");
    assert_eq!(parse("x.toml", format!("\u{feff}{windows}").as_bytes()).unwrap(), cart);
}

#[test]
fn reads_a_table_of_the_open_circuit_voltage() {
    let linear = "[battery.open_circuit.linear]\nempty_v = 40.0\nfull_v = 50.0\n";
    let with = |points: &str| {
        EXAMPLE.replace(linear, &format!("[battery.open_circuit]\ntable = {points}\n"))
    };
    let vehicle = parse("x.toml", with("[[0, 40], [0.5, 48.0], [1, 50]]").as_bytes()).unwrap();
    let OpenCircuit::Table(table) = constant(&vehicle).open_circuit else { panic!() };
    assert!((table.at(0.5) - 48.0).abs() < 1e-6);
    for (points, expected) in [
        (
            "[[0, 40], [1, \"full\"]]",
            "13:23: `table[1][1]` in [battery.open_circuit]: expected a number, found the text \"full\"",
        ),
        (
            "[[0, 40], [0, 50]]",
            "13:9: `table` in [battery.open_circuit] must have two \
             entries at least, each finite and above the one before",
        ),
        (
            "[[0, 50], [1, 40]]",
            "13:1: `table` in [battery.open_circuit] must not decrease from one entry to the next, \
             found [[0, 50], [1, 40]]",
        ),
        (
            "3",
            "13:9: `table` in [battery.open_circuit]: expected a list of 2 to 257 pairs \
             [state of charge, value], found a number",
        ),
    ] {
        let error = parse("x.toml", with(points).as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), format!("x.toml:{expected}"));
    }
}

#[test]
fn a_named_battery_is_built_in_or_a_file_beside_the_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let (start, end) = (EXAMPLE.find("[battery]").unwrap(), EXAMPLE.find("[motor]").unwrap());
    let vehicle = |battery: &str| {
        let path = folder.path().join("cart.toml");
        let text = format!("{}battery = {battery}\n{}", &EXAMPLE[..start], &EXAMPLE[end..]);
        std::fs::write(&path, text).unwrap();
        load(&path.to_string_lossy())
    };
    let named = vehicle("\"panasonic-ncr18650pf\"").unwrap();
    assert_eq!(named.powertrain.battery, VehicleBattery::Mapped(presets::PANASONIC_NCR18650PF));
    let own = include_str!("../../../data/batteries/panasonic-ncr18650pf.toml");
    std::fs::write(folder.path().join("own.toml"), own).unwrap();
    assert_eq!(vehicle("\"own.toml\"").unwrap(), named);
    for (battery, expected) in [
        (
            "\"panasonic\"",
            "cart.toml:6:1: `battery` cannot be used, found \"panasonic\": panasonic: no such battery",
        ),
        ("\"nowhere.toml\"", "nowhere.toml: cannot read"),
        (
            "3",
            "cart.toml:6:11: `battery`: expected the name of a battery, a .toml file or a table, found a number",
        ),
        ("{}", "cart.toml:6:1: missing key `open_circuit` in [battery]"),
    ] {
        let error = vehicle(battery).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn an_unknown_key() {
    says("mass_kg", "masss_kg", "40:1: unknown key `masss_kg` in [body]; did you mean `mass_kg`?");
    says(
        "name =",
        "  title =",
        "1:3: unknown key `title`; expected one of `name`, `description`, `source`, \
         `initial_soc`, `battery`, `auxiliary`, `converter`, `motor`, `pmsm`, `gearbox`, \
         `thermal`, `drive`, `wheel`, `body`, `driver`, `trips`, `fit`, `standard_error`",
    );
    says(
        "a_n =",
        "drag_coefficient =",
        "43:1: unknown key `drag_coefficient` in [body.resistance.coast-down]; expected one of \
         `a_n`, `b_n_s_per_m`, `c_n_s2_per_m2`",
    );
}

#[test]
fn a_misspelt_table() {
    says("[body]", "[boddy]", "39:2: unknown table [boddy]; did you mean [body]?");
    says(
        "[driver.duty]",
        "[driver.dutty]",
        "47:9: unknown table [driver.dutty]; did you mean [driver.duty]?",
    );
    says(
        "[battery.open_circuit.linear]",
        "[battery.open_circuit.liner]",
        "12:23: unknown table [battery.open_circuit.liner]; did you mean [battery.open_circuit.linear]?",
    );
}

#[test]
fn a_missing_key_or_table() {
    says("mass_kg = 200.0\n", "", "39:2: missing key `mass_kg` in [body]");
    says("full_v = 50.0\n", "", "12:23: missing key `full_v` in [battery.open_circuit.linear]");
    says("name = \"cart\"\n", "", "1:1: missing key `name`");
    let without = "[gearbox]\nratio = 5.0\nefficiency = 0.95\ninertia_kg_m2 = 0.0\n";
    says(without, "", "1:1: `gearbox` is missing, and there is no table [[drive]]");
}

#[test]
fn one_variant_and_no_more() {
    says(
        "[driver.duty]",
        "[driver.torque]\n[driver.duty]",
        "48:9: only one of `duty`, `torque` may stand in [driver]",
    );
    says(
        "[body.resistance.coast-down]",
        "[body.resistance]",
        "43:1: unknown key `a_n` in [body.resistance]; expected one of `physical`, `coast-down`",
    );
    says(
        "mass_kg = 200.0\n\n[body.resistance.coast-down]",
        "mass_kg = 200.0\nresistance = {}\n[other]",
        "41:1: `resistance` in [body]: expected one of `physical`, `coast-down`, found an empty table",
    );
    says(
        "\"freeze\"",
        "\"freez\"",
        "51:15: unknown value `freez` of `anti_windup` in [driver.duty]; did you mean `freeze`?",
    );
    says(
        "\"freeze\"",
        "1",
        "51:15: `anti_windup` in [driver.duty]: expected one of `freeze`, `directional`, found a \
         number",
    );
}

#[test]
fn values_that_break_a_rule() {
    let positive = "must be finite and between 1e-12 and 1e12, found";
    says(
        "mass_kg = 200.0",
        "mass_kg = -200.0",
        &format!("40:1: `mass_kg` in [body] {positive} -200.0"),
    );
    says("mass_kg = 200.0", "mass_kg = nan", &format!("40:1: `mass_kg` in [body] {positive} nan"));
    says("mass_kg = 200.0", "mass_kg = 0x0", &format!("40:1: `mass_kg` in [body] {positive} 0x0"));
    says(
        "a_n = 20.0",
        "a_n = -1",
        "43:1: `a_n` in [body.resistance.coast-down] must be finite, zero or above, and at most \
         1e12, found -1",
    );
    says(
        "output_max = 1.0",
        "output_max = -2.0",
        "50:1: `output_max` in [driver.duty] must lie above the field that limits it from below, \
         found -2.0",
    );
    says(
        "full_v = 50.0",
        "full_v = 30.0",
        "14:1: `full_v` in [battery.open_circuit.linear] must not decrease from one entry to the \
         next, found 30.0",
    );
    for soc in ["1.01", "-0.1", "nan"] {
        says(
            "initial_soc = 0.5",
            &format!("initial_soc = {soc}"),
            &format!("4:1: `initial_soc` must lie in 0..1, found {soc}"),
        );
    }
}

/// Keys whose values are no numbers.
const TEXTS: [&str; 7] =
    ["name", "description", "source", "battery", "derivative_of", "anti_windup", "pole_pairs"];

#[test]
fn every_field_that_the_models_check_has_its_place() {
    let numbers = |text: &str| {
        let mut table = String::new();
        let mut found = Vec::new();
        for (i, line) in text.lines().enumerate() {
            if let Some(name) = line.strip_prefix('[') {
                name.trim_start_matches('[').split(']').next().unwrap_or("").clone_into(&mut table);
            } else if let Some((key, _)) = line.split_once(" = ")
                && !line.starts_with('#')
                && !TEXTS.contains(&key)
                // How it was found is for the reader.
                && table != "fit"
                && table != "standard_error"
                // A list of pairs: `conditions` looks at it.
                && key != "rolling_factor"
            {
                found.push((i, table.clone(), key.to_owned()));
            }
        }
        found
    };
    for (name, text) in BUILT_IN.files {
        let found = numbers(text);
        assert!(found.len() > 30, "{name}");
        for (i, table, key) in found {
            let line = format!("{key} = nan");
            let lines: Vec<_> =
                text.lines().enumerate().map(|(n, l)| if n == i { &line } else { l }).collect();
            let error = parse("x", lines.join("\n").as_bytes()).unwrap_err();
            let subject = if table.is_empty() {
                format!("`{key}` ")
            } else {
                format!("`{key}` in [{table}] ")
            };
            assert_eq!((error.line, error.column), (Some(i as u64 + 1), Some(1)), "{error}");
            assert!(error.message.starts_with(&subject), "{error}");
            assert!(error.message.ends_with("found nan"), "{error}");
        }
    }
}

#[test]
fn values_of_the_wrong_type() {
    let mass =
        |found: &str| format!("40:11: `mass_kg` in [body]: expected a number, found {found}");
    says("mass_kg = 200.0", "mass_kg = \"heavy\"", &mass("the text \"heavy\""));
    says("mass_kg = 200.0", "mass_kg = true", &mass("`true`"));
    says("mass_kg = 200.0", "mass_kg = [1]", &mass("a list"));
    says("mass_kg = 200.0", "mass_kg = 2020-01-01", &mass("a date"));
    says(
        "mass_kg = 200.0",
        "mass_kg.x = 1",
        "40:1: `mass_kg` in [body]: expected a number, found a table",
    );
    says("\"a cart\"", "3", "2:15: `description`: expected a text, found a number");
    says(
        "mass_kg = 200.0",
        "mass_kg = 1e99",
        "40:11: `mass_kg` in [body]: the number is too large (inf for no limit)",
    );
    says(
        "[driver.duty]",
        "[[driver.duty]]",
        "47:1: `duty` in [driver]: expected a table, found a list",
    );
    says(
        "[body.resistance.coast-down]",
        "resistance.coast-down = [1, 2, 3]\n[x]",
        "42:25: `coast-down` in [body.resistance]: expected a table, found a list",
    );
    says("name =", "battery = 3\nname =", "7:2: duplicate key");
    let body = "[body]\nmass_kg = 200.0\n\n[body.resistance.coast-down]";
    says(
        body,
        "[x]",
        "39:2: unknown table [x]; expected one of `name`, `description`, `source`, \
         `initial_soc`, `battery`, `auxiliary`, `converter`, `motor`, `pmsm`, `gearbox`, \
         `thermal`, `drive`, `wheel`, `body`, `driver`, `trips`, `fit`, `standard_error`",
    );
}

#[test]
fn syntax_errors() {
    says(
        "mass_kg = 200.0",
        "mass_kg = heavy",
        "40:11: string values must be quoted, expected literal string",
    );
    let place = |from, to| {
        let said = said(from, to);
        said.split(' ').next().unwrap().to_owned()
    };
    assert_eq!(place("mass_kg = 200.0", "mass_kg = "), "x.toml:40:11:");
    assert_eq!(place("mass_kg = 200.0", "mass_kg 200.0"), "x.toml:40:9:");
    assert_eq!(place("mass_kg = 200.0", "mass_kg = 1\nmass_kg = 2"), "x.toml:41:1:");
    assert_eq!(place("\"cart\"", "\"cart"), "x.toml:1:13:");
    let error = parse("x.toml", b"name = \"a\"\nb = \"\xFF\"").unwrap_err();
    assert_eq!(error.to_string(), "x.toml:2:6: not a text: expected UTF-8");
    assert_eq!(parse("x.toml", b"").unwrap_err().to_string(), "x.toml:1:1: missing key `name`");
}

#[test]
fn a_name_that_is_not_known() {
    let list = "(built in: `bmw-i3-60ah`, `bmw-i3-60ah-constant`, `bmw-i3-60ah-epowertrain`, \
                `bmw-i3-60ah-pmsm`, `bmw-i3-60ah-thermal`, `epowertrain-udds`, `epowertrain-udds-table`, `two-axles`; or the path of a .toml file)";
    let error = load("bmw-i3-60").unwrap_err().to_string();
    assert_eq!(error, format!("bmw-i3-60: no such vehicle; did you mean `bmw-i3-60ah`? {list}"));
    assert_eq!(load("tank").unwrap_err().to_string(), format!("tank: no such vehicle {list}"));
    let battery = concat!(env!("CARGO_MANIFEST_DIR"), "/data/batteries/bmw-i3-60ah.toml");
    let error = load(battery).unwrap_err();
    assert!(error.message.starts_with("this is a battery; expected a vehicle"), "{error}");
    let error = load("nowhere.toml").unwrap_err().to_string();
    assert!(error.starts_with("nowhere.toml: cannot read: "), "{error}");
    assert!(load("nowhere/").unwrap_err().message.starts_with("cannot read: "));
}

#[test]
fn no_damage_makes_it_panic() {
    let bytes = EXAMPLE.as_bytes();
    for i in 0..bytes.len() {
        let _ = parse("x", &bytes[..i]);
        for byte in [0, b'\n', b'"', b'[', b'.', b'=', b'{', b'9', 0xC3, 0xFF] {
            let mut damaged = bytes.to_vec();
            damaged[i] = byte;
            let _ = parse("x", &damaged);
        }
    }
    for deep in ["[", "{a=", "a."] {
        let text = format!("name = {}", deep.repeat(100_000));
        assert!(parse("x", text.as_bytes()).is_err());
        assert!(parse("x", deep.repeat(100_000).as_bytes()).is_err());
    }
}

/// Drives in a list: the same as one at the top, four at most, each with one machine.
#[test]
fn several_drives() {
    let one = "[motor]\nresistance_ohm = 0.1\ninductance_h = 1e-4\nback_emf_v_s_per_rad = 0.1\ntorque_nm_per_a = 0.1\ninertia_kg_m2 = 1e-3\nviscous_nm_s_per_rad = 0\ncoulomb_nm = 0\n\n[gearbox]\nratio = 5.0\nefficiency = 0.95\ninertia_kg_m2 = 0.0\n";
    let listed = format!(
        "[[drive]]\n{}",
        one.replace("[motor]", "[drive.motor]").replace("[gearbox]", "[drive.gearbox]")
    );
    let with = |drives: &str| parse("x.toml", EXAMPLE.replace(one, drives).as_bytes());
    assert_eq!(with(&listed).unwrap().powertrain, with(one).unwrap().powertrain);
    let refused = |drives: &str| with(drives).unwrap_err().to_string();
    // A duty drives one machine.
    let two = listed.repeat(2);
    assert!(refused(&two).contains("`driver.duty` must drive one DC machine"), "{}", refused(&two));
    assert!(refused(&listed.repeat(5)).contains("`drive` may stand 4 times at most"));
    let pmsm = "[pmsm]\npole_pairs = 6.5\n";
    let whole = refused(&format!("{pmsm}{}", &one[one.find("[gearbox]").unwrap()..]));
    assert!(whole.contains("expected a whole number up to 65535, found 6.5"), "{whole}");
    let bad = format!("{listed}{}", listed.replace("ratio = 5.0", "ratio = 0.0"));
    let said = refused(&bad);
    assert!(said.contains("`ratio` in [drive.gearbox]"), "{said}");
    assert!(said.starts_with("x.toml:45:1"), "{said}");
    assert!(
        refused(&format!("{one}{listed}")).contains("belongs into each of the tables [[drive]]")
    );
    assert!(
        refused("[gearbox]\nratio = 5.0\nefficiency = 0.95\ninertia_kg_m2 = 0.0\n")
            .contains("`motor` is missing, and there is no `pmsm`")
    );
}

/// A drive that heats up, at the top and in a list, and what is wrong with its temperatures.
#[test]
fn temperatures_of_a_drive() {
    let (_, text) = BUILT_IN.files.iter().find(|f| f.0 == "bmw-i3-60ah-thermal").unwrap();
    let one = parse("x.toml", text.as_bytes()).unwrap().powertrain;
    let start = text.find("[converter]").unwrap();
    let end = text.find("[wheel]").unwrap();
    let mut listed = text[start..end].to_owned();
    for table in ["converter", "motor", "gearbox", "thermal", "thermal.machine"] {
        listed = listed.replace(&format!("\n[{table}]"), &format!("\n[drive.{table}]"));
    }
    listed = listed.replace("[converter]", "[drive.converter]");
    listed = listed.replace("[thermal.inverter]", "[drive.thermal.inverter]");
    listed = listed.replace("[thermal.winding]", "[drive.thermal.winding]");
    let listed = format!("{}[[drive]]\n{listed}{}", &text[..start], &text[end..]);
    assert_eq!(parse("x.toml", listed.as_bytes()).unwrap().powertrain, one);
    for (text, table) in [(*text, "thermal"), (listed.as_str(), "drive.thermal")] {
        for (from, to, key, rule) in [
            (
                "derate_to_c = 180.0",
                "derate_to_c = 139.0",
                "derate_to_c",
                "must lie above the field",
            ),
            (
                "coolant_k_per_w = 0.08",
                "coolant_k_per_w = 0",
                "coolant_k_per_w",
                "must be at least",
            ),
        ] {
            let line = 1 + text.lines().position(|l| l.starts_with(from)).unwrap();
            let error = parse("x.toml", text.replace(from, to).as_bytes()).unwrap_err().to_string();
            let said = format!("x.toml:{line}:1: `{key}` in [{table}.machine] {rule}");
            assert!(error.starts_with(&said), "{error}");
        }
    }
    let unknown = text.replace("derate_to_c = 180.0", "derate_to = 180.0");
    let error = parse("x.toml", unknown.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("unknown key `derate_to` in [thermal.machine]"), "{error}");
    let without = text.replace("[thermal.winding]", "[thermal.winding]\n[fit]");
    let error = parse("x.toml", without.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("missing key `reference_c`"), "{error}");
}

/// A flux map in a file: that of constant inductances is read as such; what is wrong in it has a
/// place.
#[test]
fn a_flux_map() {
    let (_, text) = BUILT_IN.files.iter().find(|f| f.0 == "bmw-i3-60ah-pmsm").unwrap();
    let rows: Vec<_> = (0..5_i8)
        .flat_map(|d| (0..7_i8).map(move |q| (f32::from(d - 4) * 200.0, f32::from(q - 3) * 250.0)))
        .map(|(d, q)| format!("  [{:?}, {:?}],\n", 0.04 + 1e-4 * d, 2e-4 * q))
        .collect();
    let map = format!(
        "[pmsm.flux.map]\nd = {{ start_a = -800.0, step_a = 200.0, points = 5 }}\n\
         q = {{ start_a = -750.0, step_a = 250.0, points = 7 }}\nflux_wb = [\n{}]\n\n",
        rows.concat()
    );
    let (start, end) = (text.find("[pmsm.flux.linear]").unwrap(), text.find("[gearbox]").unwrap());
    let mapped = format!("{}{map}{}", &text[..start], &text[end..]);
    let read = |text: &str| parse("x.toml", text.as_bytes());
    let vehicle = read(&mapped).unwrap();
    let [Some(DriveKind::Pmsm(drive)), None, ..] = vehicle.powertrain.drives.as_slice() else {
        panic!("{:?}", vehicle.powertrain.drives)
    };
    let at = drive.motor.flux.at(plant_core::machine::transform::Dq { d: -130.0, q: 310.0 });
    assert!((at.flux_wb.d - 0.027).abs() < 1e-6 && (at.flux_wb.q - 0.062).abs() < 1e-6, "{at:?}");
    // Read again it is the same table, kept once.
    assert_eq!(read(&mapped).unwrap(), vehicle);
    let line = |key: &str| 1 + mapped.lines().position(|l| l.starts_with(key)).unwrap();
    let refused = |from: &str, to: &str| {
        assert!(mapped.contains(from), "{from}");
        read(&mapped.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let (d, flux) = (line("d = "), line("flux_wb"));
    for (from, to, said) in [
        (
            "points = 5",
            "points = 4",
            format!("x.toml:{flux}:1: `flux_wb` in [pmsm.flux.map] must have as many entries"),
        ),
        (
            "points = 5",
            "points = 3",
            format!("x.toml:{d}:41: `points` in [pmsm.flux.map.d] must lie in the range"),
        ),
        ("step_a = 200.0", "step_a = 0.0", format!("x.toml:{d}:25: `step_a` in [pmsm.flux.map.d]")),
        (
            "[0.04, 0.0]",
            "[-0.9, 0.0]",
            format!("x.toml:{flux}:1: `flux_wb` in [pmsm.flux.map] must not decrease"),
        ),
        ("[0.04, 0.0]", "[0.04]", String::from("invalid length 1")),
    ] {
        let error = refused(from, to);
        assert!(error.contains(&said), "{error}\n{said}");
    }
}
