//! Which rows see a bad sample, in one look: nearly always none.

use core::hint::cold_path;

use plant_core::Real;
use plant_core::num::min;

use super::{Fast, Protection, ProtectionState, along};
use crate::protect::id::{Faults, Flow, Id, LEVELS, Level, ROWS, Side, Source};
use crate::protect::look::Taken;
use crate::protect::row::{Pace, Row};
use crate::protect::signals::Signals;

/// A quotient and a product may differ by rounding; what is near is looked at.
const NEARLY: Real = 0.999;

/// A set of rows from the answers to a few questions, which are nearly always no.
macro_rules! where_so {
    ($($id:expr => $bad:expr),+ $(,)?) => {
        if $($bad)||+ {
            cold_path();
            Faults::NONE
                $(.union(if $bad { const { Faults::NONE.with($id) } } else { Faults::NONE }))+
        } else {
            Faults::NONE
        }
    };
}

impl<const CELLS: usize, const SENSORS: usize> Protection<'_, CELLS, SENSORS> {
    /// The rows whose sample is bad, and perhaps some others: a row that rests need not be judged
    /// unless it is among them.
    pub(super) fn bad(
        &self,
        state: &ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
        ends: bool,
    ) -> Faults {
        let bad = signals.flags.union(self.bad_now(state, fast, signals));
        if ends || !self.by_sweep {
            bad.union(self.bad_of_sweep(state, fast, signals))
        } else {
            bad
        }
    }

    const fn limit(&self, id: Id) -> Real {
        self.table.row(id).threshold
    }

    fn bad_now(
        &self,
        state: &ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
    ) -> Faults {
        let unknown = |taken: Taken| taken.value().unwrap_or(Real::NAN);
        let (current_a, pack_v, link_v) =
            (unknown(fast.current), unknown(fast.pack), unknown(fast.link));
        let [discharge_a2s, charge_a2s] = state.heat_a2s;
        let mut bad = where_so!(
            Id::Heat(Flow::Discharge) => discharge_a2s > self.limit(Id::Heat(Flow::Discharge)),
            Id::Heat(Flow::Charge) => charge_a2s > self.limit(Id::Heat(Flow::Charge)),
            Id::PackVoltage(Side::Low) => pack_v < self.limit(Id::PackVoltage(Side::Low)),
            Id::PackVoltage(Side::High) => pack_v > self.limit(Id::PackVoltage(Side::High)),
            Id::ShortCircuit => current_a.abs() > self.limit(Id::ShortCircuit),
            Id::CurrentWhileOpen =>
                signals.all_open && current_a.abs() > self.limit(Id::CurrentWhileOpen),
            Id::LinkDiffers =>
                signals.mains_closed && (pack_v - link_v).abs() > self.limit(Id::LinkDiffers),
            Id::CurrentsDiffer =>
                (current_a - signals.second_current_a).abs() > self.limit(Id::CurrentsDiffer),
            Id::LateStep =>
                signals.elapsed_s > NEARLY * self.limit(Id::LateStep) * self.table.sheet().tick_s,
        );
        for flow in [Flow::Discharge, Flow::Charge] {
            let least_a = match flow {
                Flow::Discharge => state.least_a[0],
                Flow::Charge => state.least_a[1],
            };
            if along(flow, current_a) > least_a {
                bad = bad.union(of_current(flow));
            }
        }
        for (taken, stale, range) in [
            (fast.current, Id::Stale(Source::Current), Id::Range(Source::Current)),
            (fast.pack, Id::Stale(Source::Pack), Id::Range(Source::Pack)),
            (fast.link, Id::Stale(Source::Link), Id::Range(Source::Link)),
        ] {
            match taken {
                Taken::Value(_) => {}
                Taken::Stale => bad = bad.with(stale),
                Taken::OutOfRange => bad = bad.with(range),
            }
        }
        bad
    }

    fn bad_of_sweep(
        &self,
        state: &ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
    ) -> Faults {
        let (cells, temperatures) = (&state.last_cells, &state.last_temperatures);
        let bad = where_so!(
            Id::DeepDischarge => cells.lowest < self.limit(Id::DeepDischarge),
            Id::CellSum => fast
                .pack
                .value()
                .is_some_and(|pack_v| (cells.sum - pack_v).abs() > self.limit(Id::CellSum)),
            Id::Residual => signals.residual_v.abs() > self.limit(Id::Residual),
            Id::CellCount => signals.cells_found.is_some(),
            Id::Imbalance => cells.highest - cells.lowest > self.limit(Id::Imbalance),
            Id::TemperatureSpread =>
                temperatures.highest - temperatures.lowest > self.limit(Id::TemperatureSpread),
            Id::TemperatureRate =>
                state.warming.unexplained_k_per_s > self.limit(Id::TemperatureRate),
            Id::OpenWire => !signals.wires_v.is_empty(),
            Id::Stale(Source::Cell) => cells.stale,
            Id::Stale(Source::Temperature) => temperatures.stale,
            Id::Range(Source::Cell) => cells.out_of_range,
            Id::Range(Source::Temperature) => temperatures.out_of_range,
        );
        let mut bad = bad.union(state.stuck);
        for level in LEVELS {
            let [low, high] = [Side::Low, Side::High].map(|side| Id::CellVoltage(side, level));
            if cells.lowest < self.limit(low) {
                bad = bad.with(low);
            }
            if cells.highest > self.limit(high) {
                bad = bad.with(high);
            }
            for flow in [Flow::Discharge, Flow::Charge] {
                let [low, high] =
                    [Side::Low, Side::High].map(|side| Id::Temperature(flow, side, level));
                if temperatures.lowest < self.limit(low) {
                    bad = bad.with(low);
                }
                if temperatures.highest > self.limit(high) {
                    bad = bad.with(high);
                }
            }
            if signals.insulation_ohm_per_v.is_some() {
                bad = bad.with(Id::Insulation(level));
            }
        }
        bad
    }

    /// Above this no current is bad in a direction \[A\].
    pub(super) fn least_a(&self, state: &ProtectionState<CELLS, SENSORS>) -> [Real; 2] {
        [Flow::Discharge, Flow::Charge].map(|flow| {
            let share = self.share(flow, &state.last_temperatures);
            let mut least_a = share * self.limit(Id::Current(flow, Level::Mol));
            for id in
                [Id::Current(flow, Level::Rsl), Id::Current(flow, Level::Msl), Id::Surge(flow)]
            {
                least_a = min(self.limit(id), least_a);
            }
            NEARLY * least_a
        })
    }
}

/// The rows of a current.
const fn of_current(flow: Flow) -> Faults {
    Faults::NONE
        .with(Id::Current(flow, Level::Mol))
        .with(Id::Current(flow, Level::Rsl))
        .with(Id::Current(flow, Level::Msl))
        .with(Id::Surge(flow))
}

/// The rows that are bad after a sweep alone, as [`Table`](crate::protect::Table) derives them.
pub(super) const fn judged_by_sweep(pace_of: &[Row; ROWS]) -> bool {
    let mut index = 0;
    while index < ROWS {
        let by_sweep = matches!(
            Id::ALL[index],
            Id::CellVoltage(..)
                | Id::Temperature(..)
                | Id::DeepDischarge
                | Id::CellSum
                | Id::Residual
                | Id::CellCount
                | Id::Imbalance
                | Id::TemperatureSpread
                | Id::TemperatureRate
                | Id::OpenWire
                | Id::Insulation(_)
                | Id::StuckCell
                | Id::StuckTemperature
                | Id::StuckCurrent
                | Id::Stale(Source::Cell | Source::Temperature)
                | Id::Range(Source::Cell | Source::Temperature)
        );
        if by_sweep && !matches!(pace_of[index].pace, Pace::Sweep) {
            return false;
        }
        index += 1;
    }
    true
}
