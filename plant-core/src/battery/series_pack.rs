//! Cells in series that are not alike: capacity, resistance, self-discharge, state of charge,
//! temperature.
//!
//! Each is a [`MappedBattery`], `i` its number, b what bleeds it and s what it loses by itself:
//! `dSOC_i/dt = −(I + b_i + s_i)/(3600·Q_i)`, `V_i` as that model has it under `I + b_i`, and along
//! the row `C·dT_i/dt = P_i − k_i·(T_i − T_a,i) − q·(T_i − T_{i−1}) − q·(T_i − T_{i+1})`. It is ours.
//!
//! The pack is empty once one cell is, and full once another is: its state of charge is what it can
//! still give, over that and what it can still take.
//!
//! Tests: `tests` below; `tests/tests/series_pack.rs`; case "cells in series".

mod alone;
mod in_plant;
mod spread;

pub use alone::{SeriesPackInput, SeriesPackOutput};
pub use spread::CellSpread;

use super::map::{COLDEST_C, HOTTEST_C};
use super::{CurrentLimits, MappedBattery, MappedBatteryParams, MappedBatteryState};
use crate::error::{ParamError, check, not_negative, positive};
use crate::model::Dt;
use crate::num::{Accum, LARGEST, Real, clamp, max, min, sane};
use crate::port::Source;
use crate::thermal::Chain;

/// Parameters of a [`SeriesPack`] of `N` cells.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SeriesPackParams<const N: usize> {
    /// The cell, or what stands parallel ([`MappedBatteryParams::pack`]) as one; its limits hold for
    /// each.
    pub cell: MappedBatteryParams,
    /// How each differs.
    pub spread: [CellSpread; N],
    /// What flows between neighbours \[W/K\], ≥ 0.
    pub neighbour_w_per_k: Real,
}

/// `N` cells in series that are not alike, discretised for one step.
///
/// It can sit in the coupled plant ([`Pack`](super::Pack)) or step on its own. Bleed currents are an input of each
/// step; in the plant they stand in the state.
///
/// ```
/// use plant_core::battery::{CellSpread, SeriesPack, SeriesPackInput, SeriesPackParams};
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use plant_core::{Dt, ParamError, must};
///
/// const WEAK: CellSpread = CellSpread { capacity_ratio: 0.9, resistance_ratio: 1.3, ..CellSpread::NONE };
/// const PACK: SeriesPack<3> = must!(SeriesPack::new(
///     SeriesPackParams {
///         cell: PANASONIC_NCR18650PF,
///         spread: [CellSpread::NONE, WEAK, CellSpread::NONE],
///         neighbour_w_per_k: 0.1,
///     },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let mut state = PACK.rested(0.5)?;
/// // The first cell is bled while the pack gives 3 A.
/// let input = SeriesPackInput { current_a: 3.0, bleed_a: [0.1, 0.0, 0.0] };
/// let mut out = PACK.step(&mut state, input);
/// for _ in 1..600 {
///     out = PACK.step(&mut state, input);
/// }
/// assert!(out.cell_v[1] < out.cell_v[0] && out.cell_v[0] < out.cell_v[2]);
/// assert!(out.cell_soc[1] < out.cell_soc[0] && out.cell_soc[0] < out.cell_soc[2]);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesPack<const N: usize> {
    cell: MappedBattery,
    spread: [CellSpread; N],
    soc_per_a: [Real; N],
    heat: Chain<N>,
    refresh_s: Real,
}

/// The state of a [`SeriesPack`]; [`SeriesPack::rested`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SeriesPackState<const N: usize> {
    /// The cells. Their state of charge, temperature and surroundings may be set between steps, as
    /// those of a [`MappedBattery`].
    pub cells: [MappedBatteryState; N],
    /// What bleeds each cell \[A\]; negative charges it. May be set between steps; what is not finite
    /// or absurd is nothing.
    pub bleed_a: [Real; N],
    /// Voltage at each cell's terminals over the last step \[V\].
    pub terminal_v: [Real; N],
    soc: Real,
    steps_left: u32,
}

impl<const N: usize> SeriesPack<N> {
    /// Checks `params` and discretises them for steps of `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range, `pack.series` where there is no
    /// cell.
    pub const fn new(params: SeriesPackParams<N>, dt: Dt) -> Result<Self, ParamError> {
        if N == 0 {
            return Err(ParamError::NotPositive("pack.series"));
        }
        let cell = check!(MappedBattery::new(params.cell, dt));
        let neighbour = check!(not_negative("pack.neighbour_w_per_k", params.neighbour_w_per_k));
        let refresh_s = cell.refresh_s();
        let capacity_per_h = params.cell.thermal.heat_capacity_j_per_k / refresh_s;
        let (mut soc_per_a, mut cooling, mut i) = ([0.0; N], [0.0; N], 0);
        while i < N {
            let spread = check!(params.spread[i].checked());
            let ratio = check!(positive("pack.spread.capacity_ratio", spread.capacity_ratio));
            soc_per_a[i] = cell.soc_per_a / ratio;
            cooling[i] = params.cell.thermal.cooling_w_per_k * spread.cooling_ratio;
            i += 1;
        }
        let heat = Chain::new([capacity_per_h; N], cooling, [neighbour; N]);
        Ok(Self { cell, spread: params.spread, soc_per_a, heat, refresh_s })
    }

    /// A rested pack whose cells lie about `soc` and about the temperature of their surroundings, each
    /// with its offset.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] outside 0..1.
    pub fn rested(&self, soc: Real) -> Result<SeriesPackState<N>, ParamError> {
        let mut cells = [self.cell.rested(soc)?; N];
        for (cell, spread) in cells.iter_mut().zip(&self.spread) {
            cell.soc = Accum::new(clamp(soc + spread.soc_offset, 0.0, 1.0));
            let celsius = cell.ambient_c + spread.temperature_offset_k;
            cell.ambient_c = clamp(celsius, COLDEST_C, HOTTEST_C);
            cell.temperature_c = Accum::new(cell.ambient_c);
            MappedBattery::look_around(cell);
            self.cell.follow(cell, spread.resistance_ratio);
        }
        let mut state = SeriesPackState {
            cells,
            bleed_a: [0.0; N],
            terminal_v: cells.map(|cell| self.cell.offer(&cell).0.emf_v),
            soc: 0.0,
            steps_left: self.cell.refresh_steps,
        };
        self.weigh(&mut state);
        Ok(state)
    }

    /// What bleeds a cell over the next step \[A\]: no more than its charge, or the room for it.
    #[inline]
    fn bleed_a(&self, state: &SeriesPackState<N>, i: usize) -> Real {
        let asked_a = state.bleed_a[i];
        let soc = state.cells[i].soc.get();
        if !sane(asked_a) {
            0.0
        } else if asked_a > 0.0 {
            min(asked_a, max(soc, 0.0) / self.soc_per_a[i])
        } else {
            max(asked_a, -max(1.0 - soc, 0.0) / self.soc_per_a[i])
        }
    }

    /// The state of charge of the pack.
    fn weigh(&self, state: &mut SeriesPackState<N>) {
        let (mut left, mut room) = (LARGEST, LARGEST);
        for (cell, spread) in state.cells.iter().zip(&self.spread) {
            let soc = cell.soc.get();
            left = min(left, max(soc, 0.0) * spread.capacity_ratio);
            room = min(room, max(1.0 - soc, 0.0) * spread.capacity_ratio);
        }
        state.soc = if left > 0.0 { left / (left + room) } else { 0.0 };
    }

    /// What the terminals offer over the next step, and the sum of the open-circuit voltages in it
    /// \[V\].
    #[must_use]
    pub fn offer(&self, state: &SeriesPackState<N>) -> (Source, Real) {
        let mut all = Source { emf_v: 0.0, resistance_ohm: 0.0 };
        let mut open_circuit_v = 0.0;
        for (i, cell) in state.cells.iter().enumerate() {
            let (source, rest_v) = self.cell.offer(cell);
            all.emf_v += source.voltage_v(self.bleed_a(state, i));
            all.resistance_ohm += source.resistance_ohm;
            open_circuit_v += rest_v;
        }
        (all, open_circuit_v)
    }

    /// The currents that every cell allows over the next step.
    #[must_use]
    pub fn limits(&self, state: &SeriesPackState<N>) -> CurrentLimits {
        self.least(state, |i, soc| CurrentLimits {
            discharge_a: max(soc, 0.0) / self.soc_per_a[i],
            charge_a: max(1.0 - soc, 0.0) / self.soc_per_a[i],
        })
    }

    /// The same, as a coupled plant keeps them: towards full, and towards empty, they fade with the
    /// charge that is left to go, over 0.1 s.
    #[must_use]
    pub fn faded(&self, state: &SeriesPackState<N>) -> CurrentLimits {
        self.limits(state).within(self.least(state, |i, soc| self.faded_cell(i, soc)))
    }

    fn faded_cell(&self, i: usize, soc: Real) -> CurrentLimits {
        let (faded, ratio) = (self.cell.ends.faded(soc), self.spread[i].capacity_ratio);
        CurrentLimits { discharge_a: ratio * faded.discharge_a, charge_a: ratio * faded.charge_a }
    }

    /// The least of what the cells allow, each given its number and its state of charge, beside what
    /// bleeds it.
    fn least(
        &self,
        state: &SeriesPackState<N>,
        charge: impl Fn(usize, Real) -> CurrentLimits,
    ) -> CurrentLimits {
        let params = self.cell.params();
        let own = CurrentLimits {
            discharge_a: params.discharge_limit_a,
            charge_a: params.charge_limit_a,
        };
        let mut least = own;
        for (i, cell) in state.cells.iter().enumerate() {
            let mut limits = own.within(charge(i, cell.soc.get()));
            if self.cell.ends.cut_off() {
                limits = limits.within(self.cell.ends.at_voltages(self.cell.offer(cell).0));
            }
            let bleed_a = self.bleed_a(state, i);
            least = least.within(CurrentLimits {
                discharge_a: max(limits.discharge_a - bleed_a, 0.0),
                charge_a: max(limits.charge_a + bleed_a, 0.0),
            });
        }
        least
    }

    /// The state after one step under `current_a`, whatever the limits say.
    #[must_use]
    pub fn next(&self, state: &SeriesPackState<N>, current_a: Real) -> SeriesPackState<N> {
        let mut next = *state;
        for (i, before) in state.cells.iter().enumerate() {
            let cell_a = current_a + self.bleed_a(state, i);
            next.cells[i] = self.cell.next_by(before, cell_a, cell_a * self.soc_per_a[i]);
            next.terminal_v[i] = self.cell.offer(before).0.voltage_v(cell_a);
        }
        self.weigh(&mut next);
        next
    }

    /// Whether a step under `current_a`, and under `least_a` once the windings have settled, that
    /// leads to `next` keeps every limit of every cell, clear of the ends of charge.
    #[must_use]
    pub fn allows(&self, current_a: Real, least_a: Real, next: &SeriesPackState<N>) -> bool {
        let params = self.cell.params();
        let mut allowed = true;
        for (i, cell) in next.cells.iter().enumerate() {
            let (soc, bleed_a) = (cell.soc.get(), self.bleed_a(next, i));
            let (most_a, least_a) = (current_a + bleed_a, least_a + bleed_a);
            let mut limits = CurrentLimits {
                discharge_a: params.discharge_limit_a,
                charge_a: params.charge_limit_a,
            }
            .within(self.faded_cell(i, soc));
            if self.cell.ends.cut_off() {
                let resistance_ohm = cell.source_ohm;
                let emf_v = next.terminal_v[i] + resistance_ohm * most_a;
                let source = Source { emf_v, resistance_ohm };
                limits = limits.within(self.cell.ends.at_voltages(source));
            }
            allowed &= most_a <= limits.discharge_a
                && -least_a <= limits.charge_a
                && !self.cell.ends.are_near(soc);
        }
        allowed
    }

    /// Books one step under `current_a`, which [`limits`](Self::limits) allow. Returns what was
    /// charged beyond full all the same, or, negative, drawn beyond empty \[C\]: it is lost. What a
    /// single cell loses counts as much less as its voltage is below the pack's.
    pub fn settle(&self, state: &mut SeriesPackState<N>, current_a: Real) -> Real {
        let (_, open_circuit_v) = self.offer(state);
        let mut lost_j = 0.0;
        *state = self.next(state, current_a);
        for (i, cell) in state.cells.iter_mut().enumerate() {
            let reached = cell.soc;
            cell.soc.clamp(0.0, 1.0);
            let lost_c = self.capacity_c(i) * reached.since(cell.soc);
            lost_j += lost_c * self.cell.open_circuit().at(cell.soc.get());
        }
        self.weigh(state);
        if open_circuit_v > 0.0 { lost_j / open_circuit_v } else { 0.0 }
    }

    fn capacity_c(&self, i: usize) -> Real {
        self.cell.capacity_c * self.spread[i].capacity_ratio
    }

    /// Counts a step; when it is time, temperatures and resistances follow, and each cell has lost
    /// what it loses by itself.
    pub fn refresh(&self, state: &mut SeriesPackState<N>) {
        state.steps_left -= u32::from(state.steps_left > 0);
        if state.steps_left == 0 {
            self.warm(state);
        }
    }

    #[cold]
    #[inline(never)]
    fn warm(&self, state: &mut SeriesPackState<N>) {
        let (mut celsius, mut around_c, mut heat_w) = ([0.0; N], [0.0; N], [0.0; N]);
        for (i, cell) in state.cells.iter_mut().enumerate() {
            MappedBattery::look_around(cell);
            let lost_a = self.lost_a(cell, i);
            let rest_v = self.cell.open_circuit().at(cell.soc.get());
            cell.soc.add(-lost_a * self.refresh_s / self.capacity_c(i));
            cell.soc.clamp(0.0, 1.0);
            celsius[i] = cell.temperature_c.get();
            around_c[i] = cell.surroundings_c;
            heat_w[i] = cell.heat_j / self.refresh_s + lost_a * rest_v;
        }
        let increments_k = self.heat.increments_k(&celsius, &around_c, &heat_w);
        for (i, cell) in state.cells.iter_mut().enumerate() {
            MappedBattery::warm_by(cell, increments_k[i]);
            self.cell.follow(cell, self.spread[i].resistance_ratio);
        }
        state.steps_left = self.cell.refresh_steps;
        self.weigh(state);
    }

    /// What a cell loses by itself \[A\]: no more than it has.
    fn lost_a(&self, cell: &MappedBatteryState, i: usize) -> Real {
        let left_a = max(cell.soc.get(), 0.0) * self.capacity_c(i) / self.refresh_s;
        min(self.spread[i].self_discharge_a, left_a)
    }

    /// The cell.
    #[must_use]
    pub const fn cell(&self) -> &MappedBattery {
        &self.cell
    }
}

#[cfg(test)]
mod tests;
