//! The limits of a pack: those of the cell that meets them first.

use plant_core::Real;
use plant_core::num::{clamp, sqrt};

use super::ahead::Direction;
use super::{Allowance, HORIZONS, PowerAhead, PowerLimits, PowerWalk};
use crate::estimate::cells::{CellResistancesState, CellsState};
use crate::{Estimate, Health};

/// Slices of each horizon and direction.
const PARTS: usize = 3;
/// Calls of [`PowerLimits::walk_of_cells`] until the answer is there.
pub const SLICES_OF_CELLS: usize = HORIZONS * 2 * PARTS;

/// What is believed of the cells in series of a pack.
#[derive(Clone, Copy, Debug)]
pub struct SeriesCells<'a, const CELLS: usize> {
    /// Their mean, in the units of one cell.
    pub mean: Estimate,
    /// The health of their mean.
    pub health: Health,
    /// Their states of charge.
    pub socs: &'a CellsState<CELLS>,
    /// Their resistances.
    pub resistances: &'a CellResistancesState<CELLS>,
}

impl<const CELLS: usize> SeriesCells<'_, CELLS> {
    /// One of them.
    fn cell(&self, index: usize) -> Option<(Estimate, Health)> {
        let soc = self.socs.cell(index)?;
        let (ratio, ratio_sd) = self.resistances.ratio(index)?;
        let (mean, health) = (&self.mean, &self.health);
        let factor = health.resistance_factor;
        let (own, common) = (factor * ratio_sd, ratio * health.resistance_factor_sd);
        let estimate = Estimate {
            soc: soc.soc,
            soc_sd: soc.soc_sd,
            polarisation_v: mean.polarisation_v.map(|branch_v| ratio * branch_v),
            ..*mean
        };
        let health = Health {
            resistance_factor: ratio * factor,
            resistance_factor_sd: sqrt(own * own + common * common),
            ..*health
        };
        Some((estimate, health))
    }
}

impl PowerLimits<'_> {
    /// What the cells in series allow, for limits and a battery of one cell: current as it is, power
    /// of one cell. The cell that is closest to empty or full, and the one whose voltage comes
    /// closest to its limit under what the former allows, each with its own state of charge and
    /// resistance; the lesser counts. Without cells, nothing.
    #[must_use]
    pub fn ahead_of_cells<const CELLS: usize>(
        &self,
        cells: &SeriesCells<CELLS>,
    ) -> [PowerAhead; HORIZONS] {
        let mut walk = PowerWalk::START;
        for _ in 0..SLICES_OF_CELLS {
            self.slice(&mut walk, cells);
        }
        walk.found
    }

    /// The same in [`SLICES_OF_CELLS`] calls, for a processor with other things to do: with the last
    /// one the answer is there, from what was believed at each of them.
    pub fn walk_of_cells<const CELLS: usize>(
        &self,
        state: &mut PowerWalk,
        cells: &SeriesCells<CELLS>,
    ) -> Option<[PowerAhead; HORIZONS]> {
        self.slice(state, cells);
        if state.next < SLICES_OF_CELLS {
            return None;
        }
        let found = state.found;
        *state = PowerWalk::START;
        Some(found)
    }

    /// For each horizon and direction three slices: what the cell allows that is closest to empty or
    /// full, which one comes closest to its voltage limit under that, what this one allows.
    fn slice<const CELLS: usize>(&self, walk: &mut PowerWalk, cells: &SeriesCells<CELLS>) {
        let (index, part) = (walk.next / PARTS / 2, walk.next % PARTS);
        let Some((horizon, found)) = self.horizons.get(index).zip(walk.found.get_mut(index)) else {
            *walk = PowerWalk::START;
            return;
        };
        walk.next += 1;
        found.horizon_s = horizon.seconds();
        let (direction, shorter, place) = if ((walk.next - 1) / PARTS).is_multiple_of(2) {
            (Direction::Discharge, &mut walk.discharge, &mut found.discharge)
        } else {
            (Direction::Charge, &mut walk.charge, &mut found.charge)
        };
        match (part, direction) {
            (1, _) => {
                walk.candidate = self.closest(direction, cells, shorter.current_a);
                return;
            }
            (0, Direction::Discharge) => walk.candidate = cells.socs.spread().min_index,
            (0, Direction::Charge) => walk.candidate = cells.socs.spread().max_index,
            _ => {}
        }
        *shorter = match cells.cell(walk.candidate) {
            Some((estimate, health)) => {
                self.allow(horizon, direction, *shorter, &estimate, &health)
            }
            None => Allowance::NONE,
        };
        *place = *shorter;
    }

    /// The cell whose voltage comes closest to its limit under a current \[A\], ≥ 0.
    fn closest<const CELLS: usize>(
        &self,
        direction: Direction,
        cells: &SeriesCells<CELLS>,
        current_a: Real,
    ) -> usize {
        let now = self.battery.resistances(cells.mean.soc, cells.mean.temperature_c);
        let [fast_ohm, slow_ohm] = now.polarisation_ohm;
        let ohm = cells.health.resistance_factor * (now.series_ohm + fast_ohm + slow_ohm);
        let sds = self.params.margin_sds;
        let (mut closest, mut least_v) = (0, Real::INFINITY);
        for index in 0..CELLS {
            if let (Some(cell), Some((ratio, _))) =
                (cells.socs.cell(index), cells.resistances.ratio(index))
            {
                let soc = clamp(cell.soc - direction.sign() * sds * cell.soc_sd, 0.0, 1.0);
                let open_circuit_v = self.battery.open_circuit().at(soc);
                let room_v = direction.sign() * open_circuit_v - ratio * ohm * current_a;
                if room_v < least_v {
                    (closest, least_v) = (index, room_v);
                }
            }
        }
        closest
    }
}
