use super::*;

const AXIS: Axis =
    Axis { inductance_ohm: 0.5, resistance_ohm: 0.02, back_emf_v: 150.0, current_a: 0.0 };

fn bounds(lowest_w: Real, highest_w: Real) -> AxisBounds {
    AxisBounds { lowest_w, lowest_held_w: lowest_w, highest_w, current_a: Real::INFINITY }
}

/// Whatever is wanted, and wherever the command leads in the end, the power of the step lies within
/// both bounds; so does that of holding the current, unless the command does not charge in the end
/// or the current was beyond already.
#[test]
fn the_power_stays_between_its_bounds() {
    for back_emf_v in [150.0, -150.0, 20.0, 0.0] {
        for current_a in [-80.0, -20.0, 0.0, 30.0, 90.0] {
            let axis = Axis { back_emf_v, current_a, ..AXIS };
            // A command's own voltage, the current that it leads to now and in the end.
            for voltage_v in [-400.0, -140.0, -40.0, 0.0, 40.0, 148.0, 170.0, 500.0] {
                let want = (voltage_v - axis.held_v()) / axis.step_ohm();
                let ends_at = (voltage_v - back_emf_v) / axis.resistance_ohm;
                for (lowest_w, highest_w) in [(-2e3, 6e3), (-1e4, 1e3), (0.0, 0.0), (-1e6, 1e6)] {
                    let (rise_a, held) = axis.held(want, ends_at, &bounds(lowest_w, highest_w));
                    let x = current_a + rise_a;
                    let (now_w, held_w) = (axis.power_w(rise_a), axis.held_w(x));
                    let rounding_w = 0.01 + 1e-5 * (now_w.abs() + held_w.abs());
                    let say = (axis, (voltage_v, lowest_w, highest_w), (want, x), (now_w, held_w));
                    assert!(now_w <= highest_w + rounding_w, "{say:?}");
                    let carried_w = axis.held_w(current_a);
                    let braking = -back_emf_v * current_a > 0.0;
                    let beyond = braking && carried_w < lowest_w;
                    assert!(now_w >= RELEASE * lowest_w - rounding_w || beyond, "{say:?}");
                    assert!(!beyond || now_w >= lowest_w || x.abs() <= current_a.abs(), "{say:?}");
                    let ends_w = ends_at * voltage_v;
                    let free = axis.power_w(want);
                    let fits = (lowest_w..=highest_w).contains(&free) && ends_w >= lowest_w;
                    assert!(!fits || rise_a == want && held == Held::No, "{say:?}: for nothing");
                }
            }
        }
    }
}

/// Step after step under a bound that the current already exceeds.
#[test]
fn a_current_beyond_the_edge_decays_with_its_time_constant() {
    let (lowest_w, start_a) = (-15e3, -400.0);
    let mut axis = Axis { current_a: start_a, ..AXIS };
    let edge_a = -2.0 * 15e3 / (150.0 + sqrt(150.0 * 150.0 - 4.0 * 0.02 * 15e3));
    for n in 1..200 {
        let want = -500.0 - axis.current_a;
        axis.current_a += axis.held(want, -500.0, &bounds(lowest_w, 1e6)).0;
        let left = (axis.current_a - edge_a) / (start_a - edge_a);
        let share = Real::powi(1.0 / (1.0 + 0.02 / 0.5), n);
        assert!((left - share).abs() < 1e-3, "{n}: {left} {share}");
    }
}

/// A command for less than the limit is followed from the limit on, and from beyond.
#[test]
fn a_current_leaves_its_limit_when_it_is_told_to() {
    for start_a in [-100.5, -101.0, -180.0, -60.0] {
        let mut axis = Axis { current_a: start_a, ..AXIS };
        let (voltage_v, ends_at) = (149.0, -50.0);
        let lowest_w = -101.0 * (150.0 - 0.02 * 101.0);
        let mut last_a = start_a.abs();
        for _ in 0..400 {
            let want = (voltage_v - axis.held_v()) / axis.step_ohm();
            let x = axis.current_a + axis.held(want, ends_at, &bounds(lowest_w, 1e6)).0;
            assert!(x.abs() <= last_a, "{start_a}: {x} after {last_a}");
            (axis.current_a, last_a) = (x, x.abs());
        }
        assert!((axis.current_a - ends_at).abs() < 0.1, "{start_a}: {axis:?}");
    }
}

/// A machine that brakes by drawing crosses what it could not hold, and is not held.
#[test]
fn plugging_is_no_charging() {
    let mut axis = Axis { current_a: 0.0, ..AXIS };
    let voltage_v = -3.0;
    for _ in 0..400 {
        let want = (voltage_v - axis.held_v()) / axis.step_ohm();
        assert_eq!(axis.held(want, -7650.0, &bounds(-1e3, 1e6)), (want, Held::No));
        axis.current_a += want;
    }
    assert!(axis.current_a < -7600.0);
}

#[test]
fn a_root_gives_its_power() {
    for back_emf_v in [150.0, -150.0, 0.0] {
        for current_a in [-90.0, 0.0, 40.0] {
            let axis = Axis { back_emf_v, current_a, ..AXIS };
            for p in [0.0, 10.0, 2e4] {
                for near in [-100.0, 100.0] {
                    let rise_a = axis.at_power(p, near);
                    assert!((axis.power_w(rise_a) - p).abs() < 0.05, "{axis:?} {p}: {rise_a}");
                    assert!((current_a + rise_a) * near >= 0.0 || p == 0.0, "{axis:?} {p}");
                }
            }
        }
    }
}
