//! More current, brake or duty acts in the direction that it should, from any state.

use plant_core::battery::{Battery, BatteryInput, BatteryParams, BatteryState};
use plant_core::converter::ConverterParams;
use plant_core::mechanics::body::Road;
use plant_core::mechanics::slope::Grade;
use plant_core::powertrain::{DriveParams, Powertrain, PowertrainInput, PowertrainParams};
use plant_core::{Accum, Dt, Real};
use proptest::prelude::*;

use crate::check::{cases, log, positive, signed};
use crate::draw::{self, Draw, PLAUSIBLE, drawn};

/// A plant whose battery does not hold the duty back.
fn unlimited_plant(d: &mut Draw) -> PowertrainParams {
    let plant = draw::plant(d);
    let battery = BatteryParams {
        discharge_limit_a: Real::INFINITY,
        charge_limit_a: Real::INFINITY,
        capacity_ah: 1e6,
        ..plant.battery
    };
    let converter = ConverterParams { duty_limit: 2.0, ..plant.drives.converter };
    let drives = DriveParams { converter, ..plant.drives };
    PowertrainParams { battery, drives, ..plant }
}

proptest! {
    #![proptest_config(cases(2048))]

    #[test]
    fn terminal_voltage_falls_with_the_current(
        params in drawn(PLAUSIBLE, draw::battery),
        dt_s in log(1e-5, 100.0),
        soc in 0.0..=1.0_f32,
        rc_v in signed(10.0),
        (one, other) in (signed(1000.0), signed(1000.0)),
    ) {
        let battery = Battery::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut start = BatteryState::rested(soc).unwrap();
        start.rc.voltage_v = Accum::new(rc_v);
        let at = |current_a| battery.step(&mut start.clone(), BatteryInput { current_a });
        let (less, more) = (at(one.min(other)), at(one.max(other)));
        prop_assert!(less.current_a <= more.current_a, "{less:?} {more:?}");
        prop_assert!(less.terminal_v >= more.terminal_v, "{less:?} {more:?}");
        prop_assert!(less.soc >= more.soc, "{less:?} {more:?}");
        // By the series resistance at least.
        let drop_v = params.series_resistance_ohm * (more.current_a - less.current_a);
        let rounding_v = 1e-6 * (less.terminal_v.abs() + more.terminal_v.abs() + drop_v);
        prop_assert!(less.terminal_v - more.terminal_v >= drop_v - rounding_v);
    }

    #[test]
    fn more_brake_leaves_less_speed(
        params in drawn(PLAUSIBLE, unlimited_plant),
        dt_s in log(1e-5, 1.0),
        speed in signed(40.0),
        current in signed(500.0),
        (duty, sin, headwind_m_s) in (signed(1.0), signed(0.2), signed(20.0)),
        (one, other) in (positive(2e4), positive(2e4)),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut start = plant.at_speed(0.5, speed).unwrap();
        start.drives = Accum::new(current);
        let at = |brake_n| {
            let road = Road { grade: Grade::from_sin(sin), headwind_m_s, brake_n, ..Road::default() };
            plant.step(&mut start.clone(), PowertrainInput { road, auxiliary_w: 0.0, ..PowertrainInput::on(duty) })
        };
        let (less, more) = (at(one.min(other)), at(one.max(other)));
        prop_assert!(more.speed_m_s.abs() <= less.speed_m_s.abs(), "{less:?} {more:?}");
        prop_assert!(more.speed_m_s * less.speed_m_s >= 0.0, "{less:?} {more:?}");
    }

    /// As long as the battery gives less than its greatest power, that is, keeps half of its
    /// voltage: beyond, a larger duty drains it to no effect.
    #[test]
    fn a_larger_duty_gives_no_less_current(
        params in drawn(PLAUSIBLE, unlimited_plant),
        dt_s in log(1e-5, 1.0),
        speed in signed(40.0),
        current in signed(500.0),
        sin in signed(0.2),
        brake_n in positive(5000.0),
        (one, other) in (-1.5..1.5_f32, -1.5..1.5_f32),
    ) {
        let plant = Powertrain::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut start = plant.at_speed(0.5, speed).unwrap();
        start.drives = Accum::new(current);
        let at = |duty| {
            let road = Road { grade: Grade::from_sin(sin), brake_n, ..Road::default() };
            plant.step(&mut start.clone(), PowertrainInput { road, auxiliary_w: 0.0, ..PowertrainInput::on(duty) })
        };
        let (low, high) = (at(one.min(other)), at(one.max(other)));
        let idle_v = at(0.0).battery_v;
        prop_assume!(low.battery_v > 0.5 * idle_v && high.battery_v > 0.5 * idle_v);
        let rounding_a = 1e-6 * (current.abs() + low.drives.motor_a.abs());
        prop_assert!(high.drives.motor_a >= low.drives.motor_a - rounding_a, "{low:?} {high:?}");
        let faster_by = high.speed_m_s - low.speed_m_s;
        prop_assert!(faster_by >= -1e-6 * speed.abs().max(low.speed_m_s.abs()), "{low:?} {high:?}");
    }
}
