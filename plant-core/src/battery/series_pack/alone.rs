//! Cells in series on their own.

use super::{SeriesPack, SeriesPackState};
use crate::battery::{Pack, SOC_MARGIN};
use crate::model::Model;
use crate::num::{Real, clamp, sane};

/// Input of a [`SeriesPack`](super::SeriesPack) that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesPackInput<const N: usize> {
    /// The current imposed \[A\], positive when discharging.
    pub current_a: Real,
    /// What bleeds each cell beside it \[A\]; negative charges it.
    pub bleed_a: [Real; N],
}

/// Output of one step of a [`SeriesPack`](super::SeriesPack).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct SeriesPackOutput<const N: usize> {
    /// Voltage at each cell's terminals \[V\].
    pub cell_v: [Real; N],
    /// State of charge of each cell, 0..1.
    pub cell_soc: [Real; N],
    /// Temperature of each cell \[°C\].
    pub cell_temperature_c: [Real; N],
    /// State of charge of the pack, 0..1: 0 with the first cell empty, 1 with the first full.
    pub soc: Real,
    /// Voltage at the terminals of the pack \[V\].
    pub terminal_v: Real,
    /// Sum of the open-circuit voltages over the step, without hysteresis \[V\].
    pub open_circuit_v: Real,
    /// The current that flowed \[A\], positive when discharging.
    pub current_a: Real,
    /// Charge of this step that a cell's limits or its state of charge refused \[C\]; positive where
    /// discharge was refused, negative where charge was.
    pub refused_charge_c: Real,
    /// Heat in all cells, what they lose by themselves included \[W\].
    pub heat_w: Real,
    /// What the bleeding takes out of the cells \[W\].
    pub bleed_w: Real,
    /// A cell has nothing left to discharge.
    pub depleted: bool,
    /// A cell can be charged no more.
    pub full: bool,
    /// State of charge or temperature of a cell lie outside what the parameters were identified for.
    pub outside_identified: bool,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl<const N: usize> SeriesPack<N> {
    /// Advances by one step under an imposed current. What the limits or the state of charge of a cell
    /// do not allow is refused and reported.
    pub fn step(
        &self,
        state: &mut SeriesPackState<N>,
        input: SeriesPackInput<N>,
    ) -> SeriesPackOutput<N> {
        let mut next = *state;
        next.bleed_a = input.bleed_a;
        let limits = self.limits(&next);
        let (source, open_circuit_v) = self.offer(&next);
        let mut wanted_a = input.current_a;
        let mut current_a = clamp(wanted_a, -limits.charge_a, limits.discharge_a);
        let (mut heat_w, mut bleed_w) = (0.0, 0.0);
        let before = next;
        self.settle(&mut next, current_a);
        for (i, cell) in before.cells.iter().enumerate() {
            let bleed_a = self.bleed_a(&before, i);
            let rest_v = self.cell.offer(cell).1;
            bleed_w += next.terminal_v[i] * bleed_a;
            heat_w += (rest_v - next.terminal_v[i]) * (current_a + bleed_a)
                + rest_v * self.lost_a(cell, i);
        }
        let sane_bleed = input.bleed_a.iter().all(|a| sane(*a));
        let rejected = !(sane(wanted_a) && sane_bleed && sane(<Self as Pack>::magnitude(&next)));
        if rejected {
            (wanted_a, current_a, heat_w, bleed_w) = (0.0, 0.0, 0.0, 0.0);
        } else {
            *state = next;
            self.refresh(state);
        }
        SeriesPackOutput {
            cell_v: state.terminal_v,
            cell_soc: state.cells.map(|cell| cell.soc.get()),
            cell_temperature_c: state.cells.map(|cell| cell.temperature_c.get()),
            soc: state.soc,
            terminal_v: if rejected {
                state.terminal_v.iter().sum()
            } else {
                source.voltage_v(current_a)
            },
            open_circuit_v,
            current_a,
            refused_charge_c: (wanted_a - current_a) * self.cell.dt_s,
            heat_w,
            bleed_w,
            depleted: state.cells.iter().any(|cell| cell.soc.get() <= SOC_MARGIN),
            full: state.cells.iter().any(|cell| cell.soc.get() >= 1.0 - SOC_MARGIN),
            outside_identified: <Self as Pack>::is_outside(state),
            rejected,
        }
    }
}

impl<const N: usize> Model for SeriesPack<N> {
    type State = SeriesPackState<N>;
    type Input = SeriesPackInput<N>;
    type Output = SeriesPackOutput<N>;

    #[inline]
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Output {
        Self::step(self, state, input)
    }
}
