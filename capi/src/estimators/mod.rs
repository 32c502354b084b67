//! The estimators of `voltstep-bms`: one object of parameters, a state for each of them.

mod convert;
mod counter;
mod filter;
mod handle;
mod health;
mod memory;
mod params;
mod power;
mod presets;
mod record;
mod series;
mod values;

pub use counter::*;
pub use filter::*;
pub use handle::{
    VOLTSTEP_CAPACITY_STATE_WORDS, VOLTSTEP_COUNTER_STATE_WORDS, VOLTSTEP_ENERGY_STATE_WORDS,
    VOLTSTEP_ESTIMATORS_WORDS, VOLTSTEP_FILTER_STATE_WORDS, VOLTSTEP_POWER_WALK_WORDS,
    VOLTSTEP_RESISTANCE_STATE_WORDS, VoltstepCapacityState, VoltstepCounterState,
    VoltstepEnergyState, VoltstepEstimators, VoltstepFilterState, VoltstepPowerWalk,
    VoltstepResistanceState, voltstep_estimator_params_preset, voltstep_estimators_init,
};
pub use health::*;
pub use memory::{VOLTSTEP_SERIES_WORDS, VOLTSTEP_SERIES_WORDS_PER_CELL};
pub use params::*;
pub use power::*;
pub use presets::EstimatorParams;
pub use record::{
    VOLTSTEP_RECORD_BYTES, VoltstepRecord, VoltstepStored, voltstep_record_decode,
    voltstep_record_encode, voltstep_record_newest,
};
pub use series::*;
pub use values::*;
