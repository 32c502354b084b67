//! The machine on its own: its equations at the end of any step, its steady state in closed form,
//! its energy.

extern crate std;
use super::*;
use crate::machine::flux::LinearFlux;
use crate::presets::PMSM_EPOWERTRAIN;

/// A traction machine with two different axes, losses and friction.
const SALIENT: PmsmParams = PmsmParams {
    flux: Flux::Linear(LinearFlux { magnet_wb: 0.05, d_h: 1e-4, q_h: 3e-4 }),
    resistance_ohm: 8e-3,
    resistance_per_k: COPPER_PER_K,
    pole_pairs: 6,
    iron_s: 0.02,
    inertia_kg_m2: 0.04,
    viscous_nm_s_per_rad: 1e-3,
    coulomb_nm: 0.3,
};

fn machine(params: PmsmParams, dt_s: Real) -> Pmsm {
    Pmsm::new(params, Dt::from_s(dt_s).unwrap()).unwrap()
}

fn close(obtained: Real, target: Real, relative: Real) {
    assert!((obtained / target - 1.0).abs() < relative, "{obtained} against {target}");
}

/// Numbers in −1..1.
fn numbers() -> impl FnMut() -> Real {
    let mut seed = 1_u32;
    move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as Real / 8_388_608.0 - 1.0
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn settles_where_the_equations_say_at_any_step() {
    // V_d = −ω_e·L·i_q, V_q = R·i_q + ω_e·ψ_m with i_d chosen zero, 3/2·p·ψ_m·i_q = b·ω + T.
    let (speed_rad_s, load_nm) = (300.0, 0.2);
    let i_q = (1.1e-4 * speed_rad_s + load_nm) / (1.5 * 2.0 * 0.125);
    let voltage_v = Dq { d: -600.0 * 7e-3 * i_q, q: 2.98 * i_q + 600.0 * 0.125 };
    for dt_s in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
        let (m, mut s) = (machine(PMSM_EPOWERTRAIN, dt_s), PmsmState::default());
        let mut out = m.step(&mut s, PmsmInput::cold(voltage_v, load_nm));
        for _ in 0..(1.0 / dt_s) as u32 + 1000 {
            out = m.step(&mut s, PmsmInput::cold(voltage_v, load_nm));
        }
        close(out.speed_rad_s, speed_rad_s, 1e-4);
        close(out.current_a.q, i_q, 1e-3);
        assert!(out.current_a.d.abs() < 1e-3 && !out.beyond_map && !out.rejected, "{out:?}");
        assert_eq!(out.coarse_step, 600.0 * dt_s > FINE_STEP_RAD);
        close(out.electrical_w, out.copper_w + out.air_gap_w, 1e-4);
        close(out.air_gap_w, out.friction_w + load_nm * out.speed_rad_s, 1e-4);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_short_circuit_brakes_as_in_closed_form() {
    // i = −ω_e·(R + ω_e·J·L)⁻¹·J·ψ_m at an imposed speed.
    let (m, mut s) = (machine(SALIENT, 1e-4), PmsmState::default());
    let input = PmsmSpeedInput { voltage_v: Dq::ZERO, speed_rad_s: 50.0, winding_c: REFERENCE_C };
    let mut out = m.step_at_speed(&mut s, input);
    for _ in 0..20_000 {
        out = m.step_at_speed(&mut s, input);
    }
    let (r, x_d, x_q, e) = (8e-3, 300.0 * 1e-4, 300.0 * 3e-4, 300.0 * 0.05);
    let det = r * r + x_d * x_q;
    close(out.current_a.d, -x_q * e / det, 1e-4);
    close(out.current_a.q, -r * e / det, 1e-4);
    let (psi_d, psi_q) = (0.05 + 1e-4 * out.current_a.d, 3e-4 * out.current_a.q);
    let torque = 9.0 * (psi_d * out.current_a.q - psi_q * out.current_a.d);
    close(out.torque_nm, torque, 1e-3);
    let iron = 1.5 * 0.02 * 300.0 * 300.0 * (psi_d * psi_d + psi_q * psi_q);
    close(out.iron_w, iron, 1e-3);
    close(out.shaft_nm, torque - iron / 50.0 - 1e-3 * 50.0 - 0.3, 1e-3);
    assert_eq!((out.electrical_w, out.speed_rad_s), (0.0, 50.0));
}

#[test]
fn a_warm_winding_resists_more() {
    let ohm =
        |winding_c| machine(SALIENT, 1e-4).winding().law(Dq::ZERO, 0.0, winding_c).resistance_ohm;
    close(ohm(25.0), 8e-3, 1e-6);
    close(ohm(155.0), 8e-3 * 1.5, 1e-6);
    assert!(ohm(-100.0) > 0.0);
}

/// Any step against the equations at its end, in double precision.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn every_step_keeps_the_equations_and_its_power() {
    let mut number = numbers();
    let double = |v: Dq| (f64::from(v.d), f64::from(v.q));
    for n in 0..2000 {
        let dt_s = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2][n % 5];
        let m = machine(SALIENT, dt_s);
        let before = PmsmState {
            d_a: Accum::new(300.0 * number()),
            q_a: Accum::new(300.0 * number()),
            speed_rad_s: Accum::new(1200.0 * number()),
        };
        let input = PmsmInput {
            voltage_v: Dq { d: 200.0 * number(), q: 200.0 * number() },
            load_nm: 200.0 * number(),
            winding_c: 100.0 * number() + 50.0,
        };
        let mut now = before;
        let out = m.step(&mut now, input);
        assert!(!out.rejected);
        let h = f64::from(dt_s);
        let (d, q) = double(now.current_a());
        let (d0, q0) = double(before.current_a());
        let w = f64::from(now.speed_rad_s.get());
        let dw = f64::from(now.speed_rad_s.since(before.speed_rad_s));
        let (di, dq) = (f64::from(now.d_a.since(before.d_a)), f64::from(now.q_a.since(before.q_a)));
        let r = 8e-3 * (1.0 + (f64::from(input.winding_c) - 25.0) / 260.0);
        let (l_d, l_q, mean, we0) = (1e-4, 3e-4, 2e-4, 6.0 * (w - dw));
        // ω_e·J·ψ at the old currents, and the skew term with the new ones.
        let psi = (0.05 + l_d * d0, l_q * q0);
        let (gamma_d, gamma_q) = (-(psi.1 - mean * q0), psi.0 - mean * d0);
        let (v_d, v_q) = double(input.voltage_v);
        let terms = [
            [v_d, -r * d, -l_d * di / h, we0 * mean * q, -6.0 * w * gamma_d],
            [v_q, -r * q, -l_q * dq / h, -we0 * mean * d, -6.0 * w * gamma_q],
            [
                9.0 * (gamma_d * d + gamma_q * q),
                -f64::from(input.load_nm),
                -1e-3 * w - 0.3 * if w == 0.0 { 0.0 } else { w.signum() },
                -1.5 * 0.02 * 36.0 * (psi.0 * psi.0 + psi.1 * psi.1) * w,
                -0.04 * dw / h,
            ],
        ];
        for balance in terms {
            let size: f64 = balance.iter().map(|x| x.abs()).sum();
            assert!(balance.iter().sum::<f64>().abs() <= 3e-6 * size, "{n}: {balance:?}");
        }
        // Each of the two axes' powers may be much larger than their sum.
        let flows = [out.electrical_w, -out.copper_w, -out.field_w, -out.air_gap_w].map(f64::from);
        let size = flows.iter().map(|x| x.abs()).sum::<f64>() + (v_d * d).abs() + (v_q * q).abs();
        assert!(flows.iter().sum::<f64>().abs() <= 2e-6 * size, "{n}: {flows:?}");
        let shaft = f64::from(out.shaft_nm) - f64::from(input.load_nm);
        assert!(
            shaft.abs() <= 3e-6 * terms[2].iter().map(|x| x.abs()).sum::<f64>(),
            "{n}: {shaft}"
        );
        // What goes into the field is what it gains, and what the step dissipates.
        let gain = 0.75 * (l_d * (2.0 * d0 + di) * di + l_q * (2.0 * q0 + dq) * dq) / h;
        let lost = 0.75 * (l_d * di * di + l_q * dq * dq) / h;
        let off = f64::from(out.field_w) - gain - lost;
        assert!(off.abs() <= 2e-6 * size.max(gain.abs()), "{n}: {off} of {size}");
    }
}

#[test]
fn diodes_only_feed_the_bus_and_block_below_it() {
    let mut number = numbers();
    let mut blocked = 0;
    for n in 0..3000 {
        let dt_s = [1e-6, 1e-4, 1e-2][n % 3];
        let current_a = Dq { d: 300.0 * number(), q: 300.0 * number() };
        let law = machine(SALIENT, dt_s).winding().law(current_a, 1500.0 * number(), 25.0);
        let largest_v = 200.0 * (1.0 + number());
        let Some(v) = law.diode_v(current_a, largest_v) else {
            blocked += 1;
            // A voltage that the diodes can bear ends the currents.
            assert!(law.voltage_v(current_a * -1.0).length() <= largest_v * 1.001);
            continue;
        };
        close(v.length(), largest_v, 1e-5);
        let reached_a = current_a + law.increment_a(v, 0.0);
        // Close to blocking the current is a small difference.
        let rounding = 1e-5 * (current_a.length() + largest_v * law.admit(v).length() / largest_v);
        let across = reached_a.dot(v.turned()) / largest_v;
        assert!(across.abs() <= 1e-4 * reached_a.length() + rounding, "{n}: {reached_a:?} {v:?}");
        assert!(reached_a.dot(v) <= rounding * largest_v, "{n}: {reached_a:?} {v:?}");
    }
    assert!((300..2700).contains(&blocked), "{blocked}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn it_charges_the_bus_when_it_turns_too_fast_with_gates_off() {
    // 0.05 Wb at 6·1000 rad/s induce 300 V; the diodes hold 150 V.
    let (m, mut s) = (machine(SALIENT, 1e-4), PmsmState::default());
    let (speed_rad_s, mut out) = (1000.0, PmsmOutput::default());
    for _ in 0..5000 {
        let law = m.winding().law(s.current_a(), s.speed_rad_s.get(), 25.0);
        let voltage_v =
            law.diode_v(s.current_a(), 150.0).unwrap_or(law.voltage_v(s.current_a() * -1.0));
        out = m.step_at_speed(&mut s, PmsmSpeedInput { voltage_v, speed_rad_s, winding_c: 25.0 });
    }
    let i = out.current_a;
    // 0 = v + R·i + ω_e·J·ψ with v along i.
    let psi = Dq { d: 0.05 + 1e-4 * i.d, q: 3e-4 * i.q };
    let residual = i * (8e-3 + 150.0 / i.length()) + psi.turned() * 6000.0;
    assert!(residual.length() < 0.5, "{residual:?} {out:?}");
    assert!(out.electrical_w < -1e4 && out.torque_nm < 0.0, "{out:?}");
}

#[test]
fn bad_input_changes_nothing() {
    let (m, mut s) = (machine(SALIENT, 1e-4), PmsmState::default());
    let good = PmsmInput::cold(Dq { d: 1.0, q: 20.0 }, 0.0);
    m.step(&mut s, good);
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        for input in [
            PmsmInput { voltage_v: Dq { d: bad, q: 0.0 }, ..good },
            PmsmInput { voltage_v: Dq { d: 0.0, q: bad }, ..good },
            PmsmInput { load_nm: bad, ..good },
            PmsmInput { winding_c: bad, ..good },
        ] {
            let out = m.step(&mut s, input);
            assert!(out.rejected && s == before && out.electrical_w == 0.0, "{out:?}");
            assert_eq!(out.current_a, s.current_a());
        }
        let input = PmsmSpeedInput { voltage_v: Dq::ZERO, speed_rad_s: bad, winding_c: 25.0 };
        assert!(m.step_at_speed(&mut s, input).rejected && s == before);
    }
    for winding_c in [-101.0, 301.0] {
        assert!(m.step(&mut s, PmsmInput { winding_c, ..good }).rejected);
    }
}

#[test]
fn a_state_that_would_become_absurd_stays() {
    let coil = Flux::Linear(LinearFlux { magnet_wb: 0.1, d_h: 1e-9, q_h: 1e-9 });
    let params = PmsmParams { flux: coil, resistance_ohm: 1e-9, ..SALIENT };
    let (m, mut s) = (machine(params, 1e-3), PmsmState::default());
    let out = m.step(&mut s, PmsmInput::cold(Dq { d: 1e6, q: 0.0 }, 0.0));
    assert!(out.rejected && s == PmsmState::default(), "{out:?}");
}
