extern crate std;

use plant_core::battery::{
    MappedBatteryInput, MappedBatteryParams, MappedBatteryState, OpenCircuit,
};
use plant_core::must;
use plant_core::num::SocTable;
use plant_core::presets::PANASONIC_NCR18650PF;

use super::*;

mod trust;

const DT: Dt = must!(Dt::from_s(1.0));
const PARAMS: EkfParams = EkfParams::typical(PANASONIC_NCR18650PF, 3.65);
const EKF: Ekf = must!(Ekf::new(PARAMS, DT));
const CELL: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));

/// A load that a car could have: its mean is a third of the capacity in an hour.
fn load_a(second: u32) -> Real {
    match second % 60 {
        0..=9 => 0.0,
        10..=39 => 1.4,
        40..=49 => 4.0,
        _ => -2.2,
    }
}

/// One second of the cell, seen by sensors.
fn sample(cell: &mut MappedBatteryState, current_a: Real) -> EkfInput {
    let out = CELL.step(cell, MappedBatteryInput { current_a });
    EkfInput { current_a, voltage_v: out.terminal_v, temperature_c: 25.0, contactors_open: false }
}

/// Error and standard deviation at each second of a drive from a wrong start.
fn drive(ekf: &Ekf, start: Real, told: Real, sd: Real, seconds: u32) -> std::vec::Vec<[Real; 2]> {
    let mut cell = CELL.rested(start).unwrap();
    let mut state = ekf.start(told, sd, 25.0).unwrap();
    (0..seconds)
        .map(|second| {
            let input = sample(&mut cell, load_a(second));
            assert!(!ekf.step(&mut state, input).rejected);
            let estimate = ekf.estimate(&state);
            [estimate.soc - cell.soc.get(), estimate.soc_sd]
        })
        .collect()
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn finds_the_state_of_charge_from_a_wrong_start() {
    for (start, told) in [(0.9, 0.6), (0.6, 0.9), (0.5, 0.4)] {
        let run = drive(&EKF, start, told, 0.3, 3600);
        for (second, [error, sd]) in run.iter().enumerate() {
            assert!(error.abs() <= 3.0 * sd, "{start} told {told}, {second} s: {error} ± {sd}");
        }
        let [error, sd] = run[300];
        assert!(error.abs() < 0.02 && sd < 0.035, "{start} told {told}: {error} ± {sd}");
    }
}

#[test]
fn a_known_start_is_not_spoilt() {
    for [error, sd] in drive(&EKF, 0.8, 0.8, 0.01, 600) {
        assert!(error.abs() < 0.005 && sd > 0.005, "{error} ± {sd}");
    }
}

#[test]
fn a_rest_tells_what_the_curve_allows() {
    for soc in [0.2, 0.5, 0.9] {
        let (voltage_v, slope) = PANASONIC_NCR18650PF.open_circuit.with_slope(soc);
        let estimate = EKF.estimate(&EKF.start_rested(voltage_v, 25.0).unwrap());
        assert!((estimate.soc - soc).abs() < 1e-3, "{soc}: {}", estimate.soc);
        let sd = PARAMS.uncertainty.open_circuit_sd_v / slope;
        assert!((estimate.soc_sd / sd - 1.0).abs() < 0.15, "{soc}: {} for {sd}", estimate.soc_sd);
    }
}

/// However long it rests, the curve's own error stays: nothing is averaged away.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn rest_does_not_make_it_sure() {
    let mut state = EKF.start_unknown(25.0).unwrap();
    let (voltage_v, slope) = PANASONIC_NCR18650PF.open_circuit.with_slope(0.5);
    let input = EkfInput { current_a: 0.0, voltage_v, temperature_c: 25.0, contactors_open: false };
    for _ in 0..100_000 {
        EKF.step(&mut state, input);
    }
    let estimate = EKF.estimate(&state);
    let least = PARAMS.uncertainty.open_circuit_sd_v / slope;
    assert!(estimate.soc_sd > 0.9 * least, "{} where {least} is the least", estimate.soc_sd);
    assert!((estimate.soc - 0.5).abs() < 0.01);
}

/// The cell loses charge that the ammeter does not see: half of what is known of its offset and a
/// tenth, at one and ten samples a second.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_drain_that_is_not_seen_stays_within_what_is_claimed() {
    for (dt_s, hours) in [(1.0, 60), (0.1, 20)] {
        let ekf = Ekf::new(PARAMS, Dt::from_s(dt_s).unwrap()).unwrap();
        for (start, drain_a) in [(0.9, 0.005), (0.6, 0.015), (0.6, 0.003)] {
            let mut state = ekf.start(start, 0.02, 25.0).unwrap();
            for step in 0..hours * (3600.0 / dt_s) as u32 {
                let soc = start - drain_a * dt_s * step as Real / 3600.0 / 2.968;
                let voltage_v = PANASONIC_NCR18650PF.open_circuit.at(soc)
                    + if step % 2 == 0 { 1e-3 } else { -1e-3 };
                ekf.step(
                    &mut state,
                    EkfInput {
                        current_a: 0.0,
                        voltage_v,
                        temperature_c: 25.0,
                        contactors_open: false,
                    },
                );
                let Estimate { soc: told, soc_sd, .. } = ekf.estimate(&state);
                assert!((told - soc).abs() <= 2.0 * soc_sd, "{step}: {told} ± {soc_sd} for {soc}");
            }
            // A cell whose curve is known to 10 mV and rises by at most 1.3 V.
            assert!(ekf.estimate(&state).soc_sd > 0.6 * 0.010 / 1.3);
        }
    }
}

/// Two amperes for 25 minutes in the cold, a reset, and the load is gone.
#[test]
fn a_reset_while_polarised_is_within_what_is_claimed() {
    for celsius in [25.0, 0.0, -10.0] {
        let mut cell = CELL.rested_at(0.9, celsius).unwrap();
        for _ in 0..1500 {
            CELL.step(&mut cell, MappedBatteryInput { current_a: 2.0 });
        }
        let mut state = EKF.start(cell.soc.get(), 0.05, celsius).unwrap();
        for second in 0..3600 {
            EKF.step(&mut state, EkfInput { temperature_c: celsius, ..sample(&mut cell, 0.0) });
            let Estimate { soc, soc_sd, .. } = EKF.estimate(&state);
            let error = soc - cell.soc.get();
            assert!(error.abs() <= 3.0 * soc_sd, "{celsius} °C, {second} s: {error} ± {soc_sd}");
        }
    }
}

/// Driven, put to sleep for some time, woken from what was remembered: as if it had run on.
#[test]
fn what_is_remembered_is_aged_by_the_time_off() {
    let mut cell = CELL.rested(0.9).unwrap();
    let mut state = EKF.start(0.9, 0.01, 25.0).unwrap();
    for second in 0..1500 {
        EKF.step(&mut state, sample(&mut cell, 2.0 + load_a(second)));
    }
    let memory = EKF.remember(&state);
    for minutes in [1_u16, 30, 600] {
        let (mut cell, mut awake) = (cell, state);
        for _ in 0..60 * minutes {
            EKF.step(&mut awake, sample(&mut cell, 0.0));
        }
        let seconds = 60.0 * Real::from(minutes);
        let mut woken = EKF.resume(memory, Some(seconds), 25.0).unwrap();
        for (told, known) in woken.polarisation_v.iter().zip(awake.polarisation_v) {
            assert!((told - known).abs() < 1e-3, "{minutes}: {woken:?}");
        }
        assert!(woken.soc() == memory.soc && woken.variance() >= memory.soc_sd * memory.soc_sd);
        for _ in 0..600 {
            EKF.step(&mut woken, sample(&mut cell, 0.0));
            let Estimate { soc, soc_sd, .. } = EKF.estimate(&woken);
            assert!((soc - cell.soc.get()).abs() <= 2.0 * soc_sd, "{minutes}: {soc} ± {soc_sd}");
        }
        let rested = EKF.resume(memory, Some(seconds), 25.0).unwrap();
        let unknown = EKF.resume(memory, None, 25.0).unwrap();
        assert!(unknown.variance() > rested.variance());
    }
    // A month of stand-by is a quarter of the capacity, one standard deviation.
    let month = EKF.resume(memory, Some(30.0 * 86_400.0), 25.0).unwrap();
    assert!((0.2..0.3).contains(&EKF.estimate(&month).soc_sd));
    for bad in [Real::NAN, -1.0, Real::INFINITY] {
        let mut other = state;
        EKF.pause(&mut other, Some(bad));
        let mut none = state;
        EKF.pause(&mut none, None);
        assert_eq!(other, none, "no time is an unknown one");
        let wrong = EkfMemory { soc: bad, ..memory };
        assert_eq!(EKF.resume(wrong, None, 25.0).unwrap_err().field(), "soc");
        let polarisation = Some(Polarisation { load_a: bad, ..Polarisation::NONE });
        let wrong = EkfMemory { polarisation, ..memory };
        let refused = EKF.resume(wrong, None, 25.0).unwrap_err();
        assert_eq!(refused.field(), "polarisation.load_a");
    }
}

/// A cell with four fifths of the capacity and nearly twice the resistance, told and not told.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn takes_over_what_was_learnt_of_the_health() {
    use crate::Health;
    let health = Health {
        capacity_ah: 0.8 * 2.968,
        capacity_sd_ah: 0.03,
        resistance_factor: 1.8,
        resistance_factor_sd: 0.05,
    };
    let error = |told: Option<Health>| {
        let mut cell = CELL.rested(0.9).unwrap();
        let mut state = EKF.start(0.9, 0.01, 25.0).unwrap();
        if let Some(health) = told {
            EKF.adopt(&mut state, &health);
        }
        let (mut soc, mut worst) = (0.9, 0.0);
        for second in 0..3600 {
            let current_a = load_a(second);
            let out = CELL.step(&mut cell, MappedBatteryInput { current_a });
            soc -= current_a / (3600.0 * health.capacity_ah);
            // The voltage of the aged cell at its own state of charge.
            let over_v = CELL.open_circuit().at(cell.soc.get()) - out.terminal_v;
            let input = EkfInput {
                current_a,
                voltage_v: CELL.open_circuit().at(soc) - 1.8 * over_v,
                temperature_c: 25.0,
                contactors_open: false,
            };
            EKF.step(&mut state, input);
            worst = max(worst, (state.soc() - soc).abs());
        }
        (worst, state)
    };
    let (told, knows) = error(Some(health));
    let (untold, new) = error(None);
    assert!(told < 0.01 && untold > 2.0 * told, "{told} {untold}");
    assert!(knows.variance() < new.variance());
    // What is not known better than was declared is not taken, nor is what is none.
    let vague = Health { capacity_sd_ah: 0.5, resistance_factor_sd: 1.0, ..health };
    let none = Health { capacity_ah: Real::NAN, resistance_factor: -1.0, ..health };
    for useless in [vague, none] {
        let mut state = new;
        EKF.adopt(&mut state, &useless);
        assert_eq!(state, new);
    }
}

/// One sample of five is missing. The truth is known all along: so it is afterwards.
#[test]
fn isolated_dropouts_are_bridged() {
    let mut cell = CELL.rested(0.9).unwrap();
    let (mut state, mut whole) =
        (EKF.start(0.9, 0.01, 25.0).unwrap(), EKF.start(0.9, 0.01, 25.0).unwrap());
    for second in 0..3600 {
        let mut input = sample(&mut cell, load_a(second));
        EKF.step(&mut whole, input);
        if second % 5 == 0 {
            (input.current_a, input.voltage_v) = (Real::NAN, Real::NAN);
        }
        EKF.step(&mut state, input);
    }
    let (with, without) = (EKF.estimate(&state), EKF.estimate(&whole));
    assert!((with.soc - without.soc).abs() < 0.01, "{with:?} {without:?}");
    assert!(with.soc_sd < 1.5 * without.soc_sd, "{with:?} {without:?}");
}

#[test]
fn bad_samples_hold_the_estimate_and_cost_confidence() {
    let mut cell = CELL.rested(0.7).unwrap();
    let mut good = EKF.start(0.7, 0.02, 25.0).unwrap();
    for second in 0..300 {
        EKF.step(&mut good, sample(&mut cell, load_a(second)));
    }
    let before = EKF.estimate(&good);
    let input = sample(&mut cell, 0.0);
    for bad in [Real::NAN, Real::INFINITY, -Real::INFINITY, 1e38] {
        let mut state = good;
        for _ in 0..30 {
            let out = EKF.step(&mut state, EkfInput { current_a: bad, ..input });
            assert!(out.rejected);
        }
        let held = EKF.estimate(&state);
        assert!((held.soc - before.soc).abs() < 1e-3, "{bad}: {} {}", held.soc, before.soc);
        assert!(held.soc_sd > before.soc_sd, "{bad}");
        // Without a voltage the charge is still counted.
        let mut state = good;
        assert!(
            EKF.step(&mut state, EkfInput { voltage_v: bad, current_a: 2.0, ..input }).rejected
        );
        assert!(EKF.estimate(&state).soc < before.soc);
        // A missing temperature is the last one.
        let mut state = good;
        for _ in 0..2 {
            let out = EKF.step(&mut state, EkfInput { temperature_c: bad, ..input });
            assert!(!out.rejected && EKF.status(&state).temperature_missing);
        }
        assert_eq!(EKF.estimate(&state).temperature_c, 25.0);
        // Data return: so does the estimate.
        let mut cell = cell;
        for second in 0..600 {
            let mut input = sample(&mut cell, load_a(second));
            if second < 60 {
                input.current_a = bad;
            }
            EKF.step(&mut state, input);
        }
        let back = EKF.estimate(&state);
        let error = back.soc - cell.soc.get();
        assert!(error.abs() < 0.02 && error.abs() < 3.0 * back.soc_sd, "{bad}: {error}");
        assert!(EKF.status(&state).consistent && !EKF.status(&state).temperature_missing);
    }
}

#[test]
fn one_absurd_voltage_moves_nothing_and_a_lasting_one_wins() {
    let mut cell = CELL.rested(0.6).unwrap();
    let mut state = EKF.start(0.6, 0.02, 25.0).unwrap();
    for second in 0..300 {
        EKF.step(&mut state, sample(&mut cell, load_a(second)));
    }
    let before = EKF.estimate(&state);
    let mut input = sample(&mut cell, 0.0);
    input.voltage_v -= 1.5;
    EKF.step(&mut state, input);
    let after = EKF.estimate(&state);
    assert!((after.soc - before.soc).abs() < 1e-6 && after.soc_sd >= before.soc_sd);
    for _ in 0..3600 {
        EKF.step(&mut state, input);
    }
    assert!(!EKF.status(&state).consistent);
    assert!(EKF.estimate(&state).soc_sd > 2.0 * before.soc_sd);
}

#[test]
fn learns_the_offset_only_with_open_contactors() {
    let mut state = EKF.start(0.6, 0.01, 25.0).unwrap();
    let (voltage_v, _) = PANASONIC_NCR18650PF.open_circuit.with_slope(0.6);
    let closed =
        EkfInput { current_a: 0.05, voltage_v, temperature_c: 25.0, contactors_open: false };
    for _ in 0..120 {
        EKF.step(&mut state, closed);
    }
    assert_eq!(state.current_offset_a, 0.0);
    let before = state.soc();
    for _ in 0..300 {
        EKF.step(&mut state, EkfInput { contactors_open: true, ..closed });
    }
    assert!((state.current_offset_a - 0.05).abs() < 0.001, "{}", state.current_offset_a);
    assert!((state.soc() - before).abs() < 0.002, "no current flowed");
}

#[test]
fn a_flat_curve_is_not_asked() {
    const FLAT: EkfParams = EkfParams {
        battery: plant_core::battery::MappedBatteryParams {
            open_circuit: OpenCircuit::Table(must!(SocTable::from_points(
                "open_circuit",
                &[(0.0, 2.9), (0.1, 3.27), (0.9, 3.28), (1.0, 3.45)]
            ))),
            ..PANASONIC_NCR18650PF
        },
        ..PARAMS
    };
    const EKF: Ekf = must!(Ekf::new(FLAT, DT));
    let mut state = EKF.start(0.5, 0.2, 25.0).unwrap();
    let input =
        EkfInput { current_a: 0.0, voltage_v: 3.27, temperature_c: 25.0, contactors_open: false };
    for _ in 0..1000 {
        EKF.step(&mut state, input);
    }
    let estimate = EKF.estimate(&state);
    assert!(EKF.status(&state).flat && !EKF.status(&state).converged);
    assert!((estimate.soc - 0.5).abs() < 1e-3 && estimate.soc_sd > 0.19, "{estimate:?}");
    let rested = EKF.estimate(&EKF.start_rested(3.275, 25.0).unwrap());
    assert!(rested.soc_sd > 0.25, "{rested:?}");
}

#[test]
fn says_where_the_model_does_not_hold() {
    let mut state = EKF.start(0.05, 0.02, 25.0).unwrap();
    assert!(EKF.status(&state).outside_identified);
    let input =
        EkfInput { current_a: 0.0, voltage_v: 3.9, temperature_c: 25.0, contactors_open: false };
    // A start that was wrong by 70 % finds back all the same.
    let mut wrong = EKF.start(0.05, 0.3, 25.0).unwrap();
    for _ in 0..60 {
        EKF.step(&mut state, input);
        EKF.step(&mut wrong, input);
    }
    assert!((EKF.estimate(&wrong).soc - 0.77).abs() < 0.05, "{:?}", EKF.estimate(&wrong));
}

#[test]
fn refuses_each_bad_field_by_name() {
    let bad = |change: &dyn Fn(&mut EkfParams)| {
        let mut params = PARAMS;
        change(&mut params);
        Ekf::new(params, DT).unwrap_err().field()
    };
    for value in [-1.0, Real::NAN, Real::INFINITY] {
        assert_eq!(
            bad(&|p| p.uncertainty.open_circuit_sd_v = value),
            "ekf.uncertainty.open_circuit_sd_v"
        );
        assert_eq!(bad(&|p| p.uncertainty.resistance_sd = value), "ekf.uncertainty.resistance_sd");
        assert_eq!(
            bad(&|p| p.uncertainty.activation_sd_k = value),
            "ekf.uncertainty.activation_sd_k"
        );
        assert_eq!(bad(&|p| p.uncertainty.capacity_sd = value), "ekf.uncertainty.capacity_sd");
        assert_eq!(
            bad(&|p| p.uncertainty.current_offset_sd_a = value),
            "ekf.uncertainty.current_offset_sd_a"
        );
        assert_eq!(bad(&|p| p.uncertainty.standby_sd_a = value), "ekf.uncertainty.standby_sd_a");
        assert_eq!(bad(&|p| p.uncertainty.voltage_sd_v = value), "ekf.uncertainty.voltage_sd_v");
        assert_eq!(
            bad(&|p| p.uncertainty.polarisation_sd_v = value),
            "ekf.uncertainty.polarisation_sd_v"
        );
        assert_eq!(
            bad(&|p| p.uncertainty.correlation_soc = value),
            "ekf.uncertainty.correlation_soc"
        );
        assert_eq!(
            bad(&|p| p.uncertainty.outside_factor = value),
            "ekf.uncertainty.outside_factor"
        );
        assert_eq!(bad(&|p| p.flat_v_per_soc = value), "ekf.flat_v_per_soc");
        assert_eq!(bad(&|p| p.converged_sd = value), "ekf.converged_sd");
        assert_eq!(bad(&|p| p.battery.capacity_ah = value), "battery.capacity_ah");
    }
    assert_eq!(bad(&|p| p.unseen_current_a = 0.0), "ekf.unseen_current_a");
    assert_eq!(bad(&|p| p.uncertainty.correlation_soc = 1.5), "ekf.uncertainty.correlation_soc");
    assert_eq!(bad(&|p| p.uncertainty.outside_factor = 0.5), "ekf.uncertainty.outside_factor");
    for soc in [-0.1, 1.1, Real::NAN] {
        assert_eq!(EKF.start(soc, 0.1, 25.0).unwrap_err().field(), "soc");
        assert_eq!(EKF.start(0.5, soc, 25.0).unwrap_err().field(), "soc_sd");
    }
    assert_eq!(EKF.start_unknown(Real::NAN).unwrap_err().field(), "temperature_c");
    assert_eq!(EKF.start_rested(Real::NAN, 25.0).unwrap_err().field(), "voltage_v");
}
