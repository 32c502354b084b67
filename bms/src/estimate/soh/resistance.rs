//! Resistance by recursive least squares with forgetting, for one parameter \[Ljung1999, eq.
//! 11.12\]: `−ΔV = f·Δη + noise`; `S = P·x² + r`, `f += P·x/S·(y − f·x)`, `P = P·r/(S·λ)`.
//!
//! Which pairs of samples it learns from, and what is taken of outliers and misfit, are ours.
//!
//! Tests: `tests` below; `tests/tests/bms_soh.rs`.

use plant_core::battery::{MappedBattery, Resistances};
use plant_core::error::{check, not_negative, positive};
use plant_core::num::{clamp, lag_gain, max, min, sane, sqrt};
use plant_core::{Accum, Dt, ParamError, Real};

use super::OUTLIER_SDS;
use crate::Estimate;

/// Factors outside are not believed. Chosen: less is a wrong parameter set.
const SMALLEST_FACTOR: Real = 0.2;
/// Factors outside are not believed. Chosen: more is a bad contact, not age.
const LARGEST_FACTOR: Real = 10.0;

/// What voltage and current are apart in time may make up this share of a step to learn from. Chosen:
/// readings 50 to 200 ms apart then leave the factor within 1 %, where it was 0.2 of what it is.
const SKEW_SHARE: Real = 0.1;
/// What no number of steps averages out where the sensors are out of step, as a share of the factor.
/// Chosen: what [`SKEW_SHARE`] leaves.
const SYSTEMATIC: Real = 0.01;
/// The longest pair to learn from, in samples. Chosen: over 20 the open-circuit voltage hardly moves.
const LONGEST_PAIR: u32 = 20;
/// A single residual's square over what was expected counts up to this. Chosen:
/// 32 standard deviations; with 3 the factor seems known where the readings are worse than promised.
const MOST_MISFIT: Real = 1000.0;

/// Parameters of a [`ResistanceEstimator`]: how good the readings are, and how it learns from
/// them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ResistanceParams {
    /// Standard deviation of a voltage reading \[V\], quantum included, above zero.
    pub voltage_sd_v: Real,
    /// Standard deviation of a current reading \[A\], quantum included, above zero.
    pub current_sd_a: Real,
    /// The smallest change of the current between two samples to learn from \[A\], above zero.
    /// Noise of the current lowers the result by twice the square of `current_sd_a` over this:
    /// 2 % at ten times the noise.
    pub least_step_a: Real,
    /// How many such changes are remembered, above 1: with λ = 1 − 1/n.
    pub memory_steps: Real,
    /// Standard deviation of the factor before anything was learnt, above zero.
    pub initial_sd: Real,
    /// Voltage and current of a sample may be so far apart in time \[s\], ≥ 0. With 0, two
    /// samples one after the other are a pair; otherwise one ends and begins only where the current
    /// is steady for as long as this needs, and from a current that changes at every sample nothing
    /// is learnt.
    pub skew_s: Real,
}

/// The factor by which a battery's resistances exceed those of its parameters.
///
/// Between two samples, few steps apart, the open-circuit voltage stays nearly the same and what
/// moves slowly drops out:
/// `−ΔV = f·Δη + noise`, η the overpotential `R0·I + v1 + v2` that the battery of the parameters
/// would show under the same current, at the same state of charge and temperature; so neither of
/// the two is in the factor. Recursive least squares with forgetting \[Ljung1999, eq. 11.12\]:
/// `S = P·x² + r`, `f += P·x/S·(y − f·x)`, `P = P·r/(S·λ)`, only where the current changes enough,
/// so that nothing is forgotten while nothing is learnt. `r` is the variance of the readings; an
/// innovation beyond three standard deviations counts as if the readings were as uncertain as
/// that. Where the residuals are larger than `r` says, so is the published standard deviation.
///
/// What is wrong alike in every sample is not in it: the gain of a sensor, the map of the
/// parameters. What sees mostly short steps sees mostly the series resistance: where the branches age
/// differently, the factor is that of the former.
///
/// ```
/// use plant_core::presets::PANASONIC_NCR18650PF as CELL;
/// use voltstep_bms::estimate::soh::{ResistanceEstimator, ResistanceInput, ResistanceParams};
/// use voltstep_bms::{Dt, Estimate};
/// use plant_core::{battery::MappedBattery, must};
///
/// const DT: Dt = must!(Dt::from_s(1.0));
/// const BATTERY: MappedBattery = must!(MappedBattery::new(CELL, DT));
/// const PARAMS: ResistanceParams = ResistanceParams {
///     voltage_sd_v: 0.001,
///     current_sd_a: 0.01,
///     least_step_a: 0.3,
///     memory_steps: 500.0,
///     initial_sd: 0.5,
///     skew_s: 0.0,
/// };
/// const ESTIMATOR: ResistanceEstimator = must!(ResistanceEstimator::new(PARAMS, &BATTERY, DT));
///
/// // An aged cell: the voltage drops by half as much again, through the series resistance alone.
/// let estimate = Estimate::rested(0.6, 0.01, 25.0);
/// let series_ohm = 1.5 * BATTERY.resistances(0.6, 25.0).series_ohm;
/// let mut state = ESTIMATOR.unknown();
/// let mut out = None;
/// for second in 0..200 {
///     let current_a = if second % 20 == 0 { 3.0 } else { 0.0 };
///     let voltage_v = CELL.open_circuit.at(0.6) - series_ohm * current_a;
///     out = Some(ESTIMATOR.step(&mut state, ResistanceInput { voltage_v, current_a, estimate }));
/// }
/// assert!((1.2..1.6).contains(&out.unwrap().factor));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResistanceEstimator<'b> {
    battery: &'b MappedBattery,
    gains: [Real; 2],
    soc_per_a: Real,
    refresh_steps: u32,
    voltage_variance: Real,
    current_variance: Real,
    least_step_a: Real,
    per_memory: Real,
    largest_variance: Real,
    /// The skew in samples, over the share of a step that it may make up.
    skew_per_step: Real,
}

/// The state of a [`ResistanceEstimator`]; [`ResistanceEstimator::unknown`] and
/// [`ResistanceEstimator::known`] make one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct ResistanceState {
    factor: Real,
    variance: Real,
    /// Mean square of the innovations over what was expected.
    misfit: Real,
    /// Of the battery of the parameters.
    polarisation_v: [Accum; 2],
    resistances: Resistances,
    steps_left: u32,
    /// The last sample, and by how much the current changed up to it \[A\].
    last: Option<(Sample, Real)>,
    /// Where a pair begins, and how restless the current was there \[A\].
    reference: Option<(Sample, Real)>,
    /// Since then: the currents' sum \[A\], and the samples.
    passed_a: Real,
    passed: u32,
}

/// What the next sample is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
struct Sample {
    voltage_v: Real,
    current_a: Real,
    overpotential_v: Real,
}

/// Input of a [`ResistanceEstimator`]: readings of the same instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResistanceInput {
    /// Voltage at the terminals \[V\].
    pub voltage_v: Real,
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
    /// What is believed to be in the battery; of it, state of charge and temperature.
    pub estimate: Estimate,
}

/// Output of a [`ResistanceEstimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ResistanceOutput {
    /// The resistances are larger by this factor.
    pub factor: Real,
    /// Its standard deviation.
    pub factor_sd: Real,
    /// This sample changed it.
    pub learned: bool,
    /// The factor lies at the end of what is believed, 0.2 or 10: the readings are out of step, or
    /// not of this battery. Its standard deviation is then that of an unknown one.
    pub at_bound: bool,
    /// The input was not finite or absurd; the factor is unchanged, and what comes next is not
    /// compared with this sample.
    pub rejected: bool,
}

impl<'b> ResistanceEstimator<'b> {
    /// Checks `params` and discretises them for samples every `dt` of a `battery`, whose own step
    /// does not matter here.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(
        params: ResistanceParams,
        battery: &'b MappedBattery,
        dt: Dt,
    ) -> Result<Self, ParamError> {
        let voltage_sd_v = check!(positive("resistance.voltage_sd_v", params.voltage_sd_v));
        let current_sd_a = check!(positive("resistance.current_sd_a", params.current_sd_a));
        let memory = check!(positive("resistance.memory_steps", params.memory_steps));
        if memory <= 1.0 {
            return Err(ParamError::NotAbove("resistance.memory_steps"));
        }
        let initial_sd = check!(positive("resistance.initial_sd", params.initial_sd));
        let skew_s = check!(not_negative("resistance.skew_s", params.skew_s));
        let known = battery.params();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "held in 1..2^31 first"
        )]
        let refresh_steps = clamp(known.refresh_s / dt.s() + 0.5, 1.0, 2_147_483_648.0) as u32;
        Ok(Self {
            battery,
            gains: [
                lag_gain(dt.s() / known.polarisation.time_constant_s),
                lag_gain(dt.s() / known.second_polarisation.time_constant_s),
            ],
            soc_per_a: dt.s() / (3600.0 * known.capacity_ah),
            refresh_steps,
            voltage_variance: voltage_sd_v * voltage_sd_v,
            current_variance: current_sd_a * current_sd_a,
            least_step_a: check!(positive("resistance.least_step_a", params.least_step_a)),
            per_memory: 1.0 / memory,
            largest_variance: initial_sd * initial_sd,
            skew_per_step: skew_s / dt.s() / SKEW_SHARE,
        })
    }

    /// Nothing learnt yet: a rested battery as its parameters say.
    #[must_use]
    pub const fn unknown(&self) -> ResistanceState {
        ResistanceState {
            factor: 1.0,
            variance: self.largest_variance,
            misfit: 1.0,
            polarisation_v: [Accum::new(0.0); 2],
            resistances: Resistances { series_ohm: 0.0, polarisation_ohm: [0.0; 2] },
            steps_left: 0,
            last: None,
            reference: None,
            passed_a: 0.0,
            passed: 0,
        }
    }

    /// What was learnt before, from a record; a rested battery. What is not finite or out of range
    /// is not taken.
    #[must_use]
    pub const fn known(&self, factor: Real, factor_sd: Real) -> ResistanceState {
        let mut state = self.unknown();
        let variance = factor_sd * factor_sd;
        if factor >= SMALLEST_FACTOR && factor <= LARGEST_FACTOR && variance >= 0.0 {
            state.factor = factor;
            state.variance = min(variance, self.largest_variance);
        }
        state
    }

    /// Looks at one sample.
    pub fn step(&self, state: &mut ResistanceState, input: ResistanceInput) -> ResistanceOutput {
        let (soc, celsius) = (input.estimate.soc, input.estimate.temperature_c);
        let magnitude = input.voltage_v.abs() + input.current_a.abs() + soc.abs() + celsius.abs();
        let rejected = !sane(magnitude);
        let mut learned = false;
        if rejected {
            (state.last, state.reference) = (None, None);
        } else {
            let sample = self.follow(state, input);
            learned = self.pair(state, sample, soc, celsius);
        }
        let at_bound = state.factor <= SMALLEST_FACTOR || state.factor >= LARGEST_FACTOR;
        let variance = if at_bound { self.largest_variance } else { state.variance };
        let systematic = if self.skew_per_step > 0.0 { SYSTEMATIC * state.factor } else { 0.0 };
        ResistanceOutput {
            factor: state.factor,
            factor_sd: sqrt(variance * max(1.0, state.misfit) + systematic * systematic),
            learned,
            at_bound,
            rejected,
        }
    }

    /// Ends a pair at this sample where it tells something; whether it did. What the current
    /// changed by around either end is, times the skew, what the voltage may not belong to.
    fn pair(&self, state: &mut ResistanceState, sample: Sample, soc: Real, celsius: Real) -> bool {
        let (changed_a, before_a) = match state.last {
            Some((last, before_a)) => ((sample.current_a - last.current_a).abs(), before_a),
            None => (0.0, 0.0),
        };
        state.last = Some((sample, changed_a));
        let restless_a = self.skew_per_step * max(changed_a, before_a);
        state.passed_a += sample.current_a;
        state.passed += 1;
        let mut learned = false;
        if let Some((reference, then_a)) = state.reference {
            let step_a = (sample.current_a - reference.current_a).abs();
            if step_a >= self.least_step_a
                && restless_a + then_a <= step_a
                && self.battery.params().identified.holds(soc, celsius)
            {
                // What the open-circuit voltage itself moves between the two.
                let (_, slope_v) = self.battery.open_circuit().with_slope(soc);
                let drift_v = slope_v * self.soc_per_a * state.passed_a;
                let drop_v = reference.voltage_v - sample.voltage_v - drift_v;
                self.learn(state, sample.overpotential_v - reference.overpotential_v, drop_v);
                learned = true;
            }
        }
        let steadier = state.reference.is_none_or(|(_, then_a)| restless_a <= then_a);
        if learned || steadier || state.passed >= LONGEST_PAIR {
            state.reference = Some((sample, restless_a));
            (state.passed_a, state.passed) = (0.0, 0);
        }
        learned
    }

    /// The battery of the parameters under the same current.
    fn follow(&self, state: &mut ResistanceState, input: ResistanceInput) -> Sample {
        if state.steps_left == 0 {
            state.steps_left = self.refresh_steps;
            state.resistances =
                self.battery.resistances(input.estimate.soc, input.estimate.temperature_c);
        }
        state.steps_left -= 1;
        let mut overpotential_v = state.resistances.series_ohm * input.current_a;
        for ((voltage_v, gain), ohm) in
            state.polarisation_v.iter_mut().zip(self.gains).zip(state.resistances.polarisation_ohm)
        {
            voltage_v.add(gain * (ohm * input.current_a - voltage_v.get()));
            overpotential_v += voltage_v.get();
        }
        Sample { voltage_v: input.voltage_v, current_a: input.current_a, overpotential_v }
    }

    /// One step of least squares: `dropped_v` where the battery of the parameters drops
    /// `expected_v`.
    fn learn(&self, state: &mut ResistanceState, expected_v: Real, dropped_v: Real) {
        let ohm = state.factor * state.resistances.series_ohm;
        let doubt = state.variance * expected_v * expected_v;
        let expected = doubt + 2.0 * (self.voltage_variance + ohm * ohm * self.current_variance);
        let innovation_v = dropped_v - state.factor * expected_v;
        let square = innovation_v * innovation_v;
        let spread = max(expected, square / (OUTLIER_SDS * OUTLIER_SDS));
        let factor = state.factor + state.variance * expected_v / spread * innovation_v;
        let variance = state.variance * ((spread - doubt) / spread) / (1.0 - self.per_memory);
        if factor.is_finite() && variance.is_finite() {
            state.factor = clamp(factor, SMALLEST_FACTOR, LARGEST_FACTOR);
            state.variance = min(variance, self.largest_variance);
            let beyond = min(square / expected, MOST_MISFIT);
            state.misfit += self.per_memory * (beyond - state.misfit);
        }
    }
}

#[cfg(test)]
mod tests;
