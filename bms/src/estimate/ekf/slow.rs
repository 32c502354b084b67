//! What an [`Ekf`] does at a slower rate, and what it does rarely: starts, resistances over state
//! of charge and temperature, the size of the model's error, the sensor's offset, gaps.

use plant_core::battery::REFERENCE_C;
use plant_core::error::ratio;
use plant_core::num::{Accum, Real, clamp, lag_gain, max, min, sign, sqrt};
use plant_core::{ParamError, check};

use super::correction::Correction;
use super::{CONSISTENT, Ekf, EkfInput, EkfOutput, EkfState};

// "Measured" beside a constant: what half and twice of it make of `voltstep soc --matrix` over six
// drive cycles of a cell and four trips (120 runs), as RMS error and mean standard deviation of the
// state of charge. As it is: 0.81 % and 1.89 %. The truth stays within three standard deviations in
// all of them.

/// The standard deviation of a state of charge of which nothing is known: uniform in 0..1, `1/√12`.
const UNKNOWN_SD: Real = 0.288_675_13;
/// The mean magnitude of the current follows over this time \[s\]. Chosen: some time constants of a
/// slow branch. Measured: 0.79 % and 1.83 %, 0.86 % and 1.92 %; on the mean a wrong start is
/// forgotten after 300 s, 410 s instead of 380 s.
const LOAD_MEMORY_S: Real = 300.0;
/// The model's faster errors are correlated over this time \[s\]. Chosen: a fast branch's time
/// constant. Measured: 0.80 % and 1.85 %, 0.82 % and 1.96 %.
const DYNAMICS_S: Real = 10.0;
/// The random walk of the drift reaches the drift itself after this time \[s\]. Chosen: a drive.
/// Measured: 0.81 % and 1.73 %, 0.83 % and 2.10 %.
const DRIFT_HORIZON_S: Real = 3600.0;
/// The offset of the current sensor is learnt over this time with open contactors \[s\] …
/// Chosen: of one reading a second an eighth of the noise is left.
const OFFSET_MEMORY_S: Real = 30.0;
/// … down to this share of its standard deviation. Chosen: a tenth of C/100 makes 0.1 % of charge in
/// an hour, much less than the curve leaves open.
const OFFSET_LEARNT: Real = 0.1;
/// What an outlier adds to the standard deviation of the state of charge, per square root of a
/// second: what keeps on contradicting the filter wins. Chosen: 2 % in a minute. Measured: 0.81 %
/// and 1.89 %, 0.82 % and 1.89 %: real files have few outliers.
const DISTRUST: Real = 0.003;
/// The mean residual follows over this time \[s\]. Chosen: that of [`DYNAMICS_S`]. Measured: 0.86 %
/// and 1.91 %, 0.81 % and 1.89 %.
const RESIDUAL_S: Real = 10.0;
/// The noise of a voltage that says nothing \[V²\]. Chosen: it leaves a gain of nothing for any
/// pack, `H²·d_s/r < 1e-4` up to 1000 V per unit of SOC.
const SILENT_V2: Real = 1e9;
/// Over less than this there is no mean slope. Chosen: the last bit of 400 V, 3e-5 V, makes
/// 0.03 V of slope over it. Measured: no difference.
const SHORTEST_CHORD: Real = 1e-3;
/// 0 °C in kelvin.
const KELVIN: Real = 273.15;
/// Temperatures outside are no measurement \[°C\]: those that a battery's parameters may have.
const TEMPERATURES_C: core::ops::RangeInclusive<Real> = -100.0..=200.0;

/// What changes slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Slow {
    /// Mean magnitude of the current \[A\]; negative before the first step.
    load_a: Real,
    /// The standard deviation of the model's error \[V\].
    pub(super) error_sd_v: Real,
    /// Mean residual \[V\].
    pub(super) residual_v: Real,
    /// All that a steady current sees \[Ω\], and the branches' part of it.
    total_ohm: Real,
    polarisation_ohm: Real,
    /// What is left of an unknown polarisation \[V\].
    polarisation_sd_v: Real,
    pub(super) hysteresis: Real,
    /// How little of the hysteresis is known: 1 at the start.
    hysteresis_sd: Real,
    soc_then: Real,
    offset_sd_a: Real,
    pub(super) temperature_c: Real,
    pub(super) temperature_missing: bool,
}

impl Ekf {
    /// Starts with a state of charge that is known from elsewhere (a stored record, a charger that
    /// has just filled the battery), with its standard deviation; the battery need not be rested.
    ///
    /// # Errors
    /// [`ParamError`] for a state of charge or a standard deviation outside 0..1, or a temperature
    /// outside −100..200 °C.
    pub fn start(
        &self,
        soc: Real,
        soc_sd: Real,
        temperature_c: Real,
    ) -> Result<EkfState, ParamError> {
        check!(ratio("soc", soc));
        check!(ratio("soc_sd", soc_sd));
        if !TEMPERATURES_C.contains(&temperature_c) {
            return Err(ParamError::OutOfRange("temperature_c"));
        }
        let known = &self.params.uncertainty;
        let error_sd_v = known.open_circuit_sd_v;
        Ok(EkfState {
            soc_before: Accum::new(soc),
            rise: 0.0,
            polarisation_v: [0.0; 2],
            error_v: 0.0,
            own_variance: max(soc_sd * soc_sd, Real::EPSILON),
            shared_per_v: 0.0,
            error_variance_v2: error_sd_v * error_sd_v,
            current_offset_a: 0.0,
            series_ohm: 0.0,
            branch_ohm: [0.0; 2],
            open_circuit_v: 0.0,
            tangent_v: 0.0,
            slope_v: 0.0,
            noise_v2: known.voltage_sd_v * known.voltage_sd_v,
            load_noise_ohm2: 0.0,
            load_sum_a: 0.0,
            residual_sum_v: 0.0,
            steps_left: 0,
            slow: Slow {
                load_a: -1.0,
                error_sd_v,
                residual_v: 0.0,
                total_ohm: 0.0,
                polarisation_ohm: 0.0,
                polarisation_sd_v: known.polarisation_sd_v,
                hysteresis: 0.0,
                hysteresis_sd: 1.0,
                soc_then: soc,
                offset_sd_a: known.current_offset_sd_a,
                temperature_c,
                temperature_missing: false,
            },
        })
    }

    /// Starts with nothing known of the state of charge.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] for a temperature outside −100..200 °C.
    pub fn start_unknown(&self, temperature_c: Real) -> Result<EkfState, ParamError> {
        self.start(0.5, UNKNOWN_SD, temperature_c)
    }

    /// Starts with the voltage of a rested battery. How long a rest is enough is the battery's
    /// matter: some times its slower time constant.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] for a voltage that is no number, [`ParamError::OutOfRange`] for a
    /// temperature outside −100..200 °C.
    pub fn start_rested(
        &self,
        voltage_v: Real,
        temperature_c: Real,
    ) -> Result<EkfState, ParamError> {
        check!(plant_core::error::finite("voltage_v", voltage_v));
        let soc = self.params.battery.open_circuit.soc_at(voltage_v);
        let mut state = self.start(soc, UNKNOWN_SD, temperature_c)?;
        state.slow.polarisation_sd_v = 0.0;
        self.follow_error(&mut state, 0.0);
        // Where the voltage says nothing, every state of charge that shows it is as good.
        let (_, slope_v) = self.open_circuit(soc);
        state.slope_v = slope_v;
        // What the curve's error and slope let the voltage say.
        if !self.is_flat(&state) {
            let noise_v2 = state.noise_v2;
            Correction::new(&state, slope_v, noise_v2).shrink(&mut state, noise_v2);
        }
        Ok(state)
    }

    /// Brings resistances and covariance up to temperature, load and charge.
    /// [`step`](Self::step) calls it every
    /// [`refresh_s`](plant_core::battery::MappedBatteryParams::refresh_s).
    #[inline(never)]
    pub fn refresh(&self, state: &mut EkfState, input: &EkfInput) {
        state.slow.temperature_missing = !TEMPERATURES_C.contains(&input.temperature_c);
        if !state.slow.temperature_missing {
            state.slow.temperature_c = input.temperature_c;
        }
        let seen = input.current_a.abs() <= self.largest_a;
        let steps = self.steps();
        let refresh_s = steps * self.dt_s;
        let mean_a = if state.slow.load_a < 0.0 {
            // Before the first step: as if this load had been on for long.
            state.slow.load_a = if seen { input.current_a.abs() } else { 0.0 };
            state.slow.load_a
        } else {
            let mean_a = state.load_sum_a / steps;
            state.slow.load_a += lag_gain(refresh_s / LOAD_MEMORY_S) * (mean_a - state.slow.load_a);
            let residual_v = state.residual_sum_v / steps;
            let gain = lag_gain(refresh_s / RESIDUAL_S);
            state.slow.residual_v += gain * (residual_v - state.slow.residual_v);
            let map = &self.params.battery;
            let memory_s =
                max(map.polarisation.time_constant_s, map.second_polarisation.time_constant_s);
            state.slow.polarisation_sd_v /= 1.0 + refresh_s / memory_s;
            mean_a
        };
        state.load_sum_a = 0.0;
        state.residual_sum_v = 0.0;
        state.steps_left = self.refresh_steps;
        state.soc_before.add(state.rise);
        state.soc_before.clamp(0.0, 1.0);
        state.rise = 0.0;
        if input.contactors_open && seen {
            let gain = lag_gain(refresh_s / OFFSET_MEMORY_S);
            state.current_offset_a += gain * (input.current_a - state.current_offset_a);
            let learnt_a = OFFSET_LEARNT * self.params.uncertainty.current_offset_sd_a;
            state.slow.offset_sd_a += gain * (learnt_a - state.slow.offset_sd_a);
        }
        let moved = mean_a * self.soc_per_a * steps;
        self.follow_hysteresis(state, moved);
        self.follow_error(state, moved);
        self.follow_curve(state);
        if self.is_flat(state) && state.slow.residual_v.abs() > CONSISTENT * state.slow.error_sd_v {
            self.leave_flat(state);
        }
        self.follow_noise(state, max(mean_a, state.slow.load_a));
    }

    #[allow(clippy::cast_precision_loss, clippy::cast_lossless, reason = "a length of time")]
    const fn steps(&self) -> Real {
        self.refresh_steps as Real
    }

    /// Resistances; the model's error after the state of charge has moved by `moved`, without its
    /// sign.
    fn follow_error(&self, state: &mut EkfState, moved: Real) {
        let (outside, resistance_sd) = (self.outside(state), self.resistance_sd(state));
        let now = self.battery.resistances(state.soc(), state.slow.temperature_c);
        let slow = &mut state.slow;
        let [fast, slower] = now.polarisation_ohm;
        state.series_ohm = now.series_ohm;
        state.branch_ohm = [self.gains[0] * fast, self.gains[1] * slower];
        slow.polarisation_ohm = fast + slower;
        slow.total_ohm = now.series_ohm + slow.polarisation_ohm;

        let known = &self.params.uncertainty;
        let hysteresis_v = self.params.battery.hysteresis.half_gap_v * slow.hysteresis_sd;
        let load_v = resistance_sd * slow.total_ohm * max(slow.load_a, 0.0);
        let squares = known.open_circuit_sd_v * known.open_circuit_sd_v
            + load_v * load_v
            + slow.polarisation_sd_v * slow.polarisation_sd_v
            + hysteresis_v * hysteresis_v;
        let before_v2 = slow.error_sd_v * slow.error_sd_v;
        slow.error_sd_v = outside * sqrt(squares);
        let after_v2 = slow.error_sd_v * slow.error_sd_v;

        // From one stationary variance to the other, forgetting what has gone.
        let keep = (1.0 - min(moved / known.correlation_soc, 1.0)) * min(after_v2 / before_v2, 1.0);
        let added_v2 = max(after_v2 - keep * keep * before_v2, 0.0);
        let variance_v2 = keep * keep * state.error_variance_v2 + added_v2;
        let share = state.error_variance_v2 / variance_v2;
        state.own_variance += state.shared_per_v * state.shared_per_v * share * added_v2;
        state.shared_per_v *= keep * share;
        state.error_variance_v2 = variance_v2;
        state.error_v *= keep;
    }

    /// Takes the state of charge from the voltage: no place on the flat part shows this one.
    #[cold]
    fn leave_flat(&self, state: &mut EkfState) {
        let (open_circuit_v, _) = self.open_circuit(state.soc());
        let shown_v = open_circuit_v + state.error_v + state.slow.residual_v;
        let soc = self.params.battery.open_circuit.soc_at(shown_v);
        let sd_v = state.slow.error_sd_v;
        state.soc_before = Accum::new(soc);
        state.rise = 0.0;
        state.error_v = 0.0;
        state.error_variance_v2 = sd_v * sd_v;
        state.slow.residual_v = 0.0;
        state.slow.soc_then = soc;
        // Whatever the model's error is, the state of charge makes up for it; how much that may be
        // depends on the curve as far as it reaches.
        let (_, mut slope_v) = self.open_circuit(soc);
        for _ in 0..2 {
            state.shared_per_v = -1.0 / max(slope_v, sd_v / UNKNOWN_SD);
            // The residual is a mean over some seconds; so is its state of charge.
            state.own_variance = sd_v * sd_v * state.shared_per_v * state.shared_per_v;
            self.follow_curve(state);
            slope_v = state.slope_v;
        }
    }

    /// The curve's tangent, and its least mean slope over one and a half standard deviations
    /// within three.
    pub(super) fn follow_curve(&self, state: &mut EkfState) {
        let soc = state.soc();
        let sd = sqrt(state.variance());
        let (open_circuit_v, tangent_v) = self.open_circuit(soc);
        let hysteresis_v = self.params.battery.hysteresis.half_gap_v * state.slow.hysteresis;
        state.tangent_v = tangent_v;
        state.open_circuit_v = open_circuit_v + hysteresis_v - tangent_v * state.rise;
        state.slope_v = tangent_v;
        for reach in [-1.5 * sd, 1.5 * sd] {
            let (mut from, mut from_v) = (soc, open_circuit_v);
            for _ in 0..2 {
                let to = clamp(from + reach, 0.0, 1.0);
                let (to_v, _) = self.open_circuit(to);
                if (to - from).abs() > SHORTEST_CHORD {
                    state.slope_v = min(state.slope_v, (to_v - from_v) / (to - from));
                }
                (from, from_v) = (to, to_v);
            }
        }
    }

    /// How many times larger the model's error is here: outside the identified range by more than
    /// what is not known of the state of charge.
    fn outside(&self, state: &EkfState) -> Real {
        let range = &self.params.battery.identified;
        let (soc, sd) = (state.soc(), sqrt(state.variance()));
        let nearest = clamp(clamp(soc, range.soc_min, range.soc_max), soc - sd, soc + sd);
        if range.holds(nearest, state.slow.temperature_c) {
            1.0
        } else {
            self.params.uncertainty.outside_factor
        }
    }

    /// The standard deviation of the resistances here, as a ratio to them.
    fn resistance_sd(&self, state: &EkfState) -> Real {
        let known = &self.params.uncertainty;
        let celsius = state.slow.temperature_c;
        let colder_per_k = (REFERENCE_C - celsius) / ((KELVIN + celsius) * (KELVIN + REFERENCE_C));
        let by_activation = known.activation_sd_k * colder_per_k;
        sqrt(known.resistance_sd * known.resistance_sd + by_activation * by_activation)
    }

    /// What a step counts as noise, and the drift since the last refresh.
    fn follow_noise(&self, state: &mut EkfState, load_a: Real) {
        let known = &self.params.uncertainty;
        let dynamics_ohm = self.outside(state) * self.resistance_sd(state) * state.slow.total_ohm;
        state.load_noise_ohm2 =
            dynamics_ohm * dynamics_ohm * max(2.0 * DYNAMICS_S / self.dt_s, 1.0);
        state.noise_v2 = if self.is_flat(state) {
            SILENT_V2
        } else {
            known.voltage_sd_v * known.voltage_sd_v + state.load_noise_ohm2 * load_a * load_a
        };
        let unknown_a = known.capacity_sd * state.slow.load_a;
        let drift_a2 = state.slow.offset_sd_a * state.slow.offset_sd_a + unknown_a * unknown_a;
        let soc_per_a = self.soc_per_a * self.steps();
        let times = DRIFT_HORIZON_S / (self.dt_s * self.steps());
        // No more can be unknown than everything.
        let most = max(state.own_variance, UNKNOWN_SD * UNKNOWN_SD);
        state.own_variance =
            min(state.own_variance + drift_a2 * soc_per_a * soc_per_a * times, most);
    }

    fn follow_hysteresis(&self, state: &mut EkfState, moved: Real) {
        let params = &self.params.battery.hysteresis;
        if params.half_gap_v > 0.0 {
            let rise = state.soc() - state.slow.soc_then;
            // A correction moves no charge.
            let share = lag_gain(params.rate_per_soc * min(rise.abs(), moved));
            state.slow.hysteresis += share * (sign(rise) - state.slow.hysteresis);
            state.slow.hysteresis_sd -= share * state.slow.hysteresis_sd;
        }
        state.slow.soc_then = state.soc();
    }

    /// A step without a voltage, or without a current.
    #[cold]
    #[inline(never)]
    pub(super) fn miss(&self, state: &mut EkfState, current_a: Real) -> EkfOutput {
        if current_a.abs() <= self.largest_a {
            state.load_sum_a += current_a.abs();
            let current_a = current_a - state.current_offset_a;
            self.polarise(state, current_a);
            state.rise -= current_a * self.soc_per_a;
        } else {
            // The current that flowed unseen is one current: its effect is no random walk.
            let unseen_a = min(self.params.unseen_current_a, self.largest_a);
            let sd = min(sqrt(state.variance()) + unseen_a * self.soc_per_a, UNKNOWN_SD);
            let shared = state.variance() - state.own_variance;
            state.own_variance = max(state.own_variance, sd * sd - shared);
            let [fast, slow] = state.branch_ohm;
            let sd_v = state.slow.polarisation_sd_v;
            let most_v = unseen_a * state.slow.polarisation_ohm;
            state.slow.polarisation_sd_v = max(sd_v, min(sd_v + unseen_a * (fast + slow), most_v));
        }
        EkfOutput { residual_v: 0.0, rejected: true }
    }

    /// A voltage that contradicts the filter is not used, but makes it less sure.
    pub(super) fn distrust(&self, state: &mut EkfState) {
        let most = UNKNOWN_SD * UNKNOWN_SD;
        if state.own_variance < most {
            state.own_variance = min(state.own_variance + DISTRUST * DISTRUST * self.dt_s, most);
        }
    }
}
