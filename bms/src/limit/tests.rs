use super::*;
use crate::must;
use crate::protect::{EXAMPLE, Faults, Id, Level, Side};

const TABLE: Table = must!(Table::new(EXAMPLE));
const PARAMS: LimiterParams = LimiterParams {
    discharge_a: 280.0,
    charge_a: 100.0,
    parallel: 20,
    fall_per_s: 0.2,
    rise_per_s: 0.05,
    ending_s: 1.0,
    derated: 0.5,
    charge_from_c: 0.0,
    temperature_error_k: 1.0,
};
const DT: Dt = must!(Dt::from_s(0.01));
const LIMITER: Limiter = must!(Limiter::new(PARAMS, DT));
const CALM: Verdict = Verdict {
    trip: Trip::None,
    permit: true,
    tripped: Faults::NONE,
    latched: Faults::NONE,
    rose: Faults::NONE,
    fell: Faults::NONE,
};

fn input(verdict: &Verdict) -> LimiterInput<'_> {
    LimiterInput {
        cell_discharge_a: 10.0,
        cell_charge_a: 4.0,
        coldest_c: 20.0,
        verdict,
        mains_closed: true,
        ending: false,
    }
}

fn settled(input: &LimiterInput) -> Limits {
    let mut limits = Limits::NONE;
    for _ in 0..3000 {
        LIMITER.step(&mut limits, &TABLE, input);
    }
    limits
}

fn with(id: Id) -> Verdict {
    Verdict { tripped: Faults::NONE.with(id), ..CALM }
}

#[test]
fn follows_the_weakest_cell_up_to_the_pack() {
    let limits = settled(&input(&CALM));
    assert_eq!(limits.discharge, Limit { current_a: 200.0, by: Limited::Cells });
    assert_eq!(limits.charge, Limit { current_a: 80.0, by: Limited::Cells });
    let strong = LimiterInput { cell_discharge_a: 50.0, cell_charge_a: 50.0, ..input(&CALM) };
    let limits = settled(&strong);
    assert_eq!(limits.discharge, Limit { current_a: 280.0, by: Limited::Pack });
    assert_eq!(limits.charge, Limit { current_a: 100.0, by: Limited::Pack });
    let empty = LimiterInput { cell_discharge_a: -3.0, ..input(&CALM) };
    assert_eq!(settled(&empty).discharge.current_a, 0.0);
}

#[test]
fn what_is_not_known_is_nothing() {
    for bad in [Real::NAN, Real::INFINITY] {
        let unknown = Limit { current_a: 0.0, by: Limited::Unknown };
        let lost = LimiterInput { cell_discharge_a: bad, ..input(&CALM) };
        assert_eq!(settled(&lost).discharge, unknown);
        let lost = LimiterInput { cell_charge_a: bad, ..input(&CALM) };
        assert_eq!(settled(&lost).charge, unknown);
        let lost = LimiterInput { coldest_c: bad, ..input(&CALM) };
        assert_eq!(settled(&lost), Limits { discharge: unknown, charge: unknown });
    }
}

#[test]
fn cold_cells_are_not_charged_however_the_sensor_errs() {
    for (coldest_c, charges) in [(1.01, true), (0.99, false), (-10.0, false)] {
        let limits = settled(&LimiterInput { coldest_c, ..input(&CALM) });
        assert_eq!(limits.charge.current_a > 0.0, charges, "{coldest_c}");
        assert_eq!(limits.discharge.current_a, 200.0);
    }
}

#[test]
fn rows_take_back_power_in_their_direction() {
    let over = with(Id::CellVoltage(Side::High, Level::Rsl));
    let limits = settled(&input(&over));
    assert_eq!(limits.charge, Limit { current_a: 40.0, by: Limited::Derated });
    assert_eq!(limits.discharge.by, Limited::Cells);
    let hot = with(Id::Coolant);
    assert_eq!(settled(&input(&hot)).discharge.by, Limited::Derated);
    let barred = with(Id::CellVoltage(Side::High, Level::Msl));
    let limits = settled(&input(&barred));
    assert_eq!(limits.charge, Limit { current_a: 0.0, by: Limited::Barred });
    assert_eq!(limits.discharge.by, Limited::Cells);
}

/// No driver feels a cut: a fifth of the largest current a second down, a twentieth up.
#[test]
fn nothing_but_a_safety_limit_cuts() {
    let soft = Verdict { trip: Trip::Soft, ..CALM };
    let derated = with(Id::Coolant);
    let calm = input(&CALM);
    for (then, fastest_per_s) in [
        (LimiterInput { cell_discharge_a: 0.0, ..calm }, 0.2),
        (LimiterInput { cell_discharge_a: Real::NAN, ..calm }, 0.2),
        (input(&derated), 0.2),
        (input(&soft), 1.0),
        (LimiterInput { ending: true, ..calm }, 1.0),
    ] {
        let mut limits = settled(&calm);
        let mut fastest_a: Real = 0.0;
        for _ in 0..1000 {
            let before_a = limits.discharge.current_a;
            LIMITER.step(&mut limits, &TABLE, &then);
            fastest_a = fastest_a.max(before_a - limits.discharge.current_a);
        }
        let expected_a = fastest_per_s * 280.0 * 0.01;
        assert!((fastest_a - expected_a).abs() < 1e-3, "{fastest_a} A in a step");
        assert!(limits.discharge.current_a <= 100.0);
    }
    // Up again.
    let mut limits = Limits::NONE;
    for _ in 0..100 {
        LIMITER.step(&mut limits, &TABLE, &calm);
        assert_eq!(limits.discharge.by, Limited::Rate);
    }
    assert!((limits.discharge.current_a - 14.0).abs() < 1e-3);
    // A safety limit, and contactors that are open, at once.
    let hard = Verdict { trip: Trip::Hard, ..CALM };
    let open = LimiterInput { mains_closed: false, ..calm };
    for (then, by) in [(input(&hard), Limited::Barred), (open, Limited::Open)] {
        let mut limits = settled(&calm);
        LIMITER.step(&mut limits, &TABLE, &then);
        assert_eq!(limits.discharge, Limit { current_a: 0.0, by });
        assert_eq!(limits.charge, Limit { current_a: 0.0, by });
    }
}

#[test]
fn power_is_back_before_the_contactors_open() {
    let mut limits = settled(&input(&CALM));
    let ending = LimiterInput { ending: true, ..input(&CALM) };
    for _ in 0..100 {
        LIMITER.step(&mut limits, &TABLE, &ending);
    }
    assert_eq!(limits.discharge, Limit { current_a: 0.0, by: Limited::Ending });
    assert_eq!(limits.charge, Limit { current_a: 0.0, by: Limited::Ending });
}

#[test]
fn off_wins_and_so_does_doubt() {
    use Request::{Charge, Drive, Off, Silent, Unknown};
    let all = [Silent, Off, Drive, Charge, Unknown];
    for vehicle in all {
        for charger in all {
            let expected = match (vehicle, charger) {
                (Drive, Silent) => Mode::Drive,
                (Charge, Silent | Charge) | (Silent, Charge) => Mode::Charge,
                _ => Mode::Off,
            };
            assert_eq!(arbitrate(vehicle, charger), expected, "{vehicle:?} {charger:?}");
        }
    }
    assert_eq!((Request::default(), Mode::default()), (Silent, Mode::Off));
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let refused = |params| Limiter::new(params, DT).expect_err("refused").field();
    for bad in [Real::NAN, Real::NEG_INFINITY] {
        for (params, field) in [
            (LimiterParams { discharge_a: bad, ..PARAMS }, "limiter.discharge_a"),
            (LimiterParams { charge_a: bad, ..PARAMS }, "limiter.charge_a"),
            (LimiterParams { fall_per_s: bad, ..PARAMS }, "limiter.fall_per_s"),
            (LimiterParams { rise_per_s: bad, ..PARAMS }, "limiter.rise_per_s"),
            (LimiterParams { ending_s: bad, ..PARAMS }, "limiter.ending_s"),
            (LimiterParams { derated: bad, ..PARAMS }, "limiter.derated"),
            (LimiterParams { charge_from_c: bad, ..PARAMS }, "limiter.charge_from_c"),
            (LimiterParams { temperature_error_k: bad, ..PARAMS }, "limiter.temperature_error_k"),
        ] {
            assert_eq!(refused(params), field);
        }
    }
    assert_eq!(refused(LimiterParams { parallel: 0, ..PARAMS }), "limiter.parallel");
}
