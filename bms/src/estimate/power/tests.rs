extern crate std;
use plant_core::battery::{HysteresisParams, MappedBatteryParams, ThermalParams};
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::{Dt, must};

use super::*;
use crate::estimate::cells::{
    CellResistanceParams, CellResistances, Cells, CellsInput, CellsParams,
};

const DT: Dt = must!(Dt::from_s(1.0));
const CELL: MappedBattery = must!(MappedBattery::new(PANASONIC_NCR18650PF, DT));
const PARAMS: PowerParams = PowerParams {
    voltage_min_v: 2.5,
    voltage_max_v: 4.2,
    soc_min: 0.05,
    soc_max: 0.98,
    margin_sds: 2.0,
    horizons_s: HORIZONS_S,
    discharge_window: TemperatureWindow {
        none_below_c: -30.0,
        all_from_c: -20.0,
        all_to_c: 50.0,
        none_above_c: 60.0,
    },
    charge_window: TemperatureWindow {
        none_below_c: 0.0,
        all_from_c: 10.0,
        all_to_c: 45.0,
        none_above_c: 50.0,
    },
};
const LIMITS: PowerLimits<'static> = must!(PowerLimits::new(PARAMS, &CELL));

fn at(soc: Real, temperature_c: Real) -> Estimate {
    Estimate::rested(soc, 0.0, temperature_c)
}

fn ahead(estimate: &Estimate) -> [PowerAhead; HORIZONS] {
    LIMITS.ahead(estimate, &Health::as_new(&CELL))
}

#[test]
fn each_limit_binds_in_its_turn() {
    let [.., half_minute] = ahead(&at(0.5, 25.0));
    assert_eq!(half_minute.discharge.bound_by, BoundBy::Current);
    assert_eq!(half_minute.discharge.current_a, 25.0);
    assert!(half_minute.discharge.voltage_v > 2.5);
    assert_eq!(half_minute.charge.current_a, 12.0);

    let cold = ahead(&at(0.5, 5.0));
    assert_eq!(cold[0].charge.bound_by, BoundBy::Temperature);
    assert!((cold[0].charge.current_a - 6.0).abs() < 1e-5);
    assert_eq!(ahead(&at(0.5, -1.0))[0].charge.current_a, 0.0);

    let [.., half_minute] = ahead(&at(0.5, -5.0));
    assert_eq!(half_minute.discharge.bound_by, BoundBy::Voltage);
    assert!((half_minute.discharge.voltage_v - 2.5).abs() < 1e-3, "{half_minute:?}");

    // 0.3 % of the capacity in 10 s.
    let [_, ten, _] = ahead(&at(0.053, 25.0));
    assert_eq!(ten.discharge.bound_by, BoundBy::Soc);
    assert!(
        (ten.discharge.current_a - 0.003 * PANASONIC_NCR18650PF.capacity_ah * 360.0).abs() < 1e-3,
        "{ten:?}"
    );
    let [_, ten, _] = ahead(&at(0.04, 25.0));
    assert_eq!((ten.discharge.current_a, ten.discharge.power_w), (0.0, 0.0));
    assert_eq!(ahead(&at(0.99, 25.0))[1].charge.current_a, 0.0);
}

#[test]
fn doubt_keeps_away_from_empty_and_full() {
    for (soc, room, direction) in
        [(0.053, 0.003, Direction::Discharge), (0.979, 0.001, Direction::Charge)]
    {
        let taken = |soc_sd| {
            let [_, ten, _] = ahead(&Estimate { soc_sd, ..at(soc, 25.0) });
            if direction == Direction::Discharge {
                ten.discharge.current_a
            } else {
                ten.charge.current_a
            }
        };
        assert!(taken(0.3 * room) < 0.5 * taken(0.0) && taken(0.3 * room) > 0.0, "{direction:?}");
        assert_eq!(taken(0.6 * room), 0.0);
    }
}

#[test]
fn an_aged_battery_gives_less() {
    let estimate = at(0.5, 0.0);
    let [_, new, _] = ahead(&estimate);
    let aged = Health { resistance_factor: 1.4, ..Health::as_new(&CELL) };
    let [_, old, _] = LIMITS.ahead(&estimate, &aged);
    let share = old.discharge.current_a / new.discharge.current_a;
    assert!((0.68..0.8).contains(&share), "about 1/1.4: {share}");
    let half =
        Health { capacity_ah: 0.5 * PANASONIC_NCR18650PF.capacity_ah, ..Health::as_new(&CELL) };
    let (new, old) = (ahead(&at(0.053, 25.0)), LIMITS.ahead(&at(0.053, 25.0), &half));
    assert_eq!(new[1].discharge.bound_by, BoundBy::Soc);
    assert!((old[1].discharge.current_a / new[1].discharge.current_a - 0.5).abs() < 1e-6);
}

#[test]
fn what_the_filter_knows_counts() {
    let base = at(0.5, 0.0);
    let taken = |estimate: &Estimate| ahead(estimate)[1].discharge.current_a;
    let low = Estimate { offset_v: -0.05, ..base };
    let tired = Estimate { polarisation_v: [0.02, 0.04], ..base };
    assert!(taken(&low) < 0.97 * taken(&base) && taken(&tired) < 0.98 * taken(&base));
    let params = MappedBatteryParams {
        hysteresis: HysteresisParams { half_gap_v: 0.05, rate_per_soc: 30.0 },
        ..PANASONIC_NCR18650PF
    };
    let cell = MappedBattery::new(params, DT).unwrap();
    let limits = PowerLimits::new(PARAMS, &cell).unwrap();
    let on_charge = Estimate { hysteresis: 1.0, ..base };
    let on_discharge = Estimate { hysteresis: -1.0, ..base };
    let taken = |e| limits.ahead(&e, &Health::as_new(&cell))[0].discharge.current_a;
    assert!(taken(on_discharge) < 0.97 * taken(on_charge));
}

#[test]
fn the_current_must_not_overheat_it() {
    let params = MappedBatteryParams {
        thermal: ThermalParams { heat_capacity_j_per_k: 10.0, ..PANASONIC_NCR18650PF.thermal },
        ..PANASONIC_NCR18650PF
    };
    let small = MappedBattery::new(params, DT).unwrap();
    let limits = PowerLimits::new(PARAMS, &small).unwrap();
    let [.., half_minute] = limits.ahead(&at(0.5, 49.0), &Health::as_new(&small));
    assert_eq!(half_minute.discharge.bound_by, BoundBy::Temperature);
    assert!((5.0..20.0).contains(&half_minute.discharge.current_a), "{half_minute:?}");
}

#[test]
fn never_more_for_longer() {
    for i in 0..200_u8 {
        let soc = Real::from(i) / 199.0;
        let estimate = Estimate {
            polarisation_v: [0.03 * Real::from(i % 5) - 0.06, 0.0],
            ..at(soc, Real::from(i % 7) * 10.0 - 15.0)
        };
        let [two, ten, thirty] = ahead(&estimate);
        for (short, long) in [(two, ten), (ten, thirty)] {
            for (s, l) in [(short.discharge, long.discharge), (short.charge, long.charge)] {
                assert!(l.current_a <= s.current_a && l.power_w <= s.power_w, "{estimate:?}");
                assert!(l.current_a >= 0.0 && l.power_w.is_finite(), "{estimate:?}");
            }
        }
    }
}

#[test]
fn without_an_estimate_nothing_is_allowed() {
    let good = at(0.5, 25.0);
    for bad in [Real::NAN, Real::INFINITY, 1e38] {
        for estimate in [
            Estimate { soc: bad, ..good },
            Estimate { soc_sd: bad, ..good },
            Estimate { polarisation_v: [bad, 0.0], ..good },
            Estimate { polarisation_v: [0.0, bad], ..good },
            Estimate { hysteresis: bad, ..good },
            Estimate { offset_v: bad, ..good },
            Estimate { temperature_c: bad, ..good },
        ] {
            for seen in ahead(&estimate) {
                assert_eq!((seen.discharge, seen.charge), (Allowance::NONE, Allowance::NONE));
            }
        }
        let health = Health::as_new(&CELL);
        for health in [
            Health { capacity_ah: bad, ..health },
            Health { resistance_factor: bad, ..health },
            Health { capacity_ah: -1.0, ..health },
            Health { resistance_factor: 0.0, ..health },
        ] {
            for seen in LIMITS.ahead(&good, &health) {
                assert_eq!((seen.discharge, seen.charge), (Allowance::NONE, Allowance::NONE));
            }
        }
    }
}

#[test]
fn shares_over_temperature() {
    let window = PARAMS.charge_window;
    for (celsius, share) in [
        (-50.0, 0.0),
        (0.0, 0.0),
        (2.5, 0.25),
        (10.0, 1.0),
        (30.0, 1.0),
        (45.0, 1.0),
        (49.0, 0.2),
        (50.0, 0.0),
        (Real::NAN, 0.0),
    ] {
        assert!((window.share(celsius) - share).abs() < 1e-6, "{celsius}");
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| PowerLimits::new(p, &CELL).unwrap_err().field();
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        for (params, field) in [
            (PowerParams { voltage_min_v: bad, ..PARAMS }, "power.voltage_min_v"),
            (PowerParams { voltage_max_v: bad, ..PARAMS }, "power.voltage_max_v"),
            (PowerParams { soc_min: bad, ..PARAMS }, "power.soc_min"),
            (PowerParams { soc_max: bad, ..PARAMS }, "power.soc_max"),
            (PowerParams { margin_sds: bad, ..PARAMS }, "power.margin_sds"),
            (PowerParams { horizons_s: [bad, 10.0, 30.0], ..PARAMS }, "power.horizons_s"),
            (PowerParams { horizons_s: [2.0, bad, 30.0], ..PARAMS }, "power.horizons_s"),
            (PowerParams { horizons_s: [2.0, 10.0, bad], ..PARAMS }, "power.horizons_s"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    let equal = PowerParams { horizons_s: [2.0, 10.0, 10.0], ..PARAMS };
    assert_eq!(refused(equal), "power.horizons_s");
    let [w, d] = [PARAMS.charge_window, PARAMS.discharge_window];
    for (window, field) in [
        (TemperatureWindow { none_below_c: Real::NAN, ..w }, "none_below_c"),
        (TemperatureWindow { all_from_c: -0.1, ..w }, "all_from_c"),
        (TemperatureWindow { all_to_c: 9.9, ..w }, "all_to_c"),
        (TemperatureWindow { none_above_c: 44.9, ..w }, "none_above_c"),
    ] {
        let params = PowerParams { charge_window: window, ..PARAMS };
        assert_eq!(refused(params).strip_prefix("power.charge_window."), Some(field));
    }
    let hot = TemperatureWindow { none_above_c: Real::NAN, ..d };
    assert_eq!(
        PowerLimits::new(PowerParams { discharge_window: hot, ..PARAMS }, &CELL),
        Err(ParamError::NotFinite("power.discharge_window.none_above_c"))
    );
}

#[test]
fn a_walk_comes_to_what_is_ahead() {
    let estimate = Estimate { soc_sd: 0.01, ..at(0.3, -5.0) };
    let health = Health { resistance_factor_sd: 0.1, ..Health::as_new(&CELL) };
    let mut walk = PowerWalk::default();
    for _ in 0..2 {
        for _ in 0..2 * HORIZONS - 1 {
            assert_eq!(LIMITS.walk(&mut walk, &estimate, &health), None);
        }
        let found = LIMITS.walk(&mut walk, &estimate, &health).unwrap();
        assert_eq!(found, LIMITS.ahead(&estimate, &health));
    }
}

/// A cell whose resistance is two standard deviations more, and whose state of charge is as much
/// less than believed, keeps its limit; without a margin it does not.
#[test]
fn doubt_about_resistance_and_charge_keeps_the_voltage() {
    let (soc, soc_sd, factor_sd) = (0.3, 0.02, 0.1);
    let truth_soc = soc - 2.0 * soc_sd;
    let curve = CELL.open_circuit();
    // What the terminals show now is known.
    let truth = Estimate { offset_v: curve.at(soc) - curve.at(truth_soc), ..at(truth_soc, -5.0) };
    let as_it_is = Health { resistance_factor: 1.0 + 2.0 * factor_sd, ..Health::as_new(&CELL) };
    let believed = Estimate { soc_sd, ..at(soc, -5.0) };
    let health = Health { resistance_factor_sd: factor_sd, ..Health::as_new(&CELL) };
    let bold = PowerLimits::new(PowerParams { margin_sds: 0.0, ..PARAMS }, &CELL).unwrap();
    for (limits, keeps) in [(LIMITS, true), (bold, false)] {
        let [_, ten, _] = limits.ahead(&believed, &health);
        let [_, most, _] = bold.ahead(&truth, &as_it_is);
        assert_eq!(ten.discharge.bound_by, BoundBy::Voltage);
        let within = ten.discharge.current_a <= 1.001 * most.discharge.current_a;
        assert_eq!(within, keeps, "{ten:?} {most:?}");
        assert!(ten.discharge.current_a > 0.7 * most.discharge.current_a);
    }
}

/// The first of three cells has least charge, the last one most resistance.
#[test]
fn a_walk_of_cells_comes_to_what_is_ahead_of_them() {
    const OF_CELLS: Cells = must!(Cells::new(
        CellsParams {
            open_circuit: PANASONIC_NCR18650PF.open_circuit,
            noise_sd_v: 0.001,
            offset_sd_v: 0.001,
            resistance_sd_ohm: 0.003,
            capacity_sd: 0.02,
            soc_sd: 0.02,
            drift_sd_per_day: 0.001,
            pack_soc_sd_max: 0.1,
            voltage_min_v: 2.0,
            voltage_max_v: 4.5,
        },
        DT
    ));
    const OF_EACH: CellResistances = must!(CellResistances::new(CellResistanceParams {
        resistance_ohm: 0.03,
        spread_sd: 0.2,
        noise_sd_v: 0.001,
        least_step_a: 0.5,
        memory_steps: 500.0,
    }));
    let mean = Estimate { soc_sd: 0.01, ..at(0.3, -5.0) };
    let (mut socs, mut resistances) = (OF_CELLS.start::<3>(mean), OF_EACH.start::<3>());
    for second in 0..300 {
        let current_a = if second % 2 == 0 { 0.0 } else { 2.0 };
        let cell_v =
            [(-0.02, 0.03), (0.02, 0.03), (0.0, 0.06)].map(|(v, ohm)| 3.55 + v - ohm * current_a);
        OF_EACH.step(&mut resistances, &cell_v, current_a);
        if current_a == 0.0 {
            OF_CELLS.step(&mut socs, CellsInput { pack: mean, cell_v: &cell_v, current_a });
        }
    }
    let health = Health::as_new(&CELL);
    let cells = SeriesCells { mean, health, socs: &socs, resistances: &resistances };
    let wanted = LIMITS.ahead_of_cells(&cells);
    // Neither cell's limits alone are those of all.
    let alone = |index| {
        let (cell, (ratio, _)) = (socs.cell(index).unwrap(), resistances.ratio(index).unwrap());
        let health = Health { resistance_factor: ratio, ..health };
        LIMITS.ahead(&Estimate { soc: cell.soc, soc_sd: cell.soc_sd, ..mean }, &health)
    };
    let [of_all, least_charge, most_resistance] =
        [wanted, alone(0), alone(2)].map(|ahead| ahead[0].discharge.current_a);
    assert!(of_all < 0.9 * least_charge && of_all <= 1.01 * most_resistance);
    let mut walk = PowerWalk::default();
    for _ in 0..2 {
        for _ in 0..SLICES_OF_CELLS - 1 {
            assert_eq!(LIMITS.walk_of_cells(&mut walk, &cells), None);
        }
        assert_eq!(LIMITS.walk_of_cells(&mut walk, &cells), Some(wanted));
    }
}
