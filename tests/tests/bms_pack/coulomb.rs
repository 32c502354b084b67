//! The standard deviation of the count covers what it does not know.

use plant_core::battery::OpenCircuit;
use plant_core::{Dt, Real};
use proptest::prelude::*;
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams, CoulombState};

use crate::draw::{Honesty, Normal, cases, curve};

const PARAMS: CoulombParams = CoulombParams {
    capacity_ah: 60.0,
    capacity_sd_ah: 1.0,
    charge_efficiency: 1.0,
    offset_sd_a: 0.2,
    gain_sd: 0.005,
    largest_current_a: 400.0,
    open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
    rest_voltage_sd_v: 0.01,
    rest_current_a: 0.5,
    rest_s: 600.0,
};

fn counter(params: CoulombParams) -> CoulombCounter {
    CoulombCounter::new(params, Dt::from_s(1.0).unwrap()).unwrap()
}

/// What is wrong, each as a multiple of its standard deviation.
#[derive(Clone, Copy, Debug)]
struct Wrong {
    start: f64,
    offset: f64,
    gain: f64,
    capacity: f64,
}

/// Error of the count and its standard deviation after each of some phases of a current and its
/// seconds, `wrong` as it is.
fn drive(params: CoulombParams, wrong: Wrong, phases: &[(f64, u32)]) -> Vec<(f64, f64)> {
    const START_SD: Real = 0.002;
    let c = counter(params);
    let mut state = CoulombState::known(0.5, START_SD);
    let mut truth = 0.5 - wrong.start * f64::from(START_SD);
    let capacity_c = 3600.0
        * (f64::from(params.capacity_ah) + wrong.capacity * f64::from(params.capacity_sd_ah));
    let mut errors = Vec::new();
    for (current_a, seconds) in phases {
        let gain = 1.0 + wrong.gain * f64::from(params.gain_sd);
        let measured_a = gain * current_a + wrong.offset * f64::from(params.offset_sd_a);
        for _ in 0..*seconds {
            c.step(&mut state, CoulombInput { current_a: measured_a as Real });
            c.review(&mut state, Real::NAN);
            truth -= current_a / capacity_c;
        }
        errors.push((f64::from(c.soc(&state)) - truth, f64::from(c.soc_sd(&state))));
    }
    errors
}

proptest! {
    #![proptest_config(cases(256))]

    /// Four causes, each within its standard deviation: together within twice the whole.
    #[test]
    fn every_bias_within_its_own_is_within_the_whole(
        [start, offset, gain, capacity] in prop::array::uniform4(-1.0..=1.0_f64),
        phases in prop::collection::vec((-60.0..60.0_f64, 1..200_u32), 1..20),
    ) {
        let wrong = Wrong { start, offset, gain, capacity };
        for (error, sd) in drive(PARAMS, wrong, &phases) {
            // The capacity acts as its inverse, 1/60 of 1/60 beside its standard deviation; the
            // gain on what is measured, 0.5 % beside.
            prop_assert!(error.abs() <= 2.0 * 1.03 * sd + 1e-6, "{error} {sd} {wrong:?}");
        }
    }

    /// What flowed unseen was at most the largest current.
    #[test]
    fn what_was_missed_is_within_the_standard_deviation(
        unseen_a in prop::collection::vec(-400.0..=400.0_f64, 1..100),
    ) {
        let exact = CoulombParams { capacity_sd_ah: 0.0, offset_sd_a: 0.0, gain_sd: 0.0, ..PARAMS };
        let c = counter(exact);
        let mut state = CoulombState::known(0.5, 0.0);
        let mut truth = 0.5;
        for current_a in unseen_a {
            c.step(&mut state, CoulombInput { current_a: Real::NAN });
            let out = c.review(&mut state, Real::NAN);
            truth -= current_a / (3600.0 * 60.0);
            prop_assert!(out.current_missing && out.soc == 0.5);
            prop_assert!((0.5 - truth).abs() <= f64::from(out.soc_sd) + 1e-6);
        }
    }

    /// However the curve bends, a voltage within three of its standard deviations gives a state
    /// of charge within three of its own.
    #[test]
    fn a_rest_claims_no_more_than_the_curve_says(
        open_circuit in curve(),
        truth in 0.0..=1.0_f32,
        away in -3.0..=3.0_f32,
    ) {
        let c = counter(CoulombParams { open_circuit, ..PARAMS });
        let state = c.rested(open_circuit.at(truth) + away * PARAMS.rest_voltage_sd_v);
        let error = (c.soc(&state) - truth).abs();
        prop_assert!(error <= 3.0 * c.soc_sd(&state) + 1e-4, "{error} {}", c.soc_sd(&state));
    }
}

/// Errors drawn as the parameters state them: the standard deviation is neither too small nor
/// idly large.
#[test]
fn is_honest_on_the_whole() {
    let (mut normal, mut honesty) = (Normal(1), Honesty::default());
    for _ in 0..1000 {
        let wrong = Wrong {
            start: normal.next(1.0),
            offset: normal.next(1.0),
            gain: normal.next(1.0),
            capacity: normal.next(1.0),
        };
        // A drive of an hour, a charge, the drive back.
        let phases = [(15.0, 3000), (60.0, 300), (-30.0, 1800), (10.0, 1200)];
        for (error, sd) in drive(PARAMS, wrong, &phases) {
            honesty.book(error, sd);
        }
    }
    assert!(honesty.share_inside() >= 0.99, "{honesty:?}");
    assert!((0.8..1.05).contains(&honesty.rms()), "{} {honesty:?}", honesty.rms());
}
