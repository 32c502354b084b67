//! The controller part by part, and all of it against its rules in double precision.

extern crate std;
use super::*;

const BASE: PidParams = PidParams { proportional: 2.0, integral_per_s: 1.0, ..PidParams::DEFAULT };
const LIMITED: PidParams = PidParams { output_min: -0.5, output_max: 1.0, ..BASE };

fn pid(params: PidParams) -> Pid {
    Pid::new(params, Dt::from_s(0.01).unwrap()).unwrap()
}

fn error(e: Real) -> PidInput {
    PidInput { reference: e, measurement: 0.0 }
}

fn run(p: &Pid, s: &mut PidState, e: Real, steps: u32) -> PidOutput {
    let mut out = p.step(s, error(e));
    for _ in 1..steps {
        out = p.step(s, error(e));
    }
    out
}

#[test]
fn adds_its_three_parts() {
    let p = pid(PidParams { derivative_s: 0.5, ..BASE });
    let mut s = PidState::default();
    assert!((run(&p, &mut s, 0.1, 1).raw - 0.2).abs() < 1e-6, "no kick at the first step");
    // P 2·0.2, I one step of 1·0.1·0.01, D 0.5·0.1/0.01
    assert!((p.step(&mut s, error(0.2)).raw - (0.4 + 0.001 + 5.0)).abs() < 1e-5);
}

#[test]
fn freeze_and_directional_differ_where_the_error_points_back() {
    for (anti_windup, falls) in [(AntiWindup::Freeze, false), (AntiWindup::Directional, true)] {
        let p = pid(PidParams { anti_windup, ..LIMITED });
        let mut s = PidState { integral: Accum::new(3.0), ..PidState::default() };
        assert!(run(&p, &mut s, 1.0, 100).saturated);
        assert_eq!(s.integral(), 3.0, "further into saturation: neither");
        run(&p, &mut s, -0.5, 100);
        assert_eq!(s.integral() < 3.0, falls, "{anti_windup:?}");
    }
}

#[test]
fn a_saturation_further_down_the_loop_stops_the_integral() {
    let (p, mut s) = (pid(BASE), PidState::default());
    run(&p, &mut s, 1.0, 10);
    let before = s.integral();
    for _ in 0..10 {
        p.feed_back(&mut s, 0.3);
        p.step(&mut s, error(1.0));
    }
    assert_eq!(s.integral(), before);
    p.feed_back(&mut s, 0.3);
    p.step(&mut s, error(-1.0));
    assert!(s.integral() < before);
}

#[test]
fn limits_hold_and_a_dead_zone_silences() {
    let (p, mut s) = (pid(LIMITED), PidState::default());
    assert!((run(&p, &mut s, 5.0, 10).output - 1.0).abs() < 1e-4);
    assert!((run(&p, &mut s, -5.0, 10).output + 0.5).abs() < 1e-4);
    let (p, mut s) = (pid(PidParams { dead_zone: 0.1, ..BASE }), PidState::default());
    let out = run(&p, &mut s, 0.04, 100);
    assert!(out.output == 0.0 && s.integral() == 0.0);
    assert!(run(&p, &mut s, 0.06, 1).output > 0.1);
}

#[test]
fn smoothing_is_a_lag_that_never_rings() {
    let p = pid(PidParams { smoothing_per_s: 10.0, integral_per_s: 0.0, ..BASE });
    let mut s = PidState::default();
    let out = run(&p, &mut s, 1.0, 10).output;
    let exact = 2.0 * (1.0 - Real::powi(1.0 / 1.1, 10));
    assert!((out - exact).abs() < 1e-5);
    let (p, mut s) = (pid(BASE), PidState::default());
    assert!(run(&p, &mut s, 1.0, 1).output < 2.0, "k < 1 at 1e6 1/s");
    let at_once = PidParams { smoothing_per_s: Real::INFINITY, ..BASE };
    let (p, mut s) = (pid(at_once), PidState::default());
    assert_eq!(run(&p, &mut s, 1.0, 1).output, 2.0);
}

#[test]
fn the_derivative_on_measurement_does_not_kick_and_its_filter_smooths() {
    let base = PidParams { derivative_s: 1.0, integral_per_s: 0.0, ..BASE };
    let kick = |params| {
        let (p, mut s) = (pid(params), PidState::default());
        p.step(&mut s, error(0.0));
        p.step(&mut s, error(1.0)).raw - 2.0
    };
    let on_measurement = PidParams { derivative_of: DerivativeOf::Measurement, ..base };
    assert_eq!(kick(on_measurement), 0.0);
    assert!((kick(base) - 100.0).abs() < 1e-3);
    let filtered = kick(PidParams { derivative_filter_s: 0.09, ..base });
    assert!((filtered - 10.0).abs() < 1e-3, "{filtered}");
}

#[test]
fn preload_is_bumpless_and_reset_forgets() {
    let (p, mut s) = (pid(LIMITED), PidState::default());
    p.preload(&mut s, 0.7, error(0.1));
    let out = p.step(&mut s, error(0.1));
    assert!((out.output - 0.7).abs() < 1e-5, "{}", out.output);
    s.reset();
    assert_eq!(s, PidState::default());
    for (output, reference, measurement) in [
        (Real::NAN, 0.1, 0.0),
        (0.7, Real::INFINITY, 0.0),
        (0.7, 0.9e9, 0.9e9), // their difference would do
        (0.9e9, 0.0, 0.9e9),
    ] {
        p.preload(&mut s, output, PidInput { reference, measurement });
        assert_eq!(s, PidState::default(), "{output} {reference} {measurement}");
    }
}

#[test]
fn bad_input_changes_nothing() {
    let (p, mut s) = (pid(BASE), PidState::default());
    run(&p, &mut s, 0.3, 5);
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, 1e38] {
        for (reference, measurement) in [(bad, 0.0), (0.0, bad)] {
            let out = p.step(&mut s, PidInput { reference, measurement });
            assert!(out.rejected && out.output == before.output() && s == before);
        }
    }
}

/// The difference of two absurd values, or what a saturation hides, would do.
#[test]
fn what_would_cancel_is_refused() {
    let (p, mut s) = (pid(LIMITED), PidState::default());
    let absurd = PidInput { reference: 0.9e9, measurement: 0.9e9 };
    assert!(p.step(&mut s, absurd).rejected && s == PidState::default());
    assert!(p.step_fed_back(&mut s, error(0.0), 1.1e9, false).rejected && s == PidState::default());
}

#[test]
fn a_frozen_one_does_not_look_further_down_the_loop() {
    for (anti_windup, runs) in [(AntiWindup::Freeze, true), (AntiWindup::Directional, false)] {
        let p = pid(PidParams { anti_windup, ..LIMITED });
        for case in 0..3 {
            let mut s = PidState::default();
            p.step(&mut s, error(0.2));
            let before = s.integral();
            match case {
                0 => p.feed_back(&mut s, 0.1),
                1 => p.saturate(&mut s, 1.0),
                _ => _ = p.step_fed_back(&mut s, error(0.2), 0.1, true),
            }
            if case < 2 {
                p.step(&mut s, error(0.2));
            }
            assert_eq!(s.integral() > before, runs, "{anti_windup:?} {case}");
        }
    }
}

/// A first-order process behind a timer with 100 or 1000 counts.
#[test]
fn a_rounded_output_is_no_saturation() {
    let limits = PidParams { output_min: -1.0, output_max: 1.0, ..BASE };
    for params in [limits, BASE] {
        let p = pid(PidParams { proportional: 0.5, smoothing_per_s: Real::INFINITY, ..params });
        for (counts, off) in [(100.0, 0.01), (1000.0, 0.001)] {
            for round in [Real::floor, Real::round] {
                let (mut s, mut y) = (PidState::default(), 0.0);
                for _ in 0..5000 {
                    let input = PidInput { reference: 0.5, measurement: y };
                    let applied = round(p.step(&mut s, input).output * counts) / counts;
                    p.feed_back(&mut s, applied);
                    y += 0.01 * (applied - 0.2 - y);
                }
                assert!((y - 0.5).abs() <= off, "{counts}: {y}");
            }
        }
    }
    // In proportion to the limits.
    let p = pid(PidParams { output_min: 0.0, output_max: 400.0, ..BASE });
    for (applied, held_back) in [(197.0, false), (196.0, true), (203.0, false), (204.0, true)] {
        let mut s = PidState { output: Accum::new(200.0), ..PidState::default() };
        p.feed_back(&mut s, applied);
        assert_eq!(s.excess != 0.0, held_back, "{applied}");
    }
}

#[test]
fn what_it_was_told_counts_for_one_step() {
    let (p, mut s) = (pid(BASE), PidState::default());
    p.step(&mut s, error(0.1));
    p.feed_back(&mut s, 0.0);
    run(&p, &mut s, 0.1, 501);
    assert!((s.integral() - 0.501).abs() < 1e-4, "{}", s.integral());
}

#[test]
fn an_integral_grown_absurd_still_shrinks() {
    for anti_windup in [AntiWindup::Freeze, AntiWindup::Directional] {
        for integral_per_s in [1e6, 1e12] {
            let p = pid(PidParams { integral_per_s, anti_windup, ..PidParams::DEFAULT });
            let mut s = PidState::default();
            let out = run(&p, &mut s, 1e3, 300);
            assert!(out.saturated && !out.rejected && out.output <= LARGEST);
            let before = s.integral();
            assert!(before.is_finite() && before >= 0.99 * LARGEST);
            assert!(!p.step(&mut s, error(-1e3)).rejected && s.integral() < before);
        }
    }
}

#[test]
fn neither_preload_nor_dead_zone_leaves_the_limits() {
    let (p, mut s) = (pid(LIMITED), PidState::default());
    p.preload(&mut s, 5.0, error(0.1));
    assert!((p.step(&mut s, error(0.1)).output - 1.0).abs() < 1e-5);
    assert!(run(&p, &mut s, -0.1, 2).output < 0.9, "not latched");
    let at_once = PidParams { smoothing_per_s: Real::INFINITY, dead_zone: 0.05, ..BASE };
    for (output_min, output_max, silent) in [(0.2, 1.0, 0.2), (-1.0, -0.3, -0.3)] {
        let p = pid(PidParams { output_min, output_max, ..at_once });
        assert_eq!(run(&p, &mut PidState::default(), 0.001, 1).output, silent);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| Pid::new(p, Dt::from_s(0.01).unwrap()).unwrap_err();
    let bad = Real::NAN;
    for (params, field) in [
        (PidParams { proportional: bad, ..BASE }, "pid.proportional"),
        (PidParams { integral_per_s: bad, ..BASE }, "pid.integral_per_s"),
        (PidParams { derivative_s: -1.0, ..BASE }, "pid.derivative_s"),
        (PidParams { derivative_filter_s: -1.0, ..BASE }, "pid.derivative_filter_s"),
        (PidParams { dead_zone: -1.0, ..BASE }, "pid.dead_zone"),
        (PidParams { output_min: bad, ..BASE }, "pid.output_min"),
        (PidParams { output_min: 2.0, output_max: 1.0, ..BASE }, "pid.output_max"),
        (PidParams { output_max: bad, ..BASE }, "pid.output_max"),
        (PidParams { smoothing_per_s: 0.0, ..BASE }, "pid.smoothing_per_s"),
    ] {
        assert_eq!(refused(params).field(), field);
    }
}

/// The rules of [`Pid`] once more, in double precision.
struct Rules {
    p: PidParams,
    h: f64,
    integral: f64,
    output: f64,
    last: Option<f64>,
    difference: f64,
    excess: f64,
}

impl Rules {
    fn step(&mut self, reference: f64, measurement: f64) -> (f64, f64, bool) {
        let p = self.p;
        let [k, i, d, filter_s, low, high] = [
            p.proportional,
            p.integral_per_s,
            p.derivative_s,
            p.derivative_filter_s,
            p.output_min,
            p.output_max,
        ]
        .map(f64::from);
        let error = reference - measurement;
        let now = if p.derivative_of == DerivativeOf::Error { error } else { -measurement };
        let before = self.last.unwrap_or(now);
        self.last = Some(now);
        let smooth =
            if filter_s > 0.0 { (self.h / filter_s) / (1.0 + self.h / filter_s) } else { 1.0 };
        self.difference += smooth * (now - before - self.difference);
        let raw = k * error + self.integral + d / self.h * self.difference;
        let dead = raw.abs() < f64::from(p.dead_zone);
        let directional = p.anti_windup == AntiWindup::Directional;
        let excess = std::mem::take(&mut self.excess);
        let up = raw >= high || directional && excess > 0.0;
        let down = raw <= low || directional && excess < 0.0;
        let held = if directional { up && error > 0.0 || down && error < 0.0 } else { up || down };
        if !dead && !held {
            self.integral += i * self.h * error;
        }
        let target = if dead { 0.0_f64 } else { raw }.clamp(low, high);
        let rate = self.h * f64::from(p.smoothing_per_s);
        self.output +=
            if rate.is_finite() { rate / (1.0 + rate) } else { 1.0 } * (target - self.output);
        (self.output, raw, raw >= high || raw <= low)
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_step_follows_the_rules() {
    let all = PidParams { derivative_s: 0.02, dead_zone: 0.05, smoothing_per_s: 40.0, ..LIMITED };
    let measured = PidParams {
        derivative_of: DerivativeOf::Measurement,
        derivative_filter_s: 0.03,
        smoothing_per_s: Real::INFINITY,
        ..all
    };
    let mut seed = 1_u32;
    let mut number = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as Real / 8_388_608.0 - 1.0
    };
    for params in [LIMITED, all, measured] {
        for anti_windup in [AntiWindup::Directional, AntiWindup::Freeze] {
            let p = PidParams { anti_windup, integral_per_s: 8.0, ..params };
            let (pid, mut s) = (pid(p), PidState::default());
            let mut rules = Rules {
                p,
                h: 0.01,
                integral: 0.0,
                output: 0.0,
                last: None,
                difference: 0.0,
                excess: 0.0,
            };
            for n in 0..2000 {
                let wide = if n / 50 % 2 == 0 { 0.2 } else { 1.0 };
                let (reference, measurement) = (wide * number(), 0.3 * wide * number());
                if n % 400 == 399 {
                    pid.preload(&mut s, 0.3, PidInput { reference, measurement });
                    let error = f64::from(reference - measurement);
                    rules.integral = f64::from(0.3_f32) - f64::from(p.proportional) * error;
                    rules.output = f64::from(0.3_f32);
                    rules.difference = 0.0;
                    rules.excess = 0.0;
                    let of_error = p.derivative_of == DerivativeOf::Error;
                    rules.last = Some(if of_error { error } else { -f64::from(measurement) });
                }
                let applied = s.output() + if n % 3 == 0 { 0.4 * number() } else { 0.0 };
                let limited = n % 4 < 2;
                let direction = number().signum() * Real::from(n % 5 == 0);
                let before = s.output();
                let out = match n / 100 % 4 {
                    0 => pid.step(&mut s, PidInput { reference, measurement }),
                    1 => {
                        pid.feed_back(&mut s, applied);
                        let excess = before - applied;
                        let told = excess.abs() > pid.feedback_tolerance;
                        rules.excess = if told { f64::from(excess) } else { 0.0 };
                        pid.step(&mut s, PidInput { reference, measurement })
                    }
                    2 => {
                        pid.saturate(&mut s, direction);
                        rules.excess = f64::from(direction);
                        pid.step(&mut s, PidInput { reference, measurement })
                    }
                    _ => {
                        rules.excess = if limited { f64::from(before - applied) } else { 0.0 };
                        let input = PidInput { reference, measurement };
                        pid.step_fed_back(&mut s, input, applied, limited)
                    }
                };
                let (output, raw, saturated) =
                    rules.step(f64::from(reference), f64::from(measurement));
                let near = |a: Real, b: f64| (f64::from(a) - b).abs() < 2e-4;
                assert!(
                    near(out.output, output) && near(out.raw, raw),
                    "{n} {p:?}: {out:?} {output} {raw}"
                );
                assert!(
                    near(s.integral(), rules.integral),
                    "{n}: {} {}",
                    s.integral(),
                    rules.integral
                );
                assert!(out.saturated == saturated && !out.rejected);
                assert_eq!(s.excess, 0.0, "{n}");
            }
        }
    }
}
