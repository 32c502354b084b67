//! The memory of cells in series, the caller's: so many words for so many cells.

use core::mem::MaybeUninit;

use voltstep_bms::estimate::cells::CellResistancesState;
use voltstep_bms::estimate::ekf::EkfMemory;
use voltstep_bms::estimate::energy::{EnergyInput, EnergyState};
use voltstep_bms::estimate::power::{PowerAhead, PowerWalk, SeriesCells};
use voltstep_bms::estimate::series::{SeriesInput, SeriesState};
use voltstep_bms::{Estimate, Health};

use super::handle::{Models, VoltstepEstimators, models};
use super::params::VOLTSTEP_HORIZONS;
use super::power::VoltstepEnergyReport;
use super::record::VoltstepRecord;
use super::values::{VoltstepSeriesCell, VoltstepSeriesInput, VoltstepSeriesOutputs};
use crate::handle::{check, check_ranges_apart, mark, write_to};
use crate::status::VoltstepStatus;

/// Words (8 bytes) that cells in series take beside what each takes.
pub const VOLTSTEP_SERIES_WORDS: usize = 112;
/// Words (8 bytes) that each cell in series takes.
pub const VOLTSTEP_SERIES_WORDS_PER_CELL: usize = 4;

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

impl<const CELLS: usize> Memory<CELLS> {
    fn believed(&self) -> SeriesCells<'_, CELLS> {
        SeriesCells {
            mean: self.estimate,
            health: self.series.health,
            socs: &self.series.cells,
            resistances: &self.resistances,
        }
    }
}

/// What can be asked of them, whatever their number.
pub(super) trait CellsInSeries {
    fn step(&mut self, models: &Models, input: VoltstepSeriesInput, cell_v: &[f32]);
    fn outputs(&self, models: &Models) -> VoltstepSeriesOutputs;
    fn cell(&self, index: usize) -> Option<VoltstepSeriesCell>;
    fn power(&self, models: &Models) -> [PowerAhead; VOLTSTEP_HORIZONS];
    fn walk(
        &self,
        models: &Models,
        walk: &mut PowerWalk,
    ) -> Option<[PowerAhead; VOLTSTEP_HORIZONS]>;
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
        models.power.ahead_of_cells(&self.believed())
    }

    fn walk(
        &self,
        models: &Models,
        walk: &mut PowerWalk,
    ) -> Option<[PowerAhead; VOLTSTEP_HORIZONS]> {
        models.power.walk_of_cells(walk, &self.believed())
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

/// Writes the state of so many cells.
///
/// # Safety
/// `memory` is null or points to `words` words that may be written.
pub(super) unsafe fn begin(
    cells: u32,
    estimators: *const VoltstepEstimators,
    (memory, words): (*mut MaybeUninit<u64>, u32),
    remembered: (EkfMemory, Health),
    elapsed_s: Option<f32>,
    temperature_c: f32,
) -> Result<(), VoltstepStatus> {
    // SAFETY: as promised by the caller.
    unsafe {
        with_cells!(
            cells,
            begin_with(estimators, (memory, words), remembered, elapsed_s, temperature_c),
            VoltstepStatus::CellCount
        )
    }
}

/// # Safety
/// As for [`begin`].
unsafe fn begin_with<const CELLS: usize>(
    estimators: *const VoltstepEstimators,
    (memory, words): (*mut MaybeUninit<u64>, u32),
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
pub(super) unsafe fn opened<'a>(
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
