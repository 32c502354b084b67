//! An adaptive solver in double precision, for what the fixed step is measured against: the method
//! of Dormand and Prince of order 5 (`DormandPrince1980`) with its error estimate and interpolant
//! (Hairer1993, section II.6).
//!
//! It restarts at each kink of the input and stops where a system changes its mode (standstill,
//! saturation). It is our own because no crate did: `diffsol` brings a whole linear algebra library
//! (faer) into the command for a system of seven; in `differential-equations` 0.7.0 the Radau
//! method steps with a stale factorisation after a rejected step, and the interpolant of its
//! Dormand–Prince 8(5,3) is wrong between the ends of a step; `ode_solvers` cannot stop at an
//! event. Two lags that are faster than all else are eliminated in the equations (`composed`), so
//! no stiff method is needed.

use anyhow::{bail, ensure};

/// An event is located to this \[s\].
const EVENT_S: f64 = 1e-12;
/// More events between two kinks are a fault of the equations.
const MOST_EVENTS: u32 = 10_000;
/// A shorter step means that the solution has a jump or a pole \[s\].
const SHORTEST_S: f64 = 1e-14;
/// The first step after a kink, as a share of the time to the next.
const FIRST_STEP: f64 = 1e-4;

/// Nodes, then the rows of the tableau; the last row is the solution.
const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// The solution less that of order 4.
const E: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
/// The interpolant's last term.
const D: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

/// A system of ordinary differential equations whose right-hand side has modes.
pub trait System<const N: usize> {
    /// `dy/dt` in the present mode.
    fn slope(&self, t: f64, y: &[f64; N]) -> [f64; N];

    /// The present mode holds while this is ≥ 0.
    fn margin(&self, _t: f64, _y: &[f64; N]) -> f64 {
        1.0
    }

    /// Changes the mode where the margin is below zero; may project the state.
    fn switch(&mut self, _t: f64, _y: &mut [f64; N]) {}

    /// The size of each state: its error is held to the tolerance times this, or times itself.
    fn scale(&self) -> [f64; N];
}

/// One step that was made: from `t` over `h`, the slopes at its stages.
struct Made<const N: usize> {
    t: f64,
    h: f64,
    from: [f64; N],
    to: [f64; N],
    k: [[f64; N]; 7],
}

impl<const N: usize> Made<N> {
    fn new<S: System<N>>(system: &S, t: f64, h: f64, from: [f64; N], slope: [f64; N]) -> Self {
        let mut made = Self { t, h, from, to: from, k: [slope; 7] };
        for stage in 1..7 {
            made.to = std::array::from_fn(|i| {
                let sum: f64 = (0..stage).map(|j| A[stage][j] * made.k[j][i]).sum();
                from[i] + h * sum
            });
            made.k[stage] = system.slope(t + C[stage] * h, &made.to);
        }
        made
    }

    /// The error over what is tolerated: 1 is just acceptable.
    #[expect(clippy::cast_precision_loss, reason = "a handful of states")]
    fn error(&self, tolerance: f64, scale: &[f64; N]) -> f64 {
        let squares: f64 = (0..N)
            .map(|i| {
                let error: f64 = self.h * (0..7).map(|j| E[j] * self.k[j][i]).sum::<f64>();
                let size = scale[i] + self.from[i].abs().max(self.to[i].abs());
                (error / (tolerance * size)).powi(2)
            })
            .sum();
        (squares / N as f64).sqrt()
    }

    /// The solution within the step.
    fn at(&self, t: f64) -> [f64; N] {
        let s = (t - self.t) / self.h;
        let r = 1.0 - s;
        std::array::from_fn(|i| {
            let gain = self.to[i] - self.from[i];
            let start = self.h * self.k[0][i] - gain;
            let end = gain - self.h * self.k[6][i] - start;
            let last: f64 = self.h * (0..7).map(|j| D[j] * self.k[j][i]).sum::<f64>();
            self.from[i] + s * (gain + r * (start + s * (end + r * last)))
        })
    }
}

/// Sample times, `period_s` apart.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Time between two samples \[s\].
    pub period_s: f64,
    /// How many were taken.
    pub taken: u64,
}

impl Clock {
    /// From time zero on; the sample at zero is not taken.
    pub const fn new(period_s: f64) -> Self {
        Self { period_s, taken: 0 }
    }

    /// No sample at all.
    pub const fn never() -> Self {
        Self::new(1e30)
    }

    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    fn next_s(&self) -> f64 {
        (self.taken + 1) as f64 * self.period_s
    }
}

/// Integrates from one kink to the next and gives `sample` the state at each sample time.
pub fn integrate<const N: usize, S: System<N>>(
    system: &mut S,
    y: &mut [f64; N],
    (from_s, to_s): (f64, f64),
    tolerance: f64,
    clock: &mut Clock,
    mut sample: impl FnMut(f64, &[f64; N], &S),
) -> anyhow::Result<()> {
    let (mut t, mut events) = (from_s, 0);
    let scale = system.scale();
    if system.margin(t, y) < 0.0 {
        system.switch(t, y);
    }
    let mut slope = system.slope(t, y);
    let mut h = FIRST_STEP * (to_s - from_s);
    while to_s - t > EVENT_S {
        // The last step ends at the kink exactly, with no sliver left over.
        let last = t + h >= to_s - EVENT_S;
        let made = Made::new(system, t, if last { to_s - t } else { h }, *y, slope);
        let error = made.error(tolerance, &scale);
        let factor = (0.9 * error.powf(-0.2)).clamp(0.2, 5.0);
        if error > 1.0 || error.is_nan() {
            h = made.h * if error.is_nan() { 0.2 } else { factor };
            ensure!(
                h > SHORTEST_S * t.abs().max(1.0),
                "the adaptive step shrank to {h} s at {t} s"
            );
            continue;
        }
        let mut until = if last { to_s } else { t + made.h };
        let mut there = made.to;
        let switches = system.margin(until, &there) < 0.0;
        if switches {
            until = crossing(system, &made, until);
            there = made.at(until);
        }
        while clock.next_s() <= until + 1e-9 * clock.period_s {
            let at = clock.next_s();
            sample(at, &made.at(at.min(until)), system);
            clock.taken += 1;
        }
        (t, *y) = (until, there);
        if switches {
            events += 1;
            if events > MOST_EVENTS {
                bail!("more than {MOST_EVENTS} events between {from_s} s and {to_s} s");
            }
            system.switch(t, y);
            slope = system.slope(t, y);
            h = made.h.min(FIRST_STEP * (to_s - from_s));
        } else {
            slope = made.k[6];
            // What the kink cut off says nothing about the next step.
            h = made.h * factor;
        }
    }
    Ok(())
}

/// When the margin falls below zero within a step: just after.
fn crossing<const N: usize, S: System<N>>(system: &S, made: &Made<N>, until: f64) -> f64 {
    let (mut good, mut bad) = (made.t, until);
    while bad - good > EVENT_S {
        let middle = 0.5 * (good + bad);
        if middle <= good || middle >= bad {
            break;
        }
        if system.margin(middle, &made.at(middle)) < 0.0 {
            bad = middle;
        } else {
            good = middle;
        }
    }
    bad
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring; with friction it has modes.
    struct Spring {
        friction: f64,
        direction: f64,
    }

    impl System<2> for Spring {
        fn slope(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
            if self.direction == 0.0 {
                [0.0, 0.0]
            } else {
                [y[1], -y[0] - self.friction * self.direction]
            }
        }

        fn margin(&self, _t: f64, y: &[f64; 2]) -> f64 {
            if self.direction == 0.0 { 1.0 } else { self.direction * y[1] }
        }

        fn switch(&mut self, _t: f64, y: &mut [f64; 2]) {
            y[1] = 0.0;
            self.direction = if y[0].abs() <= self.friction { 0.0 } else { -y[0].signum() };
        }

        fn scale(&self) -> [f64; 2] {
            [1.0, 1.0]
        }
    }

    #[test]
    fn a_free_oscillation_is_a_sine_at_every_sample() {
        let (mut spring, mut y) = (Spring { friction: 0.0, direction: 1.0 }, [0.0, 1.0]);
        let (mut clock, mut worst) = (Clock::new(0.01), 0.0_f64);
        // It turns round three times; each is an event, between kinks or not.
        for k in 0..10 {
            let span = (f64::from(k), f64::from(k + 1));
            integrate(&mut spring, &mut y, span, 1e-11, &mut clock, |t, y, _| {
                worst = worst.max((y[0] - t.sin()).abs());
            })
            .unwrap();
        }
        assert!(worst < 1e-9, "{worst}");
        assert_eq!(clock.taken, 1000);
    }

    #[test]
    fn dry_friction_takes_its_share_of_each_swing_and_holds() {
        // Each half swing loses 2·F: 1 → −0.6 → 0.2, within ±0.2 it sticks.
        let (mut spring, mut y) = (Spring { friction: 0.2, direction: -1.0 }, [1.0, -1e-300]);
        let mut clock = Clock::new(1.0);
        integrate(&mut spring, &mut y, (0.0, 20.0), 1e-10, &mut clock, |_, _, _| {}).unwrap();
        assert!((y[0].abs() - 0.2).abs() < 1e-6 && y[1] == 0.0, "{y:?}");
    }

    #[test]
    fn one_step_is_of_order_5_and_its_interpolant_of_order_4() {
        let spring = Spring { friction: 0.0, direction: 1.0 };
        let off = |h: f64, s: f64| {
            let (sin, cos) = 0.7_f64.sin_cos();
            let made = Made::new(&spring, 0.7, h, [sin, cos], [cos, -sin]);
            (made.at(0.7 + s * h)[0] - (0.7 + s * h).sin()).abs()
        };
        for (s, order) in [(1.0, 6.0), (0.37, 5.0)] {
            let found = (off(0.2, s) / off(0.1, s)).log2();
            assert!((found - order).abs() < 0.3, "at {s}: {found}");
        }
    }

    #[test]
    fn a_pole_is_an_error() {
        struct Pole;
        impl System<1> for Pole {
            fn slope(&self, _t: f64, y: &[f64; 1]) -> [f64; 1] {
                [y[0] * y[0]]
            }
            fn scale(&self) -> [f64; 1] {
                [1.0]
            }
        }
        let mut clock = Clock::never();
        let result = integrate(&mut Pole, &mut [1.0], (0.0, 2.0), 1e-9, &mut clock, |_, _, _| {});
        assert!(result.unwrap_err().to_string().contains("shrank"));
    }
}
