//! What is measured between two samples of the filter, as means: charge is kept, noise is not.

use plant_core::Real;
use plant_core::num::sane;

use crate::Measurements;

/// Sums over one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Samples<const CELLS: usize> {
    current_as: Real,
    current_s: Real,
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    cell_v: [Real; CELLS],
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    seen: [u8; CELLS],
    pub elapsed_s: Real,
}

impl<const CELLS: usize> Samples<CELLS> {
    pub const NEW: Self = Self {
        current_as: 0.0,
        current_s: 0.0,
        cell_v: [0.0; CELLS],
        seen: [0; CELLS],
        elapsed_s: 0.0,
    };

    /// Takes the current of one tick, and a share of the cells where their turn has come.
    pub fn take<const SENSORS: usize>(
        &mut self,
        now: &Measurements<CELLS, SENSORS>,
        current_a: Real,
        elapsed_s: Real,
        (from, to): (usize, usize),
        oldest_s: Real,
    ) {
        self.elapsed_s += elapsed_s;
        if sane(current_a) {
            self.current_as += current_a * elapsed_s;
            self.current_s += elapsed_s;
        }
        let cells = self.cell_v.iter_mut().zip(&mut self.seen).zip(&now.cell_v);
        for ((sum_v, seen), reading) in cells.take(to).skip(from) {
            let cell_v = reading.usable_or_nan(oldest_s);
            if sane(cell_v) && *seen < u8::MAX {
                *sum_v += cell_v;
                *seen += 1;
            }
        }
    }

    /// The mean current \[A\]; NaN where it was known for less than half of the time.
    pub fn current_a(&self) -> Real {
        if self.current_s > 0.5 * self.elapsed_s {
            self.current_as / self.current_s
        } else {
            Real::NAN
        }
    }

    /// The mean voltage of each cell \[V\]; NaN where it was not seen.
    pub fn cells_v(&self) -> [Real; CELLS] {
        let mut cells_v = self.cell_v;
        for (cell_v, seen) in cells_v.iter_mut().zip(self.seen) {
            *cell_v = if seen > 0 { *cell_v / Real::from(seen) } else { Real::NAN };
        }
        cells_v
    }
}
