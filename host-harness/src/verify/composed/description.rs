//! What a composed vehicle is, and what it is told.

use super::MOST;
use super::machine::{Machine, Pair};

/// A PID of the speed error, with frozen integral at its limits.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    pub k: f64,
    pub i: f64,
    pub d: f64,
    pub min: f64,
    pub max: f64,
    /// Rate of the output's lag \[1/s\]; infinity for none.
    pub smoothing: f64,
}

/// A machine with its gearbox.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    pub machine: Machine,
    /// Rotor inertia and viscous friction.
    pub j: f64,
    pub bm: f64,
    /// Turns of the machine per turn of the wheel.
    pub gear: f64,
    /// Share of the torque that the gears rub away.
    pub gear_loss: f64,
    /// Rate of the ideal current loop \[1/s\].
    pub rate: f64,
}

/// A vehicle's parameters, in the symbols of the reference system.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    pub v_empty: f64,
    pub v_full: f64,
    pub q_ah: f64,
    pub rs: f64,
    pub rp: f64,
    pub c: f64,
    /// Resistor across the battery \[S\].
    pub load_s: f64,
    pub drives: &'static [Drive],
    pub radius: f64,
    pub mass: f64,
    pub area: f64,
    pub cd: f64,
    pub cr: f64,
    pub rho: f64,
    pub controller: Option<Controller>,
}

/// What a converter makes of the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Gates {
    /// Only the diodes conduct.
    #[default]
    Off,
    /// A share of the bus voltage: a duty, or both axes.
    Modulated(Pair),
    /// A voltage, as a sampled controller holds it.
    Volts(Pair),
    /// The currents of a torque \[N·m\] through an ideal loop: `di/dt = rate·(i* − i)`.
    Torque(f64),
    /// The controller's output is the duty.
    ControlledDuty,
    /// This share of the controller's output is the torque \[N·m\].
    ControlledTorque(f64),
}

/// What acts on a vehicle from one kink of its inputs to the next.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    pub gates: [Gates; MOST],
    /// When the reference begins \[s\].
    pub from_s: f64,
    /// Reference speed then \[m/s\].
    pub reference: f64,
    /// Its rate \[m/s²\].
    pub rate: f64,
    /// Sine of the slope.
    pub sin: f64,
    /// Friction brake \[N\].
    pub brake: f64,
    /// Auxiliary power \[W\].
    pub auxiliary_w: f64,
    /// Largest currents out of the battery, and into it \[A\].
    pub discharge_a: f64,
    pub charge_a: f64,
}

impl Default for Command {
    fn default() -> Self {
        Self {
            gates: [Gates::Off; MOST],
            from_s: 0.0,
            reference: 0.0,
            rate: 0.0,
            sin: 0.0,
            brake: 0.0,
            auxiliary_w: 0.0,
            discharge_a: f64::INFINITY,
            charge_a: f64::INFINITY,
        }
    }
}

impl Command {
    /// The reference speed.
    pub fn reference_at(&self, t: f64) -> f64 {
        self.reference + self.rate * (t - self.from_s)
    }
}
