//! From C's parameters to the estimators' and back.

use plant_core::ParamError;
use plant_core::battery::{
    BranchMap, HysteresisParams, IdentifiedRange, MappedBatteryParams, OpenCircuit, OverSoc,
    ResistanceMap, ThermalParams, VoltageLimits,
};
use plant_core::num::SocTable;
use voltstep_bms::estimate::cells::{CellResistanceParams, CellsParams};
use voltstep_bms::estimate::coulomb::CoulombParams;
use voltstep_bms::estimate::ekf::{EkfParams, Uncertainty};
use voltstep_bms::estimate::energy::EnergyParams;
use voltstep_bms::estimate::power::{HORIZONS, PowerParams, TemperatureWindow};
use voltstep_bms::estimate::soh::{CapacityParams, ResistanceParams};

use super::params::{
    VOLTSTEP_HORIZONS, VoltstepCapacityParams, VoltstepCellParams, VoltstepCellPreset,
    VoltstepCellResistancesParams, VoltstepCellsParams, VoltstepCounterParams,
    VoltstepEnergyParams, VoltstepEstimatorParams, VoltstepFilterParams, VoltstepPowerParams,
    VoltstepResistanceMap, VoltstepResistanceParams, VoltstepTemperatureWindow,
};
use super::presets::EstimatorParams;
use crate::params::{VOLTSTEP_ABI, VOLTSTEP_SOC_POINTS};
use crate::status::VoltstepStatus;

const _: () = assert!(VOLTSTEP_HORIZONS == HORIZONS);

/// A preset by C's number.
pub(super) fn preset(number: u32) -> Result<VoltstepEstimatorParams, VoltstepStatus> {
    if number == VoltstepCellPreset::PanasonicNcr18650Pf as u32 {
        Ok((&EstimatorParams::PANASONIC_NCR18650PF).into())
    } else {
        Err(VoltstepStatus::UnknownCellPreset)
    }
}

impl VoltstepEstimatorParams {
    /// As the estimators take them. The curve and the capacity of the cell are those of all.
    pub(super) fn models(&self) -> Result<EstimatorParams, VoltstepStatus> {
        if self.abi != VOLTSTEP_ABI {
            return Err(VoltstepStatus::AbiMismatch);
        }
        let battery = self.cell.model()?;
        let (f, n, c) = (&self.filter, &self.counter, &self.cells);
        let (s, r, q) = (&self.cell_resistances, &self.resistance, &self.capacity);
        let (p, e) = (&self.power, &self.energy);
        Ok(EstimatorParams {
            filter: EkfParams {
                battery,
                uncertainty: Uncertainty {
                    open_circuit_sd_v: f.open_circuit_sd_v,
                    resistance_sd: f.resistance_sd,
                    activation_sd_k: f.activation_sd_k,
                    capacity_sd: f.capacity_sd,
                    current_offset_sd_a: f.current_offset_sd_a,
                    standby_sd_a: f.standby_sd_a,
                    voltage_sd_v: f.voltage_sd_v,
                    polarisation_sd_v: f.polarisation_sd_v,
                    correlation_soc: f.correlation_soc,
                    outside_factor: f.outside_factor,
                },
                flat_v_per_soc: f.flat_v_per_soc,
                converged_sd: f.converged_sd,
                unseen_current_a: f.unseen_current_a,
            },
            counter: CoulombParams {
                capacity_ah: battery.capacity_ah,
                capacity_sd_ah: n.capacity_sd_ah,
                charge_efficiency: n.charge_efficiency,
                offset_sd_a: n.offset_sd_a,
                gain_sd: n.gain_sd,
                largest_current_a: n.largest_current_a,
                open_circuit: battery.open_circuit,
                rest_voltage_sd_v: n.rest_voltage_sd_v,
                rest_current_a: n.rest_current_a,
                rest_s: n.rest_s,
            },
            cells: CellsParams {
                open_circuit: battery.open_circuit,
                noise_sd_v: c.noise_sd_v,
                offset_sd_v: c.offset_sd_v,
                resistance_sd_ohm: c.resistance_sd_ohm,
                capacity_sd: c.capacity_sd,
                soc_sd: c.soc_sd,
                drift_sd_per_day: c.drift_sd_per_day,
                pack_soc_sd_max: c.pack_soc_sd_max,
                voltage_min_v: c.voltage_min_v,
                voltage_max_v: c.voltage_max_v,
            },
            cell_resistances: CellResistanceParams {
                resistance_ohm: s.resistance_ohm,
                spread_sd: s.spread_sd,
                noise_sd_v: s.noise_sd_v,
                least_step_a: s.least_step_a,
                memory_steps: s.memory_steps,
            },
            resistance: ResistanceParams {
                voltage_sd_v: r.voltage_sd_v,
                current_sd_a: r.current_sd_a,
                least_step_a: r.least_step_a,
                memory_steps: r.memory_steps,
                initial_sd: r.initial_sd,
                skew_s: r.skew_s,
            },
            capacity: CapacityParams {
                nominal_ah: battery.capacity_ah,
                nominal_sd_ah: q.nominal_sd_ah,
                current_noise_sd_a: q.current_noise_sd_a,
                current_offset_sd_a: q.current_offset_sd_a,
                current_gain_sd: q.current_gain_sd,
                least_soc_change: q.least_soc_change,
                least_soc_change_sds: q.least_soc_change_sds,
                memory_pairs: q.memory_pairs,
            },
            power: PowerParams {
                voltage_min_v: p.voltage_min_v,
                voltage_max_v: p.voltage_max_v,
                soc_min: p.soc_min,
                soc_max: p.soc_max,
                margin_sds: p.margin_sds,
                horizons_s: p.horizons_s,
                discharge_window: p.discharge_window.model(),
                charge_window: p.charge_window.model(),
            },
            energy: EnergyParams {
                empty_soc: e.empty_soc,
                full_soc: e.full_soc,
                empty_v: e.empty_v,
                least_a: e.least_a,
            },
        })
    }
}

impl VoltstepTemperatureWindow {
    const fn model(self) -> TemperatureWindow {
        TemperatureWindow {
            none_below_c: self.none_below_c,
            all_from_c: self.all_from_c,
            all_to_c: self.all_to_c,
            none_above_c: self.none_above_c,
        }
    }
}

impl VoltstepResistanceMap {
    fn model(&self, field: &'static str) -> Result<ResistanceMap, VoltstepStatus> {
        // What is no number breaks the rule of what is negative, too.
        let table = SocTable::new(field, self.ohm).map_err(|_| ParamError::Negative(field))?;
        Ok(ResistanceMap { resistance_ohm: OverSoc::Table(table), activation_k: self.activation_k })
    }

    fn branch(
        &self,
        field: &'static str,
        time_constant_s: f32,
    ) -> Result<BranchMap, VoltstepStatus> {
        let ResistanceMap { resistance_ohm, activation_k } = self.model(field)?;
        Ok(BranchMap { resistance_ohm, activation_k, time_constant_s })
    }
}

impl VoltstepCellParams {
    pub(crate) fn model(&self) -> Result<MappedBatteryParams, VoltstepStatus> {
        let curve = SocTable::new("battery.open_circuit.table", self.open_circuit_v)?;
        Ok(MappedBatteryParams {
            capacity_ah: self.capacity_ah,
            discharge_limit_a: self.discharge_limit_a,
            charge_limit_a: self.charge_limit_a,
            voltage_limits: VoltageLimits::NONE,
            refresh_s: self.refresh_s,
            open_circuit: OpenCircuit::Table(curve),
            hysteresis: HysteresisParams {
                half_gap_v: self.hysteresis_half_gap_v,
                rate_per_soc: self.hysteresis_rate_per_soc,
            },
            series: self.series.model("battery.series.resistance_ohm")?,
            polarisation: self
                .polarisation
                .branch("battery.polarisation.resistance_ohm", self.polarisation_time_constant_s)?,
            second_polarisation: self.second_polarisation.branch(
                "battery.second_polarisation.resistance_ohm",
                self.second_polarisation_time_constant_s,
            )?,
            thermal: ThermalParams {
                heat_capacity_j_per_k: self.heat_capacity_j_per_k,
                cooling_w_per_k: self.cooling_w_per_k,
                ambient_c: self.ambient_c,
            },
            identified: IdentifiedRange {
                soc_min: self.identified_soc_min,
                soc_max: self.identified_soc_max,
                temperature_min_c: self.identified_temperature_min_c,
                temperature_max_c: self.identified_temperature_max_c,
            },
        })
    }
}

/// The points of a curve, at the grid of a table.
fn points(at: impl Fn(f32) -> f32) -> [f32; VOLTSTEP_SOC_POINTS] {
    #[expect(clippy::cast_precision_loss, reason = "at most 64")]
    core::array::from_fn(|i| at(i as f32 / (VOLTSTEP_SOC_POINTS - 1) as f32))
}

impl From<&ResistanceMap> for VoltstepResistanceMap {
    fn from(map: &ResistanceMap) -> Self {
        Self { ohm: points(|soc| map.resistance_ohm.at(soc)), activation_k: map.activation_k }
    }
}

impl From<&MappedBatteryParams> for VoltstepCellParams {
    fn from(b: &MappedBatteryParams) -> Self {
        Self {
            capacity_ah: b.capacity_ah,
            discharge_limit_a: b.discharge_limit_a,
            charge_limit_a: b.charge_limit_a,
            refresh_s: b.refresh_s,
            open_circuit_v: points(|soc| b.open_circuit.at(soc)),
            hysteresis_half_gap_v: b.hysteresis.half_gap_v,
            hysteresis_rate_per_soc: b.hysteresis.rate_per_soc,
            series: (&b.series).into(),
            polarisation: (&b.polarisation.resistance()).into(),
            polarisation_time_constant_s: b.polarisation.time_constant_s,
            second_polarisation: (&b.second_polarisation.resistance()).into(),
            second_polarisation_time_constant_s: b.second_polarisation.time_constant_s,
            heat_capacity_j_per_k: b.thermal.heat_capacity_j_per_k,
            cooling_w_per_k: b.thermal.cooling_w_per_k,
            ambient_c: b.thermal.ambient_c,
            identified_soc_min: b.identified.soc_min,
            identified_soc_max: b.identified.soc_max,
            identified_temperature_min_c: b.identified.temperature_min_c,
            identified_temperature_max_c: b.identified.temperature_max_c,
        }
    }
}

impl From<&TemperatureWindow> for VoltstepTemperatureWindow {
    fn from(w: &TemperatureWindow) -> Self {
        Self {
            none_below_c: w.none_below_c,
            all_from_c: w.all_from_c,
            all_to_c: w.all_to_c,
            none_above_c: w.none_above_c,
        }
    }
}

impl From<&EstimatorParams> for VoltstepEstimatorParams {
    fn from(all: &EstimatorParams) -> Self {
        let (f, u, n) = (&all.filter, &all.filter.uncertainty, &all.counter);
        let (c, s, r) = (&all.cells, &all.cell_resistances, &all.resistance);
        let (q, p, e) = (&all.capacity, &all.power, &all.energy);
        Self {
            abi: VOLTSTEP_ABI,
            cell: (&f.battery).into(),
            filter: VoltstepFilterParams {
                open_circuit_sd_v: u.open_circuit_sd_v,
                resistance_sd: u.resistance_sd,
                activation_sd_k: u.activation_sd_k,
                capacity_sd: u.capacity_sd,
                current_offset_sd_a: u.current_offset_sd_a,
                standby_sd_a: u.standby_sd_a,
                voltage_sd_v: u.voltage_sd_v,
                polarisation_sd_v: u.polarisation_sd_v,
                correlation_soc: u.correlation_soc,
                outside_factor: u.outside_factor,
                flat_v_per_soc: f.flat_v_per_soc,
                converged_sd: f.converged_sd,
                unseen_current_a: f.unseen_current_a,
            },
            counter: VoltstepCounterParams {
                capacity_sd_ah: n.capacity_sd_ah,
                charge_efficiency: n.charge_efficiency,
                offset_sd_a: n.offset_sd_a,
                gain_sd: n.gain_sd,
                largest_current_a: n.largest_current_a,
                rest_voltage_sd_v: n.rest_voltage_sd_v,
                rest_current_a: n.rest_current_a,
                rest_s: n.rest_s,
            },
            cells: VoltstepCellsParams {
                noise_sd_v: c.noise_sd_v,
                offset_sd_v: c.offset_sd_v,
                resistance_sd_ohm: c.resistance_sd_ohm,
                capacity_sd: c.capacity_sd,
                soc_sd: c.soc_sd,
                drift_sd_per_day: c.drift_sd_per_day,
                pack_soc_sd_max: c.pack_soc_sd_max,
                voltage_min_v: c.voltage_min_v,
                voltage_max_v: c.voltage_max_v,
            },
            cell_resistances: VoltstepCellResistancesParams {
                resistance_ohm: s.resistance_ohm,
                spread_sd: s.spread_sd,
                noise_sd_v: s.noise_sd_v,
                least_step_a: s.least_step_a,
                memory_steps: s.memory_steps,
            },
            resistance: VoltstepResistanceParams {
                voltage_sd_v: r.voltage_sd_v,
                current_sd_a: r.current_sd_a,
                least_step_a: r.least_step_a,
                memory_steps: r.memory_steps,
                initial_sd: r.initial_sd,
                skew_s: r.skew_s,
            },
            capacity: VoltstepCapacityParams {
                nominal_sd_ah: q.nominal_sd_ah,
                current_noise_sd_a: q.current_noise_sd_a,
                current_offset_sd_a: q.current_offset_sd_a,
                current_gain_sd: q.current_gain_sd,
                least_soc_change: q.least_soc_change,
                least_soc_change_sds: q.least_soc_change_sds,
                memory_pairs: q.memory_pairs,
            },
            power: VoltstepPowerParams {
                voltage_min_v: p.voltage_min_v,
                voltage_max_v: p.voltage_max_v,
                soc_min: p.soc_min,
                soc_max: p.soc_max,
                margin_sds: p.margin_sds,
                horizons_s: p.horizons_s,
                discharge_window: (&p.discharge_window).into(),
                charge_window: (&p.charge_window).into(),
            },
            energy: VoltstepEnergyParams {
                empty_soc: e.empty_soc,
                full_soc: e.full_soc,
                empty_v: e.empty_v,
                least_a: e.least_a,
            },
        }
    }
}
