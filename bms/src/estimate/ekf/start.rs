//! How an [`Ekf`] starts.

use plant_core::error::ratio;
use plant_core::num::{Accum, Real, max, min};
use plant_core::{ParamError, check};

use super::correction::Correction;
use super::drift::Drift;
use super::gap::Gap;
use super::reaction::Reaction;
use super::size::Size;
use super::slope::Slope;
use super::slow::{Slow, TEMPERATURES_C};
use super::trust::Trust;
use super::{CONSISTENT, Ekf, EkfState, UNKNOWN_SD};

/// What may have flowed before a start that is not rested, as a share of the capacity per hour.
/// Chosen: a brisk drive.
const BEFORE_PER_H: Real = 1.0 / 3.0;

/// A state of charge that is told is not known better than this until the voltage has agreed: a record
/// may be the last but one, the charger another car's. Chosen: what a short trip takes, 8 %, lies
/// within three of it.
const TOLD_SD: Real = 0.027;
/// The voltage would show it where it is off by so many standard deviations of the curve. Chosen: with
/// three, σ on measured trips that start right is 1.4 times as large, and stale starts gain little.
const SHOWN_SDS: Real = 1.5;
/// Nothing is known better than this. Chosen: below the resolution of any estimate; the variance stays
/// above zero.
const LEAST_SD: Real = 3e-4;

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
        let told_sd =
            if self.would_show(soc) { max(soc_sd, LEAST_SD) } else { max(soc_sd, TOLD_SD) };
        Ok(EkfState {
            soc_before: Accum::new(soc),
            rise: 0.0,
            polarisation_v: [0.0; 2],
            error_v: 0.0,
            own_variance: told_sd * told_sd,
            shared_per_v: 0.0,
            error_variance_v2: error_sd_v * error_sd_v,
            current_offset_a: 0.0,
            soc_per_a: self.soc_per_a,
            series_ohm: 0.0,
            branch_ohm: [0.0; 2],
            open_circuit_v: 0.0,
            tangent_v: 0.0,
            slope_v: 0.0,
            noise_v2: known.voltage_sd_v * known.voltage_sd_v,
            load_noise_ohm2: 0.0,
            current_sum_a: 0.0,
            residual_sum_v: 0.0,
            last_a: 0.0,
            corrected: 0.0,
            steps_left: 0,
            slow: Slow {
                load_a: -1.0,
                error_sd_v,
                residual_v: 0.0,
                total_ohm: 0.0,
                polarisation_ohm: 0.0,
                dynamics_ohm: 0.0,
                polarisation_sd_v: known.polarisation_sd_v,
                before_sd_a: BEFORE_PER_H * self.params.battery.capacity_ah,
                hysteresis: 0.0,
                hysteresis_sd: 1.0,
                soc_then: soc,
                offset_sd_a: known.current_offset_sd_a,
                temperature_c,
                temperature_missing: false,
                temperature_factors: [0, 1, 2].map(|turn| {
                    let nearest_c = self.params.battery.identified.nearest_c(temperature_c);
                    self.temperature_factor(turn, nearest_c)
                }),
                turn: 0,
                slope: Slope::NONE,
                resistance_factor: 1.0,
                resistance_sd: known.resistance_sd,
                capacity_sd: known.capacity_sd,
                drift: Drift::NONE,
                gap: Gap::NONE,
                trust: Trust::NONE,
                reaction: Reaction::NONE,
                size: Size::NONE,
            },
        })
    }

    /// Whether the voltage would show a state of charge that is far from the one told, to either side.
    fn would_show(&self, soc: Real) -> bool {
        let far = CONSISTENT * TOLD_SD;
        let (open_circuit_v, _) = self.open_circuit(soc);
        let least_v = SHOWN_SDS * self.params.uncertainty.open_circuit_sd_v;
        let above_v = self.open_circuit(min(soc + far, 1.0)).0 - open_circuit_v;
        let below_v = open_circuit_v - self.open_circuit(max(soc - far, 0.0)).0;
        (above_v >= least_v || soc + far > 1.0) && (below_v >= least_v || soc - far < 0.0)
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
        state.slow.before_sd_a = 0.0;
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
}
