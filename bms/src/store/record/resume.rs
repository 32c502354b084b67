//! From estimators to a record, and back.

use plant_core::{ParamError, Real};

use super::Record;
use crate::Health;
use crate::estimate::coulomb::{CoulombCounter, CoulombState};
use crate::estimate::ekf::{Ekf, EkfMemory, EkfState};

impl Record {
    /// Of what the filter remembers and what is known of the battery's health; throughput, time and
    /// what follows are left at 0 and none.
    #[must_use]
    pub const fn of(memory: EkfMemory, health: Health) -> Self {
        Self {
            soc: memory.soc,
            soc_sd: memory.soc_sd,
            capacity_ah: health.capacity_ah,
            capacity_sd_ah: health.capacity_sd_ah,
            resistance_factor: health.resistance_factor,
            resistance_factor_sd: health.resistance_factor_sd,
            current_offset_a: memory.current_offset_a,
            current_offset_sd_a: memory.current_offset_sd_a,
            throughput_ah: 0.0,
            written_at_s: None,
            polarisation: memory.polarisation,
            resistor_heat_j: 0.0,
            lock_out_cause: 0,
            log_sequence: 0,
        }
    }

    /// What the filter remembers.
    #[must_use]
    pub const fn memory(&self) -> EkfMemory {
        EkfMemory {
            soc: self.soc,
            soc_sd: self.soc_sd,
            polarisation: self.polarisation,
            current_offset_a: self.current_offset_a,
            current_offset_sd_a: self.current_offset_sd_a,
        }
    }

    /// What was known of the battery's health.
    #[must_use]
    pub const fn health(&self) -> Health {
        Health {
            capacity_ah: self.capacity_ah,
            capacity_sd_ah: self.capacity_sd_ah,
            resistance_factor: self.resistance_factor,
            resistance_factor_sd: self.resistance_factor_sd,
        }
    }

    /// How old it is at `now_s` on the product's clock \[s\]; `None` where either time is not known
    /// or the clock has gone back.
    #[must_use]
    pub fn age_s(&self, now_s: Option<u32>) -> Option<Real> {
        let seconds = now_s?.checked_sub(self.written_at_s?)?;
        #[allow(clippy::cast_precision_loss, reason = "seven digits are enough of a time")]
        Some(seconds as Real)
    }

    /// The filter as it goes on from here, aged by the time off: the branches have forgotten, and
    /// what flowed in stand-by is not known. It takes over the health.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] for a temperature outside −100..200 °C; a field that is refused.
    pub fn filter(
        &self,
        filter: &Ekf,
        now_s: Option<u32>,
        temperature_c: Real,
    ) -> Result<EkfState, ParamError> {
        let mut state = filter.resume(self.memory(), self.age_s(now_s), temperature_c)?;
        filter.adopt(&mut state, &self.health());
        Ok(state)
    }

    /// The counter, likewise; `standby_sd_a` \[A\] is the stand-by current's standard deviation.
    #[must_use]
    pub fn counter(
        &self,
        counter: &CoulombCounter,
        now_s: Option<u32>,
        standby_sd_a: Real,
    ) -> CoulombState {
        let mut state = CoulombState::known(self.soc, self.soc_sd);
        counter.adopt(&mut state, &self.health());
        counter.pause(&mut state, self.age_s(now_s), standby_sd_a);
        state
    }
}
