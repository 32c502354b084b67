//! Thermal nodes, and what follows from their temperatures.

extern crate std;
use super::*;
use crate::error::ParamError;
use crate::model::Dt;
use crate::num::{Accum, Real};

const NODE: ThermalNodeParams =
    ThermalNodeParams { heat_capacity_j_per_k: 500.0, ambient_k_per_w: 0.2 };
const PAIR: ThermalPairParams = ThermalPairParams {
    inner: ThermalNodeParams { heat_capacity_j_per_k: 300.0, ambient_k_per_w: 2.0 },
    outer: ThermalNodeParams { heat_capacity_j_per_k: 2000.0, ambient_k_per_w: 0.1 },
    between_k_per_w: 0.05,
};
const HEAT: ThermalNodeInput = ThermalNodeInput { heat_w: 200.0, ambient_c: 10.0 };

fn dt(dt_s: Real) -> Dt {
    Dt::from_s(dt_s).unwrap()
}

fn node(params: ThermalNodeParams, dt_s: Real) -> ThermalNode {
    ThermalNode::new(params, dt(dt_s)).unwrap()
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn follows_the_exponential_and_halves_its_error_with_the_step() {
    let error = |dt_s: Real| {
        let (n, mut s) = (node(NODE, dt_s), ThermalNodeState::at(10.0));
        for _ in 0..(50.0 / dt_s).round() as u32 {
            n.step(&mut s, HEAT);
        }
        // 40 K with a time constant of 100 s.
        (f64::from(s.temperature_c.get()) - (10.0 + 40.0 * (1.0 - (-0.5_f64).exp()))).abs()
    };
    let order = (error(1.0) / error(0.5)).log2();
    assert!(error(0.5) < 0.05 && (0.95..1.05).contains(&order), "order {order}");
}

#[test]
fn is_stable_and_settles_alike_for_steps_of_any_length() {
    for dt_s in [1e-6, 1e-3, 1.0, 1e3, 1e9] {
        let (n, mut s) = (node(NODE, dt_s), ThermalNodeState::at(90.0));
        let mut last_c = 90.0;
        for _ in 0..200 {
            let out = n.step(&mut s, HEAT);
            assert!(out.temperature_c <= last_c && out.temperature_c >= 49.999, "{dt_s}: {out:?}");
            last_c = out.temperature_c;
        }
        assert!(dt_s < 10.0 || (last_c - 50.0).abs() < 1e-3, "{dt_s}: {last_c}");
    }
}

#[test]
fn what_flows_in_less_what_flows_out_is_stored() {
    let (n, mut s) = (node(NODE, 20.0), ThermalNodeState::at(70.0));
    let (p, mut t) = (ThermalPair::new(PAIR, dt(20.0)).unwrap(), ThermalPairState::at(70.0));
    for k in 0..30 {
        let heat_w = if k < 10 { 500.0 } else { 0.0 };
        let before = s.temperature_c;
        let out = n.step(&mut s, ThermalNodeInput { heat_w, ambient_c: 10.0 });
        let stored_j = 500.0 * s.temperature_c.since(before);
        assert!((stored_j - 20.0 * (heat_w - out.cooling_w)).abs() < 2e-6 * 20.0 * 500.0);
        let before = t;
        let input = ThermalPairInput { inner_w: heat_w, outer_w: 100.0, ambient_c: 10.0 };
        let out = p.step(&mut t, input);
        let inner_j = 300.0 * t.inner_c.since(before.inner_c);
        let outer_j = 2000.0 * t.outer_c.since(before.outer_c);
        let given_j = 20.0 * (heat_w + 100.0 - out.cooling_w);
        assert!((inner_j + outer_j - given_j).abs() < 0.05, "{inner_j} {outer_j} {given_j}");
        let inner_out_w = out.between_w + (out.inner_c - 10.0) / 2.0;
        assert!((inner_j - 20.0 * (heat_w - inner_out_w)).abs() < 0.05, "{out:?}");
    }
}

/// Without heat no node leaves the range of the temperatures around it, at any step.
#[test]
fn no_temperature_leaves_what_surrounds_it() {
    for dt_s in [1e-3, 1.0, 100.0, 1e6] {
        let p = ThermalPair::new(PAIR, dt(dt_s)).unwrap();
        let mut s = ThermalPairState { inner_c: Accum::new(120.0), outer_c: Accum::new(-20.0) };
        for _ in 0..100 {
            p.step(&mut s, ThermalPairInput { inner_w: 0.0, outer_w: 0.0, ambient_c: 30.0 });
            for c in [s.inner_c, s.outer_c] {
                assert!((-20.001..=120.001).contains(&c.get()), "{dt_s}: {s:?}");
            }
        }
    }
}

#[test]
fn a_temperature_may_be_held() {
    let (n, mut s) = (node(ThermalNodeParams::FIXED, 1.0), ThermalNodeState::at(33.0));
    assert_eq!(n.step(&mut s, HEAT).temperature_c, 33.0);
    let held = ThermalPairParams { outer: ThermalNodeParams::FIXED, ..PAIR };
    let (p, mut s) = (ThermalPair::new(held, dt(1e6)).unwrap(), ThermalPairState::at(40.0));
    let out = p.step(&mut s, ThermalPairInput { inner_w: 100.0, outer_w: 0.0, ambient_c: 40.0 });
    // 0.05 K/W to the housing beside 2 K/W to the surroundings.
    assert_eq!(out.outer_c, 40.0);
    assert!((out.inner_c - 40.0 - 100.0 / 20.5).abs() < 1e-3, "{out:?}");
}

/// Where hardly anything is stored, the middle of a chain lies between its ends.
#[test]
fn a_chain_of_light_nodes_is_a_divider() {
    let chain = Chain::<5>::new([1e12, 1e-9, 1e-9, 1e-9, 1e12], [0.0; 5], [4.0; 5]);
    let celsius = [100.0, 0.0, 0.0, 0.0, 20.0];
    let increments = chain.increments_k(&celsius, &[0.0; 5], &[0.0; 5]);
    for (i, wanted) in [(1, 80.0), (2, 60.0), (3, 40.0)] {
        assert!((increments[i] - wanted).abs() < 1e-3, "{increments:?}");
    }
}

#[test]
fn bad_input_changes_nothing() {
    let (n, mut s) = (node(NODE, 1.0), ThermalNodeState::at(20.0));
    let (p, mut t) = (ThermalPair::new(PAIR, dt(1.0)).unwrap(), ThermalPairState::at(20.0));
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        assert!(n.step(&mut s, ThermalNodeInput { heat_w: bad, ..HEAT }).rejected);
        assert!(n.step(&mut s, ThermalNodeInput { ambient_c: bad, ..HEAT }).rejected);
        let good = ThermalPairInput { inner_w: 1.0, outer_w: 1.0, ambient_c: 20.0 };
        for input in [
            ThermalPairInput { inner_w: bad, ..good },
            ThermalPairInput { outer_w: bad, ..good },
            ThermalPairInput { ambient_c: bad, ..good },
        ] {
            let out = p.step(&mut t, input);
            assert!(out.rejected && (out.inner_c, out.cooling_w) == (20.0, 0.0));
        }
    }
    assert_eq!((s, t), (ThermalNodeState::at(20.0), ThermalPairState::at(20.0)));
}

#[test]
fn derates_in_proportion_between_its_temperatures() {
    let d = Derating { derate_from_c: 80.0, derate_to_c: 120.0 };
    for (celsius, left) in
        [(-40.0, 1.0), (80.0, 1.0), (90.0, 0.75), (110.0, 0.25), (120.0, 0.0), (500.0, 0.0)]
    {
        assert_eq!(d.factor(celsius), left, "{celsius}");
    }
    assert_eq!(d.factor(Real::NAN), 0.0);
    assert_eq!((Derating::NONE.factor(1e9), Derating::NONE.checked()), (1.0, Ok(Derating::NONE)));
    let never = Derating { derate_to_c: Real::INFINITY, ..d };
    assert!(never.checked().is_ok() && never.factor(1000.0) == 1.0);
}

#[test]
fn copper_resists_in_proportion_to_235_and_its_temperature() {
    for celsius in [-40.0, 20.0, 75.0, 180.0] {
        let exact = (235.0 + celsius) / 255.0;
        assert!((Conductor::COPPER.factor(celsius) - exact).abs() < 1e-6, "{celsius}");
    }
    assert_eq!(Conductor::CONSTANT.factor(300.0), 1.0);
    assert_eq!(Conductor::COPPER.factor(-1000.0), 0.0);
}

/// From losses over a grid of torque and speed, least squares finds the machine again.
#[test]
fn a_measured_drive_is_a_dc_machine() {
    let (kt, truth) = (0.27, [3.0e-3, 2.74, 1.27e-3, 35.0]);
    let losses = DriveLosses::of_dc_machine(kt, truth[0], truth[1], truth[2], truth[3]);
    // Normal equations of a·T² + b·|T| + c·ω² + d.
    let (mut m, mut y) = ([[0.0_f64; 4]; 4], [0.0_f64; 4]);
    for i in -10..=10 {
        for j in 0..=10 {
            let (torque, speed) = (25.0 * f64::from(i), 120.0 * f64::from(j));
            let terms = [torque * torque, torque.abs(), speed * speed, 1.0];
            // What such a machine turns into heat, from its own equations.
            let amps = torque.abs() / f64::from(kt);
            let lost = f64::from(truth[0]) * amps * amps
                + f64::from(truth[1]) * amps
                + f64::from(truth[2]) * speed * speed
                + f64::from(truth[3]);
            let said = f64::from(losses.loss_w(torque as Real, speed as Real));
            assert!((said - lost).abs() < 1e-5 * lost, "{torque} {speed}: {said} {lost}");
            for r in 0..4 {
                y[r] += terms[r] * said;
                for c in 0..4 {
                    m[r][c] += terms[r] * terms[c];
                }
            }
        }
    }
    for r in 0..4 {
        let (row, right, pivot) = (m[r], y[r], m[r][r]);
        for k in 0..4 {
            if k != r {
                let share = m[k][r] / pivot;
                for c in 0..4 {
                    m[k][c] -= share * row[c];
                }
                y[k] -= share * right;
            }
        }
    }
    let found = DriveLosses {
        torque_w_per_nm2: (y[0] / m[0][0]) as Real,
        torque_w_per_nm: (y[1] / m[1][1]) as Real,
        speed_w_s2: (y[2] / m[2][2]) as Real,
        constant_w: (y[3] / m[3][3]) as Real,
    };
    let back =
        [found.resistance_ohm(kt), found.voltage_drop_v(kt), found.speed_w_s2, found.constant_w];
    for (found, truth) in back.into_iter().zip(truth) {
        assert!((found / truth - 1.0).abs() < 1e-3, "{back:?}");
    }
    // The drive of a BMW i3, as driving it shows.
    assert!((losses.torque_w_per_nm2 - 0.041).abs() < 5e-4, "{losses:?}");
    assert!((losses.torque_w_per_nm - 10.1).abs() < 0.06, "{losses:?}");
}

#[test]
fn refuses_each_bad_field_by_name() {
    for bad in [0.0, -1.0, Real::NAN] {
        let refused = |params| ThermalNode::new(params, dt(1.0)).unwrap_err();
        assert_eq!(
            refused(ThermalNodeParams { heat_capacity_j_per_k: bad, ..NODE }),
            ParamError::NotALimit("thermal.heat_capacity_j_per_k")
        );
        assert_eq!(
            refused(ThermalNodeParams { ambient_k_per_w: bad, ..NODE }),
            ParamError::NotALimit("thermal.ambient_k_per_w")
        );
        let (capacity, ambient) = (
            ThermalNodeParams { heat_capacity_j_per_k: bad, ..NODE },
            ThermalNodeParams { ambient_k_per_w: bad, ..NODE },
        );
        for (params, field) in [
            (ThermalPairParams { inner: capacity, ..PAIR }, "thermal.inner.heat_capacity_j_per_k"),
            (ThermalPairParams { outer: capacity, ..PAIR }, "thermal.outer.heat_capacity_j_per_k"),
            (ThermalPairParams { inner: ambient, ..PAIR }, "thermal.inner.ambient_k_per_w"),
            (ThermalPairParams { outer: ambient, ..PAIR }, "thermal.outer.ambient_k_per_w"),
            (ThermalPairParams { between_k_per_w: bad, ..PAIR }, "thermal.between_k_per_w"),
        ] {
            let refused = ThermalPair::new(params, dt(1.0)).unwrap_err();
            assert_eq!(refused, ParamError::NotALimit(field));
        }
    }
    let derating = |from, to| Derating { derate_from_c: from, derate_to_c: to }.checked().err();
    let from = Some(ParamError::OutOfRange("derating.derate_from_c"));
    assert_eq!((derating(Real::NAN, 1.0), derating(-300.0, 1.0)), (from, from));
    let to = Some(ParamError::NotAbove("derating.derate_to_c"));
    assert_eq!((derating(80.0, 80.0), derating(80.0, Real::NAN)), (to, to));
    let conductor = |reference_c, per_k| Conductor { reference_c, per_k }.checked().err();
    let reference = Some(ParamError::OutOfRange("conductor.reference_c"));
    assert_eq!((conductor(Real::NAN, 0.004), conductor(301.0, 0.004)), (reference, reference));
    let rise = Some(ParamError::OutOfRange("conductor.per_k"));
    assert_eq!((conductor(20.0, -1e-9), conductor(20.0, 0.021)), (rise, rise));
    let good = DriveLosses::of_dc_machine(0.3, 1e-3, 1.0, 1e-3, 10.0);
    for (bad, field) in [
        (DriveLosses { torque_w_per_nm2: -1.0, ..good }, "losses.torque_w_per_nm2"),
        (DriveLosses { torque_w_per_nm: -1.0, ..good }, "losses.torque_w_per_nm"),
        (DriveLosses { speed_w_s2: Real::NAN, ..good }, "losses.speed_w_s2"),
        (DriveLosses { constant_w: -1.0, ..good }, "losses.constant_w"),
    ] {
        assert_eq!(bad.checked(), Err(ParamError::Negative(field)));
    }
}
