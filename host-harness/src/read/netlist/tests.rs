use super::*;
use crate::simulate::circuit::run;

const BUCK: &str = include_str!("../../../data/circuits/buck.toml");
const STAR_DELTA: &str = include_str!("../../../data/circuits/star-delta.toml");
const RECTIFIER: &str = include_str!("../../../data/circuits/rectifier.toml");

fn read(text: &str) -> Netlist {
    parse("x.toml", text.as_bytes()).unwrap()
}

#[test]
fn a_buck_converter_from_a_file_gives_what_its_duty_says() {
    let netlist = read(BUCK);
    let named: Vec<_> = netlist.nodes.iter().map(String::as_str).collect();
    assert_eq!(named, ["ground", "in", "out", "second_load", "middle"]);
    let outcome = run(&netlist).unwrap();
    assert_eq!((outcome.unsettled_steps, outcome.time_s.len()), (0, 10_000));
    assert!(outcome.balance_rel < 1e-4, "{}", outcome.balance_rel);
    // 38 µs on, and the diode in the dead time: 0.38 of 400 V behind 0.11 Ω, then with half the load.
    let filter = netlist.parts.iter().position(|p| p.name == "filter").unwrap();
    let mean = |from_s: f64, to_s: f64| {
        let rows = outcome.time_s.iter().zip(&outcome.voltage_v[filter]);
        let (mut sum, mut count) = (0.0, 0.0);
        for (_, v) in rows.filter(|(t, _)| (from_s..to_s).contains(*t)) {
            sum += v;
            count += 1.0;
        }
        sum / count
    };
    for (from_s, ohm) in [(0.009, 5.0), (0.019, 10.0)] {
        let expected = (0.38 * 400.0 - 0.04 * 0.8) * ohm / (ohm + 0.11);
        let found = mean(from_s, from_s + 0.001);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}

#[test]
fn a_star_and_a_delta_of_thrice_its_impedance_take_the_same_current() {
    let outcome = run(&read(STAR_DELTA)).unwrap();
    assert_eq!(outcome.unsettled_steps, 0);
    let peak_a = |name: &str, from_s: f64, to_s: f64| {
        let part = outcome.elements.iter().position(|e| e.name == name).unwrap();
        let rows = outcome.time_s.iter().zip(&outcome.current_a[part]);
        rows.filter(|(t, _)| (from_s..to_s).contains(*t))
            .fold(0.0, |most, (_, a)| a.abs().max(most))
    };
    let line_a = 325.27 / 10.0_f64.hypot(0.02 * std::f64::consts::TAU * 50.0);
    let (star, delta) = ((0.07, 0.1), (0.17, 0.2));
    for (name, (from_s, to_s), expected_a) in [
        ("to_star_a", star, line_a),
        ("star_c", star, line_a),
        ("to_delta_b", delta, line_a),
        ("delta_ca", delta, line_a / 3.0_f64.sqrt()),
    ] {
        let found_a = peak_a(name, from_s, to_s);
        assert!((found_a / expected_a - 1.0).abs() < 1e-3, "{name}: {found_a} {expected_a}");
    }
    // What is switched off takes what its open switches let through.
    assert!(peak_a("to_delta_b", star.0, star.1) < 4e-3);
}

#[test]
fn a_rectifier_from_a_file_charges_and_holds() {
    let outcome = run(&read(RECTIFIER)).unwrap();
    let storage = outcome.elements.iter().find(|e| e.name == "storage").unwrap();
    assert_eq!(outcome.unsettled_steps, 0);
    // Two junctions below the peak.
    assert!((97.0..99.5).contains(&storage.voltage_v.largest), "{storage:?}");
    let last = outcome.voltage_v
        [outcome.elements.iter().position(|e| e.name == "storage").unwrap()]
    .last()
    .unwrap();
    assert!((88.0..98.0).contains(last), "{last}");
}

#[test]
fn sources_and_gates_follow_their_shapes() {
    let text = "name = 'x'\ndescription = 'x'\n[run]\nmethod = 'trapezoidal'\nstep_s = 0.1\n\
        duration_s = 1.0\n[voltage.sine]\nfrom = 'a'\nto = 'ground'\nsine = { offset_v = 1, \
        amplitude_v = 2, frequency_hz = 1, phase_deg = 90 }\n[voltage.step]\nfrom = 'b'\nto = \
        'ground'\nstep = { before_v = 1, after_v = 5, at_s = 0.3 }\n[voltage.square]\nfrom = 'c'\n\
        to = 'ground'\nsquare = { low_v = -1, high_v = 1, period_s = 0.5, on_s = 0.2, delay_s = 0.1 }\n\
        [voltage.table]\nfrom = 'd'\nto = 'ground'\ntable = { time_s = [0.2, 0.4], value_v = [1, 3] }\n\
        [switch.s]\nfrom = 'a'\nto = 'b'\ntoggles_s = [0.2, 0.5]\n";
    let netlist = read(text);
    let at = |name: &str, step: f64| {
        let part = netlist.parts.iter().find(|p| p.name == name).unwrap();
        part.value.at(0.1 * step, 0.1)
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
    close(at("sine", 5.0), 1.0 - 2.0);
    // What jumps at the end of the third step is there from the fourth on.
    assert_eq!([3.0, 4.0].map(|n| at("step", n)), [1.0, 5.0]);
    assert_eq!([1.0, 2.0, 3.0, 4.0, 7.0].map(|n| at("square", n)), [-1.0, 1.0, 1.0, -1.0, 1.0]);
    close(at("table", 1.0), 1.0);
    close(at("table", 3.0), 2.0);
    close(at("table", 9.0), 3.0);
    let gate = &netlist.parts.last().unwrap().gate;
    let on = [2.0, 3.0, 5.0, 6.0].map(|n| gate.is_on(0.1 * n, 0.1));
    assert_eq!(on, [false, true, true, false]);
}

#[test]
fn says_where_a_file_is_wrong() {
    for (from, to, line_of, message) in [
        ("ohm = 0.1", "ohm = -0.1", "ohm = -0.1", "`ohm` in [coil.choke] must"),
        ("henry", "henri", "henri", "did you mean `henry`?"),
        ("[coil.choke]", "[choke.coil]", "[choke.coil]", "unknown table [choke]"),
        ("dc_v = 400.0", "dc_a = 400.0", "dc_a", "unknown key `dc_a` in [voltage.supply]"),
        (
            "dc_v = 400.0\n",
            "",
            "[voltage.supply]",
            "must have one of `dc_v`, `sine`, `step`, `square`, `table`",
        ),
        (
            "on_s = 3.8e-5",
            "on_s = 3.8",
            "pulse = { period_s = 1e-4, on_s = 3.8,",
            "must lie in 0..period_s",
        ),
        ("[0.0, 0.01]", "[0.1, 0.01]", "toggles_s", "must be times that rise"),
        (
            "to = \"out\"\nhenry",
            "to = \"middle\"\nhenry",
            "henry = 1e-3",
            "must not be the node of `from`",
        ),
        (
            "[coil.choke]",
            "[voltage.again]\nfrom = \"in\"\nto = \"ground\"\ndc_v = 1.0\n\n[coil.choke]",
            "[voltage.again]",
            "`voltage.again` closes a loop of voltage sources",
        ),
        (
            "[coil.choke]",
            "[current.lost]\nfrom = \"in\"\nto = \"nowhere\"\ndc_a = 1.0\n\n[coil.choke]",
            "to = \"nowhere\"",
            "node `nowhere` is tied to the others by nothing but sources of current",
        ),
        ("second_load]", "load]", "[resistor.load]", "duplicate key"),
        ("[switch.second]", "[switch.load]", "[switch.load]", "has the name of an element before"),
        ("duration_s = 0.02", "duration_s = 20.0", "duration_s", "must be 1 to 10 million steps"),
        ("row_s = 2e-6", "row_s = 1e-7", "row_s", "must be one step to the whole run"),
        ("\"choke\"]", "\"joke\"]", "currents", "names no element of the circuit"),
        ("step_s = 1e-6", "step_s = 0.0", "step_s", "must be finite"),
    ] {
        assert!(BUCK.contains(from), "{from}");
        let text = BUCK.replace(from, to);
        let error = parse("x.toml", text.as_bytes()).unwrap_err();
        assert!(error.message.contains(message), "{error}");
        let lines = text.lines().enumerate().filter(|(_, l)| l.contains(line_of));
        let found: Vec<u64> = lines.map(|(n, _)| n as u64 + 1).collect();
        let at = error.line.unwrap();
        assert!(found.contains(&at) || found.contains(&(at + 1)), "{error}, not {found:?}");
        assert!(error.column.is_some());
    }
}

#[test]
fn counts_what_a_circuit_may_have() {
    let head = BUCK.split("[plot]").next().unwrap();
    let many = |kind: &str, count: usize, rest: &str| {
        let mut text = head.to_owned();
        for n in 0..count {
            text += &format!("[{kind}.n{n}]\nfrom = 'a{}'\nto = 'ground'\n{rest}\n", n % 15);
        }
        parse("x.toml", text.as_bytes()).map_err(|e| e.message)
    };
    assert!(many("resistor", 32, "ohm = 1").is_ok());
    assert!(many("resistor", 33, "ohm = 1").unwrap_err().contains("at most 32 elements"));
    assert!(many("switch", 16, "").is_ok());
    assert!(many("switch", 17, "").unwrap_err().contains("at most 16 switches"));
    assert!(many("switch", 0, "").unwrap_err().contains("has no element"));
    let mut long = head.to_owned();
    for n in 0..16 {
        long += &format!("[resistor.n{n}]\nfrom = 'b{n}'\nto = 'ground'\nohm = 1\n");
    }
    let error = parse("x.toml", long.as_bytes()).unwrap_err();
    assert!(error.message.contains("makes 17 nodes"), "{error}");
}
