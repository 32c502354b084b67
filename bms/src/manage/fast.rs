//! What cannot wait.

use plant_core::Real;
use plant_core::num::{max, min};

use super::{Bms, BmsState, Board};
use crate::contactor::{
    ContactorInput, Feedback, LinkClass, Phase, PrechargeInput, Watch, current_class,
};
use crate::limit::{Mode, arbitrate};
use crate::log::{Frame, Kind};
use crate::protect::{Clear, Faults, Id, PrechargeFault, Signals, Verdict};

/// The longest time between two calls that is counted \[s\]: beyond it, a sleep.
const LONGEST_S: Real = 1e6;

impl<const CELLS: usize, const SENSORS: usize> Bms<CELLS, SENSORS> {
    /// Reads, judges every row, moves the contactors: every `sheet.tick_s`. A share of the cells is
    /// looked at in each call, all within a sweep.
    pub fn fast<B: Board<CELLS, SENSORS>>(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) {
        let elapsed_s = self.elapse(state, board.uptime_us());
        state.now.elapse(elapsed_s);
        board.measure(&mut state.now);
        state.feedback = board.feedback();

        let [current_a, pack_v, link_v] = self.usable(state);
        state.mode = arbitrate(state.asked.vehicle, state.asked.charger);
        let flags = self.flags(state, board);
        let [minus, _, plus] = state.feedback;
        let latched_before = state.verdict.latched;
        state.verdict = self.protection.step(
            &mut state.protection,
            &state.now,
            &Signals {
                flags,
                bleeding: state.bleeding,
                mains_closed: minus == Feedback::Closed && plus == Feedback::Closed,
                all_open: state.feedback == [Feedback::Open; 3],
                second_current_a: board.second_current_a(),
                residual_v: state.series.filter.error_v,
                insulation_ohm_per_v: board.insulation_ohm_per_v(),
                cells_found: board.cells_found(),
                elapsed_s,
                clear: state.asked.clear,
                wires_v: board.wires_v().unwrap_or_default(),
            },
        );
        self.contact(state, board, [current_a, pack_v, link_v]);
        write_down(state, latched_before, [current_a, pack_v, link_v]);
        // A wish to end faults counts once.
        state.asked.clear = Clear::No;
        self.sum(state, current_a, elapsed_s);
    }

    /// Time since the last call \[s\]; one tick at the first.
    fn elapse(&self, state: &mut BmsState<CELLS, SENSORS>, uptime_us: u64) -> Real {
        let before = state.uptime_us.replace(uptime_us);
        let Some(before) = before else { return self.of.params().sheet.tick_s };
        let us = uptime_us.saturating_sub(before);
        #[allow(clippy::cast_precision_loss, reason = "seven digits are enough of a time")]
        let us = us as Real;
        min(us * 1e-6, LONGEST_S)
    }

    /// Current, pack and link; NaN where there is no value.
    pub(super) fn usable(&self, state: &BmsState<CELLS, SENSORS>) -> [Real; 3] {
        let sheet = &self.of.params().sheet;
        let (sensing, now) = (&sheet.sensing, &state.now);
        [
            now.current_a.usable_or_nan(sensing.current_a.oldest_s(sheet.tick_s)),
            now.pack_v.usable_or_nan(sensing.pack_v.oldest_s(sheet.tick_s)),
            now.link_v.usable_or_nan(sensing.link_v.oldest_s(sheet.tick_s)),
        ]
    }

    /// The rows that others find bad.
    fn flags<B: Board<CELLS, SENSORS>>(
        &self,
        state: &BmsState<CELLS, SENSORS>,
        board: &mut B,
    ) -> Faults {
        let contactors = state.contactors.cause().faults(state.feedback);
        let mut flags = board.flags().union(state.asked.flags).union(contactors);
        if state.pin_failed {
            flags = flags.with(Id::Pin);
        }
        if !self.precharge.ready(&state.precharge) {
            flags = flags.with(Id::Precharge(PrechargeFault::Hot));
        }
        if state.contradicts {
            flags = flags.with(Id::Estimator);
        }
        flags
    }

    /// The state machine of the contactors, and what it sees.
    fn contact<B: Board<CELLS, SENSORS>>(
        &self,
        state: &mut BmsState<CELLS, SENSORS>,
        board: &mut B,
        [current_a, pack_v, link_v]: [Real; 3],
    ) {
        let watch = self.watch(state, PrechargeInput { pack_v, link_v, current_a });
        let break_a = self.of.params().sheet.actuators.break_a;
        let input = ContactorInput {
            on: state.mode != Mode::Off,
            clear: state.asked.clear,
            trip: state.verdict.trip,
            permit: state.verdict.permit,
            resistor_ready: self.precharge.ready(&state.precharge),
            watch,
            current: current_class(current_a, break_a),
            link: self.link(state, link_v),
            feedback: state.feedback,
        };
        let coils = self.contactors.step(&mut state.contactors, input);
        state.pin_failed = !board.drive(coils);
    }

    fn link(&self, state: &mut BmsState<CELLS, SENSORS>, link_v: Real) -> LinkClass {
        self.trend.of(&mut state.trend, link_v)
    }

    /// How the precharge goes, from the moment that its contactor shows closed.
    fn watch(&self, state: &mut BmsState<CELLS, SENSORS>, input: PrechargeInput) -> Watch {
        if state.contactors.phase() != Phase::Precharge {
            (state.precharge_ticks, state.precharge_closed) = (0, false);
            self.precharge.cool(&mut state.precharge);
            return Watch::Wait;
        }
        let [_, precharge, _] = state.feedback;
        state.precharge_ticks = state.precharge_ticks.saturating_add(1);
        if precharge == Feedback::Closed && !state.precharge_closed {
            state.precharge_closed = true;
            self.precharge.begin(&mut state.precharge, input.pack_v, input.link_v);
        }
        if state.precharge_closed {
            self.precharge.step(&mut state.precharge, input)
        } else {
            self.precharge.cool(&mut state.precharge);
            // It was told to close and does not show it.
            if state.precharge_ticks > self.precharge_closes { Watch::Open } else { Watch::Wait }
        }
    }

    /// What the filter will take, and what has gone through the battery.
    fn sum(&self, state: &mut BmsState<CELLS, SENSORS>, current_a: Real, elapsed_s: Real) {
        let sheet = &self.of.params().sheet;
        let (turn, turns) = (usize::from(state.turn), usize::from(sheet.turns()));
        let share = (CELLS * turn / turns, CELLS * (turn + 1) / turns);
        let oldest_s = sheet.sensing.cell_v.oldest_s(sheet.tick_s);
        state.samples.take(&state.now, current_a, elapsed_s, share, oldest_s);
        state.turn = if turn + 1 < turns { state.turn + 1 } else { 0 };
        if current_a.is_finite() {
            state.throughput_ah.add(max(current_a, -current_a) * elapsed_s / 3600.0);
        }
        state.was_closed |= state.contactors.phase() == Phase::Closed;
    }
}

/// Into the log: what tripped, healed and was ended.
fn write_down<const CELLS: usize, const SENSORS: usize>(
    state: &mut BmsState<CELLS, SENSORS>,
    latched_before: Faults,
    [current_a, pack_v, link_v]: [Real; 3],
) {
    let Verdict { rose, fell, latched, .. } = state.verdict;
    let ended = latched_before.minus(latched);
    if rose.union(fell).union(ended).is_empty() {
        return;
    }
    let nan = (Real::NAN, Real::NAN);
    let cells_v = state.protection.cell_extremes_v().unwrap_or(nan);
    let temperatures_c = state.protection.temperature_extremes_c().unwrap_or(nan);
    let frame = Frame {
        cell_v: [cells_v.0, cells_v.1],
        temperature_c: [temperatures_c.0, temperatures_c.1],
        current_a,
        pack_v,
        link_v,
        soc: state.series.filter.soc(),
    };
    let ms = state.uptime_us.unwrap_or(0) / 1000;
    #[expect(clippy::cast_possible_truncation, reason = "the log's time wraps after 49 days")]
    let ms = ms as u32;
    let phase = state.contactors.phase() as u8;
    for (rows, kind) in [(rose, Kind::Tripped), (fell, Kind::Healed), (ended, Kind::Cleared)] {
        state.log.write(rows, kind, ms, phase, frame);
    }
}
