//! A battery with maps: finite for any input, its charge booked, its books closed in the plant.

use plant_core::battery::{MappedBattery, MappedBatteryInput};
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::powertrain::PowertrainInput;
use plant_core::{Dt, Real};
use proptest::prelude::*;

use crate::charge::SOC_ROUNDING;
use crate::check::{cases, check, inputs, keeps, log, positive, signed};
use crate::draw::{self, PERMITTED, PLAUSIBLE, drawn, within};
use crate::finite::some;

/// As for the plain battery: a few of the scalar's last bits of the turnover.
const CLOSES: f64 = 4e-7;

#[test]
fn stays_finite_and_keeps_what_it_rejects_out() {
    let model = some(PERMITTED, |d| (draw::mapped_battery(d), d.dt(), d.ratio()));
    check(512, (model, inputs([signed(500.0)])), |((params, dt, soc), inputs)| {
        let model = MappedBattery::new(params, dt).unwrap();
        keeps(model.rested(soc).unwrap(), &inputs, |s, [current_a]| {
            let out = model.step(s, MappedBatteryInput { current_a });
            (out, out.rejected)
        })
    });
}

#[test]
fn stays_finite_in_the_plant() {
    let model = some(within(1e3), |d| {
        let battery = draw::mapped_battery(d);
        (battery, d.dt(), d.ratio())
    });
    let plants = drawn(PLAUSIBLE, draw::plant);
    let inputs = inputs([signed(1.0), signed(0.2), positive(5000.0), positive(2000.0)]);
    check(256, (model, plants, inputs), |((battery, dt, soc), plant, inputs)| {
        let model = plant.with_battery(battery).build(dt).unwrap();
        keeps(model.at_rest(soc).unwrap(), &inputs, |s, [duty, sin, brake_n, auxiliary_w]| {
            let grade = Grade { sin, ..Grade::from_sin(sin) };
            let road = Road { grade, brake_n, ..Road::default() };
            let out =
                model.step(s, PowertrainInput { road, auxiliary_w, ..PowertrainInput::on(duty) });
            (out, out.rejected)
        })
    });
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn charge_is_booked_or_refused(
        params in drawn(PLAUSIBLE, draw::mapped_battery),
        dt_s in log(1e-3, 10.0),
        soc in 0.0..=1.0_f32,
        currents in prop::collection::vec(signed(1000.0), 200),
    ) {
        let battery = MappedBattery::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = battery.rested(soc).unwrap();
        let (h, capacity_c) = (f64::from(dt_s), 3600.0 * f64::from(params.capacity_ah));
        for current_a in currents {
            let before = s;
            let out = battery.step(&mut s, MappedBatteryInput { current_a });
            prop_assert!((0.0..=1.0).contains(&out.soc) && !out.rejected);
            let (asked_c, flowed_c) = (f64::from(current_a) * h, f64::from(out.current_a) * h);
            let off_c = asked_c - flowed_c - f64::from(out.refused_charge_c);
            prop_assert!(off_c.abs() <= 1e-6 * asked_c.abs() + 1e-30, "refused {off_c} off: {out:?}");
            let off_c = f64::from(before.soc.since(s.soc)) * capacity_c - flowed_c;
            let rounding_c = SOC_ROUNDING * capacity_c + 1e-6 * flowed_c.abs();
            prop_assert!(off_c.abs() <= rounding_c, "booked {off_c} off: {out:?}");
            prop_assert!((-1.0..=1.0).contains(&s.hysteresis.get()), "{s:?}");
        }
    }

    #[test]
    fn the_ledger_closes(
        battery in drawn(PLAUSIBLE, draw::mapped_battery),
        plant in drawn(PLAUSIBLE, draw::plant),
        dt_s in log(1e-4, 0.1),
        speed in signed(30.0),
        duties in prop::collection::vec((signed(1.0), signed(0.1)), 1..8),
    ) {
        let dt = Dt::from_s(dt_s).unwrap();
        let plant = plant.with_battery(battery).build(dt).unwrap().with_ledger();
        let start = plant.at_speed(0.6, speed).unwrap();
        let mut s = start;
        for (duty, sin) in duties {
            let road = Road { grade: Grade::from_sin(sin), ..Road::default() };
            for _ in 0..500 {
                let input = PowertrainInput { road, auxiliary_w: 300.0, ..PowertrainInput::on(duty) };
                let before = s; let out = plant.step(&mut s, input); prop_assert!(!out.rejected, "{out:?} {before:?}");
            }
        }
        let report = plant.energy(&start, &s);
        let kinetic_j = 0.5 * f64::from(plant.moving_mass_kg()) * f64::from(speed).powi(2);
        let terms = report.terms();
        let turnover_j: f64 = terms
            .iter()
            .filter(|(name, _)| *name != "residual")
            .map(|(_, j): &(_, Real)| f64::from(*j).abs())
            .sum();
        let residual_j = f64::from(report.residual).abs();
        prop_assert!(residual_j <= CLOSES * (turnover_j + kinetic_j), "{residual_j} of {turnover_j}");
    }
}
