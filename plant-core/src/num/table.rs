//! A lookup table over the state of charge.

use super::Real;
use crate::error::{ParamError, check, ratio};

/// Points of a [`SocTable`].
pub const SOC_POINTS: usize = 65;
const INTERVALS: usize = SOC_POINTS - 1;
/// Intervals per unit of the state of charge.
#[expect(clippy::cast_precision_loss, reason = "64")]
const RESOLUTION: Real = INTERVALS as Real;

/// A quantity over the state of charge: 65 points, evenly spaced over 0..1, linear in between.
///
/// The even grid makes a lookup one multiplication and two loads, with no search. Measured
/// points go through [`SocTable::from_points`], which reads their own polyline at the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SocTable {
    values: [Real; SOC_POINTS],
}

impl SocTable {
    /// Takes values at `soc = i/64`, i = 0..64.
    ///
    /// # Errors
    /// [`ParamError::NotFinite`] names `field` where a value is not finite.
    pub const fn new(field: &'static str, values: [Real; SOC_POINTS]) -> Result<Self, ParamError> {
        let mut i = 0;
        while i < SOC_POINTS {
            check!(crate::error::finite(field, values[i]));
            i += 1;
        }
        Ok(Self { values })
    }

    /// Reads the polyline through `points` (state of charge, value) at the grid; constant beyond
    /// its ends.
    ///
    /// # Errors
    /// [`ParamError::NotIncreasing`] unless there are two points at least and the state of charge
    /// rises from each to the next; [`ParamError::NotARatio`] where one lies outside 0..1 (percent,
    /// say); [`ParamError::NotFinite`] for a bad value.
    pub const fn from_points(
        field: &'static str,
        points: &[(Real, Real)],
    ) -> Result<Self, ParamError> {
        let [(first, _), _, ..] = points else { return Err(ParamError::NotIncreasing(field)) };
        check!(ratio(field, *first));
        let mut rest = points;
        while let [(before, _), tail @ ..] = rest
            && let [(after, _), ..] = tail
        {
            if *after <= *before {
                return Err(ParamError::NotIncreasing(field));
            }
            check!(ratio(field, *after));
            rest = tail;
        }
        let mut values = [0.0; SOC_POINTS];
        let (mut rest, mut i) = (points, 0);
        while i < SOC_POINTS {
            #[expect(clippy::cast_precision_loss, reason = "at most 64")]
            let soc = i as Real / INTERVALS as Real;
            while let [_, tail @ ..] = rest
                && let [(x1, _), _, ..] = tail
                && *x1 < soc
            {
                rest = tail;
            }
            let [(x0, y0), (x1, y1), ..] = rest else {
                return Err(ParamError::NotIncreasing(field));
            };
            let along = super::clamp((soc - *x0) / (*x1 - *x0), 0.0, 1.0);
            values[i] = *y0 + along * (*y1 - *y0);
            i += 1;
        }
        Self::new(field, values)
    }

    /// The value at `soc`; outside 0..1 that of the nearer end.
    #[inline]
    #[must_use]
    pub fn at(&self, soc: Real) -> Real {
        let (i, along) = Self::find(soc);
        self.values[i] + along * (self.values[i + 1] - self.values[i])
    }

    /// The interval that holds `soc`, and how far along it is (0..1).
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "the value is held in 0..64 first"
    )]
    fn find(soc: Real) -> (usize, Real) {
        let x = super::clamp(soc, 0.0, 1.0) * RESOLUTION;
        let i = (x as usize).min(INTERVALS - 1);
        (i, x - i as Real)
    }

    /// The value and its slope at `soc`; outside 0..1 those of the nearer end.
    #[inline]
    #[must_use]
    pub fn with_slope(&self, soc: Real) -> (Real, Real) {
        let (i, along) = Self::find(soc);
        let rise = self.values[i + 1] - self.values[i];
        (self.values[i] + along * rise, rise * RESOLUTION)
    }

    /// The mean of the value between two states of charge, in closed form over each interval; as
    /// precise where they are close.
    #[must_use]
    pub fn mean(&self, from: Real, to: Real) -> Real {
        if from > to {
            return self.mean(to, from);
        }
        let ((first, a), (last, b)) = (Self::find(from), Self::find(to));
        let (mut sum, mut width) = (super::Accum::new(0.0), super::Accum::new(0.0));
        for i in first..=last.min(INTERVALS - 1) {
            let low = if i == first { a } else { 0.0 };
            let high = if i == last { b } else { 1.0 };
            let (left, rise) = (self.values[i], self.values[i + 1] - self.values[i]);
            sum.add((high - low) * (left + 0.5 * (low + high) * rise));
            width.add(high - low);
        }
        if width.get() > 0.0 { sum.get() / width.get() } else { self.at(from) }
    }

    /// The values at `soc = i/64`.
    #[must_use]
    pub const fn values(&self) -> &[Real; SOC_POINTS] {
        &self.values
    }

    /// Whether no value is below the one before.
    #[must_use]
    pub const fn is_monotone(&self) -> bool {
        let mut i = 1;
        while i < SOC_POINTS {
            if self.values[i] < self.values[i - 1] {
                return false;
            }
            i += 1;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const KNEE: [(Real, Real); 3] = [(0.0, 300.0), (0.25, 350.0), (1.0, 400.0)];

    #[test]
    fn reads_its_points_and_holds_its_ends() {
        let t = SocTable::from_points("t", &KNEE).unwrap();
        for (soc, v) in [(0.0, 300.0), (0.125, 325.0), (0.25, 350.0), (0.625, 375.0), (1.0, 400.0)]
        {
            assert!((t.at(soc) - v).abs() < 1e-3, "{soc}: {}", t.at(soc));
        }
        assert_eq!((t.at(-1.0), t.at(2.0)), (300.0, 400.0));
        assert!(t.is_monotone());
    }

    #[test]
    fn holds_its_ends_where_the_points_do_not_reach() {
        let t = SocTable::from_points("t", &[(0.25, 1.0), (0.75, 3.0)]).unwrap();
        assert_eq!((t.at(0.0), t.at(0.5), t.at(1.0)), (1.0, 2.0, 3.0));
    }

    #[test]
    fn knows_its_slope() {
        let t = SocTable::from_points("t", &KNEE).unwrap();
        for (soc, slope) in [(-1.0, 200.0), (0.1, 200.0), (0.26, 66.667), (1.0, 66.667)] {
            let (value, found) = t.with_slope(soc);
            assert_eq!(value, t.at(soc));
            assert!((found - slope).abs() < 0.1, "{soc}: {found}");
        }
    }

    #[test]
    fn means_in_closed_form() {
        let t = SocTable::from_points("t", &KNEE).unwrap();
        assert!((t.mean(0.0, 0.25) - 325.0).abs() < 1e-3);
        assert!((t.mean(0.0, 1.0) - (81.25 + 281.25)).abs() < 1e-3);
        assert_eq!(t.mean(0.9, 0.3), t.mean(0.3, 0.9));
        assert!((t.mean(0.301, 0.302) - t.at(0.3015)).abs() < 1e-3);
        assert_eq!(t.mean(0.7, 0.7), t.at(0.7));
    }

    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn any_value_and_any_mean_are_those_of_the_polyline() {
        let points = [(0.0, 1.0), (0.125, 4.0), (0.25, 2.0), (0.5, 2.5), (0.75, 7.0), (1.0, 1.0)];
        let t = SocTable::from_points("t", &points).unwrap();
        let exact = |soc: Real| {
            let soc = soc.clamp(0.0, 1.0);
            let k = (0..4).rfind(|k| points[*k + 1].0 < soc).map_or(0, |k| k + 1);
            let ((x0, y0), (x1, y1)) = (points[k], points[k + 1]);
            y0 + (soc - x0) / (x1 - x0) * (y1 - y0)
        };
        for n in 0..=1000_u16 {
            let soc = -0.1 + 1.2 * Real::from(n) / 1000.0;
            assert!((t.at(soc) - exact(soc)).abs() < 1e-5, "{soc}: {} {}", t.at(soc), exact(soc));
        }
        for n in 0..100_u16 {
            let (from, to) = (Real::from(n) / 100.0, Real::from(n * 37 % 101) / 101.0);
            let middles =
                (0..1000_u16).map(|k| from + (to - from) * (Real::from(k) + 0.5) / 1000.0);
            let mean = middles.map(|soc| f64::from(exact(soc))).sum::<f64>() / 1000.0;
            assert!((f64::from(t.mean(from, to)) - mean).abs() < 1e-4, "{from} {to}");
        }
        assert_eq!(SocTable::new("t", *t.values()), Ok(t));
        assert!(!t.is_monotone());
    }

    #[test]
    fn refuses_bad_points() {
        let bad = |p: &[(Real, Real)]| SocTable::from_points("t", p).unwrap_err();
        assert_eq!(bad(&[(0.0, 1.0)]), ParamError::NotIncreasing("t"));
        assert_eq!(bad(&[(0.0, 1.0), (0.0, 2.0)]), ParamError::NotIncreasing("t"));
        for (from, to) in [(Real::NAN, 1.0), (0.0, Real::NAN), (0.0, 50.0), (-0.1, 1.0)] {
            assert_eq!(bad(&[(from, 1.0), (to, 2.0)]), ParamError::NotARatio("t"), "{from} {to}");
        }
        assert_eq!(bad(&[(0.0, Real::INFINITY), (1.0, 2.0)]), ParamError::NotFinite("t"));
    }
}
