//! Circuits against ngspice: the same devices, edges on the grid. Skipped where it is not installed.

use std::f64::consts::TAU;
use std::path::Path;
use std::process::{Command, Stdio};

use plant_core::circuit::{Branch, Circuit, CircuitInput, CircuitState, Element, Method, h_bridge};
use plant_core::{Dt, Real};

/// What ngspice prints for a netlist of `ngspice/`: time, then one value or two.
fn reference(name: &str) -> Option<Vec<Vec<f64>>> {
    let netlist = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/ngspice/{name}.cir"));
    let folder = tempfile::tempdir().unwrap();
    let run = Command::new("ngspice")
        .arg("-b")
        .arg(netlist)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if run.is_err() {
        println!("SKIPPED: ngspice is not installed (Debian's package `ngspice`)");
        return None;
    }
    let text = std::fs::read_to_string(folder.path().join(name)).expect("ngspice writes its data");
    // Each value has its time before it.
    let row = |line: &str| -> Vec<f64> {
        let numbers: Vec<f64> = line.split_whitespace().map(|n| n.parse().unwrap()).collect();
        numbers.iter().enumerate().filter(|(i, _)| *i == 0 || i % 2 == 1).map(|(_, n)| *n).collect()
    };
    Some(text.lines().map(row).collect())
}

/// RMS of the difference over the RMS of the reference, over rows from `from` on.
fn difference(ours: &[f64], theirs: impl Iterator<Item = f64>) -> f64 {
    let (mut apart, mut all) = (0.0, 0.0);
    for (ours, theirs) in ours.iter().zip(theirs) {
        apart += (ours - theirs).powi(2);
        all += theirs.powi(2);
    }
    (apart / all).sqrt()
}

#[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
fn narrow(x: f64) -> Real {
    x as Real
}

/// Runs a circuit from rest; `input` gives values and gates at the end of a step, `row` what is kept
/// of an output.
fn run<const N: usize, const E: usize>(
    branches: [Branch; E],
    method: Method,
    dt_s: f64,
    steps: usize,
    input: impl Fn(f64) -> ([f64; E], u32),
    element: usize,
    by_current: bool,
) -> Vec<f64> {
    let circuit: Circuit<N, E> =
        Circuit::new(branches, method, Dt::from_s(narrow(dt_s)).unwrap()).unwrap();
    let mut state = CircuitState::default();
    let mut kept = vec![0.0];
    for step in 1..=steps {
        #[expect(clippy::cast_precision_loss, reason = "a few thousand steps")]
        let (values, gates) = input(step as f64 * dt_s);
        let out = circuit.step(&mut state, CircuitInput { values: values.map(narrow), gates });
        assert!(out.settled, "step {step}: {out:?}");
        kept.push(f64::from(if by_current {
            out.current_a[element]
        } else {
            out.voltage_v[element]
        }));
    }
    kept
}

/// A bridge of four junctions of the reference system's diode, 100 V at 50 Hz: 1 mF and 100 Ω.
#[test]
fn a_rectifier() {
    let Some(theirs) = reference("rectifier") else { return };
    let bridge = [
        Branch::new(1, 2, Element::Voltage),
        Branch::new(1, 3, Element::JUNCTION),
        Branch::new(2, 3, Element::JUNCTION),
        Branch::new(0, 1, Element::JUNCTION),
        Branch::new(0, 2, Element::JUNCTION),
        Branch::new(3, 0, Element::Capacitor { farad: 1e-3 }),
        Branch::new(3, 0, Element::Resistor { ohm: 100.0 }),
    ];
    for method in [Method::BackwardEuler, Method::Trapezoidal] {
        // 200 steps in a period of the ripple.
        let input = |t: f64| ([100.0 * (TAU * 50.0 * t).sin(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
        let ours = run::<4, 7>(bridge, method, 5e-5, 1200, input, 5, false);
        let off = difference(&ours, theirs.iter().step_by(5).map(|row| row[1]));
        assert!(off < 0.01, "{method:?}: {off}");
    }
}

/// A complementary pair drives 20 nF; its gate swings from 0 to 10 V within 1 µs every 100 µs.
#[test]
fn an_inverter() {
    let Some(theirs) = reference("inverter") else { return };
    let mos = |p_channel| Element::Mos {
        gate: 2,
        p_channel,
        threshold_v: 3.0,
        gain_a_v2: 5e-4,
        modulation_per_v: 0.01,
    };
    let pair = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(2, 0, Element::Voltage),
        Branch::new(3, 1, mos(true)),
        Branch::new(3, 0, mos(false)),
        Branch::new(3, 0, Element::Capacitor { farad: 2e-8 }),
    ];
    let gate = |t: f64| {
        let within = (t * 1e6) % 200.0;
        10.0 * if within < 101.0 { within.min(1.0) } else { (102.0 - within).max(0.0) }
    };
    let input = |t: f64| ([10.0, gate(t), 0.0, 0.0, 0.0], 0);
    // 200 steps in a period, in which it falls within 16.
    let ours = run::<4, 5>(pair, Method::Trapezoidal, 1e-6, 400, input, 4, false);
    let off = difference(&ours, theirs.iter().step_by(10).map(|row| row[1]));
    assert!(off < 0.01, "{off}");
}

/// 400 V, a leg at 10 kHz, 1 mH, 100 µF, 5 Ω: voltage of the capacitor and current of the coil.
#[test]
fn a_buck_converter() {
    let Some(theirs) = reference("buck") else { return };
    let switch = Element::Switch { on_ohm: 0.01, off_ohm: 1e5 };
    let buck = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, switch),
        Branch::new(2, 0, switch),
        Branch::new(2, 3, Element::Coil { henry: 1e-3, ohm: 0.1 }),
        Branch::new(3, 0, Element::Capacitor { farad: 1e-4 }),
        Branch::new(3, 0, Element::Resistor { ohm: 5.0 }),
    ];
    let input = |t: f64| {
        let high = (t * 1e6 - 0.25) % 100.0 < 40.0;
        ([400.0, 0.0, 0.0, 0.0, 0.0, 0.0], if high { 0b010 } else { 0b100 })
    };
    for method in [Method::BackwardEuler, Method::Trapezoidal] {
        for (element, by_current, column) in [(4, false, 1), (3, true, 2)] {
            // 200 steps in a period.
            let ours = run::<4, 6>(buck, method, 5e-7, 10_000, input, element, by_current);
            let off = difference(&ours, theirs.iter().map(|row| row[column]));
            assert!(off < 0.01, "{method:?}, element {element}: {off}");
        }
    }
}

/// 2 Ω, 1 mH, 10 µF on a source that rises to 10 V within 30 µs.
#[test]
fn a_series_resonance() {
    let Some(theirs) = reference("rlc") else { return };
    let series = [
        Branch::new(1, 0, Element::Voltage),
        Branch::new(1, 2, Element::Coil { henry: 1e-3, ohm: 2.0 }),
        Branch::new(2, 0, Element::Capacitor { farad: 1e-5 }),
    ];
    let input = |t: f64| ([10.0 * (t / 30e-6).min(1.0), 0.0, 0.0], 0);
    for (element, by_current, column) in [(2, false, 1), (1, true, 2)] {
        // It rings with 0.63 ms; 200 steps of that are 3 µs, or six rows of theirs.
        let off = |method, rows: u32| {
            let (dt_s, steps) = (0.5e-6 * f64::from(rows), 6000 / rows as usize);
            let ours = run::<3, 3>(series, method, dt_s, steps, input, element, by_current);
            difference(&ours, theirs.iter().step_by(rows as usize).map(|row| row[column]))
        };
        let order = |method| (off(method, 6) / off(method, 3)).log2();
        let (rule, euler) = (order(Method::Trapezoidal), order(Method::BackwardEuler));
        assert!(off(Method::Trapezoidal, 6) < 0.01 && (rule - 2.0).abs() < 0.1, "{rule}");
        // Euler damps by ω²·h/2 = 150 1/s more than the 1000 1/s of the circuit.
        let coarse = off(Method::BackwardEuler, 6);
        assert!(coarse < 0.15 && (euler - 1.0).abs() < 0.1, "{coarse} {euler}");
    }
}

/// 400 V, two legs at 10 kHz with 2 µs of dead time, a DC motor's winding at 100 V of back-EMF.
#[test]
fn an_h_bridge() {
    let Some(theirs) = reference("h-bridge") else { return };
    let transistor =
        Element::Transistor { on_ohm: 0.005, off_ohm: 1e5, drop_v: 0.0, diode_drop_v: 0.8 };
    let bridge = h_bridge(transistor, Element::Coil { henry: 1e-3, ohm: 1.0 });
    let input = |t: f64| {
        let within = (t * 1e6 - 0.25) % 100.0;
        let gates = match within {
            2.0..70.0 => 0b10010,
            72.0..100.0 => 0b01100,
            _ => 0,
        };
        ([400.0, 0.0, 0.0, 0.0, 0.0, 100.0], gates)
    };
    for method in [Method::BackwardEuler, Method::Trapezoidal] {
        let ours = run::<4, 6>(bridge, method, 5e-7, 20_000, input, 5, true);
        let off = difference(&ours, theirs.iter().map(|row| row[1]));
        assert!(off < 0.01, "{method:?}: {off}");
    }
}
