//! What has time: the samples of the filter, and slices of what is worked out once a second.

use plant_core::Real;
use plant_core::num::{max, min, sane};

use super::description::{real, whole};
use super::samples::Samples;
use super::{Bms, BmsState, Board};
use crate::balance::BalancerInput;
use crate::contactor::{Coils, Phase};
use crate::estimate::energy::{DISCHARGES, EnergyInput};
use crate::estimate::power::{SLICES_OF_CELLS, SeriesCells};
use crate::estimate::series::SeriesInput;
use crate::limit::LimiterInput;
use crate::measure::Spread;
use crate::protect::{Currents, Flow, Trip};

/// Samples that were missed and are made up for; beyond, the battery has stood unseen. Chosen: a
/// second at ten samples a second, in which the filter's own model still holds.
const MADE_UP_FOR: u32 = 10;
/// Which horizon the limits keep: 10 s.
const HORIZON: usize = 1;

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// One sample of the estimators: every `sample_s`. Limits follow, and the bleed switches. Where it
    /// comes late, what was counted meanwhile is taken; after a sleep the estimates are aged.
    pub fn filter<B: Board<CELLS, SENSORS>>(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) {
        let params = self.of.params();
        let parallel = Real::from(params.sheet.layout.parallel);
        let samples = core::mem::replace(&mut state.samples, Samples::NEW);
        let periods = samples.elapsed_s / params.sample_s;
        let current_a = samples.current_a() / parallel;
        let mut cell_v = samples.cells_v();
        for (index, cell_v) in cell_v.iter_mut().enumerate() {
            // A cell that is bled, or whose neighbour is, reads something else.
            if state.balancer.disturbs(index) {
                *cell_v = Real::NAN;
            }
        }
        let temperature_c = self.temperature_c(state);
        let contactors_open = matches!(state.contactors.phase(), Phase::Standby | Phase::Fault)
            && state.contactors.coils() == Coils::default();

        let slept = periods > real(MADE_UP_FOR);
        if slept {
            let standby_sd_a = self.series.filter.params().uncertainty.standby_sd_a;
            let elapsed_s = Some(samples.elapsed_s);
            self.series.filter.pause(&mut state.series.filter, elapsed_s);
            self.series.counter.pause(&mut state.series.counter, elapsed_s, standby_sd_a);
            state.rested_s += samples.elapsed_s;
        }
        let missed = if slept { 0 } else { whole(periods).saturating_sub(1) };
        let unseen = [Real::NAN; CELLS];
        for late in (0..=missed).rev() {
            let cell_v = if late == 0 { &cell_v } else { &unseen };
            self.series.step(
                &mut state.series,
                SeriesInput { cell_v, current_a, temperature_c, contactors_open },
            );
            state.sample += 1;
        }
        state.contradicts = !self.series.filter.status(&state.series.filter).consistent;
        let second = state.sample >= params.per_second();
        if second {
            state.sample = state.sample.saturating_sub(params.per_second());
            state.slice = 0;
        }
        self.resistances.step(&mut state.resistances, &cell_v, current_a);
        self.energy.step(
            &mut state.energy,
            EnergyInput { current_a, voltage_v: mean(&cell_v).unwrap_or(Real::NAN) },
        );
        self.rest(state, current_a * parallel, samples.elapsed_s);
        self.limit(state);
        self.balance(state, board, &cell_v, second);
    }

    fn temperature_c(&self, state: &BmsState<CELLS, SENSORS>) -> Real {
        let sheet = &self.of.params().sheet;
        let oldest_s = sheet.sensing.temperature_c.oldest_s(sheet.tick_s);
        Spread::of(&state.now.temperature_c, oldest_s).map_or(Real::NAN, |spread| spread.mean)
    }

    fn rest(&self, state: &mut BmsState<CELLS, SENSORS>, current_a: Real, elapsed_s: Real) {
        let rests = sane(current_a) && current_a.abs() <= self.of.params().rest_current_a();
        state.rested_s = if rests { min(state.rested_s + elapsed_s, 1e6) } else { 0.0 };
    }

    /// What may be drawn and fed.
    fn limit(&self, state: &mut BmsState<CELLS, SENSORS>) {
        let cell = &self.of.params().sheet.cell;
        let ahead = state.power.as_ref().and_then(|power| power.get(HORIZON));
        let heat = |flow| state.protection.heat_share(self.of.table(), flow);
        let warm_a = |currents: &Currents, share: Real| {
            let more_a = currents.ten_seconds_a - currents.continuous_a;
            currents.continuous_a + max(0.0, 1.0 - share) * more_a
        };
        let least = |allowed: Option<Real>, warm_a: Real| {
            allowed.map_or(Real::NAN, |allowed_a| min(allowed_a, warm_a))
        };
        let coldest_c = state.protection.temperature_extremes_c().map_or(Real::NAN, |(c, _)| c);
        let phase = state.contactors.phase();
        let input = LimiterInput {
            cell_discharge_a: least(
                ahead.map(|ahead| ahead.discharge.current_a),
                warm_a(&cell.discharge, heat(Flow::Discharge)),
            ),
            cell_charge_a: least(
                ahead.map(|ahead| ahead.charge.current_a),
                warm_a(&cell.charge, heat(Flow::Charge)),
            ),
            coldest_c,
            verdict: &state.verdict,
            mains_closed: matches!(phase, Phase::Closed | Phase::Shed),
            ending: phase == Phase::Shed,
        };
        self.limiter.step(&mut state.limits, self.of.table(), &input);
    }

    /// Which cells are bled from now on; the estimates know of the charge. A frame begins with a
    /// second, so that its pause ends with the sample that the cells' states of charge take.
    fn balance<B: Board<CELLS, SENSORS>>(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
        cell_v: &[Real; CELLS],
        second: bool,
    ) {
        let allowed = state.verdict.trip == Trip::None
            && state.verdict.permit
            && matches!(state.contactors.phase(), Phase::Standby | Phase::Closed);
        state.balancing = allowed && (state.balancing || second);
        let mut soc = [(Real::NAN, Real::NAN); CELLS];
        for (index, soc) in soc.iter_mut().enumerate() {
            if let Some(cell) = state.series.cells.cell(index) {
                *soc = (cell.soc, cell.soc_sd);
            }
        }
        // While it is bled a cell's voltage is that of before.
        let mut last_v = *cell_v;
        let oldest_s = self.of.params().sheet.sensing.cell_v.oldest_s(1.0);
        for (last_v, reading) in last_v.iter_mut().zip(&state.now.cell_v) {
            if !sane(*last_v) {
                *last_v = reading.usable_or_nan(oldest_s);
            }
        }
        let bled_as = self.balancer.step(
            &mut state.balancer,
            &BalancerInput {
                soc: &soc,
                cell_v: &last_v,
                rested: state.rested_s >= self.of.params().rest_s,
                board_c: board.balancing_c(),
                allowed: state.balancing,
            },
        );
        let layout = &self.of.params().sheet.layout;
        let group_as = 3600.0 * state.series.health.capacity_ah * Real::from(layout.parallel);
        for (index, bled_as) in bled_as.into_iter().enumerate() {
            if bled_as > 0.0 {
                state.series.cells.book(index, bled_as / group_as);
            }
        }
        state.bleeding = state.balancer.bleeding().contains(&true);
        board.bleed(state.balancer.bleeding());
    }

    /// One slice of what is worked out once a second, each within 30,000 instructions of a Cortex-M4F:
    /// state of power, then energy left. `false` where nothing is left to do in this second.
    pub fn slow(&self, state: &mut BmsState<CELLS, SENSORS>) -> bool {
        let estimate = self.series.filter.estimate(&state.series.filter);
        let health = state.series.health;
        if state.slice < SLICES_OF_CELLS {
            let cells = SeriesCells {
                mean: estimate,
                health,
                socs: &state.series.cells,
                resistances: &state.resistances,
            };
            if let Some(power) = self.power.walk_of_cells(&mut state.power_walk, &cells) {
                state.power = Some(power);
            }
        } else if state.slice < SLICES_OF_CELLS + DISCHARGES {
            let walk = &mut state.energy_walk;
            if let Some(left) = self.energy.walk(walk, &state.energy, &estimate, &health) {
                state.energy_left = Some(left);
            }
        } else {
            return false;
        }
        state.slice += 1;
        true
    }

    /// All of it in the order of a single loop, once every `sheet.tick_s`: [`fast`](Self::fast), then
    /// either a sample or, at most every fourth tick, a slice.
    pub fn tick<B: Board<CELLS, SENSORS>>(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) {
        self.fast(state, board);
        state.since_filter += 1;
        if state.since_filter >= self.of.params().ticks_per_sample() {
            state.since_filter = 0;
            self.filter(state, board);
        } else if state.since_filter.is_multiple_of(4) {
            self.slow(state);
        }
    }
}

fn mean(values: &[Real]) -> Option<Real> {
    let (mut sum, mut seen) = (0.0, 0.0);
    for value in values.iter().filter(|value| sane(**value)) {
        sum += value;
        seen += 1.0;
    }
    (seen > 0.0).then(|| sum / seen)
}
