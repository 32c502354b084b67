//! A circuit as its file is laid out: a table `[kind.name]` for each element.

use std::fmt;
use std::marker::PhantomData;

use plant_core::circuit::{Branch, Element, Method};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::Part;
use super::shape::{Gate, Pulse, Wave};
use super::source::{Broken, ampere, farad, ohm, volt};

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct File {
    pub name: String,
    pub description: String,
    pub run: Run,
    #[serde(default)]
    pub plot: Plot,
    #[serde(default)]
    resistor: Named<Resistor>,
    #[serde(default)]
    coil: Named<Coil>,
    #[serde(default)]
    capacitor: Named<Capacitor>,
    #[serde(default)]
    variable_resistor: Named<ohm::Source>,
    #[serde(default)]
    variable_capacitor: Named<farad::Source>,
    #[serde(default)]
    voltage: Named<volt::Source>,
    #[serde(default)]
    current: Named<ampere::Source>,
    #[serde(default)]
    switch: Named<Switch>,
    #[serde(default)]
    diode: Named<Diode>,
    #[serde(default)]
    transistor: Named<Transistor>,
    #[serde(default)]
    junction: Named<Junction>,
    #[serde(default)]
    nmos: Named<Mos>,
    #[serde(default)]
    pmos: Named<Mos>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Run {
    pub method: HowToStep,
    pub step_s: f64,
    pub duration_s: f64,
    pub row_s: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum HowToStep {
    BackwardEuler,
    Trapezoidal,
}

impl From<HowToStep> for Method {
    fn from(how: HowToStep) -> Self {
        match how {
            HowToStep::BackwardEuler => Self::BackwardEuler,
            HowToStep::Trapezoidal => Self::Trapezoidal,
        }
    }
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plot {
    pub voltages: Option<Vec<String>>,
    pub currents: Option<Vec<String>>,
}

/// Tables with names, in the order of the file.
struct Named<T>(Vec<(String, T)>);

impl<T> Default for Named<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Named<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Tables<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Tables<T> {
            type Value = Named<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table for each element, by its name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut all = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    all.push(entry);
                }
                Ok(Named(all))
            }
        }
        deserializer.deserialize_map(Tables(PhantomData))
    }
}

/// An element of a file: two nodes, and the rest.
macro_rules! elements {
    ($($name:ident { $($field:ident: $type:ty),* $(,)? })*) => { $(
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $name { from: String, to: String, $($field: $type),* }
    )* };
}

elements! {
    Resistor { ohm: f32 }
    Coil { henry: f32, ohm: Option<f32>, initial_a: Option<f32> }
    Capacitor { farad: f32, initial_v: Option<f32> }
    Switch { on_ohm: Option<f32>, off_ohm: Option<f32>, pulse: Option<Pulse>, toggles_s: Option<Vec<f64>> }
    Diode { on_ohm: f32, off_ohm: f32, drop_v: f32 }
    Transistor {
        on_ohm: f32, off_ohm: f32, drop_v: f32, diode_drop_v: f32,
        pulse: Option<Pulse>, toggles_s: Option<Vec<f64>>,
    }
    Junction {
        saturation_a: Option<f32>, thermal_v: Option<f32>,
        largest_exponent: Option<f32>, parallel_ohm: Option<f32>,
    }
    Mos {
        gate: String, threshold_v: Option<f32>, gain_a_v2: Option<f32>,
        modulation_per_v: Option<f32>,
    }
}

fn gate(path: &str, pulse: Option<Pulse>, toggles_s: Option<&Vec<f64>>) -> Result<Gate, Broken> {
    let broken = |key: &str, rule: &str| Err((format!("{path}.{key}"), rule.to_owned()));
    match (pulse, toggles_s) {
        (None, None) => Ok(Gate::OFF),
        (Some(_), Some(_)) => broken("toggles_s", "must not stand beside `pulse`"),
        (Some(pulse), None) => match pulse.fault() {
            Some((key, rule)) => broken(&format!("pulse.{key}"), rule),
            None => Ok(Gate::Pulse(pulse)),
        },
        (None, Some(times)) => {
            if times.iter().all(|t| t.is_finite()) && times.windows(2).all(|t| t[0] < t[1]) {
                Ok(Gate::Toggles(times.clone()))
            } else {
                broken("toggles_s", "must be times that rise")
            }
        }
    }
}

/// The elements so far, and the names of the nodes.
struct Parts<'n> {
    nodes: &'n mut Vec<String>,
    all: Vec<Part>,
}

impl Parts<'_> {
    fn node(&mut self, name: &str) -> usize {
        self.nodes.iter().position(|n| n == name).unwrap_or_else(|| {
            self.nodes.push(name.to_owned());
            self.nodes.len() - 1
        })
    }

    fn push(
        &mut self,
        kind: &'static str,
        name: &str,
        ends: (&str, &str),
        element: Element,
    ) -> &mut Part {
        let branch = Branch::new(self.node(ends.0), self.node(ends.1), element);
        let (name, value, gate) = (name.to_owned(), Wave::Constant(0.0), Gate::OFF);
        self.all.push(Part { kind, name, branch, value, gate, initial: 0.0 });
        let last = self.all.len() - 1;
        &mut self.all[last]
    }
}

impl File {
    /// All elements, and in `nodes` the names of their nodes.
    pub(super) fn parts(&self, nodes: &mut Vec<String>) -> Result<Vec<Part>, Broken> {
        let mut parts = Parts { nodes, all: Vec::new() };
        macro_rules! sources {
            ($kind:literal, $tables:expr, $element:expr) => {
                for (name, it) in &$tables.0 {
                    let value = it.wave(&format!("{}.{name}", $kind))?;
                    parts.push($kind, name, (&it.from, &it.to), $element).value = value;
                }
            };
        }
        sources!("voltage", self.voltage, Element::Voltage);
        sources!("current", self.current, Element::Current);
        for (name, it) in &self.resistor.0 {
            let element = Element::Resistor { ohm: it.ohm };
            parts.push("resistor", name, (&it.from, &it.to), element);
        }
        sources!("variable-resistor", self.variable_resistor, Element::VariableResistor);
        for (name, it) in &self.coil.0 {
            let element = Element::Coil { henry: it.henry, ohm: it.ohm.unwrap_or(0.0) };
            let part = parts.push("coil", name, (&it.from, &it.to), element);
            part.initial = it.initial_a.unwrap_or(0.0);
        }
        for (name, it) in &self.capacitor.0 {
            let element = Element::Capacitor { farad: it.farad };
            let part = parts.push("capacitor", name, (&it.from, &it.to), element);
            part.initial = it.initial_v.unwrap_or(0.0);
        }
        sources!("variable-capacitor", self.variable_capacitor, Element::VariableCapacitor);
        for (name, it) in &self.switch.0 {
            let gate = gate(&format!("switch.{name}"), it.pulse, it.toggles_s.as_ref())?;
            let Element::Switch { on_ohm, off_ohm } = Element::IDEAL_SWITCH else { continue };
            let element = Element::Switch {
                on_ohm: it.on_ohm.unwrap_or(on_ohm),
                off_ohm: it.off_ohm.unwrap_or(off_ohm),
            };
            parts.push("switch", name, (&it.from, &it.to), element).gate = gate;
        }
        for (name, it) in &self.diode.0 {
            let Diode { on_ohm, off_ohm, drop_v, .. } = *it;
            let element = Element::Diode { on_ohm, off_ohm, drop_v };
            parts.push("diode", name, (&it.from, &it.to), element);
        }
        for (name, it) in &self.transistor.0 {
            let gate = gate(&format!("transistor.{name}"), it.pulse, it.toggles_s.as_ref())?;
            let Transistor { on_ohm, off_ohm, drop_v, diode_drop_v, .. } = *it;
            let element = Element::Transistor { on_ohm, off_ohm, drop_v, diode_drop_v };
            parts.push("transistor", name, (&it.from, &it.to), element).gate = gate;
        }
        for (name, it) in &self.junction.0 {
            parts.push("junction", name, (&it.from, &it.to), it.element());
        }
        for (kind, tables, p_channel) in [("nmos", &self.nmos, false), ("pmos", &self.pmos, true)] {
            for (name, it) in &tables.0 {
                let gate = parts.node(&it.gate);
                parts.push(kind, name, (&it.from, &it.to), it.element(gate, p_channel));
            }
        }
        Ok(parts.all)
    }
}

impl Junction {
    /// With the reference system's values where it says nothing.
    fn element(&self) -> Element {
        let mut element = Element::JUNCTION;
        if let Element::Junction { saturation_a, thermal_v, largest_exponent, parallel_ohm } =
            &mut element
        {
            *saturation_a = self.saturation_a.unwrap_or(*saturation_a);
            *thermal_v = self.thermal_v.unwrap_or(*thermal_v);
            *largest_exponent = self.largest_exponent.unwrap_or(*largest_exponent);
            *parallel_ohm = self.parallel_ohm.unwrap_or(*parallel_ohm);
        }
        element
    }
}

impl Mos {
    /// The same.
    fn element(&self, at: usize, p: bool) -> Element {
        let mut element = Element::NMOS;
        if let Element::Mos { gate, p_channel, threshold_v, gain_a_v2, modulation_per_v } =
            &mut element
        {
            (*gate, *p_channel) = (at, p);
            *threshold_v = self.threshold_v.unwrap_or(*threshold_v);
            *gain_a_v2 = self.gain_a_v2.unwrap_or(*gain_a_v2);
            *modulation_per_v = self.modulation_per_v.unwrap_or(*modulation_per_v);
        }
        element
    }
}
