//! Checks of an open-circuit curve that an estimator is given.

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

/// Interval, voltage and slope at `soc`; beyond 0..1 on the straight line of the nearer end, so that the two
/// belong together there too.
#[inline]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "the interval is held in 0..63; a conversion holds what is below at 0"
)]
pub(crate) fn tangent(table: &SocTable, soc: Real) -> (usize, Real, Real) {
    let x = soc * INTERVALS as Real;
    let i = (x as usize).min(INTERVALS - 1);
    let low_v = table.values()[i];
    let rise_v = table.values()[i + 1] - low_v;
    (i, low_v + rise_v * (x - i as Real), rise_v * INTERVALS as Real)
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
        let bent = as_table("ocv", OpenCircuit::Linear { empty_v: 3.0, full_v: 4.0 }).unwrap();
        for soc in [-0.5, 0.0, 0.3, 0.505, 1.0, 1.5] {
            let (interval, voltage_v, slope_v) = tangent(&bent, soc);
            assert!((voltage_v - (3.0 + soc)).abs() < 1e-4 && (slope_v - 1.0).abs() < 1e-3);
            assert_eq!(interval, ((soc * 64.0) as usize).min(63));
        }
        assert_eq!(line(4.0, 3.0), Err(ParamError::Decreasing("ocv")));
        assert_eq!(table(&[(0.0, 3.0), (1.0, 2.9)]), Err(ParamError::Decreasing("ocv")));
        assert_eq!(line(Real::NAN, 3.0), Err(ParamError::NotFinite("ocv")));
        assert_eq!(line(3.0, Real::INFINITY), Err(ParamError::NotFinite("ocv")));
    }
}
