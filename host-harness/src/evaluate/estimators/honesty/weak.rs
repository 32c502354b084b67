//! What a pack may give that has a weak cell: no cell may leave its limit.

use plant_core::Dt;
use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryState};
use voltstep_bms::Health;
use voltstep_bms::estimate::cells::{
    CellResistanceParams, CellResistances, Cells, CellsInput, CellsParams,
};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams};
use voltstep_bms::estimate::power::{
    HORIZONS_S, PowerLimits, PowerParams, SeriesCells, TemperatureWindow,
};
use voltstep_bms::estimate::soh::{ResistanceEstimator, ResistanceInput, ResistanceParams};

use super::batteries::{Chemistry, scale_resistances};
use super::random::Random;
use super::tally::{Said, Tally};

const CELLS: usize = 12;
/// How unlike the others are: resistance, capacity, state of charge.
const RESISTANCE_SD: f32 = 0.05;
const CAPACITY_SD: f32 = 0.02;
const SOC_SD: f32 = 0.01;
/// A cell may be so far beyond its limit \[V\].
const BEYOND_V: f32 = 0.010;
/// Driven for so long, and asked so often from then on \[s\].
const LEARNT_S: u32 = 900;
const DRIVEN_S: u32 = 2700;
const ASKED_S: u32 = 60;
const ANY: TemperatureWindow = TemperatureWindow {
    none_below_c: -40.0,
    all_from_c: -39.0,
    all_to_c: 79.0,
    none_above_c: 80.0,
};

/// One of the cells, and where it is.
type Cell = (MappedBattery, MappedBatteryState);

/// Drives the pack of a seed.
///
/// # Panics
/// Where a battery or an estimator refuses what is simulated: a mistake in the matrix itself.
#[expect(clippy::too_many_lines, reason = "every estimator once")]
pub fn run(chemistry: Chemistry, seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let dt = Dt::from_s(1.0).expect("a second");
    let mut known = chemistry.cell();
    known.discharge_limit_a = 8.0 * known.capacity_ah;
    let nominal_v = known.open_circuit.at(0.5);
    let capacity_ah = known.capacity_ah;
    let celsius = random.one_of(&[25.0, 10.0, 0.0]);
    let soc = 0.55 + 0.35 * random.even();
    let weak = random.one_of(&[0, 3, 7, 11]);
    let mut cells: Vec<Cell> = (0..CELLS)
        .map(|index| {
            let mut truth = known;
            let mut factor = 1.0 + RESISTANCE_SD * random.normal().clamp(-2.5, 2.5);
            truth.capacity_ah *= 1.0 + CAPACITY_SD * random.normal().clamp(-2.5, 2.5);
            if index == weak {
                factor = random.one_of(&[1.5, 2.0, 3.0]);
                truth.capacity_ah = known.capacity_ah * random.one_of(&[0.7, 0.85, 1.0]);
            }
            truth.discharge_limit_a = 1e4;
            scale_resistances(&mut truth, factor);
            let battery = MappedBattery::new(truth, dt).expect("a battery");
            let own = (soc + SOC_SD * random.normal().clamp(-2.5, 2.5)).clamp(0.0, 1.0);
            (battery, battery.rested_at(own, celsius).expect("a state"))
        })
        .collect();

    let model = MappedBattery::new(known, dt).expect("a battery");
    let ohm = model.resistances(0.5, celsius);
    let total_ohm = ohm.series_ohm + ohm.polarisation_ohm[0] + ohm.polarisation_ohm[1];
    let filter = Ekf::new(EkfParams::typical(known, nominal_v), dt).expect("a filter");
    let of_cells = CellsParams {
        open_circuit: known.open_circuit,
        noise_sd_v: 0.001,
        offset_sd_v: 0.001,
        // What a maker declares of a pack in which a cell may be weak.
        resistance_sd_ohm: 0.5 * total_ohm,
        capacity_sd: 0.1,
        soc_sd: 0.02,
        drift_sd_per_day: 0.001,
        pack_soc_sd_max: 0.3,
        voltage_min_v: 1.0,
        voltage_max_v: 4.5,
    };
    let of_cells = Cells::new(of_cells, dt).expect("cells");
    let resistances = CellResistanceParams {
        resistance_ohm: ohm.series_ohm,
        spread_sd: 1.0,
        noise_sd_v: 0.001,
        least_step_a: 0.3 * capacity_ah,
        memory_steps: 1000.0,
    };
    let resistances = CellResistances::new(resistances).expect("resistances");
    let resistance = ResistanceParams {
        voltage_sd_v: 0.001,
        current_sd_a: 0.005 * capacity_ah,
        least_step_a: 0.2 * capacity_ah,
        memory_steps: 500.0,
        initial_sd: 0.2,
        skew_s: 0.0,
    };
    let resistance = ResistanceEstimator::new(resistance, &model, dt).expect("an estimator");
    let limits = PowerParams {
        voltage_min_v: chemistry.empty_v(),
        voltage_max_v: 4.5,
        soc_min: 0.0,
        soc_max: 1.0,
        // 99.4 % of a Gaussian: each answer is judged.
        margin_sds: 2.5,
        horizons_s: HORIZONS_S,
        discharge_window: ANY,
        charge_window: ANY,
    };
    let limits = PowerLimits::new(limits, &model).expect("limits");

    let mut state = filter.start(soc, 0.02, celsius).expect("a start");
    filter.pause(&mut state, Some(7200.0));
    let mut socs = of_cells.start::<CELLS>(filter.estimate(&state));
    let mut of_each = resistances.start::<CELLS>();
    let mut of_mean = resistance.unknown();
    let mut health = Health::as_new(&model);
    let mut tally = Tally::default();
    let mut current_a = 0.0;
    for second in 0..DRIVEN_S {
        if second % 4 == 0 {
            current_a = capacity_ah * (0.25 + 0.5 * random.normal()).clamp(-0.6, 2.0);
        }
        let (mut cell_v, mut sum_v) = ([0.0; CELLS], 0.0);
        for (voltage_v, (battery, cell)) in cell_v.iter_mut().zip(&mut cells) {
            let out = battery.step(cell, MappedBatteryInput { current_a });
            *voltage_v = out.terminal_v + 0.001 * random.normal();
            sum_v += *voltage_v;
        }
        #[expect(clippy::cast_precision_loss, reason = "12")]
        let voltage_v = sum_v / CELLS as f32;
        let seen_a = current_a + 0.003 * capacity_ah * random.normal();
        let input = EkfInput {
            current_a: seen_a,
            voltage_v,
            temperature_c: celsius,
            contactors_open: false,
        };
        filter.step(&mut state, input);
        let mean = filter.estimate(&state);
        of_cells.step(&mut socs, CellsInput { pack: mean, cell_v: &cell_v, current_a: seen_a });
        resistances.step(&mut of_each, &cell_v, seen_a);
        let sample = ResistanceInput { voltage_v, current_a: seen_a, estimate: mean };
        let learnt = resistance.step(&mut of_mean, sample);
        (health.resistance_factor, health.resistance_factor_sd) = (learnt.factor, learnt.factor_sd);
        if second < LEARNT_S || second % ASKED_S != 0 {
            continue;
        }
        let allowed = limits.ahead_of_cells(&SeriesCells {
            mean,
            health,
            socs: &socs,
            resistances: &of_each,
        });
        let status = filter.status(&state);
        for ahead in allowed {
            let lowest_v = lowest_v(&cells, ahead.discharge.current_a, ahead.horizon_s);
            let beyond_v = (chemistry.empty_v() - lowest_v).max(0.0);
            // Nothing is wrong within three of these.
            let said = Said {
                value: f64::from(beyond_v),
                sd: f64::from(BEYOND_V) / 3.0,
                contradicted: false,
                outside_known: status.outside_identified,
            };
            tally.book(said, 0.0, f64::from(ASKED_S) + 1.0);
        }
    }
    tally
}

/// The lowest voltage of any cell over a time \[s\].
fn lowest_v(cells: &[Cell], current_a: f32, seconds: f32) -> f32 {
    let mut lowest_v = f32::MAX;
    for (battery, state) in cells {
        let (mut state, mut left_s) = (*state, seconds);
        while left_s > 0.0 {
            let out = battery.step(&mut state, MappedBatteryInput { current_a });
            lowest_v = lowest_v.min(out.terminal_v);
            left_s -= 1.0;
        }
    }
    lowest_v
}
