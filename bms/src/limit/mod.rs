//! What vehicle and charger may draw and feed, and which of them is heard.
//!
//! The currents that the cells allow ([`PowerLimits`](crate::PowerLimits)), less where a row of the
//! table takes power back, none where one bars a direction or the cold forbids to charge, and never
//! faster than a driver can follow, unless a safety limit forces it.
//!
//! It is ours. Tests: `tests` below.

mod request;

pub use request::{Mode, Request, arbitrate};

use plant_core::error::{check, finite, not_negative, positive, ratio};
use plant_core::num::{clamp, max, min, sane};
use plant_core::{Dt, ParamError, Real};

use crate::protect::{Flow, Table, Trip, Verdict};

/// Parameters of [`Limiter`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LimiterParams {
    /// The largest discharge current of the pack \[A\], above zero.
    pub discharge_a: Real,
    /// The largest charge current of the pack \[A\], above zero.
    pub charge_a: Real,
    /// Cells in parallel, at least 1: what the cells allow is given for one.
    pub parallel: u16,
    /// How fast a limit may fall, as a share of the largest current \[1/s\], above zero. Chosen where
    /// unknown: 0.2, which a driver can follow.
    pub fall_per_s: Real,
    /// How fast it may rise \[1/s\], above zero. Chosen where unknown: 0.05.
    pub rise_per_s: Real,
    /// In which time it falls to nothing before the contactors open \[s\], above zero: no longer than
    /// they wait.
    pub ending_s: Real,
    /// The share that is left where a row takes back power, 0..1. Chosen where unknown: 0.5.
    pub derated: Real,
    /// No charging below \[°C\].
    pub charge_from_c: Real,
    /// What a temperature may be off \[K\], ≥ 0: the coldest sensor may be that much colder.
    pub temperature_error_k: Real,
}

/// Why a limit is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub enum Limited {
    /// By what the cells allow.
    Cells,
    /// By the largest current of the pack.
    Pack,
    /// A row takes back power.
    Derated,
    /// A safety limit of this direction is broken.
    Barred,
    /// Too cold to charge.
    Cold,
    /// What the cells allow, or how warm they are, is not known.
    Unknown,
    /// The contactors are about to open.
    Ending,
    /// The contactors are not closed.
    Open,
    /// It is still on its way from another limit.
    Rate,
}

/// A limit, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Limit {
    /// The current \[A\], ≥ 0.
    pub current_a: Real,
    /// Why.
    pub by: Limited,
}

impl Limit {
    const NONE: Self = Self { current_a: 0.0, by: Limited::Open };
}

/// The limits of a pack; those before the first step allow nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "recorder", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// What may be drawn.
    pub discharge: Limit,
    /// What may be fed.
    pub charge: Limit,
}

impl Limits {
    /// Nothing.
    pub const NONE: Self = Self { discharge: Limit::NONE, charge: Limit::NONE };
}

/// What limits follow from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimiterInput<'a> {
    /// What the weakest cell allows when discharging \[A\], ≥ 0; NaN where it is not known.
    pub cell_discharge_a: Real,
    /// What it allows when charging \[A\], ≥ 0; NaN where it is not known.
    pub cell_charge_a: Real,
    /// The coldest sensor \[°C\]; NaN where it is not known.
    pub coldest_c: Real,
    /// What the rows say.
    pub verdict: &'a Verdict,
    /// Both main contactors are closed.
    pub mains_closed: bool,
    /// They are about to open.
    pub ending: bool,
}

/// Turns what cells allow into limits of the pack.
///
/// ```
/// use voltstep_bms::limit::{Limited, Limiter, LimiterInput, LimiterParams, Limits};
/// use voltstep_bms::protect::{EXAMPLE, Faults, Table, Trip, Verdict};
/// use voltstep_bms::{Dt, must};
///
/// const TABLE: Table = must!(Table::new(EXAMPLE));
/// const LIMITER: Limiter = must!(Limiter::new(
///     LimiterParams {
///         discharge_a: 280.0,
///         charge_a: 100.0,
///         parallel: 20,
///         fall_per_s: 0.2,
///         rise_per_s: 0.05,
///         ending_s: 1.0,
///         derated: 0.5,
///         charge_from_c: 0.0,
///         temperature_error_k: 1.0,
///     },
///     must!(Dt::from_s(0.1))
/// ));
/// let verdict = Verdict {
///     trip: Trip::None,
///     permit: true,
///     tripped: Faults::NONE,
///     latched: Faults::NONE,
///     rose: Faults::NONE,
///     fell: Faults::NONE,
/// };
/// let input = LimiterInput {
///     cell_discharge_a: 10.0,
///     cell_charge_a: 5.0,
///     coldest_c: 0.5, // it may be below zero
///     verdict: &verdict,
///     mains_closed: true,
///     ending: false,
/// };
/// let mut limits = Limits::NONE;
/// for _ in 0..200 {
///     LIMITER.step(&mut limits, &TABLE, &input);
/// }
/// assert_eq!((limits.discharge.current_a, limits.discharge.by), (200.0, Limited::Cells));
/// assert_eq!((limits.charge.current_a, limits.charge.by), (0.0, Limited::Cold));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limiter {
    params: LimiterParams,
    dt_s: Real,
}

impl Limiter {
    /// Checks the parameters, for a call every `dt`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: LimiterParams, dt: Dt) -> Result<Self, ParamError> {
        check!(positive("limiter.discharge_a", params.discharge_a));
        check!(positive("limiter.charge_a", params.charge_a));
        if params.parallel == 0 {
            return Err(ParamError::OutOfRange("limiter.parallel"));
        }
        check!(positive("limiter.fall_per_s", params.fall_per_s));
        check!(positive("limiter.rise_per_s", params.rise_per_s));
        check!(positive("limiter.ending_s", params.ending_s));
        check!(ratio("limiter.derated", params.derated));
        check!(finite("limiter.charge_from_c", params.charge_from_c));
        check!(not_negative("limiter.temperature_error_k", params.temperature_error_k));
        Ok(Self { params, dt_s: dt.s() })
    }

    /// One step of both limits.
    pub fn step(&self, limits: &mut Limits, table: &Table, input: &LimiterInput) {
        self.follow(&mut limits.discharge, Flow::Discharge, table, input);
        self.follow(&mut limits.charge, Flow::Charge, table, input);
    }

    /// Where a limit should be.
    fn target(&self, flow: Flow, table: &Table, input: &LimiterInput) -> Limit {
        let p = &self.params;
        let (cell_a, most_a) = match flow {
            Flow::Discharge => (input.cell_discharge_a, p.discharge_a),
            Flow::Charge => (input.cell_charge_a, p.charge_a),
        };
        let none = |by| Limit { current_a: 0.0, by };
        let surely_warm = input.coldest_c - p.temperature_error_k >= p.charge_from_c;
        if !sane(cell_a) || !sane(input.coldest_c) {
            return none(Limited::Unknown);
        }
        if flow == Flow::Charge && !surely_warm {
            return none(Limited::Cold);
        }
        let allowed_a = max(0.0, cell_a) * Real::from(p.parallel);
        let (current_a, by) =
            if allowed_a < most_a { (allowed_a, Limited::Cells) } else { (most_a, Limited::Pack) };
        if input.verdict.derates(table, flow) {
            return Limit { current_a: p.derated * current_a, by: Limited::Derated };
        }
        Limit { current_a, by }
    }

    fn follow(&self, limit: &mut Limit, flow: Flow, table: &Table, input: &LimiterInput) {
        let p = &self.params;
        // What a safety limit forces, and what nobody feels, comes at once.
        if !input.mains_closed {
            *limit = Limit::NONE;
            return;
        }
        if input.verdict.trip >= Trip::Hard || input.verdict.bars(table, flow) {
            *limit = Limit { current_a: 0.0, by: Limited::Barred };
            return;
        }
        let ending = input.ending || input.verdict.trip == Trip::Soft;
        let (target, fall_per_s) = if ending {
            let none = Limit { current_a: 0.0, by: Limited::Ending };
            (none, max(p.fall_per_s, 1.0 / p.ending_s))
        } else {
            (self.target(flow, table, input), p.fall_per_s)
        };
        let most_a = match flow {
            Flow::Discharge => p.discharge_a,
            Flow::Charge => p.charge_a,
        };
        let wanted_a = target.current_a - limit.current_a;
        let step_a = self.dt_s * most_a;
        let moved_a = clamp(wanted_a, -fall_per_s * step_a, p.rise_per_s * step_a);
        *limit = if (wanted_a - moved_a).abs() > 0.0 {
            Limit { current_a: min(most_a, limit.current_a + moved_a), by: Limited::Rate }
        } else {
            target
        };
    }
}

#[cfg(test)]
mod tests;
