//! The state of a BMS, and what is asked of it.

use plant_core::{Accum, ParamError, Real};

use super::samples::Samples;
use super::{Bms, Description};
use crate::balance::BalancerState;
use crate::comm::can::{CHARGER, REQUEST, RequestWatchState};
use crate::contactor::{Cause, ContactorState, Feedback, LinkTrendState, PrechargeState};
use crate::estimate::cells::CellResistancesState;
use crate::estimate::ekf::EkfMemory;
use crate::estimate::energy::{EnergyReport, EnergyState, EnergyWalk};
use crate::estimate::power::{HORIZONS, PowerAhead, PowerWalk};
use crate::estimate::series::SeriesState;
use crate::limit::{Limits, Mode, Request};
use crate::log::Log;
use crate::protect::{Clear, Faults, Id, ProtectionState, Trip, Verdict};
use crate::store::record::Record;
use crate::{Health, Measurements};

/// What vehicle and charger ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Asked {
    /// The vehicle.
    pub vehicle: Request,
    /// The charger.
    pub charger: Request,
    /// Which faults to end; each wish counts once.
    pub clear: Clear,
    /// What is wrong with their messages.
    pub flags: Faults,
}

impl Asked {
    /// Nobody is there.
    pub const NOTHING: Self = Self {
        vehicle: Request::Silent,
        charger: Request::Silent,
        clear: Clear::No,
        flags: Faults::NONE,
    };

    /// What was heard over the bus.
    pub fn heard(vehicle: &mut RequestWatchState, charger: &mut RequestWatchState) -> Self {
        let (by_vehicle, by_charger) = (vehicle.take_clear(), charger.take_clear());
        Self {
            vehicle: vehicle.request(),
            charger: charger.request(),
            clear: if by_vehicle > by_charger { by_vehicle } else { by_charger },
            flags: REQUEST.faults(vehicle).union(CHARGER.faults(charger)),
        }
    }
}

/// What a [`Bms`] remembers from call to call; [`Bms::start`] makes one.
#[derive(Clone, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct BmsState<const CELLS: usize, const SENSORS: usize> {
    pub(super) now: Measurements<CELLS, SENSORS>,
    /// `None` before the first call.
    pub(super) uptime_us: Option<u64>,
    pub(super) asked: Asked,
    pub(super) mode: Mode,
    pub(super) protection: ProtectionState<CELLS, SENSORS>,
    pub(super) verdict: Verdict,
    pub(super) contactors: ContactorState,
    pub(super) feedback: [Feedback; 3],
    pub(super) pin_failed: bool,
    /// The filter contradicts itself.
    pub(super) contradicts: bool,
    pub(super) precharge: PrechargeState,
    /// Ticks in the phase of precharge, and whether it shows closed.
    pub(super) precharge_ticks: u16,
    pub(super) precharge_closed: bool,
    pub(super) trend: LinkTrendState,
    pub(super) samples: Samples<CELLS>,
    pub(super) series: SeriesState<CELLS>,
    pub(super) resistances: CellResistancesState<CELLS>,
    pub(super) energy: EnergyState,
    pub(super) energy_walk: EnergyWalk,
    pub(super) energy_left: Option<EnergyReport>,
    pub(super) power_walk: PowerWalk,
    pub(super) power: Option<[PowerAhead; HORIZONS]>,
    /// How far the slices of this second have come.
    pub(super) slice: usize,
    pub(super) limits: Limits,
    pub(super) balancer: BalancerState<CELLS>,
    pub(super) balancing: bool,
    /// A cell is bled.
    pub(super) bleeding: bool,
    /// The samples of this second, as the series counts them.
    pub(super) sample: u32,
    /// Whose turn it is among the cells.
    pub(super) turn: u16,
    /// Ticks since the last sample, in a single loop.
    pub(super) since_filter: u32,
    pub(super) rested_s: Real,
    pub(super) throughput_ah: Accum,
    pub(super) log: Log,
    /// As of the last record; what was stored is the product's matter, so a checkpoint leaves it out.
    #[cfg_attr(feature = "recorder", serde(skip))]
    pub(super) recorded: Option<Record>,
    #[cfg_attr(feature = "recorder", serde(skip))]
    pub(super) was_closed: bool,
}

impl<const CELLS: usize, const SENSORS: usize> BmsState<CELLS, SENSORS> {
    /// What was measured last.
    #[must_use]
    pub const fn measurements(&self) -> &Measurements<CELLS, SENSORS> {
        &self.now
    }

    /// When the last call was, on the board's clock \[µs\]; `None` before the first.
    #[must_use]
    pub const fn uptime_us(&self) -> Option<u64> {
        self.uptime_us
    }

    /// What the rows say.
    #[must_use]
    pub const fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Where the contactors are.
    #[must_use]
    pub const fn contactors(&self) -> &ContactorState {
        &self.contactors
    }

    /// What may be drawn and fed.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The log.
    #[must_use]
    pub const fn log(&self) -> &Log {
        &self.log
    }

    /// The log, to say what was stored.
    pub const fn log_mut(&mut self) -> &mut Log {
        &mut self.log
    }

    /// The estimators of the cells in series, in the units of one cell.
    #[must_use]
    pub const fn series(&self) -> &SeriesState<CELLS> {
        &self.series
    }
}

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// After a reset: from a record and the product's clock \[s\], where there are, and a first
    /// temperature \[°C\]. A record that is damaged is none. Without a record nothing is known of the
    /// charge.
    ///
    /// # Errors
    /// [`ParamError`] for a temperature outside −100..200 °C; a field of the record that is refused.
    pub fn start(
        &self,
        record: Option<&Record>,
        now_s: Option<u32>,
        temperature_c: Real,
    ) -> Result<BmsState<CELLS, SENSORS>, ParamError> {
        let memory = record.map_or(EkfMemory::UNKNOWN, Record::memory);
        let health = record.map_or_else(|| new_cell(self.of), Record::health);
        let elapsed_s = record.and_then(|record| record.age_s(now_s));
        let series = self.series.resume(memory, health, elapsed_s, temperature_c)?;
        let heat_j = record.map_or(0.0, |record| record.resistor_heat_j);
        let (cause, lock) = record.map_or((Cause::None, None), locked);
        let cooled_j = elapsed_s.map_or(heat_j, |seconds| {
            let cooling_s = self.of.params().precharge.cooling_s;
            heat_j / (1.0 + seconds / cooling_s)
        });
        Ok(BmsState {
            now: Measurements::NONE,
            uptime_us: None,
            asked: Asked::NOTHING,
            mode: Mode::Off,
            protection: lock.map_or(ProtectionState::NEW, ProtectionState::locked_by),
            verdict: Verdict {
                trip: Trip::None,
                permit: false,
                tripped: Faults::NONE,
                latched: lock.map_or(Faults::NONE, |id| Faults::NONE.with(id)),
                rose: Faults::NONE,
                fell: Faults::NONE,
            },
            contactors: self.contactors.resume(cause),
            feedback: [Feedback::Unknown; 3],
            pin_failed: false,
            contradicts: false,
            precharge: self.precharge.warmed(cooled_j),
            precharge_ticks: 0,
            precharge_closed: false,
            trend: LinkTrendState::NEW,
            samples: Samples::NEW,
            resistances: self.resistances.start(),
            energy: EnergyState::default(),
            energy_walk: EnergyWalk::START,
            energy_left: None,
            power_walk: PowerWalk::START,
            power: None,
            slice: 0,
            limits: Limits::NONE,
            balancer: BalancerState::NEW,
            balancing: false,
            bleeding: false,
            sample: 0,
            turn: 0,
            since_filter: 0,
            rested_s: 0.0,
            throughput_ah: Accum::new(record.map_or(0.0, |record| record.throughput_ah)),
            log: Log::new(record.map_or(0, |record| record.log_sequence.wrapping_add(1))),
            recorded: record.copied(),
            was_closed: false,
            series,
        })
    }

    /// Says what is asked for, from now on.
    pub const fn request(&self, state: &mut BmsState<CELLS, SENSORS>, asked: Asked) {
        state.asked = asked;
    }
}

/// A new cell, known as well as cells are alike.
fn new_cell(of: &Description) -> Health {
    let alike = &of.params().alike;
    Health {
        capacity_sd_ah: alike.capacity_sd * of.params().cell.capacity_ah,
        resistance_factor_sd: alike.resistance_sd,
        ..Health::as_new(of.battery())
    }
}

/// What a record's lock-out means: the cause, and the row beside it.
fn locked(record: &Record) -> (Cause, Option<Id>) {
    let [cause, row] = record.lock_out_cause.to_le_bytes();
    let cause = Cause::at(cause).unwrap_or(Cause::None);
    (cause, row.checked_sub(1).and_then(Id::at))
}

/// The number of a lock-out in a record: what only a workshop may end.
pub(super) fn lock_out(cause: Cause, row: Option<Id>) -> u16 {
    let cause = if cause.needs() >= Clear::Service { cause.code() } else { 0 };
    let row = row.map_or(0, |id| id.index() + 1);
    u16::from_le_bytes([cause, row])
}
