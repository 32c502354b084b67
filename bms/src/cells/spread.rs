//! How far the cells of a pack lie apart.

use plant_core::Real;
use plant_core::num::clamp;

use super::{CellsState, real};

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
