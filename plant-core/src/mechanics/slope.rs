//! The road's slope from height and distance.
//!
//! `sin α = dH/ds` \[EPowertrain2025, eq. 4.20\], over windows of distance, which are ours: they
//! smooth the steps of a quantised height. It holds while the vehicle stands (no division by zero)
//! and is limited. The print's body takes the angle as degrees; here it is never an angle at all.
//!
//! Tests: below; properties `finite`, `refusal`; case "body on a slope".

use crate::error::{ParamError, check, positive, ratio};
use crate::model::impl_model;
use crate::num::{Real, clamp, sane, sqrt};

/// A slope as sine and cosine of its angle, so that no step needs trigonometry. Flat by default.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Grade {
    /// Sine of the angle: height per distance along the road; positive climbs.
    pub sin: Real,
    /// Cosine of the angle, ≥ 0; with the sine, the squares add up to 1.
    pub cos: Real,
}

impl Default for Grade {
    fn default() -> Self {
        Self::FLAT
    }
}

impl Grade {
    /// A flat road.
    pub const FLAT: Self = Self { sin: 0.0, cos: 1.0 };

    /// Steeper ones count as a mistake (a slope in percent, say): 45°, 1 in 1.
    pub(crate) const STEEPEST_COS: Real = 0.7;

    /// Whether this is the sine and the cosine of one angle (to 1 %, so that a cosine of 1 will do
    /// up to 10 %), no steeper than 45°.
    #[inline(always)]
    pub(crate) const fn is_possible(&self) -> bool {
        let off = self.sin * self.sin + self.cos * self.cos - 1.0;
        off.abs() <= 0.01 && self.cos >= Self::STEEPEST_COS
    }

    /// From the sine of the angle, held within −1..1; flat where it is not a number.
    #[must_use]
    pub fn from_sin(sin: Real) -> Self {
        if sin.is_nan() {
            return Self::FLAT;
        }
        let sin = clamp(sin, -1.0, 1.0);
        Self { sin, cos: sqrt(1.0 - sin * sin) }
    }

    /// From height per *horizontal* distance, as road signs give it (0.05 for 5 %).
    #[must_use]
    pub fn from_ratio(ratio: Real) -> Self {
        Self::from_sin(ratio / sqrt(1.0 + ratio * ratio))
    }
}

/// Parameters of a [`Slope`]: how it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SlopeParams {
    /// Distance over which one slope is measured \[m\], above zero: it smooths the steps of a
    /// quantised height.
    pub window_m: Real,
    /// Largest sine of the slope, in 0..1.
    pub largest_sin: Real,
}

/// Slope of the road over windows of distance.
///
/// ```
/// use plant_core::mechanics::slope::{Slope, SlopeInput, SlopeParams, SlopeState};
/// use plant_core::must;
///
/// const SLOPE: Slope =
///     must!(Slope::new(SlopeParams { window_m: 50.0, largest_sin: 0.3 }));
///
/// let mut state = SlopeState::starting_at(300.0, 0.0);
/// let up = SLOPE.step(&mut state, SlopeInput { height_m: 303.0, distance_m: 60.0 });
/// assert!((up.grade.sin - 0.05).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    params: SlopeParams,
}

/// The state of a [`Slope`]: where the last window began, and the slope found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlopeState {
    height_m: Real,
    distance_m: Real,
    grade: Grade,
}

impl SlopeState {
    /// At this height and distance; the road counts as flat until the first window is complete.
    #[must_use]
    pub const fn starting_at(height_m: Real, distance_m: Real) -> Self {
        Self::starting_on(Grade::FLAT, height_m, distance_m)
    }

    /// The same where the slope of the start is known.
    #[must_use]
    pub const fn starting_on(grade: Grade, height_m: Real, distance_m: Real) -> Self {
        Self { height_m, distance_m, grade }
    }
}

/// Input of a [`Slope`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeInput {
    /// Height above any fixed level \[m\].
    pub height_m: Real,
    /// Distance along the road \[m\].
    pub distance_m: Real,
}

/// Output of a [`Slope`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SlopeOutput {
    /// The slope of the last complete window.
    pub grade: Grade,
    /// An input was not finite or absurd; the state is unchanged.
    pub rejected: bool,
}

impl Slope {
    /// Checks `params`.
    ///
    /// # Errors
    /// [`ParamError`] names the first field that is out of range.
    pub const fn new(params: SlopeParams) -> Result<Self, ParamError> {
        check!(positive("slope.window_m", params.window_m));
        check!(ratio("slope.largest_sin", params.largest_sin));
        Ok(Self { params })
    }

    /// Looks at one place.
    #[inline]
    pub fn step(&self, state: &mut SlopeState, input: SlopeInput) -> SlopeOutput {
        let rejected = !(sane(input.height_m) && sane(input.distance_m));
        if !rejected {
            let travelled_m = input.distance_m - state.distance_m;
            if travelled_m.abs() >= self.params.window_m {
                let largest = self.params.largest_sin;
                let sin = clamp((input.height_m - state.height_m) / travelled_m, -largest, largest);
                *state = SlopeState {
                    height_m: input.height_m,
                    distance_m: input.distance_m,
                    grade: Grade::from_sin(sin),
                };
            }
        }
        SlopeOutput { grade: state.grade, rejected }
    }
}

impl_model!(Slope, SlopeState, SlopeInput, SlopeOutput);

#[cfg(test)]
mod tests {
    use super::*;

    const SLOPE: Slope =
        crate::must!(Slope::new(SlopeParams { window_m: 10.0, largest_sin: 0.25 }));

    fn at(state: &mut SlopeState, height_m: Real, distance_m: Real) -> Real {
        SLOPE.step(state, SlopeInput { height_m, distance_m }).grade.sin
    }

    #[test]
    fn finds_a_slope_over_its_window_and_holds_it_at_standstill() {
        let mut s = SlopeState::starting_at(500.0, 0.0);
        assert_eq!(at(&mut s, 500.4, 9.0), 0.0);
        assert!((at(&mut s, 500.5, 10.0) - 0.05).abs() < 1e-5);
        for _ in 0..100 {
            assert!((at(&mut s, 501.0, 10.0) - 0.05).abs() < 1e-5, "no distance, no new slope");
        }
        assert!((at(&mut s, 500.5, 30.0)).abs() < 1e-6);
        // Rolling backwards down is the same slope.
        assert!((at(&mut s, 499.5, 10.0) - 0.05).abs() < 1e-5);
        let mut s = SlopeState::starting_on(Grade::from_sin(0.1), 500.0, 0.0);
        assert_eq!(at(&mut s, 500.4, 9.0), 0.1);
    }

    #[test]
    fn is_limited_and_its_cosine_fits() {
        let mut s = SlopeState::starting_at(0.0, 0.0);
        assert_eq!(at(&mut s, 9.0, 10.0), 0.25);
        let g = Grade::from_ratio(0.75);
        assert!((g.sin - 0.6).abs() < 1e-6 && (g.cos - 0.8).abs() < 1e-6);
        assert_eq!(Grade::from_sin(7.0), Grade { sin: 1.0, cos: 0.0 });
        assert_eq!(Grade::from_sin(Real::NAN), Grade::FLAT);
    }

    #[test]
    fn bad_input_changes_nothing() {
        let mut s = SlopeState::starting_at(0.0, 0.0);
        for (height_m, distance_m) in [(Real::NAN, 20.0), (1.0, Real::INFINITY), (1e38, 20.0)] {
            let out = SLOPE.step(&mut s, SlopeInput { height_m, distance_m });
            assert!(out.rejected && s == SlopeState::starting_at(0.0, 0.0));
        }
    }

    #[test]
    fn refuses_each_bad_field_by_name() {
        let refused = |window_m, largest_sin| Slope::new(SlopeParams { window_m, largest_sin });
        assert_eq!(refused(0.0, 0.2), Err(ParamError::NotPositive("slope.window_m")));
        assert_eq!(refused(1.0, 1.2), Err(ParamError::NotARatio("slope.largest_sin")));
    }
}
