//! The state of charge stays within 0..1, and every coulomb is booked or refused.

use plant_core::Dt;
use plant_core::battery::{Battery, BatteryInput, BatteryParams, BatteryState};
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::powertrain::{Powertrain, PowertrainInput, PowertrainParams};
use proptest::prelude::*;

use crate::check::{any_bits, cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// A battery that a few steps can fill or empty.
fn small_plant(d: &mut Draw) -> PowertrainParams {
    let plant = draw::plant(d);
    let capacity_ah = d.near(0.01);
    PowertrainParams { battery: BatteryParams { capacity_ah, ..plant.battery }, ..plant }
}

/// The last bits of a state of charge near 1, twice: of the value and of the limit made of it.
pub const SOC_ROUNDING: f64 = 1.2e-7;

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn battery_under_any_current(
        params in drawn(PLAUSIBLE, draw::battery),
        capacity_ah in log(1e-4, 1e3),
        dt_s in log(1e-4, 100.0),
        soc in 0.0..=1.0_f32,
        currents in prop::collection::vec(prop_oneof![9 => signed(1000.0), 1 => any_bits()], 200),
    ) {
        let params = BatteryParams { capacity_ah, ..params };
        let battery = Battery::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = BatteryState::rested(soc).unwrap();
        let (h, capacity_c) = (f64::from(dt_s), 3600.0 * f64::from(capacity_ah));
        for current_a in currents {
            let before = s;
            let out = battery.step(&mut s, BatteryInput { current_a });
            prop_assert!((0.0..=1.0).contains(&out.soc) && out.soc == s.soc.get());
            let asked_c = if out.rejected { 0.0 } else { f64::from(current_a) * h };
            let flowed_c = f64::from(out.current_a) * h;
            let off_c = asked_c - flowed_c - f64::from(out.refused_charge_c);
            prop_assert!(off_c.abs() <= 1e-6 * asked_c.abs() + 1e-30, "refused {off_c} off: {out:?}");
            let booked_c = f64::from(before.soc.since(s.soc)) * capacity_c;
            let off_c = booked_c - flowed_c;
            let rounding_c = SOC_ROUNDING * capacity_c + 1e-6 * flowed_c.abs();
            prop_assert!(off_c.abs() <= rounding_c, "booked {off_c} off: {out:?}");
            prop_assert!(out.refused_charge_c * current_a >= 0.0 || out.rejected, "{out:?}");
        }
    }

    /// What the battery gave is what its charge fell by, whatever the duty asked for.
    #[test]
    fn powertrain_under_any_duty(
        params in drawn(PLAUSIBLE, small_plant),
        dt_s in log(1e-4, 0.1),
        soc in prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0_f32],
        speed in signed(40.0),
        slope in signed(0.2),
        inputs in prop::collection::vec((signed(1.2), positive(2000.0)), 1..10),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut s = plant.at_speed(soc, speed).unwrap();
        let (h, capacity_c) = (f64::from(dt_s), 3600.0 * f64::from(params.battery.capacity_ah));
        for step in 0..1000 {
            let (duty, brake_n) = inputs[step / 100 % inputs.len()];
            let road = Road { grade: Grade::from_sin(slope), brake_n, ..Road::default() };
            let before = s;
            let out = plant.step(&mut s, PowertrainInput { road, auxiliary_w: 100.0, ..PowertrainInput::on(duty) });
            prop_assert!((0.0..=1.0).contains(&out.soc) && !out.rejected, "{step}: {out:?}");
            let booked_c = f64::from(before.battery.soc.since(s.battery.soc)) * capacity_c;
            let lost_c = f64::from(out.overcharged_c);
            let flowed_c = f64::from(out.battery_a) * h;
            let rounding_c = SOC_ROUNDING * capacity_c + 1e-6 * flowed_c.abs();
            let off_c = booked_c - lost_c - flowed_c;
            prop_assert!(off_c.abs() <= rounding_c, "{step}: {off_c} {out:?} {before:?}");
        }
    }
}
