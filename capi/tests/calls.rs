//! The functions as C calls them: good calls agree with the models, bad ones get their code.

use std::mem::MaybeUninit;
use std::ptr::{from_mut, from_ref, null, null_mut};

use plant_core::control::driver::{Driver, DriverInput, DriverState};
use plant_core::powertrain::Feedback;
use plant_core::powertrain::{Powertrain, PowertrainInput};
use plant_core::{Dt, presets};
use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod vehicle;
use vehicle::{DT_S, inputs, plant, preset, snapshot, state, step};

#[test]
fn every_preset_steps_as_the_models_do() {
    for (number, vehicle) in [
        (VoltstepPreset::BmwI3Constant, &presets::BMW_I3_60AH_CONSTANT),
        (VoltstepPreset::BmwI3Epowertrain, &presets::BMW_I3_60AH_EPOWERTRAIN),
        (VoltstepPreset::EpowertrainUdds, &presets::EPOWERTRAIN_UDDS),
        (VoltstepPreset::EpowertrainUddsTable, &presets::EPOWERTRAIN_UDDS_TABLE),
    ] {
        let dt = Dt::from_s(DT_S).unwrap();
        let model = Powertrain::new(vehicle.powertrain, dt).unwrap();
        let driver = Driver::new(vehicle.driver, &vehicle.powertrain, dt).unwrap();
        let mut model_state = model.at_rest(vehicle.initial_soc).unwrap();
        let (mut driver_state, mut seen) = (DriverState::default(), model.feedback(&model_state));

        let params = preset(number);
        let plant = plant(&params);
        let mut state = state(&plant, params.initial_soc);
        for n in 0..400_u16 {
            let reference_m_s = f32::from(n) * 0.01;
            let driven = DriverInput { reference_m_s, reference_m_s2: 0.0, vehicle: seen };
            let command = driver.step(&mut driver_state, driven);
            let mut input = PowertrainInput::on(command.duty);
            input.road.brake_n = command.brake_n;
            let wanted = model.step(&mut model_state, input);
            seen = Feedback::from(&wanted);
            let (status, out) = step(&plant, &mut state, &inputs(reference_m_s));
            assert_eq!(status, Status::Ok);
            assert_eq!(
                [out.drives[0].duty, out.brake_n, out.speed_m_s, out.soc, out.battery_a],
                [
                    wanted.drives.duty,
                    command.brake_n,
                    wanted.speed_m_s,
                    wanted.soc,
                    wanted.battery_a
                ]
            );
        }
        let now = snapshot(&state);
        assert_eq!(now.soc.value.to_bits(), model_state.battery.soc.get().to_bits());
        assert!(now.distance_m.value > 0.0);
    }
}

#[test]
fn without_a_driver_the_inputs_say_the_duty() {
    let driver = VoltstepDriverKind::None as u32;
    let plant = plant(&VoltstepParams { driver, ..preset(VoltstepPreset::BmwI3Constant) });
    let mut state = state(&plant, 0.8);
    let input = VoltstepInputs { duty: 0.01, ..inputs(0.0) };
    let out = (0..100).map(|_| step(&plant, &mut state, &input).1).last().unwrap();
    assert!(out.drives[0].duty == 0.01 && out.speed_m_s > 0.0, "{out:?}");
    // By default the gates are off.
    let (_, off) = step(&plant, &mut state, &inputs(0.0));
    assert!(off.drives[0].motor_a == 0.0 && off.drives[0].duty == 0.0 && !off.rejected, "{off:?}");
    let limited = VoltstepInputs { discharge_limit_a: 2.5, ..input };
    let out = (0..100).map(|_| step(&plant, &mut state, &limited).1).last().unwrap();
    assert!((out.battery_a - 2.5).abs() < 0.03 && out.limited == 1, "{out:?}");
}

#[test]
fn a_table_and_a_coast_down_are_taken() {
    let mut params = preset(VoltstepPreset::BmwI3Constant);
    params.battery.open_circuit = VoltstepOpenCircuit::Table as u32;
    for (i, v) in (0_u16..).zip(&mut params.battery.table_v) {
        *v = 343.22 + (399.8 - 343.22) * f32::from(i) / 64.0;
    }
    params.body.road_law = VoltstepRoadLaw::CoastDown as u32;
    (params.body.a_n, params.body.b_n_s_per_m, params.body.c_n_s2_per_m2) = (150.0, 1.0, 0.4);
    let plant = plant(&params);
    let (status, out) = step(&plant, &mut state(&plant, 0.5), &inputs(1.0));
    assert!(status == Status::Ok && (out.open_circuit_v - 371.51).abs() < 0.01, "{out:?}");
}

#[test]
fn null_pointers_are_refused() {
    let params = preset(VoltstepPreset::BmwI3Constant);
    let (mut plant, input) = (plant(&params), inputs(1.0));
    let mut state = state(&plant, 0.8);
    let (plant, state) = (from_mut(&mut plant), from_mut(&mut state));
    // SAFETY: null is allowed everywhere; the others come from references.
    unsafe {
        for status in [
            voltstep_params_preset(0, null_mut()),
            voltstep_inputs_default(null_mut()),
            voltstep_plant_init(null_mut(), &raw const params, DT_S),
            voltstep_plant_init(plant, null(), DT_S),
            voltstep_state_init(null(), state, 0.8, 0.0),
            voltstep_state_init(plant, null_mut(), 0.8, 0.0),
            voltstep_step(null(), state, &raw const input, null_mut()),
            voltstep_step(plant, null_mut(), &raw const input, null_mut()),
            voltstep_step(plant, state, null(), null_mut()),
            voltstep_state_snapshot(null(), null_mut()),
            voltstep_state_snapshot(state, null_mut()),
        ] {
            assert_eq!(status, Status::NullPointer);
        }
        // Outputs may be null.
        assert_eq!(voltstep_step(plant, state, &raw const input, null_mut()), Status::Ok);
    }
}

/// The same pointer, one byte on.
fn off<T>(pointer: *mut T) -> *mut T {
    pointer.wrapping_byte_add(1)
}

#[test]
fn misaligned_pointers_are_refused() {
    let mut params = preset(VoltstepPreset::BmwI3Constant);
    let (mut plant, mut input) = (plant(&params), inputs(1.0));
    let mut state = state(&plant, 0.8);
    let (params, plant, state, input) =
        (from_mut(&mut params), from_mut(&mut plant), from_mut(&mut state), from_mut(&mut input));
    let mut outputs = MaybeUninit::<VoltstepOutputs>::uninit();
    let mut snapshot = MaybeUninit::<VoltstepSnapshot>::uninit();
    // SAFETY: misaligned pointers are refused before they are used; the others are good.
    unsafe {
        for status in [
            voltstep_params_preset(0, off(params)),
            voltstep_inputs_default(off(input)),
            voltstep_plant_init(off(plant), params, DT_S),
            voltstep_plant_init(plant, off(params), DT_S),
            voltstep_state_init(off(plant), state, 0.8, 0.0),
            voltstep_state_init(plant, off(state), 0.8, 0.0),
            voltstep_step(off(plant), state, input, null_mut()),
            voltstep_step(plant, off(state), input, null_mut()),
            voltstep_step(plant, state, off(input), null_mut()),
            voltstep_step(plant, state, input, off(outputs.as_mut_ptr())),
            voltstep_state_snapshot(off(state), snapshot.as_mut_ptr()),
            voltstep_state_snapshot(state, off(snapshot.as_mut_ptr())),
        ] {
            assert_eq!(status, Status::Misaligned);
        }
    }
}

#[test]
fn objects_that_were_not_initialised_or_overlap_are_refused() {
    let params = preset(VoltstepPreset::BmwI3Constant);
    let mut good = plant(&params);
    let mut fresh_plant = VoltstepPlant { opaque: [MaybeUninit::zeroed(); VOLTSTEP_PLANT_WORDS] };
    let mut fresh_state = VoltstepState { opaque: [MaybeUninit::zeroed(); VOLTSTEP_STATE_WORDS] };
    let mut started = state(&good, 0.8);
    let input = inputs(1.0);
    let step = |plant, state| {
        // SAFETY: every pointer comes from a reference.
        unsafe { voltstep_step(plant, state, &raw const input, null_mut()) }
    };
    assert_eq!(step(from_ref(&fresh_plant), &raw mut started), Status::PlantNotInitialised);
    assert_eq!(step(from_ref(&good), &raw mut fresh_state), Status::StateNotInitialised);
    let plant = from_mut(&mut good);
    assert_eq!(step(plant, plant.cast()), Status::Overlap);
    assert_eq!(step(plant, plant.wrapping_byte_add(64).cast()), Status::Overlap);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        assert_eq!(voltstep_state_init(plant, plant.cast(), 0.8, 0.0), Status::Overlap);
        // Refused parameters leave a plant as it was.
        let bad = VoltstepParams { abi: 0, ..params };
        let status = voltstep_plant_init(&raw mut fresh_plant, &raw const bad, DT_S);
        assert_eq!((status, fresh_plant.opaque[0].assume_init()), (Status::AbiMismatch, 0));
    }
}

#[test]
fn bad_inputs_change_nothing() {
    let plant = plant(&preset(VoltstepPreset::EpowertrainUdds));
    let mut state = state(&plant, 0.8);
    for _ in 0..50 {
        step(&plant, &mut state, &inputs(1.0));
    }
    let was = snapshot(&state);
    for bad in [f32::NAN, f32::INFINITY, 1e38] {
        let input = VoltstepInputs { headwind_m_s: bad, ..inputs(1.0) };
        let (status, out) = step(&plant, &mut state, &input);
        assert!(status == Status::InputRejected && out.rejected, "{out:?}");
        let now = snapshot(&state);
        assert_eq!((now.soc, now.drives, now.rc_v), (was.soc, was.drives, was.rc_v));
        assert_eq!((now.speed_m_s, now.distance_m), (was.speed_m_s, was.distance_m));
    }
    let (status, out) = step(&plant, &mut state, &inputs(f32::NAN));
    assert!(status == Status::InputRejected && out.driver_rejected);
}

#[test]
fn every_bad_parameter_has_a_code_of_its_own() {
    let mut seen = Vec::new();
    let mut refused = |params: VoltstepParams, dt_s: f32| {
        let mut plant = VoltstepPlant { opaque: [MaybeUninit::zeroed(); VOLTSTEP_PLANT_WORDS] };
        // SAFETY: both are references.
        let status = unsafe { voltstep_plant_init(&raw mut plant, &raw const params, dt_s) } as u32;
        assert!(status > 19 && status != Status::Parameter as u32, "{status}");
        assert!(!seen.contains(&status), "{status} twice");
        seen.push(status);
    };
    /// Refuses a vehicle with each of these fields not a number.
    macro_rules! each_nan {
        ($from:ident: $($group:ident { $($field:ident)+ })+) => {
            $($({ let mut bad = $from; bad.$group.$field = f32::NAN; refused(bad, DT_S); })+)+
        };
        ($from:ident, drives: $($group:ident { $($field:ident)+ })+) => {
            $($({
                let mut bad = $from;
                bad.drives[0].$group.$field = f32::NAN;
                refused(bad, DT_S);
            })+)+
        };
    }
    let linear = preset(VoltstepPreset::BmwI3Constant);
    each_nan!(linear:
        battery {
            capacity_ah series_resistance_ohm polarisation_resistance_ohm
            polarisation_capacitance_f discharge_limit_a charge_limit_a empty_v full_v
        }
        auxiliary { power_w resistance_ohm cut_out_v }
        wheel { radius_m inertia_kg_m2 viscous_nm_s_per_rad }
        body {
            mass_kg drag_coefficient frontal_area_m2 air_density_kg_m3 rolling_coefficient
        }
        pid {
            proportional integral_per_s derivative_s derivative_filter_s dead_zone output_min
            output_max smoothing_per_s
        }
        torque {
            peak_torque_nm peak_power_w regen_torque_nm regen_power_w regen_fade_m_s
            regen_fade_soc brake_limit_n current_rate_per_s
        }
    );
    each_nan!(linear, drives:
        converter { duty_limit constant_loss_w voltage_drop_v resistance_ohm current_limit_a }
        motor {
            resistance_ohm inductance_h back_emf_v_s_per_rad torque_nm_per_a inertia_kg_m2
            viscous_nm_s_per_rad coulomb_nm
        }
        gearbox { ratio efficiency inertia_kg_m2 }
    );
    let mut coasting = linear;
    coasting.body.road_law = VoltstepRoadLaw::CoastDown as u32;
    each_nan!(coasting: body { a_n b_n_s_per_m c_n_s2_per_m2 });

    // Refuses a vehicle changed in one way.
    let mut changed = |change: fn(&mut VoltstepParams)| {
        let mut bad = linear;
        change(&mut bad);
        refused(bad, DT_S);
    };
    changed(|p| p.battery.model = 7);
    changed(|p| p.battery.open_circuit = 7);
    changed(|p| p.body.road_law = 7);
    changed(|p| p.driver = 7);
    changed(|p| p.pid.anti_windup = 7);
    changed(|p| p.drive_count = 0);
    changed(|p| {
        (p.drive_count, p.drives[1]) = (2, p.drives[0]);
        p.driver = VoltstepDriverKind::Duty as u32;
    });
    changed(|p| p.battery.full_v = p.battery.empty_v - 1.0);
    changed(|p| {
        p.battery.open_circuit = VoltstepOpenCircuit::Table as u32;
        p.battery.table_v = [f32::NAN; VOLTSTEP_SOC_POINTS];
    });
    changed(|p| {
        p.battery.open_circuit = VoltstepOpenCircuit::Table as u32;
        p.battery.table_v = [350.0; VOLTSTEP_SOC_POINTS];
        p.battery.table_v[64] = 349.0;
    });
    refused(linear, 0.0);

    let plant = plant(&linear);
    let mut state = state(&plant, 0.5);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let mut init =
            |soc, speed| voltstep_state_init(&raw const plant, &raw mut state, soc, speed);
        assert_eq!((init(1.5, 0.0), init(0.5, f32::NAN)), (Status::Soc, Status::SpeedMS));
        let mut params = linear;
        assert_eq!(voltstep_params_preset(99, &raw mut params), Status::UnknownPreset);
    }
}
