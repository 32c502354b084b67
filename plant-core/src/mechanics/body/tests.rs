//! The body on its own.

extern crate std;
use super::*;

const CAR: BodyParams = BodyParams {
    mass_kg: 1500.0,
    resistance: RoadResistance::Physical {
        drag_coefficient: 0.29,
        frontal_area_m2: 2.2,
        air_density_kg_m3: 1.2,
        rolling_coefficient: 0.009,
    },
};

fn body(params: BodyParams, dt_s: Real) -> Body {
    Body::new(params, Dt::from_s(dt_s).unwrap()).unwrap()
}

fn uphill(percent: Real) -> Road {
    Road { grade: Grade::from_ratio(percent / 100.0), ..Road::default() }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn reaches_the_speed_where_drag_and_rolling_balance_the_force() {
    let (b, mut s) = (body(CAR, 0.01), BodyState::default());
    for _ in 0..100_000 {
        b.step(&mut s, BodyInput { force_n: 500.0, ..BodyInput::default() });
    }
    let exact = ((500.0 - 0.009 * 1500.0 * 9.80665) / (0.5 * 1.2 * 0.29 * 2.2_f64)).sqrt();
    assert!((f64::from(s.speed_m_s.get()) - exact).abs() < 1e-3 * exact);
}

#[test]
fn coast_down_coefficients_resist_as_measured() {
    let resistance = RoadResistance::CoastDown { a_n: 120.0, b_n_s_per_m: 2.0, c_n_s2_per_m2: 0.4 };
    let b = body(BodyParams { resistance, ..CAR }, 1e-3);
    let mut s = BodyState { speed_m_s: Accum::new(20.0), ..BodyState::default() };
    let out = b.step(&mut s, BodyInput::default());
    assert!((out.acceleration_m_s2 + (120.0 + 40.0 + 160.0) / 1500.0).abs() < 1e-4);
}

#[test]
fn headwind_slows_and_tailwind_pushes() {
    let at = |headwind_m_s| {
        let mut s = BodyState { speed_m_s: Accum::new(10.0), ..BodyState::default() };
        let road = Road { headwind_m_s, ..Road::default() };
        body(CAR, 1e-3).step(&mut s, BodyInput { force_n: 0.0, road }).drag_n
    };
    let c = 0.5 * 1.2 * 0.29 * 2.2;
    assert!((at(5.0) - c * 225.0).abs() < 0.1);
    assert!((at(-15.0) + c * 25.0).abs() < 0.1);
}

/// By physics and as measured: thin air takes the drag, cold tyres the rolling resistance.
#[test]
fn air_and_rolling_follow_their_factors() {
    let coast_down = RoadResistance::CoastDown { a_n: 120.0, b_n_s_per_m: 2.0, c_n_s2_per_m2: 0.4 };
    let c = 0.5 * 1.2 * 0.29 * 2.2;
    for (resistance, rolling_n, viscous_n, drag_n) in [
        (CAR.resistance, 0.009 * 1500.0 * 9.80665, 0.0, c * 400.0),
        (coast_down, 120.0, 40.0, 160.0),
    ] {
        let b = body(BodyParams { resistance, ..CAR }, 1e-4);
        for (air_density_factor, rolling_factor) in [(1.0, 1.0), (0.8, 1.0), (1.0, 1.5), (0.0, 0.0)]
        {
            let mut s = BodyState { speed_m_s: Accum::new(20.0), ..BodyState::default() };
            let road = Road { air_density_factor, rolling_factor, ..Road::default() };
            let out = b.step(&mut s, BodyInput { force_n: 0.0, road });
            let air_n = air_density_factor * drag_n;
            let sum_n = rolling_factor * rolling_n + viscous_n + air_n;
            assert!((out.acceleration_m_s2 * 1500.0 + sum_n).abs() < 0.1, "{out:?} {sum_n}");
            assert!((out.drag_n - air_n).abs() < 0.01, "{out:?}");
        }
        // A factor of rolling holds on a slope what would roll.
        let road =
            Road { rolling_factor: 2.0, ..uphill(100.0 * 1.5 * rolling_n / (1500.0 * 9.81)) };
        let out = b.step(&mut BodyState::default(), BodyInput { force_n: 0.0, road });
        assert_eq!((out.speed_m_s, out.slip), (0.0, Slip::Stuck));
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn holds_on_a_slope_below_the_rolling_limit_and_rolls_above_it() {
    for (percent, holds) in [(0.89, true), (-0.89, true), (0.91, false), (-0.91, false)] {
        let (b, mut s) = (body(CAR, 0.001), BodyState::default());
        for _ in 0..10_000 {
            b.step(&mut s, BodyInput { force_n: 0.0, road: uphill(percent) });
        }
        assert_eq!(s.speed_m_s.get() == 0.0, holds, "{percent} %: {:?}", s.speed_m_s);
        assert!(holds || (s.speed_m_s.get() < 0.0) == (percent > 0.0));
    }
}

#[test]
fn the_brake_stops_at_zero_and_does_not_push() {
    let (b, mut s) = (body(CAR, 0.01), BodyState::default());
    s.speed_m_s = Accum::new(1.0);
    let road = Road { brake_n: 3000.0, ..uphill(5.0) };
    let mut last = 1.0;
    for _ in 0..200 {
        let out = b.step(&mut s, BodyInput { force_n: 0.0, road });
        assert!(out.speed_m_s <= last && out.speed_m_s >= 0.0);
        last = out.speed_m_s;
    }
    assert!(s.speed_m_s.get() == 0.0 && s.distance_m.get() < 0.25);
}

#[test]
fn is_stable_for_steps_of_any_length() {
    for dt_s in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        let (b, mut s) = (body(CAR, dt_s), BodyState::default());
        s.speed_m_s = Accum::new(60.0);
        for _ in 0..50 {
            let v = b.step(&mut s, BodyInput::default()).speed_m_s;
            assert!((0.0..=60.0).contains(&v), "{dt_s}: {v}");
        }
    }
}

#[test]
fn bad_input_changes_nothing() {
    let (b, mut s) = (body(CAR, 0.01), BodyState::default());
    b.step(&mut s, BodyInput { force_n: 500.0, ..BodyInput::default() });
    let before = s;
    for bad in [Real::NAN, Real::INFINITY, 1e38] {
        let roads = [
            Road { headwind_m_s: bad, ..Road::default() },
            Road { brake_n: bad, ..Road::default() },
            Road { air_density_factor: bad, ..Road::default() },
            Road { rolling_factor: bad, ..Road::default() },
            Road { grade: Grade { sin: bad, cos: 1.0 }, ..Road::default() },
            Road { grade: Grade { sin: 0.0, cos: bad }, ..Road::default() },
            Road { grade: Grade { sin: 5.0, cos: 1.0 }, ..Road::default() },
            Road { grade: Grade { sin: 0.3, cos: 0.0 }, ..Road::default() },
            Road { grade: Grade { sin: 0.0, cos: -1.0 }, ..Road::default() },
            Road { grade: Grade::from_ratio(5.0), ..Road::default() },
        ];
        for road in roads {
            assert!(b.step(&mut s, BodyInput { force_n: 0.0, road }).rejected);
        }
        assert!(b.step(&mut s, BodyInput { force_n: bad, ..BodyInput::default() }).rejected);
    }
    for road in [
        Road { brake_n: -1.0, ..Road::default() },
        Road { air_density_factor: -0.1, ..Road::default() },
        Road { rolling_factor: -0.1, ..Road::default() },
    ] {
        assert!(b.step(&mut s, BodyInput { force_n: 0.0, road }).rejected);
    }
    assert_eq!(s, before);
}

#[test]
fn refuses_each_bad_field_by_name() {
    let refused = |p| Body::new(p, Dt::from_s(0.01).unwrap()).unwrap_err();
    let mass = BodyParams { mass_kg: -1.0, ..CAR };
    assert_eq!(refused(mass), ParamError::NotPositive("body.mass_kg"));
    let fields = [
        "body.resistance.drag_coefficient",
        "body.resistance.frontal_area_m2",
        "body.resistance.air_density_kg_m3",
        "body.resistance.rolling_coefficient",
    ];
    for (i, field) in fields.into_iter().enumerate() {
        let at = |j| if i == j { -1.0 } else { 0.3 };
        let resistance = RoadResistance::Physical {
            drag_coefficient: at(0),
            frontal_area_m2: at(1),
            air_density_kg_m3: at(2),
            rolling_coefficient: at(3),
        };
        assert_eq!(refused(BodyParams { resistance, ..CAR }), ParamError::Negative(field));
    }
    for (i, field) in ["a_n", "b_n_s_per_m", "c_n_s2_per_m2"].into_iter().enumerate() {
        let at = |j| if i == j { Real::NAN } else { 0.3 };
        let resistance =
            RoadResistance::CoastDown { a_n: at(0), b_n_s_per_m: at(1), c_n_s2_per_m2: at(2) };
        let error = refused(BodyParams { resistance, ..CAR });
        assert_eq!(error.field().strip_prefix("body.resistance."), Some(field));
    }
}

/// As fits of coast-down tests find it.
#[test]
fn the_linear_part_may_be_negative_where_the_force_is_not() {
    let at = |b_n_s_per_m, dt_s| {
        let resistance =
            RoadResistance::CoastDown { a_n: 171.3, b_n_s_per_m, c_n_s2_per_m2: 0.3583 };
        Body::new(BodyParams { resistance, ..CAR }, Dt::from_s(dt_s).unwrap())
    };
    let b = at(-0.807, 0.01).unwrap();
    let mut s = BodyState { speed_m_s: Accum::new(30.0), ..BodyState::default() };
    let force_n = -b.step(&mut s, BodyInput::default()).acceleration_m_s2 * 1500.0;
    assert!((force_n - (171.3 - 0.807 * 30.0 + 0.3583 * 900.0)).abs() < 0.5, "{force_n}");
    let refused = Err(ParamError::OutOfRange("body.resistance.b_n_s_per_m"));
    for (b_n_s_per_m, dt_s) in [(-15.7, 0.01), (-0.807, 1000.0), (Real::NAN, 0.01), (1e13, 0.01)] {
        assert_eq!(at(b_n_s_per_m, dt_s), refused);
    }
    assert!(at(-15.6, 0.01).is_ok() && at(-0.807, 900.0).is_ok());
}

#[test]
fn a_step_keeps_newtons_law() {
    let resistance =
        RoadResistance::CoastDown { a_n: 120.0, b_n_s_per_m: 20.0, c_n_s2_per_m2: 0.4 };
    let b = body(BodyParams { resistance, ..CAR }, 0.1);
    for (v, force_n) in [(20.0, 3000.0), (20.0, -3000.0), (-20.0, 3000.0), (-20.0, -3000.0)] {
        let mut s = BodyState { speed_m_s: Accum::new(v), ..BodyState::default() };
        let road = Road { headwind_m_s: 5.0, brake_n: 200.0, ..uphill(5.0) };
        let out = b.step(&mut s, BodyInput { force_n, road });
        let (sign, now) = (v.signum(), out.speed_m_s);
        let friction_n = sign * (120.0 * road.grade.cos + 200.0);
        let weight_n = 1500.0 * 9.80665 * road.grade.sin;
        let drag_n = 0.4 * (v + 5.0).abs() * (now + 5.0);
        let sum_n = force_n - friction_n - weight_n - drag_n - 20.0 * now;
        assert!((out.acceleration_m_s2 - sum_n / 1500.0).abs() < 1e-4, "{out:?}");
        assert!((out.drag_n - drag_n).abs() < 1e-2 && (now - v).abs() > 0.01);
        assert!((out.acceleration_m_s2 - (now - v) / 0.1).abs() < 1e-3);
        assert!((out.distance_m - 0.1 * now).abs() < 1e-5);
    }
    let mut s = BodyState::default();
    assert!(b.step(&mut s, BodyInput { force_n: 9e8, ..BodyInput::default() }).speed_m_s > 1e4);
}

#[test]
fn a_speed_that_would_become_absurd_stays() {
    let resistance = RoadResistance::CoastDown { a_n: 0.0, b_n_s_per_m: 0.0, c_n_s2_per_m2: 0.0 };
    let b = body(BodyParams { mass_kg: 1.0, resistance }, 1.0);
    let mut s = BodyState::default();
    let push = BodyInput { force_n: 6e8, ..BodyInput::default() };
    assert!(!b.step(&mut s, push).rejected);
    let before = s;
    let out = b.step(&mut s, push);
    assert!(out.rejected && s == before && out.acceleration_m_s2 == 0.0 && out.drag_n == 0.0);
    let light = body(BodyParams { mass_kg: 1e-3, resistance }, 1.0);
    assert!(light.step(&mut BodyState::default(), push).rejected);
}
