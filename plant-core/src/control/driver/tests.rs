//! Both drivers in closed loop, and the torque driver's single decision against its rules.

extern crate std;

mod torque;

use super::torque::STANDSTILL_M_S;
use super::*;
use crate::num::min;
use crate::powertrain::{Limited, Powertrain, PowertrainInput, PowertrainOutput};
use crate::presets::{BMW_I3_60AH_CONSTANT, EPOWERTRAIN_UDDS, Vehicle};

const DT: Dt = crate::must!(Dt::from_s(0.001));

struct Run {
    top_m_s: Real,
    brake_n: Real,
    last: PowertrainOutput,
}

/// Drives towards a reference of time for a while.
fn drive(vehicle: &Vehicle, soc: Real, v0: Real, steps: u32, reference: fn(Real) -> Real) -> Run {
    let plant = Powertrain::new(vehicle.powertrain, DT).unwrap();
    let driver = Driver::new(vehicle.driver, &vehicle.powertrain, DT).unwrap();
    let (mut ps, mut ds) = (plant.at_speed(soc, v0).unwrap(), DriverState::default());
    let mut feedback = plant.feedback(&ps);
    let mut run: Option<Run> = None;
    for n in 0..steps {
        let t = n as Real * 0.001;
        let input = DriverInput {
            reference_m_s: reference(t),
            reference_m_s2: (reference(t + 0.001) - reference(t)) / 0.001,
            vehicle: feedback,
        };
        let command = driver.step(&mut ds, input);
        let mut input = PowertrainInput::on(command.duty);
        input.road.brake_n = command.brake_n;
        let out = plant.step(&mut ps, input);
        assert!(!out.rejected && !command.rejected && command.brake_n >= 0.0);
        feedback = Feedback::from(&out);
        let (top, brake) = run.map_or((0.0, 0.0), |r| (r.top_m_s, r.brake_n));
        run = Some(Run {
            top_m_s: max(top, out.speed_m_s),
            brake_n: if n > 100 { max(brake, command.brake_n) } else { 0.0 },
            last: out,
        });
    }
    run.unwrap()
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn both_drivers_follow_a_ramp_and_hold_a_speed() {
    for vehicle in [&BMW_I3_60AH_CONSTANT, &EPOWERTRAIN_UDDS] {
        let run = drive(vehicle, 0.8, 0.0, 20_000, |t| min(1.5 * t, 15.0));
        assert!((run.last.speed_m_s - 15.0).abs() < 0.02, "{}", run.last.speed_m_s);
        assert!(run.top_m_s < 15.3, "{}", run.top_m_s);
    }
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn peak_torque_and_power_limit_the_acceleration() {
    let DriverParams::Torque(p) = BMW_I3_60AH_CONSTANT.driver else { panic!("a torque driver") };
    let run = drive(&BMW_I3_60AH_CONSTANT, 0.8, 0.0, 1000, |_| 50.0);
    assert!(
        (run.last.drives.motor_nm / p.peak_torque_nm - 1.0).abs() < 0.02,
        "{}",
        run.last.drives.motor_nm
    );
    let run = drive(&BMW_I3_60AH_CONSTANT, 0.8, 0.0, 8000, |_| 50.0);
    let power_w = run.last.drives.motor_nm * run.last.drives.motor_rad_s;
    assert!((power_w / p.peak_power_w - 1.0).abs() < 0.02, "{power_w}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_brake_takes_what_regeneration_may_not() {
    let stop = |t: Real| max(20.0 - 1.5 * t, 0.0);
    let half = drive(&BMW_I3_60AH_CONSTANT, 0.8, 20.0, 6000, stop);
    let full = drive(&BMW_I3_60AH_CONSTANT, 1.0, 20.0, 6000, stop);
    for run in [&half, &full] {
        assert!((run.last.speed_m_s - 11.0).abs() < 0.1, "{}", run.last.speed_m_s);
    }
    assert!(half.last.soc > 0.8 && half.brake_n < 50.0, "{} {}", half.last.soc, half.brake_n);
    assert!(full.last.soc <= 1.0 && full.brake_n > 1500.0, "{}", full.brake_n);
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn holds_at_standstill_with_the_brake() {
    let run = drive(&BMW_I3_60AH_CONSTANT, 0.8, 5.0, 8000, |t| max(5.0 - 2.0 * t, 0.0));
    let DriverParams::Torque(p) = BMW_I3_60AH_CONSTANT.driver else { panic!("a torque driver") };
    assert_eq!((run.last.speed_m_s, run.brake_n), (0.0, p.brake_limit_n));
    assert!(run.last.drives.motor_a.abs() < 0.1, "{}", run.last.drives.motor_a);
}

#[test]
fn bad_input_holds_the_last_command() {
    for vehicle in [&BMW_I3_60AH_CONSTANT, &EPOWERTRAIN_UDDS] {
        let driver = Driver::new(vehicle.driver, &vehicle.powertrain, DT).unwrap();
        let mut s = DriverState::default();
        let good = DriverInput {
            reference_m_s: 5.0,
            reference_m_s2: 0.0,
            vehicle: Feedback { speed_m_s: 4.9, battery_v: 380.0, soc: 0.5, ..Feedback::default() },
        };
        let before = driver.step(&mut s, good);
        for bad in [Real::NAN, Real::INFINITY, 1e38] {
            let seen = good.vehicle;
            let torque = matches!(vehicle.driver, DriverParams::Torque(_));
            let vehicles = [
                Feedback { speed_m_s: bad, ..seen },
                Feedback { motor_a: bad, ..seen },
                Feedback { battery_v: bad, ..seen },
                Feedback { soc: bad, ..seen },
            ];
            // The other driver looks at nothing but the speed.
            let mut inputs = std::vec![DriverInput { reference_m_s: bad, ..good }];
            inputs.extend(
                vehicles
                    .iter()
                    .take(if torque { 4 } else { 1 })
                    .map(|v| DriverInput { vehicle: *v, ..good }),
            );
            if torque {
                inputs.push(DriverInput { reference_m_s2: bad, ..good });
            }
            for input in inputs {
                let out = driver.step(&mut s, input);
                assert!(out.rejected, "{input:?}");
                assert_eq!((out.duty, out.brake_n), (before.duty, before.brake_n));
            }
        }
    }
}

#[test]
fn refuses_each_bad_field_by_name() {
    let DriverParams::Torque(p) = BMW_I3_60AH_CONSTANT.driver else { panic!("a torque driver") };
    let refused =
        |p| TorqueDriver::new(p, &BMW_I3_60AH_CONSTANT.powertrain, DT).unwrap_err().field();
    let bad = -1.0;
    for (params, field) in [
        (TorqueDriverParams { peak_torque_nm: bad, ..p }, "driver.torque.peak_torque_nm"),
        (TorqueDriverParams { peak_power_w: bad, ..p }, "driver.torque.peak_power_w"),
        (TorqueDriverParams { regen_torque_nm: bad, ..p }, "driver.torque.regen_torque_nm"),
        (TorqueDriverParams { regen_power_w: bad, ..p }, "driver.torque.regen_power_w"),
        (TorqueDriverParams { regen_fade_m_s: bad, ..p }, "driver.torque.regen_fade_m_s"),
        (TorqueDriverParams { regen_fade_soc: bad, ..p }, "driver.torque.regen_fade_soc"),
        (TorqueDriverParams { brake_limit_n: bad, ..p }, "driver.torque.brake_limit_n"),
        (TorqueDriverParams { current_rate_per_s: bad, ..p }, "driver.torque.current_rate_per_s"),
    ] {
        assert_eq!(refused(params), field);
    }
}

/// One decision of a fresh torque driver against its rules, written once more.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
#[allow(clippy::too_many_lines, reason = "one rule after the other")]
fn a_decision_follows_the_rules() {
    let DriverParams::Torque(p) = BMW_I3_60AH_CONSTANT.driver else { panic!("a torque driver") };
    let car = BMW_I3_60AH_CONSTANT.powertrain;
    let driver = Driver::new(DriverParams::Torque(p), &car, DT).unwrap();
    let Driver::Torque(torque, _) = driver else { panic!("a torque driver") };
    let turns = car.drives.gearbox.ratio / car.wheel.radius_m;
    let mass_kg = car.body.mass_kg
        + car.wheel.inertia_kg_m2 / car.wheel.radius_m.powi(2)
        + (car.drives.motor.inertia_kg_m2 + car.drives.gearbox.inertia_kg_m2) * turns * turns;
    let gain_ohm =
        car.drives.motor.inductance_h * p.current_rate_per_s / (1.0 + 0.001 * p.current_rate_per_s);
    let ohm = gain_ohm + car.drives.motor.resistance_ohm + car.drives.converter.resistance_ohm;
    let mut seed = 1_u32;
    let mut number = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as Real / 8_388_608.0 - 1.0
    };
    let mut seen = [0; 5];
    for n in 0..4000 {
        let small = if n % 4 == 0 { 0.05 } else { 1.0 };
        let v = if n % 50 == 0 { 0.0 } else { small * (10.0 + 30.0 * number()) };
        let reference_m_s2 = small * 2.0 * number();
        let reference_m_s = v + small * number() * if n % 3 == 0 { 3.0 } else { 0.2 };
        let motor_a = 300.0 * number();
        let vehicle = Feedback {
            speed_m_s: v,
            motor_a,
            motor_nm: car.drives.motor.torque_nm_per_a * motor_a,
            battery_v: if n % 100 == 0 { 0.5 } else { 350.0 },
            soc: (0.8 + 0.4 * number()).clamp(0.0, 1.0),
            duty: 0.1,
            limited: n % 7 == 0,
            slope_sin: 0.0,
        };
        let last_m_s = v - 0.01 * number();
        let mut state = DriverState { last_m_s: Some(last_m_s), ..DriverState::default() };
        let out = driver.step(&mut state, DriverInput { reference_m_s, reference_m_s2, vehicle });

        let force_n = (p.speed.proportional * (reference_m_s - v)).clamp(-2e4, 2e4);
        let wanted_nm = (force_n + mass_kg * reference_m_s2) / turns;
        let slow = v.abs() < STANDSTILL_M_S;
        let forward = if slow { reference_m_s >= 0.0 } else { v > 0.0 };
        let direction = if forward { 1.0 } else { -1.0 };
        let (wanted_nm, motor_rad_s) = (direction * wanted_nm, turns * v.abs());
        let most_nm = p.peak_torque_nm.min(p.peak_power_w / motor_rad_s);
        let fade = (v.abs() / p.regen_fade_m_s).min(1.0)
            * ((1.0 - vehicle.soc) / p.regen_fade_soc).min(1.0);
        let least_nm = -p.regen_torque_nm.min(p.regen_power_w / motor_rad_s) * fade;
        let standing = slow && reference_m_s.abs() < STANDSTILL_M_S;
        let mut given_nm = wanted_nm.max(least_nm).min(most_nm);
        if direction * reference_m_s < 0.0 && v.abs() < p.regen_fade_m_s {
            given_nm = given_nm.min(wanted_nm).max(-p.peak_torque_nm);
        }
        let mut short_n = (given_nm - wanted_nm) * turns;
        let motor_nm = direction * car.drives.motor.torque_nm_per_a * vehicle.motor_a;
        if vehicle.limited && wanted_nm < 0.0 {
            // What the motor was to brake with and the battery did not take.
            short_n += (motor_nm - given_nm).max(0.0) * turns;
        } else if vehicle.limited {
            short_n += (motor_nm - given_nm).min(0.0) * turns;
        }
        let mut brake_n = short_n.clamp(0.0, p.brake_limit_n);
        if standing {
            (given_nm, brake_n) = (0.0, p.brake_limit_n);
        }
        let i = vehicle.motor_a;
        // The speed to come: as before, and what the forces change.
        let more_n = (given_nm - motor_nm) * turns - brake_n;
        let mut ahead_m_s = v + (v - last_m_s) + direction * more_n * 0.001 / mass_kg;
        if slow && brake_n > 0.0 {
            ahead_m_s = v;
        }
        let voltage_v = ohm / car.drives.motor.torque_nm_per_a * direction * given_nm
            + car.drives.motor.back_emf_v_s_per_rad * turns * ahead_m_s
            - gain_ohm * i
            + car.drives.converter.voltage_drop_v
                * direction
                * given_nm.signum()
                * Real::from(given_nm != 0.0);
        let duty = voltage_v / vehicle.battery_v.max(1.0);
        assert!(!out.rejected);
        assert!((out.duty - duty).abs() <= 1e-5 * (1.0 + duty.abs()), "{n}: {} {duty}", out.duty);
        assert!(
            (out.brake_n - brake_n).abs() <= 0.05 + 1e-4 * brake_n,
            "{n}: {} {brake_n}",
            out.brake_n
        );
        let rounding_n = 0.05;
        if !standing && short_n.abs() > rounding_n && (short_n - p.brake_limit_n).abs() > rounding_n
        {
            let excess = if short_n < 0.0 { direction } else { -direction };
            let held_back = short_n < 0.0 || short_n > p.brake_limit_n;
            let mut told = DriverState::default();
            torque
                .speed
                .step(&mut told.speed, PidInput { reference: reference_m_s, measurement: v });
            torque.speed.saturate(&mut told.speed, if held_back { excess } else { 0.0 });
            assert_eq!(state.speed, told.speed, "{n}: short of {short_n} N");
        }
        seen[0] += u32::from(given_nm == most_nm);
        seen[1] += u32::from(given_nm == least_nm);
        seen[2] += u32::from(given_nm == wanted_nm);
        seen[3] += u32::from(standing);
        seen[4] += u32::from(short_n > p.brake_limit_n);
    }
    assert!(seen[..4].iter().all(|n| *n > 20), "{seen:?}");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_duty_that_was_not_told_is_no_saturation() {
    let speed = PidParams { proportional: 0.05, integral_per_s: 0.05, ..PidParams::DEFAULT };
    let vehicle = Vehicle { driver: DriverParams::Duty(speed), ..EPOWERTRAIN_UDDS };
    let plant = Powertrain::new(vehicle.powertrain, DT).unwrap();
    let driver = Driver::new(vehicle.driver, &vehicle.powertrain, DT).unwrap();
    let (mut s, mut d) = (plant.at_rest(0.8).unwrap(), DriverState::default());
    let mut seen = plant.feedback(&s);
    for _ in 0..60_000 {
        let input = DriverInput { reference_m_s: 10.0, reference_m_s2: 0.0, vehicle: seen };
        let duty = driver.step(&mut d, input).duty;
        let out = plant.step(&mut s, PowertrainInput::on(duty));
        seen = Feedback { speed_m_s: out.speed_m_s, ..Feedback::default() };
    }
    assert!((seen.speed_m_s - 10.0).abs() < 0.01, "{}", seen.speed_m_s);
}

#[test]
fn a_driver_sees_what_the_plant_says() {
    let plant = Powertrain::new(BMW_I3_60AH_CONSTANT.powertrain, DT).unwrap();
    let mut state = plant.at_speed(0.6, 20.0).unwrap();
    let mut limited = false;
    for n in 0..100 {
        let duty = if n < 50 { 0.4 } else { 1.0 };
        let out = plant.step(&mut state, PowertrainInput::on(duty));
        let seen = Feedback::from(&out);
        assert_eq!(seen.limited, out.limited != Limited::No);
        assert_eq!(
            (seen.speed_m_s, seen.motor_a, seen.soc),
            (out.speed_m_s, out.drives.motor_a, out.soc)
        );
        assert_eq!((seen.battery_v, seen.duty), (out.battery_v, out.drives.duty));
        assert!(n >= 50 || !seen.limited);
        limited |= seen.limited;
    }
    assert!(limited);
}
