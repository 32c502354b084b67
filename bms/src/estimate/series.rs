//! The estimators of cells in series, tied together: what one learns reaches the others.

use plant_core::num::sane;
use plant_core::{Accum, ParamError, Real};

use super::cells::{Cells, CellsInput, CellsState};
use super::coulomb::{CoulombCounter, CoulombInput, CoulombState};
use super::ekf::{Ekf, EkfInput, EkfMemory, EkfState};
use super::soh::{
    CapacityEstimator, CapacityInput, CapacityState, ResistanceEstimator, ResistanceInput,
    ResistanceState,
};
use crate::{Estimate, Health};

/// Filter, counter and health of the mean of cells in series, and the state of charge of each. All
/// in the units of one cell, sampled together.
///
/// At each sample filter, counter and resistance; once a second the cells, the counter's review, and
/// what was learnt goes where it is used: capacity, between two rests that the counter was put right
/// at, and resistance into filter, counter and the spread of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series<'b> {
    /// State of charge of the mean.
    pub filter: Ekf,
    /// The same by counting.
    pub counter: CoulombCounter,
    /// State of charge of each.
    pub cells: Cells,
    /// Resistance of the mean.
    pub resistance: ResistanceEstimator<'b>,
    /// Capacity of the mean.
    pub capacity: CapacityEstimator,
    /// Samples in a second, at least 1.
    pub per_second: u32,
    /// The time between two samples \[s\].
    pub dt_s: Real,
}

/// The state of a [`Series`]; [`Series::resume`] makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct SeriesState<const CELLS: usize> {
    /// Of the filter.
    pub filter: EkfState,
    /// Of the counter.
    pub counter: CoulombState,
    /// Of the cells.
    pub cells: CellsState<CELLS>,
    /// What is known of the health of the mean.
    pub health: Health,
    resistance: ResistanceState,
    capacity: CapacityState,
    /// The last rest, and what was discharged since \[A·s\], for how long \[s\].
    rest: Option<Estimate>,
    discharged_as: Accum,
    since_s: Accum,
    samples: u32,
}

/// One sample of cells in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesInput<'a, const CELLS: usize> {
    /// Their voltages \[V\]; NaN where there is no usable reading.
    pub cell_v: &'a [Real; CELLS],
    /// Current of one \[A\], positive when discharging; NaN where there is no usable reading.
    pub current_a: Real,
    /// Temperature \[°C\].
    pub temperature_c: Real,
    /// The contactors are open.
    pub contactors_open: bool,
}

impl Series<'_> {
    /// Goes on from what was remembered of the filter and the health, `elapsed_s` ago \[s\]; nothing
    /// where nobody knows. What may have flowed since is the filter's `standby_sd_a`.
    ///
    /// # Errors
    /// [`ParamError`] names what is out of range.
    pub fn resume<const CELLS: usize>(
        &self,
        memory: EkfMemory,
        health: Health,
        elapsed_s: Option<Real>,
        temperature_c: Real,
    ) -> Result<SeriesState<CELLS>, ParamError> {
        let mut filter = self.filter.resume(memory, elapsed_s, temperature_c)?;
        self.filter.adopt(&mut filter, &health);
        let mut counter = CoulombState::known(memory.soc, memory.soc_sd);
        self.counter.adopt(&mut counter, &health);
        let standby_sd_a = self.filter.params().uncertainty.standby_sd_a;
        self.counter.pause(&mut counter, elapsed_s, standby_sd_a);
        let mut cells = self.cells.start(self.filter.estimate(&filter));
        self.cells.adopt(&mut cells, &health);
        Ok(SeriesState {
            filter,
            counter,
            cells,
            resistance: self
                .resistance
                .known(health.resistance_factor, health.resistance_factor_sd),
            capacity: self.capacity.known(health.capacity_ah, health.capacity_sd_ah),
            health,
            rest: None,
            discharged_as: Accum::new(0.0),
            since_s: Accum::new(0.0),
            samples: 0,
        })
    }

    /// One sample; what is believed of the mean.
    pub fn step<const CELLS: usize>(
        &self,
        state: &mut SeriesState<CELLS>,
        input: SeriesInput<CELLS>,
    ) -> Estimate {
        let (mut sum_v, mut seen) = (0.0, 0.0);
        for voltage_v in input.cell_v.iter().filter(|v| sane(**v)) {
            sum_v += voltage_v;
            seen += 1.0;
        }
        let voltage_v = if seen > 0.0 { sum_v / seen } else { Real::NAN };
        let SeriesInput { current_a, temperature_c, contactors_open, cell_v } = input;
        self.filter.step(
            &mut state.filter,
            EkfInput { current_a, voltage_v, temperature_c, contactors_open },
        );
        self.counter.step(&mut state.counter, CoulombInput { current_a });
        let estimate = self.filter.estimate(&state.filter);
        let learnt = self
            .resistance
            .step(&mut state.resistance, ResistanceInput { voltage_v, current_a, estimate });
        if !learnt.at_bound {
            state.health.resistance_factor = learnt.factor;
            state.health.resistance_factor_sd = learnt.factor_sd;
        }
        if sane(current_a) {
            state.discharged_as.add(current_a * self.dt_s);
        } else {
            // What flowed is not known, so neither is the charge between two rests.
            state.rest = None;
        }
        state.since_s.add(self.dt_s);
        state.samples += 1;
        if state.samples >= self.per_second {
            state.samples = 0;
            self.cells.step(&mut state.cells, CellsInput { pack: estimate, cell_v, current_a });
            self.review(state, &estimate, voltage_v);
        }
        estimate
    }

    /// Once a second: a rest that puts the counter right ends one pair for the capacity and begins
    /// the next; what is known of the health goes to filter and counter.
    fn review<const CELLS: usize>(
        &self,
        state: &mut SeriesState<CELLS>,
        estimate: &Estimate,
        voltage_v: Real,
    ) {
        let counted = self.counter.review(&mut state.counter, voltage_v);
        if counted.anchored {
            let end = Estimate { soc: counted.soc, soc_sd: counted.soc_sd, ..*estimate };
            if let Some(start) = state.rest.replace(end) {
                let learnt = self.capacity.step(
                    &mut state.capacity,
                    CapacityInput {
                        start,
                        end,
                        discharged_ah: state.discharged_as.get() / 3600.0,
                        duration_s: state.since_s.get(),
                    },
                );
                state.health.capacity_ah = learnt.capacity_ah;
                state.health.capacity_sd_ah = learnt.capacity_sd_ah;
            }
            (state.discharged_as, state.since_s) = (Accum::new(0.0), Accum::new(0.0));
        }
        self.filter.adopt(&mut state.filter, &state.health);
        self.counter.adopt(&mut state.counter, &state.health);
        self.cells.adopt(&mut state.cells, &state.health);
    }
}

#[cfg(test)]
mod tests;
