//! State of charge from current and voltage, with a standard deviation that can be believed.
//!
//! An extended Kalman filter \[Plett2004Part3\] with two states: the state of charge, and the
//! error of the model's voltage. What makes its standard deviation honest is the second one: a
//! model that is 15 mV wrong stays so for minutes, and a filter that takes this for noise averages
//! it away and claims what it cannot know.
//!
//! # Equations
//! ```text
//! prediction   s ← s − h·(I − I_off)/(3600·Q)        v_k ← v_k + g_k·(R_k·(I − I_off) − v_k)
//! measurement  V = OCV(s) + M·η + e − R_0·(I − I_off) − v_1 − v_2 + noise of variance r
//! covariance   P = U·D·Uᵀ,  U = (1 u; 0 1),  D = diag(d_s, d_e):  var(s) = d_s + u²·d_e
//! correction   w = u·H + 1    S = r + H²·d_s + w²·d_e    Δs = (H·d_s + u·w·d_e)·res/S
//!              Δe = w·d_e·res/S    d_s ← d_s·r/(r + H²·d_s)    d_e ← d_e·(r + H²·d_s)/S
//!              u ← u − d_s·H·w/(r + H²·d_s)
//! ```
//! The covariance in factors \[Bierman1977, section V.3\] is symmetric by form, and positive as
//! long as `d_s` and `d_e` are, which only ever are multiplied by ratios of positive numbers or
//! added to.
//!
//! | Symbol | Field |
//! |---|---|
//! | `s`, state of charge | [`EkfState::soc`]: `soc_before + rise` |
//! | `v_1`, `v_2`, polarisation | [`EkfState::polarisation_v`] |
//! | `e`, error of the model's voltage | [`EkfState::error_v`] |
//! | `d_s`, `d_e` | [`EkfState::own_variance`], [`EkfState::error_variance_v2`] |
//! | `u`; `var(s)` | [`EkfState::shared_per_v`]; [`EkfState::variance`] |
//! | `I_off`, offset of the current sensor | [`EkfState::current_offset_a`] |
//! | `R_0`; `g_k·R_k` | `series_ohm`; `branch_ohm` |
//! | `OCV + M·η` and its tangent, as of the last refresh | `open_circuit_v`, `tangent_v` |
//! | `H`, slope that the correction uses | `slope_v` |
//! | `r = r_0 + r_I·I²` | `noise_v2`, `load_noise_ohm2` |
//! | `η`, hysteresis; `Ī`; `σ` | `slow.hysteresis`, `slow.load_a`, `slow.error_sd_v` |
//! | `res`; its mean | [`EkfOutput::residual_v`]; `slow.residual_v` |
//!
//! # What is ours
//! - **The model's error** is coloured. Its standard deviation follows the load:
//!   `σ² = σ_ocv² + (ρ·R·Ī)² + σ_pol² + (R_pol·I_before)² + σ_V² + (M·σ_η)²` with ρ the relative
//!   error of the resistances, Ī the mean magnitude of the current over minutes, `σ_pol` and
//!   `I_before` what is left of an unknown polarisation at the start and of the current before it,
//!   and `σ_V` what a sensor's resolution does alike at rest. It does not change with time but with charge (the open-circuit curve's error is a
//!   function of the state of charge): at rest nothing is averaged. When σ falls from σ₁ to σ₂ the
//!   error keeps the share (σ₂/σ₁)², as a sum of independent parts does of which some go; without
//!   this, changes of the load would seem to tell the state of charge apart from the error.
//! - **Faster errors** (the model's dynamics) are correlated over seconds: in a step they count as
//!   noise with the same spectral density.
//! - **The curve bends**: of its mean slopes within three standard deviations the least counts; a
//!   curve that is steep on one side only says little.
//! - **Where the curve is flat** the voltage corrects nothing. It is still watched: a residual of more
//!   than three standard deviations says that the battery has left the flat part, and where to.
//! - **Drift**: offset of the current sensor and error of the capacity, as a random walk that
//!   reaches their effect after an hour; where the voltage does not hold it, as the offset that it
//!   is, which adds up.
//! - **A slope that changes tells nothing**: it is held for a while, and what was learnt with one
//!   slope is carried over to the next.
//! - **A start that is told** is doubted until the voltage agrees: where the curve would not show one
//!   that is far off, it is known no better than to 2.7 %; where it needs a large error of the model, it
//!   may as well be wrong itself.
//! - **A model whose error is larger** than was declared is given a larger one from then on
//!   \[Mehra1970\].
//! - **Before the start** a third of the capacity in an hour may have flowed: the polarisation that
//!   this leaves is part of the model's error until the branches have forgotten it.
//! - **A current that is missing** goes on as it was for some seconds; its error is the same within
//!   a gap, another one in the next.
//! - **What contradicts is said**: corrections of the last hour whose sum is more than three standard
//!   deviations of what it should be, residuals or errors whose mean square is too large, a voltage that
//!   does not react as the current lets expect, are not consistent.
//!
//! The polarisation is that of the model under the measured current: the branches forget, so what
//! is wrong in them is part of the model's error.
//!
//! [`Ekf::update`] predicts and corrects at each sample, along the tangent of the open-circuit
//! curve; [`Ekf::refresh`], about once a second, brings that tangent, the resistances and the
//! variances that only grow slowly up to date.
//!
//! Tests: `tests` below; long runs in `tests/tests/bms_ekf.rs`; measured cells and trips in
//! `tests/tests/soc.rs` and `voltstep soc --matrix`.

mod correction;
mod drift;
mod gap;
mod params;
mod pause;
mod reaction;
mod size;
mod slope;
mod slow;
mod start;
#[cfg(test)]
mod tests;
mod trust;

pub use params::{EkfParams, Uncertainty};
pub use pause::{EkfMemory, Polarisation};

use plant_core::battery::MappedBattery;
use plant_core::num::{Accum, LARGEST, Real, clamp, lag_gain, max, min, sane, sqrt};
use plant_core::{Dt, Model, ParamError, check};

use crate::Estimate;
use correction::Correction;

/// The standard deviation of a state of charge of which nothing is known: uniform in 0..1, `1/√12`.
const UNKNOWN_SD: Real = 0.288_675_13;
/// A correction of the state of charge beyond this is made with the curve's mean slope over it.
/// Chosen: a table's point and a half.
const LARGE_CORRECTION: Real = 0.02;
/// Slopes that are tried for it. Chosen: each brings the correction nearer; a bound on the cost.
const CORRECTIONS: u32 = 3;
/// A residual beyond this many standard deviations is no measurement. Chosen: noise alone goes there
/// once in 5e8 samples.
const OUTLIER: Real = 6.0;
/// The most that the model's error, and what is left of it, may be in standard deviations. Chosen:
/// 0.3 % of what is normally distributed lies beyond.
const CONSISTENT: Real = 3.0;

/// A Kalman filter for the state of charge, discretised for one step.
///
/// ```
/// use plant_core::presets::PANASONIC_NCR18650PF;
/// use voltstep_bms::estimate::ekf::{Ekf, EkfInput, EkfParams};
/// use voltstep_bms::{Dt, ParamError};
/// use plant_core::must;
///
/// const EKF: Ekf = must!(Ekf::new(
///     EkfParams::typical(PANASONIC_NCR18650PF, 3.65),
///     must!(Dt::from_s(0.1)),
/// ));
///
/// let mut state = EKF.start_unknown(25.0)?;
/// let rested = EkfInput {
///     current_a: 0.0,
///     voltage_v: PANASONIC_NCR18650PF.open_circuit.at(0.7),
///     temperature_c: 25.0,
///     contactors_open: false,
/// };
/// for _ in 0..600 {
///     EKF.step(&mut state, rested);
/// }
/// let estimate = EKF.estimate(&state);
/// assert!((estimate.soc - 0.7).abs() < 0.01);
/// assert!(estimate.soc_sd > 0.005, "the curve itself is known to 10 mV only");
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ekf {
    battery: MappedBattery,
    params: EkfParams,
    gains: [Real; 2],
    soc_per_a: Real,
    /// A larger current is no measurement \[A\].
    largest_a: Real,
    dt_s: Real,
    refresh_steps: u32,
}

/// The state of an [`Ekf`]: made by one of its `start` functions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct EkfState {
    /// State of charge at the last refresh, and its rise since then.
    soc_before: Accum,
    rise: Real,
    /// Voltage across the RC branches, the faster first, positive when discharging \[V\].
    pub polarisation_v: [Real; 2],
    /// The model's error, measured less expected \[V\].
    pub error_v: Real,
    /// The part of the variance of the state of charge that the model's error does not share.
    pub own_variance: Real,
    /// What the state of charge is off for each volt that the model's error is \[1/V\].
    pub shared_per_v: Real,
    /// Variance of the model's error \[V²\].
    pub error_variance_v2: Real,
    /// What the current sensor shows when no current flows \[A\].
    pub current_offset_a: Real,
    /// What an ampere takes in a step.
    soc_per_a: Real,
    series_ohm: Real,
    /// The resistances of the branches times the gains of a step \[Ω\].
    branch_ohm: [Real; 2],
    /// Open-circuit voltage with hysteresis at the last refresh \[V\], and the curve's tangent
    /// there \[V per unit of SOC\].
    open_circuit_v: Real,
    tangent_v: Real,
    /// The curve's slope, as little as it may be \[V per unit of SOC\].
    slope_v: Real,
    /// Variance of what a step takes for noise \[V²\], and what each A² of its current adds.
    noise_v2: Real,
    load_noise_ohm2: Real,
    /// Current, summed over the steps since the last refresh \[A\].
    current_sum_a: Real,
    /// Measured less expected voltage, summed likewise \[V\].
    residual_sum_v: Real,
    /// The last measured current \[A\].
    last_a: Real,
    /// What the voltage has added to the state of charge since the last refresh.
    corrected: Real,
    steps_left: u32,
    slow: slow::Slow,
}

/// Input of one step of an [`Ekf`]: what was measured at its end; not a number where it was not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EkfInput {
    /// Current \[A\], positive when discharging.
    pub current_a: Real,
    /// Voltage at the terminals \[V\].
    pub voltage_v: Real,
    /// Temperature \[°C\]; read when the resistances are refreshed. A missing one is the last one.
    pub temperature_c: Real,
    /// The contactors are open: no current flows, what the sensor shows is its offset.
    pub contactors_open: bool,
}

/// Output of one step of an [`Ekf`]; [`Ekf::estimate`] and [`Ekf::status`] say what is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EkfOutput {
    /// Measured voltage less the expected one, before the correction \[V\]; 0 without a sample.
    pub residual_v: Real,
    /// Current or voltage was missing or absurd: the estimate is held, its variance grows.
    pub rejected: bool,
}

/// What to think of an estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[expect(clippy::struct_excessive_bools, reason = "independent flags")]
pub struct EkfStatus {
    /// The standard deviation is below [`EkfParams::converged_sd`].
    pub converged: bool,
    /// The model's error, and the mean residual beside it, are of the size that is expected.
    pub consistent: bool,
    /// The open-circuit curve is flat here: the voltage does not correct.
    pub flat: bool,
    /// State of charge or temperature lie outside the range of the model's parameters.
    pub outside_identified: bool,
    /// The temperature is not known; the last one holds.
    pub temperature_missing: bool,
}

impl Ekf {
    /// Checks `params` and discretises them for steps of `dt`, the time between two samples.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: EkfParams, dt: Dt) -> Result<Self, ParamError> {
        let params = check!(params.checked());
        let battery = check!(MappedBattery::new(params.battery, dt));
        let map = &params.battery;
        let steps = map.refresh_s / dt.s();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "held in 1..2^31 first"
        )]
        let refresh_steps = clamp(steps + 0.5, 1.0, 2_147_483_648.0) as u32;
        Ok(Self {
            battery,
            params,
            gains: [
                lag_gain(dt.s() / map.polarisation.time_constant_s),
                lag_gain(dt.s() / map.second_polarisation.time_constant_s),
            ],
            soc_per_a: dt.s() / (3600.0 * map.capacity_ah),
            largest_a: 2.0 * min(LARGEST, max(map.discharge_limit_a, map.charge_limit_a)),
            dt_s: dt.s(),
            refresh_steps,
        })
    }

    /// Its parameters.
    #[must_use]
    pub const fn params(&self) -> &EkfParams {
        &self.params
    }

    /// One step: what flowed since the last one, and what the terminals show now.
    #[inline]
    pub fn step(&self, state: &mut EkfState, input: EkfInput) -> EkfOutput {
        if state.steps_left == 0 {
            self.refresh(state, &input);
        }
        state.steps_left -= 1;
        let current_a =
            if input.contactors_open { state.current_offset_a } else { input.current_a };
        self.update(state, current_a, input.voltage_v)
    }

    /// The part of a step that is not left to [`refresh`](Self::refresh): the state's prediction,
    /// its correction and what that does to the covariance.
    // A call would pass the state through memory once more.
    #[inline(always)]
    pub fn update(&self, state: &mut EkfState, current_a: Real, voltage_v: Real) -> EkfOutput {
        if !(current_a.abs() <= self.largest_a && sane(voltage_v)) {
            return self.miss(state, current_a);
        }
        state.current_sum_a += current_a;
        state.last_a = current_a;
        let current_a = current_a - state.current_offset_a;
        state.rise -= current_a * state.soc_per_a;
        let [fast_v, slow_v] = self.polarise(state, current_a);
        let drop_v = state.series_ohm * current_a + fast_v + slow_v;
        let open_circuit_v = state.open_circuit_v + state.tangent_v * state.rise;
        let residual_v = voltage_v - (open_circuit_v + state.error_v - drop_v);
        let noise_v2 = state.noise_v2 + state.load_noise_ohm2 * (current_a * current_a);
        let correction = Correction::new(state, state.slope_v, noise_v2);
        if correction.soc_per_v < 0.0
            || (correction.soc_per_v * residual_v).abs() > LARGE_CORRECTION
            || residual_v * residual_v * correction.per_total > OUTLIER * OUTLIER
        {
            return self.surprise(state, residual_v, noise_v2);
        }
        correction.apply(state, residual_v, noise_v2)
    }

    /// The RC branches under a current \[V\].
    #[inline(always)]
    fn polarise(&self, state: &mut EkfState, current_a: Real) -> [Real; 2] {
        let [fast_v, slow_v] = state.polarisation_v;
        let [fast, slow] = self.gains;
        let [fast_ohm, slow_ohm] = state.branch_ohm;
        state.polarisation_v = [
            fast_v * (1.0 - fast) + fast_ohm * current_a,
            slow_v * (1.0 - slow) + slow_ohm * current_a,
        ];
        state.polarisation_v
    }

    /// The open-circuit voltage and its slope; beyond the identified range along the slope at its
    /// end, so that a wrong estimate finds back.
    #[inline]
    fn open_circuit(&self, soc: Real) -> (Real, Real) {
        let range = &self.params.battery.identified;
        let inside = clamp(soc, range.soc_min, range.soc_max);
        let (voltage_v, slope) = self.params.battery.open_circuit.with_slope(inside);
        (voltage_v + slope * (soc - inside), slope)
    }

    /// A large correction with the mean slope of the curve over it: where the curve bends, the
    /// slope at its start would lead astray. A residual that is no measurement corrects nothing,
    /// nor does one that would lower the state of charge for a voltage that is too high: that comes
    /// of a slope that was another one when the model's error was learnt, not of the battery.
    #[cold]
    #[inline(never)]
    fn surprise(&self, state: &mut EkfState, residual_v: Real, noise_v2: Real) -> EkfOutput {
        let soc = state.soc();
        let (open_circuit_v, _) = self.open_circuit(soc);
        let mut correction = Correction::new(state, state.slope_v, noise_v2);
        for _ in 0..CORRECTIONS {
            let change = clamp(soc + correction.soc_per_v * residual_v, 0.0, 1.0) - soc;
            if change.abs() < 0.1 * LARGE_CORRECTION {
                break;
            }
            let slope = (self.open_circuit(soc + change).0 - open_circuit_v) / change;
            let mut there = *state;
            self.change_slope(&mut there, slope, true);
            correction = Correction::new(&there, slope, noise_v2);
        }
        state.residual_sum_v += residual_v;
        if residual_v * residual_v * correction.per_total > OUTLIER * OUTLIER {
            self.distrust(state);
        } else if correction.soc_per_v >= 0.0 {
            state.rise += correction.soc_per_v * residual_v;
            state.corrected += correction.soc_per_v * residual_v;
            state.error_v += correction.error_gain * residual_v;
            self.follow_curve(state);
            // What is learnt is less than the mean slope says where the curve is flatter nearby.
            let slope_v = min(state.slope_v, correction.slope_v);
            self.change_slope(state, slope_v, true);
            Correction::new(state, slope_v, noise_v2).shrink(state, noise_v2);
            state.slow.slope.release();
        }
        EkfOutput { residual_v, rejected: false }
    }

    /// What is believed.
    #[must_use]
    pub fn estimate(&self, state: &EkfState) -> Estimate {
        Estimate {
            soc: state.soc(),
            soc_sd: sqrt(state.variance()),
            polarisation_v: state.polarisation_v,
            hysteresis: state.slow.hysteresis,
            offset_v: state.error_v,
            temperature_c: state.slow.temperature_c,
        }
    }

    /// What to think of it.
    #[must_use]
    pub fn status(&self, state: &EkfState) -> EkfStatus {
        let (soc, temperature_c) = (state.soc(), state.slow.temperature_c);
        let most_v = CONSISTENT * state.slow.error_sd_v;
        let sd = self.params.converged_sd;
        EkfStatus {
            converged: state.variance() < sd * sd,
            consistent: state.error_v.abs() <= most_v
                && state.slow.residual_v.abs() <= most_v
                && state.slow.trust.is_earned()
                && state.slow.reaction.is_expected()
                && state.slow.size.is_expected(),
            flat: self.is_flat(state),
            outside_identified: !self.params.battery.identified.holds(soc, temperature_c),
            temperature_missing: state.slow.temperature_missing,
        }
    }

    /// Whether the open-circuit curve says nothing here.
    const fn is_flat(&self, state: &EkfState) -> bool {
        state.slope_v < self.params.flat_v_per_soc
    }
}

impl EkfState {
    /// State of charge, 0..1.
    #[inline]
    #[must_use]
    pub const fn soc(&self) -> Real {
        clamp(self.soc_before.get() + self.rise, 0.0, 1.0)
    }

    /// The variance of the state of charge.
    #[must_use]
    pub const fn variance(&self) -> Real {
        self.own_variance + self.shared_per_v * self.shared_per_v * self.error_variance_v2
    }
}

impl Model for Ekf {
    type State = EkfState;
    type Input = EkfInput;
    type Output = EkfOutput;

    #[inline]
    fn step(&self, state: &mut EkfState, input: EkfInput) -> EkfOutput {
        Self::step(self, state, input)
    }
}
