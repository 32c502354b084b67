//! The continuous equations of the coupled vehicle, written once more from the reference system
//! (`EPowertrain2025`, errata applied) in double precision. Nothing here calls `plant-core`.
//!
//! Two lags are faster than all else by a factor of a thousand at least and are eliminated: an RC
//! branch with τ ≤ 1 µs acts as its resistance, and the PID's smoothing of 1 µs as the first term
//! of its series, `out = target − τ·d(target)/dt`. What that leaves out is of the order of
//! (τ·207 rad/s)² = 4e-8; a test integrates the lag itself and compares.

use super::adaptive::System;

/// Standard gravity \[m/s²\].
const G: f64 = 9.80665;
/// A lag below this is eliminated \[s\].
const FAST_S: f64 = 2e-6;

/// A PID from speed error to duty, with frozen integral at its limits.
#[derive(Clone, Copy, Debug)]
pub struct Controller {
    pub k: f64,
    pub i: f64,
    pub d: f64,
    pub min: f64,
    pub max: f64,
    pub smoothing: f64,
}

/// A vehicle's parameters, in the symbols of the reference system.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    pub v_empty: f64,
    pub v_full: f64,
    pub q_ah: f64,
    pub rs: f64,
    pub rp: f64,
    pub c: f64,
    /// Resistor across the battery \[S\].
    pub load_s: f64,
    pub rm: f64,
    pub lm: f64,
    pub ke: f64,
    pub kt: f64,
    pub bm: f64,
    pub j: f64,
    pub gear: f64,
    pub radius: f64,
    pub mass: f64,
    pub area: f64,
    pub cd: f64,
    pub cr: f64,
    pub rho: f64,
    pub pid: Controller,
}

/// Table 5.5 with the motor constants of the printed code.
pub const UDDS: Parameters = Parameters {
    v_empty: 500.0,
    v_full: 600.0,
    q_ah: 30.0,
    rs: 0.06,
    rp: 1e-3,
    c: 1e-6,
    load_s: 0.0,
    rm: 0.025,
    lm: 1e-3,
    ke: 1.4,
    kt: 1.4,
    bm: 4.21e-6,
    j: 3.87e-7,
    gear: 1.0,
    radius: 0.25,
    mass: 1500.0,
    area: 2.2,
    cd: 0.29,
    cr: 0.009,
    rho: 1.2,
    pid: Controller {
        k: 20.0,
        i: 0.1,
        d: 0.0,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        smoothing: 1e6,
    },
};

/// Table 5.5 to the letter.
pub const UDDS_TABLE: Parameters = Parameters { ke: 0.65, kt: 0.65, ..UDDS };

/// Table 5.6.
pub const I3: Parameters = Parameters {
    v_empty: 343.22,
    v_full: 399.8,
    q_ah: 60.0,
    rs: 0.1051,
    rp: 1.7834e-4,
    c: 9532.9,
    load_s: 1.0 / 80.4765,
    rm: 1.72,
    lm: 106.26e-6,
    ke: 0.7144,
    kt: 0.72,
    bm: 5e-4,
    j: 0.031,
    gear: 6.0,
    radius: 0.29,
    mass: 1280.0,
    area: 2.38,
    cd: 0.29,
    cr: 0.0084,
    rho: 1.225,
    pid: Controller { k: 0.5, i: 0.005, d: 0.1, min: -0.5, max: 1.0, smoothing: 1e6 },
};

/// What drives the vehicle from one kink of its inputs to the next.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stretch {
    /// When it begins \[s\].
    pub from_s: f64,
    /// Reference speed then \[m/s\].
    pub reference: f64,
    /// Its rate \[m/s²\].
    pub rate: f64,
    /// Sine of the slope.
    pub sin: f64,
    /// Auxiliary power \[W\].
    pub auxiliary_w: f64,
}

impl Stretch {
    /// The reference speed.
    pub fn reference_at(&self, t: f64) -> f64 {
        self.reference + self.rate * (t - self.from_s)
    }
}

/// The states, in the order of the vector.
pub const STATES: usize = 7;
/// Winding current \[A\].
pub const I: usize = 0;
/// Speed \[m/s\].
pub const V: usize = 1;
/// Voltage of the RC branch \[V\].
pub const RC: usize = 2;
/// The PID's integral.
pub const INTEGRAL: usize = 3;
/// State of charge.
pub const SOC: usize = 4;
/// Energy at the open-circuit voltage \[kWh\].
pub const ENERGY: usize = 5;
/// Distance \[km\].
pub const DISTANCE: usize = 6;

/// The vehicle in its present mode.
#[derive(Clone, Copy, Debug)]
pub struct Vehicle {
    pub p: Parameters,
    pub stretch: Stretch,
    /// The sign of the speed; 0 at standstill.
    direction: f64,
    /// −1 at the lower limit of the duty, 1 at the upper, 0 between.
    limit: f64,
}

impl Vehicle {
    /// At rest.
    pub fn new(p: Parameters) -> Self {
        Self { p, stretch: Stretch::default(), direction: 0.0, limit: 0.0 }
    }

    /// At a speed.
    pub fn moving(p: Parameters, speed: f64) -> Self {
        let direction = if speed == 0.0 { 0.0 } else { speed.signum() };
        Self { direction, ..Self::new(p) }
    }

    /// The state at rest.
    pub fn at_rest(soc: f64) -> [f64; STATES] {
        let mut y = [0.0; STATES];
        y[SOC] = soc;
        y
    }

    /// Air-gap torque \[N·m\].
    pub fn torque(&self, y: &[f64; STATES]) -> f64 {
        self.p.kt * y[I]
    }

    /// Battery current \[A\].
    pub fn battery_a(&self, t: f64, y: &[f64; STATES]) -> f64 {
        self.electric(self.duty(t, y), y).0
    }

    fn rolling(&self) -> f64 {
        let sin = self.stretch.sin;
        self.p.cr * self.p.mass * G * (1.0 - sin * sin).sqrt()
    }

    /// Force at the road without rolling resistance \[N\].
    fn force(&self, y: &[f64; STATES]) -> f64 {
        let p = &self.p;
        let (i, v, k) = (y[I], y[V], p.gear / p.radius);
        k * p.kt * i
            - 0.5 * p.rho * p.cd * p.area * v * v.abs()
            - p.bm * k * k * v
            - p.mass * G * self.stretch.sin
    }

    fn acceleration(&self, y: &[f64; STATES]) -> f64 {
        if self.direction == 0.0 {
            return 0.0;
        }
        let p = &self.p;
        let k = p.gear / p.radius;
        (self.force(y) - self.direction * self.rolling()) / (p.mass + p.j * k * k)
    }

    /// The PID's raw output.
    fn raw(&self, t: f64, y: &[f64; STATES]) -> f64 {
        let pid = &self.p.pid;
        let rate = if pid.d > 0.0 { self.stretch.rate - self.acceleration(y) } else { 0.0 };
        pid.k * (self.stretch.reference_at(t) - y[V]) + y[INTEGRAL] + pid.d * rate
    }

    /// What the PID's output follows.
    pub fn target(&self, t: f64, y: &[f64; STATES]) -> f64 {
        let pid = &self.p.pid;
        if self.limit == 0.0 {
            self.raw(t, y)
        } else if self.limit > 0.0 {
            pid.max
        } else {
            pid.min
        }
    }

    fn duty(&self, t: f64, y: &[f64; STATES]) -> f64 {
        let (target, pid) = (self.target(t, y), &self.p.pid);
        if self.limit != 0.0 || pid.d > 0.0 {
            return target;
        }
        let error = self.stretch.reference_at(t) - y[V];
        let rate = pid.k * (self.stretch.rate - self.acceleration(y)) + pid.i * error;
        target - rate / pid.smoothing
    }

    /// Battery current and terminal voltage under a duty.
    fn electric(&self, duty: f64, y: &[f64; STATES]) -> (f64, f64) {
        let p = &self.p;
        let fast = p.rp * p.c < FAST_S;
        let (r, slow_v) = if fast { (p.rs + p.rp, 0.0) } else { (p.rs, y[RC]) };
        let emf = p.v_empty + (p.v_full - p.v_empty) * y[SOC] - slow_v;
        // V = emf − r·(D·i + V/R + P/V): a quadratic in V.
        let a = 1.0 + r * p.load_s;
        let b = emf - r * duty * y[I];
        let v = (b + (b * b - 4.0 * a * r * self.stretch.auxiliary_w).sqrt()) / (2.0 * a);
        (duty * y[I] + p.load_s * v + self.stretch.auxiliary_w / v, v)
    }

    fn friction_margin(&self, y: &[f64; STATES]) -> f64 {
        if self.direction == 0.0 {
            self.rolling() - self.force(y).abs()
        } else {
            self.direction * y[V]
        }
    }

    fn limit_margin(&self, t: f64, y: &[f64; STATES]) -> f64 {
        let (raw, pid) = (self.raw(t, y), &self.p.pid);
        if self.limit > 0.0 {
            raw - pid.max
        } else if self.limit < 0.0 {
            pid.min - raw
        } else {
            (pid.max - raw).min(raw - pid.min)
        }
    }
}

impl System<STATES> for Vehicle {
    fn slope(&self, t: f64, y: &[f64; STATES]) -> [f64; STATES] {
        self.slope_at(self.duty(t, y), t, y)
    }

    fn margin(&self, t: f64, y: &[f64; STATES]) -> f64 {
        self.friction_margin(y).min(self.limit_margin(t, y))
    }

    fn switch(&mut self, t: f64, y: &mut [f64; STATES]) {
        if self.friction_margin(y) < 0.0 {
            let force = self.at_standstill(y);
            self.direction = if force.abs() <= self.rolling() { 0.0 } else { force.signum() };
        }
        if self.limit_margin(t, y) < 0.0 {
            let (raw, pid) = (self.raw(t, y), &self.p.pid);
            self.limit = f64::from(i8::from(raw >= pid.max) - i8::from(raw <= pid.min));
        }
    }

    fn scale(&self) -> [f64; STATES] {
        [1.0, 1e-2, 1e-3, 1e-2, 1e-2, 1e-2, 1.0]
    }
}

impl Vehicle {
    /// `dy/dt` under a duty.
    pub fn slope_at(&self, duty: f64, t: f64, y: &[f64; STATES]) -> [f64; STATES] {
        let p = &self.p;
        let (battery_a, battery_v) = self.electric(duty, y);
        let back_emf = p.ke * p.gear / p.radius * y[V];
        let fast = p.rp * p.c < FAST_S;
        let ocv = p.v_empty + (p.v_full - p.v_empty) * y[SOC];
        let error = self.stretch.reference_at(t) - y[V];
        [
            (duty * battery_v - p.rm * y[I] - back_emf) / p.lm,
            self.acceleration(y),
            if fast { 0.0 } else { (battery_a - y[RC] / p.rp) / p.c },
            if self.limit == 0.0 { p.pid.i * error } else { 0.0 },
            -battery_a / (3600.0 * p.q_ah),
            ocv * battery_a / 3.6e6,
            y[V] / 1000.0,
        ]
    }

    /// Stops the vehicle; the force that is then left.
    fn at_standstill(&self, y: &mut [f64; STATES]) -> f64 {
        if self.direction != 0.0 {
            y[V] = 0.0;
        }
        self.force(y)
    }
}
