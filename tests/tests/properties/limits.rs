//! A battery limit holds wherever a duty can keep it.

use plant_core::auxiliary::AuxiliaryParams;
use plant_core::battery::{BatteryParams, BatteryState};
use plant_core::converter::ConverterParams;
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::powertrain::{
    Limited, Powertrain, PowertrainInput, PowertrainOutput, PowertrainParams,
};
use plant_core::{Accum, Dt, Real};
use proptest::prelude::*;

use crate::charge::SOC_ROUNDING;
use crate::check::{cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// How closely a limit is held \[A\]: the root of a quadratic in `f32`, and the last bits of the
/// winding current that the step began with.
pub fn held_within_a(battery_a: Real, winding_a: Real) -> f64 {
    1e-3 + 1e-4 * f64::from(battery_a).abs() + 5e-7 * f64::from(winding_a).abs()
}

/// The currents between which the battery's must stay \[A\]: its limits, and what the remaining
/// charge, give or take `rounding_soc`, allows for one step.
#[derive(Debug)]
pub struct Limits {
    charge_a: f64,
    discharge_a: f64,
}

impl Limits {
    pub fn new(
        params: &BatteryParams,
        state: &BatteryState,
        dt_s: Real,
        rounding_soc: f64,
    ) -> Self {
        let a_per_soc = 3600.0 * f64::from(params.capacity_ah) / f64::from(dt_s);
        let soc = f64::from(state.soc.get());
        let charge_a = (1.0 - soc + rounding_soc) * a_per_soc;
        let discharge_a = (soc + rounding_soc) * a_per_soc;
        Self {
            charge_a: charge_a.min(f64::from(params.charge_limit_a)),
            discharge_a: discharge_a.min(f64::from(params.discharge_limit_a)),
        }
    }

    pub fn keep(&self, battery_a: Real, winding_a: Real) -> bool {
        let (current_a, rounding_a) = (f64::from(battery_a), held_within_a(battery_a, winding_a));
        (-self.charge_a - rounding_a..=self.discharge_a + rounding_a).contains(&current_a)
    }
}

/// The exception that a duty limit makes: what the machine generates, by its speed and by the
/// current that its winding holds, exceeds what the largest duty sets against it. No duty from the
/// commanded one up to the limit keeps the charge limit then. (Small ones do, but they brake with a
/// shorted winding, at a current that nobody asked for.)
fn back_emf_is_too_large(
    commanded: Real,
    out: &PowertrainOutput,
    duty_limit: Real,
    keeps: impl Fn(Real) -> bool,
) -> bool {
    let from = commanded.clamp(-duty_limit, duty_limit);
    out.limited == Limited::Charge
        && out.duty.abs() == duty_limit
        && out.duty * commanded > 0.0
        && !(0_u8..=20).any(|i| keeps(from + (out.duty - from) * Real::from(i) / 20.0))
}

/// The same plant without any limit, and without what is cut off when its battery cannot feed it.
fn unlimited(params: PowertrainParams, starved: bool) -> PowertrainParams {
    let battery = BatteryParams {
        capacity_ah: 1e9,
        discharge_limit_a: Real::INFINITY,
        charge_limit_a: Real::INFINITY,
        ..params.battery
    };
    let mut converter = ConverterParams { duty_limit: Real::INFINITY, ..params.converter };
    let mut auxiliary = params.auxiliary;
    if starved {
        converter.constant_loss_w = 0.0;
        auxiliary = AuxiliaryParams::NONE;
    }
    PowertrainParams { battery, auxiliary, converter, ..params }
}

/// A plant with tight limits now and then, and near-empty or near-full now and then.
fn case(d: &mut Draw) -> (PowertrainParams, Real) {
    let plant = draw::plant(d);
    let tight = if d.seldom() { 0.05 } else { 1.0 };
    let battery = BatteryParams {
        capacity_ah: if d.seldom() { d.near(1e-3) } else { plant.battery.capacity_ah },
        discharge_limit_a: tight * plant.battery.discharge_limit_a,
        charge_limit_a: tight * plant.battery.charge_limit_a,
        ..plant.battery
    };
    let soc = d.ratio();
    let margin = d.near(1e-6).min(0.5);
    let soc = if d.seldom() { if soc > 0.5 { 1.0 - margin } else { margin } } else { soc };
    (PowertrainParams { battery, ..plant }, soc)
}

proptest! {
    #![proptest_config(cases(4096))]

    #[test]
    fn battery_current_keeps_its_limits(
        (params, soc) in drawn(PLAUSIBLE, case),
        dt_s in log(1e-5, 0.1),
        speed in signed(60.0),
        current in signed(500.0),
        slope in signed(0.3),
        inputs in prop::collection::vec((signed(1.1), positive(8000.0), positive(2e4)), 1..20),
    ) {
        let dt = Dt::from_s(dt_s).unwrap();
        let plant = Powertrain::new(params, dt).unwrap();
        let free = [false, true].map(|starved| {
            Powertrain::new(unlimited(params, starved), dt).unwrap()
        });
        let mut s = plant.at_speed(soc, speed).unwrap();
        s.current_a = Accum::new(current);
        for (duty, brake_n, auxiliary_w) in inputs {
            let road = Road { grade: Grade::from_sin(slope), headwind_m_s: 0.0, brake_n };
            let input = PowertrainInput { duty, road, auxiliary_w };
            let (before, limits) = (s, Limits::new(&params.battery, &s.battery, dt_s, SOC_ROUNDING));
            let exactly = Limits::new(&params.battery, &s.battery, dt_s, 0.0);
            let winding_a = s.current_a.get();
            let out = plant.step(&mut s, input);
            prop_assert!(!out.rejected, "{out:?}");
            let keeps_at = |duty| {
                let auxiliary_w = if out.auxiliary_starved { 0.0 } else { auxiliary_w };
                let free = &free[usize::from(out.auxiliary_starved)];
                let input = PowertrainInput { duty, auxiliary_w, ..input };
                exactly.keep(free.step(&mut before.clone(), input).battery_a, winding_a)
            };
            prop_assert!(
                limits.keep(out.battery_a, winding_a)
                    || back_emf_is_too_large(duty, &out, params.converter.duty_limit, keeps_at),
                "{limits:?} {input:?} {out:?} {before:?}"
            );
        }
    }
}
