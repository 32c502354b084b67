//! A circuit is checked and discretised, and where it has a table, solved for each configuration.

use super::element::{Branch, Devices, Element};
use super::error::CircuitError;
use super::network::Network;
use super::{Circuit, Method, Response};
use crate::model::Dt;

/// How many elements can drive a current: the `SOURCES` of a [`Circuit::tabled`].
#[must_use]
pub const fn sources<const E: usize>(branches: &[Branch; E]) -> usize {
    let (mut count, mut e) = (0, 0);
    while e < E {
        count += branches[e].element.drives() as usize;
        e += 1;
    }
    count
}

/// How many two-state elements there are; `CONFIGURATIONS` of a [`Circuit::tabled`] is two to their
/// power.
#[must_use]
pub const fn two_states<const E: usize>(branches: &[Branch; E]) -> usize {
    let (mut count, mut e) = (0, 0);
    while e < E {
        count += branches[e].element.two_state() as usize;
        e += 1;
    }
    count
}

impl<const NODES: usize, const ELEMENTS: usize> Circuit<NODES, ELEMENTS> {
    /// Checks a circuit and discretises it for steps of `dt`. Each step factorises it anew.
    ///
    /// # Errors
    /// [`CircuitError`] names the element or node and the rule.
    pub const fn new(
        branches: [Branch; ELEMENTS],
        method: Method,
        dt: Dt,
    ) -> Result<Self, CircuitError> {
        Self::untabled(branches, method, dt)
    }
}

impl<const N: usize, const E: usize, const S: usize, const C: usize> Circuit<N, E, S, C> {
    /// Checks a circuit and solves each of its configurations for steps of `dt`: `C` = 2^n for n
    /// two-state elements, `S` = [`sources`]. For elements whose conductance does not vary.
    ///
    /// # Errors
    /// [`CircuitError`] names the element or node and the rule.
    pub const fn tabled(
        branches: [Branch; E],
        method: Method,
        dt: Dt,
    ) -> Result<Self, CircuitError> {
        let mut circuit = match Self::untabled(branches, method, dt) {
            Ok(circuit) => circuit,
            Err(error) => return Err(error),
        };
        if C != 1 << two_states(&branches) {
            return Err(CircuitError::TableSize(1 << two_states(&branches)));
        }
        if S != sources(&branches) {
            return Err(CircuitError::Sources(sources(&branches)));
        }
        let (mut e, mut driving) = (0, 0);
        while e < E {
            if branches[e].element.varies() {
                return Err(CircuitError::NotInTable(e));
            }
            if branches[e].element.drives() && driving < S {
                circuit.drives[driving] = e;
                driving += 1;
            }
            e += 1;
        }
        let mut configuration = 0;
        while configuration < C {
            circuit.table[configuration] = match circuit.response(configuration) {
                Ok(response) => response,
                Err(error) => return Err(error),
            };
            configuration += 1;
        }
        Ok(circuit)
    }

    const fn untabled(branches: [Branch; E], method: Method, dt: Dt) -> Result<Self, CircuitError> {
        if E > 32 || two_states(&branches) > 16 {
            return Err(CircuitError::TooLarge(E));
        }
        let per_s = match method {
            Method::BackwardEuler => 1.0 / dt.s(),
            Method::Trapezoidal => 2.0 / dt.s(),
        };
        let empty = Response { rows: [[0.0; S]; E], by_current: 0 };
        let mut circuit = Self {
            branches,
            method,
            per_s,
            blocking_s: [0.0; E],
            conducting_s: [0.0; E],
            devices: Devices::of(&branches),
            stores: 0,
            drop_v: [(0.0, 0.0); E],
            drives: [0; S],
            table: [empty; C],
        };
        let mut typical_s = [0.0; E];
        let mut e = 0;
        while e < E {
            let Branch { from, to, element } = branches[e];
            if let Err(error) = element.check() {
                return Err(CircuitError::Element(e, error));
            }
            let gate_there = match element {
                Element::Mos { gate, .. } => gate < N,
                _ => true,
            };
            if from >= N || to >= N || !gate_there {
                return Err(CircuitError::NoSuchNode(e));
            }
            if from == to {
                return Err(CircuitError::Shorted(e));
            }
            circuit.blocking_s[e] = element.conductance_s(per_s, false, 1.0);
            circuit.drop_v[e] = element.drop_v();
            circuit.stores |= (element.stores() as u32) << e;
            circuit.conducting_s[e] = element.conductance_s(per_s, true, 1.0);
            typical_s[e] = if element.curved() { 1.0 } else { circuit.blocking_s[e] };
            e += 1;
        }
        // With whatever values and switches: the same nodes are tied.
        match Network::<N, E>::new(&circuit.branches, typical_s) {
            Ok(_) => Ok(circuit),
            Err(error) => Err(error),
        }
    }

    /// Solves one configuration for a unit of each source.
    const fn response(&self, configuration: usize) -> Result<Response<E, S>, CircuitError> {
        let mut conductance_s = self.blocking_s;
        let (mut e, mut device) = (0, 0);
        while e < E {
            if self.branches[e].element.two_state() {
                if configuration >> device & 1 == 1 {
                    conductance_s[e] = self.conducting_s[e];
                }
                device += 1;
            }
            e += 1;
        }
        let net = match Network::<N, E>::new(&self.branches, conductance_s) {
            Ok(net) => net,
            Err(error) => return Err(error),
        };
        let mut response = Response { rows: [[0.0; S]; E], by_current: 0 };
        let mut s = 0;
        while s < S {
            let mut drive = [0.0; E];
            if self.drives[s] < E {
                drive[self.drives[s]] = 1.0;
            }
            let found = net.solve(&self.branches, &drive);
            let mut e = 0;
            while e < E {
                // The current of a coil moves by little, so that its voltage says more.
                let coil = matches!(self.branches[e].element, Element::Coil { .. });
                if net.in_tree(e) && !coil {
                    response.by_current |= 1 << e;
                    response.rows[e][s] = found.current_a[e];
                } else {
                    response.rows[e][s] = found.voltage_v[e];
                }
                e += 1;
            }
            s += 1;
        }
        Ok(response)
    }
}
