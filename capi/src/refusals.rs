//! Which code belongs to which refused parameter, and the words of every code.

use core::ffi::{CStr, c_char};

use plant_core::ParamError;

use crate::status::VoltstepStatus;

/// The rules as `ParamError::message` has them; a test compares.
macro_rules! rule {
    (NotPositive) => {
        "must be finite and between 1e-12 and 1e12"
    };
    (Negative) => {
        "must be finite, zero or above, and at most 1e12"
    };
    (NotFinite) => {
        "must be finite and between -1e12 and 1e12"
    };
    (NotALimit) => {
        "must be at least 1e-12 (infinity: no limit)"
    };
    (NotARatio) => {
        "must lie in 0..1"
    };
    (NotAnEfficiency) => {
        "must lie above 0 and up to 1"
    };
    (NotAbove) => {
        "must lie above the field that limits it from below"
    };
    (OutOfRange) => {
        "must lie in the range that its documentation gives"
    };
    (Decreasing) => {
        "must not decrease from one entry to the next"
    };
}

#[cfg(feature = "bms")]
pub(crate) use rule;

macro_rules! refusals {
    ($($status:ident: $rule:ident $field:literal,)+) => {
        /// The code of each refused parameter.
        pub(crate) const REFUSALS: &[(VoltstepStatus, ParamError)] =
            &[$((VoltstepStatus::$status, ParamError::$rule($field)),)+];

        /// `field rule`, for C.
        const fn refusal_text(code: u32) -> Option<&'static [u8]> {
            match code {
                $(code if code == VoltstepStatus::$status as u32 => {
                    Some(concat!($field, " ", rule!($rule), "\0").as_bytes())
                })+
                _ => None,
            }
        }
    };
}

refusals! {
    DtS: NotPositive "dt_s",
    Soc: NotARatio "soc",
    SpeedMS: NotFinite "speed_m_s",
    BatteryCapacityAh: NotPositive "battery.capacity_ah",
    BatterySeriesResistanceOhm: NotPositive "battery.series_resistance_ohm",
    BatteryPolarisationResistanceOhm: NotPositive "battery.polarisation.resistance_ohm",
    BatteryPolarisationCapacitanceF: NotPositive "battery.polarisation.capacitance_f",
    BatteryDischargeLimitA: NotALimit "battery.discharge_limit_a",
    BatteryChargeLimitA: NotALimit "battery.charge_limit_a",
    BatteryEmptyV: Negative "battery.open_circuit.linear.empty_v",
    BatteryFullV: NotPositive "battery.open_circuit.linear.full_v",
    BatteryFullVDecreasing: Decreasing "battery.open_circuit.linear.full_v",
    BatteryTableV: NotFinite "battery.open_circuit.table",
    BatteryTableVDecreasing: Decreasing "battery.open_circuit.table",
    BatteryTableVRange: OutOfRange "battery.open_circuit.table",
    AuxiliaryPowerW: Negative "auxiliary.power_w",
    AuxiliaryResistanceOhm: NotALimit "auxiliary.resistance_ohm",
    AuxiliaryCutOutV: NotALimit "auxiliary.cut_out_v",
    ConverterDutyLimit: NotALimit "converter.duty_limit",
    ConverterConstantLossW: Negative "converter.constant_loss_w",
    ConverterVoltageDropV: Negative "converter.voltage_drop_v",
    ConverterResistanceOhm: Negative "converter.resistance_ohm",
    ConverterCurrentLimitA: NotALimit "converter.current_limit_a",
    ConverterVoltageDropVRange: OutOfRange "converter.voltage_drop_v",
    MotorResistanceOhm: NotPositive "motor.resistance_ohm",
    MotorInductanceH: NotPositive "motor.inductance_h",
    MotorBackEmf: NotPositive "motor.back_emf_v_s_per_rad",
    MotorTorquePerA: NotPositive "motor.torque_nm_per_a",
    MotorInertia: NotPositive "motor.inertia_kg_m2",
    MotorViscous: Negative "motor.viscous_nm_s_per_rad",
    MotorCoulombNm: Negative "motor.coulomb_nm",
    GearboxRatio: NotPositive "gearbox.ratio",
    GearboxEfficiency: NotAnEfficiency "gearbox.efficiency",
    GearboxInertia: Negative "gearbox.inertia_kg_m2",
    WheelRadiusM: NotPositive "wheel.radius_m",
    WheelInertia: Negative "wheel.inertia_kg_m2",
    WheelViscous: Negative "wheel.viscous_nm_s_per_rad",
    BodyMassKg: NotPositive "body.mass_kg",
    BodyDragCoefficient: Negative "body.resistance.drag_coefficient",
    BodyFrontalAreaM2: Negative "body.resistance.frontal_area_m2",
    BodyAirDensity: Negative "body.resistance.air_density_kg_m3",
    BodyRollingCoefficient: Negative "body.resistance.rolling_coefficient",
    BodyAN: Negative "body.resistance.a_n",
    BodyBNSPerM: OutOfRange "body.resistance.b_n_s_per_m",
    BodyCNS2PerM2: Negative "body.resistance.c_n_s2_per_m2",
    PidProportional: NotFinite "pid.proportional",
    PidIntegralPerS: Negative "pid.integral_per_s",
    PidDerivativeS: Negative "pid.derivative_s",
    PidDerivativeFilterS: Negative "pid.derivative_filter_s",
    PidDeadZone: Negative "pid.dead_zone",
    PidOutputMin: NotAbove "pid.output_min",
    PidOutputMax: NotAbove "pid.output_max",
    PidSmoothingPerS: NotALimit "pid.smoothing_per_s",
    TorquePeakTorqueNm: NotALimit "driver.torque.peak_torque_nm",
    TorquePeakPowerW: NotALimit "driver.torque.peak_power_w",
    TorqueRegenTorqueNm: Negative "driver.torque.regen_torque_nm",
    TorqueRegenPowerW: NotALimit "driver.torque.regen_power_w",
    TorqueRegenFadeMS: NotPositive "driver.torque.regen_fade_m_s",
    TorqueRegenFadeSoc: NotPositive "driver.torque.regen_fade_soc",
    TorqueBrakeLimitN: NotPositive "driver.torque.brake_limit_n",
    TorqueCurrentRatePerS: NotPositive "driver.torque.current_rate_per_s",
    PmsmFluxMagnetWb: Negative "pmsm.flux.magnet_wb",
    PmsmFluxMagnetWbRange: OutOfRange "pmsm.flux.magnet_wb",
    PmsmFluxDH: NotPositive "pmsm.flux.d_h",
    PmsmFluxQH: NotPositive "pmsm.flux.q_h",
    PmsmResistanceOhm: NotPositive "pmsm.resistance_ohm",
    PmsmResistancePerK: Negative "pmsm.resistance_per_k",
    PmsmResistancePerKRange: OutOfRange "pmsm.resistance_per_k",
    PmsmPolePairs: NotPositive "pmsm.pole_pairs",
    PmsmPolePairsRange: OutOfRange "pmsm.pole_pairs",
    PmsmIronS: Negative "pmsm.iron_s",
    PmsmInertia: NotPositive "pmsm.inertia_kg_m2",
    PmsmViscous: Negative "pmsm.viscous_nm_s_per_rad",
    PmsmCoulombNm: Negative "pmsm.coulomb_nm",
    DriveTorqueRatePerS: NotPositive "drive.torque_rate_per_s",
    DriveTorqueShare: NotPositive "drive.torque_share",
    ThermalCoolantC: NotFinite "thermal.coolant_c",
    ThermalCoolantCRange: OutOfRange "thermal.coolant_c",
    ThermalMachineHeatCapacity: NotALimit "thermal.machine.heat_capacity_j_per_k",
    ThermalMachineCoolantKPerW: NotALimit "thermal.machine.coolant_k_per_w",
    ThermalMachineDerateFromC: OutOfRange "thermal.machine.derate_from_c",
    ThermalMachineDerateToC: NotAbove "thermal.machine.derate_to_c",
    ThermalInverterHeatCapacity: NotALimit "thermal.inverter.heat_capacity_j_per_k",
    ThermalInverterCoolantKPerW: NotALimit "thermal.inverter.coolant_k_per_w",
    ThermalInverterDerateFromC: OutOfRange "thermal.inverter.derate_from_c",
    ThermalInverterDerateToC: NotAbove "thermal.inverter.derate_to_c",
    ThermalReferenceC: OutOfRange "thermal.winding.reference_c",
    ThermalPerK: OutOfRange "thermal.winding.per_k",
    ConverterCurrentLimitAFinite: NotPositive "converter.current_limit_a",
    SocSd: NotARatio "soc_sd",
    TemperatureC: OutOfRange "temperature_c",
    VoltageV: NotFinite "voltage_v",
    CellRefreshS: NotPositive "battery.refresh_s",
    CellHysteresisHalfGapV: Negative "battery.hysteresis.half_gap_v",
    CellHysteresisRatePerSoc: Negative "battery.hysteresis.rate_per_soc",
    CellSeriesResistanceOhm: Negative "battery.series.resistance_ohm",
    CellSeriesActivationK: Negative "battery.series.activation_k",
    CellSeriesActivationKRange: OutOfRange "battery.series.activation_k",
    CellPolarisationResistanceOhm: Negative "battery.polarisation.resistance_ohm",
    CellPolarisationActivationK: Negative "battery.polarisation.activation_k",
    CellPolarisationActivationKRange: OutOfRange "battery.polarisation.activation_k",
    CellPolarisationTimeConstantS: NotPositive "battery.polarisation.time_constant_s",
    CellSecondPolarisationResistanceOhm: Negative "battery.second_polarisation.resistance_ohm",
    CellSecondPolarisationActivationK: Negative "battery.second_polarisation.activation_k",
    CellSecondPolarisationActivationKRange: OutOfRange "battery.second_polarisation.activation_k",
    CellSecondPolarisationTimeConstantS: NotPositive "battery.second_polarisation.time_constant_s",
    CellHeatCapacityJPerK: NotALimit "battery.thermal.heat_capacity_j_per_k",
    CellCoolingWPerK: Negative "battery.thermal.cooling_w_per_k",
    CellAmbientC: OutOfRange "battery.thermal.ambient_c",
    CellSocMin: NotARatio "battery.identified.soc_min",
    CellSocMax: NotARatio "battery.identified.soc_max",
    CellSocMaxNotAbove: NotAbove "battery.identified.soc_max",
    CellTemperatureMinC: OutOfRange "battery.identified.temperature_min_c",
    CellTemperatureMaxC: OutOfRange "battery.identified.temperature_max_c",
    CellTemperatureMaxCNotAbove: NotAbove "battery.identified.temperature_max_c",
    FilterOpenCircuitSdV: NotPositive "ekf.uncertainty.open_circuit_sd_v",
    FilterResistanceSd: Negative "ekf.uncertainty.resistance_sd",
    FilterActivationSdK: Negative "ekf.uncertainty.activation_sd_k",
    FilterCapacitySd: Negative "ekf.uncertainty.capacity_sd",
    FilterCurrentOffsetSdA: Negative "ekf.uncertainty.current_offset_sd_a",
    FilterStandbySdA: Negative "ekf.uncertainty.standby_sd_a",
    FilterVoltageSdV: NotPositive "ekf.uncertainty.voltage_sd_v",
    FilterPolarisationSdV: Negative "ekf.uncertainty.polarisation_sd_v",
    FilterCorrelationSoc: NotPositive "ekf.uncertainty.correlation_soc",
    FilterCorrelationSocRatio: NotARatio "ekf.uncertainty.correlation_soc",
    FilterOutsideFactor: NotPositive "ekf.uncertainty.outside_factor",
    FilterOutsideFactorRange: OutOfRange "ekf.uncertainty.outside_factor",
    FilterFlatVPerSoc: Negative "ekf.flat_v_per_soc",
    FilterConvergedSd: NotAbove "ekf.converged_sd",
    FilterConvergedSdRatio: NotARatio "ekf.converged_sd",
    FilterUnseenCurrentA: NotALimit "ekf.unseen_current_a",
    CounterCapacitySdAh: Negative "coulomb.capacity_sd_ah",
    CounterChargeEfficiency: NotAnEfficiency "coulomb.charge_efficiency",
    CounterOffsetSdA: Negative "coulomb.offset_sd_a",
    CounterGainSd: Negative "coulomb.gain_sd",
    CounterLargestCurrentA: NotPositive "coulomb.largest_current_a",
    CounterRestVoltageSdV: NotPositive "coulomb.rest_voltage_sd_v",
    CounterRestCurrentA: NotPositive "coulomb.rest_current_a",
    CounterRestS: NotPositive "coulomb.rest_s",
    CellsOpenCircuit: OutOfRange "cells.open_circuit",
    CellsNoiseSdV: NotARatio "cells.noise_sd_v",
    CellsNoiseSdVRange: OutOfRange "cells.noise_sd_v",
    CellsOffsetSdV: NotARatio "cells.offset_sd_v",
    CellsResistanceSdOhm: NotARatio "cells.resistance_sd_ohm",
    CellsCapacitySd: NotARatio "cells.capacity_sd",
    CellsSocSd: NotPositive "cells.soc_sd",
    CellsSocSdRatio: NotARatio "cells.soc_sd",
    CellsDriftSdPerDay: NotARatio "cells.drift_sd_per_day",
    CellsPackSocSdMax: NotARatio "cells.pack_soc_sd_max",
    CellsVoltageMinV: OutOfRange "cells.voltage_min_v",
    CellsVoltageMaxV: OutOfRange "cells.voltage_max_v",
    CellsVoltageMaxVNotAbove: NotAbove "cells.voltage_max_v",
    CellResistancesResistanceOhm: NotPositive "cell_resistances.resistance_ohm",
    CellResistancesSpreadSd: NotPositive "cell_resistances.spread_sd",
    CellResistancesNoiseSdV: NotPositive "cell_resistances.noise_sd_v",
    CellResistancesLeastStepA: NotPositive "cell_resistances.least_step_a",
    CellResistancesMemorySteps: NotPositive "cell_resistances.memory_steps",
    CellResistancesMemoryStepsNotAbove: NotAbove "cell_resistances.memory_steps",
    ResistanceVoltageSdV: NotPositive "resistance.voltage_sd_v",
    ResistanceCurrentSdA: NotPositive "resistance.current_sd_a",
    ResistanceLeastStepA: NotPositive "resistance.least_step_a",
    ResistanceMemorySteps: NotPositive "resistance.memory_steps",
    ResistanceMemoryStepsNotAbove: NotAbove "resistance.memory_steps",
    ResistanceInitialSd: NotPositive "resistance.initial_sd",
    ResistanceSkewS: Negative "resistance.skew_s",
    CapacityNominalSdAh: NotPositive "capacity.nominal_sd_ah",
    CapacityCurrentNoiseSdA: Negative "capacity.current_noise_sd_a",
    CapacityCurrentOffsetSdA: NotPositive "capacity.current_offset_sd_a",
    CapacityCurrentGainSd: Negative "capacity.current_gain_sd",
    CapacityLeastSocChange: NotPositive "capacity.least_soc_change",
    CapacityLeastSocChangeSds: NotPositive "capacity.least_soc_change_sds",
    CapacityMemoryPairs: NotPositive "capacity.memory_pairs",
    CapacityMemoryPairsNotAbove: NotAbove "capacity.memory_pairs",
    PowerVoltageMinV: NotPositive "power.voltage_min_v",
    PowerVoltageMaxV: NotFinite "power.voltage_max_v",
    PowerVoltageMaxVNotAbove: NotAbove "power.voltage_max_v",
    PowerSocMin: NotARatio "power.soc_min",
    PowerSocMax: NotARatio "power.soc_max",
    PowerSocMaxNotAbove: NotAbove "power.soc_max",
    PowerMarginSds: Negative "power.margin_sds",
    PowerHorizonsSNotAbove: NotAbove "power.horizons_s",
    PowerHorizonsS: NotPositive "power.horizons_s",
    PowerDischargeWindowNoneBelowC: NotFinite "power.discharge_window.none_below_c",
    PowerDischargeWindowAllFromC: NotFinite "power.discharge_window.all_from_c",
    PowerDischargeWindowAllFromCNotAbove: NotAbove "power.discharge_window.all_from_c",
    PowerDischargeWindowAllToC: NotFinite "power.discharge_window.all_to_c",
    PowerDischargeWindowAllToCNotAbove: NotAbove "power.discharge_window.all_to_c",
    PowerDischargeWindowNoneAboveC: NotFinite "power.discharge_window.none_above_c",
    PowerDischargeWindowNoneAboveCNotAbove: NotAbove "power.discharge_window.none_above_c",
    PowerChargeWindowNoneBelowC: NotFinite "power.charge_window.none_below_c",
    PowerChargeWindowAllFromC: NotFinite "power.charge_window.all_from_c",
    PowerChargeWindowAllFromCNotAbove: NotAbove "power.charge_window.all_from_c",
    PowerChargeWindowAllToC: NotFinite "power.charge_window.all_to_c",
    PowerChargeWindowAllToCNotAbove: NotAbove "power.charge_window.all_to_c",
    PowerChargeWindowNoneAboveC: NotFinite "power.charge_window.none_above_c",
    PowerChargeWindowNoneAboveCNotAbove: NotAbove "power.charge_window.none_above_c",
    EnergyEmptySoc: NotARatio "energy.empty_soc",
    EnergyFullSoc: NotARatio "energy.full_soc",
    EnergyFullSocNotAbove: NotAbove "energy.full_soc",
    EnergyEmptyV: Negative "energy.empty_v",
    EnergyLeastA: NotPositive "energy.least_a",
    RecordSoc: NotARatio "record.soc",
    RecordSocSd: NotARatio "record.soc_sd",
    RecordCapacityAh: NotPositive "record.capacity_ah",
    RecordCapacityAhRange: OutOfRange "record.capacity_ah",
    RecordCapacitySdAh: Negative "record.capacity_sd_ah",
    RecordCapacitySdAhRange: OutOfRange "record.capacity_sd_ah",
    RecordResistanceFactor: Negative "record.resistance_factor",
    RecordResistanceFactorRange: OutOfRange "record.resistance_factor",
    RecordResistanceFactorSd: Negative "record.resistance_factor_sd",
    RecordResistanceFactorSdRange: OutOfRange "record.resistance_factor_sd",
    RecordCurrentOffsetA: Negative "record.current_offset_a",
    RecordCurrentOffsetARange: OutOfRange "record.current_offset_a",
    RecordCurrentOffsetSdA: Negative "record.current_offset_sd_a",
    RecordCurrentOffsetSdARange: OutOfRange "record.current_offset_sd_a",
    RecordThroughputAh: Negative "record.throughput_ah",
    RecordThroughputAhRange: OutOfRange "record.throughput_ah",
    RecordPolarisationBranchesV: Negative "record.polarisation.branches_v",
    RecordPolarisationBranchesVRange: OutOfRange "record.polarisation.branches_v",
    RecordPolarisationLoadA: Negative "record.polarisation.load_a",
    RecordPolarisationLoadARange: OutOfRange "record.polarisation.load_a",
    RecordPolarisationHysteresis: Negative "record.polarisation.hysteresis",
    RecordPolarisationHysteresisRange: OutOfRange "record.polarisation.hysteresis",
    RecordResistorHeatJ: Negative "record.resistor_heat_j",
    RecordResistorHeatJRange: OutOfRange "record.resistor_heat_j",
}

/// The words of the codes that are no parameters.
const OTHERS: &[(VoltstepStatus, &CStr)] = &[
    (VoltstepStatus::Ok, c"ok"),
    (VoltstepStatus::NullPointer, c"a pointer is null"),
    (VoltstepStatus::Misaligned, c"a pointer is not aligned as its type demands"),
    (VoltstepStatus::Overlap, c"two objects of a call share memory"),
    (VoltstepStatus::PlantNotInitialised, c"the plant was not initialised"),
    (VoltstepStatus::StateNotInitialised, c"the state was not initialised"),
    (
        VoltstepStatus::AbiMismatch,
        c"abi is not VOLTSTEP_ABI: not set, or header and library differ",
    ),
    (VoltstepStatus::EstimatorsNotInitialised, c"the estimators were not initialised"),
    (VoltstepStatus::EstimatorsMoved, c"the estimators are a copy, or were moved"),
    (VoltstepStatus::MemoryTooSmall, c"the memory is too small for so many cells"),
    (VoltstepStatus::CellCount, c"no memory for such a number of cells, or not for this one"),
    (VoltstepStatus::CellIndex, c"no cell has this number"),
    (VoltstepStatus::RecordBlank, c"the slot holds no record yet"),
    (VoltstepStatus::RecordUnknown, c"the slot holds no record, or one of another version"),
    (VoltstepStatus::RecordCorrupted, c"the checksum of the record does not fit"),
    (
        VoltstepStatus::InputRejected,
        c"an input was not finite or absurd; what refused it left its state as it was",
    ),
    (VoltstepStatus::StateOfOtherDrives, c"the state was initialised by a plant with other drives"),
    (VoltstepStatus::DutyNotTaken, c"a duty beside a torque, or for drives that take none"),
    (VoltstepStatus::NotBuiltIn, c"the library was built without this kind of drive"),
    (VoltstepStatus::UnknownPreset, c"preset must be one of VoltstepPreset"),
    (VoltstepStatus::UnknownBatteryModel, c"battery.model must be one of VoltstepBatteryModel"),
    (
        VoltstepStatus::UnknownOpenCircuit,
        c"battery.open_circuit must be one of VoltstepOpenCircuit",
    ),
    (VoltstepStatus::UnknownRoadLaw, c"body.road_law must be one of VoltstepRoadLaw"),
    (VoltstepStatus::UnknownDriver, c"driver must be one of VoltstepDriverKind"),
    (VoltstepStatus::UnknownWindup, c"pid.anti_windup must be one of VoltstepWindup"),
    (VoltstepStatus::UnknownCellPreset, c"preset must be one of VoltstepCellPreset"),
    (
        VoltstepStatus::BmsNotInitialised,
        c"the BMS was not initialised, or with another version: voltstep_bms_init",
    ),
    (VoltstepStatus::BmsMoved, c"the BMS is a copy, or was moved: initialise it where it lies"),
    (VoltstepStatus::SensorCount, c"the library was built for another number of temperatures"),
    (VoltstepStatus::UnknownMachine, c"drives.machine must be one of VoltstepMachine"),
    (VoltstepStatus::DriveCount, c"drive_count must lie in 1..4"),
    (
        VoltstepStatus::DriverOfOneDc,
        c"driver must be none or torque: a duty drives one DC machine only",
    ),
    (VoltstepStatus::Parameter, c"a parameter is out of range"),
];

/// The code of a refused parameter.
pub(crate) fn status(error: ParamError) -> VoltstepStatus {
    REFUSALS
        .iter()
        .find(|(_, known)| *known == error)
        .map_or(VoltstepStatus::Parameter, |(status, _)| *status)
}

/// The words of a code: for a parameter, its field and the rule that it broke. The text is static
/// and ends with a zero; for a number that is no code it is "unknown code". Never null.
#[unsafe(no_mangle)]
pub extern "C" fn voltstep_error_message(code: u32) -> *const c_char {
    let other = OTHERS.iter().find(|(status, _)| *status as u32 == code).map(|(_, text)| *text);
    let refusal = || CStr::from_bytes_with_nul(refusal_text(code)?).ok();
    other.or_else(refusal).unwrap_or(c"unknown code").as_ptr()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::format;

    fn words(code: u32) -> &'static str {
        // SAFETY: every message is a static text that ends with a zero.
        unsafe { CStr::from_ptr(voltstep_error_message(code)) }.to_str().unwrap()
    }

    #[test]
    fn the_words_are_those_of_the_models() {
        for (code, error) in REFUSALS {
            assert_eq!(words(*code as u32), format!("{error}"));
            assert_eq!(status(*error), *code);
        }
    }

    #[test]
    fn codes_are_unique_and_others_are_unknown() {
        let mut codes: std::vec::Vec<u32> = REFUSALS.iter().map(|(code, _)| *code as u32).collect();
        codes.extend(OTHERS.iter().map(|(code, _)| *code as u32));
        let count = codes.len();
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), count);
        for code in 0..600 {
            assert_eq!(words(code) == "unknown code", !codes.contains(&code), "{code}");
        }
        assert_eq!(words(u32::MAX), "unknown code");
        assert_eq!(status(ParamError::NotPositive("no.such_field")), VoltstepStatus::Parameter);
    }
}
