//! What should survive a power cut, when it is worth a write.

use plant_core::Real;
use plant_core::num::{min, sqrt};

use super::state::lock_out;
use super::{Bms, BmsState};
use crate::contactor::{Coils, Phase};
use crate::protect::Clear;
use crate::store::record::Record;

/// A state of charge, a capacity or a resistance that has changed by this much is worth a write, and
/// so is this much of a capacity that went in or out. Chosen: at a full cycle a day some hundred
/// writes, which flash memory bears for its life.
const CHANGED: Real = 0.02;

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// What should be stored now, where it is worth a write: the contactors have opened, a fault locks
    /// them, charge or health have changed by 2 %, 2 % of the capacity went in or out, a precharge is
    /// about to begin. `now_s` is the product's clock \[s\], where one runs. It counts as stored.
    ///
    /// Ask after every tick, at least twice within `contactors.settle_s`: the heat that a precharge may
    /// leave in the resistor is booked before it begins, or one power cut after the other would burn
    /// it. While power flows the record is that of a battery that goes on: its charge is known 1 %
    /// less well, its polarisation not at all.
    pub fn record(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        now_s: Option<u32>,
    ) -> Option<Record> {
        let phase = state.contactors.phase();
        let mut record = self.worth_keeping(state, now_s);
        if state.contactors.coils() != Coils::default() {
            let (soc_sd, open) = (record.soc_sd, 0.5 * CHANGED);
            record.soc_sd = min(1.0, sqrt(soc_sd * soc_sd + open * open));
            record.polarisation = None;
        }
        let opened = state.was_closed && matches!(phase, Phase::Standby | Phase::Fault);
        let begins = phase == Phase::CloseMinus;
        if begins {
            record.resistor_heat_j += self.of.params().precharge.short_j;
        }
        let capacity_ah = record.capacity_ah * Real::from(self.of.params().sheet.layout.parallel);
        let worth = opened
            || state.recorded.is_none_or(|last| {
                begins && last.resistor_heat_j < record.resistor_heat_j
                    || changed(&last, &record, capacity_ah)
            });
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

fn changed(last: &Record, now: &Record, capacity_ah: Real) -> bool {
    let moved = |a: Real, b: Real, by: Real| (a - b).abs() > by;
    last.lock_out_cause != now.lock_out_cause
        || moved(last.soc, now.soc, CHANGED)
        || moved(last.throughput_ah, now.throughput_ah, CHANGED * capacity_ah)
        || moved(last.capacity_ah, now.capacity_ah, CHANGED * last.capacity_ah)
        || moved(last.resistance_factor, now.resistance_factor, CHANGED * last.resistance_factor)
}
