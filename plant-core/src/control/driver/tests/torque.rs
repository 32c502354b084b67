//! The torque driver at steps of any length, on hills and behind a battery's limits.

use super::*;
use crate::mechanics::body::Road;
use crate::mechanics::slope::Grade;
use crate::presets::BMW_I3_60AH_CONSTANT as CAR;

/// What a drive of some seconds came to.
#[derive(Default)]
struct Drive {
    most_nm: Real,
    least_nm: Real,
    to_100_s: Real,
    brake_changes: u32,
    lowest_m: Real,
    overshoot_m_s: Real,
    speed_m_s: Real,
}

fn drive_for(
    vehicle: &Vehicle,
    dt_s: Real,
    seconds: Real,
    slope_sin: Real,
    reference: impl Fn(Real) -> (Real, Real),
) -> Drive {
    let dt = Dt::from_s(dt_s).unwrap();
    let plant = Powertrain::new(vehicle.powertrain, dt).unwrap();
    let driver = Driver::new(vehicle.driver, &vehicle.powertrain, dt).unwrap();
    let (mut s, mut d) = (plant.at_rest(0.6).unwrap(), DriverState::default());
    let (mut seen, mut drive, mut braked) = (plant.feedback(&s), Drive::default(), true);
    for n in 0..(seconds / dt_s) as u32 {
        let t = n as Real * dt_s;
        let (reference_m_s, reference_m_s2) = reference(t);
        let command =
            driver.step(&mut d, DriverInput { reference_m_s, reference_m_s2, vehicle: seen });
        let grade = Grade::from_sin(slope_sin);
        let road = Road { grade, brake_n: command.brake_n, ..Road::default() };
        let out = plant.step(&mut s, PowertrainInput { road, ..PowertrainInput::on(command.duty) });
        assert!(!out.rejected && !command.rejected);
        seen = Feedback::from(&out);
        drive.most_nm = drive.most_nm.max(out.drives.motor_nm);
        drive.least_nm = drive.least_nm.min(out.drives.motor_nm);
        if drive.to_100_s == 0.0 && out.speed_m_s > 27.78 {
            drive.to_100_s = t;
        }
        drive.brake_changes += u32::from((command.brake_n > 0.0) != braked);
        braked = command.brake_n > 0.0;
        drive.lowest_m = drive.lowest_m.min(out.distance_m);
        drive.overshoot_m_s = drive.overshoot_m_s.max(out.speed_m_s - reference_m_s);
        drive.speed_m_s = out.speed_m_s;
    }
    drive
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_torque_is_the_commanded_one_at_any_step() {
    let race = |t: Real| (if t < 20.0 { 50.0 } else { 0.0 }, 0.0);
    for dt_s in [1e-4, 1e-3, 1e-2, 2e-2] {
        let drive = drive_for(&CAR, dt_s, 40.0, 0.0, race);
        assert!((drive.most_nm / 250.0 - 1.0).abs() < 0.03, "{dt_s}: {} N·m", drive.most_nm);
        assert!((drive.least_nm / -87.0 - 1.0).abs() < 0.03, "{dt_s}: {} N·m", drive.least_nm);
        assert!((drive.to_100_s - 7.3).abs() < 0.15, "{dt_s}: {} s", drive.to_100_s);
    }
}

/// The car does it in 7.2 s \[BMW, technical data of the i3, 2013\], with the driver alone.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn the_car_that_trips_tell_is_as_quick_as_the_real_one() {
    let told = crate::presets::BMW_I3_60AH;
    let powertrain = told.powertrain.with_battery(CAR.powertrain.battery);
    let car = Vehicle { name: told.name, initial_soc: 0.6, powertrain, driver: told.driver };
    let to_100_s = drive_for(&car, 1e-3, 10.0, 0.0, |_| (50.0, 0.0)).to_100_s;
    assert!((7.2..=7.9).contains(&to_100_s), "{to_100_s} s");
}

#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_start_on_a_hill_neither_rolls_back_nor_switches_the_brake() {
    let ramp = |t: Real| ((t - 1.0).max(0.0), if t > 1.0 { 1.0 } else { 0.0 });
    let backwards = |t: Real| (-(t - 1.0).max(0.0), if t > 1.0 { -1.0 } else { 0.0 });
    let creep = |_| (0.05, 0.0);
    for dt_s in [1e-4, 1e-3, 1e-2, 2e-2] {
        for slope_sin in [0.15, 0.05, -0.15] {
            let drive = drive_for(&CAR, dt_s, 6.0, slope_sin, ramp);
            assert!(drive.lowest_m > -0.01, "{dt_s} {slope_sin}: {} m", drive.lowest_m);
            let changes = drive.brake_changes;
            assert!(slope_sin < 0.0 || changes == 1, "{dt_s} {slope_sin}: {changes}");
            assert!((drive.speed_m_s - 5.0).abs() < 0.1, "{dt_s}: {}", drive.speed_m_s);
        }
        let drive = drive_for(&CAR, dt_s, 10.0, 0.1, creep);
        assert!(drive.lowest_m > -0.01 && drive.brake_changes == 1, "{dt_s}: {}", drive.lowest_m);
        assert!((drive.speed_m_s - 0.05).abs() < 0.03, "{dt_s}: {}", drive.speed_m_s);
        let drive = drive_for(&CAR, dt_s, 6.0, -0.15, backwards);
        assert!(drive.brake_changes == 1, "{dt_s}: {}", drive.brake_changes);
        assert!((drive.speed_m_s + 5.0).abs() < 0.1, "{dt_s}: {}", drive.speed_m_s);
    }
}

/// Behind the battery's discharge limit it overshoots no more than behind its own of the power.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn a_battery_limit_does_not_wind_it_up() {
    let over = |limit_a: Real, peak_power_w: Real, proportional: Real, integral_per_s: Real| {
        let mut vehicle = CAR;
        let DriverParams::Torque(torque) = &mut vehicle.driver else { panic!("a torque driver") };
        torque.peak_power_w = peak_power_w;
        torque.speed = PidParams { proportional, integral_per_s, ..torque.speed };
        vehicle.powertrain.battery.discharge_limit_a = limit_a;
        let ramp = |t: Real| ((3.0 * t).min(20.0), 0.0);
        drive_for(&vehicle, 1e-3, 60.0, 0.0, ramp).overshoot_m_s
    };
    for (p, i) in [(6000.0, 3000.0), (2000.0, 500.0), (1000.0, 250.0), (500.0, 100.0)] {
        let (own, behind) = (over(400.0, 30e3, p, i), over(85.0, 125e3, p, i));
        assert!(behind < 1.2 * own + 0.05, "{p} {i}: {behind} m/s, {own} by its own limit");
    }
}
