//! The estimators as C calls them: good calls agree with those of Rust, bit for bit.

#![allow(clippy::cast_possible_truncation)] // a few cells

use std::mem::MaybeUninit;
use std::ptr::null;

use plant_core::Dt;
use plant_core::battery::MappedBattery;
use voltstep_bms::estimate::cells::{CellResistances, Cells};
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombState};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput};
use voltstep_bms::estimate::energy::{EnergyGauge, EnergyInput, EnergyState};
use voltstep_bms::estimate::power::{PowerLimits, SeriesCells};
use voltstep_bms::estimate::series::{Series, SeriesInput};
use voltstep_bms::estimate::soh::{
    CapacityEstimator, CapacityInput, ResistanceEstimator, ResistanceInput,
};
use voltstep_bms::store::record::Record;
use voltstep_bms::{Estimate, Health};
use voltstep_capi::VoltstepStatus as Status;
use voltstep_capi::*;

mod memory;
use memory::{DT_S, get, known, set_up, words};

const P: EstimatorParams = EstimatorParams::PANASONIC_NCR18650PF;
const CELLS: usize = 4;

fn dt() -> Dt {
    Dt::from_s(DT_S).unwrap()
}

/// Current and voltage of a cell that is driven, sample by sample.
fn samples(count: u16) -> impl Iterator<Item = (f32, f32)> {
    let cell = MappedBattery::new(P.filter.battery, dt()).unwrap();
    let mut state = cell.rested_at(0.8, 25.0).unwrap();
    (0..count).map(move |n| {
        let current_a = [0.0, 4.0, 1.0, 8.0, -3.0][usize::from(n / 50) % 5];
        let input = plant_core::battery::MappedBatteryInput { current_a };
        (current_a, cell.step(&mut state, input).terminal_v)
    })
}

#[test]
fn the_filter_is_that_of_rust() {
    let e = set_up();
    let filter = Ekf::new(P.filter, dt()).unwrap();
    let mut wanted = filter.start(0.7, 0.1, 25.0).unwrap();
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let mut state = get(|state| voltstep_filter_start(&raw const *e, state, 0.7, 0.1, 25.0));
        for (current_a, voltage_v) in samples(800) {
            let input = VoltstepFilterInput {
                current_a,
                voltage_v,
                temperature_c: 25.0,
                contactors_open: 0,
            };
            let out: VoltstepFilterOutputs = get(|out| {
                voltstep_filter_step(&raw const *e, &raw mut state, &raw const input, out)
            });
            let input =
                EkfInput { current_a, voltage_v, temperature_c: 25.0, contactors_open: false };
            let (model, status) = (filter.step(&mut wanted, input), filter.status(&wanted));
            assert_eq!(out.estimate, filter.estimate(&wanted).into());
            assert_eq!((out.residual_v, out.rejected), (model.residual_v, model.rejected));
            assert_eq!((out.converged, out.consistent), (status.converged, status.consistent));
            assert_eq!((out.flat, out.temperature_missing), (status.flat, false));
            assert_eq!(out.outside_identified, status.outside_identified);
        }
        // What was learnt is taken over, and remembered.
        let health = VoltstepHealth {
            capacity_ah: 2.5,
            capacity_sd_ah: 0.02,
            resistance_factor: 1.4,
            resistance_factor_sd: 0.05,
        };
        let adopted = voltstep_filter_adopt(&raw const *e, &raw mut state, &raw const health);
        assert_eq!(adopted, Status::Ok);
        filter.adopt(&mut wanted, &health.into());
        let record: VoltstepRecord = get(|record| {
            voltstep_filter_record(&raw const *e, &raw const state, &raw const health, record)
        });
        let remembered = Record::of(filter.remember(&wanted), health.into());
        assert_eq!((record.soc, record.soc_sd), (remembered.soc, remembered.soc_sd));
        assert_eq!(record.capacity_ah, 2.5);
        let mut later = get(|state| {
            voltstep_filter_resume(&raw const *e, state, &raw const record, 60.0, 20.0)
        });
        let mut wanted = filter.resume(filter.remember(&wanted), Some(60.0), 20.0).unwrap();
        filter.adopt(&mut wanted, &health.into());
        let open = VoltstepFilterInput {
            current_a: 0.3,
            voltage_v: 3.9,
            temperature_c: 20.0,
            contactors_open: 1,
        };
        let out: VoltstepFilterOutputs =
            get(|out| voltstep_filter_step(&raw const *e, &raw mut later, &raw const open, out));
        let input =
            EkfInput { current_a: 0.3, voltage_v: 3.9, temperature_c: 20.0, contactors_open: true };
        filter.step(&mut wanted, input);
        assert_eq!(out.estimate, filter.estimate(&wanted).into());

        let mut rested = get(|state| voltstep_filter_start_rested(&raw const *e, state, 3.8, 20.0));
        let mut unknown = get(|state| voltstep_filter_start_unknown(&raw const *e, state, 20.0));
        let mut starts =
            [filter.start_rested(3.8, 20.0).unwrap(), filter.start_unknown(20.0).unwrap()];
        for (state, wanted) in [&mut rested, &mut unknown].into_iter().zip(&mut starts) {
            let out: VoltstepFilterOutputs =
                get(|out| voltstep_filter_step(&raw const *e, state, &raw const open, out));
            filter.step(wanted, input);
            assert_eq!(out.estimate, filter.estimate(wanted).into());
        }
    }
}

#[test]
fn the_counter_is_that_of_rust() {
    let e = set_up();
    let counter = CoulombCounter::new(P.counter, dt()).unwrap();
    let mut wanted = CoulombState::known(0.7, 0.1);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let mut state = get(|state| voltstep_counter_start(&raw const *e, state, 0.7, 0.1));
        for (n, (current_a, voltage_v)) in samples(500).enumerate() {
            assert_eq!(voltstep_counter_step(&raw const *e, &raw mut state, current_a), Status::Ok);
            counter.step(&mut wanted, CoulombInput { current_a });
            if n % 10 == 9 {
                let out: VoltstepCounterOutputs = get(|out| {
                    voltstep_counter_review(&raw const *e, &raw mut state, voltage_v, out)
                });
                let model = counter.review(&mut wanted, voltage_v);
                assert_eq!((out.soc, out.soc_sd), (model.soc, model.soc_sd));
                assert_eq!((out.anchored, out.voltage_implausible), (false, false));
            }
        }
        voltstep_counter_step(&raw const *e, &raw mut state, f32::NAN);
        let out: VoltstepCounterOutputs =
            get(|out| voltstep_counter_review(&raw const *e, &raw mut state, 3.7, out));
        assert!(out.current_missing);

        let record = known();
        let mut rested = get(|state| voltstep_counter_start_rested(&raw const *e, state, 3.8));
        let mut later =
            get(|state| voltstep_counter_resume(&raw const *e, state, &raw const record, f32::NAN));
        let mut resumed = CoulombState::known(record.soc, record.soc_sd);
        counter.adopt(
            &mut resumed,
            &Health {
                capacity_ah: record.capacity_ah,
                capacity_sd_ah: record.capacity_sd_ah,
                resistance_factor: record.resistance_factor,
                resistance_factor_sd: record.resistance_factor_sd,
            },
        );
        counter.pause(&mut resumed, None, P.filter.uncertainty.standby_sd_a);
        let mut starts = [counter.rested(3.8), resumed];
        for (state, wanted) in [&mut rested, &mut later].into_iter().zip(&mut starts) {
            let out: VoltstepCounterOutputs =
                get(|out| voltstep_counter_review(&raw const *e, state, 3.8, out));
            let model = counter.review(wanted, 3.8);
            assert_eq!((out.soc, out.soc_sd), (model.soc, model.soc_sd));
        }
    }
}

#[test]
fn the_health_is_that_of_rust() {
    let e = set_up();
    let battery = MappedBattery::new(P.filter.battery, dt()).unwrap();
    let resistance = ResistanceEstimator::new(P.resistance, &battery, dt()).unwrap();
    let capacity = CapacityEstimator::new(P.capacity, dt()).unwrap();
    let mut of_resistance = resistance.unknown();
    let mut of_capacity = capacity.known(P.capacity.nominal_ah, P.capacity.nominal_sd_ah);
    let estimate = Estimate::rested(0.7, 0.01, 25.0);
    let believed = VoltstepEstimate::from(estimate);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let health: VoltstepHealth = get(|health| voltstep_health_unlearnt(&raw const *e, health));
        let mut state =
            get(|state| voltstep_resistance_start(&raw const *e, state, &raw const health));
        let mut learned = 0;
        for (current_a, voltage_v) in samples(500) {
            let out: VoltstepResistanceOutputs = get(|out| {
                let believed = &raw const believed;
                let state = &raw mut state;
                voltstep_resistance_step(&raw const *e, state, voltage_v, current_a, believed, out)
            });
            let input = ResistanceInput { voltage_v, current_a, estimate };
            let model = resistance.step(&mut of_resistance, input);
            assert_eq!((out.factor, out.factor_sd), (model.factor, model.factor_sd));
            assert_eq!((out.learned, out.at_bound), (model.learned, model.at_bound));
            learned += u32::from(out.learned);
        }
        assert!(learned > 5, "{learned}");

        let mut state =
            get(|state| voltstep_capacity_start(&raw const *e, state, &raw const health));
        let (start, end) = (Estimate { soc: 0.9, ..estimate }, Estimate { soc: 0.3, ..estimate });
        let pair = VoltstepCapacityInput {
            start: start.into(),
            end: end.into(),
            discharged_ah: 1.5,
            duration_s: 7200.0,
        };
        for n in 0..5 {
            let out: VoltstepCapacityOutputs = get(|out| {
                voltstep_capacity_step(&raw const *e, &raw mut state, &raw const pair, out)
            });
            let input = CapacityInput { start, end, discharged_ah: 1.5, duration_s: 7200.0 };
            let model = capacity.step(&mut of_capacity, input);
            assert_eq!((out.capacity_ah, out.learned), (model.capacity_ah, model.learned));
            assert_eq!(
                (out.capacity_sd_ah, out.contradicted),
                (model.capacity_sd_ah, model.contradicted),
                "{n}"
            );
        }
    }
}

#[test]
fn power_and_energy_are_those_of_rust() {
    let e = set_up();
    let battery = MappedBattery::new(P.filter.battery, dt()).unwrap();
    let limits = PowerLimits::new(P.power, &battery).unwrap();
    let gauge = EnergyGauge::new(P.energy, &battery, dt()).unwrap();
    let mut averages = EnergyState::default();
    let estimate = Estimate::rested(0.6, 0.01, 15.0);
    let model_health = Health { resistance_factor: 1.2, ..Health::as_new(&battery) };
    let (believed, health) = (VoltstepEstimate::from(estimate), VoltstepHealth::from(model_health));
    let (believed, health) = (&raw const believed, &raw const health);
    // SAFETY: every pointer comes from a reference.
    unsafe {
        let wanted = limits.ahead(&estimate, &model_health).map(VoltstepPowerAhead::from);
        let found: [VoltstepPowerAhead; VOLTSTEP_HORIZONS] =
            get(|found: *mut [_; VOLTSTEP_HORIZONS]| {
                voltstep_power_ahead(&raw const *e, believed, health, found.cast())
            });
        assert_eq!(found, wanted);
        assert!(found[0].discharge.current_a > 1.0 && found[2].charge.power_w > 1.0);

        let mut walk = get(|walk| voltstep_power_walk_start(&raw const *e, walk));
        for _ in 0..2 {
            let mut found = [VoltstepPowerAhead { horizon_s: 0.0, ..wanted[0] }; VOLTSTEP_HORIZONS];
            for call in 1..=6 {
                let (mut done, walk) = (false, &raw mut walk);
                let found = (&raw mut found).cast();
                let status = voltstep_power_walk(
                    &raw const *e,
                    walk,
                    believed,
                    health,
                    found,
                    &raw mut done,
                );
                assert_eq!((status, done), (Status::Ok, call == 6), "{call}");
            }
            assert_eq!(found, wanted);
        }

        let mut state = get(|state| voltstep_energy_start(&raw const *e, state));
        for (current_a, voltage_v) in samples(100) {
            let status = voltstep_energy_step(&raw const *e, &raw mut state, current_a, voltage_v);
            assert_eq!(status, Status::Ok);
            gauge.step(&mut averages, EnergyInput { current_a, voltage_v });
        }
        let report: VoltstepEnergyReport = get(|report| {
            voltstep_energy_report(&raw const *e, &raw const state, believed, health, report)
        });
        let model = gauge.report(&averages, &estimate, &model_health).unwrap();
        assert_eq!(report.remaining_energy_wh, model.remaining_energy_wh);
        assert_eq!(Some(report.average_time_to_empty_s), model.average_time_to_empty_s);
        assert!(report.average_time_to_full_s.is_nan());
        assert_eq!(report.state_of_energy, model.state_of_energy);
    }
}

#[test]
fn cells_in_series_are_those_of_rust() {
    let e = set_up();
    let battery = MappedBattery::new(P.filter.battery, dt()).unwrap();
    let series = Series {
        filter: Ekf::new(P.filter, dt()).unwrap(),
        counter: CoulombCounter::new(P.counter, dt()).unwrap(),
        cells: Cells::new(P.cells, Dt::from_s(10.0 * DT_S).unwrap()).unwrap(),
        resistance: ResistanceEstimator::new(P.resistance, &battery, dt()).unwrap(),
        capacity: CapacityEstimator::new(P.capacity, dt()).unwrap(),
        per_second: 10,
        dt_s: DT_S,
    };
    let of_each = CellResistances::new(P.cell_resistances).unwrap();
    let limits = PowerLimits::new(P.power, &battery).unwrap();
    let record = known();
    let mut resistances = of_each.start::<CELLS>();
    // SAFETY: every pointer comes from a reference, and the memory is large enough.
    unsafe {
        let mut memory = words(CELLS);
        let memory = memory.as_mut_ptr();
        let count = words(CELLS).len() as u32;
        let started =
            voltstep_series_start(&raw const *e, memory, count, 4, &raw const record, 600.0, 25.0);
        assert_eq!(started, Status::Ok);
        let health = Health {
            capacity_ah: record.capacity_ah,
            capacity_sd_ah: record.capacity_sd_ah,
            resistance_factor: record.resistance_factor,
            resistance_factor_sd: record.resistance_factor_sd,
        };
        let mut first = series.filter.remember(&series.filter.start_unknown(25.0).unwrap());
        (first.soc, first.soc_sd) = (record.soc, record.soc_sd);
        (first.current_offset_a, first.current_offset_sd_a) =
            (record.current_offset_a, record.current_offset_sd_a);
        first.polarisation = None;
        let mut wanted = series.resume::<CELLS>(first, health, Some(600.0), 25.0).unwrap();
        let mut mean = Estimate::rested(0.0, 0.0, 0.0);
        for (current_a, voltage_v) in samples(1500) {
            let cell_v = [0.004, -0.001, 0.0, -0.003].map(|v| voltage_v + v - 0.002 * current_a);
            let input = VoltstepSeriesInput { current_a, temperature_c: 25.0, contactors_open: 0 };
            let out: VoltstepSeriesOutputs = get(|out| {
                let (input, cell_v) = (&raw const input, cell_v.as_ptr());
                voltstep_series_step(&raw const *e, memory, input, cell_v, 4, out)
            });
            let sample = SeriesInput {
                cell_v: &cell_v,
                current_a,
                temperature_c: 25.0,
                contactors_open: false,
            };
            mean = series.step(&mut wanted, sample);
            of_each.step(&mut resistances, &cell_v, current_a);
            assert_eq!((out.estimate, out.health), (mean.into(), wanted.health.into()));
            assert_eq!(out.counted_soc, series.counter.soc(&wanted.counter));
            let spread = wanted.cells.spread();
            assert_eq!((out.soc_min, out.soc_max), (spread.min, spread.max));
        }
        for index in 0..CELLS {
            let cell: VoltstepSeriesCell =
                get(|cell| voltstep_series_cell(memory, index as u32, cell));
            let model = wanted.cells.cell(index).unwrap();
            assert_eq!((cell.soc, cell.soc_sd, cell.held), (model.soc, model.soc_sd, model.held));
            assert_eq!(
                (cell.resistance_ratio, cell.resistance_ratio_sd),
                resistances.ratio(index).unwrap()
            );
        }
        let found: [VoltstepPowerAhead; VOLTSTEP_HORIZONS] =
            get(|found: *mut [_; VOLTSTEP_HORIZONS]| {
                voltstep_series_power(&raw const *e, memory, found.cast())
            });
        let model = limits.ahead_of_cells(&SeriesCells {
            mean,
            health: wanted.health,
            socs: &wanted.cells,
            resistances: &resistances,
        });
        assert_eq!(found, model.map(VoltstepPowerAhead::from));
        let mut walk = get(|walk| voltstep_power_walk_start(&raw const *e, walk));
        let mut sliced = [VoltstepPowerAhead { horizon_s: 0.0, ..found[0] }; VOLTSTEP_HORIZONS];
        for call in 1..=VOLTSTEP_SERIES_SLICES {
            let (mut done, walk, sliced) = (false, &raw mut walk, sliced.as_mut_ptr());
            let status =
                voltstep_series_power_walk(&raw const *e, memory, walk, sliced, &raw mut done);
            assert_eq!((status, done), (Status::Ok, call == VOLTSTEP_SERIES_SLICES));
        }
        assert_eq!(sliced, found);
        let report: VoltstepEnergyReport =
            get(|report| voltstep_series_energy(&raw const *e, memory, report));
        assert!((2.0..12.0).contains(&report.remaining_energy_wh), "{report:?}");
        let kept: VoltstepRecord =
            get(|record| voltstep_series_record(&raw const *e, memory, record));
        let wanted = Record::of(series.filter.remember(&wanted.filter), wanted.health);
        assert_eq!((kept.soc, kept.capacity_ah), (wanted.soc, wanted.capacity_ah));
        assert_eq!(kept.polarised, 1);
    }
}

#[test]
fn every_number_of_cells_steps() {
    let e = set_up();
    for cells in [1, 4, 12, 18, 96] {
        let mut memory = words(cells);
        let count = memory.len() as u32;
        let memory = memory.as_mut_ptr();
        let input = VoltstepSeriesInput { current_a: 0.0, temperature_c: 25.0, contactors_open: 0 };
        let cell_v = [3.8; 96];
        // SAFETY: every pointer comes from a reference, and the memory is large enough.
        unsafe {
            let n = cells as u32;
            let started = voltstep_series_start(&raw const *e, memory, count, n, null(), 0.0, 25.0);
            assert_eq!(started, Status::Ok, "{cells}");
            let mut out = MaybeUninit::<VoltstepSeriesOutputs>::uninit();
            for _ in 0..600 {
                let (input, cell_v) = (&raw const input, cell_v.as_ptr());
                let stepped =
                    voltstep_series_step(&raw const *e, memory, input, cell_v, n, out.as_mut_ptr());
                assert_eq!(stepped, Status::Ok);
            }
            let out = out.assume_init();
            let wanted = P.filter.battery.open_circuit.soc_at(3.8);
            assert!((out.estimate.soc - wanted).abs() < 0.02, "{cells}: {out:?}");
            let cell: VoltstepSeriesCell = get(|cell| voltstep_series_cell(memory, n - 1, cell));
            assert!((cell.soc - wanted).abs() < 0.02 && !cell.held, "{cell:?}");
        }
    }
}
