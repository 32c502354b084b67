//! A BMS attacked through the plant: a fault in a pack that drives, judged by physics.
//!
//! Each case is driven twice: with the BMS, and with the contactors held closed from the moment that it
//! first opened, until a true cell leaves its absolute limits. The difference is how long before the
//! harm it opened. What the BMS sees goes through sensors with noise; what is judged are the true cells.

mod demand;
mod report;
mod rig;
pub mod scenario;
mod virtual_pack;

use demand::{CHARGER_A, Demand};
pub use report::{Kind, Report, Unnoticed};
pub use rig::Harm;
use rig::Rig;
pub use virtual_pack::VirtualPack;

use plant_core::presets::PANASONIC_NCR18650PF;
use plant_core::{ParamError, must};
use rayon::prelude::*;
use serde::Serialize;
use voltstep_bms::Health;
use voltstep_bms::contactor::{Cause, Coils, Phase};
use voltstep_bms::estimate::ekf::{EkfMemory, Polarisation};
use voltstep_bms::limit::Request;
use voltstep_bms::manage::{Asked, Bms, BmsParams, BmsState, Description};
use voltstep_bms::protect::{
    CellSheet, Currents, EXAMPLE, Faults, Layout, PackSheet, Trip, VoltageWindow,
};
use voltstep_bms::store::record::Record;

use crate::read::scenario::{CELLS, Fault, Planted, SENSORS, When};

const PARALLEL: u8 = 20;
const PRECHARGE_OHM: f32 = 33.0;
/// A pack of 14 groups of 20 cells of the size 18650, as their data sheet states them.
const SHEET: PackSheet = PackSheet {
    cell: CellSheet {
        voltage: VoltageWindow {
            deep_v: 1.5,
            absolute_min_v: 2.3,
            operating_min_v: 2.7,
            operating_max_v: 4.2,
            absolute_max_v: 4.3,
        },
        discharge: Currents { continuous_a: 5.8, ten_seconds_a: 8.7 },
        charge: Currents { continuous_a: 2.0, ten_seconds_a: 4.0 },
        capacity_ah: 2.9,
        resistance_ohm: 0.1,
        heat_capacity_j_per_k: 45.0,
        ..EXAMPLE.cell
    },
    layout: Layout { series: 14, parallel: PARALLEL as u16 },
    ..EXAMPLE
};
static PACK: Description =
    must!(Description::new(BmsParams::typical(SHEET, PANASONIC_NCR18650PF, PRECHARGE_OHM)));
const BMS: Bms<CELLS, SENSORS> = must!(Bms::new(&PACK));

/// States of charge and temperatures \[°C\] that each fault is planted at.
const SOCS: [f32; 4] = [0.03, 0.2, 0.6, 0.97];
const TEMPERATURES_C: [f32; 4] = [-15.0, 10.0, 25.0, 42.0];
/// From here on the limits leave next to nothing of a charger's current.
const FULL_SOC: f32 = 0.9;
/// The contactors are asked to close at this time, faults come later \[ms\].
const ASKED_MS: u32 = 300;
const FAULT_MS: u32 = 3000;
/// So long it is watched from then on \[ms\].
const WATCHED_MS: u32 = 20_000;
/// Likewise, where it shows by a temperature: some times as long as warming is measured over.
const WARMED_MS: u32 = 60_000;
/// Likewise, where cells must warm up by their own current, and this current \[A\]: it warms them by some
/// steps of their sensors, where the limits leave it.
const DRIVEN_WARM_MS: u32 = 150_000;
const WARMS_A: f32 = 100.0;
/// Then the drive ends as every drive does: what shows with open contactors shows within this \[ms\].
const ENDED_MS: u32 = 5000;

/// One case.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Case {
    /// What is planted.
    pub fault: Fault,
    /// 0..3.
    pub severity: usize,
    /// How much of it, in the unit that it has.
    pub much: f32,
    /// State of charge at the start, 0..1.
    pub soc: f32,
    /// Temperature of cells and surroundings \[°C\].
    pub temperature_c: f32,
    /// A charger is on; otherwise it is driven.
    pub charging: bool,
    /// When it is planted \[ms\].
    pub from_ms: u32,
    #[serde(skip)]
    seed: u32,
}

/// What came of it, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing was noticed and nothing harmed, for a reason that was known before.
    Harmless,
    /// It was written down or power was taken back, and no cell was harmed.
    Noticed,
    /// The contactors opened, or did not close, and no cell was harmed.
    InTime,
    /// A cell left its limits in the end, or in the open pack: nothing that contactors can do.
    BeyondContactors,
    /// It should have been noticed.
    Missed,
    /// A cell was harmed first.
    Late,
}

impl Verdict {
    /// Every one, in the order in which they are shown.
    pub const ALL: [Self; 6] = [
        Self::InTime,
        Self::Noticed,
        Self::Harmless,
        Self::BeyondContactors,
        Self::Missed,
        Self::Late,
    ];
}

/// A case and its judgement.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// The case.
    pub case: Case,
    /// What came of it.
    pub verdict: Verdict,
    /// From the fault until the contactors were told to open \[ms\].
    pub opened_ms: Option<u32>,
    /// So long before a cell would have left its limits, had they stayed closed \[ms\].
    pub before_harm_ms: Option<u32>,
    /// What a cell has left behind, with the BMS.
    pub harm: Option<Harm>,
    /// Why it need not be noticed.
    pub reason: Option<&'static str>,
    /// Rows that had tripped before the fault.
    pub before: Vec<String>,
    /// Rows that tripped after it, and would not have without it.
    pub rows: Vec<String>,
    /// They did when the drive had ended, before the next.
    pub at_the_end: bool,
    /// Rows that asked for the contactors to open without the fault.
    pub without: Vec<String>,
}

/// Every `each`th of all cases.
#[must_use]
pub fn cases(each: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut seed = 1_u32;
    for fault in Fault::ALL {
        for (severity, much) in fault.severities().into_iter().enumerate() {
            for (index, soc) in SOCS.into_iter().enumerate() {
                for (other, temperature_c) in TEMPERATURES_C.into_iter().enumerate() {
                    seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let from_ms = match fault.when() {
                        When::Before => 0,
                        When::Closed => FAULT_MS + (seed >> 8) % 1000,
                    };
                    // The charger is on in every second of them, at either end of the curve.
                    let charging = match fault {
                        Fault::Overcharge => true,
                        // A charger takes half an hour to warm cells up.
                        Fault::Overload | Fault::TemperatureStuck => false,
                        // What a charger's current does not reach is met by driving alone.
                        Fault::CurrentSaturated if much > CHARGER_A => false,
                        // Full, or too cold to be charged: a current that does not flow tests no sensor.
                        _ if temperature_c < SHEET.cell.charge_window.none_below_c => false,
                        _ if fault.of_current() && soc > FULL_SOC => false,
                        _ => (index + other + severity) % 2 == 0,
                    };
                    cases.push(Case {
                        fault,
                        severity,
                        much,
                        soc,
                        temperature_c,
                        charging,
                        from_ms,
                        seed,
                    });
                }
            }
        }
    }
    cases.into_iter().step_by(each.max(1)).collect()
}

/// Drives every `each`th case, and so many hours without a fault.
///
/// # Errors
/// A parameter set that is refused.
pub fn run(each: usize, hours: f64) -> Result<Report, ParamError> {
    let judged: Result<Vec<_>, _> = cases(each).par_iter().map(judge).collect();
    let quarters = (hours * 4.0).ceil();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few hours")]
    let quarters = quarters as u32;
    let quiet: Result<Vec<_>, _> = (0..quarters).into_par_iter().map(quarter).collect();
    let false_trips = quiet?.into_iter().flatten().collect();
    Ok(Report::new(judged?, f64::from(quarters) / 4.0, false_trips))
}

/// A BMS on its pack.
struct Drive {
    rig: Rig,
    state: BmsState<CELLS, SENSORS>,
    demand: Demand,
    asked: Request,
    /// The request ends \[ms\].
    until_ms: u32,
}

impl Drive {
    fn new(
        (soc, temperature_c): (f32, f32),
        demand: Demand,
        seed: u32,
        planted: Vec<Planted>,
    ) -> Result<Self, ParamError> {
        let memory = EkfMemory { soc, soc_sd: 0.02, ..EkfMemory::UNKNOWN };
        let record = Record {
            written_at_s: Some(100),
            polarisation: Some(Polarisation::NONE),
            ..Record::of(memory, Health::as_new(PACK.battery()))
        };
        let charging = matches!(demand, Demand::Constant(current_a) if current_a < 0.0);
        Ok(Self {
            rig: Rig::new(soc, temperature_c, seed, planted)?,
            state: BMS.start(Some(&record), Some(160), temperature_c)?,
            demand,
            asked: if charging { Request::Charge } else { Request::Drive },
            until_ms: u32::MAX,
        })
    }

    fn step(&mut self) {
        let limits = *self.state.limits();
        self.rig.drive(&limits, &self.demand);
        self.rig.advance();
        let asked = self.rig.ms > ASKED_MS && self.rig.ms < self.until_ms;
        let vehicle = if asked { self.asked } else { Request::Off };
        BMS.request(&mut self.state, Asked { vehicle, ..Asked::NOTHING });
        BMS.tick(&mut self.state, &mut self.rig);
    }

    fn phase(&self) -> Phase {
        self.state.contactors().phase()
    }
}

/// What was seen of a drive with faults.
#[derive(Clone, Copy)]
struct Seen {
    /// Rows that had tripped before the first.
    already: Faults,
    /// Rows that tripped after it.
    rows: Faults,
    /// Of these, the ones that did before the drive was to end.
    driven: Faults,
    trip: Trip,
    /// The contactors were closed once.
    reached: bool,
    /// They opened after the first fault though they were asked to stay closed \[ms\].
    opened_ms: Option<u32>,
    /// So long before harm, had they stayed closed \[ms\].
    before_harm_ms: Option<u32>,
}

/// Drives until an end, a harm, or shortly after the contactors have opened, and from there once more
/// as if nobody had reacted: contactors held closed, limits as before the first fault; says each step.
fn watch(drive: &mut Drive, from_ms: u32, end_ms: u32, mut each: impl FnMut(&Drive)) -> Seen {
    let mut seen = Seen {
        already: Faults::NONE,
        rows: Faults::NONE,
        driven: Faults::NONE,
        trip: Trip::None,
        reached: false,
        opened_ms: None,
        before_harm_ms: None,
    };
    let mut fork = None;
    let mut before = *drive.state.limits();
    for ms in 1..=end_ms {
        drive.step();
        each(drive);
        let verdict = drive.state.verdict();
        let asked = ms < drive.until_ms;
        if ms > from_ms {
            seen.rows = seen.rows.union(verdict.tripped).union(verdict.latched);
            if asked {
                seen.driven = seen.rows;
            }
            seen.trip = seen.trip.max(verdict.trip);
        } else {
            seen.already = verdict.tripped;
            before = *drive.state.limits();
        }
        let phase = drive.phase();
        seen.reached |= phase == Phase::Closed;
        let opens = seen.reached && !matches!(phase, Phase::Closed | Phase::Shed);
        if opens && asked && seen.opened_ms.is_none() && ms > from_ms {
            seen.opened_ms = Some(ms);
            fork = Some(drive.rig.clone());
        }
        if drive.rig.harm.is_some() || seen.opened_ms.is_some_and(|at_ms| ms > at_ms + FAULT_MS) {
            break;
        }
    }
    seen.before_harm_ms = fork.and_then(|mut rig| {
        rig.held = Some(Coils { minus: true, precharge: false, plus: true });
        let from_ms = rig.ms;
        while rig.harm.is_none() && rig.ms < from_ms + 2 * WATCHED_MS {
            rig.drive(&before, &drive.demand);
            rig.advance();
        }
        rig.harm.map(|_| rig.ms - from_ms)
    });
    seen.rows = seen.rows.minus(seen.already);
    seen.driven = seen.driven.minus(seen.already);
    seen
}

impl Seen {
    /// Less what was seen of the same drive without a fault: that is no answer to it.
    fn beyond(self, healthy: &Self) -> Self {
        Self {
            rows: self.rows.minus(healthy.rows),
            driven: self.driven.minus(healthy.rows),
            trip: if self.trip > healthy.trip { self.trip } else { Trip::None },
            opened_ms: self.opened_ms.filter(|_| healthy.opened_ms.is_none()),
            ..self
        }
    }

    fn noticed(&self) -> bool {
        !self.rows.is_empty() || self.trip > Trip::None
    }

    /// What came of a fault, for which there is a reason not to notice it or none.
    fn verdict(&self, drive: &Drive, fault: Fault, reason: Option<&'static str>) -> Verdict {
        let cause = drive.state.contactors().cause();
        let refused = fault.when() == When::Before && (!self.reached || cause != Cause::None);
        match drive.rig.harm {
            Some(_) if self.opened_ms.is_some() => Verdict::BeyondContactors,
            Some(_) => Verdict::Late,
            None if self.opened_ms.is_some() || refused => Verdict::InTime,
            None if self.noticed() => Verdict::Noticed,
            None if reason.is_some() || !self.reached => Verdict::Harmless,
            None => Verdict::Missed,
        }
    }
}

/// How long a fault is driven with, and watched after the drive \[ms\].
fn watched_ms(fault: Fault) -> (u32, u32) {
    match fault {
        // A weld is looked for once the contactors have opened, while the link falls.
        _ if fault.shows_when_opening() => (FAULT_MS, WATCHED_MS),
        Fault::CellHeated => (WARMED_MS, ENDED_MS),
        Fault::TemperatureStuck => (DRIVEN_WARM_MS, ENDED_MS),
        _ => (WATCHED_MS, ENDED_MS),
    }
}

/// Drives a case with the BMS, then without; and with the BMS, but without the fault.
fn judge(case: &Case) -> Result<Judged, ParamError> {
    let place = (case.soc, case.temperature_c);
    let (driven_ms, ended_ms) = watched_ms(case.fault);
    let until_ms = case.from_ms + FAULT_MS + driven_ms;
    let start = |planted| -> Result<Drive, ParamError> {
        let demand = match case.fault {
            Fault::TemperatureStuck => Demand::Constant(WARMS_A),
            _ => Demand::of(case.charging),
        };
        Ok(Drive { until_ms, ..Drive::new(place, demand, case.seed, planted)? })
    };
    let mut drive = start(vec![Planted::new(case.fault, case.much, case.from_ms)])?;
    let seen = watch(&mut drive, case.from_ms, until_ms + ended_ms, |_| {});
    let healthy = watch(&mut start(Vec::new())?, case.from_ms, drive.rig.ms, |_| {});
    let seen = seen.beyond(&healthy);
    let reason = case.fault.need_not_be_noticed(case.severity);
    let verdict = seen.verdict(&drive, case.fault, reason);
    Ok(Judged {
        case: *case,
        verdict,
        opened_ms: seen.opened_ms.map(|ms| ms - case.from_ms),
        before_harm_ms: seen.before_harm_ms,
        harm: drive.rig.harm,
        reason: if verdict == Verdict::Harmless { reason } else { None },
        before: names(seen.already),
        rows: names(seen.rows),
        at_the_end: verdict == Verdict::Noticed && seen.driven.is_empty(),
        without: if healthy.trip > Trip::None { names(healthy.rows) } else { Vec::new() },
    })
}

fn names(rows: Faults) -> Vec<String> {
    rows.iter().map(|id| format!("{id:?}")).collect()
}

/// A quarter of an hour without a fault; what tripped all the same.
fn quarter(number: u32) -> Result<Vec<String>, ParamError> {
    let socs = [0.9, 0.7, 0.5, 0.35];
    let celsius = [10.0, 25.0, 35.0];
    let place = (socs[number as usize % 4], celsius[number as usize % 3]);
    let mut drive = Drive::new(place, Demand::Pulses, 7 + number, Vec::new())?;
    let mut trips = Vec::new();
    for _ in 0..900_000 {
        drive.step();
        let verdict = drive.state.verdict();
        if verdict.trip > Trip::None && !verdict.rose.is_empty() {
            let rows = names(verdict.rose).join(", ");
            trips.push(format!("{place:?} at {} ms: {rows}", drive.rig.ms));
        }
        if let Some(harm) = drive.rig.harm {
            trips.push(format!("{place:?} at {} ms: {harm:?}", drive.rig.ms));
            break;
        }
    }
    Ok(trips)
}

#[cfg(test)]
mod tests;
