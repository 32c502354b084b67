//! The estimators of cells in series, tied together, in memory of the caller's.

use core::mem::MaybeUninit;

use voltstep_bms::estimate::cells::CellResistancesState;
use voltstep_bms::estimate::ekf::EkfMemory;
use voltstep_bms::estimate::energy::{EnergyInput, EnergyState};
use voltstep_bms::estimate::power::{PowerAhead, SeriesCells};
use voltstep_bms::estimate::series::{SeriesInput, SeriesState};
use voltstep_bms::{Estimate, Health};

use super::handle::{Models, VoltstepEstimators, models};
use super::params::VOLTSTEP_HORIZONS;
use super::power::VoltstepEnergyReport;
use super::record::{VoltstepRecord, elapsed};
use super::values::{VoltstepEstimate, VoltstepHealth, VoltstepPowerAhead};
use crate::handle::{
    answer, check, check_optional, check_ranges_apart, mark, read_from, write_optional, write_to,
};
use crate::status::VoltstepStatus;

/// Words (8 bytes) that cells in series take beside what each takes.
pub const VOLTSTEP_SERIES_WORDS: usize = 128;
/// Words (8 bytes) that each cell in series takes.
pub const VOLTSTEP_SERIES_WORDS_PER_CELL: usize = 4;

/// One sample of cells in series.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesInput {
    /// Current of one cell in A, positive when discharging; NaN where there is no usable reading.
    pub current_a: f32,
    /// Temperature in degC.
    pub temperature_c: f32,
    /// Other than 0: the contactors are open.
    pub contactors_open: u32,
}

/// What is believed of cells in series after a sample.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesOutputs {
    /// Of their mean, by the filter.
    pub estimate: VoltstepEstimate,
    /// The health of their mean.
    pub health: VoltstepHealth,
    /// State of charge of their mean by counting, a ratio 0..1.
    pub counted_soc: f32,
    /// Its standard deviation, a ratio.
    pub counted_soc_sd: f32,
    /// Lowest state of charge of a cell, a ratio 0..1.
    pub soc_min: f32,
    /// Highest state of charge of a cell, a ratio 0..1.
    pub soc_max: f32,
    /// Which cell has the lowest.
    pub soc_min_index: u32,
    /// Which cell has the highest.
    pub soc_max_index: u32,
    /// The filter's standard deviation is below the `converged_sd` of the parameters.
    pub converged: bool,
    /// The model's error, and the mean residual beside it, are of the size that is expected.
    pub consistent: bool,
    /// The open-circuit curve is flat here: the voltage does not correct.
    pub flat: bool,
    /// State of charge or temperature lie outside the identified range.
    pub outside_identified: bool,
    /// The temperature is not known; the last one holds.
    pub temperature_missing: bool,
}

/// What is believed of one cell in series.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltstepSeriesCell {
    /// State of charge, a ratio 0..1.
    pub soc: f32,
    /// Its standard deviation, a ratio.
    pub soc_sd: f32,
    /// Its resistance over the mean of all, a ratio.
    pub resistance_ratio: f32,
    /// Its standard deviation, a ratio.
    pub resistance_ratio_sd: f32,
    /// Its voltage said nothing in the last second.
    pub held: bool,
}

/// What the memory of so many cells begins with.
#[repr(C)]
#[derive(Clone, Copy)]
struct Head {
    mark: u32,
    cells: u32,
}

const MARK: u32 = mark::<Head>(10);

/// What is in it.
#[repr(C)]
struct Memory<const CELLS: usize> {
    head: Head,
    series: SeriesState<CELLS>,
    resistances: CellResistancesState<CELLS>,
    energy: EnergyState,
    /// Of the mean, at the last sample.
    estimate: Estimate,
}

/// What can be asked of them, whatever their number.
trait CellsInSeries {
    fn step(&mut self, models: &Models, input: VoltstepSeriesInput, cell_v: &[f32]);
    fn outputs(&self, models: &Models) -> VoltstepSeriesOutputs;
    fn cell(&self, index: usize) -> Option<VoltstepSeriesCell>;
    fn power(&self, models: &Models) -> [PowerAhead; VOLTSTEP_HORIZONS];
    fn energy(&self, models: &Models) -> Option<VoltstepEnergyReport>;
    fn record(&self, models: &Models) -> VoltstepRecord;
}

impl<const CELLS: usize> CellsInSeries for Memory<CELLS> {
    fn step(&mut self, models: &Models, input: VoltstepSeriesInput, cell_v: &[f32]) {
        let Ok(cell_v) = <&[f32; CELLS]>::try_from(cell_v) else { return };
        let VoltstepSeriesInput { current_a, temperature_c, contactors_open } = input;
        let contactors_open = contactors_open != 0;
        let sample = SeriesInput { cell_v, current_a, temperature_c, contactors_open };
        self.estimate = models.series.step(&mut self.series, sample);
        models.cell_resistances.step(&mut self.resistances, cell_v, current_a);
        let (sum_v, seen) = cell_v
            .iter()
            .filter(|v| v.is_finite())
            .fold((0.0, 0.0), |(sum_v, seen), v| (sum_v + v, seen + 1.0));
        // Without a voltage this is no number, and left out.
        let voltage_v = sum_v / seen;
        models.energy.step(&mut self.energy, EnergyInput { current_a, voltage_v });
    }

    fn outputs(&self, models: &Models) -> VoltstepSeriesOutputs {
        let (series, state) = (&models.series, &self.series);
        let (status, spread) = (series.filter.status(&state.filter), state.cells.spread());
        #[expect(clippy::cast_possible_truncation, reason = "below the number of cells")]
        let (min_index, max_index) = (spread.min_index as u32, spread.max_index as u32);
        VoltstepSeriesOutputs {
            estimate: self.estimate.into(),
            health: state.health.into(),
            counted_soc: series.counter.soc(&state.counter),
            counted_soc_sd: series.counter.soc_sd(&state.counter),
            soc_min: spread.min,
            soc_max: spread.max,
            soc_min_index: min_index,
            soc_max_index: max_index,
            converged: status.converged,
            consistent: status.consistent,
            flat: status.flat,
            outside_identified: status.outside_identified,
            temperature_missing: status.temperature_missing,
        }
    }

    fn cell(&self, index: usize) -> Option<VoltstepSeriesCell> {
        let soc = self.series.cells.cell(index)?;
        let (resistance_ratio, resistance_ratio_sd) = self.resistances.ratio(index)?;
        Some(VoltstepSeriesCell {
            soc: soc.soc,
            soc_sd: soc.soc_sd,
            resistance_ratio,
            resistance_ratio_sd,
            held: soc.held,
        })
    }

    fn power(&self, models: &Models) -> [PowerAhead; VOLTSTEP_HORIZONS] {
        models.power.ahead_of_cells(&SeriesCells {
            mean: self.estimate,
            health: self.series.health,
            socs: &self.series.cells,
            resistances: &self.resistances,
        })
    }

    fn energy(&self, models: &Models) -> Option<VoltstepEnergyReport> {
        let report = models.energy.report(&self.energy, &self.estimate, &self.series.health)?;
        Some(report.into())
    }

    fn record(&self, models: &Models) -> VoltstepRecord {
        VoltstepRecord::of(models.series.filter.remember(&self.series.filter), self.series.health)
    }
}

/// Calls a function for so many cells. Another number is one line here.
macro_rules! with_cells {
    ($cells:expr, $function:ident $arguments:tt, $other:expr) => {
        match $cells {
            1 => $function::<1> $arguments,
            4 => $function::<4> $arguments,
            12 => $function::<12> $arguments,
            18 => $function::<18> $arguments,
            96 => $function::<96> $arguments,
            _ => Err($other),
        }
    };
}

/// # Safety
/// `memory` is null or points to `words` words that may be written.
unsafe fn begin<const CELLS: usize>(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    words: u32,
    (start, health): (EkfMemory, Health),
    elapsed_s: Option<f32>,
    temperature_c: f32,
) -> Result<(), VoltstepStatus> {
    const {
        let words = VOLTSTEP_SERIES_WORDS + CELLS * VOLTSTEP_SERIES_WORDS_PER_CELL;
        assert!(size_of::<Memory<CELLS>>() <= 8 * words);
        assert!(align_of::<Memory<CELLS>>() <= align_of::<u64>());
    }
    check(memory)?;
    let needed = VOLTSTEP_SERIES_WORDS + CELLS * VOLTSTEP_SERIES_WORDS_PER_CELL;
    if (words as usize) < needed {
        return Err(VoltstepStatus::MemoryTooSmall);
    }
    check_ranges_apart(
        (estimators.addr(), size_of::<VoltstepEstimators>()),
        (memory.addr(), 8 * needed),
    )?;
    // SAFETY: as promised by the caller.
    let models = unsafe { models(estimators) }?;
    let series = models.series.resume::<CELLS>(start, health, elapsed_s, temperature_c)?;
    #[expect(clippy::cast_possible_truncation, reason = "at most 96")]
    let head = Head { mark: MARK, cells: CELLS as u32 };
    let made = Memory {
        head,
        estimate: models.series.filter.estimate(&series.filter),
        series,
        resistances: models.cell_resistances.start(),
        energy: EnergyState::default(),
    };
    // SAFETY: checked above, and large enough.
    unsafe { write_to(memory.cast(), made) }
}

/// # Safety
/// `memory` holds what [`begin`] wrote for so many cells, and nothing else uses it during `'a`.
#[expect(clippy::unnecessary_wraps, reason = "one of the arms of `with_cells`")]
unsafe fn these<'a, const CELLS: usize>(
    memory: *mut MaybeUninit<u64>,
) -> Result<&'a mut dyn CellsInSeries, VoltstepStatus> {
    // SAFETY: as promised by the caller.
    Ok(unsafe { &mut *memory.cast::<Memory<CELLS>>() })
}

/// What is in the memory of cells in series, and how many they are.
///
/// # Safety
/// `memory` is null, or points to words that nothing else uses during `'a`; where it carries the
/// mark, `voltstep_series_start` wrote it.
unsafe fn opened<'a>(
    memory: *mut MaybeUninit<u64>,
) -> Result<(&'a mut dyn CellsInSeries, u32), VoltstepStatus> {
    check(memory)?;
    // SAFETY: not null, aligned, readable by the caller's promise; any bytes are a head.
    let head = unsafe { memory.cast::<Head>().read() };
    if head.mark != MARK {
        return Err(VoltstepStatus::StateNotInitialised);
    }
    // SAFETY: the mark says that it was written for so many cells.
    let cells =
        unsafe { with_cells!(head.cells, these(memory), VoltstepStatus::StateNotInitialised) }?;
    Ok((cells, head.cells))
}

/// Starts the estimators of cells in series, 1, 4, 12, 18 or 96 of them, in `memory`: an array of
/// `words`, at least `VOLTSTEP_SERIES_WORDS + cells * VOLTSTEP_SERIES_WORDS_PER_CELL`, which a copy
/// of it may take the place of. `record` is what was remembered `elapsed_s` seconds ago (NaN: nobody
/// knows); null: nothing is known. At a temperature in degC (-100..200).
///
/// # Safety
/// Each pointer is null or points to an object of its type; `record` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_start(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    words: u32,
    cells: u32,
    record: *const VoltstepRecord,
    elapsed_s: f32,
    temperature_c: f32,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let remembered = if record.is_null() {
                let filter = &m.series.filter;
                let unknown = filter.remember(&filter.start_unknown(temperature_c)?);
                (EkfMemory { polarisation: None, ..unknown }, m.unlearnt)
            } else {
                read_from(record)?.remembered()?
            };
            let ago = if record.is_null() { Some(0.0) } else { elapsed(elapsed_s) };
            with_cells!(
                cells,
                begin(estimators, memory, words, remembered, ago, temperature_c),
                VoltstepStatus::CellCount
            )
        })
    })
}

/// One sample of cells in series: `cell_v` is an array of `cells` voltages in V, as many as at the
/// start; NaN where there is no usable reading. `outputs` may be null. Once a second it takes
/// longer: every cell, the counter's review, what was learnt goes where it is used.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call;
/// `input` and `cell_v` are set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_step(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    input: *const VoltstepSeriesInput,
    cell_v: *const f32,
    cells: u32,
    outputs: *mut VoltstepSeriesOutputs,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check_optional(outputs).and(check(cell_v))?;
            let input = read_from(input)?;
            let (state, count) = opened(memory)?;
            if cells != count {
                return Err(VoltstepStatus::CellCount);
            }
            state.step(m, input, core::slice::from_raw_parts(cell_v, cells as usize));
            if outputs.is_null() { Ok(()) } else { write_optional(outputs, state.outputs(m)) }
        })
    })
}

/// What is believed of one of the cells in series, the first of them 0.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_cell(
    memory: *mut MaybeUninit<u64>,
    index: u32,
    cell: *mut VoltstepSeriesCell,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        opened(memory).and_then(|(state, _)| {
            let found = state.cell(index as usize).ok_or(VoltstepStatus::CellIndex)?;
            write_to(cell, found)
        })
    })
}

/// What the cells in series allow, for the limits of one cell: fills `limits`, an array of
/// `VOLTSTEP_HORIZONS`; current as it is, power of one cell. A matter for once a second.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_power(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    limits: *mut VoltstepPowerAhead,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            check(limits)?;
            write_to(
                limits.cast::<[VoltstepPowerAhead; VOLTSTEP_HORIZONS]>(),
                opened(memory)?.0.power(m).map(Into::into),
            )
        })
    })
}

/// What is left in the mean of cells in series, in the units of one cell.
/// `VOLTSTEP_STATUS_INPUT_REJECTED` says that the estimate was not finite; the report is not written
/// then.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_energy(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    report: *mut VoltstepEnergyReport,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| {
            let found = opened(memory)?.0.energy(m).ok_or(VoltstepStatus::InputRejected)?;
            write_to(report, found)
        })
    })
}

/// Fills `record` with what is worth keeping of cells in series; throughput, time and what follows
/// are left at 0.
///
/// # Safety
/// Each pointer is null or points to objects of its type that nobody else uses during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn voltstep_series_record(
    estimators: *const VoltstepEstimators,
    memory: *mut MaybeUninit<u64>,
    record: *mut VoltstepRecord,
) -> VoltstepStatus {
    // SAFETY: as promised by the caller; whether they can be used is checked inside.
    answer(unsafe {
        models(estimators).and_then(|m| write_to(record, opened(memory)?.0.record(m)))
    })
}
