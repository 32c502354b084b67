//! One of everything that a call takes, started and good.

#![allow(clippy::cast_possible_truncation)] // a few words

use std::mem::MaybeUninit;

use super::{known, preset, set_up, words};
use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

/// One of everything that a call takes.
pub struct All {
    pub e: Box<VoltstepEstimators>,
    pub params: VoltstepEstimatorParams,
    pub filter: VoltstepFilterState,
    pub counter: VoltstepCounterState,
    pub resistance: VoltstepResistanceState,
    pub capacity: VoltstepCapacityState,
    pub energy: VoltstepEnergyState,
    pub walk: VoltstepPowerWalk,
    pub pack: Vec<MaybeUninit<u64>>,
    pub cell_v: [f32; 4],
    pub sample: VoltstepFilterInput,
    pub series_sample: VoltstepSeriesInput,
    pub estimate: VoltstepEstimate,
    pub health: VoltstepHealth,
    pub pair: VoltstepCapacityInput,
    pub limits: [VoltstepPowerAhead; VOLTSTEP_HORIZONS],
    pub record: VoltstepRecord,
    pub bytes: [u8; VOLTSTEP_RECORD_BYTES],
    pub stored: VoltstepStored,
    pub report: VoltstepEnergyReport,
    pub cell: VoltstepSeriesCell,
    pub filter_out: VoltstepFilterOutputs,
    pub counter_out: VoltstepCounterOutputs,
    pub resistance_out: VoltstepResistanceOutputs,
    pub capacity_out: VoltstepCapacityOutputs,
    pub series_out: VoltstepSeriesOutputs,
    pub done: bool,
    pub sequence: u32,
}

pub fn all() -> Box<All> {
    macro_rules! zeroed {
        () => {
            // SAFETY: zeros are a value of every plain struct of the interface.
            unsafe { MaybeUninit::zeroed().assume_init() }
        };
    }
    let mut all = Box::new(All {
        e: set_up(),
        params: preset(),
        filter: zeroed!(),
        counter: zeroed!(),
        resistance: zeroed!(),
        capacity: zeroed!(),
        energy: zeroed!(),
        walk: zeroed!(),
        pack: words(4),
        cell_v: [3.8; 4],
        sample: VoltstepFilterInput {
            current_a: 1.0,
            voltage_v: 3.8,
            temperature_c: 25.0,
            contactors_open: 0,
        },
        series_sample: VoltstepSeriesInput {
            current_a: 1.0,
            temperature_c: 25.0,
            contactors_open: 0,
        },
        estimate: zeroed!(),
        health: zeroed!(),
        pair: zeroed!(),
        limits: zeroed!(),
        record: known(),
        bytes: [0; VOLTSTEP_RECORD_BYTES],
        stored: zeroed!(),
        report: zeroed!(),
        cell: zeroed!(),
        filter_out: zeroed!(),
        counter_out: zeroed!(),
        resistance_out: zeroed!(),
        capacity_out: zeroed!(),
        series_out: zeroed!(),
        done: false,
        sequence: 0,
    });
    let pack_words = all.pack.len() as u32;
    let a = &mut *all;
    let e = &raw const *a.e;
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let (health, record) = (&raw mut a.health, &raw mut a.record);
        for status in [
            voltstep_health_unlearnt(e, health),
            voltstep_filter_start(e, &raw mut a.filter, 0.7, 0.1, 25.0),
            voltstep_counter_start(e, &raw mut a.counter, 0.7, 0.1),
            voltstep_resistance_start(e, &raw mut a.resistance, health),
            voltstep_capacity_start(e, &raw mut a.capacity, health),
            voltstep_energy_start(e, &raw mut a.energy),
            voltstep_power_walk_start(e, &raw mut a.walk),
            voltstep_series_start(e, a.pack.as_mut_ptr(), pack_words, 4, record, 0.0, 25.0),
            voltstep_record_encode(record, 3, a.bytes.as_mut_ptr()),
        ] {
            assert_eq!(status, Status::Ok);
        }
    }
    a.estimate.soc = 0.7;
    all
}
