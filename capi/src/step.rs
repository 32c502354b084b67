//! Setting up, stepping, looking.

use core::mem::MaybeUninit;

use plant_core::battery::CurrentLimits;
use plant_core::control::driver::{DriverInput, Steered, Steering};
use plant_core::powertrain::{Limited, PowertrainInput, PowertrainOutput};
use plant_core::presets;

use crate::cars::{Car, Cars, DrivePlaces, Told, Trip, Trips, each_trip, same_kind};
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
        #[cfg(feature = "pmsm")]
        p if p == P::BmwI3Pmsm as u32 => (&presets::BMW_I3_60AH_PMSM).into(),
        #[cfg(all(feature = "drives", feature = "pmsm"))]
        p if p == P::TwoAxles as u32 => (&presets::TWO_AXLES).into(),
        #[cfg(feature = "thermal")]
        p if p == P::BmwI3Thermal as u32 => (&presets::BMW_I3_60AH_THERMAL).into(),
        p if [P::BmwI3Pmsm, P::TwoAxles, P::BmwI3Thermal].iter().any(|it| p == *it as u32) => {
            return VoltstepStatus::NotBuiltIn;
        }
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
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside, and
    // the reference to the state is only made where it shares nothing with the plant.
    let (plant, state) = match unsafe {
        check_optional(outputs).and(check(inputs)).and_then(|()| {
            Ok((shared(plant)?, check_apart(plant, state).and_then(|()| exclusive(state))?))
        })
    } {
        Ok(both) => both,
        Err(status) => return status,
    };
    // SAFETY: checked above, set and nobody else's by the caller's promise.
    unsafe {
        same_kind!(&plant.cars, &mut state.trips, |car, trip| advance(car, trip, inputs, outputs))
    }
}

/// One step of one kind of plant, each in a function of its own: in one together they would pass
/// through memory what each alone keeps in registers. The outputs are written where they belong.
///
/// # Safety
/// Car and trip may be used as references while none of the others is, `inputs` may be read, and
/// `outputs` is null or may be written.
#[inline(never)]
unsafe fn advance<D: Told, C: Steering<D>>(
    car: *const Car<D, C>,
    trip: *mut Trip<D>,
    inputs: *const VoltstepInputs,
    outputs: *mut VoltstepOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller. The inputs are read before anything is written, and the
    // references are not used any more when the outputs are, so overlap does no harm.
    let (inputs, car, trip) = unsafe { (inputs.read(), &*car, &mut *trip) };
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
        None => match drives.asked(inputs.duty, inputs.torque_nm) {
            Ok(command) => Steered { command, brake_n: 0.0, rejected: false },
            Err(status) => return status,
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
    let seen = car.plant.seen_of(&out);
    trip.seen = seen;
    if !outputs.is_null() {
        // SAFETY: not null, and as promised by the caller.
        unsafe {
            say::<D>(outputs, &out);
            (*outputs).motor_nm = seen.motor_nm;
            (*outputs).brake_n = input.road.brake_n;
            (*outputs).driver_rejected = steered.rejected;
        }
    }
    if out.rejected || steered.rejected {
        VoltstepStatus::InputRejected
    } else {
        VoltstepStatus::Ok
    }
}

/// What the plant said of a step, field by field into the caller's memory: a struct in between would
/// be copied.
///
/// # Safety
/// `outputs` may be written, whatever is there.
#[inline(always)]
unsafe fn say<D: Told>(outputs: *mut VoltstepOutputs, out: &PowertrainOutput<D::Output>) {
    // SAFETY: as promised by the caller; nothing is read, and nothing there needs dropping.
    unsafe {
        let mut places = (*(&raw mut (*outputs).drives).cast::<DrivePlaces>()).iter_mut();
        D::say(&out.drives, &mut places);
        for place in places {
            clear(place);
        }
        (*outputs).speed_m_s = out.speed_m_s;
        (*outputs).distance_m = out.distance_m;
        (*outputs).soc = out.soc;
        (*outputs).battery_a = out.battery_a;
        (*outputs).battery_v = out.battery_v;
        (*outputs).open_circuit_v = out.open_circuit_v;
        (*outputs).limit_exceeded_a = out.limit_exceeded_a;
        (*outputs).overcharged_c = out.overcharged_c;
        (*outputs).limited = match out.limited {
            Limited::No => VoltstepLimited::No,
            Limited::Discharge => VoltstepLimited::Discharge,
            Limited::Charge => VoltstepLimited::Charge,
            Limited::Duty => VoltstepLimited::Duty,
            Limited::Current => VoltstepLimited::Current,
        } as u32;
        (*outputs).auxiliary_starved = out.auxiliary_starved;
        (*outputs).rejected = out.rejected;
    }
}

/// Writes `VoltstepDriveOutputs::NONE`, word by word: left to itself the compiler calls a function for
/// the three drives that most plants lack, which takes twice the instructions.
#[inline(always)]
fn clear(place: &mut MaybeUninit<VoltstepDriveOutputs>) {
    const WORDS: usize = size_of::<VoltstepDriveOutputs>() / 4;
    let words: *mut u32 = place.as_mut_ptr().cast();
    for word in 0..WORDS {
        // SAFETY: within the place, which is that large and aligned for words.
        unsafe { words.add(word).write_volatile(0) };
    }
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
