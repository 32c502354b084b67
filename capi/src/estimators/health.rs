//! State of health: resistance and capacity.

use voltstep_bms::estimate::soh::{CapacityInput, ResistanceInput};

use super::handle::{
    VoltstepCapacityState, VoltstepEstimators, VoltstepResistanceState, models, start,
};
use super::values::{VoltstepEstimate, VoltstepHealth};
use crate::handle::{
    answer, check_apart, check_optional, exclusive, read_from, write_optional, write_to,
};
use crate::status::VoltstepStatus;

/// What was learnt of the resistance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepResistanceOutputs {
    /// The resistances are larger by this factor.
    pub factor: f32,
    /// Its standard deviation.
    pub factor_sd: f32,
    /// This sample changed it.
    pub learned: bool,
    /// The factor lies at the end of what is believed: the readings are out of step, or not of this
    /// cell.
    pub at_bound: bool,
    /// The input was not finite or absurd; the factor is unchanged.
    pub rejected: bool,
}

/// Two instants whose state of charge is known from their voltage, and what flowed between them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCapacityInput {
    /// What was believed at the first.
    pub start: VoltstepEstimate,
    /// What was believed at the second.
    pub end: VoltstepEstimate,
    /// Charge discharged from the first to the second in A h, negative when charged.
    pub discharged_ah: f32,
    /// Time from the first to the second in s; zero or above.
    pub duration_s: f32,
}

/// What was learnt of the capacity.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepCapacityOutputs {
    /// Charge between state of charge 0 and 1, in A h.
    pub capacity_ah: f32,
    /// Its standard deviation in A h.
    pub capacity_sd_ah: f32,
    /// This pair changed it.
    pub learned: bool,
    /// The last pair contradicts what was known; the standard deviation reaches to it.
    pub contradicted: bool,
    /// The input was not finite or absurd; nothing changed.
    pub rejected: bool,
}

/// Sets `health` to what the parameters say before anything was learnt.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_health_unlearnt(
    estimators: *const VoltstepEstimators,
    health: *mut VoltstepHealth,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe { models(estimators).and_then(|m| write_to(health, m.unlearnt.into())) })
}

/// Starts the resistance from what is known of the health; what of it is not finite or out of range
/// is not taken.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `health` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_resistance_start(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepResistanceState,
    health: *const VoltstepHealth,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let known = read_from(health)?;
            let made =
                m.series.resistance.known(known.resistance_factor, known.resistance_factor_sd);
            start(estimators, state, Ok(made))
        })
    })
}

/// Looks at one sample: voltage in V, current in A, positive when discharging, what is believed to
/// be in the cell. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that an input was
/// not finite or absurd; the factor is unchanged, the outputs are written all the same.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `estimate` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_resistance_step(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepResistanceState,
    voltage_v: f32,
    current_a: f32,
    estimate: *const VoltstepEstimate,
    outputs: *mut VoltstepResistanceOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs)?;
            check_apart(estimators, state)?;
            let estimate = read_from(estimate)?.into();
            let input = ResistanceInput { voltage_v, current_a, estimate };
            let out = m.series.resistance.step(&mut exclusive(state)?.value, input);
            let said = VoltstepResistanceOutputs {
                factor: out.factor,
                factor_sd: out.factor_sd,
                learned: out.learned,
                at_bound: out.at_bound,
                rejected: out.rejected,
            };
            write_optional(outputs, said)?;
            if out.rejected { Err(VoltstepStatus::InputRejected) } else { Ok(()) }
        })
    })
}

/// Starts the capacity from what is known of the health; what of it is not finite or out of range is
/// not taken.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `health` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_capacity_start(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCapacityState,
    health: *const VoltstepHealth,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let known = read_from(health)?;
            let made = m.series.capacity.known(known.capacity_ah, known.capacity_sd_ah);
            start(estimators, state, Ok(made))
        })
    })
}

/// Looks at one pair of instants. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that
/// an input was not finite or absurd; nothing changed, the outputs are written all the same.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `input` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_capacity_step(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepCapacityState,
    input: *const VoltstepCapacityInput,
    outputs: *mut VoltstepCapacityOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs)?;
            check_apart(estimators, state)?;
            let pair = read_from(input)?;
            let input = CapacityInput {
                start: pair.start.into(),
                end: pair.end.into(),
                discharged_ah: pair.discharged_ah,
                duration_s: pair.duration_s,
            };
            let out = m.series.capacity.step(&mut exclusive(state)?.value, input);
            let said = VoltstepCapacityOutputs {
                capacity_ah: out.capacity_ah,
                capacity_sd_ah: out.capacity_sd_ah,
                learned: out.learned,
                contradicted: out.contradicted,
                rejected: out.rejected,
            };
            write_optional(outputs, said)?;
            if out.rejected { Err(VoltstepStatus::InputRejected) } else { Ok(()) }
        })
    })
}
