//! One drive with faults of one's own, judged as the campaign judges its cases: by the true cells.

use serde::Serialize;
use voltstep_bms::contactor::Phase;
use voltstep_bms::log::Kind;
use voltstep_bms::protect::{Faults, Trip};

use super::demand::Demand;
use super::{Drive, FAULT_MS, Harm, PARALLEL, SHEET, Seen, Verdict, WATCHED_MS, names, watch};
use crate::read::input;
use crate::read::scenario::{Course, Planted, Scenario, When};
use crate::simulate::mode::Mode;
use crate::simulate::progress::Unseen;
use crate::simulate::replay::{self, Options};

/// The seed of the pack's cells and of the sensors' noise.
const SEED: u32 = 1;
/// Less of a current is no change that a driver feels \[A\].
const FELT_A: f32 = 1.0;
/// How fast power is taken back is judged over this time \[ms\].
const WINDOW_MS: usize = 100;

/// What came of a scenario. Times count from the moment that the pack is switched on \[ms\].
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// The worst of its faults; `noticed` where there is none and nothing was false.
    pub verdict: Verdict,
    /// Each fault.
    pub faults: Vec<OfFault>,
    /// When the contactors were told to open, after the first fault.
    pub opened_ms: Option<u32>,
    /// Why.
    pub cause: String,
    /// So long before a cell would have left its limits, had they stayed closed; looked at for 40 s.
    pub before_harm_ms: Option<u32>,
    /// What a cell has left behind, with the BMS, and when.
    pub harm: Option<(Harm, u32)>,
    /// What the BMS wrote into its log: the newest 32 events.
    pub recorded: Vec<Recorded>,
    /// What the driver felt.
    pub felt: Felt,
    /// What tripped before the first fault.
    pub false_trips: Vec<String>,
    /// How long was driven.
    pub driven_ms: u32,
}

/// What came of one fault.
#[derive(Clone, Debug, Serialize)]
pub struct OfFault {
    /// What was planted.
    pub planted: Planted,
    /// What came of it; none where the contactors had opened before.
    pub verdict: Option<Verdict>,
    /// Rows that tripped after it, before the next.
    pub rows: Vec<String>,
    /// From the fault to the first of them \[ms\].
    pub noticed_ms: Option<u32>,
    /// Why it need not be noticed.
    pub reason: Option<&'static str>,
}

/// An event of the log.
#[derive(Clone, Debug, Serialize)]
pub struct Recorded {
    /// When.
    pub at_ms: u32,
    /// Which row.
    pub row: String,
    /// What happened to it: it tripped, healed, was cleared.
    pub what: &'static str,
    /// The pack's current \[A\].
    pub current_a: Option<f32>,
    /// Lowest and highest cell \[V\].
    pub cell_v: [Option<f32>; 2],
    /// Hottest sensor \[°C\].
    pub hottest_c: Option<f32>,
}

/// What a driver, or a charger, felt of it.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Felt {
    /// When the limits first took something back of what was asked for.
    pub less_ms: Option<u32>,
    /// The most that they took back \[A\].
    pub most_a: f32,
    /// How fast they took it back at most, over 0.1 s \[A/s\].
    pub fastest_a_per_s: f32,
    /// What still flowed when the contactors were told to open \[A\].
    pub interrupted_a: Option<f32>,
}

impl Judged {
    /// Whether nothing was late, missed or false.
    #[must_use]
    pub fn is_good(&self) -> bool {
        !matches!(self.verdict, Verdict::Missed | Verdict::Late) && self.false_trips.is_empty()
    }
}

/// Drives a scenario with the BMS, then without.
///
/// # Errors
/// A cycle that the vehicle cannot follow; a parameter set that is refused.
pub fn judge(scenario: &Scenario) -> anyhow::Result<Judged> {
    let (demand, course_s) = demand(scenario)?;
    let mut planted = scenario.planted.clone();
    for one in planted.iter_mut().filter(|p| p.fault.when() == When::Before) {
        // Met only by contactors that are to close.
        one.from_ms = 0;
    }
    planted.sort_by_key(|p| p.from_ms);
    let first_ms = planted.first().map_or(u32::MAX, |p| p.from_ms);
    let last_ms = planted.last().map_or(0, |p| p.from_ms);
    let end_ms = scenario.seconds.map_or_else(
        || ms(course_s).saturating_add(FAULT_MS).max(last_ms + FAULT_MS + WATCHED_MS),
        ms,
    );
    let place = (scenario.soc, scenario.temperature_c);
    let mut drive = Drive::new(place, demand, SEED, planted.clone())?;
    if let Some(last) = planted.iter().rfind(|p| p.fault.shows_when_opening()) {
        drive.until_ms = last.from_ms + FAULT_MS;
    }
    let mut trace = Trace::new(&planted);
    let seen = watch(&mut drive, first_ms, end_ms, |drive| trace.look(drive));
    let faults: Vec<_> = trace.found.iter().map(|found| of_fault(found, seen, &drive)).collect();
    let worst = faults.iter().filter_map(|of| of.verdict).max();
    // Harm without a fault is the BMS's own.
    let harmed = drive.rig.harm.map(|_| Verdict::Late);
    Ok(Judged {
        name: scenario.name.clone(),
        verdict: worst.or(harmed).unwrap_or(Verdict::Noticed),
        faults,
        opened_ms: seen.opened_ms,
        cause: format!("{:?}", drive.state.contactors().cause()),
        before_harm_ms: seen.before_harm_ms,
        harm: drive.rig.harm.map(|harm| (harm, drive.rig.ms)),
        recorded: recorded(&drive),
        felt: trace.felt,
        false_trips: trace.false_trips,
        driven_ms: drive.rig.ms,
    })
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "hours at most, ≥ 0")]
fn ms(seconds: f64) -> u32 {
    (seconds * 1000.0).round() as u32
}

/// What is asked for, and how long it lasts \[s\].
fn demand(scenario: &Scenario) -> anyhow::Result<(Demand, f64)> {
    let (drive, vehicle) = match &scenario.course {
        Course::Charged(charge_a) => return Ok((Demand::Constant(-charge_a), 0.0)),
        Course::Driven(drive, vehicle) => (drive, vehicle),
    };
    // The same share of the capacity in an hour.
    let capacity_ah = SHEET.cell.capacity_ah * f32::from(PARALLEL);
    let factor = f64::from(capacity_ah / vehicle.powertrain.battery.capacity_ah());
    let (time_s, current_a): (Vec<f64>, Vec<f64>) = match drive {
        input::Drive::Trip(trip) => (trip.time_s.clone(), trip.battery_a.clone()),
        input::Drive::Cycle(_) | input::Drive::Profile(_) => {
            let options =
                Options { mode: Mode::Vehicle, dt_s: replay::DEFAULT_STEP_S, ledger: false };
            let run = replay::replay(vehicle, drive.clone(), options, &Unseen)?.run;
            run.trace.iter().map(|row| (row.time_s, f64::from(row.battery_current_a))).unzip()
        }
    };
    let long_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
    Ok((Demand::course(FAULT_MS, &time_s, &current_a, factor), long_s))
}

/// What followed a fault, until the next.
struct Found {
    planted: Planted,
    until_ms: u32,
    /// What was asked of the contactors before.
    before: Trip,
    rows: Faults,
    first_ms: Option<u32>,
    trip: Trip,
}

/// What came of a fault: of what the whole drive showed, what lies between it and the next.
fn of_fault(found: &Found, seen: Seen, drive: &Drive) -> OfFault {
    let Found { planted, until_ms, before, rows, first_ms, trip } = *found;
    let reason = planted.fault.need_not_be_noticed(planted.severity());
    let trip = if trip > before { trip } else { Trip::None };
    let gone = seen.opened_ms.is_some_and(|at_ms| at_ms <= planted.from_ms);
    let opened_ms = seen.opened_ms.filter(|at_ms| *at_ms <= until_ms);
    let verdict = Seen { rows, trip, opened_ms, ..seen }.verdict(drive, planted.fault, reason);
    let verdict = if gone || planted.from_ms >= drive.rig.ms { None } else { Some(verdict) };
    let reason = reason.filter(|_| verdict == Some(Verdict::Harmless));
    OfFault { planted, verdict, rows: names(rows), noticed_ms: first_ms, reason }
}

/// The newest events of the log.
fn recorded(drive: &Drive) -> Vec<Recorded> {
    let known = |value: f32| Some(value).filter(|value| value.is_finite());
    let of = |entry: &voltstep_bms::log::Entry| Recorded {
        at_ms: entry.at_ms,
        row: format!("{:?}", entry.id),
        what: match entry.kind {
            Kind::Tripped => "tripped",
            Kind::Healed => "healed",
            Kind::Cleared => "cleared",
        },
        current_a: known(entry.frame.current_a),
        cell_v: entry.frame.cell_v.map(known),
        hottest_c: known(entry.frame.temperature_c[1]),
    };
    drive.state.log().entries().map(of).collect()
}

/// What is looked at each step.
struct Trace {
    found: Vec<Found>,
    felt: Felt,
    withheld_a: [f32; WINDOW_MS],
    closed: bool,
    false_trips: Vec<String>,
}

impl Trace {
    fn new(planted: &[Planted]) -> Self {
        let ends = planted.iter().skip(1).map(|p| p.from_ms).chain([u32::MAX]);
        let found = planted.iter().zip(ends).map(|(planted, until_ms)| Found {
            planted: *planted,
            until_ms,
            before: Trip::None,
            rows: Faults::NONE,
            first_ms: None,
            trip: Trip::None,
        });
        Self {
            found: found.collect(),
            felt: Felt::default(),
            withheld_a: [0.0; WINDOW_MS],
            closed: false,
            false_trips: Vec::new(),
        }
    }

    fn look(&mut self, drive: &Drive) {
        let (ms, verdict) = (drive.rig.ms, drive.state.verdict());
        for found in &mut self.found {
            if ms <= found.planted.from_ms {
                found.before = verdict.trip;
            } else if ms <= found.until_ms {
                found.rows = found.rows.union(verdict.rose);
                found.trip = found.trip.max(verdict.trip);
                if !verdict.rose.is_empty() {
                    found.first_ms.get_or_insert(ms - found.planted.from_ms);
                }
            }
        }
        let quiet = self.found.first().is_none_or(|first| ms <= first.planted.from_ms);
        if quiet && verdict.trip > Trip::None && !verdict.rose.is_empty() {
            self.false_trips.push(format!("{} at {ms} ms", names(verdict.rose).join(", ")));
        }
        self.feel(drive, quiet && !self.found.is_empty());
    }

    /// Before the first fault, limits that are still rising are no news.
    fn feel(&mut self, drive: &Drive, before: bool) {
        let rig = &drive.rig;
        let ran = self.closed;
        self.closed = matches!(drive.phase(), Phase::Closed | Phase::Shed);
        if ran && !self.closed {
            self.felt.interrupted_a.get_or_insert(rig.battery_a);
        }
        let slot = &mut self.withheld_a[rig.ms as usize % WINDOW_MS];
        let earlier_a = std::mem::replace(slot, rig.withheld_a);
        if before || !self.closed || rig.withheld_a < FELT_A {
            return;
        }
        let felt = &mut self.felt;
        felt.less_ms.get_or_insert(rig.ms);
        felt.most_a = felt.most_a.max(rig.withheld_a);
        #[expect(clippy::cast_precision_loss, reason = "100")]
        let per_s = 1000.0 / WINDOW_MS as f32;
        felt.fastest_a_per_s = felt.fastest_a_per_s.max((rig.withheld_a - earlier_a) * per_s);
    }
}
