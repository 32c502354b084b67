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
    /// Two objects of a call share memory.
    Overlap = 3,
    /// The plant was not initialised: `voltstep_plant_init`.
    PlantNotInitialised = 4,
    /// The state was not initialised: `voltstep_state_init`, or the estimator's `..._start`.
    StateNotInitialised = 5,
    /// The params' `abi` is not `VOLTSTEP_ABI`: not set, or header and library differ.
    AbiMismatch = 6,
    /// The estimators were not initialised: `voltstep_estimators_init`.
    EstimatorsNotInitialised = 7,
    /// The estimators are a copy, or were moved: initialise them where they lie.
    EstimatorsMoved = 8,
    /// The memory is too small for so many cells.
    MemoryTooSmall = 9,
    /// An input of the step was not finite or absurd. The outputs say whether the plant or only the
    /// driver refused it; what refused it left its state as it was.
    InputRejected = 10,
    /// No memory of cells in series for such a number of cells, or not for this one.
    CellCount = 11,
    /// No cell has this number.
    CellIndex = 12,
    /// The slot is erased: it holds no record yet.
    RecordBlank = 13,
    /// What the slot holds is no record, or one of another version.
    RecordUnknown = 14,
    /// The checksum of the record does not fit: a torn write, or memory gone bad.
    RecordCorrupted = 15,
    /// The state was initialised by a plant with other drives.
    StateOfOtherDrives = 16,
    /// A duty beside a torque, or for drives that take none: only one DC drive does.
    DutyNotTaken = 17,
    /// The library was built without this kind of drive: the features `pmsm`, `drives`.
    NotBuiltIn = 18,
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
    /// No such preset of a cell.
    UnknownCellPreset = 26,
    /// `drives.machine` is none of `VoltstepMachine`.
    UnknownMachine = 27,
    /// `drive_count` is not in 1..`VOLTSTEP_DRIVES`.
    DriveCount = 28,
    /// `driver` is a duty's, which drives one DC machine only.
    DriverOfOneDc = 29,
    /// The BMS was not initialised: `voltstep_bms_init`.
    BmsNotInitialised = 30,
    /// The BMS is a copy, or was moved: initialise it where it lies.
    BmsMoved = 31,
    /// The library was built for a BMS with another number of temperatures.
    SensorCount = 32,
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
    /// `battery.open_circuit.table` must lie in the range that its documentation gives.
    BatteryTableVRange = 121,
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
    /// `converter.voltage_drop_v` must lie in the range that its documentation gives.
    ConverterVoltageDropVRange = 155,
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
    /// `pmsm.flux.magnet_wb` must be finite, zero or above, and at most 1e12.
    PmsmFluxMagnetWb = 240,
    /// `pmsm.flux.magnet_wb` must lie in the range that its documentation gives.
    PmsmFluxMagnetWbRange = 241,
    /// `pmsm.flux.d_h` must be finite and between 1e-12 and 1e12.
    PmsmFluxDH = 242,
    /// `pmsm.flux.q_h` must be finite and between 1e-12 and 1e12.
    PmsmFluxQH = 243,
    /// `pmsm.resistance_ohm` must be finite and between 1e-12 and 1e12.
    PmsmResistanceOhm = 244,
    /// `pmsm.resistance_per_k` must be finite, zero or above, and at most 1e12.
    PmsmResistancePerK = 245,
    /// `pmsm.resistance_per_k` must lie in the range that its documentation gives.
    PmsmResistancePerKRange = 246,
    /// `pmsm.pole_pairs` must be finite and between 1e-12 and 1e12.
    PmsmPolePairs = 247,
    /// `pmsm.pole_pairs` must lie in the range that its documentation gives.
    PmsmPolePairsRange = 248,
    /// `pmsm.iron_s` must be finite, zero or above, and at most 1e12.
    PmsmIronS = 249,
    /// `pmsm.inertia_kg_m2` must be finite and between 1e-12 and 1e12.
    PmsmInertia = 250,
    /// `pmsm.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
    PmsmViscous = 251,
    /// `pmsm.coulomb_nm` must be finite, zero or above, and at most 1e12.
    PmsmCoulombNm = 252,
    /// `drive.torque_rate_per_s` must be finite and between 1e-12 and 1e12.
    DriveTorqueRatePerS = 260,
    /// `drive.torque_share` must be finite and between 1e-12 and 1e12.
    DriveTorqueShare = 261,
    /// `thermal.coolant_c` must be finite and between -1e12 and 1e12.
    ThermalCoolantC = 270,
    /// `thermal.coolant_c` must lie in the range that its documentation gives.
    ThermalCoolantCRange = 271,
    /// `thermal.machine.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
    ThermalMachineHeatCapacity = 272,
    /// `thermal.machine.coolant_k_per_w` must be at least 1e-12 (infinity: no limit).
    ThermalMachineCoolantKPerW = 273,
    /// `thermal.machine.derate_from_c` must lie in the range that its documentation gives.
    ThermalMachineDerateFromC = 274,
    /// `thermal.machine.derate_to_c` must lie above the field that limits it from below.
    ThermalMachineDerateToC = 275,
    /// `thermal.inverter.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
    ThermalInverterHeatCapacity = 276,
    /// `thermal.inverter.coolant_k_per_w` must be at least 1e-12 (infinity: no limit).
    ThermalInverterCoolantKPerW = 277,
    /// `thermal.inverter.derate_from_c` must lie in the range that its documentation gives.
    ThermalInverterDerateFromC = 278,
    /// `thermal.inverter.derate_to_c` must lie above the field that limits it from below.
    ThermalInverterDerateToC = 279,
    /// `thermal.winding.reference_c` must lie in the range that its documentation gives.
    ThermalReferenceC = 280,
    /// `thermal.winding.per_k` must lie in the range that its documentation gives.
    ThermalPerK = 281,
    /// `converter.current_limit_a` must be finite and between 1e-12 and 1e12: of a drive that may be derated.
    ConverterCurrentLimitAFinite = 282,
    /// `soc_sd` must lie in 0..1.
    SocSd = 300,
    /// `temperature_c` must lie in the range that its documentation gives.
    TemperatureC = 301,
    /// `voltage_v` must be finite and between -1e12 and 1e12.
    VoltageV = 302,
    /// `battery.refresh_s` must be finite and between 1e-12 and 1e12.
    CellRefreshS = 310,
    /// `battery.hysteresis.half_gap_v` must be finite, zero or above, and at most 1e12.
    CellHysteresisHalfGapV = 311,
    /// `battery.hysteresis.rate_per_soc` must be finite, zero or above, and at most 1e12.
    CellHysteresisRatePerSoc = 312,
    /// `battery.series.resistance_ohm` must be finite, zero or above, and at most 1e12.
    CellSeriesResistanceOhm = 313,
    /// `battery.series.activation_k` must be finite, zero or above, and at most 1e12.
    CellSeriesActivationK = 314,
    /// `battery.series.activation_k` must lie in the range that its documentation gives.
    CellSeriesActivationKRange = 315,
    /// `battery.polarisation.resistance_ohm` must be finite, zero or above, and at most 1e12.
    CellPolarisationResistanceOhm = 316,
    /// `battery.polarisation.activation_k` must be finite, zero or above, and at most 1e12.
    CellPolarisationActivationK = 317,
    /// `battery.polarisation.activation_k` must lie in the range that its documentation gives.
    CellPolarisationActivationKRange = 318,
    /// `battery.polarisation.time_constant_s` must be finite and between 1e-12 and 1e12.
    CellPolarisationTimeConstantS = 319,
    /// `battery.second_polarisation.resistance_ohm` must be finite, zero or above, and at most
    /// 1e12.
    CellSecondPolarisationResistanceOhm = 320,
    /// `battery.second_polarisation.activation_k` must be finite, zero or above, and at most 1e12.
    CellSecondPolarisationActivationK = 321,
    /// `battery.second_polarisation.activation_k` must lie in the range that its documentation
    /// gives.
    CellSecondPolarisationActivationKRange = 322,
    /// `battery.second_polarisation.time_constant_s` must be finite and between 1e-12 and 1e12.
    CellSecondPolarisationTimeConstantS = 323,
    /// `battery.thermal.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
    CellHeatCapacityJPerK = 324,
    /// `battery.thermal.cooling_w_per_k` must be finite, zero or above, and at most 1e12.
    CellCoolingWPerK = 325,
    /// `battery.thermal.ambient_c` must lie in the range that its documentation gives.
    CellAmbientC = 326,
    /// `battery.identified.soc_min` must lie in 0..1.
    CellSocMin = 327,
    /// `battery.identified.soc_max` must lie in 0..1.
    CellSocMax = 328,
    /// `battery.identified.soc_max` must lie above the field that limits it from below.
    CellSocMaxNotAbove = 329,
    /// `battery.identified.temperature_min_c` must lie in the range that its documentation gives.
    CellTemperatureMinC = 330,
    /// `battery.identified.temperature_max_c` must lie in the range that its documentation gives.
    CellTemperatureMaxC = 331,
    /// `battery.identified.temperature_max_c` must lie above the field that limits it from below.
    CellTemperatureMaxCNotAbove = 332,
    /// `ekf.uncertainty.open_circuit_sd_v` must be finite and between 1e-12 and 1e12.
    FilterOpenCircuitSdV = 340,
    /// `ekf.uncertainty.resistance_sd` must be finite, zero or above, and at most 1e12.
    FilterResistanceSd = 341,
    /// `ekf.uncertainty.activation_sd_k` must be finite, zero or above, and at most 1e12.
    FilterActivationSdK = 342,
    /// `ekf.uncertainty.capacity_sd` must be finite, zero or above, and at most 1e12.
    FilterCapacitySd = 343,
    /// `ekf.uncertainty.current_offset_sd_a` must be finite, zero or above, and at most 1e12.
    FilterCurrentOffsetSdA = 344,
    /// `ekf.uncertainty.standby_sd_a` must be finite, zero or above, and at most 1e12.
    FilterStandbySdA = 345,
    /// `ekf.uncertainty.voltage_sd_v` must be finite and between 1e-12 and 1e12.
    FilterVoltageSdV = 346,
    /// `ekf.uncertainty.polarisation_sd_v` must be finite, zero or above, and at most 1e12.
    FilterPolarisationSdV = 347,
    /// `ekf.uncertainty.correlation_soc` must be finite and between 1e-12 and 1e12.
    FilterCorrelationSoc = 348,
    /// `ekf.uncertainty.correlation_soc` must lie in 0..1.
    FilterCorrelationSocRatio = 349,
    /// `ekf.uncertainty.outside_factor` must be finite and between 1e-12 and 1e12.
    FilterOutsideFactor = 350,
    /// `ekf.uncertainty.outside_factor` must lie in the range that its documentation gives.
    FilterOutsideFactorRange = 351,
    /// `ekf.flat_v_per_soc` must be finite, zero or above, and at most 1e12.
    FilterFlatVPerSoc = 352,
    /// `ekf.converged_sd` must lie above the field that limits it from below.
    FilterConvergedSd = 353,
    /// `ekf.converged_sd` must lie in 0..1.
    FilterConvergedSdRatio = 354,
    /// `ekf.unseen_current_a` must be at least 1e-12 (infinity: no limit).
    FilterUnseenCurrentA = 355,
    /// `coulomb.capacity_sd_ah` must be finite, zero or above, and at most 1e12.
    CounterCapacitySdAh = 360,
    /// `coulomb.charge_efficiency` must lie above 0 and up to 1.
    CounterChargeEfficiency = 361,
    /// `coulomb.offset_sd_a` must be finite, zero or above, and at most 1e12.
    CounterOffsetSdA = 362,
    /// `coulomb.gain_sd` must be finite, zero or above, and at most 1e12.
    CounterGainSd = 363,
    /// `coulomb.largest_current_a` must be finite and between 1e-12 and 1e12.
    CounterLargestCurrentA = 364,
    /// `coulomb.rest_voltage_sd_v` must be finite and between 1e-12 and 1e12.
    CounterRestVoltageSdV = 365,
    /// `coulomb.rest_current_a` must be finite and between 1e-12 and 1e12.
    CounterRestCurrentA = 366,
    /// `coulomb.rest_s` must be finite and between 1e-12 and 1e12.
    CounterRestS = 367,
    /// `cells.open_circuit` must lie in the range that its documentation gives.
    CellsOpenCircuit = 370,
    /// `cells.noise_sd_v` must lie in 0..1.
    CellsNoiseSdV = 371,
    /// `cells.noise_sd_v` must lie in the range that its documentation gives.
    CellsNoiseSdVRange = 372,
    /// `cells.offset_sd_v` must lie in 0..1.
    CellsOffsetSdV = 373,
    /// `cells.resistance_sd_ohm` must lie in 0..1.
    CellsResistanceSdOhm = 374,
    /// `cells.capacity_sd` must lie in 0..1.
    CellsCapacitySd = 375,
    /// `cells.soc_sd` must be finite and between 1e-12 and 1e12.
    CellsSocSd = 376,
    /// `cells.soc_sd` must lie in 0..1.
    CellsSocSdRatio = 377,
    /// `cells.drift_sd_per_day` must lie in 0..1.
    CellsDriftSdPerDay = 378,
    /// `cells.pack_soc_sd_max` must lie in 0..1.
    CellsPackSocSdMax = 379,
    /// `cells.voltage_min_v` must lie in the range that its documentation gives.
    CellsVoltageMinV = 380,
    /// `cells.voltage_max_v` must lie in the range that its documentation gives.
    CellsVoltageMaxV = 381,
    /// `cells.voltage_max_v` must lie above the field that limits it from below.
    CellsVoltageMaxVNotAbove = 382,
    /// `cell_resistances.resistance_ohm` must be finite and between 1e-12 and 1e12.
    CellResistancesResistanceOhm = 390,
    /// `cell_resistances.spread_sd` must be finite and between 1e-12 and 1e12.
    CellResistancesSpreadSd = 391,
    /// `cell_resistances.noise_sd_v` must be finite and between 1e-12 and 1e12.
    CellResistancesNoiseSdV = 392,
    /// `cell_resistances.least_step_a` must be finite and between 1e-12 and 1e12.
    CellResistancesLeastStepA = 393,
    /// `cell_resistances.memory_steps` must be finite and between 1e-12 and 1e12.
    CellResistancesMemorySteps = 394,
    /// `cell_resistances.memory_steps` must lie above the field that limits it from below.
    CellResistancesMemoryStepsNotAbove = 395,
    /// `resistance.voltage_sd_v` must be finite and between 1e-12 and 1e12.
    ResistanceVoltageSdV = 400,
    /// `resistance.current_sd_a` must be finite and between 1e-12 and 1e12.
    ResistanceCurrentSdA = 401,
    /// `resistance.least_step_a` must be finite and between 1e-12 and 1e12.
    ResistanceLeastStepA = 402,
    /// `resistance.memory_steps` must be finite and between 1e-12 and 1e12.
    ResistanceMemorySteps = 403,
    /// `resistance.memory_steps` must lie above the field that limits it from below.
    ResistanceMemoryStepsNotAbove = 404,
    /// `resistance.initial_sd` must be finite and between 1e-12 and 1e12.
    ResistanceInitialSd = 405,
    /// `resistance.skew_s` must be finite, zero or above, and at most 1e12.
    ResistanceSkewS = 406,
    /// `capacity.nominal_sd_ah` must be finite and between 1e-12 and 1e12.
    CapacityNominalSdAh = 410,
    /// `capacity.current_noise_sd_a` must be finite, zero or above, and at most 1e12.
    CapacityCurrentNoiseSdA = 411,
    /// `capacity.current_offset_sd_a` must be finite and between 1e-12 and 1e12.
    CapacityCurrentOffsetSdA = 412,
    /// `capacity.current_gain_sd` must be finite, zero or above, and at most 1e12.
    CapacityCurrentGainSd = 413,
    /// `capacity.least_soc_change` must be finite and between 1e-12 and 1e12.
    CapacityLeastSocChange = 414,
    /// `capacity.least_soc_change_sds` must be finite and between 1e-12 and 1e12.
    CapacityLeastSocChangeSds = 415,
    /// `capacity.memory_pairs` must be finite and between 1e-12 and 1e12.
    CapacityMemoryPairs = 416,
    /// `capacity.memory_pairs` must lie above the field that limits it from below.
    CapacityMemoryPairsNotAbove = 417,
    /// `power.voltage_min_v` must be finite and between 1e-12 and 1e12.
    PowerVoltageMinV = 420,
    /// `power.voltage_max_v` must be finite and between -1e12 and 1e12.
    PowerVoltageMaxV = 421,
    /// `power.voltage_max_v` must lie above the field that limits it from below.
    PowerVoltageMaxVNotAbove = 422,
    /// `power.soc_min` must lie in 0..1.
    PowerSocMin = 423,
    /// `power.soc_max` must lie in 0..1.
    PowerSocMax = 424,
    /// `power.soc_max` must lie above the field that limits it from below.
    PowerSocMaxNotAbove = 425,
    /// `power.margin_sds` must be finite, zero or above, and at most 1e12.
    PowerMarginSds = 426,
    /// `power.horizons_s` must lie above the field that limits it from below.
    PowerHorizonsSNotAbove = 427,
    /// `power.horizons_s` must be finite and between 1e-12 and 1e12.
    PowerHorizonsS = 428,
    /// `power.discharge_window.none_below_c` must be finite and between -1e12 and 1e12.
    PowerDischargeWindowNoneBelowC = 429,
    /// `power.discharge_window.all_from_c` must be finite and between -1e12 and 1e12.
    PowerDischargeWindowAllFromC = 430,
    /// `power.discharge_window.all_from_c` must lie above the field that limits it from below.
    PowerDischargeWindowAllFromCNotAbove = 431,
    /// `power.discharge_window.all_to_c` must be finite and between -1e12 and 1e12.
    PowerDischargeWindowAllToC = 432,
    /// `power.discharge_window.all_to_c` must lie above the field that limits it from below.
    PowerDischargeWindowAllToCNotAbove = 433,
    /// `power.discharge_window.none_above_c` must be finite and between -1e12 and 1e12.
    PowerDischargeWindowNoneAboveC = 434,
    /// `power.discharge_window.none_above_c` must lie above the field that limits it from below.
    PowerDischargeWindowNoneAboveCNotAbove = 435,
    /// `power.charge_window.none_below_c` must be finite and between -1e12 and 1e12.
    PowerChargeWindowNoneBelowC = 436,
    /// `power.charge_window.all_from_c` must be finite and between -1e12 and 1e12.
    PowerChargeWindowAllFromC = 437,
    /// `power.charge_window.all_from_c` must lie above the field that limits it from below.
    PowerChargeWindowAllFromCNotAbove = 438,
    /// `power.charge_window.all_to_c` must be finite and between -1e12 and 1e12.
    PowerChargeWindowAllToC = 439,
    /// `power.charge_window.all_to_c` must lie above the field that limits it from below.
    PowerChargeWindowAllToCNotAbove = 440,
    /// `power.charge_window.none_above_c` must be finite and between -1e12 and 1e12.
    PowerChargeWindowNoneAboveC = 441,
    /// `power.charge_window.none_above_c` must lie above the field that limits it from below.
    PowerChargeWindowNoneAboveCNotAbove = 442,
    /// `energy.empty_soc` must lie in 0..1.
    EnergyEmptySoc = 450,
    /// `energy.full_soc` must lie in 0..1.
    EnergyFullSoc = 451,
    /// `energy.full_soc` must lie above the field that limits it from below.
    EnergyFullSocNotAbove = 452,
    /// `energy.empty_v` must be finite, zero or above, and at most 1e12.
    EnergyEmptyV = 453,
    /// `energy.least_a` must be finite and between 1e-12 and 1e12.
    EnergyLeastA = 454,
    /// `record.soc` must lie in 0..1.
    RecordSoc = 460,
    /// `record.soc_sd` must lie in 0..1.
    RecordSocSd = 461,
    /// `record.capacity_ah` must be finite and between 1e-12 and 1e12.
    RecordCapacityAh = 462,
    /// `record.capacity_ah` must lie in the range that its documentation gives.
    RecordCapacityAhRange = 463,
    /// `record.capacity_sd_ah` must be finite, zero or above, and at most 1e12.
    RecordCapacitySdAh = 464,
    /// `record.capacity_sd_ah` must lie in the range that its documentation gives.
    RecordCapacitySdAhRange = 465,
    /// `record.resistance_factor` must be finite, zero or above, and at most 1e12.
    RecordResistanceFactor = 466,
    /// `record.resistance_factor` must lie in the range that its documentation gives.
    RecordResistanceFactorRange = 467,
    /// `record.resistance_factor_sd` must be finite, zero or above, and at most 1e12.
    RecordResistanceFactorSd = 468,
    /// `record.resistance_factor_sd` must lie in the range that its documentation gives.
    RecordResistanceFactorSdRange = 469,
    /// `record.current_offset_a` must be finite, zero or above, and at most 1e12.
    RecordCurrentOffsetA = 470,
    /// `record.current_offset_a` must lie in the range that its documentation gives.
    RecordCurrentOffsetARange = 471,
    /// `record.current_offset_sd_a` must be finite, zero or above, and at most 1e12.
    RecordCurrentOffsetSdA = 472,
    /// `record.current_offset_sd_a` must lie in the range that its documentation gives.
    RecordCurrentOffsetSdARange = 473,
    /// `record.throughput_ah` must be finite, zero or above, and at most 1e12.
    RecordThroughputAh = 474,
    /// `record.throughput_ah` must lie in the range that its documentation gives.
    RecordThroughputAhRange = 475,
    /// `record.polarisation.branches_v` must be finite, zero or above, and at most 1e12.
    RecordPolarisationBranchesV = 476,
    /// `record.polarisation.branches_v` must lie in the range that its documentation gives.
    RecordPolarisationBranchesVRange = 477,
    /// `record.polarisation.load_a` must be finite, zero or above, and at most 1e12.
    RecordPolarisationLoadA = 478,
    /// `record.polarisation.load_a` must lie in the range that its documentation gives.
    RecordPolarisationLoadARange = 479,
    /// `record.polarisation.hysteresis` must be finite, zero or above, and at most 1e12.
    RecordPolarisationHysteresis = 480,
    /// `record.polarisation.hysteresis` must lie in the range that its documentation gives.
    RecordPolarisationHysteresisRange = 481,
    /// `record.resistor_heat_j` must be finite, zero or above, and at most 1e12.
    RecordResistorHeatJ = 482,
    /// `record.resistor_heat_j` must lie in the range that its documentation gives.
    RecordResistorHeatJRange = 483,
}
