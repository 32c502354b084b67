//! Setting up, stepping, looking.

use plant_core::battery::CurrentLimits;
use plant_core::control::driver::{DriverInput, Steered, Steering};
use plant_core::powertrain::{Limited, PowertrainInput};
use plant_core::presets;

use crate::cars::{Car, Cars, Told, Trip, Trips, each_trip, same_kind};
use crate::handle::{
    Plant, State, VoltstepPlant, VoltstepState, answer, check, check_apart, check_optional,
    exclusive, initialise, read_from, shared, write_to,
};
use crate::params::{VOLTSTEP_DRIVES, VoltstepParams, VoltstepPreset};
use crate::status::VoltstepStatus;
use crate::values::{
    VoltstepDriveOutputs, VoltstepDriveSnapshot, VoltstepInputs, VoltstepLimited, VoltstepOutputs,
    VoltstepSnapshot,
};

/// Fills `params` with one of `VoltstepPreset`.
///
/// # Safety
/// `params` is null, or points to memory of its type that may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_params_preset(
    preset: u32,
    params: *mut VoltstepParams,
) -> VoltstepStatus {
    use VoltstepPreset as P;
    let vehicle = match preset {
        p if p == P::BmwI3Constant as u32 => VoltstepParams::from(&presets::BMW_I3_60AH_CONSTANT),
        p if p == P::BmwI3Epowertrain as u32 => (&presets::BMW_I3_60AH_EPOWERTRAIN).into(),
        p if p == P::EpowertrainUdds as u32 => (&presets::EPOWERTRAIN_UDDS).into(),
        p if p == P::EpowertrainUddsTable as u32 => (&presets::EPOWERTRAIN_UDDS_TABLE).into(),
        p if p == P::BmwI3Pmsm as u32 => (&presets::BMW_I3_60AH_PMSM).into(),
        p if p == P::TwoAxles as u32 => (&presets::TWO_AXLES).into(),
        _ => return VoltstepStatus::UnknownPreset,
    };
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe { write_to(params, vehicle) })
}

/// Checks `params` and discretises them for steps of `dt_s` seconds. Writes `plant` only if they
/// are good; a bad one is named by the code.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `params` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_plant_init(
    plant: *mut VoltstepPlant,
    params: *const VoltstepParams,
    dt_s: f32,
) -> VoltstepStatus {
    let made = check(plant)
        // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
        .and_then(|()| unsafe { read_from(params) })
        .and_then(|params| params.models(dt_s));
    answer(made.and_then(|cars| {
        // SAFETY: checked above, writable by the caller's promise.
        unsafe { initialise(plant, Plant::new(cars)) }
    }))
}

/// A rested plant with its battery at `soc` (a ratio 0..1) that rolls at `speed_m_s` (0: it stands
/// still) without current, its driver fresh.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_state_init(
    plant: *const VoltstepPlant,
    state: *mut VoltstepState,
    soc: f32,
    speed_m_s: f32,
) -> VoltstepStatus {
    // The state inside is made before anything is written, so that overlap does no harm here.
    // SAFETY: as promised by the caller; whether `plant` was initialised is checked inside.
    let made =
        unsafe { shared(plant) }.and_then(|plant| plant.cars.start(soc, speed_m_s)).map(State::new);
    answer(made.and_then(|made| {
        check(state).and(check_apart(plant, state))?;
        // SAFETY: checked above, writable by the caller's promise.
        unsafe { initialise(state, made) }
    }))
}

/// Sets `inputs` to a flat road without wind, brake and auxiliary load, reference 0, gates off.
///
/// # Safety
/// `inputs` is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_inputs_default(inputs: *mut VoltstepInputs) -> VoltstepStatus {
    let none = VoltstepInputs {
        reference_m_s: 0.0,
        reference_m_s2: 0.0,
        duty: f32::NAN,
        torque_nm: f32::NAN,
        brake_n: 0.0,
        grade_sin: 0.0,
        grade_cos: 1.0,
        headwind_m_s: 0.0,
        auxiliary_w: 0.0,
        discharge_limit_a: f32::INFINITY,
        charge_limit_a: f32::INFINITY,
    };
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe { write_to(inputs, none) })
}

/// Advances `state` by one step: the driver (if the plant has one) decides on what the last step
/// left, then the plant moves. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that an
/// input was bad; the outputs are written all the same. Any other error leaves everything as it
/// was.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `inputs` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_step(
    plant: *const VoltstepPlant,
    state: *mut VoltstepState,
    inputs: *const VoltstepInputs,
    outputs: *mut VoltstepOutputs,
) -> VoltstepStatus {
    if let Err(status) = check_optional(outputs) {
        return status;
    }
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside, and
    // the reference to the state is only made where it shares nothing with the plant.
    let (inputs, plant, state) = match unsafe {
        (
            read_from(inputs),
            shared(plant),
            check_apart(plant, state).and_then(|()| exclusive(state)),
        )
    } {
        (Ok(inputs), Ok(plant), Ok(state)) => (inputs, plant, state),
        (Err(status), ..) | (_, Err(status), _) | (.., Err(status)) => return status,
    };
    let out =
        match same_kind!(&plant.cars, &mut state.trips, |car, trip| advance(car, trip, &inputs)) {
            Ok(out) => out,
            Err(status) => return status,
        };
    let rejected = out.rejected || out.driver_rejected;
    if !outputs.is_null() {
        // SAFETY: not null, aligned (checked above), writable by the caller's promise; the
        // references to plant and state are not used any more.
        unsafe { outputs.write(out) };
    }
    if rejected { VoltstepStatus::InputRejected } else { VoltstepStatus::Ok }
}

#[inline(always)]
fn advance<D: Told, C: Steering<D>>(
    car: &Car<D, C>,
    trip: &mut Trip<D>,
    inputs: &VoltstepInputs,
) -> Result<VoltstepOutputs, VoltstepStatus> {
    let drives = car.plant.drives();
    let steered = match &car.driver {
        Some(driver) => driver.steer(
            &mut trip.driver,
            DriverInput {
                reference_m_s: inputs.reference_m_s,
                reference_m_s2: inputs.reference_m_s2,
                vehicle: trip.seen,
            },
            drives,
        ),
        None => Steered {
            command: drives.asked(inputs.duty, inputs.torque_nm)?,
            brake_n: 0.0,
            rejected: false,
        },
    };
    let mut input = PowertrainInput {
        auxiliary_w: inputs.auxiliary_w,
        limits: CurrentLimits {
            discharge_a: inputs.discharge_limit_a,
            charge_a: inputs.charge_limit_a,
        },
        ..PowertrainInput::with(steered.command)
    };
    input.road.brake_n = steered.brake_n + inputs.brake_n;
    input.road.grade.sin = inputs.grade_sin;
    input.road.grade.cos = inputs.grade_cos;
    input.road.headwind_m_s = inputs.headwind_m_s;
    let out = car.plant.step(&mut trip.plant, input);
    trip.seen = car.plant.seen_of(&out);
    let mut drives = [VoltstepDriveOutputs::NONE; VOLTSTEP_DRIVES];
    D::say(&out.drives, &mut drives.iter_mut());
    Ok(VoltstepOutputs {
        drives,
        motor_nm: trip.seen.motor_nm,
        brake_n: input.road.brake_n,
        speed_m_s: out.speed_m_s,
        distance_m: out.distance_m,
        soc: out.soc,
        battery_a: out.battery_a,
        battery_v: out.battery_v,
        open_circuit_v: out.open_circuit_v,
        limit_exceeded_a: out.limit_exceeded_a,
        overcharged_c: out.overcharged_c,
        limited: match out.limited {
            Limited::No => VoltstepLimited::No,
            Limited::Discharge => VoltstepLimited::Discharge,
            Limited::Charge => VoltstepLimited::Charge,
            Limited::Duty => VoltstepLimited::Duty,
            Limited::Current => VoltstepLimited::Current,
        } as u32,
        auxiliary_starved: out.auxiliary_starved,
        rejected: out.rejected,
        driver_rejected: steered.rejected,
    })
}

fn remembered<D: Told>(Trip { plant, seen, .. }: &Trip<D>) -> VoltstepSnapshot {
    let mut drives = [VoltstepDriveSnapshot::NONE; VOLTSTEP_DRIVES];
    D::recall(&plant.drives, &mut drives.iter_mut());
    VoltstepSnapshot {
        drives,
        speed_m_s: plant.body.speed_m_s.into(),
        distance_m: plant.body.distance_m.into(),
        soc: plant.battery.soc.into(),
        rc_v: plant.battery.rc.voltage_v.into(),
        battery_v: plant.battery_v,
        duty: seen.duty,
    }
}

/// Says every bit that the plant remembers.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_state_snapshot(
    state: *const VoltstepState,
    snapshot: *mut VoltstepSnapshot,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether `state` was initialised is checked inside.
    let seen = unsafe { shared(state) }
        .map(|State { trips, .. }| each_trip!(trips, |trip| remembered(trip)));
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(seen.and_then(|seen| unsafe { write_to(snapshot, seen) }))
}
