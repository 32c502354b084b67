//! The open-circuit voltage over the state of charge: a straight line
//! `V_oc = empty_v + (full_v − empty_v)·SOC` \[EPowertrain2025, eq. 3.7\], or a table, which is
//! ours.
//!
//! Tests: below; cases "battery", "battery with maps".

use crate::error::{ParamError, check, not_negative, positive};
use crate::num::{Real, SocTable};

/// Open-circuit voltage over the state of charge, never falling as the charge rises.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase", deny_unknown_fields))]
#[expect(clippy::large_enum_variant, reason = "no allocation: the table lives in flash")]
pub enum OpenCircuit {
    /// `V_oc = empty_v + (full_v − empty_v)·SOC` \[EPowertrain2025, eq. 3.7\].
    Linear {
        /// Voltage at SOC 0 \[V\], ≥ 0.
        empty_v: Real,
        /// Voltage at SOC 1 \[V\], above zero and not below `empty_v`.
        full_v: Real,
    },
    /// Measured points on an even grid: none negative, the last above zero.
    Table(SocTable),
}

/// Steps of a bisection over 0..1: finer than what f32 resolves near 1.
const BISECTIONS: u32 = 26;

impl OpenCircuit {
    /// The voltage of an empty battery \[V\], the lowest.
    pub(crate) const fn lowest_v(&self) -> Real {
        match self {
            Self::Linear { empty_v, .. } => *empty_v,
            Self::Table(table) => table.values()[0],
        }
    }

    pub(crate) const fn checked(self) -> Result<Self, ParamError> {
        match &self {
            Self::Linear { empty_v, full_v } => {
                check!(not_negative("battery.open_circuit.linear.empty_v", *empty_v));
                check!(positive("battery.open_circuit.linear.full_v", *full_v));
                if *full_v < *empty_v {
                    return Err(ParamError::Decreasing("battery.open_circuit.linear.full_v"));
                }
            }
            Self::Table(table) => {
                if !table.is_monotone() {
                    return Err(ParamError::Decreasing("battery.open_circuit.table"));
                }
                let [empty_v, .., full_v] = table.values();
                if *empty_v < 0.0 || *full_v <= 0.0 {
                    return Err(ParamError::OutOfRange("battery.open_circuit.table"));
                }
            }
        }
        Ok(self)
    }

    /// The voltage at `soc` \[V\].
    #[inline]
    #[must_use]
    pub fn at(&self, soc: Real) -> Real {
        match self {
            Self::Linear { empty_v, full_v } => empty_v + (full_v - empty_v) * soc,
            Self::Table(table) => table.at(soc),
        }
    }

    /// The voltage at `soc` \[V\], and how fast it rises there \[V per unit of SOC\].
    #[inline]
    #[must_use]
    pub fn with_slope(&self, soc: Real) -> (Real, Real) {
        match self {
            Self::Linear { empty_v, full_v } => (self.at(soc), full_v - empty_v),
            Self::Table(table) => table.with_slope(soc),
        }
    }

    /// The state of charge at which the voltage is `voltage_v`; 0 or 1 beyond the curve's ends, and
    /// within a flat stretch its middle.
    #[must_use]
    pub fn soc_at(&self, voltage_v: Real) -> Real {
        0.5 * (self.first(|v| v >= voltage_v) + self.first(|v| v > voltage_v))
    }

    /// The lowest state of charge whose voltage is `enough`; 1 where none is.
    fn first(&self, enough: impl Fn(Real) -> bool) -> Real {
        let (mut low, mut high) = (0.0, 1.0);
        if enough(self.at(low)) {
            return low;
        }
        // One bit of the answer each.
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if enough(self.at(middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// The mean of the voltage between two states of charge \[V\].
    #[must_use]
    pub fn mean(&self, from: Real, to: Real) -> Real {
        match self {
            Self::Linear { empty_v, full_v } => empty_v + (full_v - empty_v) * 0.5 * (from + to),
            Self::Table(table) => table.mean(from, to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: OpenCircuit = OpenCircuit::Linear { empty_v: 300.0, full_v: 400.0 };

    #[test]
    fn a_line_and_its_table_agree() {
        let table =
            OpenCircuit::Table(SocTable::from_points("t", &[(0.0, 300.0), (1.0, 400.0)]).unwrap());
        for i in 0..=100 {
            let soc = i as Real / 100.0;
            assert!((LINE.at(soc) - table.at(soc)).abs() < 1e-3);
            assert!((LINE.mean(0.3, soc) - table.mean(0.3, soc)).abs() < 1e-3);
        }
        assert!((LINE.mean(0.0, 1.0) - 350.0).abs() < 1e-3);
    }

    #[test]
    fn finds_the_charge_of_a_voltage() {
        const POINTS: [(Real, Real); 4] = [(0.0, 3.0), (0.25, 3.3), (0.75, 3.3), (1.0, 3.5)];
        let curve = OpenCircuit::Table(SocTable::from_points("t", &POINTS).unwrap());
        for curve in [LINE, curve] {
            for soc in [0.0, 0.1, 0.2, 0.8, 0.9, 1.0] {
                let found = curve.soc_at(curve.at(soc));
                assert!((found - soc).abs() < 1e-5, "{soc}: {found}");
            }
        }
        assert!((curve.soc_at(3.3) - 0.5).abs() < 1e-5, "the middle of a flat stretch");
        assert_eq!((curve.soc_at(2.0), curve.soc_at(9.0)), (0.0, 1.0));
        assert_eq!(LINE.with_slope(0.5), (350.0, 100.0));
        assert!((curve.with_slope(0.1).1 - 1.2).abs() < 1e-3);
    }

    #[test]
    fn refuses_a_falling_curve() {
        let line = OpenCircuit::Linear { empty_v: 400.0, full_v: 300.0 };
        assert_eq!(
            line.checked(),
            Err(ParamError::Decreasing("battery.open_circuit.linear.full_v"))
        );
        let flat = OpenCircuit::Linear { empty_v: 300.0, full_v: 300.0 };
        assert_eq!(flat.checked(), Ok(flat));
        let table = SocTable::from_points("t", &[(0.0, 2.0), (1.0, 1.0)]).unwrap();
        assert_eq!(
            OpenCircuit::Table(table).checked(),
            Err(ParamError::Decreasing("battery.open_circuit.table"))
        );
        let line = |empty_v, full_v| OpenCircuit::Linear { empty_v, full_v }.checked();
        let negative = Err(ParamError::Negative("battery.open_circuit.linear.empty_v"));
        assert_eq!((line(Real::NAN, 1.0), line(-10.0, 1.0)), (negative, negative));
        let not_positive = Err(ParamError::NotPositive("battery.open_circuit.linear.full_v"));
        assert_eq!((line(1.0, Real::INFINITY), line(0.0, 0.0)), (not_positive, not_positive));
        for values in [[-1.0, 1.0], [0.0, 0.0]] {
            let points = [(0.0, values[0]), (1.0, values[1])];
            let table = OpenCircuit::Table(SocTable::from_points("t", &points).unwrap());
            assert_eq!(table.checked(), Err(ParamError::OutOfRange("battery.open_circuit.table")));
        }
    }
}
