//! Averaged four-quadrant converter.
//!
//! `V_out = D·V_in − R·i − V_d·sgn(i)`, `I_in = D·i + P_0/V_in`: with the duty D it scales the
//! voltage, and what goes in comes out or is one of the losses. Four quadrants: with
//! `0 < D·V_in < Ke·ω` the current reverses and energy flows back. The voltage drop is set-valued,
//! like friction: what would drive the current has to exceed it, and is less by it then; within it
//! nothing flows.
//!
//! The ideal part is \[EPowertrain2025, eq. 3.4 and 4.2\]; the sign flip of the input current at
//! `D < 0` (eq. 4.3) is an error of the print: it creates energy. The losses are ours.
//!
//! Tests: below; properties `finite`, `limits`, `monotony`, `passivity`, `refusal`, `steady`; cases
//! "converter bench".

use crate::error::{ParamError, check, limit, not_negative};
use crate::model::impl_model;
use crate::num::{Real, clamp, sane, sign};
use crate::port::Source;

/// What the converter of a machine is told; `M` is what it modulates with: a duty, or a voltage of
/// both axes of a machine with three phases.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gates<M = Real> {
    /// Gates off: only the diodes conduct, and only where the back-EMF exceeds the input's voltage.
    #[default]
    Off,
    /// A modulation.
    On(M),
    /// A torque \[N·m\], by an ideal current loop that knows the machine.
    Torque(Real),
}

impl<M: Copy> Gates<M> {
    /// The modulation, where one is commanded.
    #[inline]
    #[must_use]
    pub const fn modulation(self) -> Option<M> {
        match self {
            Self::On(modulation) => Some(modulation),
            Self::Off | Self::Torque(_) => None,
        }
    }
}

/// Parameters of a converter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ConverterParams {
    /// Largest magnitude of the duty, above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub duty_limit: Real,
    /// Loss that does not depend on the load \[W\], ≥ 0, drawn at the input.
    pub constant_loss_w: Real,
    /// Voltage drop against the output current \[V\], ≥ 0: of the switches, or of the diodes.
    pub voltage_drop_v: Real,
    /// Resistance in the output \[Ω\], ≥ 0.
    pub resistance_ohm: Real,
    /// Largest magnitude of the output current \[A\], above zero; infinity for none. The coupled
    /// plant holds the duty back for it.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub current_limit_a: Real,
}

impl Default for ConverterParams {
    /// Without losses, duty within −1..1.
    fn default() -> Self {
        Self::IDEAL
    }
}

impl ConverterParams {
    /// Without losses, duty within −1..1.
    pub const IDEAL: Self = Self {
        duty_limit: 1.0,
        constant_loss_w: 0.0,
        voltage_drop_v: 0.0,
        resistance_ohm: 0.0,
        current_limit_a: Real::INFINITY,
    };
}

/// A converter that scales voltage by its duty and conserves power.
///
/// It has no state of its own and no time in it, so it takes no `Dt`.
///
/// ```
/// use plant_core::converter::{Converter, ConverterInput, ConverterParams};
/// use plant_core::must;
///
/// const CONVERTER: Converter = must!(Converter::new(ConverterParams::IDEAL));
///
/// let input = ConverterInput { duty: 0.5, input_v: 400.0, output_a: 100.0 };
/// let out = CONVERTER.step(&mut (), input);
/// assert_eq!((out.output_v, out.input_a), (200.0, 50.0)); // 20 kW on both sides
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Converter {
    pub(crate) params: ConverterParams,
}

/// Input of a [`Converter`] that steps on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConverterInput {
    /// Commanded duty; held within the limit.
    pub duty: Real,
    /// Voltage at the input \[V\].
    pub input_v: Real,
    /// Current out of the output \[A\].
    pub output_a: Real,
}

/// Output of a [`Converter`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ConverterOutput {
    /// The duty applied.
    pub duty: Real,
    /// Voltage at the output \[V\].
    pub output_v: Real,
    /// Current into the input \[A\].
    pub input_a: Real,
    /// Power lost \[W\], never negative.
    pub loss_w: Real,
    /// An input was not finite or absurd: it delivers nothing.
    pub rejected: bool,
}

/// A constant loss as a shunt \[S\]: `P_0/V²`; none without voltage.
#[inline]
pub(crate) const fn shunt_s(constant_loss_w: Real, input_v: Real) -> Real {
    if constant_loss_w > 0.0 && input_v > 1.0 { constant_loss_w / (input_v * input_v) } else { 0.0 }
}

impl Converter {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: ConverterParams) -> Result<Self, ParamError> {
        check!(limit("converter.duty_limit", params.duty_limit));
        check!(not_negative("converter.constant_loss_w", params.constant_loss_w));
        check!(not_negative("converter.voltage_drop_v", params.voltage_drop_v));
        check!(not_negative("converter.resistance_ohm", params.resistance_ohm));
        check!(limit("converter.current_limit_a", params.current_limit_a));
        Ok(Self { params })
    }

    /// The duty that the limit allows. One that is absurd stays so, for the caller to see.
    #[inline]
    #[must_use]
    pub const fn allowed_duty(&self, duty: Real) -> Real {
        if duty.abs() > self.params.duty_limit {
            if sane(duty) {
                clamp(duty, -self.params.duty_limit, self.params.duty_limit)
            } else {
                Real::NAN
            }
        } else {
            duty
        }
    }

    /// The constant loss as a shunt at the input \[S\].
    #[inline]
    #[must_use]
    pub const fn shunt_s(&self, input_v: Real) -> Real {
        shunt_s(self.params.constant_loss_w, input_v)
    }

    /// A source as seen through `duty`: `D·emf` behind `D²·R`; the converter's own losses come on
    /// top.
    #[inline]
    #[must_use]
    pub const fn seen_through(source: Source, duty: Real) -> Source {
        Source { emf_v: duty * source.emf_v, resistance_ohm: duty * duty * source.resistance_ohm }
    }

    /// One instant of the converter on its own.
    #[inline]
    #[must_use]
    pub fn step(&self, _state: &mut (), input: ConverterInput) -> ConverterOutput {
        let ConverterInput { duty, input_v, output_a } = input;
        if !sane(duty) || !sane(input_v) || !sane(output_a) {
            let (duty, output_v, input_a, loss_w) = (0.0, 0.0, 0.0, 0.0);
            return ConverterOutput { duty, output_v, input_a, loss_w, rejected: true };
        }
        let duty = self.allowed_duty(duty);
        let lost_v =
            self.params.voltage_drop_v * sign(output_a) + self.params.resistance_ohm * output_a;
        let shunt_a = self.shunt_s(input_v) * input_v;
        ConverterOutput {
            duty,
            output_v: duty * input_v - lost_v,
            input_a: duty * output_a + shunt_a,
            loss_w: lost_v * output_a + shunt_a * input_v,
            rejected: false,
        }
    }
}

impl_model!(Converter, (), ConverterInput, ConverterOutput);

#[cfg(test)]
mod tests {
    use super::*;

    const LOSSY: ConverterParams = ConverterParams {
        duty_limit: 0.95,
        constant_loss_w: 50.0,
        voltage_drop_v: 1.2,
        resistance_ohm: 0.01,
        current_limit_a: 300.0,
    };

    fn at(params: ConverterParams, duty: Real, input_v: Real, output_a: Real) -> ConverterOutput {
        let input = ConverterInput { duty, input_v, output_a };
        Converter::new(params).unwrap().step(&mut (), input)
    }

    #[test]
    fn conserves_power_in_all_four_quadrants() {
        for params in [ConverterParams::IDEAL, LOSSY] {
            for duty in [-0.7, -0.1, 0.0, 0.4, 0.9] {
                for i in [-80.0, -1.0, 0.0, 3.0, 200.0] {
                    let out = at(params, duty, 400.0, i);
                    let balance = 400.0 * out.input_a - out.output_v * i - out.loss_w;
                    assert!(balance.abs() < 0.02, "{duty} {i}: {balance}");
                    assert!(out.loss_w >= 0.0);
                }
            }
        }
    }

    #[test]
    fn plug_braking_draws_from_the_battery() {
        // D < 0 with a forward current: the print's sign flip would book this as charging.
        assert_eq!(at(ConverterParams::IDEAL, -0.5, 400.0, -20.0).input_a, 10.0);
        assert_eq!(at(ConverterParams::IDEAL, -0.5, 400.0, 20.0).input_a, -10.0);
    }

    #[test]
    fn losses_are_those_of_the_parameters() {
        let out = at(LOSSY, 0.5, 400.0, 100.0);
        // 50 W + 1.2 V·100 A + 0.01 Ω·(100 A)²
        assert!((out.loss_w - (50.0 + 120.0 + 100.0)).abs() < 0.01, "{}", out.loss_w);
        assert_eq!(at(LOSSY, 0.5, 400.0, 0.0).output_v, 200.0);
        assert_eq!(at(ConverterParams::IDEAL, 0.5, 400.0, 100.0).loss_w, 0.0);
    }

    #[test]
    fn holds_the_duty_within_its_limit() {
        assert_eq!(at(LOSSY, 3.0, 400.0, 0.0).duty, 0.95);
        assert_eq!(at(LOSSY, -3.0, 400.0, 0.0).duty, -0.95);
        let unlimited = ConverterParams { duty_limit: Real::INFINITY, ..ConverterParams::IDEAL };
        assert_eq!(at(unlimited, 3.0, 400.0, 0.0).output_v, 1200.0);
    }

    #[test]
    fn bad_input_delivers_nothing() {
        for (d, v, i) in [(Real::NAN, 400.0, 1.0), (0.5, 1e38, 1.0), (0.5, 400.0, -Real::INFINITY)]
        {
            let out = at(LOSSY, d, v, i);
            assert!(out.rejected && out.output_v == 0.0 && out.input_a == 0.0);
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |p| Converter::new(p).unwrap_err();
        assert_eq!(
            refused(ConverterParams { duty_limit: 0.0, ..LOSSY }),
            ParamError::NotALimit("converter.duty_limit")
        );
        assert_eq!(
            refused(ConverterParams { current_limit_a: -1.0, ..LOSSY }),
            ParamError::NotALimit("converter.current_limit_a")
        );
        for bad in [-1.0, Real::NAN, Real::INFINITY] {
            assert_eq!(
                refused(ConverterParams { constant_loss_w: bad, ..LOSSY }),
                ParamError::Negative("converter.constant_loss_w")
            );
            assert_eq!(
                refused(ConverterParams { voltage_drop_v: bad, ..LOSSY }),
                ParamError::Negative("converter.voltage_drop_v")
            );
            assert_eq!(
                refused(ConverterParams { resistance_ohm: bad, ..LOSSY }),
                ParamError::Negative("converter.resistance_ohm")
            );
        }
    }
}
