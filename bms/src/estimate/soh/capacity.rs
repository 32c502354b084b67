//! Capacity by recursive total least squares: `ΔAh = Q·ΔSOC`, both sides uncertain
//! \[Plett2011, section 6\].
//!
//! The scaling from the sums themselves, Newton's method in a bracket instead of the quartic's
//! roots, and what is taken of outliers and contradictions are ours.
//!
//! Tests: `tests` below; `tests/tests/bms_soh.rs`.

use plant_core::error::{above, check, not_negative, positive};
use plant_core::num::{clamp, max, min, sane, sqrt};
use plant_core::{Dt, ParamError, Real};

use super::OUTLIER_SDS;
use crate::Estimate;

/// Capacities outside this share of the nominal one are not believed. Chosen: a battery is worn out
/// long before.
const SMALLEST_RATIO: Real = 0.2;
/// Capacities outside this share of the nominal one are not believed. Chosen: more is a wrong
/// nominal value.
const LARGEST_RATIO: Real = 2.0;
/// A pair further off than this many standard deviations contradicts what is known. Chosen: noise
/// alone goes there once in 16,000 pairs.
const CONTRADICTION_SDS: Real = 4.0;
/// Newton steps and bisections; 24 bisections alone leave less than a millionth. With 6 an end of
/// the range is found as 1.9999 for 2.
const ROUNDS: u32 = 24;

/// Parameters of a [`CapacityEstimator`]: how good the current sensor is, and how it learns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct CapacityParams {
    /// Capacity before anything was learnt \[A·h\], above zero.
    pub nominal_ah: Real,
    /// Its standard deviation \[A·h\], above zero.
    pub nominal_sd_ah: Real,
    /// Standard deviation of a current reading's noise \[A\], ≥ 0.
    pub current_noise_sd_a: Real,
    /// Standard deviation of the current sensor's offset \[A\], above zero.
    pub current_offset_sd_a: Real,
    /// Standard deviation of the current sensor's gain, ≥ 0. It is in every pair alike, so no
    /// number of them averages it out: the result is never surer than this.
    pub current_gain_sd: Real,
    /// The smallest change of the state of charge to learn from, above zero.
    pub least_soc_change: Real,
    /// The smallest change of the state of charge to learn from, in multiples of its own standard
    /// deviation, above zero.
    pub least_soc_change_sds: Real,
    /// How many pairs are remembered, above 1: with γ = 1 − 1/n.
    pub memory_pairs: Real,
}

/// Capacity from the charge that flowed between two instants at which the state of charge was
/// known.
///
/// `ΔAh = Q·ΔSOC`, both sides uncertain: approximate weighted total least squares with fading
/// memory \[Plett2011, section 6\]. Six sums hold all pairs; capacity is
/// the minimum of `(c4·q⁴ − 2·c5·q³ + (c1 + c6)·q² − 2·c2·q + c3)/(q² + 1)²` and its variance
/// 2 over the second derivative there. Its scaling is taken from the sums themselves
/// (`k² = c1/c4`), with which it is exact where both sides' deviations keep their ratio. Instead
/// of the quartic's roots in closed form, which single precision does not give, the minimum is
/// found between the two ordinary least-squares solutions, which enclose it, by Newton's method in
/// a bracket, in at most 24 rounds.
///
/// A pair further off than three standard deviations counts as if it were as uncertain as that. One
/// that is off by more than four contradicts: it is kept aside, makes the result less sure, and is
/// learnt only together with a second one that agrees with it. A pair that agrees with what is known
/// clears it.
///
/// The state of charge must not come from the charge counted: at rest from the open-circuit
/// voltage, or from a filter that has seen enough voltage to forget what it counted, with a
/// standard deviation that says so.
///
/// ```
/// use plant_core::must;
/// use voltstep_bms::estimate::soh::{CapacityEstimator, CapacityInput, CapacityParams};
/// use voltstep_bms::{Dt, Estimate};
///
/// const ESTIMATOR: CapacityEstimator = must!(CapacityEstimator::new(
///     CapacityParams {
///         nominal_ah: 3.0,
///         nominal_sd_ah: 0.3,
///         current_noise_sd_a: 0.01,
///         current_offset_sd_a: 0.002,
///         current_gain_sd: 0.002,
///         least_soc_change: 0.3,
///         least_soc_change_sds: 10.0,
///         memory_pairs: 50.0,
///     },
///     must!(Dt::from_s(1.0)),
/// ));
///
/// let rested = |soc| Estimate::rested(soc, 0.01, 25.0);
/// // 1.5 A·h take 60 % of the charge: the cell has 2.5 A·h left of its 3.
/// let pair = CapacityInput {
///     start: rested(0.9),
///     end: rested(0.3),
///     discharged_ah: 1.5,
///     duration_s: 7200.0,
/// };
/// let mut state = ESTIMATOR.unknown();
/// let mut out = ESTIMATOR.step(&mut state, pair);
/// for _ in 1..10 {
///     out = ESTIMATOR.step(&mut state, pair);
/// }
/// assert!((out.capacity_ah - 2.5).abs() < 0.02 && out.capacity_sd_ah < 0.03);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapacityEstimator {
    nominal_ah: Real,
    per_nominal: Real,
    prior_weight: Real,
    /// Variance of the counted charge, as a share of the nominal: per second, per second squared.
    noise_per_s: Real,
    offset_per_s2: Real,
    gain_variance: Real,
    least_soc_change: Real,
    least_soc_change_sds: Real,
    fade: Real,
}

/// The state of a [`CapacityEstimator`]; [`CapacityEstimator::unknown`] and
/// [`CapacityEstimator::known`] make one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct CapacityState {
    sums: Sums,
    /// As a share of the nominal.
    ratio: Real,
    variance: Real,
    /// A pair that contradicts, and waits for another one.
    suspect: Option<Pair>,
}

/// Change of the state of charge, charge as a share of the nominal capacity, and their variances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
struct Pair {
    x: Real,
    y: Real,
    x_variance: Real,
    y_variance: Real,
}

impl Pair {
    /// The variance of its capacity, as a share of the nominal one squared.
    fn variance(&self) -> Real {
        let ratio = self.y / self.x;
        (ratio * ratio * self.x_variance + self.y_variance) / (self.x * self.x)
    }

    /// How far its capacity is from another one with this variance, in standard deviations,
    /// squared.
    fn square(&self, ratio: Real, variance: Real) -> Real {
        let off = self.y / self.x - ratio;
        off * off / (self.variance() + variance)
    }
}

/// Input of a [`CapacityEstimator`]: two instants, and what flowed between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapacityInput {
    /// What was believed at the first; of it, the state of charge and its standard deviation.
    pub start: Estimate,
    /// What was believed at the second.
    pub end: Estimate,
    /// Charge discharged from the first to the second \[A·h\], negative when charged.
    pub discharged_ah: Real,
    /// Time from the first to the second \[s\], ≥ 0.
    pub duration_s: Real,
}

/// Output of a [`CapacityEstimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CapacityOutput {
    /// Charge between SOC 0 and 1 \[A·h\].
    pub capacity_ah: Real,
    /// Its standard deviation \[A·h\].
    pub capacity_sd_ah: Real,
    /// This pair changed it.
    pub learned: bool,
    /// The last pair contradicts what was known; the standard deviation reaches to it.
    pub contradicted: bool,
    /// The input was not finite or absurd; nothing changed.
    pub rejected: bool,
}

impl CapacityState {
    /// As if one pair over the whole capacity had been seen, with half of the doubt in either
    /// side.
    const fn at(ratio: Real, weight: Real) -> Self {
        let mut sums = Sums { c: [0.0; 6] };
        sums.add(1.0, ratio, weight, weight * ratio * ratio);
        Self { sums, ratio, variance: 2.0 / weight, suspect: None }
    }
}

impl CapacityEstimator {
    /// Checks `params`; `dt` is the time between two readings of the current.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: CapacityParams, dt: Dt) -> Result<Self, ParamError> {
        let nominal_ah = check!(positive("capacity.nominal_ah", params.nominal_ah));
        let nominal_sd_ah = check!(positive("capacity.nominal_sd_ah", params.nominal_sd_ah));
        let noise_a =
            check!(not_negative("capacity.current_noise_sd_a", params.current_noise_sd_a));
        let offset_a = check!(positive("capacity.current_offset_sd_a", params.current_offset_sd_a));
        let gain_sd = check!(not_negative("capacity.current_gain_sd", params.current_gain_sd));
        let memory = check!(positive("capacity.memory_pairs", params.memory_pairs));
        check!(above("capacity.memory_pairs", memory, 1.0));
        let prior_sd = nominal_sd_ah / nominal_ah;
        let (noise, offset) = (noise_a / (3600.0 * nominal_ah), offset_a / (3600.0 * nominal_ah));
        Ok(Self {
            nominal_ah,
            per_nominal: 1.0 / nominal_ah,
            // Half of the variance on either side of the pair that stands for the prior.
            prior_weight: 2.0 / (prior_sd * prior_sd),
            noise_per_s: noise * noise * dt.s(),
            offset_per_s2: offset * offset,
            gain_variance: gain_sd * gain_sd,
            least_soc_change: check!(positive(
                "capacity.least_soc_change",
                params.least_soc_change
            )),
            least_soc_change_sds: check!(positive(
                "capacity.least_soc_change_sds",
                params.least_soc_change_sds
            )),
            fade: 1.0 - 1.0 / memory,
        })
    }

    /// Nothing learnt yet: the nominal capacity.
    #[must_use]
    pub const fn unknown(&self) -> CapacityState {
        CapacityState::at(1.0, self.prior_weight)
    }

    /// What was learnt before, from a record. What is not finite or out of range is not taken.
    #[must_use]
    pub const fn known(&self, capacity_ah: Real, capacity_sd_ah: Real) -> CapacityState {
        let ratio = capacity_ah * self.per_nominal;
        let sd = capacity_sd_ah * self.per_nominal;
        if ratio >= SMALLEST_RATIO && ratio <= LARGEST_RATIO && sd > 0.0 && sd < LARGEST_RATIO {
            // The doubt about the sensor's gain is added again when it is published.
            let variance = max(sd * sd - self.gain_variance * ratio * ratio, 0.01 * sd * sd);
            CapacityState::at(ratio, 2.0 / variance)
        } else {
            self.unknown()
        }
    }

    /// Looks at one pair of instants.
    pub fn step(&self, state: &mut CapacityState, input: CapacityInput) -> CapacityOutput {
        let (soc_change, soc_variance) = (
            input.start.soc - input.end.soc,
            input.start.soc_sd * input.start.soc_sd + input.end.soc_sd * input.end.soc_sd,
        );
        let magnitude = soc_change.abs() + soc_variance + input.discharged_ah.abs();
        let rejected = !(sane(magnitude) && sane(input.duration_s) && input.duration_s >= 0.0);
        let mut learned = false;
        if !rejected
            && soc_change.abs() >= self.least_soc_change
            && soc_change.abs() >= self.least_soc_change_sds * sqrt(soc_variance)
        {
            let charge = input.discharged_ah * self.per_nominal;
            let charge_variance = input.duration_s
                * (self.noise_per_s + self.offset_per_s2 * input.duration_s)
                + SMALLEST_VARIANCE;
            // The sign of both, so that a charge counts as a discharge does.
            let direction = if soc_change < 0.0 { -1.0 } else { 1.0 };
            let pair = Pair {
                x: direction * soc_change,
                y: direction * charge,
                x_variance: soc_variance + SMALLEST_VARIANCE,
                y_variance: charge_variance,
            };
            learned = self.judge(state, pair);
        }
        let mut variance = state.variance + self.gain_variance * state.ratio * state.ratio;
        if let Some(suspect) = state.suspect {
            let off = clamp(suspect.y / suspect.x, 0.0, LARGEST_RATIO) - state.ratio;
            variance = max(variance, off * off / (OUTLIER_SDS * OUTLIER_SDS));
        }
        CapacityOutput {
            capacity_ah: self.nominal_ah * state.ratio,
            capacity_sd_ah: self.nominal_ah * sqrt(variance),
            learned,
            contradicted: state.suspect.is_some(),
            rejected,
        }
    }

    /// Learns a pair, or keeps it aside; whether it was learnt.
    fn judge(&self, state: &mut CapacityState, pair: Pair) -> bool {
        let ratio = pair.y / pair.x;
        if pair.square(state.ratio, state.variance) <= CONTRADICTION_SDS * CONTRADICTION_SDS {
            state.suspect = None;
            return self.learn(state, pair);
        }
        let before = state.suspect.replace(pair);
        let possible = (SMALLEST_RATIO..=LARGEST_RATIO).contains(&ratio);
        match before {
            Some(other)
                if possible
                    && pair.square(other.y / other.x, other.variance())
                        <= OUTLIER_SDS * OUTLIER_SDS =>
            {
                // Two that agree: the capacity is another one.
                let off = ratio - state.ratio;
                state.suspect = None;
                *state = CapacityState::at(state.ratio, 2.0 / max(state.variance, off * off));
                self.learn(state, other) && self.learn(state, pair)
            }
            _ => false,
        }
    }

    fn learn(&self, state: &mut CapacityState, pair: Pair) -> bool {
        let Pair { x, y, x_variance, y_variance } = pair;
        let off = y - state.ratio * x;
        let spread = state.ratio * state.ratio * x_variance + y_variance + state.variance * x * x;
        let trust = min(1.0, OUTLIER_SDS * OUTLIER_SDS * spread / (off * off));
        let mut sums = state.sums;
        sums.fade(self.fade);
        sums.add(x, y, trust / y_variance, trust / x_variance);
        let Some((ratio, variance)) = sums.solve() else { return false };
        *state = CapacityState { sums, ratio, variance, suspect: None };
        true
    }
}

/// Keeps the weights finite where both sides are said to be exact.
const SMALLEST_VARIANCE: Real = 1e-10;

/// The sums over all pairs \[Plett2011, eq. 28\]: x², xy, y² over the variance of y, and the same
/// over the variance of x.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
struct Sums {
    c: [Real; 6],
}

impl Sums {
    const fn add(&mut self, x: Real, y: Real, y_weight: Real, x_weight: Real) {
        let [c1, c2, c3, c4, c5, c6] = self.c;
        self.c = [
            c1 + y_weight * x * x,
            c2 + y_weight * x * y,
            c3 + y_weight * y * y,
            c4 + x_weight * x * x,
            c5 + x_weight * x * y,
            c6 + x_weight * y * y,
        ];
    }

    fn fade(&mut self, by: Real) {
        for sum in &mut self.c {
            *sum *= by;
        }
    }

    /// The minimum and its variance; nothing where the sums do not tell.
    fn solve(&self) -> Option<(Real, Real)> {
        let [c1, c2, c3, c4, c5, c6] = self.c;
        // y times k, so that both sides weigh alike.
        let k = sqrt(c1 / c4);
        let (c1, c2, c5, c6) = (c1 / (k * k), c2 / k, c5 * k, c6 * k * k);
        let (a3, a2, a1) = (2.0 * c4 - c1 - c6, 3.0 * (c2 - c5), c1 - 2.0 * c3 + c6);
        // Half the derivative of the cost, times (q² + 1)³, and its own derivative.
        let slope = |q: Real| (((c5 * q + a3) * q + a2) * q + a1) * q - c2;
        let curvature = |q: Real| ((4.0 * c5 * q + 3.0 * a3) * q + 2.0 * a2) * q + a1;

        let (regular, inverse) = (c2 / c1, c6 / c5);
        let (smallest, largest) = (k * SMALLEST_RATIO, k * LARGEST_RATIO);
        let mut low = clamp(min(regular, inverse), smallest, largest);
        let mut high = clamp(max(regular, inverse), smallest, largest);
        if !(slope(low) <= 0.0 && slope(high) >= 0.0) {
            // Deviations that change a lot from pair to pair, or a minimum out of range.
            (low, high) = (smallest, largest);
        }
        let mut q = 0.5 * (low + high);
        for _ in 0..ROUNDS {
            let s = slope(q);
            if s > 0.0 {
                high = q;
            } else {
                low = q;
            }
            let newton = q - s / curvature(q);
            q = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        let width = q * q + 1.0;
        let variance = width * width * width / (curvature(q) * k * k);
        let sound = sane(q) && k > 0.0 && variance > 0.0 && sane(variance);
        sound.then(|| (q / k, variance))
    }
}

#[cfg(test)]
mod tests;
