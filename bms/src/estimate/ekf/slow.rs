//! What an [`Ekf`] does at a slower rate: resistances over state of charge and temperature, the size
//! of the model's error, the sensor's offset.

use plant_core::battery::{REFERENCE_C, temperature_factor};
use plant_core::num::{Real, clamp, lag_gain, max, min, sign, sqrt};

use super::drift::Drift;
use super::gap::Gap;
use super::reaction::Reaction;
use super::size::Size;
use super::slope::Slope;
use super::trust::{LOAD_MEMORY_S, Trust};
use super::{CONSISTENT, Ekf, EkfInput, EkfState};

/// The model's faster errors are correlated over this time \[s\]. Chosen: a fast branch's time
/// constant.
const DYNAMICS_S: Real = 10.0;
/// The offset of the current sensor is learnt over this time with open contactors \[s\] …
/// Chosen: of one reading a second an eighth of the noise is left.
const OFFSET_MEMORY_S: Real = 30.0;
/// … down to this share of its standard deviation. Chosen: a tenth of C/100 makes 0.1 % of charge in
/// an hour, much less than the curve leaves open.
const OFFSET_LEARNT: Real = 0.1;
/// The mean residual follows over this time \[s\]. Chosen: that of [`DYNAMICS_S`].
const RESIDUAL_S: Real = 10.0;
/// The noise of a voltage that says nothing \[V²\]. Chosen: it leaves a gain of nothing for any
/// pack, `H²·d_s/r < 1e-4` up to 1000 V per unit of SOC.
const SILENT_V2: Real = 1e9;
/// The model's error has grown to all that it is outside the identified range after so much charge …
/// Chosen: the change after which the curve's error is another one, typically.
const FAR_SOC: Real = 0.05;
/// … or so many kelvins. Chosen: some 15 % of the resistance in the cold.
const FAR_K: Real = 5.0;
/// 0 °C in kelvin.
const KELVIN: Real = 273.15;
/// Temperatures outside are no measurement \[°C\]: those that a battery's parameters may have.
pub(super) const TEMPERATURES_C: core::ops::RangeInclusive<Real> = -100.0..=200.0;

/// What changes slowly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Slow {
    /// Mean magnitude of the current \[A\]; negative before the first step.
    pub(super) load_a: Real,
    /// The standard deviation of the model's error \[V\].
    pub(super) error_sd_v: Real,
    /// Mean residual \[V\].
    pub(super) residual_v: Real,
    /// All that a steady current sees \[Ω\], and the branches' part of it.
    pub(super) total_ohm: Real,
    pub(super) polarisation_ohm: Real,
    /// What is not known of the former \[Ω\].
    pub(super) dynamics_ohm: Real,
    /// What is left of an unknown polarisation \[V\].
    pub(super) polarisation_sd_v: Real,
    /// The current before the start whose polarisation is left \[A\].
    pub(super) before_sd_a: Real,
    pub(super) hysteresis: Real,
    /// How little of the hysteresis is known: 1 at the start.
    pub(super) hysteresis_sd: Real,
    pub(super) soc_then: Real,
    pub(super) offset_sd_a: Real,
    pub(super) temperature_c: Real,
    pub(super) temperature_missing: bool,
    /// What the temperature makes of the resistances, the series one first, and which was last asked.
    pub(super) temperature_factors: [Real; 3],
    pub(super) turn: usize,
    /// Every resistance of the model is larger by this factor; what is not known of them, and of the
    /// capacity, as ratios.
    pub(super) resistance_factor: Real,
    pub(super) resistance_sd: Real,
    pub(super) capacity_sd: Real,
    pub(super) slope: Slope,
    pub(super) drift: Drift,
    pub(super) gap: Gap,
    pub(super) trust: Trust,
    pub(super) reaction: Reaction,
    pub(super) size: Size,
}

impl Ekf {
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
        let residual_v = state.residual_sum_v / steps;
        let flowing_a = state.current_sum_a / steps;
        let mean_a = if state.slow.load_a < 0.0 {
            // Before the first step: as if this load had been on for long.
            state.slow.load_a = if seen { input.current_a.abs() } else { 0.0 };
            state.slow.load_a
        } else {
            let mean_a = flowing_a.abs();
            state.slow.load_a += lag_gain(refresh_s / LOAD_MEMORY_S) * (mean_a - state.slow.load_a);
            let gain = lag_gain(refresh_s / RESIDUAL_S);
            state.slow.residual_v += gain * (residual_v - state.slow.residual_v);
            let map = &self.params.battery;
            let memory_s =
                max(map.polarisation.time_constant_s, map.second_polarisation.time_constant_s);
            let left = 1.0 / (1.0 + refresh_s / memory_s);
            state.slow.polarisation_sd_v *= left;
            state.slow.before_sd_a *= left;
            mean_a
        };
        Self::correct_drift(state);
        self.follow_reaction(state, residual_v, flowing_a);
        self.follow_trust(state, residual_v, mean_a);
        state.slow.gap.refresh(state.residual_sum_v);
        state.current_sum_a = 0.0;
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
        let moved = mean_a * state.soc_per_a * steps;
        self.follow_size(state, max(mean_a, state.slow.load_a), moved);
        self.follow_hysteresis(state, moved);
        // What flows unseen moves the state of charge too.
        let unseen = state.slow.offset_sd_a * state.soc_per_a * steps;
        self.follow_error(state, moved + unseen);
        state.slow.slope.moved += moved;
        self.follow_curve(state);
        if self.is_flat(state) && state.slow.residual_v.abs() > CONSISTENT * state.slow.error_sd_v {
            self.leave_flat(state, residual_v);
        }
        self.follow_noise(state, max(mean_a, state.slow.load_a));
        Self::mark_trust(state);
    }

    #[allow(clippy::cast_precision_loss, clippy::cast_lossless, reason = "a length of time")]
    pub(super) const fn steps(&self) -> Real {
        self.refresh_steps as Real
    }

    /// Resistances; the model's error after the state of charge has moved by `moved`, without its
    /// sign.
    pub(super) fn follow_error(&self, state: &mut EkfState, moved: Real) {
        let (outside, resistance_sd) = (self.outside(state), self.resistance_sd(state));
        self.follow_temperature(state);
        let map = &self.params.battery;
        let soc = clamp(state.soc(), map.identified.soc_min, map.identified.soc_max);
        let slow = &mut state.slow;
        let [at_series, at_fast, at_slower] =
            slow.temperature_factors.map(|factor| slow.resistance_factor * factor);
        let fast = at_fast * map.polarisation.resistance_ohm.at(soc);
        let slower = at_slower * map.second_polarisation.resistance_ohm.at(soc);
        state.series_ohm = at_series * map.series.resistance_ohm.at(soc);
        state.branch_ohm = [self.gains[0] * fast, self.gains[1] * slower];
        slow.polarisation_ohm = fast + slower;
        slow.total_ohm = state.series_ohm + slow.polarisation_ohm;
        slow.dynamics_ohm = outside * resistance_sd * slow.total_ohm;

        let known = &self.params.uncertainty;
        let hysteresis_v = map.hysteresis.half_gap_v * slow.hysteresis_sd;
        let load_v = resistance_sd * slow.total_ohm * max(slow.load_a, 0.0);
        let before_v = slow.before_sd_a * slow.polarisation_ohm;
        let squares = known.open_circuit_sd_v * known.open_circuit_sd_v
            + load_v * load_v
            + slow.polarisation_sd_v * slow.polarisation_sd_v
            + before_v * before_v
            + known.voltage_sd_v * known.voltage_sd_v
            + hysteresis_v * hysteresis_v;
        let before_v2 = slow.error_sd_v * slow.error_sd_v;
        slow.error_sd_v = outside * sqrt(slow.size.factor2 * squares);
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
        state.slow.drift.of_error_v *= keep;
    }

    /// What the temperature makes of one of the resistances, in turns: it does not move much in three
    /// seconds, and an exponential takes long.
    fn follow_temperature(&self, state: &mut EkfState) {
        let slow = &mut state.slow;
        let celsius = self.params.battery.identified.nearest_c(slow.temperature_c);
        slow.turn = if slow.turn < 2 { slow.turn + 1 } else { 0 };
        slow.temperature_factors[slow.turn] = self.temperature_factor(slow.turn, celsius);
    }

    /// How many times larger one of the resistances is at a temperature than at 25 °C.
    pub(super) fn temperature_factor(&self, turn: usize, celsius: Real) -> Real {
        let map = &self.params.battery;
        let activation_k = match turn {
            0 => map.series.activation_k,
            1 => map.polarisation.activation_k,
            _ => map.second_polarisation.activation_k,
        };
        temperature_factor(activation_k, celsius)
    }

    /// How many times larger the model's error is here: outside the identified range by more than
    /// what is not known of the state of charge. At its edge it is what it is inside.
    fn outside(&self, state: &EkfState) -> Real {
        let range = &self.params.battery.identified;
        let (soc, sd) = (state.soc(), sqrt(state.variance()));
        let celsius = state.slow.temperature_c;
        let inside = clamp(soc, range.soc_min, range.soc_max);
        let away = max((soc - inside).abs() - sd, 0.0) / FAR_SOC
            + (celsius - range.nearest_c(celsius)).abs() / FAR_K;
        1.0 + (self.params.uncertainty.outside_factor - 1.0) * min(away, 1.0)
    }

    /// The standard deviation of the resistances here, as a ratio to them.
    fn resistance_sd(&self, state: &EkfState) -> Real {
        let known = &self.params.uncertainty;
        let celsius = state.slow.temperature_c;
        let colder_per_k = (REFERENCE_C - celsius) / ((KELVIN + celsius) * (KELVIN + REFERENCE_C));
        let by_activation = known.activation_sd_k * colder_per_k;
        let resistance_sd = state.slow.resistance_sd;
        sqrt(resistance_sd * resistance_sd + by_activation * by_activation)
    }

    /// What a step counts as noise, and the drift since the last refresh.
    fn follow_noise(&self, state: &mut EkfState, load_a: Real) {
        let known = &self.params.uncertainty;
        let dynamics_ohm = state.slow.dynamics_ohm;
        state.load_noise_ohm2 =
            dynamics_ohm * dynamics_ohm * max(2.0 * DYNAMICS_S / self.dt_s, 1.0);
        state.noise_v2 = if self.is_flat(state) {
            SILENT_V2
        } else {
            known.voltage_sd_v * known.voltage_sd_v + state.load_noise_ohm2 * load_a * load_a
        };
        let unknown_a = state.slow.capacity_sd * state.slow.load_a;
        let offset_a = state.slow.offset_sd_a;
        self.add_drift(state, sqrt(offset_a * offset_a + unknown_a * unknown_a));
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
}
