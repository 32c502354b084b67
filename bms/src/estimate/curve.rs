//! Checks of an open-circuit curve that an estimator is given.
//!
//! Tests: below.

use plant_core::Real;
use plant_core::battery::OpenCircuit;
use plant_core::check;
use plant_core::error::{ParamError, finite};
use plant_core::num::{SOC_POINTS, SocTable};

/// Intervals of a curve.
pub(crate) const INTERVALS: usize = SOC_POINTS - 1;

/// The curve where it is finite and never falls.
pub(crate) const fn rising(
    field: &'static str,
    curve: OpenCircuit,
) -> Result<OpenCircuit, ParamError> {
    let rises = match &curve {
        OpenCircuit::Linear { empty_v, full_v } => {
            check!(finite(field, *empty_v));
            check!(finite(field, *full_v)) >= *empty_v
        }
        OpenCircuit::Table(table) => table.is_monotone(),
    };
    if rises { Ok(curve) } else { Err(ParamError::Decreasing(field)) }
}

/// The same as a table, whatever its shape.
pub(crate) const fn as_table(
    field: &'static str,
    curve: OpenCircuit,
) -> Result<SocTable, ParamError> {
    match check!(rising(field, curve)) {
        OpenCircuit::Linear { empty_v, full_v } => {
            SocTable::from_points(field, &[(0.0, empty_v), (1.0, full_v)])
        }
        OpenCircuit::Table(table) => Ok(table),
    }
}

/// A curve as the straight line of each of its intervals, `at_zero_v + slope_v·soc`: read in
/// nine instructions instead of the sixteen of the table, for twice its flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tangents {
    at_zero_v: [Real; INTERVALS],
    slope_v: [Real; INTERVALS],
}

impl Tangents {
    #[expect(clippy::cast_precision_loss, reason = "at most 64")]
    pub(crate) const fn of(curve: &SocTable) -> Self {
        let values = curve.values();
        let (mut at_zero_v, mut slope_v) = ([0.0; INTERVALS], [0.0; INTERVALS]);
        let mut i = 0;
        while i < INTERVALS {
            let rise_v = values[i + 1] - values[i];
            at_zero_v[i] = values[i] - rise_v * i as Real;
            slope_v[i] = rise_v * INTERVALS as Real;
            i += 1;
        }
        Self { at_zero_v, slope_v }
    }

    /// Interval, voltage and slope at `soc`; beyond 0..1 on the straight line of the nearer end, so
    /// that the two belong together there too.
    #[inline]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "the interval is held in 0..63"
    )]
    pub(crate) fn at(&self, soc: Real) -> (usize, Real, Real) {
        // Signed, the range is held in one instruction.
        let i = ((soc * INTERVALS as Real) as i32).clamp(0, INTERVALS as i32 - 1) as usize;
        (i, self.at_zero_v[i] + self.slope_v[i] * soc, self.slope_v[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_a_rising_curve_only() {
        let line = |empty_v, full_v| rising("ocv", OpenCircuit::Linear { empty_v, full_v });
        let table = |points: &[(Real, Real)]| {
            rising("ocv", OpenCircuit::Table(SocTable::from_points("t", points).unwrap()))
        };
        assert!(line(3.0, 4.0).is_ok() && line(3.0, 3.0).is_ok());
        assert!(table(&[(0.0, 3.0), (0.5, 3.3), (1.0, 3.3)]).is_ok());
        assert_eq!(line(4.0, 3.0), Err(ParamError::Decreasing("ocv")));
        assert_eq!(table(&[(0.0, 3.0), (1.0, 2.9)]), Err(ParamError::Decreasing("ocv")));
        assert_eq!(line(Real::NAN, 3.0), Err(ParamError::NotFinite("ocv")));
        assert_eq!(line(3.0, Real::INFINITY), Err(ParamError::NotFinite("ocv")));
    }

    #[test]
    fn tangents_lie_on_the_curve() {
        let straight = as_table("ocv", OpenCircuit::Linear { empty_v: 3.0, full_v: 4.0 }).unwrap();
        for soc in [-0.5, 0.0, 0.3, 0.505, 1.0, 1.5] {
            let (interval, voltage_v, slope_v) = Tangents::of(&straight).at(soc);
            assert!((voltage_v - (3.0 + soc)).abs() < 1e-4 && (slope_v - 1.0).abs() < 1e-3);
            assert_eq!(interval, ((soc * 64.0) as usize).min(63));
        }
        // Where it is steep near the full end, the line starts far below.
        let points = [(0.0, 2.5), (0.02, 3.2), (0.9, 3.35), (1.0, 4.2)];
        let bent = SocTable::from_points("t", &points).unwrap();
        for step in 0..=1000_u16 {
            let soc = Real::from(step) / 1000.0;
            assert!((Tangents::of(&bent).at(soc).1 - bent.at(soc)).abs() < 2e-6, "{soc}");
        }
    }
}
