//! The modes of a composed vehicle, and where they end.

use super::machine::{Pair, dot};
use super::{CURRENTS, ComposedReference, Draw, Flow, Gates, State, V};
use crate::verify::adaptive::System;

/// A smaller current of a synchronous machine's diodes ends: their voltage has no direction then
/// \[A\].
const TINY_A: f64 = 1e-3;
/// The rate of a mode's boundary is taken over this time \[s\].
const AHEAD_S: f64 = 1e-7;

/// The diodes of a converter whose gates are off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Diodes {
    Block,
    /// In this direction, of a DC machine.
    Conduct(f64),
}

/// How the largest charging current acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Charge {
    Free,
    /// The current is the edge itself.
    OnEdge,
    /// The current decays to it.
    Beyond,
}

/// The axis that makes the torque.
struct Axis {
    /// Its current is this state.
    place: usize,
    x: f64,
    back_emf: f64,
    l: f64,
    r: f64,
    phases: f64,
    which: usize,
}

impl ComposedReference {
    /// The first drive's.
    fn axis(&self, y: &State) -> Axis {
        let d = &self.p.drives[0];
        let (which, l, flux) = d.machine.axis();
        let i = Self::currents(y, 0);
        let w = d.gear / self.p.radius * y[V];
        // What the other axis adds to the flux counts.
        let back_emf =
            if i[0] == 0.0 || which == 0 { flux * w } else { d.machine.back_emf(i, w)[which] };
        let (r, phases) = (d.machine.resistance(), d.machine.phases());
        Axis { place: CURRENTS + which, x: i[which], back_emf, l, r, phases, which }
    }

    /// What the drive may take from the bus while the battery gives `battery_a` \[W\].
    fn left(&self, y: &State, battery_a: f64) -> f64 {
        let (emf, r) = self.source(y);
        let v = emf - r * battery_a;
        v * (battery_a - self.p.load_s * v) - self.command.auxiliary_w
    }

    /// The braking current that charges the battery just as much as it may, once held; its size.
    fn edge(&self, y: &State, axis: &Axis) -> f64 {
        if self.command.charge_a == f64::INFINITY {
            return f64::INFINITY;
        }
        let lowest = self.left(y, -self.command.charge_a) / axis.phases;
        let e = axis.back_emf.abs();
        let root = e * e + 4.0 * axis.r * lowest;
        if root > 0.0 { -2.0 * lowest / (e + root.sqrt()) } else { f64::INFINITY }
    }

    /// The direction in which a current brakes.
    fn braking(axis: &Axis) -> f64 {
        if axis.back_emf > 0.0 { -1.0 } else { 1.0 }
    }

    /// The state with the current that the charge limit determines put in.
    pub fn shown(&self, y: &State) -> State {
        let mut y = *y;
        if self.charge == Charge::OnEdge {
            let axis = self.axis(&y);
            y[axis.place] = Self::braking(&axis) * self.edge(&y, &axis);
        }
        y
    }

    pub(super) fn flow(&self, t: f64, y: &State) -> Flow {
        let mut flow = self.free_flow(t, y);
        let c = &self.command;
        if c.discharge_a == f64::INFINITY && c.charge_a == f64::INFINITY {
            return flow;
        }
        let axis = self.axis(y);
        let free = flow.slopes[0][axis.which];
        let watts =
            |slope: f64| axis.phases * axis.x * (axis.back_emf + axis.r * axis.x + axis.l * slope);
        let slope = match self.charge {
            Charge::OnEdge => self.edge_rate(&flow, y, &axis),
            Charge::Beyond => {
                let edge = Self::braking(&axis) * self.edge(y, &axis);
                -axis.r / axis.l * (axis.x - edge)
            }
            Charge::Free if c.discharge_a < f64::INFINITY => {
                let most = self.left(y, c.discharge_a);
                if watts(free) > most {
                    (most / (axis.phases * axis.x) - axis.back_emf - axis.r * axis.x) / axis.l
                } else {
                    free
                }
            }
            Charge::Free => free,
        };
        if slope == free {
            return flow;
        }
        flow.slopes[0][axis.which] = slope;
        let d = &self.p.drives[0];
        let v =
            d.machine.volts(Self::currents(y, 0), d.gear / self.p.radius * y[V], flow.slopes[0]);
        let watts = d.machine.phases() * dot(v, Self::currents(y, 0));
        let draw = Draw { amperes: 0.0, watts };
        let battery_v = self.bus(y, draw);
        self.flow_of(y, flow.slopes, draw, battery_v)
    }

    /// How fast the edge moves, from how fast the speed does: battery and flux are slow.
    fn edge_rate(&self, flow: &Flow, y: &State, axis: &Axis) -> f64 {
        let mut ahead = *y;
        ahead[V] += AHEAD_S * flow.acceleration;
        let signed = |y: &State| Self::braking(axis) * self.edge(y, &self.axis(y));
        (signed(&ahead) - signed(y)) / AHEAD_S
    }

    /// Modes that a new command begins with.
    pub(super) fn begin(&mut self, t: f64, y: &mut State) {
        for n in 0..self.p.drives.len() {
            if self.command.gates[n] == Gates::Off {
                let i = Self::currents(y, n);
                self.diodes[n] = if dot(i, i).sqrt() > TINY_A {
                    Diodes::Conduct(i[0].signum())
                } else {
                    [y[CURRENTS + 2 * n], y[CURRENTS + 2 * n + 1]] = [0.0; 2];
                    Diodes::Block
                };
            }
        }
        self.charge = Charge::Free;
        // Several modes may change at once.
        for _ in 0..8 {
            if System::margin(self, t, y) < 0.0 {
                self.switch_modes(t, y);
            }
        }
    }

    fn friction_margin(&self, y: &State) -> f64 {
        if self.direction == 0.0 {
            self.friction(y) - self.force(y).abs()
        } else {
            self.direction * y[V]
        }
    }

    fn limit_margin(&self, t: f64, y: &State) -> f64 {
        let Some(c) = &self.p.controller else { return f64::INFINITY };
        let raw = self.raw(c, t, y);
        if self.limit > 0.0 {
            raw - c.max
        } else if self.limit < 0.0 {
            c.min - raw
        } else {
            (c.max - raw).min(raw - c.min)
        }
    }

    /// How far the induced voltage is from what diodes need, or their current from its end.
    fn diode_margin(&self, t: f64, y: &State, n: usize) -> f64 {
        if self.command.gates[n] != Gates::Off {
            return f64::INFINITY;
        }
        let d = &self.p.drives[n];
        let i = Self::currents(y, n);
        match self.diodes[n] {
            Diodes::Block => {
                let e = d.machine.back_emf([0.0; 2], d.gear / self.p.radius * y[V]);
                d.machine.diode_share() * self.free_flow(t, y).battery_v - dot(e, e).sqrt()
            }
            Diodes::Conduct(way) if d.machine.axis().0 == 0 => way * i[0],
            Diodes::Conduct(_) => dot(i, i).sqrt() - TINY_A,
        }
    }

    fn charge_margin(&self, t: f64, y: &State) -> f64 {
        if self.command.charge_a == f64::INFINITY {
            return f64::INFINITY;
        }
        let (y, free) = (&self.shown(y), self.free_flow(t, &self.shown(y)));
        let axis = self.axis(y);
        let way = Self::braking(&axis);
        let (carried, edge) = (way * axis.x, self.edge(y, &axis));
        let wanted = way * free.slopes[0][axis.which];
        match self.charge {
            Charge::Free => edge - carried,
            Charge::OnEdge => wanted - way * self.edge_rate(&free, y, &axis),
            Charge::Beyond => (wanted + axis.r / axis.l * (carried - edge)).min(carried - edge),
        }
    }

    pub(super) fn margins(&self, t: f64, y: &State) -> f64 {
        let diodes = (0..self.p.drives.len()).map(|n| self.diode_margin(t, y, n));
        let others = [self.friction_margin(y), self.limit_margin(t, y), self.charge_margin(t, y)];
        diodes.chain(others).fold(f64::INFINITY, f64::min)
    }

    pub(super) fn switch_modes(&mut self, t: f64, y: &mut State) {
        if self.friction_margin(y) < 0.0 {
            if self.direction != 0.0 {
                y[V] = 0.0;
            }
            let force = self.force(y);
            self.direction = if force.abs() <= self.friction(y) { 0.0 } else { force.signum() };
        }
        if self.limit_margin(t, y) < 0.0
            && let Some(c) = &self.p.controller
        {
            let raw = self.raw(c, t, y);
            self.limit = f64::from(i8::from(raw >= c.max) - i8::from(raw <= c.min));
        }
        for n in 0..self.p.drives.len() {
            if self.diode_margin(t, y, n) < 0.0 {
                self.diodes[n] = self.switched(y, n);
            }
        }
        if self.charge_margin(t, y) < 0.0 {
            self.charge = match self.charge {
                Charge::Free => {
                    let axis = self.axis(y);
                    let beyond = Self::braking(&axis) * axis.x - self.edge(y, &axis);
                    // Where the current came from within, it is there.
                    if beyond > 1e-6 { Charge::Beyond } else { Charge::OnEdge }
                }
                Charge::OnEdge => {
                    *y = self.shown(y);
                    // Just within, so that the mode does not end at once.
                    let axis = self.axis(y);
                    y[axis.place] -= Self::braking(&axis) * 1e-9;
                    Charge::Free
                }
                Charge::Beyond => {
                    let axis = self.axis(y);
                    let beyond = Self::braking(&axis) * axis.x - self.edge(y, &axis);
                    if beyond <= 1e-9 { Charge::OnEdge } else { Charge::Free }
                }
            };
        }
    }

    /// Diodes at the end of their mode.
    fn switched(&self, y: &mut State, n: usize) -> Diodes {
        let d = &self.p.drives[n];
        let set = |y: &mut State, i: Pair| {
            [y[CURRENTS + 2 * n], y[CURRENTS + 2 * n + 1]] = i;
        };
        match self.diodes[n] {
            Diodes::Block => {
                let e = d.machine.back_emf([0.0; 2], d.gear / self.p.radius * y[V]);
                if d.machine.axis().0 == 1 {
                    // Against the induced voltage; enough to have a direction.
                    let length = dot(e, e).sqrt();
                    set(y, e.map(|e| -2.0 * TINY_A * e / length));
                }
                Diodes::Conduct(-e[0].signum())
            }
            Diodes::Conduct(_) => {
                set(y, [0.0; 2]);
                Diodes::Block
            }
        }
    }
}
