//! Temperatures at which a battery may be used.

use plant_core::error::{check, finite};
use plant_core::{ParamError, Real};

/// The share of the largest current that a battery may see at a temperature: none outside, all of
/// it within, linear in between.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct TemperatureWindow {
    /// None below \[°C\].
    pub none_below_c: Real,
    /// All from here on \[°C\], not below `none_below_c`.
    pub all_from_c: Real,
    /// All up to here \[°C\], not below `all_from_c`.
    pub all_to_c: Real,
    /// None above \[°C\], not below `all_to_c`. The heat of the current itself must not lead
    /// beyond, either.
    pub none_above_c: Real,
}

impl TemperatureWindow {
    pub(super) const fn checked(self, fields: [&'static str; 4]) -> Result<Self, ParamError> {
        let [f0, f1, f2, f3] = fields;
        let t0 = check!(finite(f0, self.none_below_c));
        let t1 = check!(finite(f1, self.all_from_c));
        let t2 = check!(finite(f2, self.all_to_c));
        let t3 = check!(finite(f3, self.none_above_c));
        if t1 < t0 {
            Err(ParamError::NotAbove(f1))
        } else if t2 < t1 {
            Err(ParamError::NotAbove(f2))
        } else if t3 < t2 {
            Err(ParamError::NotAbove(f3))
        } else {
            Ok(self)
        }
    }

    /// The share at a temperature, 0..1.
    #[must_use]
    pub const fn share(&self, temperature_c: Real) -> Real {
        if temperature_c >= self.all_from_c && temperature_c <= self.all_to_c {
            1.0
        } else if temperature_c > self.none_below_c && temperature_c < self.all_from_c {
            (temperature_c - self.none_below_c) / (self.all_from_c - self.none_below_c)
        } else if temperature_c > self.all_to_c && temperature_c < self.none_above_c {
            (self.none_above_c - temperature_c) / (self.none_above_c - self.all_to_c)
        } else {
            0.0
        }
    }
}
