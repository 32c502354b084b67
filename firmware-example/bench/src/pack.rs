//! What is learnt and looked ahead: health, energy, state of power, and all estimators of 96 cells in
//! series, tied together.

use plant_core::battery::MappedBattery;
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use plant_core::{Dt, must};
use voltstep_bms::estimate::cells::{
    CellResistanceParams, CellResistances, CellResistancesState, Cells,
};
use voltstep_bms::estimate::ekf::{EkfInput, EkfMemory};
use voltstep_bms::estimate::energy::{
    DISCHARGES, EnergyGauge, EnergyInput, EnergyParams, EnergyReport, EnergyState, EnergyWalk,
};
use voltstep_bms::estimate::power::{
    HORIZONS, HORIZONS_S, PowerAhead, PowerLimits, PowerParams, PowerWalk, SLICES_OF_CELLS,
    SeriesCells, TemperatureWindow,
};
use voltstep_bms::estimate::series::{Series, SeriesInput, SeriesState};
use voltstep_bms::estimate::soh::{
    CapacityEstimator, CapacityInput, CapacityOutput, CapacityParams, CapacityState,
    ResistanceEstimator, ResistanceInput, ResistanceOutput, ResistanceParams, ResistanceState,
};
use voltstep_bms::{Estimate, Health};

use crate::estimators::{COUNTER, EKF, Estimators, KNOWN_OF_CELLS, SAMPLE, TEMPERATURE_C};
use crate::stack::Stack;
use crate::{call, hprintln};

/// Cells of a car's pack.
pub const CELLS: usize = 96;
/// Samples in a second.
const PER_SECOND: u32 = 10;
const SECOND: Dt = must!(Dt::from_s(1.0));

const BATTERY: MappedBattery = must!(MappedBattery::new(CELL, SAMPLE));
const RESISTANCE: ResistanceEstimator = must!(ResistanceEstimator::new(
    ResistanceParams {
        voltage_sd_v: 0.001,
        current_sd_a: 0.01,
        least_step_a: 0.5,
        memory_steps: 500.0,
        initial_sd: 0.5,
        skew_s: 0.0,
    },
    &BATTERY,
    SAMPLE
));
const CAPACITY: CapacityEstimator = must!(CapacityEstimator::new(
    CapacityParams {
        nominal_ah: CELL.capacity_ah,
        nominal_sd_ah: 0.15 * CELL.capacity_ah,
        current_noise_sd_a: 0.01,
        current_offset_sd_a: 0.005,
        current_gain_sd: 0.003,
        least_soc_change: 0.2,
        least_soc_change_sds: 10.0,
        memory_pairs: 50.0,
    },
    SAMPLE
));
const GAUGE: EnergyGauge = must!(EnergyGauge::new(
    EnergyParams { empty_soc: 0.05, full_soc: 1.0, empty_v: 2.8, least_a: 0.01 },
    &BATTERY,
    SAMPLE
));
const WINDOW: TemperatureWindow = TemperatureWindow {
    none_below_c: -30.0,
    all_from_c: -20.0,
    all_to_c: 45.0,
    none_above_c: 60.0,
};
const LIMITS: PowerLimits = must!(PowerLimits::new(
    PowerParams {
        voltage_min_v: 2.5,
        voltage_max_v: 4.2,
        soc_min: 0.02,
        soc_max: 0.98,
        margin_sds: 2.0,
        horizons_s: HORIZONS_S,
        discharge_window: WINDOW,
        charge_window: WINDOW,
    },
    &BATTERY
));
const OF_EACH: CellResistances = must!(CellResistances::new(CellResistanceParams {
    resistance_ohm: 0.03,
    spread_sd: 0.1,
    noise_sd_v: 0.002,
    least_step_a: 0.5,
    memory_steps: 500.0,
}));
const SERIES: Series = Series {
    filter: EKF,
    counter: COUNTER,
    cells: must!(Cells::new(KNOWN_OF_CELLS, SECOND)),
    resistance: RESISTANCE,
    capacity: CAPACITY,
    per_second: PER_SECOND,
    dt_s: SAMPLE.s(),
};

/// What is believed, and of a battery in which health.
pub type Known = (Estimate, Health);

/// What is believed of all cells.
pub struct OfCells {
    mean: Known,
    /// All but their resistances.
    pub socs: SeriesState<CELLS>,
    /// Their resistances.
    pub resistances: CellResistancesState<CELLS>,
}

impl OfCells {
    fn series(&self) -> SeriesCells<'_, CELLS> {
        let (mean, health) = self.mean;
        SeriesCells { mean, health, socs: &self.socs.cells, resistances: &self.resistances }
    }
}

/// The resistance: each sample.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_resistance(
    state: &mut ResistanceState,
    input: &ResistanceInput,
    out: &mut ResistanceOutput,
) {
    *out = RESISTANCE.step(state, *input);
}

/// The capacity: each pair of rests.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_capacity(
    state: &mut CapacityState,
    input: &CapacityInput,
    out: &mut CapacityOutput,
) {
    *out = CAPACITY.step(state, *input);
}

/// The averages behind the energy left: each sample.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_energy_step(state: &mut EnergyState, input: &EnergyInput, out: &mut bool) {
    *out = GAUGE.step(state, *input);
}

/// The energy left.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_energy_report(
    state: &mut EnergyState,
    (estimate, health): &Known,
    out: &mut Option<EnergyReport>,
) {
    *out = GAUGE.report(state, estimate, health);
}

/// A slice of it: one discharge.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_energy_walk(
    (walk, state): &mut (EnergyWalk, EnergyState),
    (estimate, health): &Known,
    out: &mut Option<EnergyReport>,
) {
    *out = GAUGE.walk(walk, state, estimate, health);
}

/// State of power, all horizons and directions at once.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_power_ahead(
    _: &mut (),
    (estimate, health): &Known,
    out: &mut [PowerAhead; HORIZONS],
) {
    *out = LIMITS.ahead(estimate, health);
}

/// One horizon and direction of it.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_power_walk(
    state: &mut PowerWalk,
    (estimate, health): &Known,
    out: &mut Option<[PowerAhead; HORIZONS]>,
) {
    *out = LIMITS.walk(state, estimate, health);
}

/// The same of cells in series.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_power_cells(_: &mut (), cells: &OfCells, out: &mut [PowerAhead; HORIZONS]) {
    *out = LIMITS.ahead_of_cells(&cells.series());
}

/// A slice of it.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_power_cells_walk(
    state: &mut PowerWalk,
    cells: &OfCells,
    out: &mut Option<[PowerAhead; HORIZONS]>,
) {
    *out = LIMITS.walk_of_cells(state, &cells.series());
}

/// The resistance of each cell: each sample.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_cell_resistances(
    state: &mut CellResistancesState<CELLS>,
    (cell_v, current_a): &([f32; CELLS], f32),
    out: &mut bool,
) {
    *out = OF_EACH.step(state, cell_v, *current_a);
}

/// All estimators of cells in series.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_series(
    state: &mut SeriesState<CELLS>,
    (cell_v, current_a): &([f32; CELLS], f32),
    out: &mut Estimate,
) {
    *out = SERIES.step(
        state,
        SeriesInput {
            cell_v,
            current_a: *current_a,
            temperature_c: TEMPERATURE_C,
            contactors_open: false,
        },
    );
}

/// All of them, on what the other estimators see.
pub struct Learnt {
    /// The resistance.
    pub resistance: ResistanceState,
    /// The capacity.
    pub capacity: CapacityState,
    /// The averages.
    pub energy: EnergyState,
    /// How far what is left has been worked out, from averages as they were.
    pub energy_walk: (EnergyWalk, EnergyState),
    /// How far the limits have come, of one cell and of all.
    pub walks: [PowerWalk; 2],
    /// What is believed of one cell.
    pub known: Known,
    /// What is believed of all.
    pub of_cells: OfCells,
    /// What the resistance is shown.
    pub sample: ResistanceInput,
    /// What flows.
    pub flow: EnergyInput,
    /// What the cells are shown.
    pub cell_v: ([f32; CELLS], f32),
}

const HEALTH: Health = Health {
    capacity_ah: CELL.capacity_ah,
    capacity_sd_ah: 0.15 * CELL.capacity_ah,
    resistance_factor: 1.0,
    resistance_factor_sd: 0.2,
};

/// The estimators of cells in series at a state of charge.
fn resumed(soc: f32, temperature_c: f32) -> Option<SeriesState<CELLS>> {
    let memory = EkfMemory {
        soc,
        soc_sd: 0.02,
        polarisation: None,
        current_offset_a: 0.0,
        current_offset_sd_a: 0.01,
    };
    SERIES.resume(memory, HEALTH, Some(0.0), temperature_c).ok()
}

impl Learnt {
    /// Nothing learnt yet.
    #[must_use]
    pub fn new() -> Option<Self> {
        let mean = Estimate::rested(0.8, 0.1, TEMPERATURE_C);
        let known = (mean, HEALTH);
        Some(Self {
            resistance: RESISTANCE.unknown(),
            capacity: CAPACITY.unknown(),
            energy: EnergyState::default(),
            energy_walk: (EnergyWalk::START, EnergyState::default()),
            walks: [PowerWalk::START; 2],
            known,
            of_cells: OfCells {
                mean: known,
                socs: resumed(0.8, TEMPERATURE_C)?,
                resistances: OF_EACH.start(),
            },
            sample: ResistanceInput { voltage_v: 0.0, current_a: 0.0, estimate: mean },
            flow: EnergyInput { current_a: 0.0, voltage_v: 0.0 },
            cell_v: ([0.0; CELLS], 0.0),
        })
    }

    /// What is seen of the next sample.
    pub fn see(&mut self, others: &Estimators) {
        let EkfInput { current_a, voltage_v, .. } = others.input;
        let estimate = EKF.estimate(&others.ekf);
        self.sample = ResistanceInput { voltage_v, current_a, estimate };
        self.flow = EnergyInput { current_a, voltage_v };
        self.known.0 = estimate;
        let (cell_v, amps) = &mut self.cell_v;
        *amps = current_a;
        for (volts, place) in cell_v.iter_mut().zip(0_u16..) {
            *volts = voltage_v + 0.0002 * (f32::from(place) - 47.5);
        }
        self.of_cells.mean = (SERIES.filter.estimate(&self.of_cells.socs.filter), HEALTH);
    }

    /// Says how far the resistance is from that of the battery.
    pub fn say(&self) {
        let known = RESISTANCE.step(&mut self.resistance.clone(), self.sample);
        hprintln!("error resistance {}", (known.factor - 1.0).abs());
    }
}

/// The stacks of what is worked out rarely.
pub struct Rare<'a> {
    /// Of the capacity.
    pub capacity: &'a mut Stack,
    /// Of the energy left, at once and in slices.
    pub energy: [&'a mut Stack; 2],
    /// Of the limits of one cell, at once and in slices.
    pub power: [&'a mut Stack; 2],
    /// Of those of all, likewise.
    pub cells: [&'a mut Stack; 2],
}

/// From nearly empty to nearly full, cold to hot, new and aged, polarised either way: what UDDS does
/// not come to. And pairs of rests: that agree, that contradict, that contradict alike.
pub fn everywhere(learnt: &mut Learnt, stacks: Rare) -> Option<()> {
    let Rare { capacity, energy: [report, a_discharge], power: [at_once, in_slices], cells } =
        stacks;
    let [cells_at_once, cells_in_slices] = cells;
    for celsius in [-25.0, -10.0, 0.0, 25.0, 44.0] {
        for soc in [0.03, 0.1, 0.3, 0.6, 0.95] {
            for (factor, polarisation_v) in [(1.0, 0.02), (2.0, -0.02)] {
                let estimate = Estimate {
                    polarisation_v: [polarisation_v; 2],
                    ..Estimate::rested(soc, 0.01, celsius)
                };
                learnt.known = (estimate, Health { resistance_factor: factor, ..HEALTH });
                let known = &learnt.known;
                call!(report, bench_energy_report, &mut learnt.energy, known);
                for _ in 0..DISCHARGES {
                    call!(a_discharge, bench_energy_walk, &mut learnt.energy_walk, known);
                }
                call!(at_once, bench_power_ahead, &mut (), known);
                for _ in 0..2 * HORIZONS {
                    call!(in_slices, bench_power_walk, &mut learnt.walks[0], known);
                }
                learnt.of_cells.mean = learnt.known;
                learnt.of_cells.socs = resumed(soc, celsius)?;
                call!(cells_at_once, bench_power_cells, &mut (), &learnt.of_cells);
                for _ in 0..SLICES_OF_CELLS {
                    let walk = &mut learnt.walks[1];
                    call!(cells_in_slices, bench_power_cells_walk, walk, &learnt.of_cells);
                }
            }
        }
    }
    let rested = |soc| Estimate::rested(soc, 0.01, TEMPERATURE_C);
    for ah in [2.9, 2.8, 2.9, 2.0, 2.0, 2.05, 3.5, 2.1, 2.9, 2.95] {
        let pair = CapacityInput {
            start: rested(0.9),
            end: rested(0.2),
            discharged_ah: 0.7 * ah,
            duration_s: 7200.0,
        };
        call!(capacity, bench_capacity, &mut learnt.capacity, &pair);
    }
    Some(())
}
