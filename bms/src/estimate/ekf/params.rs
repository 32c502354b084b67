//! Parameters of an [`Ekf`](super::Ekf): the battery, and how well it is known.

use plant_core::battery::MappedBatteryParams;
use plant_core::error::{above, limit, not_negative, positive, ratio};
use plant_core::num::Real;
use plant_core::{ParamError, check};

/// How well battery and sensors are known: standard deviations of what stays wrong, not of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Uncertainty {
    /// Of the open-circuit curve \[V\], above zero.
    pub open_circuit_sd_v: Real,
    /// Of all resistances at 25 °C, as a ratio to them, ≥ 0.
    pub resistance_sd: Real,
    /// Of their activation temperature \[K\], ≥ 0: away from 25 °C resistances are known less.
    pub activation_sd_k: Real,
    /// Of the capacity, as a ratio to it, ≥ 0.
    pub capacity_sd: Real,
    /// Of the current sensor's offset \[A\], ≥ 0.
    pub current_offset_sd_a: Real,
    /// Of the current that flows while nothing is measured, the contactors open \[A\], ≥ 0:
    /// stand-by draw, self-discharge.
    pub standby_sd_a: Real,
    /// Of one voltage sample \[V\], noise and resolution, above zero.
    pub voltage_sd_v: Real,
    /// Of the polarisation at a start that is not rested \[V\], ≥ 0.
    pub polarisation_sd_v: Real,
    /// The change of the state of charge after which the open-circuit curve's error is another
    /// one, above 0 and up to 1.
    pub correlation_soc: Real,
    /// How many times larger the model's error is outside the range in which its parameters were
    /// identified, at least 1.
    pub outside_factor: Real,
}

impl Uncertainty {
    /// What fits a battery identified from drive cycles, with sensors of a production car: 10 mV a
    /// cell, 20 % of the resistance (25 % at 0 °C), 3 % of the capacity, an offset of C/100,
    /// C/3000 in stand-by.
    ///
    /// All are chosen. 10 mV make 1 % of charge where the curve rises by 1 V over the whole charge;
    /// 500 K make 30 % of the resistance at −10 °C; an offset of C/100 makes 1 % of charge in an
    /// hour; C/3000 makes 0.8 % in a day; 5 % of charge are some three points of the curve's table.
    ///
    /// `nominal_v` is the voltage at half charge \[V\], of the cell or the pack.
    #[must_use]
    pub const fn typical(nominal_v: Real, capacity_ah: Real) -> Self {
        let cells = nominal_v / 3.65;
        Self {
            open_circuit_sd_v: 0.010 * cells,
            resistance_sd: 0.2,
            activation_sd_k: 500.0,
            capacity_sd: 0.03,
            current_offset_sd_a: 0.01 * capacity_ah,
            standby_sd_a: capacity_ah / 3000.0,
            voltage_sd_v: 0.003 * cells,
            polarisation_sd_v: 0.010 * cells,
            correlation_soc: 0.05,
            outside_factor: 10.0,
        }
    }

    const fn checked(self) -> Result<Self, ParamError> {
        check!(positive("ekf.uncertainty.open_circuit_sd_v", self.open_circuit_sd_v));
        check!(not_negative("ekf.uncertainty.resistance_sd", self.resistance_sd));
        check!(not_negative("ekf.uncertainty.activation_sd_k", self.activation_sd_k));
        check!(not_negative("ekf.uncertainty.capacity_sd", self.capacity_sd));
        check!(not_negative("ekf.uncertainty.current_offset_sd_a", self.current_offset_sd_a));
        check!(not_negative("ekf.uncertainty.standby_sd_a", self.standby_sd_a));
        check!(positive("ekf.uncertainty.voltage_sd_v", self.voltage_sd_v));
        check!(not_negative("ekf.uncertainty.polarisation_sd_v", self.polarisation_sd_v));
        check!(positive("ekf.uncertainty.correlation_soc", self.correlation_soc));
        check!(ratio("ekf.uncertainty.correlation_soc", self.correlation_soc));
        check!(positive("ekf.uncertainty.outside_factor", self.outside_factor));
        if self.outside_factor < 1.0 {
            return Err(ParamError::OutOfRange("ekf.uncertainty.outside_factor"));
        }
        Ok(self)
    }
}

/// Parameters of an [`Ekf`](super::Ekf): a battery, its sensors, and how well they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EkfParams {
    /// The battery: a cell, or a pack as one. A map without a second branch makes this the filter
    /// of the RC1 model, a constant one that of constant parameters.
    pub battery: MappedBatteryParams,
    /// How well it is known.
    pub uncertainty: Uncertainty,
    /// Where the open-circuit curve rises by less \[V per unit of SOC\] the voltage does not
    /// correct, ≥ 0.
    pub flat_v_per_soc: Real,
    /// The standard deviation of the state of charge below which it counts as known, above 0 and
    /// up to 1.
    pub converged_sd: Real,
    /// The standard deviation of the current that flows while none is measured \[A\], above zero;
    /// infinity: the state of charge is unknown after any gap.
    pub unseen_current_a: Real,
}

impl EkfParams {
    /// A battery with [`Uncertainty::typical`] and the other fields to match.
    ///
    /// `nominal_v` is the voltage at half charge \[V\].
    #[must_use]
    pub const fn typical(battery: MappedBatteryParams, nominal_v: Real) -> Self {
        Self {
            battery,
            uncertainty: Uncertainty::typical(nominal_v, battery.capacity_ah),
            flat_v_per_soc: 0.03 * nominal_v,
            converged_sd: 0.03,
            unseen_current_a: battery.capacity_ah,
        }
    }

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(self.uncertainty.checked());
        check!(not_negative("ekf.flat_v_per_soc", self.flat_v_per_soc));
        check!(above("ekf.converged_sd", self.converged_sd, 0.0));
        check!(ratio("ekf.converged_sd", self.converged_sd));
        check!(limit("ekf.unseen_current_a", self.unseen_current_a));
        Ok(self)
    }
}
