//! Cells in series as the coupled plant asks for them.

use super::{SeriesPack, SeriesPackState};
use crate::battery::{CurrentLimits, Losses, MappedBatteryState, Pack};
use crate::error::ParamError;
use crate::num::Real;
use crate::port::Source;

/// In the plant's ledger what bleeds a cell and what it loses by itself are no part of the
/// electrochemical energy that leaves it: they show as `open_circuit_explicit`.
impl<const N: usize> Pack for SeriesPack<N> {
    type State = SeriesPackState<N>;

    fn rested(&self, soc: Real) -> Result<Self::State, ParamError> {
        Self::rested(self, soc)
    }

    fn soc(state: &Self::State) -> Real {
        state.soc
    }

    fn magnitude(state: &Self::State) -> Real {
        state.cells.iter().map(MappedBatteryState::magnitude).sum()
    }

    fn offer(&self, state: &Self::State) -> (Source, Real) {
        Self::offer(self, state)
    }

    fn faded(&self, state: &Self::State) -> CurrentLimits {
        Self::faded(self, state)
    }

    fn next(&self, state: &Self::State, current_a: Real) -> Self::State {
        Self::next(self, state, current_a)
    }

    fn allows(&self, current_a: Real, least_a: Real, next: &Self::State) -> bool {
        Self::allows(self, current_a, least_a, next)
    }

    fn may_collapse(&self) -> bool {
        true
    }

    fn settle(&self, state: &mut Self::State, current_a: Real) -> Real {
        Self::settle(self, state, current_a)
    }

    fn losses(&self, before: &Self::State, after: &Self::State, current_a: Real) -> Losses {
        let mut losses = Losses::default();
        for (i, cell) in before.cells.iter().enumerate() {
            let cell_a = current_a + self.bleed_a(before, i);
            let [fast_v, slow_v] = after.cells[i].polarisation_v;
            losses.series += cell.now.series_ohm * cell_a * current_a;
            losses.polarisation +=
                (fast_v.get() + slow_v.get() - self.cell.hysteresis_v(cell)) * current_a;
        }
        losses
    }

    fn loss_factors(&self) -> (Real, Real) {
        (1.0, 1.0)
    }

    fn capacitive_j(&self, _state: &Self::State) -> Real {
        0.0
    }

    fn discharged_energy_j(&self, from: &Self::State, to: &Self::State) -> Real {
        let mut energy_j = 0.0;
        for i in 0..N {
            let (from, to) = (from.cells[i].soc, to.cells[i].soc);
            let mean_v = self.cell.open_circuit().mean(from.get(), to.get());
            energy_j += self.capacity_c(i) * mean_v * from.since(to);
        }
        energy_j
    }

    fn refresh(&self, state: &mut Self::State) {
        Self::refresh(self, state);
    }

    /// Of every cell.
    fn set_temperature(&self, state: &mut Self::State, temperature_c: Real) -> bool {
        let mut taken = true;
        for (cell, spread) in state.cells.iter_mut().zip(&self.spread) {
            taken &= self.cell.set_temperature(cell, temperature_c);
            self.cell.follow(cell, spread.resistance_ratio);
        }
        taken
    }

    fn is_outside(state: &Self::State) -> bool {
        state.cells.iter().any(|cell| cell.outside)
    }
}
