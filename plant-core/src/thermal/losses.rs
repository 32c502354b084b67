//! What a temperature does to a winding and to a limit, and the losses of a whole drive.

use crate::error::{ParamError, check, not_negative};
use crate::num::{Real, clamp};

/// How much of a limit is left at a temperature: all up to one, none from the other on, in
/// proportion in between. It is ours.
///
/// ```
/// use plant_core::must;
/// use plant_core::thermal::Derating;
///
/// const WINDING: Derating =
///     must!(Derating { derate_from_c: 140.0, derate_to_c: 180.0 }.checked());
/// assert_eq!([100.0, 140.0, 170.0, 200.0].map(|c| WINDING.factor(c)), [1.0, 1.0, 0.25, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Derating {
    /// Up to this temperature all is left \[°C\], −273.15 at least; infinity: always.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub derate_from_c: Real,
    /// From this temperature on nothing is left \[°C\], above the other; infinity: never.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub derate_to_c: Real,
}

/// 0 K \[°C\].
const ABSOLUTE_ZERO_C: Real = -273.15;

impl Derating {
    /// All is left at any temperature.
    pub const NONE: Self = Self { derate_from_c: Real::INFINITY, derate_to_c: Real::INFINITY };

    /// Checks it.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] or [`ParamError::NotAbove`] names the field that is out of range.
    pub const fn checked(self) -> Result<Self, ParamError> {
        if self.derate_from_c.is_nan() || self.derate_from_c < ABSOLUTE_ZERO_C {
            return Err(ParamError::OutOfRange("derating.derate_from_c"));
        }
        let never = self.derate_to_c == Real::INFINITY;
        if !(never || self.derate_to_c > self.derate_from_c) {
            return Err(ParamError::NotAbove("derating.derate_to_c"));
        }
        Ok(self)
    }

    /// What is left at a temperature, 0..1; 0 where that is not a number.
    #[inline]
    #[must_use]
    pub const fn factor(&self, celsius: Real) -> Real {
        if celsius <= self.derate_from_c || self.derate_to_c == Real::INFINITY {
            1.0
        } else if celsius < self.derate_to_c {
            clamp((self.derate_to_c - celsius) / (self.derate_to_c - self.derate_from_c), 0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// The resistance of a conductor over its temperature, `R(T) = R_ref·(1 + α·(T − T_ref))`
/// \[Iec60034\], as a factor.
///
/// ```
/// use plant_core::thermal::Conductor;
///
/// // A copper winding at 120 °C has 39 % more than at 20 °C.
/// assert!((Conductor::COPPER.factor(120.0) - 1.392).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Conductor {
    /// Temperature `T_ref` at which the resistance is given \[°C\], −100..300.
    pub reference_c: Real,
    /// Rise of the resistance α \[1/K\], 0..0.02, of that at `reference_c`.
    pub per_k: Real,
}

impl Conductor {
    /// Copper, given at 20 °C: `R` is in proportion to `235 + T` \[Iec60034\].
    pub const COPPER: Self = Self { reference_c: 20.0, per_k: 1.0 / 255.0 };
    /// The same at any temperature.
    pub const CONSTANT: Self = Self { reference_c: 20.0, per_k: 0.0 };

    /// Checks it.
    ///
    /// # Errors
    /// [`ParamError::OutOfRange`] names the field that is out of range.
    pub const fn checked(self) -> Result<Self, ParamError> {
        if !(self.reference_c >= -100.0 && self.reference_c <= 300.0) {
            return Err(ParamError::OutOfRange("conductor.reference_c"));
        }
        if !(self.per_k >= 0.0 && self.per_k <= 0.02) {
            return Err(ParamError::OutOfRange("conductor.per_k"));
        }
        Ok(self)
    }

    /// The resistance at a temperature over that at the reference, never below zero.
    #[inline]
    #[must_use]
    pub const fn factor(&self, celsius: Real) -> Real {
        let factor = 1.0 + self.per_k * (celsius - self.reference_c);
        if factor > 0.0 { factor } else { 0.0 }
    }
}

/// The losses of a drive (converter, machine and what turns) by torque and speed of its shaft, as
/// they are measured: `P = a·T² + b·|T| + c·ω² + d`. The form is ours.
///
/// A DC machine with torque constant `K_t` behind a converter has just these, as `i = T/K_t`:
///
/// | Coefficient | Loss | What it is there |
/// |---|---|---|
/// | a | `(R + R_c)·i²` | resistances of winding and converter, `R = a·K_t²` |
/// | b | `V_d·\|i\|` | voltage drop of the converter, `V_d = b·K_t` |
/// | c | `b_v·ω²` | viscous friction, `b_v = c` |
/// | d | `P_0` | constant loss of the converter |
///
/// so a drive that was measured is one that [`DcMotor`](crate::machine::dc::DcMotor) and
/// [`Converter`](crate::converter::Converter) can be. Torque is that of the air gap: a Coulomb
/// friction of the machine is no part of it.
///
/// ```
/// use plant_core::must;
/// use plant_core::thermal::DriveLosses;
///
/// // Found by least squares from driving a BMW i3.
/// const I3: DriveLosses = must!(
///     DriveLosses {
///         torque_w_per_nm2: 0.041,
///         torque_w_per_nm: 10.1,
///         speed_w_s2: 1.27e-3,
///         constant_w: 0.0,
///     }
///     .checked()
/// );
/// assert!((I3.resistance_ohm(0.27) - 3.0e-3).abs() < 2e-5);
/// assert!((I3.voltage_drop_v(0.27) - 2.73).abs() < 0.01);
/// assert!((I3.loss_w(100.0, 400.0) - (410.0 + 1010.0 + 203.2)).abs() < 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct DriveLosses {
    /// a: with the square of the torque \[W/(N·m)²\], ≥ 0.
    pub torque_w_per_nm2: Real,
    /// b: with the torque's magnitude \[W/(N·m)\], ≥ 0.
    pub torque_w_per_nm: Real,
    /// c: with the square of the speed \[W·s²/rad²\], ≥ 0.
    pub speed_w_s2: Real,
    /// d: always \[W\], ≥ 0.
    pub constant_w: Real,
}

impl DriveLosses {
    /// Checks it.
    ///
    /// # Errors
    /// [`ParamError::Negative`] names the first field that is out of range.
    pub const fn checked(self) -> Result<Self, ParamError> {
        check!(not_negative("losses.torque_w_per_nm2", self.torque_w_per_nm2));
        check!(not_negative("losses.torque_w_per_nm", self.torque_w_per_nm));
        check!(not_negative("losses.speed_w_s2", self.speed_w_s2));
        check!(not_negative("losses.constant_w", self.constant_w));
        Ok(self)
    }

    /// The losses of a DC machine behind a converter, with both resistances in one.
    #[must_use]
    pub const fn of_dc_machine(
        torque_nm_per_a: Real,
        resistance_ohm: Real,
        voltage_drop_v: Real,
        viscous_nm_s_per_rad: Real,
        constant_loss_w: Real,
    ) -> Self {
        Self {
            torque_w_per_nm2: resistance_ohm / (torque_nm_per_a * torque_nm_per_a),
            torque_w_per_nm: voltage_drop_v / torque_nm_per_a,
            speed_w_s2: viscous_nm_s_per_rad,
            constant_w: constant_loss_w,
        }
    }

    /// What is lost at a torque \[N·m\] and a speed \[rad/s\] of the shaft \[W\].
    #[inline]
    #[must_use]
    pub const fn loss_w(&self, torque_nm: Real, speed_rad_s: Real) -> Real {
        let torque_nm = torque_nm.abs();
        (self.torque_w_per_nm2 * torque_nm + self.torque_w_per_nm) * torque_nm
            + self.speed_w_s2 * speed_rad_s * speed_rad_s
            + self.constant_w
    }

    /// The resistance of winding and converter of a DC machine with these losses \[Ω\].
    #[must_use]
    pub const fn resistance_ohm(&self, torque_nm_per_a: Real) -> Real {
        self.torque_w_per_nm2 * torque_nm_per_a * torque_nm_per_a
    }

    /// The voltage drop of its converter \[V\].
    #[must_use]
    pub const fn voltage_drop_v(&self, torque_nm_per_a: Real) -> Real {
        self.torque_w_per_nm * torque_nm_per_a
    }
}
