//! What a [`MappedBattery`](super::MappedBattery) is made of: quantities over the state of charge
//! and the temperature, and the lumped thermal node.
//!
//! - `R(s, T) = R(s)·exp(E·(1/T − 1/298.15 K))` \[Arrhenius1889, as an activation temperature\]
//! - `dh/dSOC = γ·(sgn − h)` \[Plett2004Part2, eq. 22\]
//! - `C·dT/dt = (OCV − V)·I − k·(T − T_ambient)` \[Bernardi1985, without the entropic term\]
//!
//! Tests: below and in `mapped/tests.rs`; property `mapped`; case "battery with maps".

use super::{BatteryParams, OpenCircuit, VoltageLimits};
use crate::error::{ParamError, check, limit, not_negative, positive, ratio};
use crate::num::{Real, SocTable, clamp, exp};

/// 0 °C in kelvin.
const KELVIN_AT_0_C: Real = 273.15;
/// The temperature at which resistances are given \[°C\].
pub const REFERENCE_C: Real = 25.0;

/// A quantity over the state of charge.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase", deny_unknown_fields))]
#[expect(clippy::large_enum_variant, reason = "no allocation: the table lives in flash")]
pub enum OverSoc {
    /// The same at any state of charge.
    Constant(Real),
    /// Measured points on an even grid; the ends hold beyond them.
    Table(SocTable),
}

impl OverSoc {
    /// Its value at `soc`.
    #[inline]
    #[must_use]
    pub fn at(&self, soc: Real) -> Real {
        match self {
            Self::Constant(value) => *value,
            Self::Table(table) => table.at(soc),
        }
    }

    const fn checked(self, field: &'static str) -> Result<Self, ParamError> {
        match &self {
            Self::Constant(value) => {
                check!(not_negative(field, *value));
            }
            Self::Table(table) => {
                let mut rest = table.values().as_slice();
                while let [value, tail @ ..] = rest {
                    check!(not_negative(field, *value));
                    rest = tail;
                }
            }
        }
        Ok(self)
    }
}

/// A resistance over state of charge and temperature:
/// `R(s, T) = R(s)·exp(E·(1/T − 1/298.15 K))` \[Arrhenius1889, as an activation temperature\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ResistanceMap {
    /// At 25 °C \[Ω\], ≥ 0.
    pub resistance_ohm: OverSoc,
    /// Activation temperature E \[K\], 0..20 000; 0 for no dependence on temperature.
    #[cfg_attr(feature = "serde", serde(default))]
    pub activation_k: Real,
}

/// The steepest dependence on temperature that makes sense \[K\].
const LARGEST_ACTIVATION_K: Real = 20_000.0;

impl ResistanceMap {
    /// None.
    pub const NONE: Self = Self { resistance_ohm: OverSoc::Constant(0.0), activation_k: 0.0 };

    pub(super) const fn checked(
        self,
        resistance: &'static str,
        activation: &'static str,
    ) -> Result<Self, ParamError> {
        let resistance_ohm = check!(self.resistance_ohm.checked(resistance));
        let activation_k = check!(not_negative(activation, self.activation_k));
        if activation_k > LARGEST_ACTIVATION_K {
            return Err(ParamError::OutOfRange(activation));
        }
        Ok(Self { resistance_ohm, activation_k })
    }

    /// The resistance at a state of charge and a temperature \[Ω\].
    #[must_use]
    pub fn at(&self, soc: Real, temperature_c: Real) -> Real {
        let base = self.resistance_ohm.at(soc);
        if self.activation_k > 0.0 {
            base * temperature_factor(self.activation_k, temperature_c)
        } else {
            base
        }
    }
}

/// How many times larger a resistance with this activation temperature \[K\] is at a temperature
/// \[°C\] than at 25 °C \[Arrhenius1889\].
#[must_use]
pub fn temperature_factor(activation_k: Real, temperature_c: Real) -> Real {
    let kelvin = temperature_c + KELVIN_AT_0_C;
    let reference = REFERENCE_C + KELVIN_AT_0_C;
    // One quotient: the difference of two inverses would lose digits.
    exp(activation_k * (REFERENCE_C - temperature_c) / (kelvin * reference))
}

/// One RC branch whose resistance depends on state of charge and temperature and whose time
/// constant does not.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct BranchMap {
    /// At 25 °C \[Ω\], ≥ 0.
    pub resistance_ohm: OverSoc,
    /// Activation temperature of the resistance \[K\], 0..20 000; 0 for no dependence.
    #[cfg_attr(feature = "serde", serde(default))]
    pub activation_k: Real,
    /// Time constant \[s\], above zero.
    pub time_constant_s: Real,
}

impl BranchMap {
    /// No branch.
    pub const NONE: Self =
        Self { resistance_ohm: OverSoc::Constant(0.0), activation_k: 0.0, time_constant_s: 1.0 };

    /// Its resistance at a state of charge and a temperature \[Ω\].
    #[must_use]
    pub fn at(&self, soc: Real, temperature_c: Real) -> Real {
        self.resistance().at(soc, temperature_c)
    }

    /// Its resistance.
    #[must_use]
    pub const fn resistance(&self) -> ResistanceMap {
        ResistanceMap { resistance_ohm: self.resistance_ohm, activation_k: self.activation_k }
    }
}

/// One-state hysteresis of the open-circuit voltage \[Plett2004Part2, eq. 22\]:
/// `dh/dSOC = γ·(sgn − h)`, `V_oc = OCV(SOC) + M·h`, with h towards 1 when charging.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct HysteresisParams {
    /// Half the gap between the curves of charge and discharge, M \[V\], ≥ 0; 0 for none.
    pub half_gap_v: Real,
    /// How fast a change of the state of charge moves from one curve to the other, γ, ≥ 0.
    pub rate_per_soc: Real,
}

impl HysteresisParams {
    /// None.
    pub const NONE: Self = Self { half_gap_v: 0.0, rate_per_soc: 0.0 };

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(not_negative("battery.hysteresis.half_gap_v", self.half_gap_v));
        check!(not_negative("battery.hysteresis.rate_per_soc", self.rate_per_soc));
        Ok(self)
    }
}

impl Default for HysteresisParams {
    fn default() -> Self {
        Self::NONE
    }
}

/// A lumped thermal node: `C·dT/dt = (OCV − V)·I − k·(T − T_ambient)` \[Bernardi1985,
/// without the entropic term\].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ThermalParams {
    /// Heat capacity \[J/K\], above zero; infinity: the temperature stays as it is set.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub heat_capacity_j_per_k: Real,
    /// Cooling to the surroundings \[W/K\], ≥ 0.
    pub cooling_w_per_k: Real,
    /// Temperature of the surroundings at the start \[°C\], −100..200.
    pub ambient_c: Real,
}

impl ThermalParams {
    /// The temperature stays as it is set; 25 °C at the start.
    pub const FIXED: Self = Self {
        heat_capacity_j_per_k: Real::INFINITY,
        cooling_w_per_k: 0.0,
        ambient_c: REFERENCE_C,
    };

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(limit("battery.thermal.heat_capacity_j_per_k", self.heat_capacity_j_per_k));
        check!(not_negative("battery.thermal.cooling_w_per_k", self.cooling_w_per_k));
        check!(temperature("battery.thermal.ambient_c", self.ambient_c));
        Ok(self)
    }
}

impl Default for ThermalParams {
    fn default() -> Self {
        Self::FIXED
    }
}

/// Temperatures outside are refused \[°C\].
pub(super) const COLDEST_C: Real = -100.0;
/// Temperatures outside are refused \[°C\].
pub(super) const HOTTEST_C: Real = 200.0;

pub(super) const fn is_possible(celsius: Real) -> bool {
    celsius >= COLDEST_C && celsius <= HOTTEST_C
}

pub(super) const fn temperature(field: &'static str, celsius: Real) -> Result<Real, ParamError> {
    if is_possible(celsius) { Ok(celsius) } else { Err(ParamError::OutOfRange(field)) }
}

/// Where the parameters were identified. Outside, the values of the nearer end hold, and the
/// battery says so.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct IdentifiedRange {
    /// Lowest state of charge, 0..1.
    pub soc_min: Real,
    /// Highest state of charge, above the lowest, up to 1.
    pub soc_max: Real,
    /// Lowest temperature \[°C\].
    pub temperature_min_c: Real,
    /// Highest temperature \[°C\], not below the lowest.
    pub temperature_max_c: Real,
}

impl IdentifiedRange {
    /// Everywhere.
    pub const ALL: Self = Self {
        soc_min: 0.0,
        soc_max: 1.0,
        temperature_min_c: COLDEST_C,
        temperature_max_c: HOTTEST_C,
    };

    /// Whether a state of charge and a temperature lie inside.
    #[must_use]
    pub const fn holds(&self, soc: Real, temperature_c: Real) -> bool {
        soc >= self.soc_min
            && soc <= self.soc_max
            && temperature_c >= self.temperature_min_c
            && temperature_c <= self.temperature_max_c
    }

    /// The nearest temperature inside \[°C\].
    #[must_use]
    pub const fn nearest_c(&self, temperature_c: Real) -> Real {
        clamp(temperature_c, self.temperature_min_c, self.temperature_max_c)
    }

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(ratio("battery.identified.soc_min", self.soc_min));
        check!(ratio("battery.identified.soc_max", self.soc_max));
        if self.soc_max <= self.soc_min {
            return Err(ParamError::NotAbove("battery.identified.soc_max"));
        }
        check!(temperature("battery.identified.temperature_min_c", self.temperature_min_c));
        check!(temperature("battery.identified.temperature_max_c", self.temperature_max_c));
        if self.temperature_max_c < self.temperature_min_c {
            return Err(ParamError::NotAbove("battery.identified.temperature_max_c"));
        }
        Ok(self)
    }
}

impl Default for IdentifiedRange {
    fn default() -> Self {
        Self::ALL
    }
}

/// Parameters of a [`MappedBattery`](super::MappedBattery): they depend on state of charge and
/// temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct MappedBatteryParams {
    /// Charge between SOC 0 and 1 \[A·h\], above zero.
    pub capacity_ah: Real,
    /// Largest discharge current \[A\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub discharge_limit_a: Real,
    /// Largest charge current \[A\], above zero; infinity for none.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::unlimited"))]
    pub charge_limit_a: Real,
    /// Lowest and highest voltage at the terminals; any by default.
    #[cfg_attr(feature = "serde", serde(default))]
    pub voltage_limits: VoltageLimits,
    /// How often resistances and temperature follow \[s\], above zero: well below the time in
    /// which state of charge or temperature change them.
    #[cfg_attr(feature = "serde", serde(default = "one_second"))]
    pub refresh_s: Real,
    /// Open-circuit voltage over the state of charge.
    pub open_circuit: OpenCircuit,
    /// Its hysteresis.
    #[cfg_attr(feature = "serde", serde(default))]
    pub hysteresis: HysteresisParams,
    /// Series resistance.
    pub series: ResistanceMap,
    /// The faster RC branch.
    pub polarisation: BranchMap,
    /// The slower RC branch; [`BranchMap::NONE`] for none.
    #[cfg_attr(feature = "serde", serde(default = "no_branch"))]
    pub second_polarisation: BranchMap,
    /// The thermal node.
    #[cfg_attr(feature = "serde", serde(default))]
    pub thermal: ThermalParams,
    /// Where all this was identified.
    #[cfg_attr(feature = "serde", serde(default))]
    pub identified: IdentifiedRange,
}

#[cfg(feature = "serde")]
const fn one_second() -> Real {
    1.0
}

#[cfg(feature = "serde")]
const fn no_branch() -> BranchMap {
    BranchMap::NONE
}

impl MappedBatteryParams {
    /// A battery with constant parameters and one RC branch, as a map.
    #[must_use]
    pub const fn constant(params: BatteryParams) -> Self {
        Self {
            capacity_ah: params.capacity_ah,
            discharge_limit_a: params.discharge_limit_a,
            charge_limit_a: params.charge_limit_a,
            voltage_limits: params.voltage_limits,
            refresh_s: 1.0,
            open_circuit: params.open_circuit,
            hysteresis: HysteresisParams::NONE,
            series: ResistanceMap {
                resistance_ohm: OverSoc::Constant(params.series_resistance_ohm),
                activation_k: 0.0,
            },
            polarisation: BranchMap {
                resistance_ohm: OverSoc::Constant(params.polarisation.resistance_ohm),
                activation_k: 0.0,
                time_constant_s: params.polarisation.resistance_ohm
                    * params.polarisation.capacitance_f,
            },
            second_polarisation: BranchMap::NONE,
            thermal: ThermalParams::FIXED,
            identified: IdentifiedRange::ALL,
        }
    }

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(positive("battery.capacity_ah", self.capacity_ah));
        check!(limit("battery.discharge_limit_a", self.discharge_limit_a));
        check!(limit("battery.charge_limit_a", self.charge_limit_a));
        check!(self.voltage_limits.checked());
        check!(positive("battery.refresh_s", self.refresh_s));
        check!(self.open_circuit.checked());
        check!(self.hysteresis.checked());
        check!(self.series.checked("battery.series.resistance_ohm", "battery.series.activation_k"));
        check!(
            self.polarisation.resistance().checked(
                "battery.polarisation.resistance_ohm",
                "battery.polarisation.activation_k"
            )
        );
        check!(positive("battery.polarisation.time_constant_s", self.polarisation.time_constant_s));
        check!(self.second_polarisation.resistance().checked(
            "battery.second_polarisation.resistance_ohm",
            "battery.second_polarisation.activation_k"
        ));
        check!(positive(
            "battery.second_polarisation.time_constant_s",
            self.second_polarisation.time_constant_s
        ));
        check!(self.thermal.checked());
        check!(self.identified.checked());
        Ok(self)
    }
}
