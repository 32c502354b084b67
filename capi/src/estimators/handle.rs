//! The memory of the estimators, and the checks before it is touched.

use core::mem::MaybeUninit;

use plant_core::battery::MappedBattery;
use plant_core::{Dt, ParamError};
use voltstep_bms::Health;
use voltstep_bms::estimate::cells::{CellResistances, Cells};
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombState};
use voltstep_bms::estimate::ekf::{Ekf, EkfState};
use voltstep_bms::estimate::energy::{EnergyGauge, EnergyState};
use voltstep_bms::estimate::power::{PowerLimits, PowerWalk};
use voltstep_bms::estimate::series::Series;
use voltstep_bms::estimate::soh::{
    CapacityEstimator, CapacityState, ResistanceEstimator, ResistanceState,
};

use super::params::VoltstepEstimatorParams;
use super::presets::EstimatorParams;
use crate::handle::{
    Opaque, answer, check, check_apart, fits, initialise, inside, mark, read_from, write_to,
};
use crate::status::VoltstepStatus;

/// Words (8 bytes) of a `VoltstepEstimators`.
pub const VOLTSTEP_ESTIMATORS_WORDS: usize = 704;
/// Words (8 bytes) of a `VoltstepFilterState`.
pub const VOLTSTEP_FILTER_STATE_WORDS: usize = 48;
/// Words (8 bytes) of a `VoltstepCounterState`.
pub const VOLTSTEP_COUNTER_STATE_WORDS: usize = 16;
/// Words (8 bytes) of a `VoltstepResistanceState`.
pub const VOLTSTEP_RESISTANCE_STATE_WORDS: usize = 16;
/// Words (8 bytes) of a `VoltstepCapacityState`.
pub const VOLTSTEP_CAPACITY_STATE_WORDS: usize = 12;
/// Words (8 bytes) of a `VoltstepEnergyState`.
pub const VOLTSTEP_ENERGY_STATE_WORDS: usize = 4;
/// Words (8 bytes) of a `VoltstepPowerWalk`.
pub const VOLTSTEP_POWER_WALK_WORDS: usize = 24;

/// Every estimator of a cell, checked and discretised for the time between two samples. Opaque: set
/// it up by `voltstep_estimators_init` where it stays, a copy is refused; from then on it is only
/// read, so any number of states may share it.
#[repr(C)]
pub struct VoltstepEstimators {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_ESTIMATORS_WORDS],
}

/// What the filter remembers. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepFilterState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_FILTER_STATE_WORDS],
}

/// What the coulomb counter remembers. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepCounterState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_COUNTER_STATE_WORDS],
}

/// What was learnt of the resistance. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepResistanceState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_RESISTANCE_STATE_WORDS],
}

/// What was learnt of the capacity. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepCapacityState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_CAPACITY_STATE_WORDS],
}

/// The rolling averages behind the energy left. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepEnergyState {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_ENERGY_STATE_WORDS],
}

/// How far the power limits have come. Opaque; a snapshot is a copy.
#[repr(C)]
pub struct VoltstepPowerWalk {
    /// Not for reading.
    pub opaque: [MaybeUninit<u64>; VOLTSTEP_POWER_WALK_WORDS],
}

/// A state, with the mark that tells it from any other memory.
#[repr(C)]
pub(crate) struct Marked<T> {
    mark: u32,
    pub value: T,
}

/// Which state lies in which object, by which mark.
macro_rules! states {
    ($($outside:ident: $state:ty, $kind:literal;)+) => {$(
        // SAFETY: `Marked` is `repr(C)` with its mark first; the size is checked below.
        unsafe impl Opaque for $outside {
            type Inside = Marked<$state>;
            const MARK: u32 = mark::<Marked<$state>>($kind);
            const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::StateNotInitialised;
        }
        const _: () = assert!(fits::<Marked<$state>, $outside>());
    )+};
}

states! {
    VoltstepFilterState: EkfState, 4;
    VoltstepCounterState: CoulombState, 5;
    VoltstepResistanceState: ResistanceState, 6;
    VoltstepCapacityState: CapacityState, 7;
    VoltstepEnergyState: EnergyState, 8;
    VoltstepPowerWalk: PowerWalk, 9;
}

/// What is inside a `VoltstepEstimators`.
#[repr(C)]
pub(crate) struct Estimators {
    mark: u32,
    /// Where it lies: some of the models refer to the battery in it.
    home: usize,
    battery: MappedBattery,
    models: Models<'static>,
}

// SAFETY: `Estimators` is `repr(C)` with its mark first; the size is checked on the next line.
unsafe impl Opaque for VoltstepEstimators {
    type Inside = Estimators;
    const MARK: u32 = mark::<Estimators>(3);
    const NOT_INITIALISED: VoltstepStatus = VoltstepStatus::EstimatorsNotInitialised;
}
const _: () = assert!(fits::<Estimators, VoltstepEstimators>());

/// The estimators of a battery.
pub(crate) struct Models<'b> {
    pub series: Series<'b>,
    pub cell_resistances: CellResistances,
    pub power: PowerLimits<'b>,
    pub energy: EnergyGauge<'b>,
    /// What is known of the health before anything was learnt.
    pub unlearnt: Health,
}

impl<'b> Models<'b> {
    fn new(p: &EstimatorParams, battery: &'b MappedBattery, dt: Dt) -> Result<Self, ParamError> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "held in 1..1e6 first"
        )]
        let per_second = (1.0 / dt.s() + 0.5).clamp(1.0, 1e6) as u32;
        #[expect(clippy::cast_precision_loss, reason = "at most 1e6")]
        let second = Dt::from_s(per_second as f32 * dt.s())?;
        Ok(Self {
            series: Series {
                filter: Ekf::new(p.filter, dt)?,
                counter: CoulombCounter::new(p.counter, dt)?,
                cells: Cells::new(p.cells, second)?,
                resistance: ResistanceEstimator::new(p.resistance, battery, dt)?,
                capacity: CapacityEstimator::new(p.capacity, dt)?,
                per_second,
                dt_s: dt.s(),
            },
            cell_resistances: CellResistances::new(p.cell_resistances)?,
            power: PowerLimits::new(p.power, battery)?,
            energy: EnergyGauge::new(p.energy, battery, dt)?,
            unlearnt: Health {
                capacity_ah: p.capacity.nominal_ah,
                capacity_sd_ah: p.capacity.nominal_sd_ah,
                resistance_factor: 1.0,
                resistance_factor_sd: p.resistance.initial_sd,
            },
        })
    }
}

/// The estimators inside an object, to read.
///
/// # Safety
/// As for [`shared`](crate::handle::shared).
#[inline]
pub(super) unsafe fn models<'a>(
    estimators: *const VoltstepEstimators,
) -> Result<&'a Models<'static>, VoltstepStatus> {
    // SAFETY: as promised by the caller.
    let inside = unsafe { inside(estimators) }?;
    // SAFETY: the mark says that it was initialised; an address is a number.
    let home = unsafe { (&raw const (*inside).home).read() };
    if home != estimators.addr() {
        return Err(VoltstepStatus::EstimatorsMoved);
    }
    // SAFETY: initialised, and it lies where it was, so what it refers to is its own battery;
    // nothing writes it meanwhile, by the caller's promise.
    Ok(unsafe { &(*inside).models })
}

/// Writes a state, once the estimators have made it.
///
/// # Safety
/// `state` is null, or points to memory of its type that may be written.
pub(super) unsafe fn start<S, T>(
    estimators: *const VoltstepEstimators,
    state: *mut S,
    made: Result<T, VoltstepStatus>,
) -> Result<(), VoltstepStatus>
where
    S: Opaque<Inside = Marked<T>>,
{
    let value = made?;
    check(state).and(check_apart(estimators, state))?;
    // SAFETY: checked above, writable by the caller's promise.
    unsafe { initialise(state, Marked { mark: S::MARK, value }) }
}

/// Fills `params` with one of `VoltstepCellPreset`.
///
/// # Safety
/// `params` is null, or points to memory of its type that may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_estimator_params_preset(
    preset: u32,
    params: *mut VoltstepEstimatorParams,
) -> VoltstepStatus {
    let made = super::convert::preset(preset);
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    answer(made.and_then(|made| unsafe { write_to(params, made) }))
}

/// Checks `params` and discretises them for samples every `dt_s` seconds. Writes `estimators` only
/// if they are good; a bad one is named by the code. The object has to stay where it is: a copy of
/// it is refused by `VOLTSTEP_STATUS_ESTIMATORS_MOVED`.
///
/// # Safety
/// Each pointer is null or points to an object of its type; `params` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_estimators_init(
    estimators: *mut VoltstepEstimators,
    params: *const VoltstepEstimatorParams,
    dt_s: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller.
    answer(unsafe { set_up(estimators, params, dt_s) })
}

/// # Safety
/// As for [`voltstep_estimators_init`].
unsafe fn set_up(
    estimators: *mut VoltstepEstimators,
    params: *const VoltstepEstimatorParams,
    dt_s: f32,
) -> Result<(), VoltstepStatus> {
    check(estimators)?;
    // SAFETY: as promised by the caller; null and misaligned pointers are refused inside.
    let params = unsafe { read_from(params) }?.models()?;
    let dt = Dt::from_s(dt_s)?;
    let battery = MappedBattery::new(params.filter.battery, dt)?;
    // Everything is checked before anything is written.
    Models::new(&params, &battery, dt)?;
    let inside = estimators.cast::<Estimators>();
    // SAFETY: checked above, writable by the caller's promise, and large enough (`Opaque`).
    let battery = unsafe {
        (&raw mut (*inside).mark).write(0);
        (&raw mut (*inside).battery).write(battery);
        // Read as long as the object lies there with its mark, which `models` checks.
        &(*inside).battery
    };
    let models = Models::new(&params, battery, dt)?;
    // SAFETY: as above.
    unsafe {
        (&raw mut (*inside).models).write(models);
        (&raw mut (*inside).home).write(estimators.addr());
        (&raw mut (*inside).mark).write(VoltstepEstimators::MARK);
    }
    Ok(())
}
