//! Setting up, stepping, looking.

use plant_core::Accum;
use plant_core::battery::CurrentLimits;
use plant_core::control::driver::{DriverInput, DriverOutput};
use plant_core::converter::Gates;
use plant_core::powertrain::Feedback;
use plant_core::powertrain::{Limited, PowertrainInput};
use plant_core::presets;

use crate::handle::{
    Plant, State, VoltstepPlant, VoltstepState, answer, check, check_apart, check_optional,
    exclusive, initialise, read_from, shared, write_to,
};
use crate::params::{VoltstepParams, VoltstepPreset};
use crate::status::VoltstepStatus;

/// What changed the duty, if anything.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepLimited {
    /// The duty is the commanded one; or the gates are off.
    No = 0,
    /// The discharge limit, or what is left to discharge, held it back.
    Discharge = 1,
    /// The charge limit, or what is left to charge, held it back.
    Charge = 2,
    /// The commanded duty lay beyond the converter's limit.
    Duty = 3,
    /// The converter's current limit held it back.
    Current = 4,
}

/// What drives one step. Start from `voltstep_inputs_default`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepInputs {
    /// With a driver: the speed to follow in m/s.
    pub reference_m_s: f32,
    /// With the torque driver: how fast that changes, in m/s^2; 0 where it is not known.
    pub reference_m_s2: f32,
    /// Without a driver: duty of the converter, a ratio -1..1; NaN, the default, for gates off.
    pub duty: f32,
    /// Force of the friction brake in N, beside that of the driver; zero or above.
    pub brake_n: f32,
    /// Sine of the road's angle; positive climbs.
    pub grade_sin: f32,
    /// Cosine of the road's angle; zero or above, 1 on a flat road.
    pub grade_cos: f32,
    /// Wind against the vehicle in m/s.
    pub headwind_m_s: f32,
    /// Auxiliary power beside the parameter in W; zero or above.
    pub auxiliary_w: f32,
    /// What the battery's management lets it discharge, in A; zero or above, infinity for any.
    pub discharge_limit_a: f32,
    /// What the battery's management lets it charge, in A; zero or above, infinity for any.
    pub charge_limit_a: f32,
}

/// What one step says. Discharge current, traction torque and forward speed are positive.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepOutputs {
    /// The duty applied, a ratio; with gates off +-1 while the diodes conduct, else 0.
    pub duty: f32,
    /// Force of the friction brake that was commanded, in N.
    pub brake_n: f32,
    /// Speed in m/s.
    pub speed_m_s: f32,
    /// Distance in m.
    pub distance_m: f32,
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Battery current in A.
    pub battery_a: f32,
    /// Voltage at the battery's terminals in V.
    pub battery_v: f32,
    /// The battery's open-circuit voltage over the step in V.
    pub open_circuit_v: f32,
    /// Winding current in A.
    pub motor_a: f32,
    /// Air-gap torque of the motor in N m.
    pub motor_nm: f32,
    /// Motor speed in rad/s.
    pub motor_rad_s: f32,
    /// How far the battery's current is beyond its limits all the same, in A; zero or above.
    pub limit_exceeded_a: f32,
    /// Charge of this step that went into a full battery, or, negative, out of an empty one, and is
    /// lost, in C.
    pub overcharged_c: f32,
    /// One of `VoltstepLimited`.
    pub limited: u32,
    /// Neither battery nor drive could feed the auxiliary loads: they were cut off.
    pub auxiliary_starved: bool,
    /// The plant refused the step and is as it was.
    pub rejected: bool,
    /// The driver refused its inputs and holds its last command.
    pub driver_rejected: bool,
}

/// A compensated sum: what it is, and what its last additions rounded away.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSum {
    /// The sum.
    pub value: f32,
    /// What `value` has too little, exactly, in the same unit.
    pub lost: f32,
}

/// Every bit that the plant remembers: to compare two runs bit for bit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSnapshot {
    /// Winding current in A.
    pub current_a: VoltstepSum,
    /// Speed in m/s.
    pub speed_m_s: VoltstepSum,
    /// Distance in m.
    pub distance_m: VoltstepSum,
    /// State of charge, a ratio 0..1.
    pub soc: VoltstepSum,
    /// Voltage across the battery's RC branch in V.
    pub rc_v: VoltstepSum,
    /// Voltage at the battery's terminals in V.
    pub battery_v: f32,
    /// The duty that was last applied, a ratio.
    pub duty: f32,
}

impl From<Accum> for VoltstepSum {
    fn from(sum: Accum) -> Self {
        Self { value: sum.get(), lost: sum.since(Accum::new(sum.get())) }
    }
}

/// Fills `params` with one of `VoltstepPreset`.
///
/// # Safety
/// `params` is null, or points to memory of its type that may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_params_preset(
    preset: u32,
    params: *mut VoltstepParams,
) -> VoltstepStatus {
    let vehicle = match preset {
        p if p == VoltstepPreset::BmwI3Constant as u32 => &presets::BMW_I3_60AH_CONSTANT,
        p if p == VoltstepPreset::BmwI3Epowertrain as u32 => &presets::BMW_I3_60AH_EPOWERTRAIN,
        p if p == VoltstepPreset::EpowertrainUdds as u32 => &presets::EPOWERTRAIN_UDDS,
        p if p == VoltstepPreset::EpowertrainUddsTable as u32 => &presets::EPOWERTRAIN_UDDS_TABLE,
        _ => return VoltstepStatus::UnknownPreset,
    };
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(unsafe { write_to(params, VoltstepParams::from(vehicle)) })
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
    answer(made.and_then(|(model, driver)| {
        // SAFETY: checked above, writable by the caller's promise.
        unsafe { initialise(plant, Plant::new(model, driver)) }
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
    let made = unsafe { shared(plant) }.and_then(|plant| {
        let state = plant.model.at_speed(soc, speed_m_s)?;
        Ok(State::new(state, plant.model.feedback(&state)))
    });
    answer(made.and_then(|made| {
        check(state).and(check_apart(plant, state))?;
        // SAFETY: checked above, writable by the caller's promise.
        unsafe { initialise(state, made) }
    }))
}

/// Sets `inputs` to a flat road without wind, brake and auxiliary load, reference and duty 0.
///
/// # Safety
/// `inputs` is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_inputs_default(inputs: *mut VoltstepInputs) -> VoltstepStatus {
    let none = VoltstepInputs {
        reference_m_s: 0.0,
        reference_m_s2: 0.0,
        duty: f32::NAN,
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
    let out = advance(plant, state, &inputs);
    let rejected = out.rejected || out.driver_rejected;
    if !outputs.is_null() {
        // SAFETY: not null, aligned (checked above), writable by the caller's promise; the
        // references to plant and state are not used any more.
        unsafe { outputs.write(out) };
    }
    if rejected { VoltstepStatus::InputRejected } else { VoltstepStatus::Ok }
}

#[inline(always)]
fn advance(plant: &Plant, state: &mut State, inputs: &VoltstepInputs) -> VoltstepOutputs {
    let command = match &plant.driver {
        Some(driver) => driver.step(
            &mut state.driver,
            DriverInput {
                reference_m_s: inputs.reference_m_s,
                reference_m_s2: inputs.reference_m_s2,
                vehicle: state.seen,
            },
        ),
        None => DriverOutput { duty: inputs.duty, brake_n: 0.0, rejected: false },
    };
    let off = plant.driver.is_none() && command.duty.is_nan();
    let mut input = PowertrainInput {
        gates: if off { Gates::Off } else { Gates::On(command.duty) },
        auxiliary_w: inputs.auxiliary_w,
        limits: CurrentLimits {
            discharge_a: inputs.discharge_limit_a,
            charge_a: inputs.charge_limit_a,
        },
        ..PowertrainInput::default()
    };
    input.road.brake_n = command.brake_n + inputs.brake_n;
    input.road.grade.sin = inputs.grade_sin;
    input.road.grade.cos = inputs.grade_cos;
    input.road.headwind_m_s = inputs.headwind_m_s;
    let out = plant.model.step(&mut state.plant, input);
    state.seen = Feedback::from(&out);
    VoltstepOutputs {
        duty: out.drives.duty,
        brake_n: input.road.brake_n,
        speed_m_s: out.speed_m_s,
        distance_m: out.distance_m,
        soc: out.soc,
        battery_a: out.battery_a,
        battery_v: out.battery_v,
        open_circuit_v: out.open_circuit_v,
        motor_a: out.drives.motor_a,
        motor_nm: out.drives.motor_nm,
        motor_rad_s: out.drives.motor_rad_s,
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
        driver_rejected: command.rejected,
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
    let seen = unsafe { shared(state) }.map(|State { plant, seen, .. }| VoltstepSnapshot {
        current_a: plant.drives.into(),
        speed_m_s: plant.body.speed_m_s.into(),
        distance_m: plant.body.distance_m.into(),
        soc: plant.battery.soc.into(),
        rc_v: plant.battery.rc.voltage_v.into(),
        battery_v: plant.battery_v,
        duty: seen.duty,
    });
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(seen.and_then(|seen| unsafe { write_to(snapshot, seen) }))
}
