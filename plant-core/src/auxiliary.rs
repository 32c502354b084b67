//! Auxiliary load: what else draws from the battery.
//!
//! `I = P/V + V/R`: a constant power, a resistor, or both. The constant power is drawn as a current
//! at the last known voltage and booked as delivered; the resistor is part of the step's equation.
//! The resistor is the load of the reference system's trip \[EPowertrain2025, Table 5.6\]; the
//! constant power with its cut-out is ours.
//!
//! Tests: below; properties `finite`, `ledger`, `limits`, `passivity`, `refusal`; case "gearbox,
//! wheel, auxiliary load".

use crate::error::{ParamError, check, limit, not_negative};
use crate::model::impl_model;
use crate::num::{Real, max, sane};

/// Once cut out, the constant power comes back in the coupled plant where the voltage has been above
/// this multiple of the cut-out voltage for [`REARM_S`].
pub const REARM_RATIO: Real = 1.02;
/// See [`REARM_RATIO`] \[s\].
pub const REARM_S: Real = 1.0;

/// Parameters of the auxiliary loads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct AuxiliaryParams {
    /// Constant power \[W\], ≥ 0.
    pub power_w: Real,
    /// Resistor across the battery \[Ω\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub resistance_ohm: Real,
    /// Below this voltage the constant power is cut out \[V\], above zero.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub cut_out_v: Real,
}

impl Default for AuxiliaryParams {
    fn default() -> Self {
        Self::NONE
    }
}

impl AuxiliaryParams {
    /// No load.
    pub const NONE: Self = Self { power_w: 0.0, resistance_ohm: Real::INFINITY, cut_out_v: 1.0 };
}

/// A load of constant power, a resistor, or both.
///
/// ```
/// use plant_core::auxiliary::{Auxiliary, AuxiliaryInput, AuxiliaryParams};
/// use plant_core::must;
///
/// const HEATER: Auxiliary =
///     must!(Auxiliary::new(AuxiliaryParams { power_w: 1000.0, ..AuxiliaryParams::NONE }));
///
/// let out = HEATER.step(&mut (), AuxiliaryInput { voltage_v: 400.0, power_w: 0.0 });
/// assert_eq!(out.current_a, 2.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Auxiliary {
    power_w: Real,
    pub(crate) conductance_s: Real,
    cut_out_v: Real,
}

/// Input of an [`Auxiliary`] that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AuxiliaryInput {
    /// Voltage across it \[V\].
    pub voltage_v: Real,
    /// Power asked for beside the parameter \[W\], ≥ 0.
    pub power_w: Real,
}

/// Output of an [`Auxiliary`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AuxiliaryOutput {
    /// Current drawn \[A\].
    pub current_a: Real,
    /// Power drawn \[W\].
    pub power_w: Real,
    /// The constant power is cut out.
    pub cut_out: bool,
    /// An input was not finite, absurd, or a negative power: it draws nothing.
    pub rejected: bool,
}

impl Auxiliary {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: AuxiliaryParams) -> Result<Self, ParamError> {
        Ok(Self {
            power_w: check!(not_negative("auxiliary.power_w", params.power_w)),
            conductance_s: 1.0 / check!(limit("auxiliary.resistance_ohm", params.resistance_ohm)),
            cut_out_v: check!(limit("auxiliary.cut_out_v", params.cut_out_v)),
        })
    }

    /// Whether it draws nothing of its own.
    #[inline]
    pub(crate) const fn is_none(&self) -> bool {
        self.power_w == 0.0 && self.conductance_s == 0.0
    }

    /// The current of the constant power, `asked_w` ≥ 0 more than the parameter, at `voltage_v`.
    #[inline]
    #[must_use]
    pub const fn constant_power_a(&self, asked_w: Real, voltage_v: Real) -> Real {
        if voltage_v >= self.cut_out_v { (self.power_w + asked_w) / voltage_v } else { 0.0 }
    }

    /// How long the constant power still stays cut out after a step of `dt_s` that ended at
    /// `voltage_v`, given how long before it \[s\]; 0 where it is not.
    ///
    /// A load that comes back as soon as its own voltage drop is gone would switch in every step.
    #[inline]
    #[must_use]
    pub const fn cut_out_s(&self, before_s: Real, voltage_v: Real, dt_s: Real) -> Real {
        if before_s > 0.0 {
            let back_v = REARM_RATIO * self.cut_out_v;
            if voltage_v < back_v { REARM_S } else { max(before_s - dt_s, 0.0) }
        } else if voltage_v < self.cut_out_v {
            REARM_S
        } else {
            0.0
        }
    }

    /// One instant of the load on its own.
    #[inline]
    #[must_use]
    pub fn step(&self, _state: &mut (), input: AuxiliaryInput) -> AuxiliaryOutput {
        let rejected = !(sane(input.voltage_v) && sane(input.power_w) && input.power_w >= 0.0);
        let (voltage_v, asked_w) =
            if rejected { (0.0, 0.0) } else { (input.voltage_v, input.power_w) };
        let constant_a = self.constant_power_a(asked_w, voltage_v);
        let current_a = constant_a + self.conductance_s * voltage_v;
        AuxiliaryOutput {
            current_a,
            power_w: current_a * voltage_v,
            cut_out: constant_a == 0.0 && self.power_w + asked_w > 0.0,
            rejected,
        }
    }
}

impl_model!(Auxiliary, (), AuxiliaryInput, AuxiliaryOutput);

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: AuxiliaryParams =
        AuxiliaryParams { power_w: 500.0, resistance_ohm: 100.0, cut_out_v: 250.0 };

    fn at(params: AuxiliaryParams, voltage_v: Real, power_w: Real) -> AuxiliaryOutput {
        Auxiliary::new(params).unwrap().step(&mut (), AuxiliaryInput { voltage_v, power_w })
    }

    #[test]
    fn draws_power_and_resistor_together_until_it_cuts_out() {
        let out = at(BOTH, 400.0, 300.0);
        assert!((out.power_w - (800.0 + 1600.0)).abs() < 0.01 && !out.cut_out);
        let out = at(BOTH, 249.0, 300.0);
        assert!((out.current_a - 2.49).abs() < 1e-4 && out.cut_out);
        assert_eq!(at(AuxiliaryParams::NONE, 400.0, 0.0).current_a, 0.0);
        // Cut out is what would be drawn otherwise.
        assert!(at(BOTH, 249.0, 500.0).cut_out && !at(AuxiliaryParams::NONE, 249.0, 0.0).cut_out);
        assert!(
            at(AuxiliaryParams { cut_out_v: 250.0, ..AuxiliaryParams::NONE }, 249.0, 1.0).cut_out
        );
    }

    #[test]
    fn never_feeds_the_battery() {
        let out = at(AuxiliaryParams::NONE, 400.0, -100.0);
        assert!(out.rejected && out.current_a == 0.0);
    }

    #[test]
    fn bad_input_draws_nothing() {
        for (v, p) in [(Real::NAN, 0.0), (400.0, Real::INFINITY), (1e38, 0.0)] {
            let out = at(BOTH, v, p);
            assert!(out.rejected && out.current_a == 0.0 && out.power_w == 0.0);
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |p| Auxiliary::new(p).unwrap_err();
        for bad in [-1.0, Real::NAN] {
            assert_eq!(
                refused(AuxiliaryParams { power_w: bad, ..BOTH }),
                ParamError::Negative("auxiliary.power_w")
            );
            assert_eq!(
                refused(AuxiliaryParams { resistance_ohm: bad, ..BOTH }),
                ParamError::NotALimit("auxiliary.resistance_ohm")
            );
            assert_eq!(
                refused(AuxiliaryParams { cut_out_v: bad, ..BOTH }),
                ParamError::NotALimit("auxiliary.cut_out_v")
            );
        }
    }
}
