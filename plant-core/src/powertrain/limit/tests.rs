use super::*;

const AXIS: Axis =
    Axis { inductance_ohm: 0.5, resistance_ohm: 0.02, back_emf_v: 150.0, current_a: 0.0 };

/// Whatever is wanted, the power of the step lies within both bounds, and so does the power of
/// holding the current; unless the current was beyond already.
#[test]
fn the_power_stays_between_its_bounds() {
    for back_emf_v in [150.0, -150.0, 20.0, 0.0] {
        for current_a in [-80.0, -20.0, 0.0, 30.0, 90.0] {
            let axis = Axis { back_emf_v, current_a, ..AXIS };
            for want in [-400.0, -50.0, 0.0, 70.0, 500.0] {
                for (lowest_w, highest_w) in [(-2e3, 6e3), (-1e4, 1e3), (0.0, 0.0), (-1e6, 1e6)] {
                    let x = axis.held(want, lowest_w, highest_w);
                    let (now_w, held_w) = (axis.power_w(x), x * (back_emf_v + 0.02 * x));
                    let rounding_w = 0.01 + 1e-5 * (now_w.abs() + held_w.abs());
                    assert!(now_w <= highest_w + rounding_w, "{axis:?} {want}: {now_w}");
                    let braking = -back_emf_v * current_a > 0.0;
                    let beyond = braking && current_a * (back_emf_v + 0.02 * current_a) < lowest_w;
                    let worst_w = now_w.min(held_w);
                    let before_a = current_a.abs() + 1e-3;
                    assert!(worst_w >= lowest_w - rounding_w || beyond && x.abs() <= before_a);
                    let free = axis.power_w(want);
                    let fits = (lowest_w..=highest_w).contains(&free)
                        && want * (back_emf_v + 0.02 * want) >= lowest_w;
                    assert!(x == want || !fits || beyond, "{axis:?} {want}: {x} for nothing");
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
        axis.current_a = axis.held(-500.0, lowest_w, 1e6);
        let left = (axis.current_a - edge_a) / (start_a - edge_a);
        let share = Real::powi(1.0 / (1.0 + 0.02 / 0.5), n);
        assert!((left - share).abs() < 1e-3, "{n}: {left} {share}");
    }
    // What is wanted may end it at once, where that charges no more.
    assert!(Axis { current_a: start_a, ..AXIS }.held(-399.0, lowest_w, 1e6) > -400.0);
}

#[test]
fn a_root_gives_its_power() {
    for back_emf_v in [150.0, -150.0, 0.0] {
        for current_a in [-90.0, 0.0, 40.0] {
            let axis = Axis { back_emf_v, current_a, ..AXIS };
            for p in [-3e3, -10.0, 0.0, 10.0, 2e4] {
                for near in [-100.0, 100.0] {
                    let x = axis.at_power(p, near);
                    let lowest_w = axis.power_w(axis.at_power(-1e9, near));
                    assert!((axis.power_w(x) - p.max(lowest_w)).abs() < 0.05, "{axis:?} {p}: {x}");
                }
            }
        }
    }
}
