//! What an [`Ekf`] remembers over a time in which it does not run.

use plant_core::error::{finite, not_negative};
use plant_core::num::{LARGEST_PARAM, Real, clamp, exp, max, min, sane};
use plant_core::{ParamError, check};

use crate::Health;

use super::trust::LOAD_MEMORY_S;
use super::{Ekf, EkfState, UNKNOWN_SD};

/// A time that nobody knows counts as this long for what may have flowed \[s\]. Chosen: a month.
const UNKNOWN_S: Real = 2.6e6;
/// What was learnt of the health leaves at least this share of what was declared open.
/// Chosen: one factor for all resistances says nothing of the map's shape.
const LEARNT: Real = 0.5;

/// What is worth keeping of an [`EkfState`] where the power goes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct EkfMemory {
    /// State of charge, 0..1.
    pub soc: Real,
    /// Its standard deviation, 0..1.
    pub soc_sd: Real,
    /// What the last minutes left in the battery; `None` where nobody knows.
    pub polarisation: Option<Polarisation>,
    /// What the current sensor shows without a current \[A\].
    pub current_offset_a: Real,
    /// Its standard deviation \[A\], ≥ 0.
    pub current_offset_sd_a: Real,
}

impl EkfMemory {
    /// Nothing: half full, as uncertain as a state of charge can be.
    pub const UNKNOWN: Self = Self {
        soc: 0.5,
        soc_sd: UNKNOWN_SD,
        polarisation: None,
        current_offset_a: 0.0,
        current_offset_sd_a: 0.0,
    };
}

/// What the last minutes left in the battery.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Polarisation {
    /// Voltage across the RC branches, the faster first, positive when discharging \[V\].
    pub branches_v: [Real; 2],
    /// Mean magnitude of the current over the last minutes \[A\], ≥ 0.
    pub load_a: Real,
    /// Where between the curves of discharge (−1) and charge (1) the open-circuit voltage lies.
    pub hysteresis: Real,
}

impl Polarisation {
    /// Of a battery that has rested.
    pub const NONE: Self = Self { branches_v: [0.0; 2], load_a: 0.0, hysteresis: 0.0 };
}

impl Ekf {
    /// What is worth keeping where the power goes.
    #[must_use]
    pub fn remember(&self, state: &EkfState) -> EkfMemory {
        let estimate = self.estimate(state);
        EkfMemory {
            soc: estimate.soc,
            soc_sd: min(estimate.soc_sd, 1.0),
            polarisation: Some(Polarisation {
                branches_v: estimate.polarisation_v,
                load_a: max(state.slow.load_a, 0.0),
                hysteresis: estimate.hysteresis,
            }),
            current_offset_a: state.current_offset_a,
            current_offset_sd_a: state.slow.offset_sd_a,
        }
    }

    /// Starts from what was remembered `elapsed_s` ago \[s\]; nothing where nobody knows.
    ///
    /// # Errors
    /// [`ParamError`] names what is out of range.
    pub fn resume(
        &self,
        memory: EkfMemory,
        elapsed_s: Option<Real>,
        temperature_c: Real,
    ) -> Result<EkfState, ParamError> {
        let mut state = self.start(memory.soc, memory.soc_sd, temperature_c)?;
        state.current_offset_a = check!(finite("current_offset_a", memory.current_offset_a));
        let slow = &mut state.slow;
        slow.offset_sd_a = check!(not_negative("current_offset_sd_a", memory.current_offset_sd_a));
        if let Some(Polarisation { branches_v, load_a, hysteresis }) = memory.polarisation {
            let [fast_v, slow_v] = branches_v;
            check!(finite("polarisation.branches_v", fast_v + slow_v));
            check!(finite("polarisation.hysteresis", hysteresis));
            state.polarisation_v = branches_v;
            slow.load_a = check!(not_negative("polarisation.load_a", load_a));
            slow.hysteresis = clamp(hysteresis, -1.0, 1.0);
            slow.before_sd_a = 0.0;
        }
        self.pause(&mut state, elapsed_s);
        Ok(state)
    }

    /// Takes over what was learnt of the battery's health: capacity and resistance, each where it is
    /// known better than was declared, and never as surer than half of that: the shape of the map
    /// stays what it is. What is not finite or not above zero is not taken.
    pub fn adopt(&self, state: &mut EkfState, health: &Health) {
        let known = &self.params.uncertainty;
        let (factor, factor_sd) = (health.resistance_factor, health.resistance_factor_sd);
        if sane(factor) && factor > 0.0 && factor_sd >= 0.0 {
            let sd = factor_sd / factor;
            if sd <= known.resistance_sd {
                state.slow.resistance_factor = factor;
                state.slow.resistance_sd = max(sd, LEARNT * known.resistance_sd);
            }
        }
        let (capacity_ah, capacity_sd_ah) = (health.capacity_ah, health.capacity_sd_ah);
        if sane(capacity_ah) && capacity_ah > 0.0 && capacity_sd_ah >= 0.0 {
            let sd = capacity_sd_ah / capacity_ah;
            if sd <= known.capacity_sd {
                state.soc_per_a = self.soc_per_a * (self.params.battery.capacity_ah / capacity_ah);
                state.slow.capacity_sd = max(sd, LEARNT * known.capacity_sd);
            }
        }
    }

    /// Says that the battery stood for `elapsed_s` \[s\] while the filter did not run: the branches
    /// forget, the stand-by current is not known. What is no time, or `None`, is an unknown one:
    /// anything may be left of the branches, and a month's stand-by may have flowed.
    pub fn pause(&self, state: &mut EkfState, elapsed_s: Option<Real>) {
        let known = elapsed_s.filter(|seconds| (0.0..=LARGEST_PARAM).contains(seconds));
        let map = &self.params.battery;
        let times_s = [map.polarisation.time_constant_s, map.second_polarisation.time_constant_s];
        let longest_s = max(times_s[0], times_s[1]);
        let slow = &mut state.slow;
        if let Some(seconds) = known {
            for (branch_v, time_s) in state.polarisation_v.iter_mut().zip(times_s) {
                *branch_v *= exp(-seconds / time_s);
            }
            let left = exp(-seconds / longest_s);
            slow.polarisation_sd_v *= left;
            slow.before_sd_a *= left;
            slow.load_a *= exp(-seconds / LOAD_MEMORY_S);
        } else {
            // Half of it, give or take.
            let mut half_v = 0.0;
            for branch_v in &mut state.polarisation_v {
                *branch_v *= 0.5;
                half_v += branch_v.abs();
            }
            slow.polarisation_sd_v = max(slow.polarisation_sd_v, half_v);
        }
        slow.residual_v = 0.0;
        state.last_a = 0.0;
        let sd_per_s = self.params.uncertainty.standby_sd_a / (3600.0 * map.capacity_ah);
        let sd = sd_per_s * known.unwrap_or(UNKNOWN_S);
        Self::widen(state, min(sd, 1.0) * min(sd, 1.0));
    }
}
