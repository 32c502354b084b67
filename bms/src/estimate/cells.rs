//! State of charge of each cell: that of the pack, and by how much the cell differs.
//!
//! Bar-delta filtering \[Plett2009; Plett2016, ch. 4\]: the pack's estimate follows the mean
//! of the cells, and for each cell a scalar Kalman filter reads from its voltage's deviation from
//! the mean the difference of its state of charge, `v − v̄ = OCV(s̄ + δ) − OCV(s̄)`.
//!
//! What stays wrong in a cell (offset, resistance, capacity) is considered, not estimated
//! \[Schmidt1966\]. That a bend of the curve counts as noise is ours.
//!
//! Tests: `tests` below; `tests/tests/bms_pack/cells.rs` and `finite.rs`.

use core::hint::cold_path;

use plant_core::error::{above, positive, ratio};
use plant_core::num::{clamp, sane, sound};
use plant_core::{Dt, ParamError, Real, check};

use crate::estimate::curve::{INTERVALS, Tangents, as_table};
use crate::{Estimate, Health};

mod params;
mod resistance;
mod spread;

pub use params::CellsParams;
use params::{SMALLEST_NOISE_V, cell_v, noise_variances};
pub use resistance::{CellResistanceParams, CellResistances, CellResistancesState};
pub use spread::{BLED_SD, CellSoc, SocSpread};

/// How far each cell's state of charge lies from the pack's.
///
/// Where the open-circuit curve is flat the gain is zero by itself: the cell is held there.
///
/// A voltage offset, a larger resistance, a smaller capacity are not noise: they stay, and a
/// filter that averages them away believes what it cannot know. Each is a quantity that is not
/// estimated but whose correlation with the estimate is kept \[Schmidt1966\], so the standard
/// deviation never falls below what they leave open.
///
/// The filter reads the curve by its tangent. Where the curve bends within reach of what a cell may
/// differ by, the tangent's own error counts as noise, so a knee is believed once it is passed.
///
/// ```
/// use plant_core::battery::OpenCircuit;
/// use plant_core::must;
/// use voltstep_bms::estimate::cells::{Cells, CellsInput, CellsParams};
/// use voltstep_bms::{Dt, Estimate};
///
/// const CELLS: Cells = must!(Cells::new(
///     CellsParams {
///         open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
///         noise_sd_v: 0.002,
///         offset_sd_v: 0.003,
///         resistance_sd_ohm: 0.000_1,
///         capacity_sd: 0.01,
///         soc_sd: 0.02,
///         drift_sd_per_day: 0.001,
///         pack_soc_sd_max: 0.05,
///         voltage_min_v: 2.0,
///         voltage_max_v: 4.5,
///     },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let pack = Estimate::rested(0.6, 0.01, 25.0);
/// let mut state = CELLS.start::<3>(pack);
/// for _ in 0..300 {
///     let cell_v = [3.66, 3.70, 3.68]; // 20 mV apart at rest
///     CELLS.step(&mut state, CellsInput { pack, cell_v: &cell_v, current_a: 0.0 });
/// }
/// let spread = state.spread();
/// assert_eq!((spread.min_index, spread.max_index), (0, 1));
/// assert!((spread.max - spread.min - 0.04 / 1.2).abs() < 2e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    tangents: Tangents,
    /// In each interval of the curve, the noise and what the tangent there is wrong by \[V²\].
    noise_variances: [Real; INTERVALS],
    offset_sd_v: Real,
    resistance_sd_ohm: Real,
    capacity_sd: Real,
    soc_variance: Real,
    /// What drift adds to the variance in a step.
    drift_variance: Real,
    pack_soc_sd_max: Real,
    /// Half the range of a cell's voltage, and its middle.
    half_range_v: Real,
    middle_v: Real,
}

/// What is believed of one cell: `error = √variance·w + offset·u₁ + resistance·u₂ + capacity·u₃`
/// with independent w, u of unit variance. In this form rounding cannot make a variance negative.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
struct Cell {
    /// State of charge above that of the pack.
    soc: Real,
    /// Variance that more measurements reduce.
    variance: Real,
    /// What one standard deviation of the cell's own offset, resistance and capacity makes of it.
    of_offset: Real,
    of_resistance: Real,
    of_capacity: Real,
    held: bool,
}

/// The state of [`Cells`]; [`Cells::start`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct CellsState<const CELLS: usize> {
    pack_soc: Real,
    pack_soc_sd: Real,
    /// As of the last step, the cells' mean above the pack: of the open-circuit voltages, which
    /// differ where the curve bends, and of what is believed of the states of charge.
    bend_v: Real,
    mean_soc: Real,
    /// What the held cells leave open of the others' mean, as a variance.
    others_variance: Real,
    /// The resistances, and with them their spread, are larger by this factor.
    resistance_factor: Real,
    /// How many cells are held; where none is, what the cells say of it is old.
    held: usize,
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    cells: [Cell; CELLS],
}

/// Input of one step of [`Cells`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellsInput<'a, const CELLS: usize> {
    /// What is believed of the pack's cells in the mean.
    pub pack: Estimate,
    /// The cells' voltages \[V\]; NaN where there is no usable reading.
    pub cell_v: &'a [Real; CELLS],
    /// Pack current \[A\]; NaN where there is no usable reading: then every cell is held.
    pub current_a: Real,
}

/// Output of one step of [`Cells`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CellsOutput {
    /// How many cells were held.
    pub held: usize,
    /// The pack's estimate was not finite or not in 0..1: the last one was kept.
    pub rejected: bool,
}

const SECONDS_PER_DAY: Real = 86_400.0;

impl Cells {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the field and the rule that it broke.
    pub const fn new(params: CellsParams, dt: Dt) -> Result<Self, ParamError> {
        let noise_sd_v = check!(ratio("cells.noise_sd_v", params.noise_sd_v));
        if noise_sd_v < SMALLEST_NOISE_V {
            return Err(ParamError::OutOfRange("cells.noise_sd_v"));
        }
        let soc_sd = check!(ratio("cells.soc_sd", check!(positive("cells.soc_sd", params.soc_sd))));
        let drift = check!(ratio("cells.drift_sd_per_day", params.drift_sd_per_day));
        let min_v = check!(cell_v("cells.voltage_min_v", params.voltage_min_v));
        let max_v = check!(cell_v("cells.voltage_max_v", params.voltage_max_v));
        check!(above("cells.voltage_max_v", max_v, min_v));
        let curve = check!(as_table("cells.open_circuit", params.open_circuit));
        let [empty_v, .., full_v] = curve.values();
        check!(cell_v("cells.open_circuit", *empty_v));
        check!(cell_v("cells.open_circuit", *full_v));
        Ok(Self {
            tangents: Tangents::of(&curve),
            noise_variances: noise_variances(&curve, noise_sd_v, soc_sd, dt),
            offset_sd_v: check!(ratio("cells.offset_sd_v", params.offset_sd_v)),
            resistance_sd_ohm: check!(ratio("cells.resistance_sd_ohm", params.resistance_sd_ohm)),
            capacity_sd: check!(ratio("cells.capacity_sd", params.capacity_sd)),
            soc_variance: soc_sd * soc_sd,
            drift_variance: drift * drift / SECONDS_PER_DAY * dt.s(),
            pack_soc_sd_max: check!(ratio("cells.pack_soc_sd_max", params.pack_soc_sd_max)),
            half_range_v: 0.5 * (max_v - min_v),
            middle_v: 0.5 * (max_v + min_v),
        })
    }

    /// Cells of which nothing is known but the pack they are in.
    #[must_use]
    pub fn start<const CELLS: usize>(&self, pack: Estimate) -> CellsState<CELLS> {
        let cell = Cell {
            soc: 0.0,
            variance: self.soc_variance,
            of_offset: 0.0,
            of_resistance: 0.0,
            of_capacity: 0.0,
            held: true,
        };
        let (pack_soc, pack_soc_sd) =
            if believable(&pack) { (pack.soc, pack.soc_sd) } else { (0.5, 1.0) };
        CellsState {
            pack_soc,
            pack_soc_sd,
            bend_v: 0.0,
            mean_soc: 0.0,
            others_variance: 0.0,
            resistance_factor: 1.0,
            held: CELLS,
            cells: [cell; CELLS],
        }
    }

    /// Takes over what was learnt of the resistances' mean: cells that have aged differ by as much
    /// more. What is not finite or not above zero is not taken.
    pub fn adopt<const CELLS: usize>(&self, state: &mut CellsState<CELLS>, health: &Health) {
        let factor = health.resistance_factor;
        if sane(factor) && factor > 0.0 {
            state.resistance_factor = factor;
        }
    }

    /// Advances by one step: brings every cell up to the pack's estimate, and those that are
    /// measured up to their voltages.
    pub fn step<const CELLS: usize>(
        &self,
        state: &mut CellsState<CELLS>,
        input: CellsInput<CELLS>,
    ) -> CellsOutput {
        let rejected = !believable(&input.pack);
        let old_soc = state.pack_soc;
        if !rejected {
            (state.pack_soc, state.pack_soc_sd) = (input.pack.soc, input.pack.soc_sd);
        }
        let usable =
            !rejected && sane(input.current_a) && state.pack_soc_sd <= self.pack_soc_sd_max;
        let seen = Seen {
            pack_soc: state.pack_soc,
            of_capacity: self.capacity_sd * (state.pack_soc - old_soc),
            mean_soc: state.mean_soc,
            base_v: 0.0,
            resistance_v: self.resistance_sd_ohm * state.resistance_factor * input.current_a,
        };
        let (_, pack_v, _) = self.tangents.at(state.pack_soc);
        match self.mean_of_all(input.cell_v) {
            Some(mean_v) if usable => {
                let seen = Seen { base_v: mean_v - pack_v - state.bend_v, ..seen };
                let (mut sum_v, mut sum_soc) = (0.0, 0.0);
                for (cell, voltage_v) in state.cells.iter_mut().zip(input.cell_v) {
                    sum_v += self.correct(cell, &seen, *voltage_v);
                    sum_soc += cell.soc;
                }
                state.bend_v = sum_v / real(CELLS) - pack_v;
                state.mean_soc = sum_soc / real(CELLS);
                (state.others_variance, state.held) = (0.0, 0);
            }
            _ => self.correct_some(state, &seen, input.cell_v, usable),
        }
        CellsOutput { held: state.held, rejected }
    }

    /// Corrects those cells whose voltage is plausible, so that with the held ones their mean is
    /// the pack's.
    #[cold]
    #[inline(never)]
    fn correct_some<const CELLS: usize>(
        &self,
        state: &mut CellsState<CELLS>,
        seen: &Seen,
        cell_v: &[Real; CELLS],
        usable: bool,
    ) {
        let (mut sum_v, mut expected_sum_v, mut count) = (0.0, 0.0, 0.0);
        let (mut sum_soc, mut held_variance) = (0.0, 0.0);
        for (cell, voltage_v) in state.cells.iter().zip(cell_v) {
            sum_soc += cell.soc;
            if usable && self.plausible(*voltage_v) {
                expected_sum_v += self.tangents.at(seen.pack_soc + cell.soc).1;
                sum_v += voltage_v;
                count += 1.0;
            } else {
                held_variance += cell.soc_variance();
            }
        }
        let (mut seen, left_open) = (*seen, state.others_variance);
        if count > 0.0 {
            seen.base_v = (sum_v - expected_sum_v) / count;
            seen.mean_soc = sum_soc / count;
            state.bend_v = expected_sum_v / count - self.tangents.at(seen.pack_soc).1;
            state.mean_soc = 0.0;
            state.others_variance = held_variance / (count * count);
        }
        state.held = 0;
        for (cell, voltage_v) in state.cells.iter_mut().zip(cell_v) {
            if usable && self.plausible(*voltage_v) {
                self.correct(cell, &seen, *voltage_v);
                cell.held = false;
            } else {
                cell.variance += self.drift_variance + if cell.held { 0.0 } else { left_open };
                cell.of_capacity += seen.of_capacity;
                cell.held = true;
                state.held += 1;
            }
        }
    }

    #[inline]
    const fn plausible(&self, voltage_v: Real) -> bool {
        (voltage_v - self.middle_v).abs() <= self.half_range_v
    }

    /// The mean of the voltages \[V\]; `None` where there is none or one is not plausible.
    #[inline]
    fn mean_of_all<const CELLS: usize>(&self, cell_v: &[Real; CELLS]) -> Option<Real> {
        let mut sum_v = 0.0;
        for voltage_v in cell_v {
            if !self.plausible(*voltage_v) {
                return None;
            }
            sum_v += voltage_v;
        }
        (CELLS > 0).then(|| sum_v / real(CELLS))
    }

    /// The Kalman filter's step of one cell; the open-circuit voltage that was expected of it.
    #[inline]
    fn correct(&self, cell: &mut Cell, seen: &Seen, voltage_v: Real) -> Real {
        // The pack's state of charge is the cells' mean, so theirs above it is none.
        let soc = cell.soc - seen.mean_soc;
        let (interval, expected_v, slope_v) = self.tangents.at(seen.pack_soc + soc);
        let noise_variance = self.noise_variances[interval];
        let (soc_variance, of_capacity) =
            (cell.variance + self.drift_variance, cell.of_capacity + seen.of_capacity);
        // What one standard deviation of each makes of the voltage that is not expected.
        let offset_v = slope_v * cell.of_offset + self.offset_sd_v;
        let resistance_v = slope_v * cell.of_resistance + seen.resistance_v;
        let covariance = slope_v * (soc_variance + of_capacity * of_capacity)
            + cell.of_offset * offset_v
            + cell.of_resistance * resistance_v;
        let variance = slope_v * covariance
            + self.offset_sd_v * offset_v
            + seen.resistance_v * resistance_v
            + noise_variance;
        let gain = covariance / variance;
        let kept = 1.0 - gain * slope_v;
        cell.variance = kept * kept * soc_variance + gain * gain * noise_variance;
        cell.of_offset -= gain * offset_v;
        cell.of_resistance -= gain * resistance_v;
        cell.of_capacity = kept * of_capacity;
        cell.soc = soc + gain * (voltage_v - seen.base_v - expected_v);
        // No two states of charge lie further apart.
        if cell.soc.abs() > 1.0 {
            cold_path();
            cell.soc = clamp(cell.soc, -1.0, 1.0);
        }
        expected_v
    }
}

/// What one step knows of all cells.
#[derive(Clone, Copy)]
struct Seen {
    pack_soc: Real,
    /// What one standard deviation of the capacity makes of the step.
    of_capacity: Real,
    /// What the cells' states of charge are off by, all alike.
    mean_soc: Real,
    /// What every voltage has in common.
    base_v: Real,
    /// What one standard deviation of the resistance makes of the current.
    resistance_v: Real,
}

impl Cell {
    /// Variance of its state of charge above the pack's.
    fn soc_variance(&self) -> Real {
        self.variance
            + self.of_offset * self.of_offset
            + self.of_resistance * self.of_resistance
            + self.of_capacity * self.of_capacity
    }
}

fn believable(pack: &Estimate) -> bool {
    (0.0..=1.0).contains(&pack.soc) && pack.soc_sd >= 0.0 && sound(pack.soc_sd)
}

#[expect(clippy::cast_precision_loss, reason = "a pack has fewer cells than 2^24")]
const fn real(count: usize) -> Real {
    count as Real
}

#[cfg(test)]
mod tests;
