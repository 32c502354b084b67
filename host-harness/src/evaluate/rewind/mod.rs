//! A recording of a BMS, run again: to the same bits, and beside it with other parameters.

mod change;

pub use change::{Change, ChangeError};

use std::time::Duration;

use serde::Serialize;
use voltstep_bms::contactor::{Coils, Phase};
use voltstep_bms::manage::recorder::{Recording, RecordingError};
use voltstep_bms::manage::{Bms, BmsState, Description};
use voltstep_bms::protect::{Faults, Trip};

/// What came of it.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Cells and temperatures of the pack.
    pub size: (u16, u16),
    /// Calls that were recorded.
    pub calls: u32,
    /// The time between the first and the last \[s\].
    pub seconds: f64,
    /// Whether the state at the end is that of the recording, to the last bit.
    pub same: bool,
    /// What happened.
    pub was: History,
    /// What would have happened with other parameters.
    pub supposed: Option<History>,
}

/// What happened in one run.
#[derive(Debug, Serialize)]
pub struct History {
    /// In the order of time.
    pub events: Vec<Event>,
    /// When a row first had the contactors open \[s\].
    pub trips_s: Option<f64>,
    /// From when on the contactors are told something else than in the recording \[s\]: its inputs are
    /// then no longer what would have been, and the run ends there.
    pub apart_s: Option<f64>,
}

/// One of them.
#[derive(Debug, PartialEq, Serialize)]
pub struct Event {
    /// Since the first call \[s\].
    pub at_s: f64,
    /// What it was.
    pub what: What,
}

/// What it was.
#[derive(Debug, PartialEq, Serialize)]
pub enum What {
    /// A row tripped.
    Tripped(String),
    /// A row healed.
    Healed(String),
    /// The contactors went on, and why.
    Phase(String, String),
}

/// Why a recording is not run.
#[derive(Debug, thiserror::Error)]
pub enum RewindError {
    /// The bytes are none.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A pack of a size that the command was not built for.
    #[error(
        "a pack of {0} cells and {1} temperatures; this command knows {sizes}, others are run by \
         `voltstep::evaluate::rewind::of`",
        sizes = sizes()
    )]
    Size(u16, u16),
    /// The description in it is refused.
    #[error("the description of the pack: {0}")]
    Params(voltstep_bms::ParamError),
    /// What is to be changed.
    #[error(transparent)]
    Change(#[from] ChangeError),
}

macro_rules! sizes {
    ($(($cells:literal, $sensors:literal)),+) => {
        /// The sizes of packs that [`rewind`] knows.
        pub const SIZES: &[(u16, u16)] = &[$(($cells, $sensors)),+];

        /// Runs a recording again, and with changes where there are any.
        ///
        /// # Errors
        /// [`RewindError`] says why it cannot.
        pub fn rewind(bytes: &[u8], changes: &[Change]) -> Result<Report, RewindError> {
            let recording = Recording::read(bytes)?;
            match recording.size() {
                $(($cells, $sensors) => of::<$cells, $sensors>(&recording, changes),)+
                (cells, sensors) => Err(RewindError::Size(cells, sensors)),
            }
        }
    };
}

sizes![(14, 3), (14, 4), (18, 4), (96, 24)];

fn sizes() -> String {
    let sizes: Vec<_> = SIZES.iter().map(|(c, s)| format!("{c} and {s}")).collect();
    sizes.join(", ")
}

/// The same for a pack of any size that is known when compiling.
///
/// # Errors
/// [`RewindError`] says why it cannot.
pub fn of<const CELLS: usize, const SENSORS: usize>(
    recording: &Recording,
    changes: &[Change],
) -> Result<Report, RewindError> {
    let params = recording.params()?;
    let description = Description::new(params).map_err(RewindError::Params)?;
    let run = run::<CELLS, SENSORS>(recording, description, None)?;
    let supposed = if changes.is_empty() {
        None
    } else {
        let description = change::applied(params, changes)?;
        Some(self::run::<CELLS, SENSORS>(recording, description, Some(&run.coils))?.history)
    };
    let Run { calls, seconds, last, history, .. } = run;
    let same = recording.ends_with(&last);
    Ok(Report { size: recording.size(), calls, seconds, same, was: history, supposed })
}

struct Run<const CELLS: usize, const SENSORS: usize> {
    calls: u32,
    seconds: f64,
    last: BmsState<CELLS, SENSORS>,
    /// What the contactors were told in each call.
    coils: Vec<Coils>,
    history: History,
}

/// What is looked at from call to call.
fn seen<const CELLS: usize, const SENSORS: usize>(
    state: &BmsState<CELLS, SENSORS>,
) -> (Faults, Phase) {
    (state.verdict().tripped, state.contactors().phase())
}

fn run<const CELLS: usize, const SENSORS: usize>(
    recording: &Recording,
    description: Description,
    told: Option<&[Coils]>,
) -> Result<Run<CELLS, SENSORS>, RewindError> {
    // A BMS borrows its description for good, as from flash memory; there is one for each run.
    let description: &'static Description = Box::leak(Box::new(description));
    let bms: Bms<CELLS, SENSORS> = Bms::new(description).map_err(RewindError::Params)?;
    let mut state = recording.state()?;
    let mut playback = recording.playback();
    let mut history = History { events: Vec::new(), trips_s: None, apart_s: None };
    let mut coils = Vec::new();
    let (mut calls, mut began_us, mut at_s) = (0, None, 0.0);
    let (mut tripped, mut phase) = seen(&state);
    let mut standing = state.verdict().trip;
    while playback.next(&bms, &mut state)?.is_some() {
        calls += 1;
        let uptime_us = state.uptime_us().unwrap_or(0);
        let since = uptime_us.saturating_sub(*began_us.get_or_insert(uptime_us));
        at_s = Duration::from_micros(since).as_secs_f64();
        let (now, now_phase) = seen(&state);
        let mut event = |what| history.events.push(Event { at_s, what });
        for id in now.minus(tripped).iter() {
            event(What::Tripped(format!("{id:?}")));
        }
        for id in tripped.minus(now).iter() {
            event(What::Healed(format!("{id:?}")));
        }
        if now_phase != phase {
            event(What::Phase(
                format!("{now_phase:?}"),
                format!("{:?}", state.contactors().cause()),
            ));
        }
        let trip = state.verdict().trip;
        if trip > Trip::None && standing == Trip::None && history.trips_s.is_none() {
            history.trips_s = Some(at_s);
        }
        (tripped, phase, standing) = (now, now_phase, trip);
        let now_told = state.contactors().coils();
        if told.is_some_and(|told| told.get(coils.len()) != Some(&now_told)) {
            history.apart_s = Some(at_s);
            break;
        }
        coils.push(now_told);
    }
    Ok(Run { calls, seconds: at_s, last: state, coils, history })
}

#[cfg(test)]
mod tests;
