//! What should survive a power cut, when it is worth a write.

use plant_core::Real;

use super::state::lock_out;
use super::{Bms, BmsState};
use crate::contactor::Phase;
use crate::protect::Clear;
use crate::store::record::Record;

/// A state of charge, a capacity or a resistance that has changed by this much is worth a write.
/// Chosen: at a full cycle a day some hundred writes, which flash memory bears for its life.
const CHANGED: Real = 0.02;

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// What should be stored now, where it is worth a write: the contactors have opened, a fault locks
    /// them, charge or health have changed by 2 %. `now_s` is the product's clock \[s\], where one runs.
    /// It counts as stored.
    pub fn record(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        now_s: Option<u32>,
    ) -> Option<Record> {
        let record = self.worth_keeping(state, now_s);
        let phase = state.contactors.phase();
        let opened = state.was_closed && matches!(phase, Phase::Standby | Phase::Fault);
        let worth = opened || state.recorded.is_none_or(|last| changed(&last, &record));
        if !worth {
            return None;
        }
        if opened {
            state.was_closed = false;
        }
        state.recorded = Some(record);
        Some(record)
    }

    /// All that a record holds, before the power goes.
    #[must_use]
    pub fn worth_keeping(&self, state: &BmsState<CELLS, SENSORS>, now_s: Option<u32>) -> Record {
        let table = self.of.table();
        let locks = |id: &_| table.row(*id).clear >= Clear::Service;
        let row = state.verdict.latched.iter().find(locks);
        let memory = self.series.filter.remember(&state.series.filter);
        Record {
            throughput_ah: state.throughput_ah.get(),
            written_at_s: now_s,
            resistor_heat_j: state.precharge.heat_j(),
            lock_out_cause: lock_out(state.contactors.cause(), row),
            log_sequence: state.log.newest().unwrap_or(0),
            ..Record::of(memory, state.series.health)
        }
    }
}

fn changed(last: &Record, now: &Record) -> bool {
    let moved = |a: Real, b: Real, by: Real| (a - b).abs() > by;
    last.lock_out_cause != now.lock_out_cause
        || moved(last.soc, now.soc, CHANGED)
        || moved(last.capacity_ah, now.capacity_ah, CHANGED * last.capacity_ah)
        || moved(last.resistance_factor, now.resistance_factor, CHANGED * last.resistance_factor)
}
