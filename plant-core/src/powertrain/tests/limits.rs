//! Limits over many steps, gates off, and what a full battery does.

use super::*;
use crate::presets::{BMW_I3_60AH_CONSTANT, EPOWERTRAIN_UDDS};

/// What the last four fifths of half a second come to.
struct Seen {
    lowest_a: Real,
    highest_a: Real,
    changes: u32,
    jumps: u32,
    last: PowertrainOutput,
    residual_rel: Real,
}

fn run(params: PowertrainParams, dt_s: Real, speed_m_s: Real, input: PowertrainInput) -> Seen {
    let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap().with_ledger();
    let mut s = plant.at_speed(0.8, speed_m_s).unwrap();
    let start = s;
    let steps = (0.5 / dt_s).min(2e5) as u32;
    let mut last = plant.step(&mut s, input);
    let (mut lowest_a, mut highest_a, mut changes, mut jumps) = (1e9, -1e9, 0, 0);
    for n in 1..steps {
        let out = plant.step(&mut s, input);
        changes += u32::from(out.limited != last.limited);
        if n > steps / 5 {
            lowest_a = Real::min(lowest_a, out.battery_a);
            highest_a = Real::max(highest_a, out.battery_a);
            jumps += u32::from((out.drives.duty - last.drives.duty).abs() > 0.01);
        }
        last = out;
    }
    let residual_rel = plant.energy(&start, &s).residual_rel();
    Seen { lowest_a, highest_a, changes, jumps, last, residual_rel }
}

fn with_limits(
    mut params: PowertrainParams,
    discharge_a: Real,
    charge_a: Real,
) -> PowertrainParams {
    (params.battery.discharge_limit_a, params.battery.charge_limit_a) = (discharge_a, charge_a);
    (params.drives.converter.duty_limit, params.drives.converter.current_limit_a) =
        (1.0, Real::INFINITY);
    params
}

/// From the plant's own parameters or asked for by the input, at any step, the current stands at
/// the limit and the duty does not flip.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_current_stands_at_its_limit_at_any_step() {
    let i3 = BMW_I3_60AH_CONSTANT.powertrain;
    let udds = EPOWERTRAIN_UDDS.powertrain;
    for (params, charge_a, speed_m_s, duty) in
        [(i3, 150.0, 20.0, 0.3), (i3, 150.0, 11.0, 0.12), (udds, 100.0, 20.0, 0.1)]
    {
        for dt_s in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 2e-2] {
            let own = with_limits(params, Real::INFINITY, charge_a);
            let free = with_limits(params, Real::INFINITY, Real::INFINITY);
            let limits = CurrentLimits { charge_a, ..CurrentLimits::NONE };
            let asked = PowertrainInput { limits, ..PowertrainInput::on(duty) };
            let same = [(own, PowertrainInput::on(duty)), (free, asked)];
            for (params, input) in same {
                let seen = run(params, dt_s, speed_m_s, input);
                let (low, high) = (seen.lowest_a, seen.highest_a);
                // At the shortest step it has not got there in the time.
                assert!(low >= -1.01 * charge_a, "{dt_s} {duty}: {low}..{high} A");
                let near = if dt_s < 1e-5 { 0.5 } else { 0.98 };
                assert!(high <= -near * charge_a, "{dt_s} {duty}: {low}..{high} A");
                assert!(seen.changes <= 2 && seen.jumps == 0, "{dt_s}: {} changes", seen.changes);
                assert!(seen.residual_rel.abs() < 3e-6, "{dt_s}: {}", seen.residual_rel);
            }
        }
    }
    for dt_s in [1e-5, 1e-3, 2e-2] {
        let limits = CurrentLimits { discharge_a: 60.0, ..CurrentLimits::NONE };
        let input = PowertrainInput { limits, ..PowertrainInput::on(0.6) };
        let seen = run(i3, dt_s, 20.0, input);
        assert!((seen.highest_a - 60.0).abs() < 0.6 && seen.lowest_a > 59.0, "{dt_s}");
        assert!(seen.changes <= 1 && seen.jumps == 0 && seen.last.limited == Limited::Discharge);
    }
}

/// A controller without limits of its own asks for a duty beyond that of the greatest power; the
/// battery gives what it may all the same.
#[test]
fn a_duty_beyond_any_use_draws_all_that_is_allowed() {
    let params = EPOWERTRAIN_UDDS.powertrain;
    for dt_s in [1e-5, 1e-3, 1e-2] {
        for duty in [0.9, 20.0, 99.9, -99.9] {
            let seen = run(params, dt_s, 2.0, PowertrainInput::on(duty));
            assert!(seen.lowest_a > 399.0 && seen.highest_a < 401.0, "{dt_s} {duty}");
            assert!(
                seen.last.limited == Limited::Discharge && seen.last.drives.motor_a * duty > 0.0
            );
        }
    }
}

/// The management cuts the limit while the winding carries more.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_is_beyond_a_limit_that_falls_decays_and_is_reported() {
    for dt_s in [1e-5, 1e-4, 1e-3] {
        let plant =
            Powertrain::new(BMW_I3_60AH_CONSTANT.powertrain, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_speed(0.8, 20.0).unwrap();
        for _ in 0..(0.3 / dt_s) as u32 {
            plant.step(&mut s, PowertrainInput::on(0.3));
        }
        let limits = CurrentLimits { charge_a: 50.0, ..CurrentLimits::NONE };
        let (mut exceeded_a, mut last_a) = (0.0, Real::INFINITY);
        for n in 0..(0.1 / dt_s) as u32 {
            let out = plant.step(&mut s, PowertrainInput { limits, ..PowertrainInput::on(0.3) });
            assert!(out.limit_exceeded_a <= last_a, "{dt_s} {n}: {out:?}");
            let beyond_a = -out.battery_a - 50.0;
            assert!(
                (out.limit_exceeded_a - beyond_a).abs() < 0.06 + 1e-3 * beyond_a || beyond_a < 0.0
            );
            exceeded_a = Real::max(exceeded_a, out.limit_exceeded_a);
            last_a = out.limit_exceeded_a;
        }
        assert!(last_a == 0.0 && exceeded_a > 50.0 && exceeded_a < 120.0, "{dt_s}: {exceeded_a}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn gates_off_let_nothing_flow_unless_the_back_emf_exceeds_the_bus() {
    for dt_s in [1e-5, 1e-3, 2e-2] {
        let seen = run(BMW_I3_60AH_CONSTANT.powertrain, dt_s, 30.0, PowertrainInput::default());
        assert_eq!(
            (seen.last.drives.motor_a, seen.last.drives.duty, seen.last.limited),
            (0.0, 0.0, Limited::No)
        );
        assert!(seen.lowest_a > 0.0 && seen.highest_a < 2.0, "the auxiliary load");
        // 60 m/s of 49: the diodes charge the battery, as one with duty 1 would.
        let params = with_limits(BMW_I3_60AH_CONSTANT.powertrain, 1e4, 1e4);
        let diodes = run(params, dt_s, 60.0, PowertrainInput::default());
        let rectified = run(params, dt_s, 60.0, PowertrainInput::on(1.0));
        let (a, b) = (diodes.last, rectified.last);
        assert!(a.drives.motor_a < -100.0 && a.drives.duty == 1.0, "{a:?}");
        assert!(
            (a.drives.motor_a - b.drives.motor_a).abs() < 1e-3 * b.drives.motor_a.abs(),
            "{a:?} {b:?}"
        );
    }
    // A current that flows when the gates go off ends, and with it the torque.
    let plant = Powertrain::new(BMW_I3_60AH_CONSTANT.powertrain, DT).unwrap();
    let mut s = plant.at_speed(0.8, 10.0).unwrap();
    assert!(plant.step(&mut s, PowertrainInput::on(0.4)).drives.motor_a > 100.0);
    assert_eq!(plant.step(&mut s, PowertrainInput::default()).drives.motor_a, 0.0);
}

/// A duty of 0 is a shorted winding.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_winding_keeps_the_current_limit_of_its_converter() {
    for dt_s in [1e-6, 1e-4, 1e-2] {
        let mut params =
            with_limits(BMW_I3_60AH_CONSTANT.powertrain, Real::INFINITY, Real::INFINITY);
        params.drives.converter.current_limit_a = 1000.0;
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        for duty in [0.0, 1.0] {
            let mut s = plant.at_speed(0.8, 30.0).unwrap();
            let mut acted = 0;
            for _ in 0..(0.05 / dt_s) as u32 {
                let out = plant.step(&mut s, PowertrainInput::on(duty));
                assert!(out.drives.motor_a.abs() <= 1000.1, "{dt_s} {duty}: {out:?}");
                acted += u32::from(out.limited == Limited::Current);
            }
            assert!(acted > 0, "{dt_s} {duty}");
        }
    }
}

#[test]
fn a_drive_that_charges_feeds_the_auxiliary_load() {
    let params = with_limits(BMW_I3_60AH_CONSTANT.powertrain, 1.0, 150.0);
    for soc in [0.5, 0.0] {
        let plant = Powertrain::new(params, crate::must!(Dt::from_s(0.001))).unwrap();
        let mut s = plant.at_speed(soc, 30.0).unwrap();
        let mut out = plant.step(&mut s, PowertrainInput::on(0.45));
        for _ in 0..50 {
            out = plant.step(&mut s, PowertrainInput::on(0.45));
            let fed = (out.flows.auxiliary - 530.0).abs() < 30.0;
            assert!(!out.auxiliary_starved && fed, "{out:?}");
        }
        assert!(out.battery_a < -140.0 && out.limited == Limited::Charge, "{out:?}");
        // At standstill nothing feeds it.
        let mut s = plant.at_rest(soc).unwrap();
        assert!(plant.step(&mut s, PowertrainInput::on(0.0)).auxiliary_starved);
    }
}

/// Downhill, with a back-EMF that no duty holds.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_a_full_battery_is_forced_to_take_has_a_name() {
    for dt_s in [1e-3, 1e-4] {
        let plant = Powertrain::new(BMW_I3_60AH_CONSTANT.powertrain, Dt::from_s(dt_s).unwrap())
            .unwrap()
            .with_ledger();
        let mut s = plant.at_speed(1.0, 55.0).unwrap();
        let road = Road { grade: Grade::from_sin(-0.1), ..Road::default() };
        let (start, mut into_c, mut overcharged_c) = (s, 0.0, 0.0);
        for _ in 0..(5.0 / dt_s) as u32 {
            let out = plant.step(&mut s, PowertrainInput { road, ..PowertrainInput::on(0.9) });
            assert!(out.limit_exceeded_a > 0.0 && out.soc == 1.0, "{out:?}");
            into_c -= f64::from(out.battery_a * dt_s);
            overcharged_c += f64::from(out.overcharged_c);
        }
        assert!(into_c > 50.0 && (overcharged_c / into_c - 1.0).abs() < 1e-3, "{overcharged_c}");
        let report = plant.energy(&start, &s);
        let expected_j = 399.8 * into_c;
        assert!((f64::from(report.overcharge) / expected_j - 1.0).abs() < 1e-3, "{report:?}");
        assert!(report.open_circuit_explicit.abs() < 1e-3 * report.overcharge, "{report:?}");
        assert!(report.residual_rel().abs() < 1e-6, "{report:?}");
    }
}

/// A load whose own voltage drop cuts it out does not switch from step to step.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_load_that_was_cut_out_waits_for_its_voltage() {
    let mut params = BMW_I3_60AH_CONSTANT.powertrain;
    (params.auxiliary.power_w, params.battery.series_resistance_ohm) = (8000.0, 0.3);
    for (cut_out_v, most) in [(370.0, 2), (360.0, 20)] {
        params.auxiliary.cut_out_v = cut_out_v;
        for dt_s in [1e-2, 1e-3, 1e-4] {
            let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
            let mut s = plant.at_rest(0.55).unwrap();
            // A drive that pulls the voltage down and lets it go, once a second.
            let (mut switches, mut last) = (0, true);
            for n in 0..(10.0 / dt_s) as u32 {
                let pulls = (n as Real * dt_s) % 1.0 < 0.1 && cut_out_v < 370.0;
                let duty = if pulls { 0.004 } else { 0.0 };
                let now = plant.step(&mut s, PowertrainInput::on(duty)).flows.auxiliary > 0.0;
                switches += u32::from(now != last);
                last = now;
            }
            assert!(switches <= most, "{cut_out_v} {dt_s}: {switches}");
        }
    }
}

/// The converter's drop from no current on: 427.8 A where the step is short.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_drop_of_the_converter_does_not_keep_a_current_from_growing() {
    for (dt_s, within) in [(1e-2, 0.1), (1e-3, 0.01), (1e-4, 1e-3), (1e-5, 1e-3)] {
        let plant =
            Powertrain::new(BMW_I3_60AH_CONSTANT.powertrain, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_rest(0.8).unwrap();
        for _ in 0..(0.03 / dt_s).round() as u32 {
            plant.step(&mut s, PowertrainInput::on(0.01));
        }
        let a = s.drives.get();
        assert!((a / 427.8 - 1.0).abs() < within, "{dt_s}: {a}");
        // Within the drop nothing flows at all.
        let mut s = plant.at_rest(0.8).unwrap();
        assert_eq!(plant.step(&mut s, PowertrainInput::on(0.002)).drives.motor_a, 0.0);
    }
}
