//! A machine behind its converter, with temperatures: its losses heat one node each of machine and
//! inverter, the machine's resists by its winding's temperature, and either derates the current.
//!
//! `C·dΔ/dt = P − Δ/R` with Δ the temperature above the coolant, which does not change; P is what the
//! ledger names: `copper`, `iron` and the friction of its shaft in the machine, `converter` in the
//! inverter. So a drive whose losses were measured as
//! [`DriveLosses`](crate::thermal::DriveLosses) is heated by just these.
//!
//! Resistance and current limit of a step are those of the temperatures at its start. Where nothing is
//! derated and the resistance is that of the reference, a step gives the bits of the machine alone. The
//! nodes are ours, as is the derating; the resistance is that of [`Conductor`].
//!
//! Tests: `heated/tests.rs`; property `drives`; case "heated drive".

use super::{
    Bounds, Footing, Held, Machine, MachineFlows, Review, Seen, Solved, Temperatures, Wish,
};
use crate::converter::{ConverterParams, Gates};
use crate::error::{ParamError, check, finite, limit};
use crate::mechanics::body::Resistance;
use crate::model::Dt;
use crate::num::{Accum, Real, min};
use crate::port::{BusLaw, Coast, DriveLaw, Source};
use crate::thermal::{Conductor, Derating, ThermalNode, ThermalNodeParams};

/// A part of a drive that heats up: the machine, or the inverter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct HeatedPartParams {
    /// Heat capacity C \[J/K\], above zero; infinity: it stays as warm as the coolant.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub heat_capacity_j_per_k: Real,
    /// Thermal resistance R to the coolant \[K/W\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub coolant_k_per_w: Real,
    /// Up to this temperature the whole current limit is left \[°C\], −273.15 at least; infinity:
    /// always.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub derate_from_c: Real,
    /// From this temperature on nothing is left \[°C\], above the other; infinity: never.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub derate_to_c: Real,
}

impl HeatedPartParams {
    /// As warm as the coolant, and never derated.
    pub const FIXED: Self = Self {
        heat_capacity_j_per_k: Real::INFINITY,
        coolant_k_per_w: Real::INFINITY,
        derate_from_c: Real::INFINITY,
        derate_to_c: Real::INFINITY,
    };
}

/// How a drive heats up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DriveThermalParams {
    /// Temperature of the coolant \[°C\], −100..200: that of both parts at the start.
    pub coolant_c: Real,
    /// The machine: its winding counts as warm as the rest.
    pub machine: HeatedPartParams,
    /// The inverter.
    pub inverter: HeatedPartParams,
    /// How the winding's resistance follows; it is given at `reference_c`. What a synchronous machine
    /// says of itself (`resistance_per_k`) is for a machine without nodes.
    #[cfg_attr(feature = "serde", serde(default = "copper"))]
    pub winding: Conductor,
}

#[cfg(feature = "serde")]
fn copper() -> Conductor {
    Conductor::COPPER
}

impl DriveThermalParams {
    /// A drive that no loss heats: the machine alone, to the bit.
    pub const NONE: Self = Self {
        coolant_c: 20.0,
        machine: HeatedPartParams::FIXED,
        inverter: HeatedPartParams::FIXED,
        winding: Conductor::CONSTANT,
    };
}

/// A machine whose winding and current limit may be other than it was made with.
pub trait HeatedMachine: Machine {
    /// The same machine with another resistance of its winding, ≥ 0 \[Ω\], and another limit of its
    /// current, ≥ 0 \[A\].
    #[must_use]
    fn with(&self, winding_ohm: Real, current_limit_a: Real) -> Self;

    /// Whether its current limit holds back what an ideal inner loop is told.
    fn holds(&self, gates: Gates<Self::Modulation>, link: &Self::Link) -> bool;
}

/// One part, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    node: ThermalNode,
    derating: Derating,
}

/// A machine with temperatures, discretised for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heated<M> {
    cold: M,
    machine: Part,
    inverter: Part,
    conductor: Conductor,
    coolant_c: Real,
    winding_ohm: Real,
    current_limit_a: Real,
    constant_loss_w: Real,
    /// Friction of the machine's shaft at the road: viscous \[N·s/m\], Coulomb \[N\].
    viscous: Real,
    coulomb_n: Real,
}

/// What a [`Heated`] machine remembers; as warm as the coolant by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HeatedState<S> {
    /// The machine's own.
    pub machine: S,
    /// How much warmer than the coolant the machine is \[K\]; may be set between steps.
    pub machine_above_k: Accum,
    /// The same of the inverter \[K\].
    pub inverter_above_k: Accum,
}

/// What a step with a [`Heated`] machine leaves for the walk back.
#[derive(Clone, Copy, Debug)]
pub struct HeatedLink<K> {
    link: K,
    /// Of the road: at the start until it is closed, then at the end \[m/s\].
    speed_m_s: Real,
    /// A temperature holds a command back.
    derated: bool,
}

/// What a step says of a [`Heated`] machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HeatedOutput<O> {
    /// The machine itself.
    pub machine: O,
    /// How warm it is at the end of the step.
    pub temperatures: Temperatures,
}

impl Part {
    /// The parameters, and what their fields are called in an error.
    const fn new(
        params: HeatedPartParams,
        names: [&'static str; 4],
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let [capacity, resistance, from, to] = names;
        let heat_capacity_j_per_k = check!(limit(capacity, params.heat_capacity_j_per_k));
        let ambient_k_per_w = check!(limit(resistance, params.coolant_k_per_w));
        let node = ThermalNodeParams { heat_capacity_j_per_k, ambient_k_per_w };
        let HeatedPartParams { derate_from_c, derate_to_c, .. } = params;
        let derating = match (Derating { derate_from_c, derate_to_c }).checked() {
            Ok(derating) => derating,
            Err(ParamError::OutOfRange(_)) => return Err(ParamError::OutOfRange(from)),
            Err(_) => return Err(ParamError::NotAbove(to)),
        };
        Ok(Self { node: check!(ThermalNode::new(node, dt)), derating })
    }
}

/// The coolant's range \[°C\].
const COOLANT_C: (Real, Real) = (-100.0, 200.0);

impl<M: Copy> Heated<M> {
    /// A machine with its nodes. `winding_ohm` is the resistance of the winding that it was made with,
    /// `shaft` what resists there whatever drives it.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range; a drive that may be derated needs a
    /// finite `converter.current_limit_a`.
    pub(crate) const fn new(
        cold: M,
        thermal: &DriveThermalParams,
        winding_ohm: Real,
        converter: ConverterParams,
        shaft: Coast,
        motor_rad_per_m: Real,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let coolant_c = check!(finite("thermal.coolant_c", thermal.coolant_c));
        if !(coolant_c >= COOLANT_C.0 && coolant_c <= COOLANT_C.1) {
            return Err(ParamError::OutOfRange("thermal.coolant_c"));
        }
        let names = [
            "thermal.machine.heat_capacity_j_per_k",
            "thermal.machine.coolant_k_per_w",
            "thermal.machine.derate_from_c",
            "thermal.machine.derate_to_c",
        ];
        let machine = check!(Part::new(thermal.machine, names, dt));
        let names = [
            "thermal.inverter.heat_capacity_j_per_k",
            "thermal.inverter.coolant_k_per_w",
            "thermal.inverter.derate_from_c",
            "thermal.inverter.derate_to_c",
        ];
        let inverter = check!(Part::new(thermal.inverter, names, dt));
        let conductor = thermal.winding;
        if conductor.checked().is_err() {
            let level = Conductor { per_k: 0.0, ..conductor };
            return Err(ParamError::OutOfRange(if level.checked().is_err() {
                "thermal.winding.reference_c"
            } else {
                "thermal.winding.per_k"
            }));
        }
        let never = machine.derating.derate_to_c == Real::INFINITY
            && inverter.derating.derate_to_c == Real::INFINITY;
        if !never && converter.current_limit_a == Real::INFINITY {
            // Of no limit no share can be left.
            return Err(ParamError::NotPositive("converter.current_limit_a"));
        }
        let shaft = shaft.reflected(motor_rad_per_m);
        Ok(Self {
            cold,
            machine,
            inverter,
            conductor,
            coolant_c,
            winding_ohm,
            current_limit_a: converter.current_limit_a,
            constant_loss_w: converter.constant_loss_w,
            viscous: shaft.viscous,
            coulomb_n: shaft.coulomb,
        })
    }

    /// How warm it is.
    #[inline(always)]
    const fn temperatures<S>(&self, state: &HeatedState<S>) -> Temperatures {
        let machine_c = self.coolant_c + state.machine_above_k.get();
        let inverter_c = self.coolant_c + state.inverter_above_k.get();
        let left =
            min(self.machine.derating.factor(machine_c), self.inverter.derating.factor(inverter_c));
        Temperatures { machine_c, inverter_c, left }
    }
}

impl<M: HeatedMachine> Heated<M> {
    /// The machine as warm as it is.
    #[inline(always)]
    fn warm(&self, state: &HeatedState<M::State>) -> M {
        let Temperatures { machine_c, left, .. } = self.temperatures(state);
        let winding_ohm = self.winding_ohm * self.conductor.factor(machine_c);
        // All that is left of no limit is none.
        let limit_a = if left < 1.0 { self.current_limit_a * left } else { self.current_limit_a };
        self.cold.with(winding_ohm, limit_a)
    }

    /// Whether a temperature holds a command back.
    #[inline(always)]
    fn derates(
        &self,
        state: &HeatedState<M::State>,
        warm: &M,
        gates: Gates<M::Modulation>,
        link: &M::Link,
    ) -> bool {
        self.temperatures(state).left < 1.0 && warm.holds(gates, link)
    }
}

mod joined;

#[cfg(test)]
mod tests;
