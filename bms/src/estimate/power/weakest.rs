//! The limits of a pack: those of the cell that meets them first.

use plant_core::Real;
use plant_core::num::{clamp, sqrt};

use super::ahead::Direction;
use super::{Allowance, HORIZONS, PowerAhead, PowerLimits, PowerWalk};
use crate::estimate::cells::{CellResistancesState, CellsState};
use crate::{Estimate, Health};

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

/// A cell, the search for another one, that one.
const PARTS: usize = 3;
/// Both directions of every horizon.
const SLICES: usize = 2 * HORIZONS * PARTS;

/// How far [`PowerLimits::walk_cells`] has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CellsWalk {
    next: usize,
    cell: usize,
    discharge: Allowance,
    charge: Allowance,
    found: [PowerAhead; HORIZONS],
}

impl CellsWalk {
    /// Before the first call.
    pub const START: Self = Self {
        next: 0,
        cell: 0,
        discharge: Allowance::ANY,
        charge: Allowance::ANY,
        found: PowerWalk::START.found,
    };
}

impl Default for CellsWalk {
    fn default() -> Self {
        Self::START
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
        let mut walk = CellsWalk::START;
        for _ in 1..SLICES {
            self.walk_cells(&mut walk, cells);
        }
        self.walk_cells(&mut walk, cells).unwrap_or(walk.found)
    }

    /// The same in slices, for a processor with other things to do: one cell under one horizon in one
    /// direction, or the search for it; after eighteen calls the answer is there, from the estimates of
    /// these calls.
    pub fn walk_cells<const CELLS: usize>(
        &self,
        walk: &mut CellsWalk,
        cells: &SeriesCells<CELLS>,
    ) -> Option<[PowerAhead; HORIZONS]> {
        let index = walk.next / (2 * PARTS);
        let Some((horizon, found)) = self.horizons.get(index).zip(walk.found.get_mut(index)) else {
            *walk = CellsWalk::START;
            return None;
        };
        let charging = walk.next / PARTS % 2 == 1;
        let (direction, shorter) = if charging {
            (Direction::Charge, &mut walk.charge)
        } else {
            (Direction::Discharge, &mut walk.discharge)
        };
        let part = walk.next % PARTS;
        if part == 0 {
            let spread = cells.socs.spread();
            walk.cell = if charging { spread.max_index } else { spread.min_index };
        }
        if part == 1 {
            // The search is a slice of its own.
            walk.cell = self.closest(direction, cells, shorter.current_a);
        } else {
            *shorter = match cells.cell(walk.cell) {
                Some((estimate, health)) => {
                    self.allow(horizon, direction, *shorter, &estimate, &health)
                }
                None => Allowance::NONE,
            };
        }
        *found = PowerAhead {
            horizon_s: horizon.seconds(),
            discharge: walk.discharge,
            charge: walk.charge,
        };
        walk.next += 1;
        if walk.next < SLICES {
            return None;
        }
        let found = walk.found;
        *walk = CellsWalk { found, ..CellsWalk::START };
        Some(found)
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
