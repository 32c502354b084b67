//! Each region against its closed form, or its own condition.

extern crate std;
use super::*;

const SALIENT: LinearFlux = LinearFlux { magnet_wb: 0.05, d_h: 1e-4, q_h: 3e-4 };
const ROUND: LinearFlux = LinearFlux { magnet_wb: 0.125, d_h: 7e-3, q_h: 7e-3 };
const RELUCTANCE: LinearFlux = LinearFlux { magnet_wb: 0.0, d_h: 5e-3, q_h: 20e-3 };
const INVERSE: LinearFlux = LinearFlux { magnet_wb: 0.05, d_h: 3e-4, q_h: 1e-4 };

fn close(obtained: Real, target: Real, relative: Real) {
    assert!((obtained - target).abs() <= relative * target.abs(), "{obtained} against {target}");
}

fn flux_of(flux: &LinearFlux, i: Dq) -> Dq {
    Dq { d: flux.magnet_wb + flux.d_h * i.d, q: flux.q_h * i.q }
}

/// Terminal voltage at an electrical speed.
fn voltage_of(t: &Torque, i: Dq, turning: Real) -> Real {
    (i * t.resistance_ohm + flux_of(&t.flux, i).turned() * turning).length()
}

#[test]
fn the_least_current_meets_its_closed_form() {
    for flux in [SALIENT, ROUND, RELUCTANCE, INVERSE] {
        for current_a in [1e-3, 1.0, 20.0, 400.0] {
            // i_d = (ψ_m − √(ψ_m² + 8·b²·I²))/4b.
            let (m, b) = (f64::from(flux.magnet_wb), f64::from(flux.q_h) - f64::from(flux.d_h));
            let i = f64::from(current_a);
            let d =
                if b == 0.0 { 0.0 } else { (m - (m * m + 8.0 * b * b * i * i).sqrt()) / (4.0 * b) };
            let q = (i * i - d * d).sqrt();
            let torque = ((m - b * d) * q) as Real;
            let found = least_current(&flux, torque);
            assert!((f64::from(found.d) - d).abs() < 1e-5 * i, "{found:?} {d} {q}");
            assert!((f64::from(found.q) - q).abs() < 1e-5 * i, "{found:?} {d} {q}");
            close(most_at_current(&flux, current_a), torque, 1e-5);
        }
        assert_eq!(least_current(&flux, 0.0), Dq::ZERO);
    }
}

#[test]
fn a_point_on_the_flux_circle_has_its_flux_and_its_torque() {
    for flux in [SALIENT, ROUND, RELUCTANCE, INVERSE] {
        for flux_wb in [0.01, 0.03, 0.06, 0.1] {
            let peak = on_flux_circle(&flux, Real::INFINITY, flux_wb);
            let most = torque_of(&flux, peak);
            for share in [0.001, 0.1, 0.5, 0.9, 0.99, 0.9999] {
                let i = on_flux_circle(&flux, share * most, flux_wb);
                close(torque_of(&flux, i), share * most, 1e-4);
                close(flux_of(&flux, i).length(), flux_wb, 1e-5);
                assert!(i.d >= peak.d - 1e-4 * peak.length(), "not the nearer: {i:?} {peak:?}");
            }
            // No point of the circle makes more.
            for n in 0..3600_u16 {
                let (sin, cos) = (f64::from(n) / 3600.0 * std::f64::consts::TAU).sin_cos();
                let psi = Dq { d: flux_wb * cos as Real, q: flux_wb * sin as Real };
                let i = Dq { d: (psi.d - flux.magnet_wb) / flux.d_h, q: psi.q / flux.q_h };
                assert!(torque_of(&flux, i) <= most * (1.0 + 1e-5));
            }
        }
    }
}

#[test]
fn a_round_rotor_meets_its_closed_forms_in_each_region() {
    let t = Torque {
        flux: ROUND,
        pole_pairs: 2.0,
        resistance_ohm: 1e-6,
        current_limit_a: 10.0,
        torque_limit_nm: Real::INFINITY,
    };
    // Least current: i_d = 0.
    let slow = t.currents(1.5, 10.0, 100.0);
    assert!(!slow.weakened && !slow.limited && slow.current_a.d == 0.0);
    close(slow.current_a.q, 1.5 / (3.0 * 0.125), 1e-6);
    // The limit of the current.
    let most = t.currents(100.0, 10.0, 100.0);
    close(most.torque_nm, 3.0 * 0.125 * 10.0, 1e-6);
    assert!(most.limited && !most.weakened);
    // Weakened: (ψ_m + L·i_d)² + (L·i_q)² = (V/ω_e)².
    let fast = t.currents(1.5, 450.0, 100.0);
    let q = 1.5 / (3.0 * 0.125);
    let d = (((100.0 / 900.0) * (100.0 / 900.0) - 0.028 * 0.028 as Real).sqrt() - 0.125) / 7e-3;
    assert!(fast.weakened && !fast.limited);
    close(fast.current_a.q, q, 1e-4);
    close(fast.current_a.d, d, 1e-4);
    // On both circles: i_d = ((V/ω_e)² − ψ_m² − L²·I²)/(2·ψ_m·L).
    let both = t.currents(100.0, 450.0, 100.0);
    let d =
        ((100.0 / 900.0) * (100.0 / 900.0) - 0.125 * 0.125 - 0.07 * 0.07) / (2.0 * 0.125 * 7e-3);
    assert!(both.weakened && both.limited);
    close(both.current_a.d, d, 1e-3);
    close(both.current_a.length(), 10.0, 1e-3);
    // Faster than its current can weaken: all of it against the magnets, or next to it.
    let beyond = t.currents(1.0, 5000.0, 100.0);
    close(beyond.current_a.d, -10.0, 1e-3);
    assert!(beyond.limited && beyond.torque_nm.abs() < 0.05, "{beyond:?}");
}

/// Any demand: limits hold, both directions are alike, and more than it finds is not there.
#[test]
#[cfg_attr(miri, ignore = "too many points for an interpreter")]
fn limits_hold_and_nothing_better_is_found_by_trying() {
    for (flux, ohm, amps) in [
        (SALIENT, 8e-3, 400.0),
        (ROUND, 2.98, 5.0),
        (RELUCTANCE, 0.5, 20.0),
        (INVERSE, 0.01, 300.0),
    ] {
        let t = Torque {
            flux,
            pole_pairs: 3.0,
            resistance_ohm: ohm,
            current_limit_a: amps,
            torque_limit_nm: Real::INFINITY,
        };
        let most_nm = 4.5 * most_at_current(&flux, amps);
        for speed in [0.0, 1.0, 50.0, 200.0, 800.0] {
            for volts in [10.0, 30.0, 150.0] {
                for share in [0.1, 0.6, 1.1, -0.1, -1.1] {
                    let found = t.currents(share * most_nm, speed, volts);
                    let i = found.current_a;
                    close(found.torque_nm, 4.5 * torque_of(&flux, i), 1e-5);
                    assert!(i.length() <= amps * (1.0 + 1e-5), "{found:?}");
                    assert!(found.torque_nm.abs() <= (share * most_nm).abs() * (1.0 + 1e-4));
                    let turning = 3.0 * speed;
                    let v = voltage_of(&t, i, turning);
                    let mirror = t.currents(-share * most_nm, -speed, volts);
                    assert_eq!((mirror.torque_nm, mirror.current_a.d), (-found.torque_nm, i.d));
                    if v > volts * 1.003 {
                        // Only where no current at all would do.
                        assert!(found.limited && found.weakened, "{found:?} {v} {volts}");
                        assert!(found.torque_nm.abs() <= 0.02 * most_nm, "{found:?}: {v} {volts}");
                        continue;
                    }
                    // A grid over the circle: nothing allowed makes more of what was asked.
                    for n in 0..40_u16 {
                        for r in 1..=20_u16 {
                            let angle = f64::from(n) / 40.0 * std::f64::consts::TAU;
                            let length = amps * Real::from(r) / 20.0;
                            let other = Dq {
                                d: length * angle.cos() as Real,
                                q: length * angle.sin() as Real,
                            };
                            let allowed = voltage_of(&t, other, turning) <= 0.998 * volts;
                            let torque = 4.5 * torque_of(&flux, other) * share.signum();
                            let made = found.torque_nm * share.signum();
                            if allowed && found.limited {
                                assert!(
                                    torque <= made + 0.005 * most_nm,
                                    "{found:?} {other:?}: {torque} {speed} {volts}"
                                );
                            }
                            if allowed && torque >= made * 1.001 + 1e-3 * most_nm {
                                assert!(other.length() >= i.length() * 0.99, "{found:?} {other:?}");
                            }
                        }
                    }
                }
            }
        }
    }
}
