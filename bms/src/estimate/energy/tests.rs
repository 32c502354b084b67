extern crate std;
use plant_core::battery::{MappedBatteryInput, MappedBatteryParams, ResistanceMap};
use plant_core::must;
use plant_core::presets::PANASONIC_NCR18650PF;

use super::*;

const DT: Dt = must!(Dt::from_s(1.0));
const CELL: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));
const PARAMS: EnergyParams =
    EnergyParams { empty_soc: 0.05, full_soc: 1.0, empty_v: 2.8, least_a: 0.01 };
const FULL_AH: f64 = PANASONIC_NCR18650PF.capacity_ah as f64;
const GAUGE: EnergyGauge<'static> = must!(EnergyGauge::new(PARAMS, &CELL, DT));

fn at(soc: Real, temperature_c: Real) -> Estimate {
    Estimate::rested(soc, 0.0, temperature_c)
}

fn health() -> Health {
    Health::as_new(&CELL)
}

/// Discharges the plant at constant power, in surroundings as warm as it is at the start: charge,
/// energy, seconds.
fn discharge(power_w: Real, soc: Real, celsius: Real) -> (f64, f64, f64) {
    let mut state = CELL.rested_at(soc, celsius).unwrap();
    let (mut ah, mut wh, mut seconds) = (0.0, 0.0, 0.0);
    for _ in 0..200_000 {
        let (source, _) = CELL.offer(&state);
        let square = source.emf_v * source.emf_v - 4.0 * source.resistance_ohm * power_w;
        if square < 0.0 {
            break;
        }
        let current_a = 2.0 * power_w / (source.emf_v + square.sqrt());
        if source.voltage_v(current_a) < PARAMS.empty_v || state.soc.get() < PARAMS.empty_soc {
            break;
        }
        ah += f64::from(current_a) / 3600.0;
        wh += f64::from(power_w) / 3600.0;
        seconds += 1.0;
        CELL.step(&mut state, MappedBatteryInput { current_a });
    }
    (ah, wh, seconds)
}

const FULL_WH: f64 = 10.5;

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_plant_gives_what_the_gauge_says() {
    for celsius in [25.0, 10.0, 0.0, -10.0] {
        for soc in [1.0, 0.9, 0.5, 0.25] {
            for power_w in [1.0, 2.0, 5.0, 10.0, 25.0] {
                let left = GAUGE.left(power_w, &at(soc, celsius), &health());
                let (ah, wh, _) = discharge(power_w, soc, celsius);
                let off_wh = f64::from(left.energy_wh) - wh;
                std::println!("{soc} {celsius} °C {power_w} W: {wh:.3} Wh, {off_wh:+.3}");
                assert!(off_wh.abs() < 0.02 * FULL_WH, "{left:?} {wh}");
                assert!((f64::from(left.charge_ah) - ah).abs() < 0.02 * FULL_AH, "{left:?} {ah}");
            }
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_standard_deviation_says_what_the_cold_leaves_open() {
    // As well known as a battery usually is.
    let known = Health { capacity_sd_ah: 0.09, resistance_factor_sd: 0.2, ..health() };
    for celsius in [25.0, 0.0, -10.0] {
        for soc in [0.9, 0.5, 0.25] {
            for power_w in [2.0, 10.0, 25.0] {
                let current_a = power_w / 3.6;
                let average_w = Accum::new(power_w);
                let state = EnergyState { average_a: Accum::new(current_a), average_w };
                let estimate = Estimate { soc_sd: 0.01, ..at(soc, celsius) };
                let report = GAUGE.report(&state, &estimate, &known).unwrap();
                let (_, wh, _) = discharge(power_w, soc, celsius);
                let off_wh = f64::from(report.remaining_energy_wh) - wh;
                let sd_wh = f64::from(report.remaining_energy_sd_wh);
                std::println!(
                    "{soc} {celsius} °C {power_w} W: {wh:.2} Wh, {off_wh:+.2} ± {sd_wh:.2}"
                );
                assert!(off_wh.abs() <= sd_wh, "{soc} {celsius} {power_w}: {wh} {report:?}");
                // It may not simply be large.
                assert!(celsius < 25.0 || sd_wh < 0.07 * FULL_WH, "{report:?}");
            }
        }
    }
}

#[test]
fn a_battery_without_resistance_gives_its_open_circuit_energy() {
    const NONE: MappedBattery = must!(MappedBattery::new(
        MappedBatteryParams {
            series: ResistanceMap::NONE,
            polarisation: plant_core::battery::BranchMap::NONE,
            second_polarisation: plant_core::battery::BranchMap::NONE,
            ..PANASONIC_NCR18650PF
        },
        DT
    ));
    let gauge = EnergyGauge::new(PARAMS, &NONE, DT).unwrap();
    let left = gauge.left(5.0, &at(0.8, 25.0), &health());
    let ah = PANASONIC_NCR18650PF.capacity_ah * 0.75;
    let wh = ah * NONE.open_circuit().mean(0.05, 0.8);
    assert!((left.charge_ah - ah).abs() < 1e-5 && (left.energy_wh - wh).abs() < 1e-4);
}

#[test]
fn reports_by_the_names_of_the_specification() {
    let mut state = EnergyState::default();
    let estimate = Estimate { soc_sd: 0.02, ..at(0.6, 25.0) };
    let aged = Health { capacity_ah: 2.5, capacity_sd_ah: 0.05, ..health() };
    let report = GAUGE.report(&state, &estimate, &aged).unwrap();
    assert!(report.average_time_to_empty_s.is_none() && report.average_time_to_full_s.is_none());
    // At a fifth of the capacity it empties down to `empty_soc`, or close to it.
    assert!((report.remaining_capacity_ah - 2.5 * 0.55).abs() < 0.02, "{report:?}");
    assert!((report.full_charge_capacity_ah - 2.5 * 0.95).abs() < 0.02, "{report:?}");
    assert!((report.relative_state_of_charge - 0.55 / 0.95).abs() < 0.01);
    assert!(
        (report.absolute_state_of_charge - 2.5 * 0.55 / PANASONIC_NCR18650PF.capacity_ah).abs()
            < 0.01
    );
    assert!(report.state_of_energy < report.relative_state_of_charge, "the voltage falls");
    // 0.02·2.5 Ah·3.73 V, and 2 % of some 4.8 Wh.
    assert!((report.remaining_energy_sd_wh - 0.21).abs() < 0.02, "{report:?}");

    for _ in 0..600 {
        assert!(GAUGE.step(&mut state, EnergyInput { current_a: 1.0, voltage_v: 3.6 }));
    }
    let report = GAUGE.report(&state, &estimate, &aged).unwrap();
    let (_, _, seconds) = discharge(3.6, 0.6, 25.0);
    let expected = seconds * 2.5 / FULL_AH;
    let told = f64::from(report.average_time_to_empty_s.unwrap());
    assert!((told / expected - 1.0).abs() < 0.01, "{told} {expected}");
    assert_eq!(report.average_time_to_full_s, None);

    for _ in 0..900 {
        GAUGE.step(&mut state, EnergyInput { current_a: -1.25, voltage_v: 3.9 });
    }
    let report = GAUGE.report(&state, &estimate, &aged).unwrap();
    assert_eq!(report.average_time_to_empty_s, None);
    assert!((report.average_time_to_full_s.unwrap() - 0.8 * 3600.0).abs() < 2.0);
}

#[test]
fn a_walk_comes_to_the_report() {
    let state = EnergyState::default();
    let estimate = Estimate { soc_sd: 0.02, ..at(0.6, 0.0) };
    let known = Health { resistance_factor_sd: 0.1, ..health() };
    let mut walk = EnergyWalk::default();
    for _ in 0..2 {
        for _ in 0..DISCHARGES - 1 {
            assert_eq!(GAUGE.walk(&mut walk, &state, &estimate, &known), None);
        }
        let walked = GAUGE.walk(&mut walk, &state, &estimate, &known);
        assert_eq!(walked, GAUGE.report(&state, &estimate, &known));
        assert!(walked.is_some() && walk == EnergyWalk::START);
    }
    // What is not finite begins anew.
    GAUGE.walk(&mut walk, &state, &estimate, &known);
    let nowhere = Estimate { soc: Real::NAN, ..estimate };
    assert_eq!(GAUGE.walk(&mut walk, &state, &nowhere, &known), None);
    assert_eq!(walk, EnergyWalk::START);
}

#[test]
fn averages_over_a_minute() {
    let mut state = EnergyState::default();
    for _ in 0..60 {
        GAUGE.step(&mut state, EnergyInput { current_a: 2.0, voltage_v: 3.5 });
    }
    let share = 1.0 - Real::exp(-1.0);
    assert!((state.average_a.get() / 2.0 - share).abs() < 0.01);
    assert!((state.average_w.get() / 7.0 - share).abs() < 0.01);
}

#[test]
fn nothing_is_left_where_it_cannot_give_the_power() {
    assert_eq!(GAUGE.left(1e4, &at(0.9, 25.0), &health()), Left::default());
    assert_eq!(GAUGE.left(1.0, &at(0.04, 25.0), &health()), Left::default());
    let (mild, cold) = (at(0.5, 25.0), at(0.5, -10.0));
    assert!(
        GAUGE.left(5.0, &cold, &health()).energy_wh
            < 0.7 * GAUGE.left(5.0, &mild, &health()).energy_wh
    );
}

#[test]
fn bad_values_are_left_out_and_not_reported_on() {
    let mut state = EnergyState::default();
    for bad in [Real::NAN, Real::INFINITY, -1e38] {
        assert!(!GAUGE.step(&mut state, EnergyInput { current_a: bad, voltage_v: 3.6 }));
        assert!(!GAUGE.step(&mut state, EnergyInput { current_a: 1.0, voltage_v: bad }));
        assert_eq!(state, EnergyState::default());
        let good = at(0.5, 25.0);
        for estimate in [
            Estimate { soc: bad, ..good },
            Estimate { soc_sd: bad, ..good },
            Estimate { temperature_c: bad, ..good },
        ] {
            assert_eq!(GAUGE.report(&state, &estimate, &health()), None);
        }
        for health in [
            Health { capacity_ah: bad, ..health() },
            Health { capacity_sd_ah: bad, ..health() },
            Health { resistance_factor: bad, ..health() },
        ] {
            assert_eq!(GAUGE.report(&state, &good, &health), None);
        }
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| EnergyGauge::new(p, &CELL, DT).unwrap_err().field();
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        for (params, field) in [
            (EnergyParams { empty_soc: bad, ..PARAMS }, "energy.empty_soc"),
            (EnergyParams { full_soc: bad, ..PARAMS }, "energy.full_soc"),
            (EnergyParams { empty_v: bad, ..PARAMS }, "energy.empty_v"),
            (EnergyParams { least_a: bad, ..PARAMS }, "energy.least_a"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    assert_eq!(
        EnergyGauge::new(EnergyParams { full_soc: 0.05, ..PARAMS }, &CELL, DT),
        Err(ParamError::NotAbove("energy.full_soc"))
    );
}
