use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryParams, OverSoc};
use plant_core::num::SocTable;
use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::{Dt, must};

use super::*;
use crate::estimate::cells::CellsParams;
use crate::estimate::coulomb::CoulombParams;
use crate::estimate::ekf::EkfParams;
use crate::estimate::soh::{CapacityParams, ResistanceParams};

const DT: Dt = must!(Dt::from_s(1.0));
const NOMINAL: MappedBatteryParams = PANASONIC_NCR18650PF;
const MODEL: MappedBattery = must!(MappedBattery::new(NOMINAL, DT));
const SERIES: Series<'static> = Series {
    filter: must!(Ekf::new(EkfParams::typical(NOMINAL, 3.65), DT)),
    counter: must!(CoulombCounter::new(
        CoulombParams {
            capacity_ah: NOMINAL.capacity_ah,
            capacity_sd_ah: 0.03 * NOMINAL.capacity_ah,
            charge_efficiency: 1.0,
            offset_sd_a: 0.01,
            gain_sd: 0.003,
            largest_current_a: 30.0,
            open_circuit: NOMINAL.open_circuit,
            rest_voltage_sd_v: 0.003,
            rest_current_a: 0.03,
            rest_s: 3600.0,
        },
        DT
    )),
    cells: must!(Cells::new(
        CellsParams {
            open_circuit: NOMINAL.open_circuit,
            noise_sd_v: 0.001,
            offset_sd_v: 0.001,
            resistance_sd_ohm: 0.003,
            capacity_sd: 0.02,
            soc_sd: 0.02,
            drift_sd_per_day: 0.001,
            pack_soc_sd_max: 0.1,
            voltage_min_v: 2.0,
            voltage_max_v: 4.5,
        },
        DT
    )),
    resistance: must!(ResistanceEstimator::new(
        ResistanceParams {
            voltage_sd_v: 0.001,
            current_sd_a: 0.01,
            least_step_a: 0.5,
            memory_steps: 500.0,
            initial_sd: 0.5,
            skew_s: 0.0,
        },
        &MODEL,
        DT
    )),
    capacity: must!(CapacityEstimator::new(
        CapacityParams {
            nominal_ah: NOMINAL.capacity_ah,
            nominal_sd_ah: 0.15 * NOMINAL.capacity_ah,
            current_noise_sd_a: 0.01,
            current_offset_sd_a: 0.005,
            current_gain_sd: 0.003,
            least_soc_change: 0.2,
            least_soc_change_sds: 10.0,
            memory_pairs: 50.0,
        },
        DT
    )),
    per_second: 1,
    dt_s: 1.0,
};

/// Four fifths of the capacity, 1.8 times the resistance: driven, rested, charged, rested.
#[test]
#[cfg_attr(miri, ignore = "too many steps for an interpreter")]
fn what_is_learnt_of_an_aged_cell_reaches_filter_and_counter() {
    let mut aged = NOMINAL;
    aged.capacity_ah *= 0.8;
    for over in [
        &mut aged.series.resistance_ohm,
        &mut aged.polarisation.resistance_ohm,
        &mut aged.second_polarisation.resistance_ohm,
    ] {
        if let OverSoc::Table(table) = *over {
            *over = OverSoc::Table(SocTable::new("r", table.values().map(|r| 1.8 * r)).unwrap());
        }
    }
    let truth = MappedBattery::new(aged, DT).unwrap();
    let mut cell = truth.rested(0.9).unwrap();
    let start = SERIES.filter.start(0.9, 0.02, 25.0).unwrap();
    let memory = SERIES.filter.remember(&start);
    let as_new = Health {
        capacity_sd_ah: 0.15 * NOMINAL.capacity_ah,
        resistance_factor_sd: 0.5,
        ..Health::as_new(&MODEL)
    };
    let mut state = SERIES.resume::<2>(memory, as_new, Some(86_400.0), 25.0).unwrap();
    let (mut inside, mut samples) = (0_u32, 0_u32);
    for day in 0..3 {
        for second in 0..30_000_u32 {
            let soc = cell.soc.get();
            let current_a = match second {
                0..12_000 if soc > 0.35 => [0.0, 2.0, 4.0, -1.0, 1.0][second as usize / 7 % 5],
                18_000..26_000 if soc < 0.88 => -1.0,
                _ => 0.0,
            };
            let out = truth.step(&mut cell, MappedBatteryInput { current_a });
            let cell_v = [out.terminal_v + 0.002, out.terminal_v - 0.002];
            let estimate = SERIES.step(
                &mut state,
                SeriesInput {
                    cell_v: &cell_v,
                    current_a,
                    temperature_c: out.temperature_c,
                    contactors_open: false,
                },
            );
            if day > 0 {
                samples += 1;
                inside += u32::from((estimate.soc - cell.soc.get()).abs() <= 3.0 * estimate.soc_sd);
            }
        }
    }
    let Health { capacity_ah, capacity_sd_ah, resistance_factor, .. } = state.health;
    assert!((capacity_ah / aged.capacity_ah - 1.0).abs() < 0.03, "{:?}", state.health);
    assert!((resistance_factor / 1.8 - 1.0).abs() < 0.05, "{:?}", state.health);
    assert!((capacity_ah - aged.capacity_ah).abs() <= 3.0 * capacity_sd_ah, "{:?}", state.health);
    assert!(f64::from(inside) >= 0.997 * f64::from(samples), "{inside} of {samples}");
    let counted = SERIES.counter.soc(&state.counter);
    assert!((counted - cell.soc.get()).abs() < 0.02, "{counted}");
    // Without a reading nothing breaks.
    let nothing = SeriesInput {
        cell_v: &[Real::NAN; 2],
        current_a: Real::NAN,
        temperature_c: Real::NAN,
        contactors_open: false,
    };
    let before = SERIES.filter.estimate(&state.filter);
    let after = SERIES.step(&mut state, nothing);
    assert!((after.soc - before.soc).abs() < 1e-3 && after.soc_sd >= before.soc_sd);
    let mut memory = memory;
    memory.soc = 2.0;
    assert_eq!(SERIES.resume::<2>(memory, as_new, None, 25.0).unwrap_err().field(), "soc");
}
