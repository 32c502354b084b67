//! The estimators of a battery management system, each part on its own: the filter's update and
//! what it leaves to a slower rate, the counter, the cells. Beside them a published filter.

use plant_core::battery::{MappedBattery, MappedBatteryInput, MappedBatteryState};
use plant_core::presets::PANASONIC_NCR18650PF as CELL;
use plant_core::{Dt, must};
use voltstep_bms::Estimate;
use voltstep_bms::estimate::cells::{Cells, CellsInput, CellsOutput, CellsParams, CellsState};
use voltstep_bms::estimate::coulomb::{
    CoulombCounter, CoulombInput, CoulombOutput, CoulombParams, CoulombState,
};
use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfOutput, EkfParams, EkfState, Uncertainty};

use crate::hprintln;
use crate::kalman::Kalman;

/// The time between two samples of the filter.
pub const SAMPLE: Dt = must!(Dt::from_s(0.1));
/// The voltage at half charge \[V\].
const NOMINAL_V: f32 = 3.65;
/// Cells of the pack.
pub const CELLS: usize = 18;
/// The temperature \[°C\].
pub const TEMPERATURE_C: f32 = 25.0;

/// The filter.
pub const EKF: Ekf = must!(Ekf::new(EkfParams::typical(CELL, NOMINAL_V), SAMPLE));
const KNOWN: Uncertainty = Uncertainty::typical(NOMINAL_V, CELL.capacity_ah);
/// The counter.
pub const COUNTER: CoulombCounter = must!(CoulombCounter::new(
    CoulombParams {
        capacity_ah: CELL.capacity_ah,
        capacity_sd_ah: KNOWN.capacity_sd * CELL.capacity_ah,
        charge_efficiency: 1.0,
        offset_sd_a: KNOWN.current_offset_sd_a,
        gain_sd: 0.005,
        largest_current_a: 30.0,
        open_circuit: CELL.open_circuit,
        rest_voltage_sd_v: KNOWN.open_circuit_sd_v,
        rest_current_a: 0.03,
        rest_s: 1800.0,
    },
    SAMPLE
));
/// What is known of the cells.
pub const KNOWN_OF_CELLS: CellsParams = CellsParams {
    open_circuit: CELL.open_circuit,
    noise_sd_v: 0.002,
    offset_sd_v: 0.002,
    resistance_sd_ohm: 0.003,
    capacity_sd: 0.02,
    soc_sd: 0.02,
    drift_sd_per_day: 0.001,
    pack_soc_sd_max: 0.2,
    voltage_min_v: 2.0,
    voltage_max_v: 4.5,
};
const OF_CELLS: Cells = must!(Cells::new(KNOWN_OF_CELLS, SAMPLE));

/// What the cells are shown: the pack's estimate, their voltages, the current.
pub type OfCells = (Estimate, [f32; CELLS], f32);

/// The filter without what is left to a slower rate.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_ekf_update(state: &mut EkfState, input: &EkfInput, out: &mut EkfOutput) {
    *out = EKF.update(state, input.current_a, input.voltage_v);
}

/// What it leaves.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_ekf_refresh(state: &mut EkfState, input: &EkfInput, _: &mut ()) {
    EKF.refresh(state, input);
}

/// The counter's count.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_counter_step(state: &mut CoulombState, input: &CoulombInput, _: &mut ()) {
    COUNTER.step(state, *input);
}

/// The counter's review, with the voltage.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_counter_review(
    state: &mut CoulombState,
    voltage_v: &f32,
    out: &mut CoulombOutput,
) {
    *out = COUNTER.review(state, *voltage_v);
}

/// Each of the cells.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_cells(
    state: &mut CellsState<CELLS>,
    (pack, cell_v, current_a): &OfCells,
    out: &mut CellsOutput,
) {
    *out = OF_CELLS.step(state, CellsInput { pack: *pack, cell_v, current_a: *current_a });
}

/// A published filter with the same two states, the same model and the same numbers.
#[unsafe(no_mangle)]
#[inline(never)]
pub extern "C" fn bench_kalman(state: &mut Kalman, input: &EkfInput, soc: &mut f32) {
    *soc = state.step(input.current_a, input.voltage_v);
}

/// All of them, on one cell that is driven like the car's pack.
pub struct Estimators {
    cell: MappedBatteryState,
    /// The filter.
    pub ekf: EkfState,
    /// The counter.
    pub counter: CoulombState,
    /// The cells.
    pub cells: CellsState<CELLS>,
    /// The published filter.
    pub kalman: Kalman,
    /// What the sensors show.
    pub input: EkfInput,
    /// What the cells are shown.
    pub of_cells: OfCells,
}

/// The cell.
const PLANT: MappedBattery = must!(MappedBattery::new(CELL, SAMPLE));

impl Estimators {
    /// Told a state of charge that is 10 % wrong.
    #[must_use]
    pub fn new() -> Option<Self> {
        let ekf = EKF.start(0.8, 0.1, TEMPERATURE_C).ok()?;
        let pack = EKF.estimate(&ekf);
        Some(Self {
            cell: PLANT.rested(0.9).ok()?,
            ekf,
            counter: CoulombState::known(0.8, 0.1),
            cells: OF_CELLS.start(pack),
            kalman: Kalman::new(0.8, 0.1),
            input: EkfInput {
                current_a: 0.0,
                voltage_v: 0.0,
                temperature_c: TEMPERATURE_C,
                contactors_open: false,
            },
            of_cells: (pack, [0.0; CELLS], 0.0),
        })
    }

    /// What the sensors show of the next sample.
    pub fn drive(&mut self, current_a: f32) {
        let voltage_v = PLANT.step(&mut self.cell, MappedBatteryInput { current_a }).terminal_v;
        (self.input.current_a, self.input.voltage_v) = (current_a, voltage_v);
        let (pack, cell_v, amps) = &mut self.of_cells;
        *pack = EKF.estimate(&self.ekf);
        *amps = current_a;
        for (volts, place) in cell_v.iter_mut().zip(0_u16..) {
            *volts = voltage_v + 0.001 * (f32::from(place) - 8.5);
        }
        self.kalman.follow(PLANT.resistances(self.kalman.soc(), TEMPERATURE_C));
    }

    /// Says how far each of the two filters is from the truth.
    pub fn say(&self) {
        let truth = self.cell.soc.get();
        hprintln!("error ekf {}", (self.ekf.soc() - truth).abs());
        hprintln!("error kalman {}", (self.kalman.soc() - truth).abs());
    }
}
