//! An adaptive solver in double precision, for what the fixed step is measured against.
//!
//! Explicit Runge–Kutta of order 8 (Dormand–Prince 8(5,3)) from the crate `differential-equations`,
//! driven here so that it restarts at each kink of the input and stops where a system changes its
//! mode (standstill, saturation). `diffsol` was considered: it builds a whole linear algebra
//! library (faer) into the command, and its methods are of order 5 at most, 1 after each of 1369
//! restarts. The Radau method of the crate used keeps a stale factorisation after a rejected
//! step, so the two lags that are faster than anything else are eliminated in the equations
//! (`equations`), and no stiff method is needed.

use anyhow::{anyhow, ensure};
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};

/// An event is located to this \[s\].
const EVENT_S: f64 = 1e-12;
/// More events between two kinks are a fault of the equations.
const MOST_EVENTS: usize = 10_000;
/// More steps between two kinks are one, too.
const MOST_STEPS: usize = 100_000_000;

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

/// The right-hand side for the crate.
struct Slope<'a, S>(&'a S);

impl<const N: usize, S: System<N>> ODE<f64, [f64; N]> for Slope<'_, S> {
    fn diff(&self, t: f64, y: &[f64; N], dydt: &mut [f64; N]) {
        *dydt = self.0.slope(t, y);
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
    let mut t = from_s;
    let failed = |e| anyhow!("the adaptive solver failed: {e:?}");
    for _ in 0..MOST_EVENTS {
        if system.margin(t, y) < 0.0 {
            system.switch(t, y);
        }
        let mut method = ExplicitRungeKutta::dop853()
            .rtol(tolerance)
            .atol(system.scale().map(|scale| scale * tolerance))
            .max_steps(MOST_STEPS);
        method.init(&Slope(system), t, to_s, y).map_err(failed)?;
        let mut event = None;
        while event.is_none() && method.t() < to_s {
            let before = method.t();
            let left = to_s - before;
            if method.h() > left {
                method.set_h(left);
            }
            method.step(&Slope(system)).map_err(failed)?;
            if method.t() == before {
                continue; // rejected; it tries again with a shorter step
            }
            if to_s - method.t() < EVENT_S {
                // What rounding left over is no step.
                let (t, y) = (method.t(), *method.y());
                event = (system.margin(t, &y) < 0.0).then_some((t, y));
                take(clock, t.max(to_s), &mut method, to_s, |t, y| sample(t, y, system))?;
                break;
            }
            let mut until = method.t();
            if system.margin(until, method.y()) < 0.0 {
                let (mut good, mut bad) = (before, until);
                while bad - good > EVENT_S {
                    let middle = 0.5 * (good + bad);
                    if middle <= good || middle >= bad {
                        break;
                    }
                    let there = method.interpolate(middle).map_err(failed)?;
                    if system.margin(middle, &there) < 0.0 {
                        bad = middle;
                    } else {
                        good = middle;
                    }
                }
                until = bad;
                event = Some((bad, method.interpolate(bad).map_err(failed)?));
            }
            take(clock, until, &mut method, until, |t, y| sample(t, y, system))?;
        }
        let Some((at, there)) = event else {
            *y = *method.y();
            ensure!(y.iter().all(|x| x.is_finite()), "the adaptive solution diverged at {t} s");
            return Ok(());
        };
        (t, *y) = (at, there);
        system.switch(t, y);
        if to_s - t < EVENT_S {
            return Ok(());
        }
    }
    Err(anyhow!("more than {MOST_EVENTS} events between {from_s} s and {to_s} s"))
}

/// Samples up to `until_s`, from the interpolant of the step that was just made.
fn take<const N: usize, M>(
    clock: &mut Clock,
    until_s: f64,
    method: &mut M,
    end_s: f64,
    mut sample: impl FnMut(f64, &[f64; N]),
) -> anyhow::Result<()>
where
    M: OrdinaryNumericalMethod<f64, [f64; N]> + Interpolation<f64, [f64; N]>,
{
    while clock.next_s() <= until_s + 1e-9 * clock.period_s {
        let at = clock.next_s().min(end_s);
        let within = at.clamp(method.t_prev(), method.t());
        let y = method.interpolate(within).map_err(|e| anyhow!("interpolation: {e:?}"))?;
        sample(at, &y);
        clock.taken += 1;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring; with friction it has modes.
    struct Spring {
        friction: f64,
        way: f64,
    }

    impl System<2> for Spring {
        fn slope(&self, _t: f64, y: &[f64; 2]) -> [f64; 2] {
            if self.way == 0.0 { [0.0, 0.0] } else { [y[1], -y[0] - self.friction * self.way] }
        }

        fn margin(&self, _t: f64, y: &[f64; 2]) -> f64 {
            if self.way == 0.0 { 1.0 } else { self.way * y[1] }
        }

        fn switch(&mut self, _t: f64, y: &mut [f64; 2]) {
            y[1] = 0.0;
            self.way = if y[0].abs() <= self.friction { 0.0 } else { -y[0].signum() };
        }

        fn scale(&self) -> [f64; 2] {
            [1.0, 1.0]
        }
    }

    #[test]
    fn a_free_oscillation_is_a_sine_at_every_sample() {
        let (mut spring, mut y) = (Spring { friction: 0.0, way: 1.0 }, [0.0, 1.0]);
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
        let (mut spring, mut y) = (Spring { friction: 0.2, way: -1.0 }, [1.0, -1e-300]);
        let mut clock = Clock::new(1.0);
        integrate(&mut spring, &mut y, (0.0, 20.0), 1e-10, &mut clock, |_, _, _| {}).unwrap();
        assert!((y[0].abs() - 0.2).abs() < 1e-6 && y[1] == 0.0, "{y:?}");
    }
}
