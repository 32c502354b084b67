//! What lies between battery and vehicle, against closed forms.

use plant_core::link::{
    Contactor, ContactorFault, ContactorInput, ContactorParams, ContactorState, Insulation,
    InsulationInput, InsulationParams, InsulationState, Link, LinkInput, LinkParams, LinkState,
};
use plant_core::port::Source;
use plant_core::{Dt, Real};

use super::tolerance as t;
use super::{Case, Checks};

pub(super) const CASES: [Case; 3] = [
    Case { name: "precharge of the link", models: &["Link"], run: precharge },
    Case { name: "contactor", models: &["Contactor"], run: contactor },
    Case { name: "insulation to the chassis", models: &["Insulation"], run: insulation },
];

const DT_S: f64 = 1e-4;
const CAPACITANCE_F: Real = 0.00096;
const RESISTOR_OHM: Real = 40.0;
/// Pack and link at the start of a recorded precharge of a car \[V\].
const PACK_V: f64 = 355.0;
const FIRST_V: f64 = 121.0;

/// From 121 V on, `v = 355 − 234·e^(−t/τ)` with τ = 38.4 ms; and every charge that leaves the battery
/// is in the capacitor.
fn precharge(checks: &mut Checks) -> anyhow::Result<()> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let (dt_s, pack_v, first_v) = (DT_S as Real, PACK_V as Real, FIRST_V as Real);
    let params = LinkParams {
        capacitance_f: CAPACITANCE_F,
        bleeder_ohm: Real::INFINITY,
        precharge_ohm: RESISTOR_OHM - 0.001,
        contact_ohm: 0.001,
        fuse_rated_a: Real::INFINITY,
        fuse_melting_a2s: 1e5,
    };
    let (link, mut state) = (Link::new(params, Dt::from_s(dt_s)?)?, LinkState::charged_to(first_v));
    let input = LinkInput {
        source: Source::stiff(pack_v),
        minus: true,
        precharge: true,
        plus: false,
        load_a: 0.0,
        short_ohm: Real::INFINITY,
    };
    let tau_s = f64::from(RESISTOR_OHM) * f64::from(CAPACITANCE_F);
    let (mut worst_v, mut charge_c, mut charged_s) = (0.0_f64, 0.0, None);
    for number in 1..=4000_u32 {
        let out = link.step(&mut state, input);
        let time_s = f64::from(number) * DT_S;
        let exact_v = PACK_V - (PACK_V - FIRST_V) * (-time_s / tau_s).exp();
        worst_v = worst_v.max((f64::from(out.voltage_v) - exact_v).abs());
        charge_c += f64::from(out.battery_a) * DT_S;
        if out.voltage_v >= pack_v - 1.0 {
            charged_s = charged_s.or(Some(time_s));
        }
    }
    checks.add(&t::PRECHARGE_TRAJECTORY, worst_v);
    let until_s = tau_s * (PACK_V - FIRST_V).ln();
    checks.against(&t::PRECHARGE_TIME, until_s, charged_s.unwrap_or(f64::NAN));
    let stored_c = f64::from(CAPACITANCE_F) * (f64::from(state.voltage_v.get()) - FIRST_V);
    checks.add(&t::PRECHARGE_CHARGE, (charge_c - stored_c).abs() / stored_c);
    Ok(())
}

/// It closes and opens its lags after its coil.
fn contactor(checks: &mut Checks) -> anyhow::Result<()> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let dt = Dt::from_s(DT_S as Real)?;
    let params = ContactorParams::USUAL;
    let (contactor, mut state) = (Contactor::new(params, dt)?, ContactorState::default());
    for (coil, bound, lag_s) in
        [(true, &t::CONTACTOR_CLOSES, params.close_s), (false, &t::CONTACTOR_OPENS, params.open_s)]
    {
        let input = ContactorInput { coil, fault: ContactorFault::None };
        let steps = (0..10_000_u32)
            .find(|_| contactor.step(&mut state, input).shows_closed == coil)
            .map_or(f64::NAN, f64::from);
        checks.against(bound, f64::from(lag_s), steps * DT_S);
        for _ in 0..1000 {
            contactor.step(&mut state, input);
        }
    }
    Ok(())
}

/// The measured resistance is that of the leak, on either side of the pack.
fn insulation(checks: &mut Checks) -> anyhow::Result<()> {
    #[expect(clippy::cast_possible_truncation, reason = "the plant computes in f32")]
    let (dt, pack_v) = (Dt::from_s(DT_S as Real)?, PACK_V as Real);
    let insulation = Insulation::new(InsulationParams::USUAL, dt)?;
    let mut worst = 0.0_f64;
    for (plus_ohm, minus_ohm) in [(35.5e3, 3e6), (3e6, 35.5e3), (150e3, Real::INFINITY)] {
        let mut state = InsulationState::default();
        let input = InsulationInput { pack_v, plus_ohm, minus_ohm };
        let readings = (0..81_000).filter_map(|_| insulation.step(&mut state, input).measured_ohm);
        let measured = readings.last().map_or(f64::NAN, f64::from);
        let error = (measured / f64::from(plus_ohm.min(minus_ohm)) - 1.0).abs();
        worst = if error > worst || error.is_nan() { error } else { worst };
    }
    checks.add(&t::INSULATION_MEASURED, worst);
    Ok(())
}
