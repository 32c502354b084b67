//! The energy ledger closes, in `f32` and in its f64 twin.

use plant_core::Real;
use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::BatteryParams;
use plant_core::powertrain::{DriveParams, PowertrainParams};
use proptest::prelude::*;

use crate::check::{cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// The largest residual in shares of the turnover (twice the throughput on most drives): a few of
/// the scalar's last bits. Of 6400 cases the worst had 1.5e-7 and 3e-16.
const CLOSES: f64 = 4e-7;
const TWIN_CLOSES: f64 = 1e-15;

/// What acts on the plant for a while.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    duty: Real,
    sin: Real,
    headwind_m_s: Real,
    brake_n: Real,
    auxiliary_w: Real,
    air_density_factor: Real,
    rolling_factor: Real,
}

const STRETCH_STEPS: u32 = 500;

#[derive(Clone, Debug)]
struct Drive {
    dt_s: Real,
    speed_m_s: Real,
    stretches: Vec<Stretch>,
}

fn drives() -> impl Strategy<Value = Drive> {
    let acts = (signed(1.0), signed(0.1), signed(15.0), positive(2000.0), positive(2000.0));
    let factors = (0.5..2.0_f32, 0.5..2.0_f32);
    let stretch = (acts, factors).prop_map(|(acts, (air_density_factor, rolling_factor))| {
        let (duty, sin, headwind_m_s, brake_n, auxiliary_w) = acts;
        Stretch {
            duty,
            sin,
            headwind_m_s,
            brake_n,
            auxiliary_w,
            air_density_factor,
            rolling_factor,
        }
    });
    (log(1e-5, 0.1), signed(30.0), prop::collection::vec(stretch, 4..12))
        .prop_map(|(dt_s, speed_m_s, stretches)| Drive { dt_s, speed_m_s, stretches })
}

/// With Ke and Kt apart, for which the ledger has a term. Nothing is infinite, so that the twin can
/// take the parameters as text.
fn finite_plant(d: &mut Draw) -> PowertrainParams {
    let motor = draw::lossy_motor(d);
    let plant = draw::plant(d);
    let PowertrainParams { battery, auxiliary, .. } = plant;
    // Often small enough to be empty or full before the end.
    let capacity_ah = if d.number() > 0.0 { battery.capacity_ah } else { d.near(0.5) };
    let battery = BatteryParams {
        capacity_ah,
        discharge_limit_a: battery.discharge_limit_a.min(1e9),
        charge_limit_a: battery.charge_limit_a.min(1e9),
        ..battery
    };
    let resistance_ohm = auxiliary.resistance_ohm.min(1e9);
    let auxiliary = AuxiliaryParams { resistance_ohm, ..auxiliary };
    let drives = DriveParams { motor, ..plant.drives };
    PowertrainParams { battery, auxiliary, drives, ..plant }
}

/// The residual of a drive and what it is measured against \[J\], with one crate's scalar or the
/// other's: the throughput Σ|E·I|·h, or the sum of all terms and of the motion at the start, which
/// counts each joule about twice and does not vanish where gravity or wind do it all.
macro_rules! residual_and_turnover {
    ($core:ident, $real:ty, $params:expr, $case:expr) => {{
        let case: &Drive = $case;
        let dt = $core::Dt::from_s(<$real>::from(case.dt_s)).unwrap();
        let plant = $core::powertrain::Powertrain::new($params, dt).unwrap().with_ledger();
        let start = plant.at_speed(0.6, case.speed_m_s.into()).unwrap();
        let mut s = start;
        for stretch in &case.stretches {
            let road = $core::mechanics::body::Road {
                grade: $core::mechanics::slope::Grade::from_sin(stretch.sin.into()),
                headwind_m_s: stretch.headwind_m_s.into(),
                brake_n: stretch.brake_n.into(),
                air_density_factor: stretch.air_density_factor.into(),
                rolling_factor: stretch.rolling_factor.into(),
            };
            let (duty, auxiliary_w) = (stretch.duty.into(), stretch.auxiliary_w.into());
            let input = $core::powertrain::PowertrainInput {
                road,
                auxiliary_w,
                ..$core::powertrain::PowertrainInput::on(duty)
            };
            for _ in 0..STRETCH_STEPS {
                let mut next = s;
                let out = plant.step(&mut next, input);
                prop_assert!(!out.rejected);
                s = next;
            }
        }
        let report = plant.energy(&start, &s);
        let kinetic_j = 0.5 * f64::from(plant.moving_mass_kg()) * f64::from(case.speed_m_s).powi(2);
        let turnover_j: f64 = report
            .terms()
            .iter()
            .filter(|(name, _)| *name != "residual")
            .map(|(_, j)| f64::from(*j).abs())
            .sum();
        (f64::from(report.residual).abs(), turnover_j + kinetic_j)
    }};
}

/// The same parameters for the twin.
pub fn twin(params: &PowertrainParams) -> plant_core_f64::powertrain::PowertrainParams {
    let text = serde_json::to_value(params).expect("finite numbers");
    serde_json::from_value(text).expect("the same fields")
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn closes_in_both_precisions(
        params in drawn(PLAUSIBLE, finite_plant),
        case in drives(),
    ) {
        let (residual_j, turnover_j) = residual_and_turnover!(plant_core, f32, params, &case);
        prop_assert!(residual_j <= CLOSES * turnover_j, "{residual_j} of {turnover_j}");
        let (residual_j, turnover_j) =
            residual_and_turnover!(plant_core_f64, f64, twin(&params), &case);
        prop_assert!(residual_j <= TWIN_CLOSES * turnover_j, "{residual_j} of {turnover_j} (f64)");
    }
}
