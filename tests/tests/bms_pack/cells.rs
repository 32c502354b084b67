//! The standard deviation of each cell covers what is not known of it.

use plant_core::battery::OpenCircuit;
use plant_core::num::SocTable;
use plant_core::{Dt, Real};
use voltstep_bms::Estimate;
use voltstep_bms::estimate::cells::{Cells, CellsInput, CellsParams};

use crate::draw::{Honesty, Normal};

const CELLS: usize = 18;

fn params(open_circuit: OpenCircuit) -> CellsParams {
    CellsParams {
        open_circuit,
        noise_sd_v: 0.002,
        offset_sd_v: 0.003,
        resistance_sd_ohm: 0.000_1,
        capacity_sd: 0.01,
        soc_sd: 0.02,
        drift_sd_per_day: 0.001,
        pack_soc_sd_max: 0.05,
        voltage_min_v: 2.0,
        voltage_max_v: 4.5,
    }
}

fn table(points: &[(Real, Real)]) -> OpenCircuit {
    OpenCircuit::Table(SocTable::from_points("t", points).unwrap())
}

/// Cells that differ as the parameters state, driven from 95 % to 5 % in two hours and charged
/// again; every minute each is judged.
fn judged(open_circuit: OpenCircuit, packs: u64, missing: usize) -> [Honesty; 40] {
    const SECONDS: u32 = 7200;
    let p = params(open_circuit);
    let model = Cells::new(p, Dt::from_s(1.0).unwrap()).unwrap();
    let mut bands = [Honesty::default(); 40];
    for seed in 0..packs {
        let mut n = Normal(seed);
        let mut drawn = |sd: Real| -> [f64; CELLS] {
            let x: [f64; CELLS] = core::array::from_fn(|_| n.next(f64::from(sd)));
            let mean = x.iter().sum::<f64>() / CELLS as f64;
            x.map(|x| x - mean)
        };
        let (start, offset) = (drawn(p.soc_sd), drawn(p.offset_sd_v));
        let (resistance, capacity) = (drawn(p.resistance_sd_ohm), drawn(p.capacity_sd));
        let mut n = Normal(seed + 1_000_000);
        let at = |soc: f64| Estimate::rested(soc as Real, 0.0, 25.0);
        let mut state = model.start::<CELLS>(at(0.95));
        for second in 0..2 * SECONDS {
            let down = f64::from(if second < SECONDS { second } else { 2 * SECONDS - second });
            let soc = 0.95 - 0.9 * down / f64::from(SECONDS);
            // A current that comes and goes, on average that of the change.
            let current_a = if second < SECONDS { 30.0 } else { -30.0 }
                * if second % 60 < 30 { 2.0 } else { 0.0 };
            let truth: [f64; CELLS] =
                core::array::from_fn(|i| soc + start[i] + capacity[i] * (soc - 0.95));
            let mut cell_v: [Real; CELLS] = core::array::from_fn(|i| {
                let noise_v = n.next(f64::from(p.noise_sd_v));
                p.open_circuit.at(truth[i] as Real)
                    + (offset[i] - resistance[i] * current_a + noise_v) as Real
            });
            cell_v[..missing].fill(Real::NAN);
            let input = CellsInput { pack: at(soc), cell_v: &cell_v, current_a: current_a as Real };
            assert_eq!(model.step(&mut state, input).held, missing);
            if second % 60 == 59 {
                let band = (soc * 20.0) as usize + if second < SECONDS { 0 } else { 20 };
                for (i, truth) in truth.iter().enumerate() {
                    let cell = state.cell(i).unwrap();
                    let error = f64::from(cell.soc) - truth.clamp(0.0, 1.0);
                    bands[band].book(error, f64::from(cell.soc_sd));
                }
            }
        }
    }
    bands
}

/// In every twentieth of the state of charge, on the way down and up, with all cells measured and
/// without some.
fn is_honest(open_circuit: OpenCircuit) {
    for missing in [0, 1, 6] {
        for (band, honesty) in judged(open_circuit, 40, missing).iter().enumerate() {
            if honesty.count() > 0 {
                let (inside, rms) = (honesty.share_inside(), honesty.rms());
                assert!(
                    inside >= 0.99,
                    "band {band}, {missing} missing: {inside} inside three standard deviations"
                );
                assert!(
                    (0.6..1.1).contains(&rms),
                    "band {band}, {missing} missing: {rms} standard deviations"
                );
            }
        }
    }
}

#[test]
fn is_honest_on_a_line() {
    is_honest(OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 });
}

#[test]
fn is_honest_on_a_bent_curve() {
    let nmc = [(0.0, 3.0), (0.1, 3.45), (0.3, 3.6), (0.6, 3.8), (0.8, 4.0), (1.0, 4.2)];
    is_honest(table(&nmc));
}

#[test]
fn is_honest_on_a_flat_curve() {
    let lfp =
        [(0.0, 2.8), (0.1, 3.2), (0.25, 3.29), (0.6, 3.3), (0.65, 3.33), (0.97, 3.335), (1.0, 3.5)];
    is_honest(table(&lfp));
}
