//! What the filter makes of a world that is not as declared.

use super::*;

#[test]
fn an_error_forgets_as_a_sum_of_independent_parts_does() {
    let mut state = EKF.start(0.6, 0.01, 25.0).unwrap();
    state.slow.polarisation_sd_v = 0.0;
    state.slow.before_sd_a = 0.0;
    state.slow.load_a = 4.0;
    EKF.follow_error(&mut state, 0.0);
    let loaded_v2 = state.slow.error_sd_v * state.slow.error_sd_v;
    state.error_v = 0.01;
    state.error_variance_v2 = loaded_v2;
    state.slow.load_a = 0.0;
    EKF.follow_error(&mut state, 0.0);
    let left_v2 = state.slow.error_sd_v * state.slow.error_sd_v;
    assert!(left_v2 < 0.5 * loaded_v2, "the load is a large part of it");
    // Of a sum e = a + b with the variances A + B, b gone: E(a | e) = e·A/(A + B).
    let kept = state.error_v / 0.01;
    assert!((kept - left_v2 / loaded_v2).abs() < 1e-3, "{kept} {left_v2} {loaded_v2}");
    assert!((state.error_variance_v2 / left_v2 - 1.0).abs() < 1e-3);
}

/// Drives a flat cell for ten minutes, seen through an ammeter: the share of the last five in which it
/// is consistent and inside what it knows.
fn on_a_plateau(ammeter: impl Fn(Real) -> Real) -> Real {
    const FLAT: MappedBatteryParams = MappedBatteryParams {
        open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
            "open_circuit",
            &[(0.0, 2.8), (0.1, 3.2), (0.3, 3.29), (0.7, 3.31), (0.95, 3.34), (1.0, 3.5)]
        ))),
        ..PANASONIC_NCR18650PF
    };
    let plant = MappedBattery::new(FLAT, DT).unwrap();
    let ekf = Ekf::new(EkfParams::typical(FLAT, 3.3), DT).unwrap();
    let mut cell = plant.rested(0.5).unwrap();
    let mut state = ekf.start(0.5, 0.03, 25.0).unwrap();
    let mut consistent = 0.0;
    for second in 0..600 {
        let out = plant.step(&mut cell, MappedBatteryInput { current_a: load_a(second) });
        let input = EkfInput {
            current_a: ammeter(load_a(second)),
            voltage_v: out.terminal_v,
            temperature_c: 25.0,
            contactors_open: false,
        };
        ekf.step(&mut state, input);
        let status = ekf.status(&state);
        if second >= 300 && status.consistent && !status.outside_identified {
            consistent += 1.0;
        }
    }
    consistent / 300.0
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn an_ammeter_that_lies_is_told_by_how_the_voltage_reacts() {
    assert_eq!(on_a_plateau(|current_a| current_a), 1.0);
    assert_eq!(on_a_plateau(|current_a| 1.05 * current_a + 0.02), 1.0);
    for (ammeter, name) in [
        ((|_| 0.0) as fn(Real) -> Real, "dead"),
        (|_| 1.5, "stuck"),
        (|current_a| -current_a, "reversed"),
    ] {
        assert_eq!(on_a_plateau(ammeter), 0.0, "{name}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_start_that_needs_a_large_error_is_doubted() {
    for off in [0.08, -0.08] {
        let run = drive(&EKF, 0.7, 0.7 + off, 0.01, 1200);
        let outside = run[60..].iter().filter(|[error, sd]| error.abs() > 3.0 * sd).count();
        assert!(outside < 300, "{off}: outside for {outside} s");
        let [error, _] = run[1199];
        assert!(error.abs() < 0.5 * 0.08, "{off}: {error}");
    }
    // One that is right is not.
    let [_, sd] = drive(&EKF, 0.7, 0.7, 0.01, 1200)[1199];
    assert!(sd < 0.015, "{sd}");
}

#[test]
fn a_start_on_a_plateau_is_known_no_better_than_the_voltage_could_tell() {
    const FLAT: MappedBatteryParams = MappedBatteryParams {
        open_circuit: OpenCircuit::Linear { empty_v: 3.2, full_v: 3.3 },
        ..PANASONIC_NCR18650PF
    };
    let flat = Ekf::new(EkfParams::typical(FLAT, 3.25), DT).unwrap();
    let sd = |ekf: &Ekf, told| ekf.estimate(&ekf.start(0.5, told, 25.0).unwrap()).soc_sd;
    assert!((sd(&flat, 0.005) - 0.027).abs() < 1e-4);
    assert!((sd(&flat, 0.05) - 0.05).abs() < 1e-4);
    assert!((sd(&EKF, 0.005) - 0.005).abs() < 1e-4);
}
