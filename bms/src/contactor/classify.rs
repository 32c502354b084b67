//! From measurements to the classes that the machine sees.

use plant_core::error::{check, not_negative, positive};
use plant_core::num::{lag_gain, sane};
use plant_core::{Dt, ParamError, Real};

use super::state::{CurrentClass, LinkClass};

/// What a current \[A\] is to a contactor that breaks `break_a` without harm. NaN is unknown, and so
/// is everything absurd.
#[must_use]
pub const fn current_class(current_a: Real, break_a: Real) -> CurrentClass {
    if !sane(current_a) {
        CurrentClass::Unknown
    } else if current_a.abs() <= break_a {
        CurrentClass::Breakable
    } else {
        CurrentClass::High
    }
}

/// Parameters of [`LinkTrend`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinkTrendParams {
    /// Time over which it is seen \[s\], above zero.
    pub time_s: Real,
    /// A change within that time that is none \[V\], ≥ 0: noise.
    pub noise_v: Real,
}

/// Whether the link's voltage rises or falls: against its own lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkTrend {
    gain: Real,
    noise_v: Real,
}

/// The state of a [`LinkTrend`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct LinkTrendState {
    slow_v: Real,
}

impl LinkTrendState {
    /// Nothing seen.
    pub const NEW: Self = Self { slow_v: Real::NAN };
}

impl LinkTrend {
    /// Checks the parameters, for a call every `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the field that is out of range.
    pub const fn new(params: LinkTrendParams, dt: Dt) -> Result<Self, ParamError> {
        check!(positive("link_trend.time_s", params.time_s));
        check!(not_negative("link_trend.noise_v", params.noise_v));
        Ok(Self { gain: lag_gain(dt.s() / params.time_s), noise_v: params.noise_v })
    }

    /// The class of a voltage \[V\]; NaN where there is no value.
    pub const fn of(&self, state: &mut LinkTrendState, link_v: Real) -> LinkClass {
        if !sane(link_v) {
            state.slow_v = Real::NAN;
            return LinkClass::Unknown;
        }
        if !sane(state.slow_v) {
            state.slow_v = link_v;
        }
        let change_v = link_v - state.slow_v;
        state.slow_v += self.gain * change_v;
        if change_v > self.noise_v {
            LinkClass::Rising
        } else if change_v < -self.noise_v {
            LinkClass::Falling
        } else {
            LinkClass::Steady
        }
    }
}
