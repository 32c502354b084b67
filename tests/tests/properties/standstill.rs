//! Friction holds a vehicle on a slope exactly, up to its limit.

use plant_core::Dt;
use plant_core::mechanics::body::{Body, BodyInput, BodyParams, BodyState, Road, RoadResistance};
use plant_core::mechanics::slope::Grade;
use plant_core::num::GRAVITY_M_S2;
use plant_core::port::Slip;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainParams};
use proptest::prelude::*;

use crate::check::{cases, log, positive};
use crate::draw::{self, PLAUSIBLE, drawn};

/// What holds a standing vehicle on a slope of this sine \[N\], beside what its motor does.
fn friction_n(params: &BodyParams, held_n: f64, sin: f64) -> f64 {
    let rolling_n = match params.resistance {
        RoadResistance::Physical { rolling_coefficient, .. } => {
            f64::from(rolling_coefficient) * weight_n(params)
        }
        RoadResistance::CoastDown { a_n, .. } => f64::from(a_n),
    };
    rolling_n * (1.0 - sin * sin).sqrt() + held_n
}

fn weight_n(params: &BodyParams) -> f64 {
    f64::from(params.mass_kg) * f64::from(GRAVITY_M_S2)
}

/// The sine of the slope whose pull is `share` of what holds the vehicle; no steeper than 1 in 2.
fn sine(params: &BodyParams, held_n: f64, share: f64) -> f64 {
    let mut sin = 0.0;
    for _ in 0..50 {
        sin = (share * friction_n(params, held_n, sin) / weight_n(params)).min(0.5);
    }
    sin
}

/// The friction of the brake and of the motor's bearings, seen at the road \[N\].
fn held_n(params: &PowertrainParams, brake_n: f32) -> f64 {
    let per_m = f64::from(params.drives.gearbox.ratio) / f64::from(params.wheel.radius_m);
    f64::from(brake_n) + f64::from(params.drives.motor.coulomb_nm) * per_m
}

/// Below the limit, in shares of it; clear of rounding, and close to it often.
fn holds() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..0.9999, Just(0.9999)]
}

/// Above it.
fn slips() -> impl Strategy<Value = f64> {
    prop_oneof![1.0001..3.0, Just(1.0001)]
}

fn uphill_or_down(sin: f64, up: bool) -> Road {
    let sin = if up { sin } else { -sin };
    Road { grade: Grade::from_sin(sin as f32), ..Road::default() }
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn powertrain_holds_up_to_its_friction(
        params in drawn(PLAUSIBLE, draw::plant),
        dt_s in log(1e-5, 1.0),
        brake_n in positive(5000.0),
        share in holds(),
        up in any::<bool>(),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_rest(0.5).unwrap();
        let sin = sine(&params.body, held_n(&params, brake_n), share);
        let road = Road { brake_n, ..uphill_or_down(sin, up) };
        for step in 0..3000 {
            let out = plant.step(&mut s, PowertrainInput { road, ..PowertrainInput::default() });
            prop_assert!(out.slip == Slip::Stuck && !out.rejected, "{step}: {out:?}");
            prop_assert!(out.speed_m_s == 0.0 && out.distance_m == 0.0, "{step}: {out:?}");
        }
    }

    #[test]
    fn powertrain_rolls_downhill_beyond_it(
        params in drawn(PLAUSIBLE, draw::plant),
        dt_s in log(1e-5, 1.0),
        brake_n in positive(2000.0),
        share in slips(),
        up in any::<bool>(),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_rest(0.5).unwrap();
        let held_n = held_n(&params, brake_n);
        let sin = sine(&params.body, held_n, share);
        prop_assume!(sin * weight_n(&params.body) > 1.00005 * friction_n(&params.body, held_n, sin));
        let road = Road { brake_n, ..uphill_or_down(sin, up) };
        let out = plant.step(&mut s, PowertrainInput { road, ..PowertrainInput::default() });
        let downhill = if up { Slip::Backward } else { Slip::Forward };
        prop_assert!(out.slip == downhill && out.speed_m_s * road.grade.sin < 0.0, "{out:?}");
    }

    /// A body on its own, which comes to rest and stays.
    #[test]
    fn body_comes_to_rest(
        params in drawn(PLAUSIBLE, draw::body),
        dt_s in log(1e-2, 1.0),
        brake_n in log(500.0, 5000.0),
        share in 0.0..0.9_f64,
        up in any::<bool>(),
        speed in -3.0..3.0_f32,
    ) {
        let body = Body::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = BodyState { speed_m_s: plant_core::Accum::new(speed), ..BodyState::default() };
        let sin = sine(&params, f64::from(brake_n), share);
        let road = Road { brake_n, ..uphill_or_down(sin, up) };
        // Friction exceeds the pull by a tenth of itself at least.
        let slowest = 0.1 * f64::from(brake_n) / f64::from(params.mass_kg);
        let steps = 3.0 / slowest / f64::from(dt_s) + 2.0;
        let mut at_rest = 0;
        for _ in 0..steps as u32 + 2000 {
            let out = body.step(&mut s, BodyInput { force_n: 0.0, road });
            if out.slip == Slip::Stuck {
                at_rest += 1;
            }
            prop_assert!(at_rest == 0 || out.speed_m_s == 0.0, "{out:?}");
        }
        prop_assert!(at_rest >= 2000, "{at_rest} of {steps}");
    }
}
