//! Parameters of [`Cells`](super::Cells), and what of them can be worked out beforehand.

use plant_core::battery::OpenCircuit;
use plant_core::num::{SOC_POINTS, SocTable, max};
use plant_core::{Dt, ParamError, Real};

use crate::estimate::curve::INTERVALS;

/// Parameters of [`Cells`](super::Cells): how alike the cells of a pack are, and how well their
/// voltages are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct CellsParams {
    /// Open-circuit voltage of a cell over its state of charge, within ±100 V.
    pub open_circuit: OpenCircuit,
    /// Standard deviation of the noise of a cell's voltage \[V\], 1e-6..1.
    pub noise_sd_v: Real,
    /// Standard deviation of what stays between a cell's voltage and the curve \[V\], 0..1: the
    /// channel's offset, the cell's own curve.
    pub offset_sd_v: Real,
    /// Standard deviation of the cells' resistances, polarisation included \[Ω\], 0..1.
    pub resistance_sd_ohm: Real,
    /// Standard deviation of their capacities, as a ratio, 0..1.
    pub capacity_sd: Real,
    /// Standard deviation of their states of charge at the start, above 0 and up to 1.
    pub soc_sd: Real,
    /// How far a cell wanders from the others in a day, as a standard deviation of the state of
    /// charge, 0..1: self-discharge, balancing.
    pub drift_sd_per_day: Real,
    /// While the pack's own standard deviation is above this, the cells are held: nobody knows
    /// where on the curve they are. 0..1.
    pub pack_soc_sd_max: Real,
    /// Lowest voltage that a cell can have \[V\], within ±100; a reading below is none.
    pub voltage_min_v: Real,
    /// Highest voltage that a cell can have \[V\], above the lowest, within ±100; a reading above
    /// is none.
    pub voltage_max_v: Real,
}

/// The largest voltage of a cell \[V\]: with a quiet sensor's noise it bounds the gain.
const LARGEST_CELL_V: Real = 100.0;
/// The quietest sensor \[V\].
pub(super) const SMALLEST_NOISE_V: Real = 1e-6;
/// How long a cell stays in a bend at a moderate current \[s\]: so long its error stays the same.
/// Chosen: the cells' tests pass with a quarter and with four times as much.
const BEND_S: Real = 30.0;

/// The noise, and how far the curve leaves its tangent within two of `soc_sd` to either side. The
/// latter is no noise but lasts: noise that is larger by as many steps leaves as much open.
pub(super) const fn noise_variances(
    curve: &SocTable,
    noise_sd_v: Real,
    soc_sd: Real,
    dt: Dt,
) -> [Real; INTERVALS] {
    let values = curve.values();
    let reach = 2.0 * soc_sd * intervals(INTERVALS);
    let mut variances = [noise_sd_v * noise_sd_v; INTERVALS];
    let mut i = 0;
    while i < INTERVALS {
        let (mut bend_v, mut j) = (0.0, 0);
        while j < SOC_POINTS {
            let away = intervals(j) - intervals(i);
            if away >= -reach && away <= 1.0 + reach {
                let tangent_v = values[i] + (values[i + 1] - values[i]) * away;
                bend_v = max((values[j] - tangent_v).abs(), bend_v);
            }
            j += 1;
        }
        variances[i] += max(BEND_S / dt.s(), 1.0) * (bend_v * bend_v);
        i += 1;
    }
    variances
}

pub(super) const fn cell_v(field: &'static str, voltage_v: Real) -> Result<Real, ParamError> {
    if voltage_v.abs() <= LARGEST_CELL_V {
        Ok(voltage_v)
    } else {
        Err(ParamError::OutOfRange(field))
    }
}

#[expect(clippy::cast_precision_loss, reason = "at most 64")]
const fn intervals(count: usize) -> Real {
    count as Real
}
