//! What cells and current say of each other where the current is steady: while it is, no cell moves
//! alone; from one such time to the next the cells move as their resistances let the current change.

use plant_core::Real;
use plant_core::num::{clamp, lag_gain, max, min, sane};

use super::derive::AGREE_S;
use super::look::FOLLOW;
use super::sheet::PackSheet;

/// Beyond that it may move by this share of what the mean cell moves. Chosen: three standard deviations
/// of resistances that differ by a tenth; in the cold cells relax by hundreds of mV.
const UNLIKE: Real = 0.3;
/// A cell's resistance may be this many times less than the largest of its life …
pub(super) const RESISTANCE_RANGE: Real = 10.0;
/// A cell has moved beyond what its sensor may be off this many times. Chosen: cells that are not alike
/// part too, over minutes.
const ALONE_ERRORS: Real = 3.0;
/// … and react this many times more than it lets expect. Chosen: colder than its windows.
const BEYOND: Real = 2.0;
/// What a change of the current left unexplained is forgotten over this time \[s\]. Chosen: such errors
/// add up where they are a fault, and not where they are chance.
const FORGET_S: Real = 60.0;

/// When the current is steady, and what cells may do then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SteadyLimits {
    /// A steady current stays within this \[A\].
    steady_a: Real,
    /// It is steady after so many sweeps, and cells have followed.
    follow: u16,
    /// So many sweeps later cells have moved by more than the current.
    agree: u16,
    /// A cell that moves more than this against others that stand still moves alone \[V\].
    alone_v: Real,
    /// What a change of the current may be off \[A\].
    off_a: Real,
    /// The least and the most that the mean cell may react to the pack's current with \[Ω\].
    reacts_ohm: [Real; 2],
    alike_gain: Real,
    keep: Real,
}

/// The state of what is watched by [`SteadyLimits`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Steady<const CELLS: usize> {
    /// What the current stays at \[A\], and for how many sweeps.
    current_a: Real,
    sweeps: u16,
    /// The mean cell of the sweep before, and what it has come from, as each cell is followed \[V\].
    mean_v: Real,
    from_v: Real,
    /// A cell that moves more than this against the others moves alone \[V\].
    alone_v: Real,
    /// Current and mean cell when it last was steady, and how many sweeps ago.
    last: [Real; 2],
    ago: u16,
    /// What the current has changed and the cells do not show \[A\], and for how many sweeps.
    unexplained_a: Real,
    contradicts: u16,
    /// Where each cell lies from the mean \[V\].
    #[cfg_attr(feature = "recorder", serde(with = "serde_big_array::BigArray"))]
    apart_v: [Real; CELLS],
    /// One has moved alone in this sweep; in so many sweeps.
    moved: bool,
    alone: u16,
}

impl SteadyLimits {
    pub(super) const fn new(sheet: &PackSheet) -> Self {
        let (cell, current) = (&sheet.sensing.cell_v, &sheet.sensing.current_a);
        let parallel = sheet.layout.parallel as Real;
        let most_ohm = sheet.cell.resistance_ohm / parallel;
        // A reading may be a period old, and its turn a sweep away.
        let follow = max(FOLLOW as Real, 2.0 * cell.period_s / sheet.sweep_s() + 1.0);
        Self {
            steady_a: current.error + current.hysteresis(),
            follow: sweeps(follow),
            agree: sweeps(AGREE_S / sheet.sweep_s()),
            alone_v: ALONE_ERRORS * cell.error + cell.hysteresis(),
            off_a: current.error,
            reacts_ohm: [most_ohm / RESISTANCE_RANGE, BEYOND * most_ohm],
            // Cells that relax part within seconds, a wire or a short parts one at once.
            alike_gain: lag_gain(sheet.sweep_s() / AGREE_S),
            keep: 1.0 - lag_gain(sheet.sweep_s() / FORGET_S),
        }
    }

    /// What of a change of the current its cells cannot show \[A\].
    fn unexplained_a(&self, change_a: Real, fall_v: Real) -> Real {
        let [least_ohm, most_ohm] = self.reacts_ohm;
        let (one_a, other_a) = (fall_v / most_ohm, fall_v / least_ohm);
        let (low_a, high_a) = (min(one_a, other_a) - self.off_a, max(one_a, other_a) + self.off_a);
        change_a - clamp(change_a, low_a, high_a)
    }
}

impl<const CELLS: usize> Steady<CELLS> {
    pub(super) const NEW: Self = Self {
        current_a: Real::NAN,
        sweeps: 0,
        mean_v: Real::NAN,
        from_v: Real::NAN,
        alone_v: Real::NAN,
        last: [Real::NAN; 2],
        ago: 0,
        unexplained_a: 0.0,
        contradicts: 0,
        apart_v: [Real::NAN; CELLS],
        moved: false,
        alone: 0,
    };

    /// A cell in its turn.
    pub(super) fn take(&mut self, limits: &SteadyLimits, index: usize, cell_v: Option<Real>) {
        if self.sweeps < limits.follow {
            return;
        }
        let Some(apart_v) = self.apart_v.get_mut(index) else { return };
        let now_v = cell_v.unwrap_or(Real::NAN) - self.mean_v;
        let moved_v = now_v - *apart_v;
        if self.sweeps == limits.follow {
            *apart_v = now_v;
        } else if moved_v.abs() > self.alone_v {
            self.moved = true;
        } else if sane(moved_v) {
            *apart_v += limits.alike_gain * moved_v;
        }
    }

    /// At the end of a sweep. While cells are bled, or one is not seen, nothing is said of them.
    pub(super) fn end_sweep(
        &mut self,
        limits: &SteadyLimits,
        current_a: Real,
        mean_v: Option<Real>,
    ) {
        let mean_v = mean_v.unwrap_or(Real::NAN);
        let stays = (current_a - self.current_a).abs() <= limits.steady_a && sane(mean_v);
        if stays {
            self.sweeps = min_u16(self.sweeps + 1, limits.follow + 1);
        } else {
            (self.current_a, self.sweeps, self.alone) = (current_a, 0, 0);
        }
        self.unexplained_a *= limits.keep;
        self.ago = self.ago.saturating_add(1);
        if self.sweeps >= limits.follow {
            let [last_a, last_v] = self.last;
            let more_a = limits.unexplained_a(current_a - last_a, last_v - mean_v);
            if self.sweeps == limits.follow && self.ago <= limits.agree && sane(more_a) {
                self.unexplained_a += more_a;
                // Once it is told, a change that the cells show says that it has ended.
                let shown = more_a.abs() <= 0.0 && (current_a - last_a).abs() > 2.0 * limits.off_a;
                if shown && self.contradicts(limits) {
                    self.unexplained_a = 0.0;
                }
            }
            (self.last, self.ago) = ([current_a, mean_v], 0);
            self.alone = if self.moved { self.alone.saturating_add(1) } else { 0 };
        }
        let contradicts = self.unexplained_a.abs() > limits.off_a;
        self.contradicts = if contradicts { self.contradicts.saturating_add(1) } else { 0 };
        if self.sweeps > limits.follow {
            self.from_v += limits.alike_gain * (mean_v - self.from_v);
        } else {
            self.from_v = mean_v;
        }
        self.alone_v = limits.alone_v + UNLIKE * (mean_v - self.from_v).abs();
        (self.mean_v, self.moved) = (mean_v, false);
    }

    /// A cell moves though nothing else does.
    pub(super) const fn cell_alone(&self, limits: &SteadyLimits) -> bool {
        self.alone >= limits.follow
    }

    /// The current has changed and the cells do not show it, for longer than sensors may differ.
    pub(super) const fn contradicts(&self, limits: &SteadyLimits) -> bool {
        self.contradicts > limits.agree
    }
}

const fn min_u16(a: u16, b: u16) -> u16 {
    if a < b { a } else { b }
}

/// Whole sweeps of a time in sweeps.
const fn sweeps(n: Real) -> u16 {
    if n < 60_000.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "just checked")]
        let n = (n + 0.5) as u16;
        n
    } else {
        60_000
    }
}
