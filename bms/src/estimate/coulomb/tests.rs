use plant_core::num::SocTable;

use super::*;
use crate::Health;

const LINE: OpenCircuit = OpenCircuit::Linear { empty_v: 3.0, full_v: 4.0 };
const PARAMS: CoulombParams = CoulombParams {
    capacity_ah: 10.0,
    capacity_sd_ah: 0.2,
    charge_efficiency: 1.0,
    offset_sd_a: 0.05,
    gain_sd: 0.005,
    largest_current_a: 100.0,
    open_circuit: LINE,
    rest_voltage_sd_v: 0.01,
    rest_current_a: 0.1,
    rest_s: 600.0,
};

fn counter(params: CoulombParams, dt_s: Real) -> CoulombCounter {
    CoulombCounter::new(params, Dt::from_s(dt_s).unwrap()).unwrap()
}

/// LFP-like: steep, flat between 20 % and 90 %, steep.
fn flat() -> OpenCircuit {
    let points = [(0.0, 2.8), (0.2, 3.29), (0.9, 3.31), (1.0, 3.6)];
    OpenCircuit::Table(SocTable::from_points("t", &points).unwrap())
}

/// `seconds` of one current, ten steps and a review in each.
fn run(
    counter: &CoulombCounter,
    state: &mut CoulombState,
    current_a: Real,
    voltage_v: Real,
    seconds: u32,
) -> CoulombOutput {
    let mut output = counter.review(state, Real::NAN);
    for _ in 0..seconds {
        for _ in 0..10 {
            counter.step(state, CoulombInput { current_a });
        }
        output = counter.review(state, voltage_v);
    }
    output
}

#[test]
fn counts_what_flows() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::known(0.9, 0.01);
    let out = run(&c, &mut s, 10.0, 3.5, 1800);
    assert!((out.soc - 0.4).abs() < 1e-6, "{out:?}");
    let out = run(&c, &mut s, -10.0, 3.5, 360);
    assert!((out.soc - 0.5).abs() < 1e-6, "{out:?}");
    assert!(!out.current_missing && !out.anchored && !out.voltage_implausible);
    assert_eq!(c.soc(&s), out.soc);
    for _ in 0..5 {
        Model::step(&c, &mut s, CoulombInput { current_a: 100.0 });
    }
    assert!((c.soc(&s) - (out.soc - 50.0 / 36_000.0)).abs() < 1e-6, "between reviews too");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn keeps_a_small_current_at_a_high_rate() {
    let (c, mut s) = (counter(PARAMS, 1e-4), CoulombState::known(0.9, 0.0));
    for _ in 0..100 {
        for _ in 0..36_000 {
            c.step(&mut s, CoulombInput { current_a: 0.1 });
        }
        c.review(&mut s, Real::NAN);
    }
    assert!((c.soc(&s) - (0.9 - 0.001)).abs() < 1e-7, "{}", c.soc(&s));
}

#[test]
fn loses_what_charging_loses() {
    let c = counter(CoulombParams { charge_efficiency: 0.95, ..PARAMS }, 0.1);
    let mut s = CoulombState::known(0.5, 0.0);
    assert!((run(&c, &mut s, -10.0, 3.5, 720).soc - (0.5 + 0.95 * 0.2)).abs() < 1e-6);
    assert!((run(&c, &mut s, 10.0, 3.5, 720).soc - (0.5 - 0.05 * 0.2)).abs() < 1e-6);
}

#[test]
fn stops_at_empty_and_full() {
    let (c, mut s) = (counter(PARAMS, 0.1), CoulombState::known(0.1, 0.05));
    assert_eq!(run(&c, &mut s, 10.0, 3.5, 720).soc, 0.0);
    assert!((run(&c, &mut s, -10.0, 3.5, 360).soc - 0.1).abs() < 1e-6);
    assert_eq!(run(&c, &mut s, -10.0, 3.5, 3600).soc, 1.0);
}

#[test]
fn grows_uncertain_by_each_cause() {
    let certain = CoulombParams { capacity_sd_ah: 0.0, offset_sd_a: 0.0, gain_sd: 0.0, ..PARAMS };
    let offset = CoulombParams { offset_sd_a: 0.05, ..certain };
    let gain = CoulombParams { gain_sd: 0.005, ..certain };
    let capacity = CoulombParams { capacity_sd_ah: 0.2, ..certain };
    // After an hour: 0.3 out and 0.1 in again.
    for (params, expected) in [
        (certain, 0.01),
        (offset, sqrt(1e-4 + 0.005 * 0.005)),
        (gain, sqrt(1e-4 + 0.002 * 0.002)),
        (capacity, sqrt(1e-4 + 0.004 * 0.004)),
    ] {
        let (c, mut s) = (counter(params, 0.1), CoulombState::known(0.9, 0.01));
        run(&c, &mut s, 10.0, 3.5, 1080);
        run(&c, &mut s, -10.0, 3.5, 360);
        let out = run(&c, &mut s, 0.0, Real::NAN, 2160);
        assert!((out.soc_sd - expected).abs() < 1e-5, "{params:?}: {}", out.soc_sd);
    }
}

#[test]
fn holds_without_a_reading_and_says_so() {
    let c = counter(PARAMS, 0.1);
    for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY, 100.1, -1e30] {
        let mut s = CoulombState::known(0.6, 0.0);
        let out = run(&c, &mut s, bad, 3.2, 36);
        assert!(out.current_missing && out.soc == 0.6, "{out:?}");
        // 100 A for 36 s of 10 A·h.
        assert!((out.soc_sd - 0.1).abs() < 1e-4, "{}", out.soc_sd);
        assert!(!run(&c, &mut s, 1.0, 3.2, 1).current_missing);
        // Nothing is known, not less than nothing.
        let out = run(&c, &mut s, bad, 3.2, 3600);
        assert!((out.soc_sd - most_sd(out.soc)).abs() < 1e-6, "{}", out.soc_sd);
    }
}

#[test]
fn is_put_right_by_a_rest() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::UNKNOWN;
    assert!(!run(&c, &mut s, 0.05, 3.7, 599).anchored);
    let out = run(&c, &mut s, 0.05, 3.7, 2);
    assert!((out.soc - 0.7).abs() < 1e-4 && (out.soc_sd - 0.01).abs() < 1e-4, "{out:?}");
    // A current above that of a rest, or none measured for a while, starts the rest anew.
    for (interruption, seconds) in [(0.2, 1), (Real::NAN, 2)] {
        let mut s = CoulombState::UNKNOWN;
        run(&c, &mut s, 0.05, 3.7, 300);
        run(&c, &mut s, interruption, 3.7, seconds);
        assert!(run(&c, &mut s, 0.05, 3.7, 599).soc_sd > 0.2);
        assert!(run(&c, &mut s, 0.05, 3.7, 1).soc_sd < 0.02);
    }
    // So do a ripple whose mean is nothing, and a pulse that is over.
    for [first_a, last_a] in [[-1.0, 1.0], [1.0, 0.05]] {
        let mut s = CoulombState::UNKNOWN;
        for _ in 0..4000 {
            c.step(&mut s, CoulombInput { current_a: first_a });
            c.step(&mut s, CoulombInput { current_a: last_a });
            assert!(!c.review(&mut s, 3.7).anchored);
        }
    }
    // Without a voltage there is nothing to learn.
    for bad in [Real::NAN, Real::INFINITY, 2.9, 4.1] {
        let mut s = CoulombState::UNKNOWN;
        let out = run(&c, &mut s, 0.0, bad, 700);
        assert!(out.soc_sd > 0.28 && out.voltage_implausible == bad.is_finite(), "{out:?}");
    }
}

/// One sample of a hundred is missing, and one of five.
#[test]
fn single_missing_samples_are_bridged_and_end_no_rest() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::UNKNOWN;
    let drop = |s: &mut CoulombState, every: u32, current_a: Real, seconds: u32| {
        let mut out = c.review(s, Real::NAN);
        for step in 1..=10 * seconds {
            let seen = !step.is_multiple_of(every);
            c.step(s, CoulombInput { current_a: if seen { current_a } else { Real::NAN } });
            if step.is_multiple_of(10) {
                out = c.review(s, 3.7);
            }
        }
        out
    };
    assert!((drop(&mut s, 100, 0.05, 601).soc - 0.7).abs() < 1e-4);
    let mut s = CoulombState::known(0.9, 0.0);
    let out = drop(&mut s, 5, 5.0, 3600);
    assert!((out.soc - 0.4).abs() < 1e-4 && out.soc_sd < 0.03, "{out:?}");
    assert!(drop(&mut s, 5, 0.05, 700).soc_sd >= out.soc_sd, "too many for a rest");
}

#[test]
fn takes_over_a_capacity_that_was_learnt() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::known(0.9, 0.0);
    let health = Health {
        capacity_ah: 8.0,
        capacity_sd_ah: 0.08,
        resistance_factor: 1.0,
        resistance_factor_sd: 0.0,
    };
    c.adopt(&mut s, &Health { capacity_sd_ah: 1.0, ..health });
    c.adopt(&mut s, &Health { capacity_ah: Real::NAN, ..health });
    assert_eq!(s, CoulombState::known(0.9, 0.0));
    c.adopt(&mut s, &health);
    let out = run(&c, &mut s, 4.0, Real::NAN, 3600);
    assert!((out.soc - 0.4).abs() < 1e-4 && out.soc_sd < 0.01, "{out:?}");
    run(&c, &mut s, 0.0, 3.7, 700);
    let again = run(&c, &mut s, 4.0, Real::NAN, 1800);
    assert!((again.soc - 0.45).abs() < 1e-3, "a rest changes nothing of it: {again:?}");
}

#[test]
fn a_pause_is_a_rest_of_which_little_is_known() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::known(0.5, 0.001);
    c.pause(&mut s, Some(10.0 * 3600.0), 0.01);
    assert!((c.soc_sd(&s) - 0.01).abs() < 1e-3);
    assert!(run(&c, &mut s, 0.0, 3.7, 1).anchored, "it has rested");
    let mut s = CoulombState::known(0.5, 0.001);
    c.pause(&mut s, None, 0.01);
    assert!(c.soc_sd(&s) > 0.28 && !run(&c, &mut s, 0.0, 3.7, 1).anchored);
}

#[test]
fn believes_the_better_of_count_and_rest() {
    let c = counter(PARAMS, 0.1);
    let mut s = CoulombState::known(0.69, 0.005);
    let out = run(&c, &mut s, 0.0, 3.7, 700);
    assert!(out.soc == 0.69 && out.soc_sd < 0.006, "the count is better: {out:?}");
    let mut s = CoulombState::known(0.4, 0.005);
    let out = run(&c, &mut s, 0.0, 3.7, 700);
    assert!((out.soc - 0.7).abs() < 1e-4, "the two contradict each other: {out:?}");
}

#[test]
fn learns_nothing_from_a_plateau() {
    let c = counter(CoulombParams { open_circuit: flat(), ..PARAMS }, 0.1);
    for voltage_v in [3.285, 3.3, 3.31, 3.32] {
        let mut s = CoulombState::known(0.6, 0.1);
        let out = run(&c, &mut s, 0.0, voltage_v, 700);
        assert!(out.soc == 0.6 && out.soc_sd >= 0.1, "{voltage_v}: {out:?}");
        let from_rest = c.soc_sd(&c.rested(voltage_v));
        assert!(from_rest > 0.2, "{voltage_v}: {from_rest}");
    }
    let out = run(&c, &mut CoulombState::known(0.6, 0.1), 0.0, 3.5, 700);
    assert!((out.soc - 0.9655).abs() < 1e-3 && out.soc_sd < 0.01, "off the plateau: {out:?}");
}

#[test]
fn starts_from_what_is_there() {
    let c = counter(PARAMS, 0.1);
    assert_eq!(c.rested(Real::NAN), CoulombState::UNKNOWN);
    assert_eq!(c.rested(5.0), CoulombState::UNKNOWN);
    for (voltage_v, soc) in [(3.25, 0.25), (2.99, 0.0), (4.02, 1.0)] {
        let s = c.rested(voltage_v);
        assert!((c.soc(&s) - soc).abs() < 1e-5 && (c.soc_sd(&s) - 0.01).abs() < 1e-4, "{s:?}");
    }
    for (soc, sd) in [(Real::NAN, 0.1), (0.5, Real::NAN), (1.1, 0.1), (-0.1, 0.1), (0.5, -0.1)] {
        assert_eq!(CoulombState::known(soc, sd), CoulombState::default());
    }
    assert!((c.soc_sd(&CoulombState::default()) - 0.2887).abs() < 1e-4);
    assert!(c.soc_sd(&CoulombState::known(1.0, 1.0)) < 0.58, "as of a uniform distribution");
}

#[test]
fn refuses_each_bad_field_by_name() {
    use ParamError::{Decreasing, Negative, NotAnEfficiency, NotPositive};
    let dt = Dt::from_s(0.1).unwrap();
    let refused = |change: fn(&mut CoulombParams), error| {
        let mut params = PARAMS;
        change(&mut params);
        assert_eq!(CoulombCounter::new(params, dt), Err(error));
    };
    refused(|p| p.capacity_ah = 0.0, NotPositive("coulomb.capacity_ah"));
    refused(|p| p.capacity_sd_ah = -1.0, Negative("coulomb.capacity_sd_ah"));
    refused(|p| p.charge_efficiency = 1.01, NotAnEfficiency("coulomb.charge_efficiency"));
    refused(|p| p.offset_sd_a = Real::NAN, Negative("coulomb.offset_sd_a"));
    refused(|p| p.gain_sd = -0.1, Negative("coulomb.gain_sd"));
    refused(|p| p.largest_current_a = Real::INFINITY, NotPositive("coulomb.largest_current_a"));
    refused(|p| p.rest_voltage_sd_v = 0.0, NotPositive("coulomb.rest_voltage_sd_v"));
    refused(|p| p.rest_current_a = 0.0, NotPositive("coulomb.rest_current_a"));
    refused(|p| p.rest_s = -1.0, NotPositive("coulomb.rest_s"));
    refused(
        |p| p.open_circuit = OpenCircuit::Linear { empty_v: 4.0, full_v: 3.0 },
        Decreasing("coulomb.open_circuit"),
    );
}
