//! What is made of a whole sweep.

use plant_core::Real;
use plant_core::num::{LARGEST, clamp, min, sane};

use super::{Protection, ProtectionState};
use crate::protect::id::{Faults, Id};
use crate::protect::look::{FOLLOW, Look};

impl<const CELLS: usize, const SENSORS: usize> Protection<'_, CELLS, SENSORS> {
    /// Everything was looked at once more.
    pub(super) fn end_sweep(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        current_a: Option<Real>,
        bleeding: bool,
    ) {
        let shows = |value: Option<Real>| value.unwrap_or(Real::NAN);
        let mean_v = if bleeding || !state.cells.complete() { None } else { state.cells.mean() };
        state.steady.end_sweep(&self.steady, shows(current_a), mean_v);
        let fall_k_per_s = self.table.row(Id::TemperatureRate).threshold;
        state.warming.end_sweep(&self.warming, shows(current_a), fall_k_per_s);
        let mut stuck = Faults::NONE;
        let alone = state.steady.cell_alone(&self.steady);
        if state.cell_moves.stuck(shows(current_a), self.cell_moves_a) || alone {
            stuck = stuck.with(Id::StuckCell);
        }
        let mean_c = shows(state.temperatures.mean());
        let falls = state.warming.falls(&self.warming);
        if state.temperature_moves.stuck(mean_c, self.temperature_moves_k) || falls {
            stuck = stuck.with(Id::StuckTemperature);
        }
        let contradicts = state.steady.contradicts(&self.steady);
        if self.current_stuck(state, shows(current_a)) || contradicts {
            stuck = stuck.with(Id::StuckCurrent);
        }
        state.stuck = stuck;
        state.last_cells = state.cells;
        state.last_temperatures = state.temperatures;
        (state.cells, state.temperatures) = (Look::NEW, Look::NEW);
        state.swept = true;
        state.least_a = self.least_a(state);
    }

    /// All cells have jumped and the current is the same to the bit: it is stuck, until it moves.
    fn current_stuck(&self, state: &mut ProtectionState<CELLS, SENSORS>, current_a: Real) -> bool {
        let now_v = [state.cells.lowest, state.cells.highest];
        #[expect(clippy::float_cmp, reason = "a stuck reading is the same to the bit")]
        let moved = current_a != state.current_a;
        state.current_a = current_a;
        if moved {
            state.follow = FOLLOW;
        }
        // The cells' readings need time to follow; what they do slowly is no jump.
        let slow_v = if state.follow > 0 { LARGEST } else { self.slow_v };
        state.follow = state.follow.saturating_sub(1);
        for (from_v, now_v) in state.jump_from_v.iter_mut().zip(now_v) {
            *from_v += clamp(now_v - *from_v, -slow_v, slow_v);
            if !sane(*from_v) {
                *from_v = now_v;
            }
        }
        let [low_v, high_v] = [0, 1].map(|end: usize| now_v[end] - state.jump_from_v[end]);
        let jumped = low_v * high_v > 0.0 && min(low_v.abs(), high_v.abs()) > self.jump_v;
        state.current_stands = !moved && (jumped || state.current_stands);
        state.current_stands
    }
}
