extern crate std;
use plant_core::must;

use super::*;

const DT: Dt = must!(Dt::from_s(1.0));
const PARAMS: CapacityParams = CapacityParams {
    nominal_ah: 3.0,
    nominal_sd_ah: 0.5,
    current_noise_sd_a: 0.01,
    current_offset_sd_a: 0.005,
    current_gain_sd: 0.0,
    least_soc_change: 0.1,
    least_soc_change_sds: 5.0,
    memory_pairs: 100.0,
};
const ESTIMATOR: CapacityEstimator = must!(CapacityEstimator::new(PARAMS, DT));
const HOUR_S: Real = 3600.0;

fn at(soc: Real, soc_sd: Real) -> Estimate {
    Estimate::rested(soc, soc_sd, 25.0)
}

fn pair(start: Real, end: Real, soc_sd: Real, discharged_ah: Real) -> CapacityInput {
    CapacityInput {
        start: at(start, soc_sd),
        end: at(end, soc_sd),
        discharged_ah,
        duration_s: HOUR_S,
    }
}

/// Numbers as if drawn from a normal distribution: a sum of twelve even ones.
struct Noise(u32);

impl Noise {
    fn draw(&mut self) -> Real {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            sum += (self.0 >> 8) as Real / 16_777_216.0;
        }
        sum
    }
}

#[test]
fn exact_pairs_give_the_exact_capacity_charged_or_discharged() {
    for capacity_ah in [1.5, 2.55, 3.0, 4.0] {
        let mut state = ESTIMATOR.unknown();
        let mut out = ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, 0.7 * capacity_ah));
        for _ in 0..10 {
            ESTIMATOR.step(&mut state, pair(0.2, 0.9, 0.003, -0.7 * capacity_ah));
            out = ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, 0.7 * capacity_ah));
        }
        assert!(out.learned && !out.rejected);
        assert!((out.capacity_ah / capacity_ah - 1.0).abs() < 1e-3, "{capacity_ah}: {out:?}");
        assert!(out.capacity_sd_ah < 0.005 * capacity_ah, "{out:?}");
    }
}

/// Whatever one pair says: a wrong state of charge, a count that was reset, a current with the wrong
/// sign.
#[test]
fn one_pair_that_contradicts_is_flagged_and_never_wins() {
    for wrong_ah in [0.0, -2.0, 0.4, 4.5, 10.0] {
        let mut state = ESTIMATOR.unknown();
        for _ in 0..5 {
            ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 0.8 * 2.5));
        }
        let out = ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, wrong_ah));
        assert!(out.contradicted && !out.learned, "{wrong_ah}: {out:?}");
        assert!((out.capacity_ah - 2.5).abs() < 0.05 && out.capacity_sd_ah > 0.1, "{out:?}");
        let out = ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 0.8 * 2.5));
        assert!(out.learned && !out.contradicted && out.capacity_sd_ah < 0.05, "{out:?}");
        // As the first pair of all, too.
        let out = ESTIMATOR.step(&mut ESTIMATOR.unknown(), pair(0.9, 0.1, 0.005, wrong_ah));
        assert!(out.contradicted && out.capacity_ah == 3.0, "{out:?}");
        assert!(out.capacity_sd_ah >= 0.5, "{out:?}");
    }
}

#[test]
fn two_that_agree_win_and_the_impossible_never_does() {
    let mut state = ESTIMATOR.unknown();
    for _ in 0..5 {
        ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 0.8 * 2.9));
    }
    ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 0.8 * 2.2));
    let out = ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 0.8 * 2.2));
    assert!(out.learned && !out.contradicted, "{out:?}");
    assert!((out.capacity_ah - 2.2).abs() <= 3.0 * out.capacity_sd_ah, "{out:?}");
    assert!((out.capacity_ah - 2.2).abs() < 0.1, "{out:?}");
    let mut state = ESTIMATOR.unknown();
    for _ in 0..8 {
        let out = ESTIMATOR.step(&mut state, pair(0.9, 0.1, 0.005, 10.0));
        assert!(out.contradicted && !out.learned && out.capacity_ah == 3.0, "{out:?}");
    }
}

#[test]
fn finds_the_minimum_of_the_cost_and_its_curvature() {
    // Pairs whose deviations change from one to the next, in double precision and by brute force.
    let pairs = [(0.7, 1.9, 0.01, 0.02), (0.5, 1.3, 0.02, 0.01), (0.3, 0.86, 0.005, 0.03)];
    let mut sums = Sums { c: [0.0; 6] };
    for (x, y, x_sd, y_sd) in pairs {
        sums.add(x, y, 1.0 / (y_sd * y_sd), 1.0 / (x_sd * x_sd));
    }
    // The ratio is held in 0.2 .. 2: give charge as a share of a large nominal capacity.
    for (sums, unit) in [(sums, 1.0), (scaled(&sums, 0.5), 0.5)] {
        let c = sums.c.map(f64::from);
        let k2 = c[0] / c[3];
        let cost = |q: f64| {
            // q in the units of the scaled charge.
            let k = k2.sqrt();
            let q = q * k;
            let s = [c[0] / k2, c[1] / k, c[2], c[3], c[4] * k, c[5] * k2];
            (s[3] * q.powi(4) - 2.0 * s[4] * q.powi(3) + (s[0] + s[5]) * q * q - 2.0 * s[1] * q
                + s[2])
                / (q * q + 1.0).powi(2)
        };
        let best = (2000..20000)
            .map(|i| f64::from(i) * 1e-4)
            .min_by(|a, b| cost(*a).total_cmp(&cost(*b)))
            .unwrap();
        let (found, variance) = sums.solve().unwrap();
        if unit == 1.0 {
            assert_eq!(found, 2.0, "held at the largest ratio: {best}");
            continue;
        }
        assert!((f64::from(found) - best).abs() < 2e-4, "{found} {best}");
        let h = 1e-3;
        let bend = (cost(best + h) - 2.0 * cost(best) + cost(best - h)) / (h * h);
        assert!((f64::from(variance) * bend / 2.0 - 1.0).abs() < 0.02, "{variance} {bend}");
    }
}

fn scaled(sums: &Sums, unit: Real) -> Sums {
    let [c1, c2, c3, c4, c5, c6] = sums.c;
    Sums { c: [c1 / (unit * unit), c2 / unit, c3, c4, c5 * unit, c6 * unit * unit] }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn says_how_far_off_it_is() {
    let (truth_ah, soc_sd, offset_sd_a) = (2.5, 0.01, PARAMS.current_offset_sd_a);
    let mut noise = Noise(7);
    let (mut within_1, mut within_2, mut sum, runs) = (0, 0, 0.0, 400);
    for _ in 0..runs {
        let mut state = ESTIMATOR.unknown();
        let mut out = None;
        for _ in 0..20 {
            let change = 0.3 + 0.02 * noise.draw();
            let (a, b) = (soc_sd * noise.draw(), soc_sd * noise.draw());
            let read_ah = truth_ah * change + offset_sd_a * noise.draw();
            let input = pair(0.8 + a, 0.8 - change + b, soc_sd, read_ah);
            out = Some(ESTIMATOR.step(&mut state, input));
        }
        let out = out.unwrap();
        let off_sds = (out.capacity_ah - truth_ah) / out.capacity_sd_ah;
        within_1 += u32::from(off_sds.abs() < 1.0);
        within_2 += u32::from(off_sds.abs() < 2.0);
        sum += f64::from(out.capacity_ah);
    }
    let (one, two) = (f64::from(within_1) / 400.0, f64::from(within_2) / 400.0);
    assert!((0.60..0.80).contains(&one) && two > 0.93, "{one} {two}");
    // Least squares with all the doubt in the charge is low by 2·0.01²/0.3² = 0.2 % and its prior;
    // this one is not.
    let bias = sum / f64::from(runs) / f64::from(truth_ah) - 1.0;
    assert!(bias.abs() < 2e-3, "{bias}");
}

#[test]
fn learns_only_from_changes_that_are_known_well() {
    let mut state = ESTIMATOR.unknown();
    let before = state;
    for (input, learned) in [
        (pair(0.80, 0.72, 0.001, 0.2), false), // too small
        (pair(0.80, 0.60, 0.05, 0.5), false),  // 0.2 ± 0.07
        (pair(0.80, 0.60, 0.02, 0.5), true),
    ] {
        assert_eq!(state, before);
        assert_eq!(ESTIMATOR.step(&mut state, input).learned, learned, "{input:?}");
    }
    assert_ne!(state, before);
}

#[test]
fn one_absurd_pair_does_little() {
    let mut state = ESTIMATOR.unknown();
    for _ in 0..10 {
        ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, 0.7 * 2.5));
    }
    let out = ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, 0.7 * 5.0));
    assert!((out.capacity_ah / 2.5 - 1.0).abs() < 0.01, "{out:?}");
    let out = ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, -0.7 * 2.5));
    assert!((out.capacity_ah / 2.5 - 1.0).abs() < 0.01, "{out:?}");
}

#[test]
fn forgets_and_follows() {
    let estimator =
        CapacityEstimator::new(CapacityParams { memory_pairs: 10.0, ..PARAMS }, DT).unwrap();
    let mut state = estimator.unknown();
    let mut last = 0.0;
    for i in 0..120 {
        let capacity_ah = if i < 60 { 3.0 } else { 2.7 };
        last = estimator.step(&mut state, pair(0.9, 0.2, 0.003, 0.7 * capacity_ah)).capacity_ah;
    }
    assert!((last / 2.7 - 1.0).abs() < 2e-3, "{last}");
}

#[test]
fn is_never_surer_than_the_sensor() {
    let params = CapacityParams { current_gain_sd: 0.01, memory_pairs: 1e6, ..PARAMS };
    let estimator = CapacityEstimator::new(params, DT).unwrap();
    let mut state = estimator.unknown();
    let mut out = estimator.step(&mut state, pair(0.9, 0.2, 0.001, 1.9));
    for _ in 0..1000 {
        out = estimator.step(&mut state, pair(0.9, 0.2, 0.001, 1.9));
    }
    let sd = out.capacity_sd_ah / out.capacity_ah;
    assert!((0.01..0.0102).contains(&sd), "{sd}");
}

#[test]
fn starts_from_a_record() {
    let mut state = ESTIMATOR.known(2.6, 0.05);
    let small = pair(0.8, 0.79, 0.01, 0.0);
    let out = ESTIMATOR.step(&mut state, small);
    assert!(!out.learned);
    assert!((out.capacity_ah - 2.6).abs() < 1e-5 && (out.capacity_sd_ah - 0.05).abs() < 1e-5);
    // What follows is weighed against it.
    let out = ESTIMATOR.step(&mut state, pair(0.8, 0.5, 0.02, 0.3 * 2.4));
    assert!((2.5..2.6).contains(&out.capacity_ah), "{out:?}");
    for (ah, sd) in [(0.1, 0.1), (Real::NAN, 0.1), (2.6, Real::NAN), (2.6, 0.0), (99.0, 0.1)] {
        assert_eq!(ESTIMATOR.known(ah, sd), ESTIMATOR.unknown(), "{ah} {sd}");
    }
}

#[test]
fn bad_pairs_change_nothing() {
    let mut state = ESTIMATOR.unknown();
    ESTIMATOR.step(&mut state, pair(0.9, 0.2, 0.003, 1.9));
    let before = state;
    let good = pair(0.9, 0.2, 0.003, 1.9);
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        for input in [
            CapacityInput { start: at(bad, 0.003), ..good },
            CapacityInput { end: at(0.2, bad), ..good },
            CapacityInput { discharged_ah: bad, ..good },
            CapacityInput { duration_s: bad, ..good },
        ] {
            let out = ESTIMATOR.step(&mut state, input);
            assert!(out.rejected && !out.learned && out.capacity_ah.is_finite(), "{input:?}");
            assert_eq!(state, before);
        }
    }
}

#[test]
fn stays_finite_and_in_bounds_whatever_the_pairs() {
    let mut noise = Noise(3);
    let mut state = ESTIMATOR.unknown();
    for _ in 0..2000 {
        let input = CapacityInput {
            start: at(0.5 + noise.draw(), 1e-6),
            end: at(0.5 + noise.draw(), noise.draw().abs() * 0.1),
            discharged_ah: noise.draw() * 10.0,
            duration_s: noise.draw().abs() * 1e5,
        };
        let out = ESTIMATOR.step(&mut state, input);
        let ratio = out.capacity_ah / PARAMS.nominal_ah;
        assert!((0.199..2.001).contains(&ratio), "{out:?}");
        assert!(out.capacity_sd_ah > 0.0 && out.capacity_sd_ah.is_finite(), "{out:?}");
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| CapacityEstimator::new(p, DT).unwrap_err().field();
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        for (params, field) in [
            (CapacityParams { nominal_ah: bad, ..PARAMS }, "capacity.nominal_ah"),
            (CapacityParams { nominal_sd_ah: bad, ..PARAMS }, "capacity.nominal_sd_ah"),
            (CapacityParams { current_noise_sd_a: bad, ..PARAMS }, "capacity.current_noise_sd_a"),
            (CapacityParams { current_offset_sd_a: bad, ..PARAMS }, "capacity.current_offset_sd_a"),
            (CapacityParams { current_gain_sd: bad, ..PARAMS }, "capacity.current_gain_sd"),
            (CapacityParams { least_soc_change: bad, ..PARAMS }, "capacity.least_soc_change"),
            (
                CapacityParams { least_soc_change_sds: bad, ..PARAMS },
                "capacity.least_soc_change_sds",
            ),
            (CapacityParams { memory_pairs: bad, ..PARAMS }, "capacity.memory_pairs"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    assert_eq!(
        CapacityEstimator::new(CapacityParams { memory_pairs: 1.0, ..PARAMS }, DT),
        Err(ParamError::NotAbove("capacity.memory_pairs"))
    );
}
