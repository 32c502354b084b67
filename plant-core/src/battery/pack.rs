//! What the coupled plant asks of a battery, whichever model it is.
//!
//! Tests: those of the batteries and of the powertrain.

use super::{Battery, BatteryState, CurrentLimits, MappedBattery, MappedBatteryState};
use crate::error::ParamError;
use crate::num::{LARGEST, Real};
use crate::port::Source;

/// What one step turns into heat, without the factors of [`Pack::loss_factors`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Losses {
    /// In the series resistance.
    pub series: Real,
    /// In the polarisation.
    pub polarisation: Real,
    /// Twice what the implicit step dissipates.
    pub numerical: Real,
}

/// A battery that can sit in the coupled plant: within one step it is a [`Source`].
pub trait Pack: Copy {
    /// What it remembers.
    type State: Copy;

    /// A rested battery at `soc`, in its usual surroundings.
    ///
    /// # Errors
    /// [`ParamError::NotARatio`] outside 0..1.
    fn rested(&self, soc: Real) -> Result<Self::State, ParamError>;
    /// State of charge, 0..1.
    fn soc(state: &Self::State) -> Real;
    /// The sum of the magnitudes of what else a step changes: not sane where an input was not.
    fn magnitude(state: &Self::State) -> Real;
    /// What the terminals offer over the next step, and the open-circuit voltage in it \[V\].
    fn offer(&self, state: &Self::State) -> (Source, Real);
    /// The currents that the battery allows over the next step; towards its ends of charge they
    /// fade.
    fn faded(&self, state: &Self::State) -> CurrentLimits;
    /// The state after one step under `current_a`, whatever the limits say.
    fn next(&self, state: &Self::State, current_a: Real) -> Self::State;
    /// Whether a step under `current_a`, and under `least_a` once the windings have settled, that
    /// leads to `next` keeps every limit.
    fn allows(&self, current_a: Real, least_a: Real, next: &Self::State) -> bool;
    /// Whether the limits allow a current beyond that of the greatest power, where the voltage falls
    /// faster than the current grows.
    fn may_collapse(&self) -> bool;
    /// Books one step under `current_a`, which the limits allow. Returns what was
    /// charged beyond full all the same, or, negative, drawn beyond empty \[C\]: it is lost.
    fn settle(&self, state: &mut Self::State, current_a: Real) -> Real;
    /// What one step from `before` to `after` turned into heat.
    fn losses(&self, before: &Self::State, after: &Self::State, current_a: Real) -> Losses;
    /// What the series and the polarisation losses are to be multiplied by.
    fn loss_factors(&self) -> (Real, Real);
    /// Energy in the capacitance \[J\].
    fn capacitive_j(&self, state: &Self::State) -> Real;
    /// The drop of the electrochemical energy between two states \[J\].
    fn discharged_energy_j(&self, from: &Self::State, to: &Self::State) -> Real;
    /// Lets slow parameters follow, after a step.
    fn refresh(&self, state: &mut Self::State);
    /// Takes a measured temperature \[°C\]; says whether the model knows one and this is possible.
    fn set_temperature(&self, state: &mut Self::State, temperature_c: Real) -> bool;
    /// Whether state of charge or temperature lie outside what the parameters were identified for.
    fn is_outside(state: &Self::State) -> bool;
}

impl Pack for Battery {
    type State = BatteryState;

    fn rested(&self, soc: Real) -> Result<BatteryState, ParamError> {
        BatteryState::rested(soc)
    }

    #[inline(always)]
    fn soc(state: &BatteryState) -> Real {
        state.soc.get()
    }

    #[inline(always)]
    fn magnitude(state: &BatteryState) -> Real {
        state.rc.voltage_v.get().abs()
    }

    #[inline(always)]
    fn offer(&self, state: &BatteryState) -> (Source, Real) {
        Self::offer(self, state)
    }

    #[inline(always)]
    fn faded(&self, state: &BatteryState) -> CurrentLimits {
        Self::faded(self, state)
    }

    #[inline(always)]
    fn next(&self, state: &BatteryState, current_a: Real) -> BatteryState {
        Self::next(self, state, current_a)
    }

    #[inline(always)]
    fn allows(&self, current_a: Real, least_a: Real, next: &BatteryState) -> bool {
        Self::allows(self, current_a, least_a, next)
    }

    #[inline(always)]
    fn may_collapse(&self) -> bool {
        self.may_collapse
    }

    #[inline(always)]
    fn settle(&self, state: &mut BatteryState, current_a: Real) -> Real {
        Self::settle(self, state, current_a)
    }

    #[inline(always)]
    fn losses(&self, before: &BatteryState, after: &BatteryState, current_a: Real) -> Losses {
        let rc_v = after.rc.voltage_v.get();
        let increment_v = rc_v - before.rc.voltage_v.get();
        Losses {
            series: current_a * current_a,
            polarisation: rc_v * rc_v,
            numerical: self.rc.capacitance_per_h_s * increment_v * increment_v,
        }
    }

    #[inline(always)]
    fn loss_factors(&self) -> (Real, Real) {
        (self.series_resistance_ohm, self.rc.conductance_s)
    }

    fn capacitive_j(&self, state: &BatteryState) -> Real {
        let rc_v = state.rc.voltage_v.get();
        0.5 * self.rc.capacitance_f * rc_v * rc_v
    }

    fn discharged_energy_j(&self, from: &BatteryState, to: &BatteryState) -> Real {
        Self::discharged_energy_j(self, from, to)
    }

    #[inline(always)]
    fn refresh(&self, _state: &mut BatteryState) {}

    fn set_temperature(&self, _state: &mut BatteryState, _temperature_c: Real) -> bool {
        false
    }

    #[inline(always)]
    fn is_outside(_state: &BatteryState) -> bool {
        false
    }
}

impl Pack for MappedBattery {
    type State = MappedBatteryState;

    fn rested(&self, soc: Real) -> Result<MappedBatteryState, ParamError> {
        Self::rested(self, soc)
    }

    #[inline(always)]
    fn soc(state: &MappedBatteryState) -> Real {
        state.soc.get()
    }

    #[inline(always)]
    fn magnitude(state: &MappedBatteryState) -> Real {
        state.magnitude()
    }

    #[inline(always)]
    fn offer(&self, state: &MappedBatteryState) -> (Source, Real) {
        Self::offer(self, state)
    }

    #[inline(always)]
    fn faded(&self, state: &MappedBatteryState) -> CurrentLimits {
        Self::faded(self, state)
    }

    #[inline(always)]
    fn next(&self, state: &MappedBatteryState, current_a: Real) -> MappedBatteryState {
        Self::next(self, state, current_a)
    }

    #[inline(always)]
    fn allows(&self, current_a: Real, least_a: Real, next: &MappedBatteryState) -> bool {
        Self::allows(self, current_a, least_a, next)
    }

    // Its resistance depends on temperature and state of charge.
    #[inline(always)]
    fn may_collapse(&self) -> bool {
        self.params.discharge_limit_a < LARGEST
    }

    #[inline(always)]
    fn settle(&self, state: &mut MappedBatteryState, current_a: Real) -> Real {
        Self::settle(self, state, current_a)
    }

    /// The branches take `v·I`, whether they store it for a while or not; so does hysteresis.
    #[inline(always)]
    fn losses(
        &self,
        before: &MappedBatteryState,
        after: &MappedBatteryState,
        current_a: Real,
    ) -> Losses {
        let [fast_v, slow_v] = after.polarisation_v;
        Losses {
            series: before.now.series_ohm * current_a * current_a,
            polarisation: (fast_v.get() + slow_v.get() - self.hysteresis_v(before)) * current_a,
            numerical: 0.0,
        }
    }

    #[inline(always)]
    fn loss_factors(&self) -> (Real, Real) {
        (1.0, 1.0)
    }

    fn capacitive_j(&self, _state: &MappedBatteryState) -> Real {
        0.0
    }

    fn discharged_energy_j(&self, from: &MappedBatteryState, to: &MappedBatteryState) -> Real {
        let mean_v = self.params.open_circuit.mean(from.soc.get(), to.soc.get());
        self.capacity_c * mean_v * from.soc.since(to.soc)
    }

    #[inline(always)]
    fn refresh(&self, state: &mut MappedBatteryState) {
        Self::refresh(self, state);
    }

    fn set_temperature(&self, state: &mut MappedBatteryState, temperature_c: Real) -> bool {
        Self::set_temperature(self, state, temperature_c)
    }

    #[inline(always)]
    fn is_outside(state: &MappedBatteryState) -> bool {
        state.outside
    }
}
