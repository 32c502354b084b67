//! No input makes a state or an output infinite, and what is missing is flagged.

use plant_core::{Dt, Real};
use proptest::prelude::*;
use voltstep_bms::Estimate;
use voltstep_bms::estimate::cells::{Cells, CellsInput, CellsParams};
use voltstep_bms::estimate::coulomb::{CoulombCounter, CoulombInput, CoulombParams, CoulombState};
use voltstep_bms::measure::{Reading, Spread};

use crate::draw::{any_bits, cases, curve, log};

fn bits(from: Real, to: Real) -> BoxedStrategy<Real> {
    any_bits(from..to)
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn coulomb(
        scale in prop::array::uniform9(prop_oneof![8 => log(0.1, 10.0), 1 => log(1e-9, 1e9)]),
        dt_s in prop_oneof![8 => log(1e-4, 1.0), 1 => log(1e-11, 1e11)],
        open_circuit in curve(),
        start in (bits(0.0, 1.0), bits(0.0, 0.3)),
        seconds in prop::collection::vec(
            (prop::collection::vec(bits(-50.0, 50.0), 0..5), bits(2.0, 4.5)), 1..40,
        ),
    ) {
        let [capacity, capacity_sd, offset, gain, largest, voltage, rest, rest_s, _] = scale;
        let params = CoulombParams {
            capacity_ah: 3.0 * capacity,
            capacity_sd_ah: 0.1 * capacity_sd,
            charge_efficiency: 0.99,
            offset_sd_a: 0.01 * offset,
            gain_sd: 0.01 * gain,
            largest_current_a: 40.0 * largest,
            open_circuit,
            rest_voltage_sd_v: 0.01 * voltage,
            rest_current_a: 10.0 * rest,
            rest_s: 0.01 * rest_s,
        };
        let counter = CoulombCounter::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let mut state = CoulombState::known(start.0, start.1);
        for (currents, voltage_v) in seconds {
            let mut missing = false;
            for current_a in currents {
                let before = counter.soc(&state);
                counter.step(&mut state, CoulombInput { current_a });
                if current_a.is_nan() || current_a.abs() > params.largest_current_a {
                    missing = true;
                    prop_assert_eq!(counter.soc(&state), before);
                }
                prop_assert!((0.0..=1.0).contains(&counter.soc(&state)));
            }
            let out = counter.review(&mut state, voltage_v);
            prop_assert!((0.0..=1.0).contains(&out.soc), "{out:?}");
            prop_assert!((0.0..=0.58).contains(&out.soc_sd), "{out:?}");
            prop_assert_eq!(out.current_missing, missing);
        }
    }

    #[test]
    fn cells(
        open_circuit in curve(),
        scale in prop::array::uniform6(prop_oneof![8 => log(0.1, 10.0), 1 => log(1e-3, 90.0)]),
        dt_s in prop_oneof![8 => log(0.01, 10.0), 1 => log(1e-11, 1e11)],
        steps in prop::collection::vec(
            (bits(0.0, 1.0), bits(0.0, 0.1), bits(-300.0, 300.0), prop::array::uniform4(bits(2.0, 5.0))),
            1..60,
        ),
    ) {
        let params = CellsParams {
            open_circuit,
            noise_sd_v: 0.001 * scale[0],
            offset_sd_v: 0.003 * scale[1],
            resistance_sd_ohm: 0.001 * scale[2],
            capacity_sd: 0.01 * scale[3],
            soc_sd: 0.01 * scale[4],
            drift_sd_per_day: 0.01 * scale[5],
            pack_soc_sd_max: 0.1,
            voltage_min_v: 2.0,
            voltage_max_v: 5.0,
        };
        let model = Cells::new(params, Dt::from_s(dt_s).unwrap()).unwrap();
        let at = |soc, soc_sd| Estimate::rested(soc, soc_sd, 25.0);
        let mut state = model.start::<4>(at(0.5, 0.05));
        for (soc, soc_sd, current_a, cell_v) in steps {
            let pack = at(soc, soc_sd);
            let before = state;
            let out = model.step(&mut state, CellsInput { pack, cell_v: &cell_v, current_a });
            let sane = |x: Real| x.abs() <= 1e9;
            let rejected = !((0.0..=1.0).contains(&soc) && soc_sd >= 0.0 && sane(soc_sd));
            prop_assert_eq!(out.rejected, rejected);
            let mut held = 0;
            for (i, voltage_v) in cell_v.iter().enumerate() {
                let cell = state.cell(i).unwrap();
                prop_assert!((0.0..=1.0).contains(&cell.soc) && (0.0..=1.0).contains(&cell.soc_sd), "{cell:?}");
                let usable = !rejected && sane(current_a) && (2.0..=5.0).contains(voltage_v)
                    && state.cell(i).unwrap().soc_sd >= 0.0 && soc_sd <= 0.1;
                prop_assert_eq!(cell.held, !usable, "{} {:?}", i, out);
                held += usize::from(cell.held);
                if rejected {
                    prop_assert_eq!(cell.soc, before.cell(i).unwrap().soc);
                    let before_sd = before.cell(i).unwrap().soc_sd;
                    prop_assert!(cell.soc_sd >= before_sd * (1.0 - 1e-6), "{before_sd} {cell:?}");
                }
            }
            prop_assert_eq!(out.held, held);
            let spread = state.spread();
            prop_assert!(0.0 <= spread.min && spread.max <= 1.0, "{spread:?}");
            // The mean is one of unbounded values; within rounding it lies between the two.
            prop_assert!((0.0..=1.0).contains(&spread.mean), "{spread:?}");
        }
    }

    #[test]
    fn spread(readings in prop::collection::vec((bits(2.0, 4.5), bits(0.0, 0.2), any::<bool>()), 0..20)) {
        let readings: Vec<_> = readings
            .into_iter()
            .map(|(value, age_s, valid)| Reading { value, age_s, valid })
            .collect();
        let usable: Vec<_> = readings.iter().filter_map(|reading| reading.usable(0.1)).collect();
        match Spread::of(&readings, 0.1) {
            None => prop_assert!(usable.is_empty()),
            Some(spread) => {
                prop_assert_eq!(spread.usable, usable.len());
                prop_assert_eq!(Some(spread.min), readings[spread.min_index].usable(0.1));
                prop_assert_eq!(Some(spread.max), readings[spread.max_index].usable(0.1));
                prop_assert!(usable.iter().all(|v| (spread.min..=spread.max).contains(v)));
                prop_assert!(spread.mean.is_finite());
            }
        }
    }
}
