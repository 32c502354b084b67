//! How cells differ.

use crate::error::{ParamError, check, not_negative};
use crate::num::Real;

/// How one cell of a [`SeriesPack`](super::SeriesPack) differs from what its parameters say.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct CellSpread {
    /// Its capacity over that of the parameters, 0.01..100.
    pub capacity_ratio: Real,
    /// Its resistances over those of the parameters, 0.01..100.
    pub resistance_ratio: Real,
    /// Its cooling over that of the parameters, 0..100.
    pub cooling_ratio: Real,
    /// What it loses by itself \[A\], ≥ 0.
    pub self_discharge_a: Real,
    /// Its state of charge at the start, less that of the pack, −1..1; held in 0..1.
    pub soc_offset: Real,
    /// Its temperature at the start, and that of its surroundings, less those of the pack \[K\],
    /// −100..100; held where a battery can be.
    pub temperature_offset_k: Real,
}

impl CellSpread {
    /// As the parameters say.
    pub const NONE: Self = Self {
        capacity_ratio: 1.0,
        resistance_ratio: 1.0,
        cooling_ratio: 1.0,
        self_discharge_a: 0.0,
        soc_offset: 0.0,
        temperature_offset_k: 0.0,
    };

    pub(super) const fn checked(self) -> Result<Self, ParamError> {
        check!(within("pack.spread.capacity_ratio", self.capacity_ratio, 0.01, 100.0));
        check!(within("pack.spread.resistance_ratio", self.resistance_ratio, 0.01, 100.0));
        check!(within("pack.spread.cooling_ratio", self.cooling_ratio, 0.0, 100.0));
        check!(not_negative("pack.spread.self_discharge_a", self.self_discharge_a));
        check!(within("pack.spread.soc_offset", self.soc_offset, -1.0, 1.0));
        let offset_k = self.temperature_offset_k;
        check!(within("pack.spread.temperature_offset_k", offset_k, -100.0, 100.0));
        Ok(self)
    }
}

impl Default for CellSpread {
    fn default() -> Self {
        Self::NONE
    }
}

const fn within(
    field: &'static str,
    value: Real,
    low: Real,
    high: Real,
) -> Result<Real, ParamError> {
    if value >= low && value <= high { Ok(value) } else { Err(ParamError::OutOfRange(field)) }
}
