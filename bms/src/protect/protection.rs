//! Measurements judged by every row.

use plant_core::error::check;
use plant_core::num::{LARGEST, max, min};
use plant_core::{ParamError, Real};

use super::debounce::DebounceState;
use super::id::{Faults, Flow, Id, Level, ROWS, Side};
use super::look::{Look, Moves, Taken, taken};
use super::row::{Clear, Pace, Reaction, Row, Trip};
use super::signals::{Signals, Verdict};
use super::steady::{RESISTANCE_RANGE, Steady, SteadyLimits};
use super::table::Table;
use super::warming::{Warming, WarmingLimits};
use crate::Measurements;

mod bad;
mod seen;
mod sweep;

/// Too hot for either direction.
const TOO_HOT: Faults = Faults::NONE
    .with(Id::Temperature(Flow::Discharge, Side::High, Level::Msl))
    .with(Id::Temperature(Flow::Charge, Side::High, Level::Msl));
/// A move that no converter hides, in its steps.
const STEPS: Real = 8.0;
/// Cells that all move this share of their window within a second say that the current moved.
const JUMP: Real = 0.05;

/// Judges measurements by every row of a [`Table`], each at its pace.
///
/// ```
/// use voltstep_bms::protect::{EXAMPLE, Id, Level, Protection, ProtectionState, Side, Signals};
/// use voltstep_bms::protect::{Table, Trip};
/// use voltstep_bms::{Measurements, Reading, must};
///
/// const TABLE: Table = must!(Table::new(EXAMPLE));
/// const PROTECTION: Protection<14, 4> = must!(Protection::new(&TABLE));
///
/// let mut now: Measurements<14, 4> = Measurements {
///     cell_v: [Reading::new(3.7); 14],
///     temperature_c: [Reading::new(25.0); 4],
///     current_a: Reading::new(12.0),
///     pack_v: Reading::new(51.8),
///     link_v: Reading::new(51.8),
/// };
/// let mut state = ProtectionState::NEW;
/// for _ in 0..40 {
///     PROTECTION.step(&mut state, &now, &Signals::QUIET);
/// }
/// let verdict = PROTECTION.step(&mut state, &now, &Signals::QUIET);
/// assert!(verdict.permit && verdict.trip == Trip::None);
///
/// now.cell_v[9] = Reading::new(4.3);
/// let ticks = (1..).find(|_| {
///     PROTECTION.step(&mut state, &now, &Signals::QUIET).trip == Trip::Hard
/// });
/// assert!(ticks.is_some_and(|ms| ms <= 100));
/// assert!(state.latched().has(Id::CellVoltage(Side::High, Level::Msl)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Protection<'t, const CELLS: usize, const SENSORS: usize> {
    table: &'t Table,
    /// The rows that are judged in every call.
    each_tick: Faults,
    /// Rows of cells and temperatures are judged after a sweep, none in every call.
    by_sweep: bool,
    steady: SteadyLimits,
    warming: WarmingLimits,
    cell_moves_a: Real,
    temperature_moves_k: Real,
    jump_v: Real,
    slow_v: Real,
}

/// The state of a [`Protection`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct ProtectionState<const CELLS: usize, const SENSORS: usize> {
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    rows: [DebounceState; ROWS],
    /// Rows that are not at rest: each of their samples counts.
    awake: Faults,
    tripped: Faults,
    latched: Faults,
    tick: u16,
    /// A whole sweep was seen since the start.
    swept: bool,
    cells: Look,
    temperatures: Look,
    /// Of the sweep before.
    last_cells: Look,
    last_temperatures: Look,
    cell_moves: Moves<CELLS>,
    temperature_moves: Moves<SENSORS>,
    steady: Steady<CELLS>,
    warming: Warming<SENSORS>,
    pub(super) stuck: Faults,
    pub(super) heat_a2s: [Real; 2],
    current_a: Real,
    /// It has been the same since the cells have jumped.
    current_stands: bool,
    /// No current up to this is bad, discharging and charging \[A\].
    least_a: [Real; 2],
    /// Lowest and highest cell, where they were when the current had last moved, following slowly
    /// \[V\].
    jump_from_v: [Real; 2],
    follow: u8,
}

impl<const CELLS: usize, const SENSORS: usize> ProtectionState<CELLS, SENSORS> {
    /// Nothing seen.
    pub const NEW: Self = Self {
        rows: [DebounceState::NEW; ROWS],
        awake: Faults::NONE,
        tripped: Faults::NONE,
        latched: Faults::NONE,
        tick: 0,
        swept: false,
        cells: Look::NEW,
        temperatures: Look::NEW,
        last_cells: Look::NEW,
        last_temperatures: Look::NEW,
        cell_moves: Moves::NEW,
        temperature_moves: Moves::NEW,
        steady: Steady::NEW,
        warming: Warming::NEW,
        stuck: Faults::NONE,
        heat_a2s: [0.0; 2],
        current_a: Real::NAN,
        current_stands: false,
        least_a: [Real::NEG_INFINITY; 2],
        jump_from_v: [Real::NAN; 2],
        follow: 0,
    };

    /// After a power cut, with what only a workshop may end.
    #[must_use]
    pub const fn locked_by(id: Id) -> Self {
        Self { latched: Faults::NONE.with(id), ..Self::NEW }
    }

    /// Rows that stay until somebody ends them.
    #[must_use]
    pub const fn latched(&self) -> Faults {
        self.latched
    }

    /// Lowest and highest cell of the last sweep \[V\]; `None` where none was seen.
    #[must_use]
    pub fn cell_extremes_v(&self) -> Option<(Real, Real)> {
        (self.last_cells.seen > 0).then_some((self.last_cells.lowest, self.last_cells.highest))
    }

    /// How much of the charge of squared current that a direction may take for a short time is used
    /// up, ≥ 0; at 1 it trips.
    #[must_use]
    pub fn heat_share(&self, table: &Table, flow: Flow) -> Real {
        let [discharge, charge] = self.heat_a2s;
        let heat_a2s = match flow {
            Flow::Discharge => discharge,
            Flow::Charge => charge,
        };
        let threshold = table.row(Id::Heat(flow)).threshold;
        if threshold > 0.0 { heat_a2s / threshold } else { 1.0 }
    }

    /// Coldest and hottest sensor of the last sweep \[°C\]; `None` where none was seen.
    #[must_use]
    pub fn temperature_extremes_c(&self) -> Option<(Real, Real)> {
        let look = &self.last_temperatures;
        (look.seen > 0).then_some((look.lowest, look.highest))
    }
}

/// The readings that are judged in every call.
#[derive(Clone, Copy)]
struct Fast {
    current: Taken,
    pack: Taken,
    link: Taken,
}

impl<'t, const CELLS: usize, const SENSORS: usize> Protection<'t, CELLS, SENSORS> {
    /// Takes a table of as many cells in series.
    ///
    /// # Errors
    /// [`ParamError::LengthsDiffer`] where the table is one of another pack.
    pub const fn new(table: &'t Table) -> Result<Self, ParamError> {
        let sheet = table.sheet();
        check!(sheet.checked());
        if sheet.layout.series as usize != CELLS || SENSORS == 0 {
            return Err(ParamError::LengthsDiffer("layout.series"));
        }
        let (cell, temperature) = (&sheet.sensing.cell_v, &sheet.sensing.temperature_c);
        let least_ohm = sheet.cell.resistance_ohm / RESISTANCE_RANGE;
        let window_v = sheet.cell.voltage.operating_max_v - sheet.cell.voltage.operating_min_v;
        let (mut each_tick, mut index) = (Faults::NONE, 0);
        while index < ROWS {
            if matches!(table.rows()[index].pace, Pace::Tick) {
                each_tick = each_tick.with(Id::ALL[index]);
            }
            index += 1;
        }
        Ok(Self {
            table,
            each_tick,
            by_sweep: bad::judged_by_sweep(table.rows()),
            steady: SteadyLimits::new(sheet),
            warming: WarmingLimits::new(sheet),
            cell_moves_a: STEPS * cell.resolution * sheet.layout.parallel as Real / least_ohm,
            temperature_moves_k: max(
                STEPS * temperature.resolution,
                2.0 * temperature.hysteresis(),
            ),
            jump_v: JUMP * window_v,
            slow_v: JUMP * window_v * sheet.sweep_s(),
        })
    }

    /// The table.
    #[must_use]
    pub const fn table(&self) -> &'t Table {
        self.table
    }

    /// One call: the next share of cells and temperatures is looked at, current, pack and link are,
    /// and every row that is due is judged.
    pub fn step(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        now: &Measurements<CELLS, SENSORS>,
        signals: &Signals,
    ) -> Verdict {
        self.step_with(state, now, signals, Faults::NONE)
    }

    /// The same, and some rows are judged whether or not they rest.
    pub(super) fn step_with(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        now: &Measurements<CELLS, SENSORS>,
        signals: &Signals,
        these: Faults,
    ) -> Verdict {
        let sheet = self.table.sheet();
        let sensing = &sheet.sensing;
        let tick_s = sheet.tick_s;
        let fast = Fast {
            current: taken(&now.current_a, &sensing.current_a, sensing.current_a.oldest_s(tick_s)),
            pack: taken(&now.pack_v, &sensing.pack_v, sensing.pack_v.oldest_s(tick_s)),
            link: taken(&now.link_v, &sensing.link_v, sensing.link_v.oldest_s(tick_s)),
        };
        self.warm(state, fast.current.value());
        self.look(state, now);
        let ends = state.tick + 1 >= sheet.sweep_ticks;
        state.tick = if ends { 0 } else { state.tick + 1 };
        if ends {
            self.end_sweep(state, fast.current.value(), signals.bleeding);
        }

        let due = if ends { Faults::ALL } else { self.each_tick };
        let bad = self.bad(state, &fast, signals, ends);
        // A row at rest changes by a bad sample alone.
        let rows = due.both(state.awake.union(bad).union(these));
        let (mut rose, mut fell) = (Faults::NONE, Faults::NONE);
        if !rows.is_empty() {
            (rose, fell) = self.judge(state, &fast, signals, rows);
        }
        self.verdict(state, &fast, signals, rose, fell)
    }

    /// Lets rows judge what they see: which have tripped, which have healed.
    #[cold]
    #[inline(never)]
    fn judge(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
        rows: Faults,
    ) -> (Faults, Faults) {
        let (mut rose, mut fell) = (Faults::NONE, Faults::NONE);
        for id in rows.iter() {
            let row = self.table.row(id);
            let sample = row.judge(self.seen(state, fast, signals, id));
            let Some(debounce) = state.rows.get_mut(usize::from(id.index())) else { continue };
            let (before, after) = (debounce.tripped(), row.debounce.step(debounce, sample));
            state.awake =
                if debounce.rests() { state.awake.without(id) } else { state.awake.with(id) };
            if after && !before {
                rose = rose.with(id);
            } else if before && !after {
                fell = fell.with(id);
            }
        }
        state.tripped = state.tripped.union(rose).minus(fell);
        (rose, fell)
    }

    /// What follows from the rows.
    fn verdict(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        fast: &Fast,
        signals: &Signals,
        rose: Faults,
        fell: Faults,
    ) -> Verdict {
        if signals.clear > Clear::No && !state.latched.is_empty() {
            for id in state.latched.iter() {
                let quiet =
                    state.rows.get(usize::from(id.index())).is_some_and(DebounceState::quiet);
                if quiet && self.table.row(id).clear <= signals.clear {
                    state.latched = state.latched.without(id);
                }
            }
        }
        let (mut trip, mut forbidden) = (Trip::None, !state.latched.is_empty());
        if !state.tripped.is_empty() {
            let runaway = state.tripped.both(TOO_HOT) == TOO_HOT;
            for id in state.tripped.iter() {
                let row = self.table.row(id);
                if !self.in_effect(row, fast.current, signals.mains_closed && runaway) {
                    continue;
                }
                if row.clear > Clear::No {
                    state.latched = state.latched.with(id);
                    forbidden = true;
                }
                forbidden |= row.reaction >= Reaction::Soft;
                trip = if row.reaction.trip() > trip { row.reaction.trip() } else { trip };
            }
        }
        let seen = state.swept
            && state.last_cells.complete()
            && state.last_temperatures.complete()
            && fast.current.value().is_some()
            && fast.pack.value().is_some()
            && fast.link.value().is_some();
        Verdict {
            trip,
            permit: seen && !forbidden,
            tripped: state.tripped,
            latched: state.latched,
            rose,
            fell,
        }
    }

    /// A temperature at which a battery may not be charged harms none that is not. One that is too hot
    /// for either direction is so by no current, once none is allowed: waiting would not cool it.
    fn in_effect(&self, row: &Row, current: Taken, runaway: bool) -> bool {
        let Id::Temperature(flow, ..) = row.id else { return true };
        if runaway && TOO_HOT.has(row.id) {
            return true;
        }
        let Some(current_a) = current.value() else { return true };
        let sensor = &self.table.sheet().sensing.current_a;
        along(flow, current_a) > sensor.error + sensor.hysteresis()
    }

    /// The charge of squared current above the continuous one.
    fn warm(&self, state: &mut ProtectionState<CELLS, SENSORS>, current_a: Option<Real>) {
        let sheet = self.table.sheet();
        let Some(current_a) = current_a else { return };
        for (heat, flow) in state.heat_a2s.iter_mut().zip([Flow::Discharge, Flow::Charge]) {
            let currents = match flow {
                Flow::Discharge => &sheet.cell.discharge,
                Flow::Charge => &sheet.cell.charge,
            };
            let continuous_a = currents.continuous_a * Real::from(sheet.layout.parallel);
            let flowing_a = max(0.0, along(flow, current_a));
            let over = flowing_a * flowing_a - continuous_a * continuous_a;
            *heat = min(LARGEST, max(0.0, *heat + over * sheet.tick_s));
        }
    }

    /// The share of cells and temperatures whose turn it is.
    fn look(
        &self,
        state: &mut ProtectionState<CELLS, SENSORS>,
        now: &Measurements<CELLS, SENSORS>,
    ) {
        let sheet = self.table.sheet();
        let (turn, turns) = (usize::from(state.tick), usize::from(sheet.turns()));
        let sensor = &sheet.sensing.cell_v;
        let oldest_s = sensor.oldest_s(sheet.tick_s);
        let (from, to) = (CELLS * turn / turns, CELLS * (turn + 1) / turns);
        let readings = now.cell_v.get(from..to).unwrap_or_default();
        for (index, reading) in (from..to).zip(readings) {
            let taken = taken(reading, sensor, oldest_s);
            state.cells.take(taken);
            state.cell_moves.take(index, taken.value());
            state.steady.take(&self.steady, index, taken.value());
        }
        let sensor = &sheet.sensing.temperature_c;
        let oldest_s = sensor.oldest_s(sheet.tick_s);
        let (from, to) = (SENSORS * turn / turns, SENSORS * (turn + 1) / turns);
        let readings = now.temperature_c.get(from..to).unwrap_or_default();
        for (index, reading) in (from..to).zip(readings) {
            let taken = taken(reading, sensor, oldest_s);
            state.temperatures.take(taken);
            state.temperature_moves.take(index, taken.value());
            state.warming.take(&self.warming, index, taken.value());
        }
    }
}

/// A current in a direction, positive where it flows that way \[A\].
const fn along(flow: Flow, current_a: Real) -> Real {
    match flow {
        Flow::Discharge => current_a,
        Flow::Charge => -current_a,
    }
}
