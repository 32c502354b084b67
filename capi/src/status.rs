//! What a call ended with.

/// What a call ended with; `voltstep_error_message` has the words. Codes from 99 on are
/// parameters: each is one field and the rule that it broke. Numbers do not change between
/// versions; new ones may come.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoltstepStatus {
    /// Done.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A pointer is not aligned as its type demands.
    Misaligned = 2,
    /// Plant and state share memory.
    Overlap = 3,
    /// The plant was not initialised: `voltstep_plant_init`.
    PlantNotInitialised = 4,
    /// The state was not initialised: `voltstep_state_init`.
    StateNotInitialised = 5,
    /// `VoltstepParams.abi` is not `VOLTSTEP_ABI`: not set, or header and library differ.
    AbiMismatch = 6,
    /// An input of the step was not finite or absurd. The outputs say whether the plant or only the
    /// driver refused it; what refused it left its state as it was.
    InputRejected = 10,
    /// No such preset.
    UnknownPreset = 20,
    /// `battery.model` is none of `VoltstepBatteryModel`.
    UnknownBatteryModel = 21,
    /// `battery.open_circuit` is none of `VoltstepOpenCircuit`.
    UnknownOpenCircuit = 22,
    /// `body.road_law` is none of `VoltstepRoadLaw`.
    UnknownRoadLaw = 23,
    /// `driver` is none of `VoltstepDriverKind`.
    UnknownDriver = 24,
    /// `pid.anti_windup` is none of `VoltstepWindup`.
    UnknownWindup = 25,
    /// A parameter is out of range, and this version has no code of its own for it.
    Parameter = 99,
    /// `dt_s` must be finite and between 1e-12 and 1e12.
    DtS = 100,
    /// `soc` must lie in 0..1.
    Soc = 101,
    /// `speed_m_s` must be finite and between -1e12 and 1e12.
    SpeedMS = 102,
    /// `battery.capacity_ah` must be finite and between 1e-12 and 1e12.
    BatteryCapacityAh = 110,
    /// `battery.series_resistance_ohm` must be finite and between 1e-12 and 1e12.
    BatterySeriesResistanceOhm = 111,
    /// `battery.polarisation.resistance_ohm` must be finite and between 1e-12 and 1e12.
    BatteryPolarisationResistanceOhm = 112,
    /// `battery.polarisation.capacitance_f` must be finite and between 1e-12 and 1e12.
    BatteryPolarisationCapacitanceF = 113,
    /// `battery.discharge_limit_a` must be at least 1e-12 (infinity: no limit).
    BatteryDischargeLimitA = 114,
    /// `battery.charge_limit_a` must be at least 1e-12 (infinity: no limit).
    BatteryChargeLimitA = 115,
    /// `battery.open_circuit.linear.empty_v` must be finite, zero or above, and at most 1e12.
    BatteryEmptyV = 116,
    /// `battery.open_circuit.linear.full_v` must be finite and between 1e-12 and 1e12.
    BatteryFullV = 117,
    /// `battery.open_circuit.linear.full_v` must not decrease from one entry to the next.
    BatteryFullVDecreasing = 118,
    /// `battery.open_circuit.table` must be finite and between -1e12 and 1e12.
    BatteryTableV = 119,
    /// `battery.open_circuit.table` must not decrease from one entry to the next.
    BatteryTableVDecreasing = 120,
    /// `auxiliary.power_w` must be finite, zero or above, and at most 1e12.
    AuxiliaryPowerW = 140,
    /// `auxiliary.resistance_ohm` must be at least 1e-12 (infinity: no limit).
    AuxiliaryResistanceOhm = 141,
    /// `auxiliary.cut_out_v` must be at least 1e-12 (infinity: no limit).
    AuxiliaryCutOutV = 142,
    /// `converter.duty_limit` must be at least 1e-12 (infinity: no limit).
    ConverterDutyLimit = 150,
    /// `converter.constant_loss_w` must be finite, zero or above, and at most 1e12.
    ConverterConstantLossW = 151,
    /// `converter.voltage_drop_v` must be finite, zero or above, and at most 1e12.
    ConverterVoltageDropV = 152,
    /// `converter.resistance_ohm` must be finite, zero or above, and at most 1e12.
    ConverterResistanceOhm = 153,
    /// `converter.current_limit_a` must be at least 1e-12 (infinity: no limit).
    ConverterCurrentLimitA = 154,
    /// `motor.resistance_ohm` must be finite and between 1e-12 and 1e12.
    MotorResistanceOhm = 160,
    /// `motor.inductance_h` must be finite and between 1e-12 and 1e12.
    MotorInductanceH = 161,
    /// `motor.back_emf_v_s_per_rad` must be finite and between 1e-12 and 1e12.
    MotorBackEmf = 162,
    /// `motor.torque_nm_per_a` must be finite and between 1e-12 and 1e12.
    MotorTorquePerA = 163,
    /// `motor.inertia_kg_m2` must be finite and between 1e-12 and 1e12.
    MotorInertia = 164,
    /// `motor.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
    MotorViscous = 165,
    /// `motor.coulomb_nm` must be finite, zero or above, and at most 1e12.
    MotorCoulombNm = 166,
    /// `gearbox.ratio` must be finite and between 1e-12 and 1e12.
    GearboxRatio = 170,
    /// `gearbox.efficiency` must lie above 0 and up to 1.
    GearboxEfficiency = 171,
    /// `gearbox.inertia_kg_m2` must be finite, zero or above, and at most 1e12.
    GearboxInertia = 172,
    /// `wheel.radius_m` must be finite and between 1e-12 and 1e12.
    WheelRadiusM = 180,
    /// `wheel.inertia_kg_m2` must be finite, zero or above, and at most 1e12.
    WheelInertia = 181,
    /// `wheel.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
    WheelViscous = 182,
    /// `body.mass_kg` must be finite and between 1e-12 and 1e12.
    BodyMassKg = 190,
    /// `body.resistance.drag_coefficient` must be finite, zero or above, and at most 1e12.
    BodyDragCoefficient = 191,
    /// `body.resistance.frontal_area_m2` must be finite, zero or above, and at most 1e12.
    BodyFrontalAreaM2 = 192,
    /// `body.resistance.air_density_kg_m3` must be finite, zero or above, and at most 1e12.
    BodyAirDensity = 193,
    /// `body.resistance.rolling_coefficient` must be finite, zero or above, and at most 1e12.
    BodyRollingCoefficient = 194,
    /// `body.resistance.a_n` must be finite, zero or above, and at most 1e12.
    BodyAN = 195,
    /// `body.resistance.b_n_s_per_m` must lie in the range that its documentation gives.
    BodyBNSPerM = 196,
    /// `body.resistance.c_n_s2_per_m2` must be finite, zero or above, and at most 1e12.
    BodyCNS2PerM2 = 197,
    /// `pid.proportional` must be finite and between -1e12 and 1e12.
    PidProportional = 210,
    /// `pid.integral_per_s` must be finite, zero or above, and at most 1e12.
    PidIntegralPerS = 211,
    /// `pid.derivative_s` must be finite, zero or above, and at most 1e12.
    PidDerivativeS = 212,
    /// `pid.derivative_filter_s` must be finite, zero or above, and at most 1e12.
    PidDerivativeFilterS = 213,
    /// `pid.dead_zone` must be finite, zero or above, and at most 1e12.
    PidDeadZone = 214,
    /// `pid.output_min` must lie above the field that limits it from below.
    PidOutputMin = 215,
    /// `pid.output_max` must lie above the field that limits it from below.
    PidOutputMax = 216,
    /// `pid.smoothing_per_s` must be at least 1e-12 (infinity: no limit).
    PidSmoothingPerS = 217,
    /// `driver.torque.peak_torque_nm` must be at least 1e-12 (infinity: no limit).
    TorquePeakTorqueNm = 230,
    /// `driver.torque.peak_power_w` must be at least 1e-12 (infinity: no limit).
    TorquePeakPowerW = 231,
    /// `driver.torque.regen_torque_nm` must be finite, zero or above, and at most 1e12.
    TorqueRegenTorqueNm = 232,
    /// `driver.torque.regen_power_w` must be at least 1e-12 (infinity: no limit).
    TorqueRegenPowerW = 233,
    /// `driver.torque.regen_fade_m_s` must be finite and between 1e-12 and 1e12.
    TorqueRegenFadeMS = 234,
    /// `driver.torque.regen_fade_soc` must be finite and between 1e-12 and 1e12.
    TorqueRegenFadeSoc = 235,
    /// `driver.torque.brake_limit_n` must be finite and between 1e-12 and 1e12.
    TorqueBrakeLimitN = 236,
    /// `driver.torque.current_rate_per_s` must be finite and between 1e-12 and 1e12.
    TorqueCurrentRatePerS = 237,
}
