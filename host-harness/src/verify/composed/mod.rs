//! The continuous equations of a vehicle with several drives, in double precision, written from the
//! differential equations alone: one battery (RC1), one body on a road, and up to four drives, each
//! a DC machine or a synchronous machine behind an averaged converter without losses (the resistance
//! of one adds to the winding's), with its gearbox on the wheels (`EPowertrain2025`, errata applied).
//! Nothing here calls `plant-core`.
//!
//! ```text
//! battery  V = V_oc(SOC) − V_rc − R_s·I     dSOC/dt = −I/(3600·Q)     C·dV_rc/dt = I − V_rc/R_p
//! bus      I = Σ P_j/V + V/R_load + P_aux/V
//! drive    L·di/dt = v − R·i − e(ω)         P = v·i, of a synchronous machine 3/2·v·i
//! road     m·dv/dt = Σ T_j·N_j/r − air − viscous − M·g·sin α − F_c·sgn(v), set-valued at v = 0
//!          F_c = C_r·M·g·cos α + brake + Σ (1 − η_j)·|T_j|·N_j/r
//! ```
//!
//! What a converter makes of the bus is its command ([`Gates`]). Modes (standstill, a controller at
//! its limit, diodes that block, a battery limit that acts) end where a margin falls below zero; the
//! solver stops there.
//!
//! Two lags are eliminated where they are faster than all else by a factor of a thousand: an RC
//! branch with τ ≤ 2 µs acts as its resistance, and the controller's smoothing as the first term of
//! its series, `out = target − τ·d(target)/dt`: (τ·207 rad/s)² = 4e-8 at 1 µs.
//!
//! **Battery limits** act on the axis that makes the torque, of a vehicle with one drive. *Discharge*:
//! the power is what the limit leaves, so the current rises no faster than that. *Charge*: up to the
//! edge, the current that charges just so much once it is held, commands are free; it stays on the
//! edge while the command would lead beyond; one that is beyond already, as the limit fell, decays
//! to it with L/R. A command that ends where so much of the braking is heat that less is charged
//! again is held at the edge too; a plant may let it pass, so such a case compares nothing.

mod description;
mod machine;
mod modes;
pub mod sets;
#[cfg(test)]
mod tests;

pub use description::{Command, Controller, Description, Drive, Gates};
pub use machine::{Machine, Pair, dot};
use modes::{Charge, Diodes};

use super::adaptive::{Clock, System, integrate};

/// Standard gravity \[m/s²\].
const G: f64 = 9.80665;
/// A lag below this is eliminated \[s\].
const FAST_S: f64 = 2e-6;
/// The most drives.
pub const MOST: usize = 4;

/// The states' vector.
pub type State = [f64; STATES];
pub const STATES: usize = CURRENTS + 2 * MOST;
/// Speed \[m/s\].
pub const V: usize = 0;
/// Voltage of the RC branch \[V\].
pub const RC: usize = 1;
/// The controller's integral.
pub const INTEGRAL: usize = 2;
/// State of charge.
pub const SOC: usize = 3;
/// Energy at the open-circuit voltage \[kWh\].
pub const ENERGY: usize = 4;
/// Distance \[km\].
pub const DISTANCE: usize = 5;
/// What all that loses energy took, height and auxiliary loads included \[kWh\].
pub const LOST: usize = 6;
/// The first drive's currents; two for each \[A\].
pub const CURRENTS: usize = 7;

/// What flows in one moment.
struct Flow {
    /// The slopes of each drive's currents.
    slopes: [Pair; MOST],
    battery_a: f64,
    battery_v: f64,
    acceleration: f64,
}

/// What a drive draws: amperes at any voltage, and watts.
#[derive(Clone, Copy, Default)]
struct Draw {
    amperes: f64,
    watts: f64,
}

/// A vehicle in its present modes.
#[derive(Clone, Debug)]
pub struct ComposedReference {
    p: Description,
    command: Command,
    /// The sign of the speed; 0 at standstill.
    direction: f64,
    /// −1 at the lower limit of the controller, 1 at the upper, 0 between.
    limit: f64,
    diodes: [Diodes; MOST],
    charge: Charge,
}

impl ComposedReference {
    /// At rest.
    ///
    /// # Errors
    /// No drive, or too many.
    pub fn new(p: Description) -> anyhow::Result<Self> {
        anyhow::ensure!((1..=MOST).contains(&p.drives.len()), "one to {MOST} drives");
        Ok(Self {
            p,
            command: Command::default(),
            direction: 0.0,
            limit: 0.0,
            diodes: [Diodes::Block; MOST],
            charge: Charge::Free,
        })
    }

    /// Rolling at a speed, without currents, the battery rested.
    pub fn rolling_at(&mut self, speed: f64, soc: f64) -> State {
        self.direction = if speed == 0.0 { 0.0 } else { speed.signum() };
        let mut y = [0.0; STATES];
        (y[V], y[SOC]) = (speed, soc);
        y
    }

    /// Advances from `t0` to `t1` under a command, to a tolerance; `sample` sees the state at each
    /// sample time.
    ///
    /// # Errors
    /// A battery limit on several drives; a solution with a pole.
    pub fn advance(
        &mut self,
        y: &mut State,
        command: &Command,
        (t0, t1): (f64, f64),
        tolerance: f64,
        clock: &mut Clock,
        mut sample: impl FnMut(f64, &State, &Self),
    ) -> anyhow::Result<()> {
        let limited = command.discharge_a < f64::INFINITY || command.charge_a < f64::INFINITY;
        anyhow::ensure!(!limited || self.p.drives.len() == 1, "limits act on one drive");
        self.command = *command;
        self.begin(t0, y);
        integrate(self, y, (t0, t1), tolerance, clock, |t, y, system| {
            sample(t, &system.shown(y), system);
        })?;
        *y = self.shown(y);
        Ok(())
    }

    /// The currents of a drive \[A\].
    pub fn currents(y: &State, drive: usize) -> Pair {
        [y[CURRENTS + 2 * drive], y[CURRENTS + 2 * drive + 1]]
    }

    /// Air-gap torque of a drive \[N·m\].
    pub fn torque(&self, y: &State, drive: usize) -> f64 {
        self.p.drives[drive].machine.torque(Self::currents(y, drive))
    }

    /// Battery current \[A\].
    pub fn battery_a(&self, t: f64, y: &State) -> f64 {
        self.flow(t, y).battery_a
    }

    /// Voltage at the battery's terminals \[V\].
    pub fn battery_v(&self, t: f64, y: &State) -> f64 {
        self.flow(t, y).battery_v
    }

    /// Voltage of a drive over the largest that its converter makes: above 1 no converter does.
    pub fn used(&self, t: f64, y: &State, drive: usize) -> f64 {
        let (flow, i) = (self.flow(t, y), Self::currents(y, drive));
        let d = &self.p.drives[drive];
        let v = d.machine.volts(i, d.gear / self.p.radius * y[V], flow.slopes[drive]);
        dot(v, v).sqrt() / (d.machine.diode_share() * flow.battery_v)
    }

    /// What motion and fields hold, and the RC branch \[J\].
    pub fn stored(&self, y: &State) -> f64 {
        let fields = self.p.drives.iter().enumerate();
        let fields: f64 = fields.map(|(n, d)| d.machine.field(Self::currents(y, n))).sum();
        0.5 * self.moving() * y[V] * y[V] + fields + 0.5 * self.p.c * y[RC] * y[RC]
    }

    /// Everything that moves, as mass.
    fn moving(&self) -> f64 {
        let rotors = self.p.drives.iter().map(|d| d.j * (d.gear / self.p.radius).powi(2));
        self.p.mass + rotors.sum::<f64>()
    }

    /// Rolling resistance, brake and gears: what is set-valued \[N\].
    fn friction(&self, y: &State) -> f64 {
        let sin = self.command.sin;
        let gears = self.p.drives.iter().enumerate().map(|(n, d)| {
            d.gear_loss * d.gear / self.p.radius * d.machine.torque(Self::currents(y, n)).abs()
        });
        let rolling = self.p.cr * self.p.mass * G * (1.0 - sin * sin).sqrt();
        rolling + self.command.brake + gears.sum::<f64>()
    }

    fn air(&self, v: f64) -> f64 {
        0.5 * self.p.rho * self.p.cd * self.p.area * v * v.abs()
    }

    /// Force at the road without what is set-valued \[N\].
    fn force(&self, y: &State) -> f64 {
        let drives: f64 = (self.p.drives.iter().enumerate())
            .map(|(n, d)| {
                let (i, k) = (Self::currents(y, n), d.gear / self.p.radius);
                k * (d.machine.torque(i) - (d.bm + d.machine.iron(i)) * k * y[V])
            })
            .sum();
        drives - self.air(y[V]) - self.p.mass * G * self.command.sin
    }

    fn acceleration(&self, y: &State) -> f64 {
        if self.direction == 0.0 {
            return 0.0;
        }
        (self.force(y) - self.direction * self.friction(y)) / self.moving()
    }

    /// The controller's raw output.
    fn raw(&self, c: &Controller, t: f64, y: &State) -> f64 {
        let rate = if c.d > 0.0 { self.command.rate - self.acceleration(y) } else { 0.0 };
        c.k * (self.command.reference_at(t) - y[V]) + y[INTEGRAL] + c.d * rate
    }

    /// The controller's output.
    fn controlled(&self, t: f64, y: &State) -> f64 {
        let Some(c) = &self.p.controller else { return 0.0 };
        if self.limit != 0.0 {
            return if self.limit > 0.0 { c.max } else { c.min };
        }
        let target = self.raw(c, t, y);
        if c.d > 0.0 {
            return target;
        }
        let error = self.command.reference_at(t) - y[V];
        let rate = c.k * (self.command.rate - self.acceleration(y)) + c.i * error;
        target - rate / c.smoothing
    }

    /// The battery behind its resistance: voltage without current, resistance.
    fn source(&self, y: &State) -> (f64, f64) {
        let p = &self.p;
        let (r, slow_v) = if self.is_fast() { (p.rs + p.rp, 0.0) } else { (p.rs, y[RC]) };
        (self.open_circuit(y) - slow_v, r)
    }

    fn is_fast(&self) -> bool {
        self.p.rp * self.p.c < FAST_S
    }

    fn open_circuit(&self, y: &State) -> f64 {
        self.p.v_empty + (self.p.v_full - self.p.v_empty) * y[SOC]
    }

    /// The bus voltage under what all drives draw: `V = E − r·(A + V/R_load + P/V)`.
    fn bus(&self, y: &State, draw: Draw) -> f64 {
        let (emf, r) = self.source(y);
        let (a, b) = (1.0 + r * self.p.load_s, emf - r * draw.amperes);
        let watts = draw.watts + self.command.auxiliary_w;
        (b + (b * b - 4.0 * a * r * watts).sqrt()) / (2.0 * a)
    }

    /// The gates of a drive, the controller's output put in.
    fn gates(&self, t: f64, y: &State, drive: usize) -> Gates {
        match self.command.gates[drive] {
            Gates::ControlledDuty => Gates::Modulated([self.controlled(t, y), 0.0]),
            Gates::ControlledTorque(share) => Gates::Torque(share * self.controlled(t, y)),
            gates => gates,
        }
    }

    /// What a drive draws, and the slopes of its currents where these do not depend on the bus.
    fn drawn(&self, t: f64, y: &State, drive: usize) -> (Draw, Option<Pair>) {
        let d = &self.p.drives[drive];
        let (i, w) = (Self::currents(y, drive), d.gear / self.p.radius * y[V]);
        let phases = d.machine.phases();
        let power = |v: Pair| Draw { watts: phases * dot(v, i), amperes: 0.0 };
        match self.gates(t, y, drive) {
            Gates::Modulated(m) => (Draw { amperes: phases * dot(m, i), watts: 0.0 }, None),
            Gates::Volts(v) => (power(v), Some(d.machine.slope(i, w, v))),
            Gates::Torque(torque) => {
                let aim = d.machine.aim(torque, i);
                let slope = std::array::from_fn(|k| d.rate * (aim[k] - i[k]));
                (power(d.machine.volts(i, w, slope)), Some(slope))
            }
            Gates::ControlledDuty | Gates::ControlledTorque(_) | Gates::Off => {
                match self.diodes[drive] {
                    Diodes::Block => (Draw::default(), Some([0.0; 2])),
                    Diodes::Conduct(way) => {
                        let amperes =
                            -phases * d.machine.diode_share() * dot(d.machine.along(way, i), i);
                        (Draw { amperes, watts: 0.0 }, None)
                    }
                }
            }
        }
    }

    /// The voltage of a drive on a bus, where it depends on that.
    fn volts_of(&self, t: f64, y: &State, drive: usize, bus_v: f64) -> Pair {
        let d = &self.p.drives[drive];
        match (self.gates(t, y, drive), self.diodes[drive]) {
            (Gates::Modulated(m), _) => m.map(|m| m * bus_v),
            (_, Diodes::Conduct(way)) => {
                let along = d.machine.along(way, Self::currents(y, drive));
                along.map(|x| -x * d.machine.diode_share() * bus_v)
            }
            _ => [0.0; 2],
        }
    }

    /// Without regard to battery limits.
    fn free_flow(&self, t: f64, y: &State) -> Flow {
        let mut slopes = [[0.0; 2]; MOST];
        let mut found = [None; MOST];
        let mut all = Draw::default();
        for (n, found) in found.iter_mut().enumerate().take(self.p.drives.len()) {
            let (draw, slope) = self.drawn(t, y, n);
            all = Draw { amperes: all.amperes + draw.amperes, watts: all.watts + draw.watts };
            *found = slope;
        }
        let battery_v = self.bus(y, all);
        for (n, d) in self.p.drives.iter().enumerate() {
            slopes[n] = found[n].unwrap_or_else(|| {
                let w = d.gear / self.p.radius * y[V];
                let v = self.volts_of(t, y, n, battery_v);
                d.machine.slope(Self::currents(y, n), w, v)
            });
        }
        self.flow_of(y, slopes, all, battery_v)
    }

    fn flow_of(&self, y: &State, slopes: [Pair; MOST], all: Draw, battery_v: f64) -> Flow {
        let watts = all.watts + self.command.auxiliary_w;
        let battery_a = all.amperes + self.p.load_s * battery_v + watts / battery_v;
        Flow { slopes, battery_a, battery_v, acceleration: self.acceleration(y) }
    }
}

impl System<STATES> for ComposedReference {
    fn slope(&self, t: f64, y: &State) -> State {
        let y = &self.shown(y);
        let (p, flow) = (&self.p, self.flow(t, y));
        let Flow { battery_a, battery_v, acceleration, .. } = flow;
        let (ocv, fast) = (self.open_circuit(y), self.is_fast());
        let mut slope = [0.0; STATES];
        slope[V] = acceleration;
        slope[RC] = if fast { 0.0 } else { (battery_a - y[RC] / p.rp) / p.c };
        let error = self.command.reference_at(t) - y[V];
        slope[INTEGRAL] = match &p.controller {
            Some(c) if self.limit == 0.0 => c.i * error,
            _ => 0.0,
        };
        slope[SOC] = -battery_a / (3600.0 * p.q_ah);
        slope[ENERGY] = ocv * battery_a / 3.6e6;
        slope[DISTANCE] = y[V] / 1000.0;
        let rc_w = if fast { p.rp * battery_a * battery_a } else { y[RC] * y[RC] / p.rp };
        let mut lost = p.rs * battery_a * battery_a
            + rc_w
            + p.load_s * battery_v * battery_v
            + self.command.auxiliary_w
            + (self.air(y[V]) + p.mass * G * self.command.sin) * y[V]
            + self.friction(y) * y[V].abs();
        for (n, d) in p.drives.iter().enumerate() {
            let (i, w) = (Self::currents(y, n), d.gear / p.radius * y[V]);
            lost += d.machine.lost(i, w) + (d.bm + d.machine.iron(i)) * w * w;
            [slope[CURRENTS + 2 * n], slope[CURRENTS + 2 * n + 1]] = flow.slopes[n];
        }
        slope[LOST] = lost / 3.6e6;
        slope
    }

    fn margin(&self, t: f64, y: &State) -> f64 {
        self.margins(t, y)
    }

    fn switch(&mut self, t: f64, y: &mut State) {
        self.switch_modes(t, y);
    }

    fn scale(&self) -> State {
        let mut scale = [1.0; STATES];
        scale[..CURRENTS].copy_from_slice(&[1e-2, 1e-3, 1e-2, 1e-2, 1e-2, 1.0, 1e-2]);
        scale
    }
}
