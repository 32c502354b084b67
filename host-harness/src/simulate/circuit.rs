//! A circuit from a file, over the time that it names.

use anyhow::ensure;
use plant_core::circuit::CircuitInput;
use serde::Serialize;

use crate::read::netlist::{ELEMENTS, Netlist};

/// The least, mean and largest of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// The least.
    pub least: f64,
    /// The mean.
    pub mean: f64,
    /// The largest.
    pub largest: f64,
}

impl Span {
    const NONE: Self = Self { least: f64::INFINITY, mean: 0.0, largest: f64::NEG_INFINITY };

    fn add(&mut self, value: f64, share: f64) {
        self.least = self.least.min(value);
        self.mean += share * value;
        self.largest = self.largest.max(value);
    }
}

/// What one element did, over every step of the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElementFigures {
    /// Its name.
    pub name: String,
    /// Voltage \[V\].
    pub voltage_v: Span,
    /// Current \[A\].
    pub current_a: Span,
}

/// What came of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircuitRun {
    /// The circuit's name.
    pub name: String,
    /// Steps taken.
    pub steps: u32,
    /// Steps in which the switches or curves did not come to rest.
    pub unsettled_steps: u32,
    /// `Σ v·i` over `½·Σ |v·i|`, the largest of all steps with at least a millionth of the largest power.
    pub balance_rel: f64,
    /// Each element, in the order of the netlist's.
    pub elements: Vec<ElementFigures>,
    /// Ends of the steps that are kept \[s\].
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// Voltages \[V\] of each element.
    #[serde(skip)]
    pub voltage_v: Vec<Vec<f64>>,
    /// Currents \[A\].
    #[serde(skip)]
    pub current_a: Vec<Vec<f64>>,
}

/// Runs it.
///
/// # Errors
/// A value that the circuit can't take, or one that grew beyond all bounds: when.
pub fn run(netlist: &Netlist) -> anyhow::Result<CircuitRun> {
    let mut circuit = netlist.circuit()?;
    let parts = &netlist.parts;
    let idle = |name: &String| ElementFigures {
        name: name.clone(),
        voltage_v: Span::NONE,
        current_a: Span::NONE,
    };
    let mut run = CircuitRun {
        name: netlist.name.clone(),
        steps: netlist.steps,
        unsettled_steps: 0,
        balance_rel: 0.0,
        elements: parts.iter().map(|part| idle(&part.name)).collect(),
        time_s: Vec::new(),
        voltage_v: vec![Vec::new(); parts.len()],
        current_a: vec![Vec::new(); parts.len()],
    };
    let share = 1.0 / f64::from(netlist.steps);
    let mut largest_w = 0.0_f32;
    for step in 1..=netlist.steps {
        let end_s = f64::from(step) * netlist.step_s;
        let mut input = CircuitInput::<ELEMENTS>::of([0.0; ELEMENTS]);
        for (e, part) in parts.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
            let value = part.value.at(end_s, netlist.step_s) as f32;
            input.values[e] = value;
            input.gates |= u32::from(part.gate.is_on(end_s, netlist.step_s)) << e;
        }
        let (out, books) = circuit.step(input);
        ensure!(
            !out.rejected,
            "{}: at {end_s:.9} s a value is not finite, or no circuit can have it",
            netlist.name
        );
        run.unsettled_steps += u32::from(!out.settled);
        largest_w = largest_w.max(books.throughput_w);
        if books.throughput_w > 1e-6 * largest_w {
            let off = f64::from(books.balance_w.abs() / books.throughput_w);
            run.balance_rel = run.balance_rel.max(off);
        }
        let kept = step % netlist.row_steps == 0;
        if kept {
            run.time_s.push(end_s);
        }
        for (e, figures) in run.elements.iter_mut().enumerate() {
            let (voltage_v, current_a) = (out.voltage_v[e].into(), out.current_a[e].into());
            figures.voltage_v.add(voltage_v, share);
            figures.current_a.add(current_a, share);
            if kept {
                run.voltage_v[e].push(voltage_v);
                run.current_a[e].push(current_a);
            }
        }
    }
    Ok(run)
}
