//! A pack made of cells that are all alike, as one battery.
//!
//! n in series carry the same current, m in parallel share it: voltages grow with n, charge and
//! currents with m, resistances with n/m, heat with n·m. The time constants stay.
//!
//! Tests: below; case "cells in series".

use super::{
    BatteryParams, BranchMap, HysteresisParams, MappedBatteryParams, OpenCircuit, OverSoc,
    RcBranchParams, ResistanceMap, ThermalParams, VoltageLimits,
};
use crate::error::{ParamError, check, positive};
use crate::num::{Real, SocTable};

/// n and m, each 1 at least.
const fn counts(series: u16, parallel: u16) -> Result<(Real, Real), ParamError> {
    Ok((
        check!(positive("pack.series", series as Real)),
        check!(positive("pack.parallel", parallel as Real)),
    ))
}

impl OpenCircuit {
    const fn times(&self, factor: Real) -> Result<Self, ParamError> {
        Ok(match self {
            Self::Linear { empty_v, full_v } => {
                Self::Linear { empty_v: *empty_v * factor, full_v: *full_v * factor }
            }
            Self::Table(table) => {
                Self::Table(check!(scaled("battery.open_circuit.table", table, factor)))
            }
        })
    }
}

impl OverSoc {
    const fn times(&self, field: &'static str, factor: Real) -> Result<Self, ParamError> {
        Ok(match self {
            Self::Constant(value) => Self::Constant(*value * factor),
            Self::Table(table) => Self::Table(check!(scaled(field, table, factor))),
        })
    }
}

const fn scaled(
    field: &'static str,
    table: &SocTable,
    factor: Real,
) -> Result<SocTable, ParamError> {
    let (mut values, mut i) = (*table.values(), 0);
    while i < values.len() {
        values[i] *= factor;
        i += 1;
    }
    SocTable::new(field, values)
}

impl VoltageLimits {
    const fn times(self, factor: Real) -> Self {
        Self { lowest_v: self.lowest_v * factor, highest_v: self.highest_v * factor }
    }
}

impl BranchMap {
    const fn times(&self, field: &'static str, factor: Real) -> Result<Self, ParamError> {
        Ok(Self { resistance_ohm: check!(self.resistance_ohm.times(field, factor)), ..*self })
    }
}

impl BatteryParams {
    /// A pack of these cells, `series` of them in series and `parallel` in parallel.
    ///
    /// ```
    /// use plant_core::battery::{Battery, BatteryParams, OpenCircuit, RcBranchParams, VoltageLimits};
    /// use plant_core::{Dt, must};
    ///
    /// const CELL: BatteryParams = BatteryParams {
    ///     open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
    ///     capacity_ah: 3.0,
    ///     series_resistance_ohm: 0.03,
    ///     polarisation: RcBranchParams { resistance_ohm: 0.02, capacitance_f: 500.0 },
    ///     discharge_limit_a: 10.0,
    ///     charge_limit_a: 3.0,
    ///     voltage_limits: VoltageLimits { lowest_v: 2.5, highest_v: 4.2 },
    /// };
    /// const PACK: BatteryParams = must!(CELL.pack(96, 40));
    /// const MODEL: Battery = must!(Battery::new(PACK, must!(Dt::from_s(0.001))));
    /// assert_eq!((PACK.capacity_ah, PACK.discharge_limit_a), (120.0, 400.0));
    /// assert!((PACK.series_resistance_ohm - 0.072).abs() < 1e-6);
    /// ```
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] names the count that is zero; [`ParamError::NotFinite`] a table
    /// whose values become too large. What else does, [`Battery::new`](super::Battery::new) refuses.
    pub const fn pack(self, series: u16, parallel: u16) -> Result<Self, ParamError> {
        let (n, m) = check!(counts(series, parallel));
        Ok(Self {
            open_circuit: check!(self.open_circuit.times(n)),
            capacity_ah: self.capacity_ah * m,
            series_resistance_ohm: self.series_resistance_ohm * (n / m),
            polarisation: RcBranchParams {
                resistance_ohm: self.polarisation.resistance_ohm * (n / m),
                capacitance_f: self.polarisation.capacitance_f * (m / n),
            },
            discharge_limit_a: self.discharge_limit_a * m,
            charge_limit_a: self.charge_limit_a * m,
            voltage_limits: self.voltage_limits.times(n),
        })
    }
}

impl MappedBatteryParams {
    /// A pack of these cells, `series` of them in series and `parallel` in parallel. Each keeps its
    /// own cooling: the pack has n·m times of it.
    ///
    /// ```
    /// use plant_core::battery::{MappedBattery, MappedBatteryParams};
    /// use plant_core::presets::PANASONIC_NCR18650PF;
    /// use plant_core::{Dt, ParamError, must};
    ///
    /// const PACK: MappedBatteryParams = must!(PANASONIC_NCR18650PF.pack(96, 20));
    /// let pack = MappedBattery::new(PACK, Dt::from_s(0.1)?)?;
    /// let rest_v = pack.offer(&pack.rested(0.5)?).0.emf_v;
    /// assert!((345.0..360.0).contains(&rest_v));
    /// # Ok::<(), ParamError>(())
    /// ```
    ///
    /// # Errors
    /// [`ParamError::NotPositive`] names the count that is zero; [`ParamError::NotFinite`] a table
    /// whose values become too large. What else does,
    /// [`MappedBattery::new`](super::MappedBattery::new) refuses.
    pub const fn pack(self, series: u16, parallel: u16) -> Result<Self, ParamError> {
        let (n, m) = check!(counts(series, parallel));
        Ok(Self {
            capacity_ah: self.capacity_ah * m,
            discharge_limit_a: self.discharge_limit_a * m,
            charge_limit_a: self.charge_limit_a * m,
            voltage_limits: self.voltage_limits.times(n),
            refresh_s: self.refresh_s,
            open_circuit: check!(self.open_circuit.times(n)),
            hysteresis: HysteresisParams {
                half_gap_v: self.hysteresis.half_gap_v * n,
                rate_per_soc: self.hysteresis.rate_per_soc,
            },
            series: ResistanceMap {
                resistance_ohm: check!(
                    self.series.resistance_ohm.times("battery.series.resistance_ohm", n / m)
                ),
                activation_k: self.series.activation_k,
            },
            polarisation: check!(
                self.polarisation.times("battery.polarisation.resistance_ohm", n / m)
            ),
            second_polarisation: check!(
                self.second_polarisation.times("battery.second_polarisation.resistance_ohm", n / m)
            ),
            thermal: ThermalParams {
                heat_capacity_j_per_k: self.thermal.heat_capacity_j_per_k * n * m,
                cooling_w_per_k: self.thermal.cooling_w_per_k * n * m,
                ambient_c: self.thermal.ambient_c,
            },
            identified: self.identified,
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::battery::{Battery, BatteryInput, BatteryState, MappedBattery, MappedBatteryInput};
    use crate::model::Dt;
    use crate::presets::{BMW_I3_60AH_CONSTANT, PANASONIC_NCR18650PF};

    const DT: Dt = crate::must!(Dt::from_s(0.5));
    const CELL: BatteryParams = BatteryParams {
        open_circuit: OpenCircuit::Linear { empty_v: 3.0, full_v: 4.2 },
        capacity_ah: 3.0,
        series_resistance_ohm: 0.03,
        polarisation: RcBranchParams { resistance_ohm: 0.02, capacitance_f: 500.0 },
        discharge_limit_a: 10.0,
        charge_limit_a: 3.0,
        voltage_limits: VoltageLimits { lowest_v: 3.2, highest_v: 4.1 },
    };

    /// A pack does what one of its cells does, n times the voltage at m times the current, limits of
    /// current and voltage included.
    #[test]
    fn a_pack_does_what_its_cells_do() {
        let (n, m) = (12.0, 5.0);
        let cell = Battery::new(CELL, DT).unwrap();
        let pack = Battery::new(CELL.pack(12, 5).unwrap(), DT).unwrap();
        let (mut c, mut p) =
            (BatteryState::rested(0.5).unwrap(), BatteryState::rested(0.5).unwrap());
        for k in 0..4000 {
            let current_a = [8.0, 15.0, -5.0, 2.0][k / 1000];
            let one = cell.step(&mut c, BatteryInput { current_a });
            let all = pack.step(&mut p, BatteryInput { current_a: m * current_a });
            assert!((all.terminal_v / n - one.terminal_v).abs() < 1e-5, "{k}: {one:?} {all:?}");
            assert!((all.current_a / m - one.current_a).abs() < 1e-4, "{k}: {one:?} {all:?}");
            assert!((all.heat_w / (n * m) - one.heat_w).abs() < 1e-4 * (1.0 + one.heat_w));
            assert!((all.soc - one.soc).abs() < 1e-6);
        }
        assert!(c.soc.get() < 0.3, "it went down to the voltage limit: {c:?}");
    }

    /// The same of a cell with maps, its temperature included.
    #[test]
    #[cfg_attr(miri, ignore = "too many steps for an interpreter")]
    fn a_pack_warms_as_its_cells_do() {
        let thermal =
            ThermalParams { heat_capacity_j_per_k: 45.0, cooling_w_per_k: 0.2, ambient_c: 10.0 };
        let hysteresis = HysteresisParams { half_gap_v: 0.02, rate_per_soc: 50.0 };
        let params = MappedBatteryParams { hysteresis, thermal, ..PANASONIC_NCR18650PF };
        let cell = MappedBattery::new(params, DT).unwrap();
        let pack = MappedBattery::new(params.pack(96, 30).unwrap(), DT).unwrap();
        let (mut c, mut p) = (cell.rested(0.9).unwrap(), pack.rested(0.9).unwrap());
        for k in 0..2000 {
            let current_a = if k % 400 < 300 { 6.0 } else { -2.0 };
            let one = cell.step(&mut c, MappedBatteryInput { current_a });
            let all = pack.step(&mut p, MappedBatteryInput { current_a: 30.0 * current_a });
            assert!((all.terminal_v / 96.0 - one.terminal_v).abs() < 2e-5, "{k}: {one:?} {all:?}");
            assert!((all.temperature_c - one.temperature_c).abs() < 1e-3, "{k}: {one:?} {all:?}");
        }
        assert!(c.temperature_c.get() > 12.0 && c.soc.get() < 0.6, "{c:?}");
    }

    /// Infinite limits stay infinite, and 1 × 1 changes nothing.
    #[test]
    fn one_cell_is_itself() {
        for cell in [CELL, BMW_I3_60AH_CONSTANT.powertrain.battery] {
            assert_eq!(cell.pack(1, 1), Ok(cell));
        }
        assert_eq!(PANASONIC_NCR18650PF.pack(1, 1), Ok(PANASONIC_NCR18650PF));
        let none = BatteryParams {
            voltage_limits: VoltageLimits::NONE,
            discharge_limit_a: Real::INFINITY,
            ..CELL
        };
        let pack = none.pack(96, 2).unwrap();
        assert_eq!(pack.voltage_limits, VoltageLimits::NONE);
        assert_eq!(pack.discharge_limit_a, Real::INFINITY);
    }

    #[test]
    fn refuses_no_cells_by_name() {
        let (series, parallel) = ("pack.series", "pack.parallel");
        assert_eq!(CELL.pack(0, 1), Err(ParamError::NotPositive(series)));
        assert_eq!(CELL.pack(1, 0), Err(ParamError::NotPositive(parallel)));
        let cell = PANASONIC_NCR18650PF;
        assert_eq!(cell.pack(0, 1), Err(ParamError::NotPositive(series)));
        assert_eq!(cell.pack(1, 0), Err(ParamError::NotPositive(parallel)));
        let huge = SocTable::new("t", [1e10; 65]).unwrap();
        let huge = BatteryParams { open_circuit: OpenCircuit::Table(huge), ..CELL };
        assert_eq!(huge.pack(1000, 1), Err(ParamError::NotFinite("battery.open_circuit.table")));
    }
}
