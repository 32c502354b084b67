//! A circuit from a TOML file: `data/circuits/*.toml` are the examples. Whatever is wrong in one is
//! reported with its line and column.

mod layout;
mod shape;
mod sized;
mod source;
#[cfg(test)]
mod tests;

pub use shape::{Gate, Wave};
pub use sized::{ELEMENTS, NODES, Stepping};

use std::collections::BTreeSet;
use std::path::Path;

use plant_core::Dt;
use plant_core::circuit::{Branch, CircuitError, Element, Method};

use crate::read::document::Document;
use crate::read::error::{self, InputError};

/// The name of node 0.
const GROUND: &str = "ground";
/// The most switches, diodes and transistors.
const TWO_STATES: usize = 16;
/// The most steps of a run.
const MOST_STEPS: f64 = 1e7;

/// A circuit and how it is run; it can be built.
#[derive(Clone, Debug, PartialEq)]
pub struct Netlist {
    /// Its name.
    pub name: String,
    /// What it is, in one line.
    pub description: String,
    /// How a step approximates a derivative.
    pub method: Method,
    /// The step.
    pub step: Dt,
    /// The same, as it is written \[s\].
    pub step_s: f64,
    /// Steps of the run.
    pub steps: u32,
    /// The trace has a row for each so many steps.
    pub row_steps: u32,
    /// Names of the nodes, the ground first.
    pub nodes: Vec<String>,
    /// Its elements.
    pub parts: Vec<Part>,
    /// Of which parts the voltage is plotted.
    pub plotted_v: Vec<usize>,
    /// Of which parts the current is plotted.
    pub plotted_a: Vec<usize>,
}

/// One element.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its kind, as the file calls it.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// What and where it is.
    pub branch: Branch,
    /// The value that it takes in each step.
    pub value: Wave,
    /// Its gate.
    pub gate: Gate,
    /// Current of a coil \[A\], voltage of a capacitor \[V\] at the start.
    pub initial: f32,
}

impl Part {
    fn path(&self) -> String {
        format!("{}.{}", self.kind, self.name)
    }
}

/// A circuit from a file.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn load(path: &str) -> Result<Netlist, InputError> {
    parse(path, &error::read(Path::new(path))?)
}

/// A circuit from the bytes of a file; `file` is for messages.
///
/// # Errors
/// [`InputError`] says what is wrong and where.
pub fn parse(file: &str, bytes: &[u8]) -> Result<Netlist, InputError> {
    let document = Document::parse(file, bytes)?;
    let read = document.read::<layout::File>()?;
    let mut nodes = vec![GROUND.to_owned()];
    let parts = read.parts(&mut nodes).map_err(|(path, rule)| document.refusal(&path, &rule))?;
    limits(&document, &parts, &nodes)?;
    let (step_s, duration_s) = (read.run.step_s, read.run.duration_s);
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let step = Dt::from_s(step_s as f32)
        .map_err(|error| document.refusal("run.step_s", error.message()))?;
    let steps = (duration_s / step_s).round();
    if !(1.0..=MOST_STEPS).contains(&steps) {
        return Err(document.refusal("run.duration_s", "must be 1 to 10 million steps"));
    }
    let row_s = read.run.row_s.unwrap_or(step_s);
    let row_steps = (row_s / step_s).round();
    if !(1.0..=steps).contains(&row_steps) {
        return Err(document.refusal("run.row_s", "must be one step to the whole run"));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 1e7")]
    let (steps, row_steps) = (steps as u32, row_steps as u32);
    let plotted = |key: &str, names: &Option<Vec<String>>, usual: fn(&Element) -> bool| match names
    {
        None => Ok((0..parts.len()).filter(|p| usual(&parts[*p].branch.element)).collect()),
        Some(names) => (names.iter())
            .map(|name| {
                let found = parts.iter().position(|part| part.name == *name);
                found.ok_or_else(|| {
                    document.refusal(&format!("plot.{key}"), "names no element of the circuit")
                })
            })
            .collect::<Result<Vec<_>, _>>(),
    };
    let (plotted_v, plotted_a) = (
        plotted("voltages", &read.plot.voltages, |e| matches!(e, Element::Capacitor { .. }))?,
        plotted("currents", &read.plot.currents, |e| matches!(e, Element::Coil { .. }))?,
    );
    let method = read.run.method.into();
    let (name, description) = (read.name, read.description);
    let netlist = Netlist {
        name,
        description,
        method,
        step,
        step_s,
        steps,
        row_steps,
        nodes,
        parts,
        plotted_v,
        plotted_a,
    };
    match netlist.circuit() {
        Ok(_) => Ok(netlist),
        Err(error) => Err(refused(&document, &netlist, error)),
    }
}

fn limits(document: &Document<'_>, parts: &[Part], nodes: &[String]) -> Result<(), InputError> {
    let Some(last) = parts.last() else {
        return Err(document.refusal("run", "has no element to run"));
    };
    let mut names = BTreeSet::new();
    if let Some(twice) = parts.iter().find(|part| !names.insert(&part.name)) {
        return Err(document.refusal(&twice.path(), "has the name of an element before it"));
    }
    if let Some(beyond) = parts.get(ELEMENTS) {
        let rule = format!("is one too many: a circuit has at most {ELEMENTS} elements");
        return Err(document.refusal(&beyond.path(), &rule));
    }
    if nodes.len() > NODES {
        let rule = format!("makes {} nodes: a circuit has at most {NODES}", nodes.len());
        return Err(document.refusal(&last.path(), &rule));
    }
    let two_state = |part: &&Part| {
        matches!(
            part.branch.element,
            Element::Switch { .. } | Element::Diode { .. } | Element::Transistor { .. }
        )
    };
    if let Some(beyond) = parts.iter().filter(two_state).nth(TWO_STATES) {
        let rule =
            format!("is one too many: at most {TWO_STATES} switches, diodes and transistors");
        return Err(document.refusal(&beyond.path(), &rule));
    }
    Ok(())
}

/// What the model says of its numbers, in the names of the file.
fn refused(document: &Document<'_>, netlist: &Netlist, error: CircuitError) -> InputError {
    let path = |e: usize| netlist.parts.get(e).map_or_else(String::new, Part::path);
    match error {
        CircuitError::Element(e, error) => {
            let field = error.field().rsplit('.').next().unwrap_or_default();
            document.refusal(&format!("{}.{field}", path(e)), error.message())
        }
        CircuitError::Shorted(e) => {
            document.refusal(&format!("{}.to", path(e)), "must not be the node of `from`")
        }
        CircuitError::SourceLoop(e) => {
            document.refusal(&path(e), "closes a loop of voltage sources")
        }
        CircuitError::Floating(n) => {
            let rule = format!(
                "node `{}` is tied to the others by nothing but sources of current and gates",
                netlist.nodes.get(n).map_or("", String::as_str)
            );
            let at = netlist.parts.iter().find_map(|part| {
                let Branch { from, to, element } = part.branch;
                let key = match element {
                    _ if from == n => "from",
                    _ if to == n => "to",
                    Element::Mos { gate, .. } if gate == n => "gate",
                    _ => return None,
                };
                Some(format!("{}.{key}", part.path()))
            });
            document.refusal(&at.unwrap_or_default(), &format!("floats: {rule}"))
        }
        other => document.refusal("run", &other.to_string()),
    }
}
