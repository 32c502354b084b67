//! What is believed of one cell, and how far the cells of a pack lie apart.

use plant_core::Real;
use plant_core::num::{clamp, min, sqrt};

use super::{CellsState, real};

/// What is not known of a charge that was bled, as a ratio. Chosen: resistors of 1 % and a voltage
/// that falls while it is bled.
pub const BLED_SD: Real = 0.05;

/// The state of charge of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CellSoc {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation.
    pub soc_sd: Real,
    /// Its voltage said nothing in the last step: no usable reading of it, of the current or of
    /// the pack.
    pub held: bool,
}

/// How far the cells' states of charge lie apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SocSpread {
    /// Lowest state of charge, 0..1.
    pub min: Real,
    /// Mean state of charge, 0..1.
    pub mean: Real,
    /// Highest state of charge, 0..1.
    pub max: Real,
    /// Which cell has the lowest.
    pub min_index: usize,
    /// Which cell has the highest.
    pub max_index: usize,
}

impl<const CELLS: usize> CellsState<CELLS> {
    /// What is believed of one cell; `None` where there is none of this number.
    #[must_use]
    pub fn cell(&self, index: usize) -> Option<CellSoc> {
        let cell = self.cells.get(index)?;
        let held = self.held > 0 && cell.held;
        let variance = self.pack_soc_sd * self.pack_soc_sd
            + cell.soc_variance()
            + if held { 0.0 } else { self.others_variance };
        Some(CellSoc {
            soc: clamp(self.pack_soc + cell.soc, 0.0, 1.0),
            soc_sd: sqrt(min(variance, 1.0)),
            held,
        })
    }

    /// Says that so much was bled from a cell, as a state of charge ≥ 0. Not known of it is
    /// [`BLED_SD`], a ratio; what is not finite or below zero is not taken.
    pub fn book(&mut self, index: usize, bled_soc: Real) {
        if !(0.0..=1.0).contains(&bled_soc) {
            return;
        }
        if let Some(cell) = self.cells.get_mut(index) {
            cell.soc -= bled_soc;
            cell.variance += (BLED_SD * bled_soc) * (BLED_SD * bled_soc);
            self.mean_soc -= bled_soc / real(CELLS);
        }
    }

    /// Lowest, mean and highest state of charge; without cells, the pack's.
    #[must_use]
    pub fn spread(&self) -> SocSpread {
        let first = self.cells.first().map_or(0.0, |cell| cell.soc);
        let (mut low, mut high, mut sum) = ((0, first), (0, first), 0.0);
        for (i, cell) in self.cells.iter().enumerate() {
            sum += cell.soc;
            if cell.soc < low.1 {
                low = (i, cell.soc);
            } else if cell.soc > high.1 {
                high = (i, cell.soc);
            }
        }
        let mean = if CELLS > 0 { sum / real(CELLS) } else { 0.0 };
        let soc = |above: Real| clamp(self.pack_soc + above, 0.0, 1.0);
        SocSpread {
            min: soc(low.1),
            mean: soc(mean),
            max: soc(high.1),
            min_index: low.0,
            max_index: high.0,
        }
    }
}
