//! Tests and trips as one kind of series: current, voltage, state of charge, temperature.

use super::layout::{Layout, Place, place};
use crate::read::cell::{self, CellRecord, Kind};
use crate::read::trip::Trip;

/// Samples further apart than this, and than [`GAP_SAMPLINGS`] usual steps, are a gap: the battery
/// is taken as rested after it \[s\].
const GAP_S: f64 = 60.0;
const GAP_SAMPLINGS: f64 = 3.0;
/// A sample stands for the time since the one before, but for no more than this \[s\].
const LONGEST_WEIGHT_S: f64 = 10.0;
/// Below this state of charge only a slow sweep counts: a cell's resistance rises there as no
/// one activation temperature describes, and would spoil the rest.
pub const LOWEST_SOC: f64 = 0.15;
/// A new block begins where the state of charge has moved by this.
const BLOCK_SOC: f64 = 0.05;
/// 0 °C, and the temperature at which resistances are given \[K\].
const KELVIN_AT_0_C: f64 = 273.15;
const REFERENCE_K: f64 = 298.15;

/// What was measured, before it is placed among the points of the tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The file's name without its extension.
    pub name: String,
    pub time_s: Vec<f64>,
    /// Positive when discharging.
    pub current_a: Vec<f64>,
    pub voltage_v: Vec<f64>,
    pub soc: Vec<f64>,
    pub celsius: Vec<f64>,
    /// Of the surroundings; NaN where not measured.
    pub ambient_c: Vec<f64>,
    pub kind: Kind,
    /// One block: a trip. Otherwise blocks follow the state of charge.
    pub whole: bool,
}

/// One sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Since the sample before \[s\].
    pub dt_s: f64,
    /// The battery is rested: the first sample, or the first after a gap.
    pub rested: bool,
    pub current_a: f64,
    pub voltage_v: f64,
    pub soc: f64,
    /// `1/T − 1/298.15 K` \[1/K\].
    pub coldness: f64,
    /// 0 for one that only drives the filters.
    pub weight: f64,
    pub ocv: Place,
    pub ohm: Place,
    pub block: usize,
}

/// A series that can be fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub name: String,
    pub samples: Vec<Sample>,
    pub blocks: usize,
    /// The level of the voltage in each block is free: in a pulse test the charge that flows
    /// between pulses is not known well enough to tell the open-circuit voltage, and a pulse tells
    /// the resistances without.
    pub free_level: bool,
}

impl Measured {
    /// A cell's test, full where its counter is 0. Of a sweep, the discharge: during the
    /// charge the counter has no zero.
    pub fn of_cell(record: &CellRecord, capacity_ah: f64) -> Self {
        let (kind, _) = record.kind(capacity_ah);
        let count = if kind == Kind::Sweep { emptied(record) + 1 } else { record.time_s.len() };
        let first = |values: &[f64]| values[..count].to_vec();
        Self {
            name: record.name.clone(),
            time_s: first(&record.time_s),
            current_a: first(&record.current_a),
            voltage_v: first(&record.voltage_v),
            soc: (0..count).map(|i| record.soc(i, capacity_ah)).collect(),
            celsius: first(&record.cell_c),
            ambient_c: first(&record.chamber_c),
            kind,
            whole: false,
        }
    }

    /// A trip: ampere-hours from the vehicle's own state of charge at the start.
    pub fn of_trip(trip: &Trip, capacity_ah: f64) -> Self {
        let mut soc = vec![trip.first_soc().unwrap_or(f64::NAN)];
        for i in 1..trip.len() {
            let mean_a = 0.5 * (trip.battery_a[i] + trip.battery_a[i - 1]);
            let hours = (trip.time_s[i] - trip.time_s[i - 1]) / 3600.0;
            soc.push(soc[i - 1] - mean_a * hours / capacity_ah);
        }
        let mut last_c = trip.battery_c.iter().copied().find(|c| c.is_finite());
        let celsius = trip.battery_c.iter().map(|&c| {
            last_c = if c.is_finite() { Some(c) } else { last_c };
            last_c.unwrap_or(REFERENCE_K - KELVIN_AT_0_C)
        });
        Self {
            name: trip.name.clone(),
            time_s: trip.time_s.clone(),
            current_a: trip.battery_a.clone(),
            voltage_v: trip.battery_v.clone(),
            soc,
            celsius: celsius.collect(),
            ambient_c: vec![f64::NAN; trip.len()],
            kind: Kind::Cycle,
            whole: true,
        }
    }

    /// The median time between two samples \[s\].
    pub fn sampling_s(&self) -> f64 {
        cell::sampling_s(&self.time_s)
    }

    /// The longest step that is no gap \[s\].
    pub fn longest_step_s(&self) -> f64 {
        GAP_S.max(GAP_SAMPLINGS * self.sampling_s())
    }

    /// The series among the points of `layout`. Samples outside the range of the state of charge
    /// drive the filters and count for nothing.
    pub fn placed(&self, layout: &Layout, delay_s: f64) -> Series {
        let current_a = cell::delayed(&self.time_s, &self.current_a, delay_s);
        let longest_s = self.longest_step_s();
        let (mut block, mut block_soc) = (0, self.soc[0]);
        let pulses = self.kind == Kind::Pulses;
        let samples = (0..self.time_s.len()).map(|i| {
            let dt_s = if i == 0 { 0.0 } else { self.time_s[i] - self.time_s[i - 1] };
            let soc = self.soc[i];
            let rested = i == 0 || dt_s > longest_s;
            let moved = !self.whole && (soc - block_soc).abs() > BLOCK_SOC;
            if i > 0 && if pulses { rested } else { moved } {
                (block, block_soc) = (block + 1, soc);
            }
            let lowest = if self.kind == Kind::Sweep { 0.0 } else { LOWEST_SOC };
            let inside = (lowest..=1.0).contains(&soc);
            Sample {
                dt_s,
                rested,
                current_a: current_a[i],
                voltage_v: self.voltage_v[i],
                soc,
                coldness: coldness(self.celsius[i]),
                weight: if inside { dt_s.min(LONGEST_WEIGHT_S) } else { 0.0 },
                ocv: place(&layout.ocv, soc),
                ohm: place(&layout.ohm, soc),
                block,
            }
        });
        let samples: Vec<Sample> = samples.collect();
        Series { name: self.name.clone(), samples, blocks: block + 1, free_level: pulses }
    }
}

/// `1/T − 1/298.15 K` \[1/K\].
pub fn coldness(celsius: f64) -> f64 {
    1.0 / (celsius + KELVIN_AT_0_C) - 1.0 / REFERENCE_K
}

/// The sample at which a sweep has discharged most; the first, as a rest may follow, or a charge.
pub fn emptied(record: &CellRecord) -> usize {
    let counted = record.discharged_ah.iter().enumerate();
    let most = counted.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)));
    most.map_or(0, |(i, _)| i)
}
