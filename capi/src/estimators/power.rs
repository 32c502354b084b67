//! State of power, and the energy left.

use voltstep_bms::estimate::energy::{EnergyInput, EnergyReport, EnergyState};
use voltstep_bms::estimate::power::PowerWalk;

use super::handle::{VoltstepEnergyState, VoltstepEstimators, VoltstepPowerWalk, models, start};
use super::params::VOLTSTEP_HORIZONS;
use super::values::{VoltstepEstimate, VoltstepHealth, VoltstepPowerAhead};
use crate::handle::{answer, check, check_apart, exclusive, read_from, shared, write_to};
use crate::status::VoltstepStatus;

/// What is left until empty, at the average power of the last minute where it is discharged, else at
/// that of a five-hour discharge.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepEnergyReport {
    /// Charge left in A h.
    pub remaining_capacity_ah: f32,
    /// Energy left at the terminals in W h.
    pub remaining_energy_wh: f32,
    /// Its standard deviation in W h.
    pub remaining_energy_sd_wh: f32,
    /// Charge from full until empty in A h.
    pub full_charge_capacity_ah: f32,
    /// Energy from full until empty in W h.
    pub full_charge_energy_wh: f32,
    /// Remaining over full-charge capacity, a ratio 0..1.
    pub relative_state_of_charge: f32,
    /// Remaining capacity over that of the cell when new, a ratio that may exceed 1.
    pub absolute_state_of_charge: f32,
    /// Remaining over full-charge energy, a ratio 0..1.
    pub state_of_energy: f32,
    /// Time until empty in s; NaN where it is not discharged.
    pub average_time_to_empty_s: f32,
    /// Time until full in s; NaN where it is not charged.
    pub average_time_to_full_s: f32,
}

#[cfg(feature = "bms")]
impl VoltstepEnergyReport {
    /// Not worked out yet.
    pub(crate) const UNKNOWN: Self = Self {
        remaining_capacity_ah: f32::NAN,
        remaining_energy_wh: f32::NAN,
        remaining_energy_sd_wh: f32::NAN,
        full_charge_capacity_ah: f32::NAN,
        full_charge_energy_wh: f32::NAN,
        relative_state_of_charge: f32::NAN,
        absolute_state_of_charge: f32::NAN,
        state_of_energy: f32::NAN,
        average_time_to_empty_s: f32::NAN,
        average_time_to_full_s: f32::NAN,
    };
}

impl From<EnergyReport> for VoltstepEnergyReport {
    fn from(r: EnergyReport) -> Self {
        Self {
            remaining_capacity_ah: r.remaining_capacity_ah,
            remaining_energy_wh: r.remaining_energy_wh,
            remaining_energy_sd_wh: r.remaining_energy_sd_wh,
            full_charge_capacity_ah: r.full_charge_capacity_ah,
            full_charge_energy_wh: r.full_charge_energy_wh,
            relative_state_of_charge: r.relative_state_of_charge,
            absolute_state_of_charge: r.absolute_state_of_charge,
            state_of_energy: r.state_of_energy,
            average_time_to_empty_s: r.average_time_to_empty_s.unwrap_or(f32::NAN),
            average_time_to_full_s: r.average_time_to_full_s.unwrap_or(f32::NAN),
        }
    }
}

/// What may be drawn and charged from now on: fills `limits`, an array of `VOLTSTEP_HORIZONS`, for
/// each length of time. Without a finite estimate, nothing. A matter for once a second:
/// `voltstep_power_walk` does the same in six shorter calls.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `estimate` and `health` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_power_ahead(
    estimators: *const VoltstepEstimators,
    estimate: *const VoltstepEstimate,
    health: *const VoltstepHealth,
    limits: *mut VoltstepPowerAhead,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check(limits)?;
            let (estimate, health) = (read_from(estimate)?.into(), read_from(health)?.into());
            write_to(
                limits.cast::<[VoltstepPowerAhead; VOLTSTEP_HORIZONS]>(),
                m.power.ahead(&estimate, &health).map(Into::into),
            )
        })
    })
}

/// Begins to work out the power limits.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_power_walk_start(
    estimators: *const VoltstepEstimators,
    walk: *mut VoltstepPowerWalk,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|_| start(estimators, walk, Ok(PowerWalk::START)))
    })
}

/// One length of time and direction at a time. The last of six calls fills `limits`, an array of
/// `VOLTSTEP_HORIZONS`, and sets `done`; the next one begins again.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call;
/// `estimate` and `health` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_power_walk(
    estimators: *const VoltstepEstimators,
    walk: *mut VoltstepPowerWalk,
    estimate: *const VoltstepEstimate,
    health: *const VoltstepHealth,
    limits: *mut VoltstepPowerAhead,
    done: *mut bool,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check(limits).and(check(done))?;
            check_apart(estimators, walk)?;
            let (estimate, health) = (read_from(estimate)?.into(), read_from(health)?.into());
            let found = m.power.walk(&mut exclusive(walk)?.value, &estimate, &health);
            write_to(done, found.is_some())?;
            match found {
                Some(found) => write_to(
                    limits.cast::<[VoltstepPowerAhead; VOLTSTEP_HORIZONS]>(),
                    found.map(Into::into),
                ),
                None => Ok(()),
            }
        })
    })
}

/// Starts the averages behind the energy left, at rest.
///
/// # Safety
/// Each pointer is null or points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_energy_start(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepEnergyState,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|_| start(estimators, state, Ok(EnergyState::default())))
    })
}

/// Averages one sample: current in A, positive when discharging, voltage in V.
/// `VOLTSTEP_STATUS_INPUT_REJECTED` says that one was not finite or absurd, and was left out.
///
/// # Safety
/// Each pointer is null or points to an object of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_energy_step(
    estimators: *const VoltstepEstimators,
    state: *mut VoltstepEnergyState,
    current_a: f32,
    voltage_v: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_apart(estimators, state)?;
            let input = EnergyInput { current_a, voltage_v };
            let sound = m.energy.step(&mut exclusive(state)?.value, input);
            if sound { Ok(()) } else { Err(VoltstepStatus::InputRejected) }
        })
    })
}

/// Says what is left, about once a second. `VOLTSTEP_STATUS_INPUT_REJECTED` says that the estimate
/// or the health was not finite or absurd; the report is not written then.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `estimate` and `health` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_energy_report(
    estimators: *const VoltstepEstimators,
    state: *const VoltstepEnergyState,
    estimate: *const VoltstepEstimate,
    health: *const VoltstepHealth,
    report: *mut VoltstepEnergyReport,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let (estimate, health) = (read_from(estimate)?.into(), read_from(health)?.into());
            check(report)?;
            match m.energy.report(&shared(state)?.value, &estimate, &health) {
                Some(found) => write_to(report, found.into()),
                None => Err(VoltstepStatus::InputRejected),
            }
        })
    })
}
