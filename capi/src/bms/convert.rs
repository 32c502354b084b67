//! A description from C's to the BMS's own, and back.

use voltstep_bms::contactor::{ContactorParams, PrechargeParams};
use voltstep_bms::estimate::power::TemperatureWindow;
use voltstep_bms::manage::{Alike, Balancing, BmsParams};
use voltstep_bms::protect::{
    Actuators, CellSheet, Currents, Layout, PackSheet, Sensing, Sensor, VoltageWindow,
};

use super::params::{
    VoltstepBmsActuators, VoltstepBmsAlike, VoltstepBmsBalancing, VoltstepBmsCellSheet,
    VoltstepBmsContactors, VoltstepBmsCurrents, VoltstepBmsLayout, VoltstepBmsParams,
    VoltstepBmsPrecharge, VoltstepBmsSensing, VoltstepBmsSensor, VoltstepBmsSheet,
    VoltstepBmsVoltages,
};
use super::{CELLS, SENSORS};
use crate::estimators::VoltstepTemperatureWindow;
use crate::params::VOLTSTEP_ABI;
use crate::status::VoltstepStatus;

/// Both ways between structs with the same fields.
macro_rules! mirror {
    ($($ours:ident = $theirs:ident { $($field:ident)+ })+) => {$(
        impl From<$theirs> for $ours {
            fn from(from: $theirs) -> Self {
                Self { $($field: from.$field.into(),)+ }
            }
        }
        impl From<$ours> for $theirs {
            fn from(from: $ours) -> Self {
                Self { $($field: from.$field.into(),)+ }
            }
        }
    )+};
}

mirror! {
    VoltstepBmsVoltages = VoltageWindow {
        deep_v absolute_min_v operating_min_v operating_max_v absolute_max_v
    }
    VoltstepBmsCurrents = Currents { continuous_a ten_seconds_a }
    VoltstepTemperatureWindow = TemperatureWindow {
        none_below_c all_from_c all_to_c none_above_c
    }
    VoltstepBmsCellSheet = CellSheet {
        voltage discharge charge discharge_window charge_window capacity_ah resistance_ohm
        heat_capacity_j_per_k
    }
    VoltstepBmsLayout = Layout { series parallel }
    VoltstepBmsSensor = Sensor { error noise_sd resolution period_s lowest highest }
    VoltstepBmsSensing = Sensing { cell_v temperature_c current_a pack_v link_v }
    VoltstepBmsActuators = Actuators { open_s wait_s break_a }
    VoltstepBmsSheet = PackSheet { cell layout sensing actuators tick_s sweep_ticks }
    VoltstepBmsAlike = Alike {
        resistance_ohm resistance_sd capacity_sd soc_sd drift_sd_per_day
    }
    VoltstepBmsPrecharge = PrechargeParams {
        resistor_ohm link_f tau_factor noise_v noise_a done_v count lag_s budget_j short_j cooling_s
    }
    VoltstepBmsContactors = ContactorParams {
        start_limit_s settle_s close_limit_s precharge_limit_s open_limit_s shed_limit_s
        hard_limit_s weld_limit_s cooldown_s tries
    }
    VoltstepBmsBalancing = Balancing { bleed_ohm channels board_max_c }
}

impl VoltstepBmsParams {
    /// As the BMS takes them, for the numbers of cells and temperatures of this library.
    pub(super) fn model(&self) -> Result<BmsParams, VoltstepStatus> {
        if self.abi != VOLTSTEP_ABI {
            return Err(VoltstepStatus::AbiMismatch);
        }
        if usize::from(self.sheet.layout.series) != CELLS {
            return Err(VoltstepStatus::CellCount);
        }
        if self.sensors as usize != SENSORS {
            return Err(VoltstepStatus::SensorCount);
        }
        Ok(BmsParams {
            sheet: self.sheet.into(),
            cell: self.cell.model()?,
            alike: self.alike.into(),
            current_offset_sd_a: self.current_offset_sd_a,
            current_gain_sd: self.current_gain_sd,
            skew_s: self.skew_s,
            sample_s: self.sample_s,
            rest_s: self.rest_s,
            empty_soc: self.empty_soc,
            precharge: self.precharge.into(),
            contactors: self.contactors.into(),
            balancing: self.balancing.into(),
        })
    }
}

impl From<&BmsParams> for VoltstepBmsParams {
    fn from(p: &BmsParams) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "at most 8")]
        let sensors = SENSORS as u32;
        Self {
            abi: VOLTSTEP_ABI,
            sensors,
            sheet: p.sheet.into(),
            cell: (&p.cell).into(),
            alike: p.alike.into(),
            current_offset_sd_a: p.current_offset_sd_a,
            current_gain_sd: p.current_gain_sd,
            skew_s: p.skew_s,
            sample_s: p.sample_s,
            rest_s: p.rest_s,
            empty_soc: p.empty_soc,
            precharge: p.precharge.into(),
            contactors: p.contactors.into(),
            balancing: p.balancing.into(),
        }
    }
}
