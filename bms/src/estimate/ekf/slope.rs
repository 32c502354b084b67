//! The slope that the open-circuit curve is given, and what a change of it may not tell.

use plant_core::num::{Accum, Real, clamp, max, min, sqrt};

use super::{CONSISTENT, Ekf, EkfState};

/// Over less than this there is no mean slope. Chosen: the last bit of 400 V, 3e-5 V, makes
/// 0.03 V of slope over it.
const SHORTEST_CHORD: Real = 1e-3;
/// The slope is taken anew after a move by this many of the standard deviations it was taken with.
/// Chosen: within that the least slope over three of them is nearly the same.
const HELD_SDS: Real = 0.25;
/// A slope that falls makes the state of charge at most so much less sure at a time. Chosen: over
/// half a standard deviation's move no curve's slope falls further but at a knee, which is passed.
const MOST_LESS: Real = 2.0;
/// Places that are weighed where the battery has left the flat part, and how far around, in standard
/// deviations and in charge. Chosen: of half of all charge they are closer than the curve's points.
const PLACES: Real = 32.0;
const REACH_SDS: Real = 4.0;
const LEAST_REACH: Real = 0.25;
/// √½.
const HALF_ROOT: Real = 0.707_106_77;

/// Where a slope was taken, and what has been learnt with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slope {
    /// State of charge and its standard deviation there; a negative standard deviation asks for
    /// another one.
    at_soc: Real,
    at_sd: Real,
    /// The last slope that was not flat \[V per unit of SOC\]; 0 before.
    learnt_v: Real,
    /// Charge that was counted since, without its sign, as state of charge.
    pub(super) moved: Real,
}

impl Slope {
    pub(super) const NONE: Self = Self { at_soc: 0.0, at_sd: -1.0, learnt_v: 0.0, moved: 0.0 };

    /// Asks for another one.
    pub(super) const fn release(&mut self) {
        self.at_sd = -1.0;
    }
}

impl Ekf {
    /// The curve's tangent, and its least mean slope over one and a half standard deviations
    /// within three.
    ///
    /// A slope that followed each correction would be a noise that the correction knows: it would
    /// tell the state of charge apart from the model's error, which nothing does at rest. So it is
    /// held for a while.
    pub(super) fn follow_curve(&self, state: &mut EkfState) {
        let soc = state.soc();
        let sd = sqrt(state.variance());
        let (open_circuit_v, tangent_v) = self.open_circuit(soc);
        let hysteresis_v = self.params.battery.hysteresis.half_gap_v * state.slow.hysteresis;
        state.tangent_v = tangent_v;
        state.open_circuit_v = open_circuit_v + hysteresis_v - tangent_v * state.rise;
        let Slope { at_soc, at_sd, moved, .. } = state.slow.slope;
        let (gone, held) = ((soc - at_soc).abs(), HELD_SDS * at_sd);
        if gone <= held && (sd - at_sd).abs() <= held {
            return;
        }
        (state.slow.slope.at_soc, state.slow.slope.at_sd) = (soc, sd);
        let mut slope_v = Real::INFINITY;
        for reach in [-1.5 * sd, 1.5 * sd] {
            let (mut from, mut from_v) = (soc, open_circuit_v);
            for _ in 0..2 {
                let to = clamp(from + reach, 0.0, 1.0);
                let (to_v, _) = self.open_circuit(to);
                if (to - from).abs() > SHORTEST_CHORD {
                    slope_v = min(slope_v, (to_v - from_v) / (to - from));
                }
                (from, from_v) = (to, to_v);
            }
        }
        // The tangent counts only where nothing is left open: a dent of the curve that is narrower than
        // a standard deviation says little of what lies within three.
        let slope_v = if slope_v < Real::INFINITY { slope_v } else { tangent_v };
        self.change_slope(state, slope_v, gone > moved);
    }

    /// Takes another slope, `by_correction` where it is not the charge counted that led there.
    ///
    /// A change of the slope tells nothing: what the voltage has said, it would have said with
    /// this slope, so `shared·slope` stays. Where the slope is more, what that leaves open of the
    /// state of charge is now open by itself; where it is less, less is known, unless the charge
    /// that was counted has brought the battery here.
    pub(super) fn change_slope(&self, state: &mut EkfState, slope_v: Real, by_correction: bool) {
        state.slope_v = slope_v;
        if self.is_flat(state) {
            return;
        }
        let keep = state.slow.slope.learnt_v / slope_v;
        (state.slow.slope.learnt_v, state.slow.slope.moved) = (slope_v, 0.0);
        if keep > 0.0 && keep < 1.0 {
            let before = state.shared_per_v;
            state.shared_per_v *= keep;
            state.own_variance += (before * before - state.shared_per_v * state.shared_per_v)
                * state.error_variance_v2;
        } else if keep > 1.0 && by_correction {
            state.shared_per_v *= min(keep, MOST_LESS);
        }
    }

    /// Takes the state of charge from the voltage as well: no place on the flat part shows this
    /// one. `residual_v` is that of the last second; the longer mean comes late.
    ///
    /// What is believed before, and how well each place explains the voltage, is weighed at places
    /// around it (Bayes's rule on a grid \[Bucy1971\]): where
    /// the curve has more than one place for a voltage, the mean lies between them and the standard
    /// deviation says so.
    #[cold]
    pub(super) fn leave_flat(&self, state: &mut EkfState, residual_v: Real) {
        let (open_circuit_v, _) = self.open_circuit(state.soc());
        let late_v = state.slow.residual_v;
        let residual_v = if residual_v * late_v > late_v * late_v { residual_v } else { late_v };
        let shown_v = open_circuit_v + state.error_v + residual_v;
        let sd_v = state.slow.error_sd_v;
        let (before, per_sd_v) = (state.soc(), 1.0 / sd_v);
        let per_sd = 1.0 / sqrt(state.variance());
        let reach = max(REACH_SDS / per_sd, LEAST_REACH);
        let (low, high) = (max(before - reach, 0.0), min(before + reach, 1.0));
        let step = (high - low) / PLACES;
        let (mut weights, mut sum, mut squares, mut off_sum_v) = (0.0, 0.0, 0.0, 0.0);
        let mut soc = low + 0.5 * step;
        while soc < high {
            let off_v = shown_v - self.params.battery.open_circuit.at(soc);
            let weight = likely((soc - before) * per_sd) * likely(off_v * per_sd_v);
            let away = soc - before;
            weights += weight;
            sum += weight * away;
            squares += weight * away * away;
            off_sum_v += weight * off_v;
            soc += step;
        }
        let mean = sum / weights;
        // The places themselves are as wide as a step.
        let variance = max(squares / weights - mean * mean, 0.0) + step * step / 12.0;
        let (soc, sd) = (before + mean, sqrt(variance));
        state.soc_before = Accum::new(soc);
        state.rise = 0.0;
        // What the places, as they are weighed, do not explain.
        state.error_v = clamp(off_sum_v / weights, -CONSISTENT * sd_v, CONSISTENT * sd_v);
        state.error_variance_v2 = sd_v * sd_v;
        state.slow.residual_v = 0.0;
        state.slow.soc_then = soc;
        state.slow.drift.forget();
        state.slow.reaction.forget();
        // Half of it because of the model's error, half of it for what the range leaves open.
        state.own_variance = 0.5 * variance;
        state.shared_per_v = -HALF_ROOT * sd / sd_v;
        state.slow.slope = Slope::NONE;
        self.follow_curve(state);
    }
}

/// About `e^(−x²/2)` up to two standard deviations; beyond, it falls as a power (Student's
/// distribution): what was declared may be wrong.
fn likely(x: Real) -> Real {
    let fall = 1.0 / (1.0 + 0.25 * x * x);
    fall * fall * fall
}
