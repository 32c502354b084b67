//! Vehicles with other drives than one DC machine, as C drives them.
#![cfg(all(feature = "drives", feature = "pmsm", feature = "thermal"))]

use plant_core::battery::BatteryParams;
use plant_core::control::driver::{DriverInput, DriverParams, DriverState, Steering, TorqueDriver};
use plant_core::powertrain::{DrivesParams, PowertrainInput};
use plant_core::presets::{self, Vehicle};
use plant_core::{Dt, Real};
use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod vehicle;
use vehicle::{DT_S, inputs, plant, preset, refusal, snapshot, state, step, stepped};

/// Steps a preset beside its models; gives what C says at the end.
fn as_the_models<D: DrivesParams>(
    number: VoltstepPreset,
    vehicle: &Vehicle<BatteryParams, D>,
) -> VoltstepOutputs {
    let dt = Dt::from_s(DT_S).unwrap();
    let model = vehicle.powertrain.build(dt).unwrap();
    let DriverParams::Torque(driver) = vehicle.driver else { panic!("a torque driver") };
    let (body_kg, moving_kg) = (vehicle.powertrain.body.mass_kg, model.moving_mass_kg());
    let driver =
        TorqueDriver::fitted(driver, model.motor_rad_per_m(), body_kg, moving_kg, dt).unwrap();
    let mut model_state = model.at_rest(vehicle.initial_soc).unwrap();
    let (mut driver_state, mut seen) = (DriverState::default(), model.feedback(&model_state));

    let params = preset(number);
    let plant = plant(&params);
    let mut state = state(&plant, params.initial_soc);
    let mut last = None;
    for n in 0..2000_u16 {
        let reference_m_s = if n < 1000 { Real::from(n) * 0.01 } else { 10.0 };
        let driven = DriverInput { reference_m_s, reference_m_s2: 0.0, vehicle: seen };
        let command = driver.steer(&mut driver_state, driven, model.drives());
        let mut input = PowertrainInput::with(command.command);
        input.road.brake_n = command.brake_n;
        let wanted = model.step(&mut model_state, input);
        seen = model.seen_of(&wanted);
        let (_, out) = step(&plant, &mut state, &inputs(reference_m_s));
        assert_eq!(
            [out.drives[0].duty, out.drives[0].motor_a, out.motor_nm, out.speed_m_s, out.soc],
            [seen.duty, seen.motor_a, seen.motor_nm, wanted.speed_m_s, wanted.soc],
            "{n}"
        );
        last = Some(out);
    }
    let now = snapshot(&state);
    assert_eq!(now.soc.value.to_bits(), model_state.battery.soc.get().to_bits());
    last.unwrap()
}

#[test]
fn a_synchronous_machine_steps_as_the_models_do() {
    let out = as_the_models(VoltstepPreset::BmwI3Pmsm, &presets::BMW_I3_60AH_PMSM);
    let [one, others @ ..] = out.drives;
    assert!(
        one.motor_rad_s > 200.0 && one.coarse_step && one.d_a < 0.0 && one.q_a > 0.0,
        "{out:?}"
    );
    assert_eq!(one.motor_nm, out.motor_nm);
    assert!(others.iter().all(|drive| drive.duty == 0.0 && drive.motor_rad_s == 0.0), "{out:?}");
}

#[test]
fn two_axles_step_as_the_models_do() {
    let out = as_the_models(VoltstepPreset::TwoAxles, &presets::TWO_AXLES);
    let [rear, front, none, _] = out.drives;
    assert!(rear.q_a > 0.0 && front.q_a == 0.0 && front.motor_a > 0.0, "{out:?}");
    assert!(rear.motor_rad_s > front.motor_rad_s && none.motor_rad_s == 0.0, "{out:?}");
    assert!(rear.motor_nm < out.motor_nm, "{out:?}");
}

/// As it is, and with a part that is hot from the start.
#[test]
fn a_drive_that_heats_up_steps_as_the_models_do() {
    let [one, others @ ..] =
        as_the_models(VoltstepPreset::BmwI3Thermal, &presets::BMW_I3_60AH_THERMAL).drives;
    assert!(one.machine_c > 50.0 && one.inverter_c > 50.0 && one.derated == 0.0, "{one:?}");
    assert!(others.iter().all(|drive| drive.machine_c == 0.0), "{others:?}");

    let mut hot = presets::BMW_I3_60AH_THERMAL;
    hot.powertrain.drives.thermal.coolant_c = 115.0;
    let params = VoltstepParams::from(&hot);
    assert_eq!(params.drives[0].thermal.coolant_c, 115.0);
    let plant = plant(&params);
    let mut state = state(&plant, 0.7);
    let (_, out) = (0..100).map(|_| step(&plant, &mut state, &inputs(10.0))).last().unwrap();
    let one = out.drives[0];
    assert!(one.inverter_c > 115.0 && one.motor_a < 399.0, "{one:?}");
    // Derated from 100 to 125 degrees C.
    assert!((one.derated - (one.inverter_c - 100.0) / 25.0).abs() < 1e-5, "{one:?}");
    let now = snapshot(&state).drives[0];
    assert_eq!(115.0 + now.inverter_above_k.value, one.inverter_c);
    assert!(now.machine_above_k.value > 0.0 && now.current_a.value > 0.0, "{now:?}");
}

/// A synchronous machine and several drives heat up, too; each alone.
#[test]
fn any_drive_may_heat_up() {
    let thermal = preset(VoltstepPreset::BmwI3Thermal).drives[0].thermal;
    let mut alone = preset(VoltstepPreset::BmwI3Pmsm);
    alone.drives[0].thermal = thermal;
    alone.drives[0].thermal.machine.derate_to_c = f32::INFINITY;
    alone.drives[0].converter.current_limit_a = 600.0;
    let mut two = preset(VoltstepPreset::TwoAxles);
    two.drives[1].thermal = thermal;
    two.drives[1].converter.current_limit_a = 600.0;
    for (params, at, other) in [(alone, 0, 1), (two, 1, 0)] {
        let plant = plant(&params);
        let mut state = state(&plant, 0.7);
        let (status, out) =
            (0..1000).map(|_| step(&plant, &mut state, &inputs(10.0))).last().unwrap();
        assert_eq!(status, Status::Ok);
        assert!(out.drives[at].machine_c > 50.0 && out.drives[at].inverter_c > 50.0, "{out:?}");
        let now = snapshot(&state).drives;
        assert!(now[at].machine_above_k.value > 0.0, "{now:?}");
        assert_eq!(now[other].machine_above_k.value, 0.0);
    }
}

/// The torque of each drive once its loop has settled.
fn torques(params: &VoltstepParams, torque_nm: f32) -> [f32; VOLTSTEP_DRIVES] {
    let driver = VoltstepDriverKind::None as u32;
    let plant = plant(&VoltstepParams { driver, ..*params });
    let mut state = state(&plant, 0.7);
    let input = VoltstepInputs { torque_nm, ..inputs(0.0) };
    let out = (0..100).map(|_| step(&plant, &mut state, &input).1).last().unwrap();
    assert!((out.motor_nm - torque_nm).abs() < 0.2, "{out:?}");
    // Gates off, as by default.
    let out = (0..20).map(|_| step(&plant, &mut state, &inputs(0.0)).1).last().unwrap();
    assert!(out.drives.iter().all(|drive| drive.motor_a == 0.0), "{out:?}");
    let input = VoltstepInputs { torque_nm, ..inputs(0.0) };
    let out = (0..100).map(|_| step(&plant, &mut state, &input).1).last().unwrap();
    out.drives.map(|drive| drive.motor_nm)
}

#[test]
fn without_a_driver_the_inputs_say_the_torque() {
    for (number, count) in [
        (VoltstepPreset::BmwI3Constant, 1),
        (VoltstepPreset::BmwI3Pmsm, 1),
        (VoltstepPreset::TwoAxles, 2),
    ] {
        let params = preset(number);
        assert_eq!(params.drive_count, count);
        let found = torques(&params, 60.0);
        // Each takes its share, at the speed that its gear makes.
        let whole: f32 = params.drives.iter().map(|drive| drive.torque_share).sum();
        for (drive, found) in params.drives.iter().zip(found).take(count as usize) {
            let ratio = params.drives[0].gearbox.ratio / drive.gearbox.ratio;
            let wanted = 60.0 * drive.torque_share / whole * ratio;
            assert!((found - wanted).abs() < 0.2, "{found} {wanted}");
        }
    }
}

#[test]
fn three_and_four_drives_share_a_torque() {
    let two = preset(VoltstepPreset::TwoAxles);
    let [rear, front, ..] = two.drives;
    for (drive_count, drives) in [(3, [rear, front, rear, front]), (4, [rear, front, rear, front])]
    {
        let params = VoltstepParams { drive_count, drives, ..two };
        let found = torques(&params, 60.0);
        assert!((found[0] - found[2]).abs() < 0.1 && found[0] > 0.0, "{found:?}");
        assert_eq!(found[3] > 0.0, drive_count == 4, "{found:?}");
    }
}

#[test]
fn a_duty_is_for_one_dc_drive_alone() {
    let off = VoltstepDriverKind::None as u32;
    let both = VoltstepInputs { duty: 0.1, torque_nm: 10.0, ..inputs(0.0) };
    let duty = VoltstepInputs { torque_nm: f32::NAN, ..both };
    for (number, alone) in [
        (VoltstepPreset::BmwI3Constant, Status::Ok),
        (VoltstepPreset::BmwI3Pmsm, Status::DutyNotTaken),
        (VoltstepPreset::TwoAxles, Status::DutyNotTaken),
    ] {
        let plant = plant(&VoltstepParams { driver: off, ..preset(number) });
        let mut state = state(&plant, 0.7);
        let was = snapshot(&state);
        assert_eq!(stepped(&plant, &mut state, &both), Status::DutyNotTaken);
        assert_eq!(snapshot(&state), was);
        assert_eq!(stepped(&plant, &mut state, &duty), alone);
    }
}

#[test]
fn a_state_belongs_to_its_kind_of_drives() {
    let (one, two) = (preset(VoltstepPreset::BmwI3Pmsm), preset(VoltstepPreset::TwoAxles));
    let (one, two) = (plant(&one), plant(&two));
    let mut of_one = state(&one, 0.7);
    assert_eq!(stepped(&two, &mut of_one, &inputs(1.0)), Status::StateOfOtherDrives);
    assert_eq!(stepped(&one, &mut of_one, &inputs(1.0)), Status::Ok);
}

#[test]
fn a_bad_drive_among_several_is_found() {
    let two = preset(VoltstepPreset::TwoAxles);
    let mut bad = two;
    bad.drives[1].motor.inductance_h = 0.0;
    assert_eq!(refusal(&bad), Status::MotorInductanceH);
    // One more is none at all.
    assert_eq!(refusal(&VoltstepParams { drive_count: 3, ..two }), Status::GearboxRatio);
    assert_eq!(refusal(&VoltstepParams { drive_count: 5, ..two }), Status::DriveCount);
}

#[test]
fn every_bad_parameter_of_a_drive_has_its_code() {
    type Change = fn(&mut VoltstepDriveParams, f32);
    let nan = f32::NAN;
    let bad: [(Change, Status); 17] = [
        (|d, nan| d.pmsm.magnet_wb = nan, Status::PmsmFluxMagnetWb),
        (|d, _| (d.pmsm.magnet_wb, d.pmsm.q_h) = (0.0, d.pmsm.d_h), Status::PmsmFluxMagnetWbRange),
        (|d, nan| d.pmsm.d_h = nan, Status::PmsmFluxDH),
        (|d, nan| d.pmsm.q_h = nan, Status::PmsmFluxQH),
        (|d, nan| d.pmsm.resistance_ohm = nan, Status::PmsmResistanceOhm),
        (|d, nan| d.pmsm.resistance_per_k = nan, Status::PmsmResistancePerK),
        (|d, _| d.pmsm.resistance_per_k = 0.1, Status::PmsmResistancePerKRange),
        (|d, _| d.pmsm.pole_pairs = 0, Status::PmsmPolePairs),
        (|d, _| d.pmsm.pole_pairs = 70_000, Status::PmsmPolePairsRange),
        (|d, nan| d.pmsm.iron_s = nan, Status::PmsmIronS),
        (|d, nan| d.pmsm.inertia_kg_m2 = nan, Status::PmsmInertia),
        (|d, nan| d.pmsm.viscous_nm_s_per_rad = nan, Status::PmsmViscous),
        (|d, nan| d.pmsm.coulomb_nm = nan, Status::PmsmCoulombNm),
        (|d, _| d.converter.voltage_drop_v = 1.0, Status::ConverterVoltageDropVRange),
        (|d, nan| d.torque_rate_per_s = nan, Status::DriveTorqueRatePerS),
        (|d, nan| d.torque_share = nan, Status::DriveTorqueShare),
        (|d, _| d.machine = 7, Status::UnknownMachine),
    ];
    for number in [VoltstepPreset::BmwI3Pmsm, VoltstepPreset::TwoAxles] {
        for (change, wanted) in bad {
            let mut params = preset(number);
            change(&mut params.drives[0], nan);
            assert_eq!(refusal(&params), wanted);
        }
    }
    // Of a DC machine too.
    for (change, wanted) in &bad[14..] {
        let mut params = preset(VoltstepPreset::BmwI3Constant);
        change(&mut params.drives[0], nan);
        assert_eq!(refusal(&params), *wanted);
    }
    let mut params = preset(VoltstepPreset::TwoAxles);
    params.driver = VoltstepDriverKind::Duty as u32;
    assert_eq!(refusal(&params), Status::DriverOfOneDc);
}

#[test]
fn every_bad_temperature_of_a_drive_has_its_code() {
    type Change = fn(&mut VoltstepDriveParams);
    let bad: [(Change, Status); 13] = [
        (|d| d.thermal.coolant_c = f32::NAN, Status::ThermalCoolantC),
        (|d| d.thermal.coolant_c = 201.0, Status::ThermalCoolantCRange),
        (|d| d.thermal.machine.heat_capacity_j_per_k = 0.0, Status::ThermalMachineHeatCapacity),
        (|d| d.thermal.machine.coolant_k_per_w = 0.0, Status::ThermalMachineCoolantKPerW),
        (|d| d.thermal.machine.derate_from_c = -300.0, Status::ThermalMachineDerateFromC),
        (|d| d.thermal.machine.derate_to_c = 0.0, Status::ThermalMachineDerateToC),
        (|d| d.thermal.inverter.heat_capacity_j_per_k = 0.0, Status::ThermalInverterHeatCapacity),
        (|d| d.thermal.inverter.coolant_k_per_w = 0.0, Status::ThermalInverterCoolantKPerW),
        (|d| d.thermal.inverter.derate_from_c = -300.0, Status::ThermalInverterDerateFromC),
        (|d| d.thermal.inverter.derate_to_c = 0.0, Status::ThermalInverterDerateToC),
        (|d| d.thermal.reference_c = f32::NAN, Status::ThermalReferenceC),
        (|d| d.thermal.per_k = -1.0, Status::ThermalPerK),
        (|d| d.converter.current_limit_a = f32::INFINITY, Status::ConverterCurrentLimitAFinite),
    ];
    for (change, wanted) in bad {
        let mut params = preset(VoltstepPreset::BmwI3Thermal);
        change(&mut params.drives[0]);
        assert_eq!(refusal(&params), wanted);
        // What does not heat up is not looked at.
        params.drives[0].thermal.heated = 0;
        assert_eq!(refusal(&params), Status::Ok, "{wanted:?}");
    }
}
