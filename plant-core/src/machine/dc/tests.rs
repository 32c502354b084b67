//! The motor on its own: published step responses, and its equations at the end of any step.

extern crate std;
use super::*;
use crate::presets::{MOTOR_MOMENTS, MOTOR_PASEK};
use std::vec::Vec;

const RPM_PER_RAD_S: Real = 9.549_297;

fn motor(params: DcMotorParams, dt_s: Real) -> DcMotor {
    DcMotor::new(params, Dt::from_s(dt_s).unwrap()).unwrap()
}

/// 60 V until steady, then 248 V: (before, at the peak, time of the peak, after).
fn step_response(params: DcMotorParams) -> [DcMotorOutput; 3] {
    let (m, mut s) = (motor(params, 1e-5), DcMotorState::default());
    let mut run = |voltage_v, steps| -> Vec<DcMotorOutput> {
        (0..steps).map(|_| m.step(&mut s, DcMotorInput { voltage_v, load_nm: 0.0 })).collect()
    };
    let before = *run(60.0, 200_000).last().unwrap();
    let after = run(248.0, 200_000);
    let peak = after.iter().copied().max_by(|a, b| a.current_a.total_cmp(&b.current_a));
    [before, peak.unwrap(), *after.last().unwrap()]
}

fn close(obtained: Real, target: Real, relative: Real) {
    assert!((obtained / target - 1.0).abs() < relative, "{obtained} against {target}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn reproduces_the_measured_step_with_static_torque() {
    for (params, peak_a) in [(MOTOR_PASEK, 4.674), (MOTOR_MOMENTS, 4.081)] {
        let [before, peak, after] = step_response(params);
        close(before.current_a, 0.1129, 0.005);
        close(after.current_a, 0.1661, 0.005);
        close(before.speed_rad_s * RPM_PER_RAD_S, 407.9, 0.005);
        close(after.speed_rad_s * RPM_PER_RAD_S, 1753.0, 0.005);
        close(peak.current_a, peak_a, 0.01);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn reproduces_the_published_step_without_static_torque() {
    for (params, peak_a) in [(MOTOR_PASEK, 4.578), (MOTOR_MOMENTS, 3.985)] {
        let [_, peak, after] = step_response(DcMotorParams { coulomb_nm: 0.0, ..params });
        close(after.speed_rad_s * RPM_PER_RAD_S, 1774.4, 0.005);
        close(peak.current_a, peak_a, 0.01);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn generates_on_an_imposed_speed() {
    let (m, mut s) = (motor(MOTOR_PASEK, 1e-4), DcMotorState::default());
    let input = DcMotorSpeedInput { voltage_v: 0.0, speed_rad_s: 100.0 };
    let mut out = m.step_at_speed(&mut s, input);
    for _ in 0..10_000 {
        out = m.step_at_speed(&mut s, input);
    }
    close(out.current_a, -132.3 / 30.9, 1e-4);
    close(out.torque_nm, -1.323 * 132.3 / 30.9, 1e-4);
    // What turns the shaft pays for friction too.
    close(out.shaft_nm, out.torque_nm - 0.05 - 0.128, 1e-4);
    assert_eq!(out.speed_rad_s, 100.0);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn stands_still_until_the_torque_exceeds_the_static_torque() {
    let (m, mut s) = (motor(MOTOR_PASEK, 1e-3), DcMotorState::default());
    for (voltage_v, moves) in [(2.9, false), (3.1, true), (0.0, false), (-3.1, true)] {
        for _ in 0..20_000 {
            m.step(&mut s, DcMotorInput { voltage_v, load_nm: 0.0 });
        }
        assert_eq!(s.speed_rad_s.get() != 0.0, moves, "{voltage_v}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn power_in_is_heat_friction_and_mechanical_power_at_steady_state() {
    let (m, mut s) = (motor(MOTOR_PASEK, 1e-3), DcMotorState::default());
    let input = DcMotorInput { voltage_v: 248.0, load_nm: 0.5 };
    let mut out = m.step(&mut s, input);
    for _ in 0..20_000 {
        out = m.step(&mut s, input);
    }
    let power_in = 248.0 * out.current_a;
    close(out.copper_w + out.friction_w + 0.5 * out.speed_rad_s, power_in, 1e-3);
    close(out.shaft_nm, 0.5, 1e-3);
}

#[test]
fn bad_input_changes_nothing() {
    let (m, mut s) = (motor(MOTOR_PASEK, 1e-3), DcMotorState::default());
    m.step(&mut s, DcMotorInput { voltage_v: 60.0, load_nm: 0.0 });
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        for (voltage_v, load_nm) in [(bad, 0.0), (60.0, bad)] {
            assert!(m.step(&mut s, DcMotorInput { voltage_v, load_nm }).rejected);
        }
        let input = DcMotorSpeedInput { voltage_v: 0.0, speed_rad_s: bad };
        assert!(m.step_at_speed(&mut s, input).rejected);
        assert_eq!(s, before);
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let p = MOTOR_PASEK;
    let refused = |p| DcMotor::new(p, Dt::from_s(1e-3).unwrap()).unwrap_err();
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        for (params, field) in [
            (DcMotorParams { resistance_ohm: bad, ..p }, "motor.resistance_ohm"),
            (DcMotorParams { inductance_h: bad, ..p }, "motor.inductance_h"),
            (DcMotorParams { back_emf_v_s_per_rad: bad, ..p }, "motor.back_emf_v_s_per_rad"),
            (DcMotorParams { torque_nm_per_a: bad, ..p }, "motor.torque_nm_per_a"),
            (DcMotorParams { inertia_kg_m2: bad, ..p }, "motor.inertia_kg_m2"),
        ] {
            assert_eq!(refused(params), ParamError::NotPositive(field));
        }
        for (params, field) in [
            (DcMotorParams { viscous_nm_s_per_rad: bad, ..p }, "motor.viscous_nm_s_per_rad"),
            (DcMotorParams { coulomb_nm: bad, ..p }, "motor.coulomb_nm"),
        ] {
            assert_eq!(refused(params), ParamError::Negative(field));
        }
    }
}

/// Any step against the two equations at its end, in double precision, and what it says of it.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_step_keeps_the_equations() {
    let p = DcMotorParams { torque_nm_per_a: 1.2, ..MOTOR_PASEK };
    let m = motor(p, 1e-3);
    let mut seed = 1_u32;
    let mut number = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as Real / 8_388_608.0 - 1.0
    };
    let near = |a: f64, b: f64, size: f64| (a - b).abs() <= 2e-6 * size + 1e-7;
    let mut slips = [0; 3];
    for n in 0..1000 {
        let small = if n % 2 == 0 { 1.0 } else { 0.01 };
        let before = DcMotorState {
            current_a: Accum::new(small * 5.0 * number()),
            speed_rad_s: Accum::new(small * 200.0 * number()),
        };
        let (voltage_v, load_nm) = (small * 300.0 * number(), small * 3.0 * number());
        let speed_rad_s = if n % 5 == 0 { 0.0 } else { 100.0 * number() };
        for imposed in [false, true] {
            let mut now = before;
            let out = if imposed {
                m.step_at_speed(&mut now, DcMotorSpeedInput { voltage_v, speed_rad_s })
            } else {
                m.step(&mut now, DcMotorInput { voltage_v, load_nm })
            };
            assert!(!out.rejected);
            let (i, w) = (f64::from(now.current_a.get()), f64::from(now.speed_rad_s.get()));
            let di = f64::from(now.current_a.since(before.current_a)) / 1e-3;
            let dw = f64::from(now.speed_rad_s.since(before.speed_rad_s)) / 1e-3;
            let terms = [p.resistance_ohm, p.back_emf_v_s_per_rad, p.inductance_h].map(f64::from);
            let (r, ke, l) = (terms[0], terms[1], terms[2]);
            let size = f64::from(voltage_v.abs()) + r * i.abs() + ke * w.abs() + l * di.abs();
            assert!(near(f64::from(voltage_v), r * i + ke * w + l * di, size), "{out:?}");
            let torque = f64::from(p.torque_nm_per_a) * i;
            let friction = f64::from(p.viscous_nm_s_per_rad) * w
                + f64::from(p.coulomb_nm) * if w == 0.0 { 0.0 } else { w.signum() };
            let inertia = f64::from(p.inertia_kg_m2) * dw;
            let shaft = torque - friction - inertia;
            let size = torque.abs() + friction.abs() + inertia.abs();
            assert!(near(f64::from(out.shaft_nm), shaft, size), "{out:?} {shaft}");
            if imposed {
                assert!(near(w, f64::from(speed_rad_s), 200.0), "{w} {speed_rad_s}");
            } else if w == 0.0 {
                // Static torque carries what the load leaves.
                let carried = (shaft - f64::from(load_nm)).abs();
                assert!(carried <= f64::from(p.coulomb_nm) * (1.0 + 1e-5) + 1e-6, "{carried}");
            } else {
                assert!(near(shaft, f64::from(load_nm), size), "{out:?} {load_nm}");
            }
            assert_eq!(
                (out.current_a, out.speed_rad_s),
                (now.current_a.get(), now.speed_rad_s.get())
            );
            assert!(near(f64::from(out.torque_nm), torque, torque.abs()));
            assert!(near(f64::from(out.back_emf_v), ke * w, ke * w.abs()));
            assert!(near(f64::from(out.copper_w), r * i * i, r * i * i));
            assert!(near(f64::from(out.friction_w), friction * w, friction.abs() * w.abs()));
            slips[if w == 0.0 { 0 } else { 1 + usize::from(w > 0.0) }] += 1;
        }
    }
    assert!(slips.iter().all(|n| *n > 20), "{slips:?}");
}

#[test]
fn a_state_that_would_become_absurd_stays() {
    let superconducting = DcMotorParams { resistance_ohm: 1e-6, inductance_h: 1e-9, ..MOTOR_PASEK };
    let light = DcMotorParams { inertia_kg_m2: 1e-9, viscous_nm_s_per_rad: 0.0, ..MOTOR_PASEK };
    let still = DcMotorParams { inertia_kg_m2: 1e12, ..superconducting };
    let weak = DcMotorParams { torque_nm_per_a: 1e-6, back_emf_v_s_per_rad: 1e-6, ..light };
    for (params, voltage_v, load_nm) in [(still, 1e8, 0.0), (weak, 0.0, 1e8)] {
        let (m, mut s) = (motor(params, 1e-3), DcMotorState::default());
        let out = m.step(&mut s, DcMotorInput { voltage_v, load_nm });
        assert!(out.rejected && s == DcMotorState::default(), "{out:?}");
    }
}

#[test]
fn a_state_becomes_large_in_two_steps_but_not_absurd() {
    // 6e8 A, or 6e8 rad/s, in each step.
    let coil = DcMotorParams {
        resistance_ohm: 1e-12,
        inductance_h: 1e-9,
        back_emf_v_s_per_rad: 1e-12,
        ..MOTOR_PASEK
    };
    let top = DcMotorParams {
        torque_nm_per_a: 1e-12,
        back_emf_v_s_per_rad: 1e-12,
        inertia_kg_m2: 1e-9,
        viscous_nm_s_per_rad: 0.0,
        coulomb_nm: 0.0,
        ..MOTOR_PASEK
    };
    let inputs = [(DcMotorParams { inertia_kg_m2: 1e12, ..coil }, 600.0, 0.0), (top, 0.0, -600.0)];
    for (params, voltage_v, load_nm) in inputs {
        let (m, mut s) = (motor(params, 1e-3), DcMotorState::default());
        let first = m.step(&mut s, DcMotorInput { voltage_v, load_nm });
        let before = s;
        let second = m.step(&mut s, DcMotorInput { voltage_v, load_nm });
        assert!(!first.rejected && second.rejected && s == before, "{first:?} {second:?}");
        assert!((first.current_a + first.speed_rad_s - 6e8).abs() < 1e6, "{first:?}");
    }
}
