//! What a battery allows: currents, and the currents that its voltages and its charge leave.
//!
//! Within one step a battery is a [`Source`], so a voltage at its terminals is a current:
//! discharging `I ≤ (emf − lowest)/R`, charging `I ≤ (highest − emf)/R`. Towards the ends of charge
//! the currents fade. Both are ours.
//!
//! Tests: below, those of the batteries and of the powertrain; property `limits`.

use crate::error::{ParamError, check, limit, not_negative};
use crate::model::Dt;
use crate::num::{Real, max, min};
use crate::port::Source;

/// The currents that a battery, or what manages it, allows over the next step \[A\], both ≥ 0; none
/// by default.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CurrentLimits {
    /// Largest discharge current: the parameter, what the lowest voltage leaves, or what the
    /// remaining charge feeds for one step.
    pub discharge_a: Real,
    /// Largest charge current, likewise.
    pub charge_a: Real,
}

impl Default for CurrentLimits {
    fn default() -> Self {
        Self::NONE
    }
}

impl CurrentLimits {
    /// Any current.
    pub const NONE: Self = Self { discharge_a: Real::INFINITY, charge_a: Real::INFINITY };

    /// The lower of both, in each direction.
    #[inline]
    #[must_use]
    pub const fn within(self, other: Self) -> Self {
        Self {
            discharge_a: min(self.discharge_a, other.discharge_a),
            charge_a: min(self.charge_a, other.charge_a),
        }
    }
}

/// Between which voltages the terminals are to stay; any by default. What would lead beyond is
/// refused: discharging below the lowest, charging above the highest.
///
/// ```
/// use plant_core::battery::{Battery, BatteryInput, BatteryState, VoltageLimits};
/// use plant_core::presets::BMW_I3_60AH_CONSTANT;
/// use plant_core::{Dt, ParamError};
///
/// let mut params = BMW_I3_60AH_CONSTANT.powertrain.battery;
/// params.voltage_limits = VoltageLimits { lowest_v: 340.0, ..VoltageLimits::NONE };
/// let battery = Battery::new(params, Dt::from_s(0.01)?)?;
/// let mut state = BatteryState::rested(0.1)?; // 348.9 V, 0.105 Ω
/// let out = battery.step(&mut state, BatteryInput { current_a: 300.0 });
/// assert!(out.current_a < 90.0 && (out.terminal_v - 340.0).abs() < 1e-3);
/// # Ok::<(), ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct VoltageLimits {
    /// Lowest voltage at the terminals under discharge \[V\], ≥ 0; −infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited::below"))]
    pub lowest_v: Real,
    /// Highest voltage at the terminals under charge \[V\], above zero and above `lowest_v`;
    /// infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub highest_v: Real,
}

impl Default for VoltageLimits {
    fn default() -> Self {
        Self::NONE
    }
}

impl VoltageLimits {
    /// Any voltage.
    pub const NONE: Self = Self { lowest_v: -Real::INFINITY, highest_v: Real::INFINITY };

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        if self.lowest_v > -Real::INFINITY || self.lowest_v.is_nan() {
            check!(not_negative("battery.voltage_limits.lowest_v", self.lowest_v));
        }
        check!(limit("battery.voltage_limits.highest_v", self.highest_v));
        if self.highest_v <= self.lowest_v {
            return Err(ParamError::NotAbove("battery.voltage_limits.highest_v"));
        }
        Ok(self)
    }

    /// Whether there is one.
    const fn any(&self) -> bool {
        self.lowest_v > -Real::INFINITY || self.highest_v < Real::INFINITY
    }
}

/// How long a coupled plant's limits take to fade at the ends of charge \[s\].
const FADE_S: Real = 0.1;
/// Nearer to an end of charge than this the limits themselves are looked at in any case, unless the
/// parameters allow too little to fade there.
const NEAR: Real = 1e-3;

/// Where a battery's limits change from step to step: towards the ends of charge, and with the
/// voltage.
///
/// A coupled plant sees the ends of charge fade: a limit of one step, as
/// [`limits`](super::Battery::limits) has it, would switch a winding's current off and on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    a_per_soc: Real,
    /// Below this state of charge discharging fades, above the other charging.
    low: Real,
    high: Real,
    /// Between these nothing but the parameters limits: no charge fades, no voltage acts.
    far_low: Real,
    far_high: Real,
    voltage: VoltageLimits,
    cuts_off: bool,
}

impl Ends {
    pub(super) const fn new(
        capacity_c: Real,
        limits: CurrentLimits,
        voltage: VoltageLimits,
        dt: Dt,
    ) -> Self {
        let a_per_soc = capacity_c / max(FADE_S, dt.s());
        let cuts_off = voltage.any();
        let (low, high) = (limits.discharge_a / a_per_soc, 1.0 - limits.charge_a / a_per_soc);
        Self {
            a_per_soc,
            low,
            high,
            far_low: if cuts_off { Real::INFINITY } else { low },
            far_high: if cuts_off { -Real::INFINITY } else { high },
            voltage,
            cuts_off,
        }
    }

    /// What the charge that is left to go leaves.
    pub(super) const fn faded(&self, soc: Real) -> CurrentLimits {
        CurrentLimits {
            discharge_a: max(soc, 0.0) * self.a_per_soc,
            charge_a: max(1.0 - soc, 0.0) * self.a_per_soc,
        }
    }

    /// Whether a voltage may limit the current at all.
    #[inline(always)]
    pub(super) const fn cut_off(&self) -> bool {
        self.cuts_off
    }

    /// What the voltages leave, for a battery that offers `source`.
    pub(super) const fn at_voltages(&self, source: Source) -> CurrentLimits {
        CurrentLimits {
            discharge_a: max((source.emf_v - self.voltage.lowest_v) / source.resistance_ohm, 0.0),
            charge_a: max((self.voltage.highest_v - source.emf_v) / source.resistance_ohm, 0.0),
        }
    }

    /// Whether a step that leads to `soc` is one in which nothing but the parameters limits.
    #[inline(always)]
    pub(super) const fn are_far(&self, soc: Real) -> bool {
        soc >= self.far_low && soc <= self.far_high
    }

    /// Whether a step that leads to `soc` is one in which the limits themselves are to be looked at:
    /// a plant that went by a few currents there would switch its loads off and on.
    pub(super) const fn are_near(&self, soc: Real) -> bool {
        soc < min(self.low, NEAR) || soc > max(self.high, 1.0 - NEAR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voltage_is_a_current() {
        let limits = CurrentLimits { discharge_a: 100.0, charge_a: 50.0 };
        let voltage = VoltageLimits { lowest_v: 300.0, highest_v: 400.0 };
        let ends = Ends::new(7200.0, limits, voltage, Dt::from_s(0.01).unwrap());
        for (emf_v, discharge_a, charge_a) in [
            (350.0, 500.0, 500.0),
            (310.0, 100.0, 900.0),
            (290.0, 0.0, 1100.0),
            (410.0, 1100.0, 0.0),
        ] {
            let left = ends.at_voltages(Source { emf_v, resistance_ohm: 0.1 });
            assert!((left.discharge_a - discharge_a).abs() < 1e-3, "{emf_v} {left:?}");
            assert!((left.charge_a - charge_a).abs() < 1e-3, "{emf_v} {left:?}");
        }
        assert!(!ends.are_far(0.5), "a voltage may act at any charge");
        let none = Ends::new(7200.0, limits, VoltageLimits::NONE, Dt::from_s(0.01).unwrap());
        let left = none.at_voltages(Source { emf_v: 350.0, resistance_ohm: 0.1 });
        assert_eq!(left, CurrentLimits::NONE);
        assert!(none.are_far(0.5) && !none.cut_off());
    }

    #[test]
    fn refuses_what_is_no_range() {
        let refused = |lowest_v, highest_v| VoltageLimits { lowest_v, highest_v }.checked().err();
        let lowest = Some(ParamError::Negative("battery.voltage_limits.lowest_v"));
        for bad in [-1.0, Real::NAN, Real::INFINITY, 1e13] {
            assert_eq!(refused(bad, Real::INFINITY), lowest);
        }
        let highest = "battery.voltage_limits.highest_v";
        for bad in [0.0, -1.0, Real::NAN, -Real::INFINITY] {
            assert_eq!(refused(-Real::INFINITY, bad), Some(ParamError::NotALimit(highest)));
        }
        assert_eq!(refused(3.0, 3.0), Some(ParamError::NotAbove(highest)));
        for (lowest_v, highest_v) in [(0.0, 4.2), (2.5, Real::INFINITY), (-Real::INFINITY, 4.2)] {
            assert_eq!(refused(lowest_v, highest_v), None);
        }
    }
}
