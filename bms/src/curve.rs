//! Checks of an open-circuit curve that an estimator is given.

use plant_core::battery::OpenCircuit;
use plant_core::check;
use plant_core::error::{ParamError, finite};

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

#[cfg(test)]
mod tests {
    use super::*;
    use plant_core::Real;
    use plant_core::num::SocTable;

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
}
