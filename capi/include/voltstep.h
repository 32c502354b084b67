/*
 * Voltstep for C: an EV powertrain (battery, up to four drives of converter, DC or synchronous
 * machine and gearbox, wheels, body) with its driver, in fixed steps, the estimators of a
 * battery, and a whole BMS; single precision, without allocation; bit for bit the same on a Cortex-M4F and on a PC.
 *
 *   VoltstepParams params;
 *   voltstep_params_preset(VOLTSTEP_PRESET_BMW_I3_CONSTANT, &params);
 *   static VoltstepPlant plant;                        // read only from here on
 *   voltstep_plant_init(&plant, &params, 0.001f);      // names a bad parameter by its code
 *   static VoltstepState state;                        // a snapshot is a copy of it
 *   voltstep_state_init(&plant, &state, 0.8f, 0.0f);
 *   every millisecond: voltstep_step(&plant, &state, &inputs, &outputs);
 *
 *   VoltstepEstimatorParams known;
 *   voltstep_estimator_params_preset(VOLTSTEP_CELL_PRESET_PANASONIC_NCR18650_PF, &known);
 *   static VoltstepEstimators estimators;              // stays where it is
 *   voltstep_estimators_init(&estimators, &known, 0.1f);
 *   static uint64_t pack[VOLTSTEP_SERIES_WORDS + 18 * VOLTSTEP_SERIES_WORDS_PER_CELL];
 *   voltstep_series_start(&estimators, pack, sizeof pack / 8, 18, 0, NAN, 25.0f);
 *   every 100 ms: voltstep_series_step(&estimators, pack, &sample, cell_v, 18, &believed);
 *
 *   VoltstepBmsSheet sheet;                            // from your data sheets
 *   VoltstepBmsParams described;
 *   voltstep_bms_params_typical(&sheet, &known.cell, 33.0f, &described);
 *   static VoltstepBms bms;                            // stays where it is
 *   voltstep_bms_init(&bms, &described, &refused);     // names a bad field
 *   static VoltstepBmsState battery;
 *   voltstep_bms_start(&bms, &battery, 0, 0, 0, 25.0f);
 *   every millisecond: voltstep_bms_tick(&bms, &battery, &measured, &told);
 *
 * Built with --no-default-features the library has plants with one DC drive, in 15 kB of flash; the
 * features `pmsm` (synchronous machines), `drives` (two to four drives) and `thermal` (drives that heat up)
 * add to them. What is not built in is refused by VOLTSTEP_STATUS_NOT_BUILT_IN.
 *
 * All memory is the caller's. Units stand in the names (_a A, _v V, _nm N m, _m_s m/s, ...);
 * ratios have none. Discharge current, traction torque and forward speed are positive. Every
 * function checks its pointers and answers with a VoltstepStatus. A function may be called from
 * several threads or interrupts as long as no two of them use the same state.
 */

#ifndef VOLTSTEP_H
#define VOLTSTEP_H

/* Made from capi/src by `cargo xtask capi`: do not edit. */

#include <stdbool.h>
#include <stdint.h>

/* A struct that begins at a multiple of n bytes. */
#if defined(__cplusplus)
#define VOLTSTEP_ALIGNED(n) alignas(n)
#elif defined(_MSC_VER)
#define VOLTSTEP_ALIGNED(n) __declspec(align(n))
#else
#define VOLTSTEP_ALIGNED(n) __attribute__((aligned(n)))
#endif

// Words (8 bytes) of a `VoltstepBms`.
#define VOLTSTEP_BMS_WORDS 1280

// Words (8 bytes) of a `VoltstepBmsState`.
#define VOLTSTEP_BMS_STATE_WORDS 832

// Cells in series that a BMS may have at most. How many a library is built for is chosen by the
// environment variable `VOLTSTEP_BMS_CELLS` when building; 18 without it.
#define VOLTSTEP_BMS_CELLS_MAX 18

// Temperatures that a BMS may have at most. How many a library is built for is chosen by the
// environment variable `VOLTSTEP_BMS_SENSORS` when building; 4 without it.
#define VOLTSTEP_BMS_SENSORS_MAX 8

// Wires between so many cells and the front end.
#define VOLTSTEP_BMS_WIRES_MAX 19

// Words (8 bytes) of a `VoltstepEstimators`.
#define VOLTSTEP_ESTIMATORS_WORDS 704

// Words (8 bytes) of a `VoltstepFilterState`.
#define VOLTSTEP_FILTER_STATE_WORDS 48

// Words (8 bytes) of a `VoltstepCounterState`.
#define VOLTSTEP_COUNTER_STATE_WORDS 16

// Words (8 bytes) of a `VoltstepResistanceState`.
#define VOLTSTEP_RESISTANCE_STATE_WORDS 16

// Words (8 bytes) of a `VoltstepCapacityState`.
#define VOLTSTEP_CAPACITY_STATE_WORDS 12

// Words (8 bytes) of a `VoltstepEnergyState`.
#define VOLTSTEP_ENERGY_STATE_WORDS 4

// Words (8 bytes) of a `VoltstepPowerWalk`.
#define VOLTSTEP_POWER_WALK_WORDS 24

// Words (8 bytes) that cells in series take beside what each takes.
#define VOLTSTEP_SERIES_WORDS 112

// Words (8 bytes) that each cell in series takes.
#define VOLTSTEP_SERIES_WORDS_PER_CELL 4

// Lengths of time that the power limits look ahead.
#define VOLTSTEP_HORIZONS 3

// Bytes of a slot that holds a record.
#define VOLTSTEP_RECORD_BYTES 96

// Calls of `voltstep_series_power_walk` until the answer is there.
#define VOLTSTEP_SERIES_SLICES 18

// Words (8 bytes) of a `VoltstepPlant`.
#define VOLTSTEP_PLANT_WORDS 168

// Words (4 bytes) of a `VoltstepState`.
#define VOLTSTEP_STATE_WORDS 96

// Version of this interface. `VoltstepParams.abi` must hold it, so that a header and a library
// that do not belong together are noticed.
#define VOLTSTEP_ABI 3

// Points of an open-circuit table: at state of charge i/64, i = 0..64.
#define VOLTSTEP_SOC_POINTS 65

// Drives of a vehicle, at most.
#define VOLTSTEP_DRIVES 4

// What a call ended with; `voltstep_error_message` has the words. Codes from 99 on are
// parameters: each is one field and the rule that it broke. Numbers do not change between
// versions; new ones may come.
enum VoltstepStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Done.
  VOLTSTEP_STATUS_OK = 0,
  // A pointer is null.
  VOLTSTEP_STATUS_NULL_POINTER = 1,
  // A pointer is not aligned as its type demands.
  VOLTSTEP_STATUS_MISALIGNED = 2,
  // Two objects of a call share memory.
  VOLTSTEP_STATUS_OVERLAP = 3,
  // The plant was not initialised: `voltstep_plant_init`.
  VOLTSTEP_STATUS_PLANT_NOT_INITIALISED = 4,
  // The state was not initialised: `voltstep_state_init`, or the estimator's `..._start`.
  VOLTSTEP_STATUS_STATE_NOT_INITIALISED = 5,
  // The params' `abi` is not `VOLTSTEP_ABI`: not set, or header and library differ.
  VOLTSTEP_STATUS_ABI_MISMATCH = 6,
  // The estimators were not initialised: `voltstep_estimators_init`.
  VOLTSTEP_STATUS_ESTIMATORS_NOT_INITIALISED = 7,
  // The estimators are a copy, or were moved: initialise them where they lie.
  VOLTSTEP_STATUS_ESTIMATORS_MOVED = 8,
  // The memory is too small for so many cells.
  VOLTSTEP_STATUS_MEMORY_TOO_SMALL = 9,
  // An input of the step was not finite or absurd. The outputs say whether the plant or only the
  // driver refused it; what refused it left its state as it was.
  VOLTSTEP_STATUS_INPUT_REJECTED = 10,
  // No memory of cells in series for such a number of cells, or not for this one.
  VOLTSTEP_STATUS_CELL_COUNT = 11,
  // No cell has this number.
  VOLTSTEP_STATUS_CELL_INDEX = 12,
  // The slot is erased: it holds no record yet.
  VOLTSTEP_STATUS_RECORD_BLANK = 13,
  // What the slot holds is no record, or one of another version.
  VOLTSTEP_STATUS_RECORD_UNKNOWN = 14,
  // The checksum of the record does not fit: a torn write, or memory gone bad.
  VOLTSTEP_STATUS_RECORD_CORRUPTED = 15,
  // The state was initialised by a plant with other drives.
  VOLTSTEP_STATUS_STATE_OF_OTHER_DRIVES = 16,
  // A duty beside a torque, or for drives that take none: only one DC drive does.
  VOLTSTEP_STATUS_DUTY_NOT_TAKEN = 17,
  // The library was built without this kind of drive: the features `pmsm`, `drives`.
  VOLTSTEP_STATUS_NOT_BUILT_IN = 18,
  // No such preset.
  VOLTSTEP_STATUS_UNKNOWN_PRESET = 20,
  // `battery.model` is none of `VoltstepBatteryModel`.
  VOLTSTEP_STATUS_UNKNOWN_BATTERY_MODEL = 21,
  // `battery.open_circuit` is none of `VoltstepOpenCircuit`.
  VOLTSTEP_STATUS_UNKNOWN_OPEN_CIRCUIT = 22,
  // `body.road_law` is none of `VoltstepRoadLaw`.
  VOLTSTEP_STATUS_UNKNOWN_ROAD_LAW = 23,
  // `driver` is none of `VoltstepDriverKind`.
  VOLTSTEP_STATUS_UNKNOWN_DRIVER = 24,
  // `pid.anti_windup` is none of `VoltstepWindup`.
  VOLTSTEP_STATUS_UNKNOWN_WINDUP = 25,
  // No such preset of a cell.
  VOLTSTEP_STATUS_UNKNOWN_CELL_PRESET = 26,
  // `drives.machine` is none of `VoltstepMachine`.
  VOLTSTEP_STATUS_UNKNOWN_MACHINE = 27,
  // `drive_count` is not in 1..`VOLTSTEP_DRIVES`.
  VOLTSTEP_STATUS_DRIVE_COUNT = 28,
  // `driver` is a duty's, which drives one DC machine only.
  VOLTSTEP_STATUS_DRIVER_OF_ONE_DC = 29,
  // The BMS was not initialised: `voltstep_bms_init`.
  VOLTSTEP_STATUS_BMS_NOT_INITIALISED = 30,
  // The BMS is a copy, or was moved: initialise it where it lies.
  VOLTSTEP_STATUS_BMS_MOVED = 31,
  // The library was built for a BMS with another number of temperatures.
  VOLTSTEP_STATUS_SENSOR_COUNT = 32,
  // A parameter is out of range, and this version has no code of its own for it.
  VOLTSTEP_STATUS_PARAMETER = 99,
  // `dt_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_DT_S = 100,
  // `soc` must lie in 0..1.
  VOLTSTEP_STATUS_SOC = 101,
  // `speed_m_s` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_SPEED_MS = 102,
  // `battery.capacity_ah` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_CAPACITY_AH = 110,
  // `battery.series_resistance_ohm` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_SERIES_RESISTANCE_OHM = 111,
  // `battery.polarisation.resistance_ohm` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_POLARISATION_RESISTANCE_OHM = 112,
  // `battery.polarisation.capacitance_f` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_POLARISATION_CAPACITANCE_F = 113,
  // `battery.discharge_limit_a` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_BATTERY_DISCHARGE_LIMIT_A = 114,
  // `battery.charge_limit_a` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_BATTERY_CHARGE_LIMIT_A = 115,
  // `battery.open_circuit.linear.empty_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BATTERY_EMPTY_V = 116,
  // `battery.open_circuit.linear.full_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_FULL_V = 117,
  // `battery.open_circuit.linear.full_v` must not decrease from one entry to the next.
  VOLTSTEP_STATUS_BATTERY_FULL_V_DECREASING = 118,
  // `battery.open_circuit.table` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_BATTERY_TABLE_V = 119,
  // `battery.open_circuit.table` must not decrease from one entry to the next.
  VOLTSTEP_STATUS_BATTERY_TABLE_V_DECREASING = 120,
  // `battery.open_circuit.table` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_BATTERY_TABLE_V_RANGE = 121,
  // `auxiliary.power_w` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_AUXILIARY_POWER_W = 140,
  // `auxiliary.resistance_ohm` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_AUXILIARY_RESISTANCE_OHM = 141,
  // `auxiliary.cut_out_v` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_AUXILIARY_CUT_OUT_V = 142,
  // `converter.duty_limit` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_CONVERTER_DUTY_LIMIT = 150,
  // `converter.constant_loss_w` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CONVERTER_CONSTANT_LOSS_W = 151,
  // `converter.voltage_drop_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CONVERTER_VOLTAGE_DROP_V = 152,
  // `converter.resistance_ohm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CONVERTER_RESISTANCE_OHM = 153,
  // `converter.current_limit_a` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_CONVERTER_CURRENT_LIMIT_A = 154,
  // `converter.voltage_drop_v` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CONVERTER_VOLTAGE_DROP_V_RANGE = 155,
  // `motor.resistance_ohm` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_MOTOR_RESISTANCE_OHM = 160,
  // `motor.inductance_h` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_MOTOR_INDUCTANCE_H = 161,
  // `motor.back_emf_v_s_per_rad` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_MOTOR_BACK_EMF = 162,
  // `motor.torque_nm_per_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_MOTOR_TORQUE_PER_A = 163,
  // `motor.inertia_kg_m2` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_MOTOR_INERTIA = 164,
  // `motor.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_MOTOR_VISCOUS = 165,
  // `motor.coulomb_nm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_MOTOR_COULOMB_NM = 166,
  // `gearbox.ratio` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_GEARBOX_RATIO = 170,
  // `gearbox.efficiency` must lie above 0 and up to 1.
  VOLTSTEP_STATUS_GEARBOX_EFFICIENCY = 171,
  // `gearbox.inertia_kg_m2` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_GEARBOX_INERTIA = 172,
  // `wheel.radius_m` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_WHEEL_RADIUS_M = 180,
  // `wheel.inertia_kg_m2` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_WHEEL_INERTIA = 181,
  // `wheel.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_WHEEL_VISCOUS = 182,
  // `body.mass_kg` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_BODY_MASS_KG = 190,
  // `body.resistance.drag_coefficient` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_DRAG_COEFFICIENT = 191,
  // `body.resistance.frontal_area_m2` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_FRONTAL_AREA_M2 = 192,
  // `body.resistance.air_density_kg_m3` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_AIR_DENSITY = 193,
  // `body.resistance.rolling_coefficient` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_ROLLING_COEFFICIENT = 194,
  // `body.resistance.a_n` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_AN = 195,
  // `body.resistance.b_n_s_per_m` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_BODY_BNS_PER_M = 196,
  // `body.resistance.c_n_s2_per_m2` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_BODY_CNS2_PER_M2 = 197,
  // `pid.proportional` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_PID_PROPORTIONAL = 210,
  // `pid.integral_per_s` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PID_INTEGRAL_PER_S = 211,
  // `pid.derivative_s` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PID_DERIVATIVE_S = 212,
  // `pid.derivative_filter_s` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PID_DERIVATIVE_FILTER_S = 213,
  // `pid.dead_zone` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PID_DEAD_ZONE = 214,
  // `pid.output_min` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_PID_OUTPUT_MIN = 215,
  // `pid.output_max` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_PID_OUTPUT_MAX = 216,
  // `pid.smoothing_per_s` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_PID_SMOOTHING_PER_S = 217,
  // `driver.torque.peak_torque_nm` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_TORQUE_PEAK_TORQUE_NM = 230,
  // `driver.torque.peak_power_w` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_TORQUE_PEAK_POWER_W = 231,
  // `driver.torque.regen_torque_nm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_TORQUE_REGEN_TORQUE_NM = 232,
  // `driver.torque.regen_power_w` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_TORQUE_REGEN_POWER_W = 233,
  // `driver.torque.regen_fade_m_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_TORQUE_REGEN_FADE_MS = 234,
  // `driver.torque.regen_fade_soc` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_TORQUE_REGEN_FADE_SOC = 235,
  // `driver.torque.brake_limit_n` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_TORQUE_BRAKE_LIMIT_N = 236,
  // `driver.torque.current_rate_per_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_TORQUE_CURRENT_RATE_PER_S = 237,
  // `pmsm.flux.magnet_wb` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PMSM_FLUX_MAGNET_WB = 240,
  // `pmsm.flux.magnet_wb` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_PMSM_FLUX_MAGNET_WB_RANGE = 241,
  // `pmsm.flux.d_h` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_PMSM_FLUX_DH = 242,
  // `pmsm.flux.q_h` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_PMSM_FLUX_QH = 243,
  // `pmsm.resistance_ohm` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_PMSM_RESISTANCE_OHM = 244,
  // `pmsm.resistance_per_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PMSM_RESISTANCE_PER_K = 245,
  // `pmsm.resistance_per_k` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_PMSM_RESISTANCE_PER_K_RANGE = 246,
  // `pmsm.pole_pairs` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_PMSM_POLE_PAIRS = 247,
  // `pmsm.pole_pairs` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_PMSM_POLE_PAIRS_RANGE = 248,
  // `pmsm.iron_s` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PMSM_IRON_S = 249,
  // `pmsm.inertia_kg_m2` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_PMSM_INERTIA = 250,
  // `pmsm.viscous_nm_s_per_rad` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PMSM_VISCOUS = 251,
  // `pmsm.coulomb_nm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_PMSM_COULOMB_NM = 252,
  // `drive.torque_rate_per_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_DRIVE_TORQUE_RATE_PER_S = 260,
  // `drive.torque_share` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_DRIVE_TORQUE_SHARE = 261,
  // `thermal.coolant_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_THERMAL_COOLANT_C = 270,
  // `thermal.coolant_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_THERMAL_COOLANT_C_RANGE = 271,
  // `thermal.machine.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_THERMAL_MACHINE_HEAT_CAPACITY = 272,
  // `thermal.machine.coolant_k_per_w` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_THERMAL_MACHINE_COOLANT_K_PER_W = 273,
  // `thermal.machine.derate_from_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_THERMAL_MACHINE_DERATE_FROM_C = 274,
  // `thermal.machine.derate_to_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_THERMAL_MACHINE_DERATE_TO_C = 275,
  // `thermal.inverter.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_THERMAL_INVERTER_HEAT_CAPACITY = 276,
  // `thermal.inverter.coolant_k_per_w` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_THERMAL_INVERTER_COOLANT_K_PER_W = 277,
  // `thermal.inverter.derate_from_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_THERMAL_INVERTER_DERATE_FROM_C = 278,
  // `thermal.inverter.derate_to_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_THERMAL_INVERTER_DERATE_TO_C = 279,
  // `thermal.winding.reference_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_THERMAL_REFERENCE_C = 280,
  // `thermal.winding.per_k` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_THERMAL_PER_K = 281,
  // `converter.current_limit_a` must be finite and between 1e-12 and 1e12: of a drive that may be derated.
  VOLTSTEP_STATUS_CONVERTER_CURRENT_LIMIT_A_FINITE = 282,
  // `soc_sd` must lie in 0..1.
  VOLTSTEP_STATUS_SOC_SD = 300,
  // `temperature_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_TEMPERATURE_C = 301,
  // `voltage_v` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_VOLTAGE_V = 302,
  // `battery.refresh_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_REFRESH_S = 310,
  // `battery.hysteresis.half_gap_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_HYSTERESIS_HALF_GAP_V = 311,
  // `battery.hysteresis.rate_per_soc` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_HYSTERESIS_RATE_PER_SOC = 312,
  // `battery.series.resistance_ohm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_SERIES_RESISTANCE_OHM = 313,
  // `battery.series.activation_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_SERIES_ACTIVATION_K = 314,
  // `battery.series.activation_k` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELL_SERIES_ACTIVATION_K_RANGE = 315,
  // `battery.polarisation.resistance_ohm` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_POLARISATION_RESISTANCE_OHM = 316,
  // `battery.polarisation.activation_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_POLARISATION_ACTIVATION_K = 317,
  // `battery.polarisation.activation_k` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELL_POLARISATION_ACTIVATION_K_RANGE = 318,
  // `battery.polarisation.time_constant_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_POLARISATION_TIME_CONSTANT_S = 319,
  // `battery.second_polarisation.resistance_ohm` must be finite, zero or above, and at most
  // 1e12.
  VOLTSTEP_STATUS_CELL_SECOND_POLARISATION_RESISTANCE_OHM = 320,
  // `battery.second_polarisation.activation_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_SECOND_POLARISATION_ACTIVATION_K = 321,
  // `battery.second_polarisation.activation_k` must lie in the range that its documentation
  // gives.
  VOLTSTEP_STATUS_CELL_SECOND_POLARISATION_ACTIVATION_K_RANGE = 322,
  // `battery.second_polarisation.time_constant_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_SECOND_POLARISATION_TIME_CONSTANT_S = 323,
  // `battery.thermal.heat_capacity_j_per_k` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_CELL_HEAT_CAPACITY_J_PER_K = 324,
  // `battery.thermal.cooling_w_per_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CELL_COOLING_W_PER_K = 325,
  // `battery.thermal.ambient_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELL_AMBIENT_C = 326,
  // `battery.identified.soc_min` must lie in 0..1.
  VOLTSTEP_STATUS_CELL_SOC_MIN = 327,
  // `battery.identified.soc_max` must lie in 0..1.
  VOLTSTEP_STATUS_CELL_SOC_MAX = 328,
  // `battery.identified.soc_max` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_CELL_SOC_MAX_NOT_ABOVE = 329,
  // `battery.identified.temperature_min_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELL_TEMPERATURE_MIN_C = 330,
  // `battery.identified.temperature_max_c` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELL_TEMPERATURE_MAX_C = 331,
  // `battery.identified.temperature_max_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_CELL_TEMPERATURE_MAX_C_NOT_ABOVE = 332,
  // `ekf.uncertainty.open_circuit_sd_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_FILTER_OPEN_CIRCUIT_SD_V = 340,
  // `ekf.uncertainty.resistance_sd` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_RESISTANCE_SD = 341,
  // `ekf.uncertainty.activation_sd_k` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_ACTIVATION_SD_K = 342,
  // `ekf.uncertainty.capacity_sd` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_CAPACITY_SD = 343,
  // `ekf.uncertainty.current_offset_sd_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_CURRENT_OFFSET_SD_A = 344,
  // `ekf.uncertainty.standby_sd_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_STANDBY_SD_A = 345,
  // `ekf.uncertainty.voltage_sd_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_FILTER_VOLTAGE_SD_V = 346,
  // `ekf.uncertainty.polarisation_sd_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_POLARISATION_SD_V = 347,
  // `ekf.uncertainty.correlation_soc` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_FILTER_CORRELATION_SOC = 348,
  // `ekf.uncertainty.correlation_soc` must lie in 0..1.
  VOLTSTEP_STATUS_FILTER_CORRELATION_SOC_RATIO = 349,
  // `ekf.uncertainty.outside_factor` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_FILTER_OUTSIDE_FACTOR = 350,
  // `ekf.uncertainty.outside_factor` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_FILTER_OUTSIDE_FACTOR_RANGE = 351,
  // `ekf.flat_v_per_soc` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_FILTER_FLAT_V_PER_SOC = 352,
  // `ekf.converged_sd` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_FILTER_CONVERGED_SD = 353,
  // `ekf.converged_sd` must lie in 0..1.
  VOLTSTEP_STATUS_FILTER_CONVERGED_SD_RATIO = 354,
  // `ekf.unseen_current_a` must be at least 1e-12 (infinity: no limit).
  VOLTSTEP_STATUS_FILTER_UNSEEN_CURRENT_A = 355,
  // `coulomb.capacity_sd_ah` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_COUNTER_CAPACITY_SD_AH = 360,
  // `coulomb.charge_efficiency` must lie above 0 and up to 1.
  VOLTSTEP_STATUS_COUNTER_CHARGE_EFFICIENCY = 361,
  // `coulomb.offset_sd_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_COUNTER_OFFSET_SD_A = 362,
  // `coulomb.gain_sd` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_COUNTER_GAIN_SD = 363,
  // `coulomb.largest_current_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_COUNTER_LARGEST_CURRENT_A = 364,
  // `coulomb.rest_voltage_sd_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_COUNTER_REST_VOLTAGE_SD_V = 365,
  // `coulomb.rest_current_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_COUNTER_REST_CURRENT_A = 366,
  // `coulomb.rest_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_COUNTER_REST_S = 367,
  // `cells.open_circuit` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELLS_OPEN_CIRCUIT = 370,
  // `cells.noise_sd_v` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_NOISE_SD_V = 371,
  // `cells.noise_sd_v` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELLS_NOISE_SD_V_RANGE = 372,
  // `cells.offset_sd_v` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_OFFSET_SD_V = 373,
  // `cells.resistance_sd_ohm` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_RESISTANCE_SD_OHM = 374,
  // `cells.capacity_sd` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_CAPACITY_SD = 375,
  // `cells.soc_sd` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELLS_SOC_SD = 376,
  // `cells.soc_sd` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_SOC_SD_RATIO = 377,
  // `cells.drift_sd_per_day` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_DRIFT_SD_PER_DAY = 378,
  // `cells.pack_soc_sd_max` must lie in 0..1.
  VOLTSTEP_STATUS_CELLS_PACK_SOC_SD_MAX = 379,
  // `cells.voltage_min_v` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELLS_VOLTAGE_MIN_V = 380,
  // `cells.voltage_max_v` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_CELLS_VOLTAGE_MAX_V = 381,
  // `cells.voltage_max_v` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_CELLS_VOLTAGE_MAX_V_NOT_ABOVE = 382,
  // `cell_resistances.resistance_ohm` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_RESISTANCES_RESISTANCE_OHM = 390,
  // `cell_resistances.spread_sd` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_RESISTANCES_SPREAD_SD = 391,
  // `cell_resistances.noise_sd_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_RESISTANCES_NOISE_SD_V = 392,
  // `cell_resistances.least_step_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_RESISTANCES_LEAST_STEP_A = 393,
  // `cell_resistances.memory_steps` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CELL_RESISTANCES_MEMORY_STEPS = 394,
  // `cell_resistances.memory_steps` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_CELL_RESISTANCES_MEMORY_STEPS_NOT_ABOVE = 395,
  // `resistance.voltage_sd_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RESISTANCE_VOLTAGE_SD_V = 400,
  // `resistance.current_sd_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RESISTANCE_CURRENT_SD_A = 401,
  // `resistance.least_step_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RESISTANCE_LEAST_STEP_A = 402,
  // `resistance.memory_steps` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RESISTANCE_MEMORY_STEPS = 403,
  // `resistance.memory_steps` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_RESISTANCE_MEMORY_STEPS_NOT_ABOVE = 404,
  // `resistance.initial_sd` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RESISTANCE_INITIAL_SD = 405,
  // `resistance.skew_s` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RESISTANCE_SKEW_S = 406,
  // `capacity.nominal_sd_ah` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CAPACITY_NOMINAL_SD_AH = 410,
  // `capacity.current_noise_sd_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CAPACITY_CURRENT_NOISE_SD_A = 411,
  // `capacity.current_offset_sd_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CAPACITY_CURRENT_OFFSET_SD_A = 412,
  // `capacity.current_gain_sd` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_CAPACITY_CURRENT_GAIN_SD = 413,
  // `capacity.least_soc_change` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CAPACITY_LEAST_SOC_CHANGE = 414,
  // `capacity.least_soc_change_sds` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CAPACITY_LEAST_SOC_CHANGE_SDS = 415,
  // `capacity.memory_pairs` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_CAPACITY_MEMORY_PAIRS = 416,
  // `capacity.memory_pairs` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_CAPACITY_MEMORY_PAIRS_NOT_ABOVE = 417,
  // `power.voltage_min_v` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_POWER_VOLTAGE_MIN_V = 420,
  // `power.voltage_max_v` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_VOLTAGE_MAX_V = 421,
  // `power.voltage_max_v` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_VOLTAGE_MAX_V_NOT_ABOVE = 422,
  // `power.soc_min` must lie in 0..1.
  VOLTSTEP_STATUS_POWER_SOC_MIN = 423,
  // `power.soc_max` must lie in 0..1.
  VOLTSTEP_STATUS_POWER_SOC_MAX = 424,
  // `power.soc_max` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_SOC_MAX_NOT_ABOVE = 425,
  // `power.margin_sds` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_POWER_MARGIN_SDS = 426,
  // `power.horizons_s` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_HORIZONS_S_NOT_ABOVE = 427,
  // `power.horizons_s` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_POWER_HORIZONS_S = 428,
  // `power.discharge_window.none_below_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_NONE_BELOW_C = 429,
  // `power.discharge_window.all_from_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_ALL_FROM_C = 430,
  // `power.discharge_window.all_from_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_ALL_FROM_C_NOT_ABOVE = 431,
  // `power.discharge_window.all_to_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_ALL_TO_C = 432,
  // `power.discharge_window.all_to_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_ALL_TO_C_NOT_ABOVE = 433,
  // `power.discharge_window.none_above_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_NONE_ABOVE_C = 434,
  // `power.discharge_window.none_above_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_DISCHARGE_WINDOW_NONE_ABOVE_C_NOT_ABOVE = 435,
  // `power.charge_window.none_below_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_NONE_BELOW_C = 436,
  // `power.charge_window.all_from_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_ALL_FROM_C = 437,
  // `power.charge_window.all_from_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_ALL_FROM_C_NOT_ABOVE = 438,
  // `power.charge_window.all_to_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_ALL_TO_C = 439,
  // `power.charge_window.all_to_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_ALL_TO_C_NOT_ABOVE = 440,
  // `power.charge_window.none_above_c` must be finite and between -1e12 and 1e12.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_NONE_ABOVE_C = 441,
  // `power.charge_window.none_above_c` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_POWER_CHARGE_WINDOW_NONE_ABOVE_C_NOT_ABOVE = 442,
  // `energy.empty_soc` must lie in 0..1.
  VOLTSTEP_STATUS_ENERGY_EMPTY_SOC = 450,
  // `energy.full_soc` must lie in 0..1.
  VOLTSTEP_STATUS_ENERGY_FULL_SOC = 451,
  // `energy.full_soc` must lie above the field that limits it from below.
  VOLTSTEP_STATUS_ENERGY_FULL_SOC_NOT_ABOVE = 452,
  // `energy.empty_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_ENERGY_EMPTY_V = 453,
  // `energy.least_a` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_ENERGY_LEAST_A = 454,
  // `record.soc` must lie in 0..1.
  VOLTSTEP_STATUS_RECORD_SOC = 460,
  // `record.soc_sd` must lie in 0..1.
  VOLTSTEP_STATUS_RECORD_SOC_SD = 461,
  // `record.capacity_ah` must be finite and between 1e-12 and 1e12.
  VOLTSTEP_STATUS_RECORD_CAPACITY_AH = 462,
  // `record.capacity_ah` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_CAPACITY_AH_RANGE = 463,
  // `record.capacity_sd_ah` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_CAPACITY_SD_AH = 464,
  // `record.capacity_sd_ah` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_CAPACITY_SD_AH_RANGE = 465,
  // `record.resistance_factor` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_RESISTANCE_FACTOR = 466,
  // `record.resistance_factor` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_RESISTANCE_FACTOR_RANGE = 467,
  // `record.resistance_factor_sd` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_RESISTANCE_FACTOR_SD = 468,
  // `record.resistance_factor_sd` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_RESISTANCE_FACTOR_SD_RANGE = 469,
  // `record.current_offset_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_CURRENT_OFFSET_A = 470,
  // `record.current_offset_a` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_CURRENT_OFFSET_A_RANGE = 471,
  // `record.current_offset_sd_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_CURRENT_OFFSET_SD_A = 472,
  // `record.current_offset_sd_a` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_CURRENT_OFFSET_SD_A_RANGE = 473,
  // `record.throughput_ah` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_THROUGHPUT_AH = 474,
  // `record.throughput_ah` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_THROUGHPUT_AH_RANGE = 475,
  // `record.polarisation.branches_v` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_POLARISATION_BRANCHES_V = 476,
  // `record.polarisation.branches_v` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_POLARISATION_BRANCHES_V_RANGE = 477,
  // `record.polarisation.load_a` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_POLARISATION_LOAD_A = 478,
  // `record.polarisation.load_a` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_POLARISATION_LOAD_A_RANGE = 479,
  // `record.polarisation.hysteresis` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_POLARISATION_HYSTERESIS = 480,
  // `record.polarisation.hysteresis` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_POLARISATION_HYSTERESIS_RANGE = 481,
  // `record.resistor_heat_j` must be finite, zero or above, and at most 1e12.
  VOLTSTEP_STATUS_RECORD_RESISTOR_HEAT_J = 482,
  // `record.resistor_heat_j` must lie in the range that its documentation gives.
  VOLTSTEP_STATUS_RECORD_RESISTOR_HEAT_J_RANGE = 483,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepStatus VoltstepStatus;
#else
typedef uint32_t VoltstepStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Parameter sets that come with the library.
enum VoltstepPreset
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A physical BMW i3 60 Ah, driven by torque, with a battery of constant parameters:
  // `bmw-i3-60ah-constant`. The mapped battery of `bmw-i3-60ah` is not in this interface yet.
  VOLTSTEP_PRESET_BMW_I3_CONSTANT = 0,
  // The BMW i3 of `EPowertrain` (2025), Table 5.6, to the letter.
  VOLTSTEP_PRESET_BMW_I3_EPOWERTRAIN = 1,
  // The UDDS vehicle of `EPowertrain` (2025) that gives its published state of charge.
  VOLTSTEP_PRESET_EPOWERTRAIN_UDDS = 2,
  // The same, Table 5.5 to the letter.
  VOLTSTEP_PRESET_EPOWERTRAIN_UDDS_TABLE = 3,
  // The car of `BmwI3Constant` with a synchronous machine: `bmw-i3-60ah-pmsm`.
  VOLTSTEP_PRESET_BMW_I3_PMSM = 4,
  // A car with a synchronous machine behind and a DC machine in front: `two-axles`.
  VOLTSTEP_PRESET_TWO_AXLES = 5,
  // The car of `BmwI3Constant` with a drive that heats up: `bmw-i3-60ah-thermal`.
  VOLTSTEP_PRESET_BMW_I3_THERMAL = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepPreset VoltstepPreset;
#else
typedef uint32_t VoltstepPreset;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The machine of a drive.
enum VoltstepMachine
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A DC machine: `motor`.
  VOLTSTEP_MACHINE_DC = 0,
  // A permanent-magnet synchronous machine: `pmsm`.
  VOLTSTEP_MACHINE_PMSM = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepMachine VoltstepMachine;
#else
typedef uint32_t VoltstepMachine;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the battery is modelled.
enum VoltstepBatteryModel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Open-circuit voltage over the state of charge; resistances and one RC branch are constant.
  VOLTSTEP_BATTERY_MODEL_CONSTANT = 0,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBatteryModel VoltstepBatteryModel;
#else
typedef uint32_t VoltstepBatteryModel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the open-circuit voltage depends on the state of charge.
enum VoltstepOpenCircuit
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // A line from `empty_v` to `full_v`.
  VOLTSTEP_OPEN_CIRCUIT_LINEAR = 0,
  // The polyline through `table_v`.
  VOLTSTEP_OPEN_CIRCUIT_TABLE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepOpenCircuit VoltstepOpenCircuit;
#else
typedef uint32_t VoltstepOpenCircuit;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the road load is given.
enum VoltstepRoadLaw
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Drag and rolling resistance by their coefficients.
  VOLTSTEP_ROAD_LAW_PHYSICAL = 0,
  // A + B v + C v^2 of a coast-down test.
  VOLTSTEP_ROAD_LAW_COAST_DOWN = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepRoadLaw VoltstepRoadLaw;
#else
typedef uint32_t VoltstepRoadLaw;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Who drives.
enum VoltstepDriverKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nobody: the inputs say duty or torque, and brake.
  VOLTSTEP_DRIVER_KIND_NONE = 0,
  // A PID from the speed error straight to the duty; for one DC machine only.
  VOLTSTEP_DRIVER_KIND_DUTY = 1,
  // Speed, torque, limits, and of one DC machine current and duty; the friction brake takes the
  // rest.
  VOLTSTEP_DRIVER_KIND_TORQUE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepDriverKind VoltstepDriverKind;
#else
typedef uint32_t VoltstepDriverKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the integral of a PID does in saturation.
enum VoltstepWindup
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It stands still.
  VOLTSTEP_WINDUP_FREEZE = 0,
  // It may move back, and counts saturation further down the loop too.
  VOLTSTEP_WINDUP_DIRECTIONAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepWindup VoltstepWindup;
#else
typedef uint32_t VoltstepWindup;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What changed the duty, if anything.
enum VoltstepLimited
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The duty is the commanded one; or the gates are off.
  VOLTSTEP_LIMITED_NO = 0,
  // The discharge limit, or what is left to discharge, held it back.
  VOLTSTEP_LIMITED_DISCHARGE = 1,
  // The charge limit, or what is left to charge, held it back.
  VOLTSTEP_LIMITED_CHARGE = 2,
  // The commanded duty lay beyond the converter's limit.
  VOLTSTEP_LIMITED_DUTY = 3,
  // The converter's current limit held it back.
  VOLTSTEP_LIMITED_CURRENT = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepLimited VoltstepLimited;
#else
typedef uint32_t VoltstepLimited;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Parameter sets of cells that come with the library, with the estimators' own to match.
enum VoltstepCellPreset
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Panasonic NCR18650PF, identified from drive cycles; sensors of a production car.
  VOLTSTEP_CELL_PRESET_PANASONIC_NCR18650_PF = 0,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepCellPreset VoltstepCellPreset;
#else
typedef uint32_t VoltstepCellPreset;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What kept a current from being larger.
enum VoltstepBoundBy
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The largest current of the cell.
  VOLTSTEP_BOUND_BY_CURRENT = 0,
  // The voltage at the terminals.
  VOLTSTEP_BOUND_BY_VOLTAGE = 1,
  // The state of charge.
  VOLTSTEP_BOUND_BY_SOC = 2,
  // The temperature, now or as the current raises it.
  VOLTSTEP_BOUND_BY_TEMPERATURE = 3,
  // The estimate was not finite or absurd: nothing is allowed.
  VOLTSTEP_BOUND_BY_UNKNOWN = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBoundBy VoltstepBoundBy;
#else
typedef uint32_t VoltstepBoundBy;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a contactor shows.
enum VoltstepBmsFeedback
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It could not be read.
  VOLTSTEP_BMS_FEEDBACK_UNKNOWN = 0,
  // Open.
  VOLTSTEP_BMS_FEEDBACK_OPEN = 1,
  // Closed.
  VOLTSTEP_BMS_FEEDBACK_CLOSED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsFeedback VoltstepBmsFeedback;
#else
typedef uint32_t VoltstepBmsFeedback;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What somebody asks for.
enum VoltstepBmsWish
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nobody is there, or has not been heard in time.
  VOLTSTEP_BMS_WISH_SILENT = 0,
  // Open.
  VOLTSTEP_BMS_WISH_OFF = 1,
  // Close to drive.
  VOLTSTEP_BMS_WISH_DRIVE = 2,
  // Close to charge.
  VOLTSTEP_BMS_WISH_CHARGE = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsWish VoltstepBmsWish;
#else
typedef uint32_t VoltstepBmsWish;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Which faults to end.
enum VoltstepBmsClear
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // None.
  VOLTSTEP_BMS_CLEAR_NO = 0,
  // What a reset by the driver or the vehicle may end.
  VOLTSTEP_BMS_CLEAR_RESET = 1,
  // What a workshop may end, too.
  VOLTSTEP_BMS_CLEAR_SERVICE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsClear VoltstepBmsClear;
#else
typedef uint32_t VoltstepBmsClear;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the BMS watches: a row of its table is a bit in the sets of rows, row k in word k/32. Limits
// are the field's three, each inside the next: maximum operating (MOL), recommended safety (RSL) and
// maximum safety limit (MSL).
enum VoltstepBmsRow
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The lowest cell against its MOL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_LOW_MOL = 0,
  // The lowest cell against its RSL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_LOW_RSL = 1,
  // The lowest cell against its MSL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_LOW_MSL = 2,
  // The highest cell against its MOL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_HIGH_MOL = 3,
  // The highest cell against its RSL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_HIGH_RSL = 4,
  // The highest cell against its MSL.
  VOLTSTEP_BMS_ROW_CELL_VOLTAGE_HIGH_MSL = 5,
  // The coldest sensor against the MOL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_LOW_MOL = 6,
  // The coldest sensor against the RSL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_LOW_RSL = 7,
  // The coldest sensor against the MSL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_LOW_MSL = 8,
  // The hottest sensor against the MOL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_HIGH_MOL = 9,
  // The hottest sensor against the RSL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_HIGH_RSL = 10,
  // The hottest sensor against the MSL of discharging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_DISCHARGE_HIGH_MSL = 11,
  // The coldest sensor against the MOL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_LOW_MOL = 12,
  // The coldest sensor against the RSL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_LOW_RSL = 13,
  // The coldest sensor against the MSL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_LOW_MSL = 14,
  // The hottest sensor against the MOL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_HIGH_MOL = 15,
  // The hottest sensor against the RSL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_HIGH_RSL = 16,
  // The hottest sensor against the MSL of charging.
  VOLTSTEP_BMS_ROW_TEMPERATURE_CHARGE_HIGH_MSL = 17,
  // The pack's current against the MOL of discharging.
  VOLTSTEP_BMS_ROW_CURRENT_DISCHARGE_MOL = 18,
  // The pack's current against the RSL of discharging.
  VOLTSTEP_BMS_ROW_CURRENT_DISCHARGE_RSL = 19,
  // The pack's current against the MSL of discharging.
  VOLTSTEP_BMS_ROW_CURRENT_DISCHARGE_MSL = 20,
  // The pack's current against the MOL of charging.
  VOLTSTEP_BMS_ROW_CURRENT_CHARGE_MOL = 21,
  // The pack's current against the RSL of charging.
  VOLTSTEP_BMS_ROW_CURRENT_CHARGE_RSL = 22,
  // The pack's current against the MSL of charging.
  VOLTSTEP_BMS_ROW_CURRENT_CHARGE_MSL = 23,
  // Twice the short-time current of discharging.
  VOLTSTEP_BMS_ROW_SURGE_DISCHARGE = 24,
  // Twice the short-time current of charging.
  VOLTSTEP_BMS_ROW_SURGE_CHARGE = 25,
  // Charge of squared current beyond the continuous one of discharging.
  VOLTSTEP_BMS_ROW_HEAT_DISCHARGE = 26,
  // Charge of squared current beyond the continuous one of charging.
  VOLTSTEP_BMS_ROW_HEAT_CHARGE = 27,
  // The pack's voltage is too low.
  VOLTSTEP_BMS_ROW_PACK_VOLTAGE_LOW = 28,
  // The pack's voltage is too high.
  VOLTSTEP_BMS_ROW_PACK_VOLTAGE_HIGH = 29,
  // No value of the cells' voltages, or an old one.
  VOLTSTEP_BMS_ROW_STALE_CELL = 30,
  // No value of temperatures, or an old one.
  VOLTSTEP_BMS_ROW_STALE_TEMPERATURE = 31,
  // No value of the current, or an old one.
  VOLTSTEP_BMS_ROW_STALE_CURRENT = 32,
  // No value of the pack's voltage, or an old one.
  VOLTSTEP_BMS_ROW_STALE_PACK = 33,
  // No value of the link's voltage, or an old one.
  VOLTSTEP_BMS_ROW_STALE_LINK = 34,
  // A value of the cells' voltages that the sensor cannot show.
  VOLTSTEP_BMS_ROW_RANGE_CELL = 35,
  // A value of temperatures that the sensor cannot show.
  VOLTSTEP_BMS_ROW_RANGE_TEMPERATURE = 36,
  // A value of the current that the sensor cannot show.
  VOLTSTEP_BMS_ROW_RANGE_CURRENT = 37,
  // A value of the pack's voltage that the sensor cannot show.
  VOLTSTEP_BMS_ROW_RANGE_PACK = 38,
  // A value of the link's voltage that the sensor cannot show.
  VOLTSTEP_BMS_ROW_RANGE_LINK = 39,
  // The contactor minus does not show what it was told.
  VOLTSTEP_BMS_ROW_FEEDBACK_MINUS = 40,
  // The contactor precharge does not show what it was told.
  VOLTSTEP_BMS_ROW_FEEDBACK_PRECHARGE = 41,
  // The contactor plus does not show what it was told.
  VOLTSTEP_BMS_ROW_FEEDBACK_PLUS = 42,
  // The contactor minus does not open.
  VOLTSTEP_BMS_ROW_WELD_MINUS = 43,
  // The contactor precharge does not open.
  VOLTSTEP_BMS_ROW_WELD_PRECHARGE = 44,
  // The contactor plus does not open.
  VOLTSTEP_BMS_ROW_WELD_PLUS = 45,
  // Precharge: current flows, the link does not rise.
  VOLTSTEP_BMS_ROW_PRECHARGE_SHORT = 46,
  // Precharge: no current flows.
  VOLTSTEP_BMS_ROW_PRECHARGE_OPEN = 47,
  // Precharge: the link rises too slowly.
  VOLTSTEP_BMS_ROW_PRECHARGE_SLOW = 48,
  // Precharge: the resistor is too warm for another try.
  VOLTSTEP_BMS_ROW_PRECHARGE_HOT = 49,
  // Resistance to the chassis against its MOL.
  VOLTSTEP_BMS_ROW_INSULATION_MOL = 50,
  // Resistance to the chassis against its RSL.
  VOLTSTEP_BMS_ROW_INSULATION_RSL = 51,
  // Resistance to the chassis against its MSL.
  VOLTSTEP_BMS_ROW_INSULATION_MSL = 52,
  // A cell so far down that it must not be charged again without a look.
  VOLTSTEP_BMS_ROW_DEEP_DISCHARGE = 53,
  // Current though every contactor is open.
  VOLTSTEP_BMS_ROW_CURRENT_WHILE_OPEN = 54,
  // The current sensor is near its end, or a comparator says so.
  VOLTSTEP_BMS_ROW_SHORT_CIRCUIT = 55,
  // The sum of the cells against the pack.
  VOLTSTEP_BMS_ROW_CELL_SUM = 56,
  // The link against the pack while both mains are closed.
  VOLTSTEP_BMS_ROW_LINK_DIFFERS = 57,
  // Two current sensors against each other.
  VOLTSTEP_BMS_ROW_CURRENTS_DIFFER = 58,
  // The mean cell against its model.
  VOLTSTEP_BMS_ROW_RESIDUAL = 59,
  // The front end counts other cells than there are.
  VOLTSTEP_BMS_ROW_CELL_COUNT = 60,
  // A cell that does not move when the current does, or moves when nothing does.
  VOLTSTEP_BMS_ROW_STUCK_CELL = 61,
  // A temperature that does not move when the others do, or falls faster than anything cools.
  VOLTSTEP_BMS_ROW_STUCK_TEMPERATURE = 62,
  // A current that does not move when the cells do, or moves and they do not.
  VOLTSTEP_BMS_ROW_STUCK_CURRENT = 63,
  // Highest less lowest cell.
  VOLTSTEP_BMS_ROW_IMBALANCE = 64,
  // Hottest less coldest sensor.
  VOLTSTEP_BMS_ROW_TEMPERATURE_SPREAD = 65,
  // How fast the fastest sensor warms up beyond what the current explains.
  VOLTSTEP_BMS_ROW_TEMPERATURE_RATE = 66,
  // A wire between cells and front end.
  VOLTSTEP_BMS_ROW_OPEN_WIRE = 67,
  // A pin that drives or reads a contactor fails.
  VOLTSTEP_BMS_ROW_PIN = 68,
  // The link rises before it is precharged, or a contactor shows closed that is not driven.
  VOLTSTEP_BMS_ROW_BYPASSED = 69,
  // The loop through the connectors is open.
  VOLTSTEP_BMS_ROW_INTERLOCK = 70,
  // The vehicle reports a crash.
  VOLTSTEP_BMS_ROW_CRASH = 71,
  // The supply of the control unit is low.
  VOLTSTEP_BMS_ROW_SUPPLY = 72,
  // The coolant pump or level is not as it should be.
  VOLTSTEP_BMS_ROW_COOLANT = 73,
  // No valid request in time.
  VOLTSTEP_BMS_ROW_REQUEST_LOST = 74,
  // Requests whose checksum or counter is wrong.
  VOLTSTEP_BMS_ROW_REQUEST_CORRUPT = 75,
  // The charger is silent.
  VOLTSTEP_BMS_ROW_CHARGER_LOST = 76,
  // The time between two calls.
  VOLTSTEP_BMS_ROW_LATE_STEP = 77,
  // The record is damaged or cannot be written.
  VOLTSTEP_BMS_ROW_RECORD = 78,
  // The parameters are not those that were checked.
  VOLTSTEP_BMS_ROW_PARAMETERS = 79,
  // The log cannot be written.
  VOLTSTEP_BMS_ROW_LOG_STORE = 80,
  // The estimator says that it is lost.
  VOLTSTEP_BMS_ROW_ESTIMATOR = 81,
  // A bleed switch does not do what it was told.
  VOLTSTEP_BMS_ROW_BLEED_STUCK = 82,
  // The balancing board is hot.
  VOLTSTEP_BMS_ROW_BLEED_HOT = 83,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsRow VoltstepBmsRow;
#else
typedef uint32_t VoltstepBmsRow;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Where the contactors are in their order.
enum VoltstepBmsPhase
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // After a reset: nothing is known yet.
  VOLTSTEP_BMS_PHASE_START = 0,
  // All open, ready.
  VOLTSTEP_BMS_PHASE_STANDBY = 1,
  // The main contactor at the negative pole closes.
  VOLTSTEP_BMS_PHASE_CLOSE_MINUS = 2,
  // The link is charged through the resistor.
  VOLTSTEP_BMS_PHASE_PRECHARGE = 3,
  // The main contactor at the positive pole closes.
  VOLTSTEP_BMS_PHASE_CLOSE_PLUS = 4,
  // The precharge contactor opens.
  VOLTSTEP_BMS_PHASE_OPEN_PRECHARGE = 5,
  // Both mains are closed.
  VOLTSTEP_BMS_PHASE_CLOSED = 6,
  // Both are closed still, and no power is allowed.
  VOLTSTEP_BMS_PHASE_SHED = 7,
  // The main contactor at the positive pole opens.
  VOLTSTEP_BMS_PHASE_OPEN_FIRST = 8,
  // All open.
  VOLTSTEP_BMS_PHASE_OPEN_SECOND = 9,
  // All should be open: are they?
  VOLTSTEP_BMS_PHASE_WELD_CHECK = 10,
  // A pause before the next try.
  VOLTSTEP_BMS_PHASE_COOLDOWN = 11,
  // All open, until somebody clears it.
  VOLTSTEP_BMS_PHASE_FAULT = 12,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsPhase VoltstepBmsPhase;
#else
typedef uint32_t VoltstepBmsPhase;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why the contactors opened, or may not close.
enum VoltstepBmsCause
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nothing, or the request ended.
  VOLTSTEP_BMS_CAUSE_NONE = 0,
  // A trip that let the power be taken back first.
  VOLTSTEP_BMS_CAUSE_SOFT = 1,
  // A trip at a safety limit.
  VOLTSTEP_BMS_CAUSE_HARD = 2,
  // A crash.
  VOLTSTEP_BMS_CAUSE_CRASH = 3,
  // Data went missing while closing, or never came.
  VOLTSTEP_BMS_CAUSE_LOST = 4,
  // Minus does not show closed.
  VOLTSTEP_BMS_CAUSE_MINUS_STUCK_OPEN = 5,
  // Plus does not show closed.
  VOLTSTEP_BMS_CAUSE_PLUS_STUCK_OPEN = 6,
  // Precharge does not show closed.
  VOLTSTEP_BMS_CAUSE_PRECHARGE_STUCK_OPEN = 7,
  // Precharge does not show open.
  VOLTSTEP_BMS_CAUSE_PRECHARGE_STUCK_CLOSED = 8,
  // Current flows, the link stays down.
  VOLTSTEP_BMS_CAUSE_PRECHARGE_SHORT = 9,
  // No current flows into the link.
  VOLTSTEP_BMS_CAUSE_PRECHARGE_OPEN = 10,
  // The link rises too slowly.
  VOLTSTEP_BMS_CAUSE_PRECHARGE_SLOW = 11,
  // The link rises, or a contactor shows closed, before its turn.
  VOLTSTEP_BMS_CAUSE_BYPASSED = 12,
  // A main that was closed shows open.
  VOLTSTEP_BMS_CAUSE_DROPPED = 13,
  // One shows closed that should be open.
  VOLTSTEP_BMS_CAUSE_WELDED = 14,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsCause VoltstepBmsCause;
#else
typedef uint32_t VoltstepBmsCause;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What is done of what is asked for.
enum VoltstepBmsMode
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Open.
  VOLTSTEP_BMS_MODE_OFF = 0,
  // Closed to drive.
  VOLTSTEP_BMS_MODE_DRIVE = 1,
  // Closed to charge.
  VOLTSTEP_BMS_MODE_CHARGE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsMode VoltstepBmsMode;
#else
typedef uint32_t VoltstepBmsMode;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What the rows tell the contactors.
enum VoltstepBmsTrip
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Nothing: go on.
  VOLTSTEP_BMS_TRIP_NONE = 0,
  // Power is taken back over seconds, then they open.
  VOLTSTEP_BMS_TRIP_SOFT = 1,
  // They open after a short wait for the current.
  VOLTSTEP_BMS_TRIP_HARD = 2,
  // They open at once.
  VOLTSTEP_BMS_TRIP_CRASH = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsTrip VoltstepBmsTrip;
#else
typedef uint32_t VoltstepBmsTrip;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Why not more may be drawn or fed.
enum VoltstepBmsLimited
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // By what the cells allow.
  VOLTSTEP_BMS_LIMITED_CELLS = 0,
  // By the largest current of the pack.
  VOLTSTEP_BMS_LIMITED_PACK = 1,
  // A row takes back power.
  VOLTSTEP_BMS_LIMITED_DERATED = 2,
  // A safety limit of this direction is broken.
  VOLTSTEP_BMS_LIMITED_BARRED = 3,
  // Too cold to charge.
  VOLTSTEP_BMS_LIMITED_COLD = 4,
  // What the cells allow, or how warm they are, is not known.
  VOLTSTEP_BMS_LIMITED_UNKNOWN = 5,
  // The contactors are about to open.
  VOLTSTEP_BMS_LIMITED_ENDING = 6,
  // The contactors are not closed.
  VOLTSTEP_BMS_LIMITED_OPEN = 7,
  // It is still on its way from another limit.
  VOLTSTEP_BMS_LIMITED_RATE = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepBmsLimited VoltstepBmsLimited;
#else
typedef uint32_t VoltstepBmsLimited;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Voltages of a cell in V, rising.
typedef struct VoltstepBmsVoltages {
  // Below this, not to be charged again without a look at the cell; above zero.
  float deep_v;
  // The absolute minimum of the data sheet.
  float absolute_min_v;
  // Where discharging ends.
  float operating_min_v;
  // Where charging ends.
  float operating_max_v;
  // The absolute maximum of the data sheet.
  float absolute_max_v;
} VoltstepBmsVoltages;

// Currents of a cell in one direction in A.
typedef struct VoltstepBmsCurrents {
  // Continuous; above zero.
  float continuous_a;
  // For ten seconds; above the continuous one.
  float ten_seconds_a;
} VoltstepBmsCurrents;

// The share of the largest current at a temperature: none outside, all within, a line in between.
// In degC, each not below the one before.
typedef struct VoltstepTemperatureWindow {
  // None below.
  float none_below_c;
  // All from here on.
  float all_from_c;
  // All up to here.
  float all_to_c;
  // None above.
  float none_above_c;
} VoltstepTemperatureWindow;

// A cell in the terms of its data sheet.
typedef struct VoltstepBmsCellSheet {
  // Its voltages.
  struct VoltstepBmsVoltages voltage;
  // Its currents when discharging.
  struct VoltstepBmsCurrents discharge;
  // Its currents when charging.
  struct VoltstepBmsCurrents charge;
  // Temperatures at which it may be discharged, each above the one before; `none_below_c` and
  // `none_above_c` are the absolute limits, the others those of operation.
  struct VoltstepTemperatureWindow discharge_window;
  // Temperatures at which it may be charged, likewise.
  struct VoltstepTemperatureWindow charge_window;
  // Capacity in A h; above zero.
  float capacity_ah;
  // The largest resistance within its life and its windows in ohm; above zero.
  float resistance_ohm;
  // Heat capacity in J/K; above zero.
  float heat_capacity_j_per_k;
} VoltstepBmsCellSheet;

// How many cells.
typedef struct VoltstepBmsLayout {
  // In series: the number that the library is built for.
  uint16_t series;
  // In parallel; at least 1.
  uint16_t parallel;
} VoltstepBmsLayout;

// A kind of sensor; its unit is that of the quantity.
typedef struct VoltstepBmsSensor {
  // How far a value may be off, offset and gain together; zero or above.
  float error;
  // Standard deviation of its noise; zero or above.
  float noise_sd;
  // What one step of its converter means; above zero.
  float resolution;
  // Time between two values in s; above zero.
  float period_s;
  // The lowest value that it can show.
  float lowest;
  // The highest value that it can show, above the lowest. What lies outside is no value but a
  // sentinel, or in another unit.
  float highest;
} VoltstepBmsSensor;

// The sensors.
typedef struct VoltstepBmsSensing {
  // Of the cells' voltages in V.
  struct VoltstepBmsSensor cell_v;
  // Of temperatures in degC.
  struct VoltstepBmsSensor temperature_c;
  // Of the pack's current in A.
  struct VoltstepBmsSensor current_a;
  // Of the pack's voltage in V.
  struct VoltstepBmsSensor pack_v;
  // Of the voltage behind the contactors in V.
  struct VoltstepBmsSensor link_v;
} VoltstepBmsSensing;

// What opens the circuit.
typedef struct VoltstepBmsActuators {
  // From the command until the contactor is open in s; above zero.
  float open_s;
  // How long an opening for safety waits for a smaller current in s; zero or above.
  float wait_s;
  // The largest current that a contactor breaks without harm in A; above zero.
  float break_a;
} VoltstepBmsActuators;

// All that the rows of protection are derived from.
typedef struct VoltstepBmsSheet {
  // One cell.
  struct VoltstepBmsCellSheet cell;
  // How many of them.
  struct VoltstepBmsLayout layout;
  // What measures them.
  struct VoltstepBmsSensing sensing;
  // What protects them.
  struct VoltstepBmsActuators actuators;
  // Time between two calls in s, 0.0001..0.005.
  float tick_s;
  // Calls in which every cell and every temperature is looked at once; at least 1, together at most
  // 25 ms.
  uint16_t sweep_ticks;
} VoltstepBmsSheet;

// A resistance over state of charge and temperature:
// `ohm(soc) * exp(activation_k * (1/T - 1/298.15 K))`.
typedef struct VoltstepResistanceMap {
  // At 25 degC and state of charge i/64, in ohm; zero or above.
  float ohm[VOLTSTEP_SOC_POINTS];
  // Activation temperature in K, 0..20000; 0 for no dependence on temperature.
  float activation_k;
} VoltstepResistanceMap;

// A cell, or a pack as one: resistances over state of charge and temperature, two RC branches,
// hysteresis, a thermal node.
typedef struct VoltstepCellParams {
  // Charge between state of charge 0 and 1, in A h; above zero.
  float capacity_ah;
  // Largest discharge current in A; above zero, infinity for none.
  float discharge_limit_a;
  // Largest charge current in A; above zero, infinity for none.
  float charge_limit_a;
  // How often resistances follow state of charge and temperature, in s; above zero.
  float refresh_s;
  // Open-circuit voltage at state of charge i/64, in V; zero or above, must not fall.
  float open_circuit_v[VOLTSTEP_SOC_POINTS];
  // Half the gap between the curves of charge and discharge, in V; zero or above.
  float hysteresis_half_gap_v;
  // How fast a change of the state of charge moves from one curve to the other, a ratio; zero or
  // above.
  float hysteresis_rate_per_soc;
  // Series resistance.
  struct VoltstepResistanceMap series;
  // Resistance of the faster RC branch.
  struct VoltstepResistanceMap polarisation;
  // Its time constant in s; above zero.
  float polarisation_time_constant_s;
  // Resistance of the slower RC branch; zeros for no such branch.
  struct VoltstepResistanceMap second_polarisation;
  // Its time constant in s; above zero.
  float second_polarisation_time_constant_s;
  // Heat capacity in J/K; above zero, infinity: the temperature stays as it is.
  float heat_capacity_j_per_k;
  // Cooling to the surroundings in W/K; zero or above.
  float cooling_w_per_k;
  // Temperature of the surroundings in degC, -100..200.
  float ambient_c;
  // Lowest state of charge at which all this was identified, a ratio 0..1.
  float identified_soc_min;
  // Highest such state of charge, above the lowest, up to 1.
  float identified_soc_max;
  // Lowest temperature at which all this was identified, in degC, -100..200.
  float identified_temperature_min_c;
  // Highest such temperature in degC, not below the lowest, up to 200.
  float identified_temperature_max_c;
} VoltstepCellParams;

// How alike the cells are.
typedef struct VoltstepBmsAlike {
  // Series resistance of a new cell at 25 degC in ohm; above zero.
  float resistance_ohm;
  // Standard deviation of the cells' resistances, a ratio; above zero.
  float resistance_sd;
  // Standard deviation of their capacities, a ratio 0..1.
  float capacity_sd;
  // Standard deviation of their states of charge at the start, a ratio; above 0, up to 1.
  float soc_sd;
  // How far one wanders from the others in a day, as a state of charge, 0..1.
  float drift_sd_per_day;
} VoltstepBmsAlike;

// Precharge of the link.
typedef struct VoltstepBmsPrecharge {
  // Resistor in ohm; above zero.
  float resistor_ohm;
  // Capacitance of the link in F; above zero; with the resistor two steps at least.
  float link_f;
  // By what factor the time constant may be off; above 1.
  float tau_factor;
  // Noise of the voltage difference between pack and link in V; zero or above.
  float noise_v;
  // Noise of the current in A; zero or above.
  float noise_a;
  // The link is charged when it lacks no more than this, in V; above zero.
  float done_v;
  // Samples in a row before any verdict, 2..100.
  uint8_t count;
  // From the feedback until current flows, bouncing included, in s; zero or above.
  float lag_s;
  // What the resistor may take up at once in J; above zero.
  float budget_j;
  // What a precharge into a short costs until it is told in J; below the budget.
  float short_j;
  // Time constant with which it cools down in s; above zero.
  float cooling_s;
} VoltstepBmsPrecharge;

// How long the contactors may take.
typedef struct VoltstepBmsContactors {
  // Until everything was seen after a reset in s; above zero.
  float start_limit_s;
  // With minus closed alone, to see whether the link rises, in s; above zero.
  float settle_s;
  // Until a contactor shows closed in s; above `settle_s`.
  float close_limit_s;
  // Until the link is charged in s; above zero.
  float precharge_limit_s;
  // Until a contactor shows open in s; above zero.
  float open_limit_s;
  // For a current that can be broken, where there is time, in s; at least `hard_limit_s`.
  float shed_limit_s;
  // For such a current at a safety limit in s; above zero.
  float hard_limit_s;
  // For the link to fall in s; above zero.
  float weld_limit_s;
  // Before the next try in s; above zero.
  float cooldown_s;
  // Tries of a precharge that are allowed to fail while one request stands, 1..10.
  uint8_t tries;
} VoltstepBmsContactors;

// What bleeds cells.
typedef struct VoltstepBmsBalancing {
  // Resistor across a cell in ohm; above zero.
  float bleed_ohm;
  // The most channels at once; at least 1.
  uint16_t channels;
  // No bleeding with the board warmer than this, in degC.
  float board_max_c;
} VoltstepBmsBalancing;

// All that a BMS is made from. Start from `voltstep_bms_params_typical`.
typedef struct VoltstepBmsParams {
  // `VOLTSTEP_ABI`.
  uint32_t abi;
  // Temperatures: the number that the library is built for.
  uint32_t sensors;
  // Cell, layout, sensors and contactors, in the terms of their data sheets.
  struct VoltstepBmsSheet sheet;
  // The map of one cell, as `voltstep identify battery` finds it.
  struct VoltstepCellParams cell;
  // How alike the cells are.
  struct VoltstepBmsAlike alike;
  // Standard deviation of the pack's current sensor's offset in A; zero or above.
  float current_offset_sd_a;
  // Standard deviation of its gain, a ratio 0..1.
  float current_gain_sd;
  // How late voltages may be for the current in s; zero or above.
  float skew_s;
  // Time between two samples of the filter in s, 0.05..0.25, a whole part of a second and a whole
  // number of ticks.
  float sample_s;
  // What counts as a rest in s; above zero.
  float rest_s;
  // What counts as empty, a ratio 0..1.
  float empty_soc;
  // Precharge of the link.
  struct VoltstepBmsPrecharge precharge;
  // How long contactors may take.
  struct VoltstepBmsContactors contactors;
  // What bleeds cells.
  struct VoltstepBmsBalancing balancing;
} VoltstepBmsParams;

// A whole BMS, derived from its description. Opaque: set it up by `voltstep_bms_init` where it
// stays, a copy is refused; from then on it is only read. Sets of rows are 128 bits, which some
// machines want aligned.
typedef struct VOLTSTEP_ALIGNED(16) VoltstepBms {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_BMS_WORDS];
} VoltstepBms;

// What a BMS remembers. Opaque: set it up by `voltstep_bms_start`. A snapshot is a copy.
typedef struct VOLTSTEP_ALIGNED(16) VoltstepBmsState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_BMS_STATE_WORDS];
} VoltstepBmsState;

// What is worth knowing after a power cut.
typedef struct VoltstepRecord {
  // State of charge, a ratio 0..1.
  float soc;
  // Its standard deviation, a ratio 0..1.
  float soc_sd;
  // Capacity in A h; above 0, up to 1e6.
  float capacity_ah;
  // Its standard deviation in A h, 0 up to the capacity.
  float capacity_sd_ah;
  // Resistance as a multiple of that of a new cell, 0.01..100.
  float resistance_factor;
  // Its standard deviation, 0..100.
  float resistance_factor_sd;
  // What the current sensor shows without a current in A, within +-10000.
  float current_offset_a;
  // Its standard deviation in A, 0..10000.
  float current_offset_sd_a;
  // Charge that has gone in or out over the life in A h, 0..1e9.
  float throughput_ah;
  // Other than 0: the time is known.
  uint32_t timed;
  // When this was written, in s on a clock of the product's own.
  uint32_t written_at_s;
  // Other than 0: what the last minutes left in the cell is known.
  uint32_t polarised;
  // Voltage across the RC branches, the faster first, in V, within +-10000.
  float polarisation_v[2];
  // Mean magnitude of the current over the last minutes in A, 0..1e5.
  float load_a;
  // Where between the curves of discharge (-1) and charge (1) the open-circuit voltage lies.
  float hysteresis;
  // Heat in the precharge resistor in J, 0..1e6.
  float resistor_heat_j;
  // Why the contactors must stay open, a number of the product's own; 0: they need not.
  uint16_t lock_out_cause;
  // Sequence number of the newest entry of the product's log.
  uint32_t log_sequence;
} VoltstepRecord;

// What vehicle and charger ask for.
typedef struct VoltstepBmsRequest {
  // One of `VoltstepBmsWish`; another number is not understood, and opens.
  uint32_t vehicle;
  // The charger's, likewise.
  uint32_t charger;
  // One of `VoltstepBmsClear` (another number: none); each wish counts once.
  uint32_t clear;
  // What is wrong with their messages, a bit for each of `VoltstepBmsRow`, row k in word k/32.
  uint32_t flags[3];
} VoltstepBmsRequest;

// What the hardware knows in a tick. Values that are not new keep what they were and grow older; one
// that could not be trusted is given as new and not a number. All zero is a start: nothing is new, nothing
// is fitted. Beyond the cells and temperatures that
// the library is built for nothing is read.
typedef struct VoltstepBmsInputs {
  // Time since the first power-up in us, sleep included; it never goes back.
  uint64_t uptime_us;
  // Other than 0: `cell_v` is new.
  uint32_t cells_new;
  // Voltage of each cell in V.
  float cell_v[VOLTSTEP_BMS_CELLS_MAX];
  // Other than 0: `temperature_c` is new.
  uint32_t temperatures_new;
  // Temperatures in degC.
  float temperature_c[VOLTSTEP_BMS_SENSORS_MAX];
  // Other than 0: `current_a` is new.
  uint32_t current_new;
  // Current of the pack in A, positive when discharging.
  float current_a;
  // Other than 0: `pack_v` is new.
  uint32_t pack_new;
  // Voltage of the cells together, before the contactors, in V.
  float pack_v;
  // Other than 0: `link_v` is new.
  uint32_t link_new;
  // Voltage behind the contactors in V.
  float link_v;
  // What the contactors show, each one of `VoltstepBmsFeedback` (another number: unknown): minus,
  // precharge, plus.
  uint32_t feedback[3];
  // Other than 0: a pin failed when the contactors were last driven.
  uint32_t pin_failed;
  // What the hardware finds bad by itself, a bit for each of `VoltstepBmsRow`, row k in word k/32:
  // interlock, crash, supply, coolant, a comparator of a short circuit, memory.
  uint32_t flags[3];
  // Other than 0: there is a second current sensor.
  uint32_t second_current_measured;
  // What it shows in A; NaN where it could not be trusted.
  float second_current_a;
  // Other than 0: a device watches the insulation.
  uint32_t insulation_watched;
  // Insulation to the chassis in ohm/V; NaN where the device is silent.
  float insulation_ohm_per_v;
  // How many cells the front end found; 0 where it does not count.
  uint16_t cells_found;
  // Other than 0: the wires were tested, `wires_v` is set.
  uint32_t wires_tested;
  // How far each wire moves under the front end's test current in V: one more than cells.
  float wires_v[VOLTSTEP_BMS_WIRES_MAX];
  // Temperature of the balancing board in degC.
  float balancing_c;
} VoltstepBmsInputs;

// What the hardware is told.
typedef struct VoltstepBmsOutputs {
  // Close the main contactor at the negative pole.
  bool minus;
  // Close the precharge contactor.
  bool precharge;
  // Close the main contactor at the positive pole.
  bool plus;
  // Bleed each of these cells.
  bool bleed[VOLTSTEP_BMS_CELLS_MAX];
} VoltstepBmsOutputs;

// How a cell differs from the one that its parameters describe.
typedef struct VoltstepHealth {
  // Charge between state of charge 0 and 1, in A h.
  float capacity_ah;
  // Its standard deviation in A h.
  float capacity_sd_ah;
  // Every resistance is larger by this factor.
  float resistance_factor;
  // Its standard deviation.
  float resistance_factor_sd;
} VoltstepHealth;

// What is left until empty, at the average power of the last minute where it is discharged, else at
// that of a five-hour discharge.
typedef struct VoltstepEnergyReport {
  // Charge left in A h.
  float remaining_capacity_ah;
  // Energy left at the terminals in W h.
  float remaining_energy_wh;
  // Its standard deviation in W h.
  float remaining_energy_sd_wh;
  // Charge from full until empty in A h.
  float full_charge_capacity_ah;
  // Energy from full until empty in W h.
  float full_charge_energy_wh;
  // Remaining over full-charge capacity, a ratio 0..1.
  float relative_state_of_charge;
  // Remaining capacity over that of the cell when new, a ratio that may exceed 1.
  float absolute_state_of_charge;
  // Remaining over full-charge energy, a ratio 0..1.
  float state_of_energy;
  // Time until empty in s; NaN where it is not discharged.
  float average_time_to_empty_s;
  // Time until full in s; NaN where it is not charged.
  float average_time_to_full_s;
} VoltstepEnergyReport;

// How far several readings of one quantity lie apart; NaN where none is usable.
typedef struct VoltstepBmsSpread {
  // The lowest.
  float min;
  // The mean.
  float mean;
  // The highest.
  float max;
  // Which reading is the lowest; the first where several are.
  uint32_t min_index;
  // Which reading is the highest; the first where several are.
  uint32_t max_index;
  // How many are usable.
  uint32_t usable;
} VoltstepBmsSpread;

// What a BMS knows. Charge, energy and currents are those of the pack.
typedef struct VoltstepBmsReport {
  // State of charge, a ratio 0..1.
  float soc;
  // Its standard deviation, a ratio.
  float soc_sd;
  // It comes from counting alone, which knows better than the filter, or the filter contradicts
  // itself.
  bool soc_counted;
  // The filter's standard deviation is small enough to count as known.
  bool converged;
  // The model's error, and the mean residual beside it, are of the size that is expected.
  bool consistent;
  // The open-circuit curve is flat here: the voltage does not correct.
  bool flat;
  // State of charge or temperature lie outside the identified range.
  bool outside_identified;
  // The temperature is not known; the last one holds.
  bool temperature_missing;
  // Lowest state of charge of a cell, a ratio 0..1.
  float soc_min;
  // Mean of the cells' states of charge, a ratio 0..1.
  float soc_mean;
  // Highest state of charge of a cell, a ratio 0..1.
  float soc_max;
  // Which cell has the lowest.
  uint32_t soc_min_index;
  // Which cell has the highest.
  uint32_t soc_max_index;
  // Capacity of the pack in A h.
  float capacity_ah;
  // Health of the mean cell.
  struct VoltstepHealth health;
  // Energy and time left of the pack; NaN in the first second.
  struct VoltstepEnergyReport energy;
  // What may be drawn in A; zero or above.
  float discharge_limit_a;
  // Why not more: one of `VoltstepBmsLimited`.
  uint32_t discharge_limited;
  // What may be fed in A; zero or above.
  float charge_limit_a;
  // Why not more: one of `VoltstepBmsLimited`.
  uint32_t charge_limited;
  // Voltages of the cells in V.
  struct VoltstepBmsSpread cell_v;
  // Temperatures in degC.
  struct VoltstepBmsSpread temperature_c;
  // Current in A, positive when discharging; NaN where it is not known.
  float current_a;
  // Voltage of the pack in V; NaN where it is not known.
  float pack_v;
  // Voltage behind the contactors in V; NaN where it is not known.
  float link_v;
  // What is done of what is asked for: one of `VoltstepBmsMode`.
  uint32_t mode;
  // Where the contactors are: one of `VoltstepBmsPhase`.
  uint32_t phase;
  // Why they opened, or may not close: one of `VoltstepBmsCause`.
  uint32_t cause;
  // What the rows tell the contactors: one of `VoltstepBmsTrip`.
  uint32_t trip;
  // Everything was seen, and nothing that forbids to close has tripped or is latched.
  bool permit;
  // Rows that have tripped and not healed, a bit for each of `VoltstepBmsRow`, row k in word k/32.
  uint32_t tripped[3];
  // Rows that stay until somebody ends them, likewise.
  uint32_t latched[3];
  // Charge that went through the pack over its life in A h.
  float throughput_ah;
} VoltstepBmsReport;

// Every estimator of a cell, checked and discretised for the time between two samples. Opaque: set
// it up by `voltstep_estimators_init` where it stays, a copy is refused; from then on it is only
// read, so any number of states may share it.
typedef struct VoltstepEstimators {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_ESTIMATORS_WORDS];
} VoltstepEstimators;

// What the coulomb counter remembers. Opaque; a snapshot is a copy.
typedef struct VoltstepCounterState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_COUNTER_STATE_WORDS];
} VoltstepCounterState;

// What the coulomb counter says.
typedef struct VoltstepCounterOutputs {
  // State of charge, a ratio 0..1.
  float soc;
  // Its standard deviation, a ratio.
  float soc_sd;
  // A reading was missing or too large since the last review: the uncertainty grew.
  bool current_missing;
  // The count was put right from the voltage at rest.
  bool anchored;
  // At rest, but the voltage lies so far outside the curve that it was not used.
  bool voltage_implausible;
} VoltstepCounterOutputs;

// What the filter remembers. Opaque; a snapshot is a copy.
typedef struct VoltstepFilterState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_FILTER_STATE_WORDS];
} VoltstepFilterState;

// One sample of the filter; NaN where there is no usable reading.
typedef struct VoltstepFilterInput {
  // Current in A, positive when discharging.
  float current_a;
  // Voltage at the terminals in V.
  float voltage_v;
  // Temperature in degC. A missing one is the last one.
  float temperature_c;
  // Other than 0: the contactors are open, no current flows, what the sensor shows is its offset.
  uint32_t contactors_open;
} VoltstepFilterInput;

// What is believed to be in a cell, or in a pack as one.
typedef struct VoltstepEstimate {
  // State of charge, a ratio 0..1.
  float soc;
  // Its standard deviation, a ratio.
  float soc_sd;
  // Voltage across the RC branches, the faster first, positive when discharging, in V.
  float polarisation_v[2];
  // Where between the curves of discharge (-1) and charge (1) the open-circuit voltage lies.
  float hysteresis;
  // What the terminals show above what the model expects, in V.
  float offset_v;
  // Temperature in degC.
  float temperature_c;
} VoltstepEstimate;

// What the filter believes after a sample, and what to think of it.
typedef struct VoltstepFilterOutputs {
  // What is believed.
  struct VoltstepEstimate estimate;
  // Measured voltage less the expected one, in V; 0 without a sample.
  float residual_v;
  // The standard deviation is below the `converged_sd` of the parameters.
  bool converged;
  // The model's error, and the mean residual beside it, are of the size that is expected.
  bool consistent;
  // The open-circuit curve is flat here: the voltage does not correct.
  bool flat;
  // State of charge or temperature lie outside the identified range.
  bool outside_identified;
  // The temperature is not known; the last one holds.
  bool temperature_missing;
  // Current or voltage was missing or absurd: the estimate is held, its uncertainty grows.
  bool rejected;
} VoltstepFilterOutputs;

// The filter: how well cell and sensors are known, as standard deviations of what stays wrong, not
// of noise.
typedef struct VoltstepFilterParams {
  // Of the open-circuit curve, in V; above zero.
  float open_circuit_sd_v;
  // Of all resistances at 25 degC, as a ratio to them; zero or above.
  float resistance_sd;
  // Of their activation temperature, in K; zero or above.
  float activation_sd_k;
  // Of the capacity, as a ratio to it; zero or above.
  float capacity_sd;
  // Of the current sensor's offset, in A; zero or above.
  float current_offset_sd_a;
  // Of the current that flows while nothing is measured, the contactors open, in A; zero or
  // above.
  float standby_sd_a;
  // Of one voltage sample, noise and resolution, in V; above zero.
  float voltage_sd_v;
  // Of the polarisation at a start that is not rested, in V; zero or above.
  float polarisation_sd_v;
  // The change of the state of charge after which the curve's error is another one, a ratio;
  // above 0, up to 1.
  float correlation_soc;
  // How many times larger the model's error is outside the identified range; 1 or above.
  float outside_factor;
  // Where the open-circuit curve rises by less than this, in V per unit of state of charge, the
  // voltage does not correct; zero or above.
  float flat_v_per_soc;
  // The standard deviation below which the state of charge counts as known, a ratio; above 0, up
  // to 1.
  float converged_sd;
  // The standard deviation of the current that flows while none is measured, in A; above zero,
  // infinity: the state of charge is unknown after any gap.
  float unseen_current_a;
} VoltstepFilterParams;

// The coulomb counter: its sensor, and when a rest puts it right.
typedef struct VoltstepCounterParams {
  // Standard deviation of the cell's capacity, in A h; zero or above.
  float capacity_sd_ah;
  // Share of the charging current that stays in the cell; above 0, up to 1.
  float charge_efficiency;
  // Standard deviation of the sensor's constant offset, in A; zero or above.
  float offset_sd_a;
  // Standard deviation of its gain, a ratio; zero or above.
  float gain_sd;
  // The largest current of either sign that can flow, in A; above zero. A reading above is none.
  float largest_current_a;
  // Standard deviation of a rested voltage from the open-circuit curve, in V; above zero.
  float rest_voltage_sd_v;
  // At rest the current's magnitude is at most this, in A; above zero.
  float rest_current_a;
  // How long a rest takes until its voltage is believed, in s; above zero.
  float rest_s;
} VoltstepCounterParams;

// How alike the cells in series are, and how well their voltages are measured.
typedef struct VoltstepCellsParams {
  // Standard deviation of the noise of a cell's voltage, in V, 1e-6..1.
  float noise_sd_v;
  // Standard deviation of what stays between its voltage and the curve, in V, 0..1.
  float offset_sd_v;
  // Standard deviation of the cells' resistances, polarisation included, in ohm, 0..1.
  float resistance_sd_ohm;
  // Standard deviation of their capacities, a ratio 0..1.
  float capacity_sd;
  // Standard deviation of their states of charge at the start, a ratio; above 0, up to 1.
  float soc_sd;
  // How far a cell wanders from the others in a day, as a standard deviation of the state of
  // charge, 0..1.
  float drift_sd_per_day;
  // While the mean's own standard deviation is above this ratio, the cells are held; 0..1.
  float pack_soc_sd_max;
  // Lowest voltage that a cell can have, in V, within +-100; a reading below is none.
  float voltage_min_v;
  // Highest voltage that a cell can have, in V, above the lowest, within +-100.
  float voltage_max_v;
} VoltstepCellsParams;

// How each cell's resistance is learnt.
typedef struct VoltstepCellResistancesParams {
  // Of a new cell between two samples, about its series resistance, in ohm; above zero.
  float resistance_ohm;
  // How alike the cells are: standard deviation as a ratio to that; above zero.
  float spread_sd;
  // Standard deviation of the noise of a cell's voltage, in V; above zero.
  float noise_sd_v;
  // The smallest change of the current to learn from, in A; above zero.
  float least_step_a;
  // How many such changes are remembered; above 1.
  float memory_steps;
} VoltstepCellResistancesParams;

// How the resistance of the mean is learnt.
typedef struct VoltstepResistanceParams {
  // Standard deviation of a voltage reading, quantum included, in V; above zero.
  float voltage_sd_v;
  // Standard deviation of a current reading, quantum included, in A; above zero.
  float current_sd_a;
  // The smallest change of the current to learn from, in A; above zero.
  float least_step_a;
  // How many such changes are remembered; above 1.
  float memory_steps;
  // Standard deviation of the factor before anything was learnt; above zero.
  float initial_sd;
  // Voltage and current of a sample may be so far apart in time, in s; zero or above.
  float skew_s;
} VoltstepResistanceParams;

// How the capacity is learnt.
typedef struct VoltstepCapacityParams {
  // Standard deviation of the cell's capacity before anything was learnt, in A h; above zero.
  float nominal_sd_ah;
  // Standard deviation of the noise of one current reading, in A; zero or above.
  float current_noise_sd_a;
  // Standard deviation of the sensor's constant offset, in A; above zero.
  float current_offset_sd_a;
  // Standard deviation of its gain, a ratio; zero or above.
  float current_gain_sd;
  // The smallest change of the state of charge to learn from, a ratio; above zero.
  float least_soc_change;
  // The same in multiples of its own standard deviation; above zero.
  float least_soc_change_sds;
  // How many pairs of rests are remembered; above 1.
  float memory_pairs;
} VoltstepCapacityParams;

// The limits that the state of power keeps, beside the cell's largest currents.
typedef struct VoltstepPowerParams {
  // Lowest voltage at the terminals, in V; above zero.
  float voltage_min_v;
  // Highest voltage at the terminals, in V; above the lowest.
  float voltage_max_v;
  // Lowest state of charge, a ratio 0..1.
  float soc_min;
  // Highest state of charge, above the lowest, up to 1.
  float soc_max;
  // How many standard deviations to stay away from every limit; zero or above.
  float margin_sds;
  // How long the currents must hold, in s; above zero and rising.
  float horizons_s[VOLTSTEP_HORIZONS];
  // Temperatures at which it may be discharged.
  struct VoltstepTemperatureWindow discharge_window;
  // Temperatures at which it may be charged.
  struct VoltstepTemperatureWindow charge_window;
} VoltstepPowerParams;

// What counts as empty and as full.
typedef struct VoltstepEnergyParams {
  // State of charge at which it counts as empty, a ratio 0..1.
  float empty_soc;
  // State of charge at which it counts as full, above that, up to 1.
  float full_soc;
  // Voltage at the terminals at which it counts as empty, too, in V; 0 for none.
  float empty_v;
  // A current below this is none, for the times, in A; above zero.
  float least_a;
} VoltstepEnergyParams;

// Everything that the estimators are told. Start from `voltstep_estimator_params_preset` and change
// what differs. All in the units of one cell, or all in those of a pack as one.
typedef struct VoltstepEstimatorParams {
  // `VOLTSTEP_ABI`.
  uint32_t abi;
  // The cell.
  struct VoltstepCellParams cell;
  // The filter.
  struct VoltstepFilterParams filter;
  // The coulomb counter.
  struct VoltstepCounterParams counter;
  // The cells in series.
  struct VoltstepCellsParams cells;
  // Their resistances.
  struct VoltstepCellResistancesParams cell_resistances;
  // Resistance of the mean.
  struct VoltstepResistanceParams resistance;
  // Capacity of the mean.
  struct VoltstepCapacityParams capacity;
  // State of power.
  struct VoltstepPowerParams power;
  // Energy and time left.
  struct VoltstepEnergyParams energy;
} VoltstepEstimatorParams;

// What was learnt of the resistance. Opaque; a snapshot is a copy.
typedef struct VoltstepResistanceState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_RESISTANCE_STATE_WORDS];
} VoltstepResistanceState;

// What was learnt of the resistance.
typedef struct VoltstepResistanceOutputs {
  // The resistances are larger by this factor.
  float factor;
  // Its standard deviation.
  float factor_sd;
  // This sample changed it.
  bool learned;
  // The factor lies at the end of what is believed: the readings are out of step, or not of this
  // cell.
  bool at_bound;
  // The input was not finite or absurd; the factor is unchanged.
  bool rejected;
} VoltstepResistanceOutputs;

// What was learnt of the capacity. Opaque; a snapshot is a copy.
typedef struct VoltstepCapacityState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_CAPACITY_STATE_WORDS];
} VoltstepCapacityState;

// Two instants whose state of charge is known from their voltage, and what flowed between them.
typedef struct VoltstepCapacityInput {
  // What was believed at the first.
  struct VoltstepEstimate start;
  // What was believed at the second.
  struct VoltstepEstimate end;
  // Charge discharged from the first to the second in A h, negative when charged.
  float discharged_ah;
  // Time from the first to the second in s; zero or above.
  float duration_s;
} VoltstepCapacityInput;

// What was learnt of the capacity.
typedef struct VoltstepCapacityOutputs {
  // Charge between state of charge 0 and 1, in A h.
  float capacity_ah;
  // Its standard deviation in A h.
  float capacity_sd_ah;
  // This pair changed it.
  bool learned;
  // The last pair contradicts what was known; the standard deviation reaches to it.
  bool contradicted;
  // The input was not finite or absurd; nothing changed.
  bool rejected;
} VoltstepCapacityOutputs;

// What may be drawn, or charged.
typedef struct VoltstepAllowance {
  // Constant current in A, zero or above in either direction.
  float current_a;
  // Constant power in W, zero or above in either direction.
  float power_w;
  // The voltage closest to its limit that this current leads to, in V.
  float voltage_v;
  // One of `VoltstepBoundBy`.
  uint32_t bound_by;
} VoltstepAllowance;

// What is allowed over one length of time.
typedef struct VoltstepPowerAhead {
  // How long it holds, in s.
  float horizon_s;
  // Discharging.
  struct VoltstepAllowance discharge;
  // Charging.
  struct VoltstepAllowance charge;
} VoltstepPowerAhead;

// How far the power limits have come. Opaque; a snapshot is a copy.
typedef struct VoltstepPowerWalk {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_POWER_WALK_WORDS];
} VoltstepPowerWalk;

// The rolling averages behind the energy left. Opaque; a snapshot is a copy.
typedef struct VoltstepEnergyState {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_ENERGY_STATE_WORDS];
} VoltstepEnergyState;

// What two slots hold.
typedef struct VoltstepStored {
  // The newest record.
  struct VoltstepRecord record;
  // Its sequence number.
  uint32_t sequence;
  // The slot for the next record, 0 or 1: never that of the newest.
  uint32_t next_slot;
  // The sequence number for the next record.
  uint32_t next_sequence;
  // A slot holds something else than a record or nothing: there may have been a newer record.
  bool damaged;
} VoltstepStored;

// One sample of cells in series.
typedef struct VoltstepSeriesInput {
  // Current of one cell in A, positive when discharging; NaN where there is no usable reading.
  float current_a;
  // Temperature in degC.
  float temperature_c;
  // Other than 0: the contactors are open.
  uint32_t contactors_open;
} VoltstepSeriesInput;

// What is believed of cells in series after a sample.
typedef struct VoltstepSeriesOutputs {
  // Of their mean, by the filter.
  struct VoltstepEstimate estimate;
  // The health of their mean.
  struct VoltstepHealth health;
  // State of charge of their mean by counting, a ratio 0..1.
  float counted_soc;
  // Its standard deviation, a ratio.
  float counted_soc_sd;
  // Lowest state of charge of a cell, a ratio 0..1.
  float soc_min;
  // Highest state of charge of a cell, a ratio 0..1.
  float soc_max;
  // Which cell has the lowest.
  uint32_t soc_min_index;
  // Which cell has the highest.
  uint32_t soc_max_index;
  // The filter's standard deviation is below the `converged_sd` of the parameters.
  bool converged;
  // The model's error, and the mean residual beside it, are of the size that is expected.
  bool consistent;
  // The open-circuit curve is flat here: the voltage does not correct.
  bool flat;
  // State of charge or temperature lie outside the identified range.
  bool outside_identified;
  // The temperature is not known; the last one holds.
  bool temperature_missing;
} VoltstepSeriesOutputs;

// What is believed of one cell in series.
typedef struct VoltstepSeriesCell {
  // State of charge, a ratio 0..1.
  float soc;
  // Its standard deviation, a ratio.
  float soc_sd;
  // Its resistance over the mean of all, a ratio.
  float resistance_ratio;
  // Its standard deviation, a ratio.
  float resistance_ratio_sd;
  // Its voltage said nothing in the last second.
  bool held;
} VoltstepSeriesCell;

// What is known about a battery.
typedef struct VoltstepBatteryParams {
  // One of `VoltstepBatteryModel`.
  uint32_t model;
  // One of `VoltstepOpenCircuit`.
  uint32_t open_circuit;
  // Linear: voltage at state of charge 0, in V.
  float empty_v;
  // Linear: voltage at state of charge 1, in V; not below `empty_v`.
  float full_v;
  // Table: voltage at state of charge i/64, in V; must not fall.
  float table_v[VOLTSTEP_SOC_POINTS];
  // Charge between state of charge 0 and 1, in A h; above zero.
  float capacity_ah;
  // Series resistance in ohm; above zero.
  float series_resistance_ohm;
  // Resistance of the RC branch in ohm; above zero.
  float polarisation_resistance_ohm;
  // Capacitance of the RC branch in F; above zero.
  float polarisation_capacitance_f;
  // Largest discharge current in A; above zero, infinity for none.
  float discharge_limit_a;
  // Largest charge current in A; above zero, infinity for none.
  float charge_limit_a;
} VoltstepBatteryParams;

// What else draws from the battery.
typedef struct VoltstepAuxiliaryParams {
  // Constant power in W; zero or above.
  float power_w;
  // Resistor across the battery in ohm; above zero, infinity for none.
  float resistance_ohm;
  // Below this voltage in V the constant power is cut out; above zero.
  float cut_out_v;
} VoltstepAuxiliaryParams;

// What is known about the converter.
typedef struct VoltstepConverterParams {
  // Largest magnitude of the duty, a ratio; above zero, infinity for none.
  float duty_limit;
  // Loss that does not depend on the load, in W; zero or above.
  float constant_loss_w;
  // Voltage drop against the output current, in V; zero or above, of a synchronous machine's zero.
  float voltage_drop_v;
  // Resistance in the output, in ohm; zero or above.
  float resistance_ohm;
  // Largest magnitude of the output current in A; above zero, infinity for none.
  float current_limit_a;
} VoltstepConverterParams;

// What is known about the DC motor.
typedef struct VoltstepMotorParams {
  // Winding resistance in ohm; above zero.
  float resistance_ohm;
  // Winding inductance in H; above zero.
  float inductance_h;
  // Back-EMF constant in V s/rad; above zero.
  float back_emf_v_s_per_rad;
  // Torque constant in N m/A; above zero.
  float torque_nm_per_a;
  // Rotor inertia in kg m^2; above zero.
  float inertia_kg_m2;
  // Viscous friction in N m s/rad; zero or above.
  float viscous_nm_s_per_rad;
  // Coulomb friction in N m; zero or above.
  float coulomb_nm;
} VoltstepMotorParams;

// What is known about the synchronous machine.
typedef struct VoltstepPmsmParams {
  // Flux linkage of the magnets in Wb, peak of a phase; zero or above, zero only where the
  // inductances differ.
  float magnet_wb;
  // Inductance of the d axis in H; above zero.
  float d_h;
  // Inductance of the q axis in H; above zero.
  float q_h;
  // Resistance of one phase at 25 degrees C in ohm; above zero.
  float resistance_ohm;
  // How much it grows per kelvin; 0..0.007, of copper 1/260.
  float resistance_per_k;
  // Pole pairs, 1..65535.
  uint32_t pole_pairs;
  // Iron loss as a conductance across the induced voltage of each phase, in S; zero or above.
  float iron_s;
  // Rotor inertia in kg m^2; above zero.
  float inertia_kg_m2;
  // Viscous friction in N m s/rad; zero or above.
  float viscous_nm_s_per_rad;
  // Coulomb friction in N m; zero or above.
  float coulomb_nm;
} VoltstepPmsmParams;

// What is known about the gearbox.
typedef struct VoltstepGearboxParams {
  // Motor turns per wheel turn; above zero.
  float ratio;
  // Share of the torque that gets through; above 0, up to 1.
  float efficiency;
  // Inertia at the motor's side in kg m^2; zero or above.
  float inertia_kg_m2;
} VoltstepGearboxParams;

// A part of a drive that heats up: the machine, or the inverter.
typedef struct VoltstepHeatedPartParams {
  // Heat capacity in J/K; above zero, infinity: it stays as warm as the coolant.
  float heat_capacity_j_per_k;
  // Thermal resistance to the coolant in K/W; above zero, infinity for none.
  float coolant_k_per_w;
  // Up to this temperature in degrees C the whole current limit is left; infinity: always.
  float derate_from_c;
  // From this temperature in degrees C on nothing is left; above the other, infinity: never.
  float derate_to_c;
} VoltstepHeatedPartParams;

// How a drive heats up.
typedef struct VoltstepDriveThermalParams {
  // Other than 0: losses heat machine and inverter. 0: they do not, and the rest is not looked at.
  uint32_t heated;
  // Temperature of the coolant in degrees C, -100..200: that of both parts at the start.
  float coolant_c;
  // The machine: its winding counts as warm as the rest.
  struct VoltstepHeatedPartParams machine;
  // The inverter.
  struct VoltstepHeatedPartParams inverter;
  // Temperature in degrees C at which the resistance of the winding is given.
  float reference_c;
  // How much the resistance of the winding grows per kelvin, as a share of what it is at
  // `reference_c`; of copper 1/255 at 20 degrees C. Of a synchronous machine in place of
  // `resistance_per_k`.
  float per_k;
} VoltstepDriveThermalParams;

// A drive: converter, machine and gearbox on an axle.
typedef struct VoltstepDriveParams {
  // One of `VoltstepMachine`.
  uint32_t machine;
  // The converter.
  struct VoltstepConverterParams converter;
  // DC: the machine.
  struct VoltstepMotorParams motor;
  // Synchronous: the machine.
  struct VoltstepPmsmParams pmsm;
  // The gearbox.
  struct VoltstepGearboxParams gearbox;
  // Its temperatures.
  struct VoltstepDriveThermalParams thermal;
  // Bandwidth of the ideal current loop behind a torque demand, in 1/s; above zero.
  float torque_rate_per_s;
  // Of a torque demand this drive takes its share, in proportion to those of the others; above
  // zero.
  float torque_share;
} VoltstepDriveParams;

// What is known about the wheels.
typedef struct VoltstepWheelParams {
  // Rolling radius in m; above zero.
  float radius_m;
  // Inertia of all wheels in kg m^2; zero or above.
  float inertia_kg_m2;
  // Viscous friction in N m s/rad; zero or above.
  float viscous_nm_s_per_rad;
} VoltstepWheelParams;

// What is known about the body.
typedef struct VoltstepBodyParams {
  // Mass in kg, without what turns; above zero.
  float mass_kg;
  // One of `VoltstepRoadLaw`.
  uint32_t road_law;
  // Physical: drag coefficient; zero or above.
  float drag_coefficient;
  // Physical: frontal area in m^2; zero or above.
  float frontal_area_m2;
  // Physical: density of the air in kg/m^3; zero or above.
  float air_density_kg_m3;
  // Physical: rolling resistance coefficient; zero or above.
  float rolling_coefficient;
  // Coast-down: the part that does not depend on speed, in N; zero or above.
  float a_n;
  // Coast-down: the part that grows with speed, in N s/m; zero or above.
  float b_n_s_per_m;
  // Coast-down: the part that grows with its square, in N s^2/m^2; zero or above.
  float c_n_s2_per_m2;
} VoltstepBodyParams;

// The speed controller: a PID from m/s to duty, or from m/s to N for the torque driver.
typedef struct VoltstepPidParams {
  // Proportional gain; finite.
  float proportional;
  // Integral gain in 1/s; zero or above.
  float integral_per_s;
  // Derivative gain in s; zero or above.
  float derivative_s;
  // Time constant that smooths the derivative, in s; zero for none.
  float derivative_filter_s;
  // Other than 0: the derivative is of the measurement, not of the error.
  uint32_t derivative_of_measurement;
  // Below this magnitude the raw output counts as zero; zero for no dead zone.
  float dead_zone;
  // Lowest output; -infinity for none.
  float output_min;
  // Highest output, above the lowest; infinity for none.
  float output_max;
  // Rate at which the output follows its target, in 1/s; above zero, infinity for at once.
  float smoothing_per_s;
  // One of `VoltstepWindup`.
  uint32_t anti_windup;
} VoltstepPidParams;

// What the torque driver knows beside its speed controller.
typedef struct VoltstepTorqueParams {
  // Peak torque of the motor in N m; above zero.
  float peak_torque_nm;
  // Peak mechanical power of the motor in W; above zero.
  float peak_power_w;
  // Largest regenerative torque in N m; zero or above.
  float regen_torque_nm;
  // Largest regenerative mechanical power in W; above zero.
  float regen_power_w;
  // Below this speed in m/s regeneration fades to zero; above zero.
  float regen_fade_m_s;
  // Regeneration fades to zero over this last share of the state of charge; above zero.
  float regen_fade_soc;
  // Largest force of the friction brake at the road in N; above zero.
  float brake_limit_n;
  // Bandwidth of the current controller in 1/s; above zero.
  float current_rate_per_s;
} VoltstepTorqueParams;

// A vehicle with its driver. Start from `voltstep_params_preset` and change what differs.
typedef struct VoltstepParams {
  // `VOLTSTEP_ABI`.
  uint32_t abi;
  // State of charge at the start, a ratio 0..1: what the preset's sources used.
  float initial_soc;
  // The battery.
  struct VoltstepBatteryParams battery;
  // What else draws from it.
  struct VoltstepAuxiliaryParams auxiliary;
  // How many drives there are, 1..`VOLTSTEP_DRIVES`.
  uint32_t drive_count;
  // The drives; those beyond `drive_count` are not looked at.
  struct VoltstepDriveParams drives[VOLTSTEP_DRIVES];
  // The wheels.
  struct VoltstepWheelParams wheel;
  // The body.
  struct VoltstepBodyParams body;
  // One of `VoltstepDriverKind`.
  uint32_t driver;
  // Duty and torque driver: the speed controller.
  struct VoltstepPidParams pid;
  // Torque driver: the rest of it.
  struct VoltstepTorqueParams torque;
} VoltstepParams;

// A vehicle with its driver, checked and discretised for one step. Opaque: set it up by
// `voltstep_plant_init`; from then on it is only read, so any number of states may share it.
typedef struct VoltstepPlant {
  // Not for reading.
  uint64_t opaque[VOLTSTEP_PLANT_WORDS];
} VoltstepPlant;

// Everything that a vehicle and its driver remember. Opaque: set it up by
// `voltstep_state_init`. A snapshot, a roll-back or a what-if run is a copy (`a = b;`).
typedef struct VoltstepState {
  // Not for reading.
  uint32_t opaque[VOLTSTEP_STATE_WORDS];
} VoltstepState;

// What drives one step. Start from `voltstep_inputs_default`.
typedef struct VoltstepInputs {
  // With a driver: the speed to follow in m/s.
  float reference_m_s;
  // With the torque driver: how fast that changes, in m/s^2; 0 where it is not known.
  float reference_m_s2;
  // Without a driver, of one DC drive without temperatures: duty of the converter, a ratio -1..1; NaN, the default,
  // where a torque is asked for, or gates are to be off.
  float duty;
  // Without a driver: torque of all motors, as felt at the shaft of the first, in N m, by an ideal
  // current loop of each; NaN, the default, where a duty is given, or gates are to be off.
  float torque_nm;
  // Force of the friction brake in N, beside that of the driver; zero or above.
  float brake_n;
  // Sine of the road's angle; positive climbs.
  float grade_sin;
  // Cosine of the road's angle; zero or above, 1 on a flat road.
  float grade_cos;
  // Wind against the vehicle in m/s.
  float headwind_m_s;
  // Auxiliary power beside the parameter in W; zero or above.
  float auxiliary_w;
  // What the battery's management lets it discharge, in A; zero or above, infinity for any.
  float discharge_limit_a;
  // What the battery's management lets it charge, in A; zero or above, infinity for any.
  float charge_limit_a;
} VoltstepInputs;

// What one step says of a drive.
typedef struct VoltstepDriveOutputs {
  // The duty applied, a ratio; of a synchronous machine its voltage over the largest. With gates off
  // what the diodes make of it while they conduct, else 0.
  float duty;
  // Winding current in A; of a synchronous machine the peak of a phase.
  float motor_a;
  // Synchronous machine: its part along d in A.
  float d_a;
  // Synchronous machine: its part along q in A.
  float q_a;
  // Air-gap torque in N m.
  float motor_nm;
  // Motor speed in rad/s.
  float motor_rad_s;
  // Synchronous machine: it turned too far in this step for what rings at the electrical frequency
  // to be followed; it is damped.
  bool coarse_step;
  // Temperature of a heated drive's machine in degrees C; else 0.
  float machine_c;
  // Temperature of a heated drive's inverter in degrees C; else 0.
  float inverter_c;
  // How much of the converter's current limit the temperatures take away, a ratio 0..1.
  float derated;
} VoltstepDriveOutputs;

// What one step says. Discharge current, traction torque and forward speed are positive.
typedef struct VoltstepOutputs {
  // Each drive; zeros beyond those that there are.
  struct VoltstepDriveOutputs drives[VOLTSTEP_DRIVES];
  // Air-gap torque of all motors, as felt at the shaft of the first, in N m.
  float motor_nm;
  // Force of the friction brake that was commanded, in N.
  float brake_n;
  // Speed in m/s.
  float speed_m_s;
  // Distance in m.
  float distance_m;
  // State of charge, a ratio 0..1.
  float soc;
  // Battery current in A.
  float battery_a;
  // Voltage at the battery's terminals in V.
  float battery_v;
  // The battery's open-circuit voltage over the step in V.
  float open_circuit_v;
  // How far the battery's current is beyond its limits all the same, in A; zero or above.
  float limit_exceeded_a;
  // Charge of this step that went into a full battery, or, negative, out of an empty one, and is
  // lost, in C.
  float overcharged_c;
  // One of `VoltstepLimited`.
  uint32_t limited;
  // Neither battery nor drive could feed the auxiliary loads: they were cut off.
  bool auxiliary_starved;
  // The plant refused the step and is as it was.
  bool rejected;
  // The driver refused its inputs and holds its last command.
  bool driver_rejected;
} VoltstepOutputs;

// A compensated sum: what it is, and what its last additions rounded away.
typedef struct VoltstepSum {
  // The sum.
  float value;
  // What `value` has too little, exactly, in the same unit.
  float lost;
} VoltstepSum;

// Every bit that a drive remembers; zeros of the other kind of machine.
typedef struct VoltstepDriveSnapshot {
  // DC machine: winding current in A.
  struct VoltstepSum current_a;
  // Synchronous machine: current of the d axis in A.
  struct VoltstepSum d_a;
  // Synchronous machine: current of the q axis in A.
  struct VoltstepSum q_a;
  // Heated drive: how much warmer than the coolant its machine is, in K.
  struct VoltstepSum machine_above_k;
  // Heated drive: how much warmer than the coolant its inverter is, in K.
  struct VoltstepSum inverter_above_k;
} VoltstepDriveSnapshot;

// Every bit that the plant remembers: to compare two runs bit for bit.
typedef struct VoltstepSnapshot {
  // Each drive; zeros beyond those that there are.
  struct VoltstepDriveSnapshot drives[VOLTSTEP_DRIVES];
  // Speed in m/s.
  struct VoltstepSum speed_m_s;
  // Distance in m.
  struct VoltstepSum distance_m;
  // State of charge, a ratio 0..1.
  struct VoltstepSum soc;
  // Voltage across the battery's RC branch in V.
  struct VoltstepSum rc_v;
  // Voltage at the battery's terminals in V.
  float battery_v;
  // The duty that the first drive last applied, a ratio.
  float duty;
} VoltstepSnapshot;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Fills `sheet` with a pack of 14 groups of 20 cells of the size 21700: for examples. Take the
// figures of your own data sheets.
//
// # Safety
// `sheet` is null, or points to memory of its type that may be written.
VoltstepStatus voltstep_bms_sheet_example(struct VoltstepBmsSheet *sheet);

// Fills `params` with what fits a pack with sensors and contactors of a production car, and a link
// that `precharge_ohm` charges in some 0.2 s: from the data sheets and the map of a cell, for the
// numbers of cells and temperatures that the library is built for. Each field can be set on its own.
//
// # Safety
// Each pointer is null or points to an object of its type; `sheet` and `cell` are set.
VoltstepStatus voltstep_bms_params_typical(const struct VoltstepBmsSheet *sheet,
                                           const struct VoltstepCellParams *cell,
                                           float precharge_ohm,
                                           struct VoltstepBmsParams *params);

// Checks `params` and derives the whole BMS from them. A field that is refused has a code of its own
// where the estimators have it, too, else `VOLTSTEP_STATUS_PARAMETER`; its words are in `*refused`,
// a static text, null where nothing is refused; `refused` itself may be null. After a refusal `bms`
// is not initialised. The object has to stay where it is: a copy of it is refused by
// `VOLTSTEP_STATUS_BMS_MOVED`. It takes some 26 kB of stack, once.
//
// # Safety
// Each pointer is null or points to an object of its type; `params` is set.
VoltstepStatus voltstep_bms_init(struct VoltstepBms *bms,
                                 const struct VoltstepBmsParams *params,
                                 const char **refused);

// After a reset: from what was recorded, null: nothing is known of the charge, and the product's
// clock in s, where `timed` is other than 0, at a first temperature in degC (-100..200). Everything
// is open, nothing is asked for. It takes some 10 kB of stack, a tick 2.
//
// # Safety
// Each pointer is null or points to an object of its type; `record` is set.
VoltstepStatus voltstep_bms_start(const struct VoltstepBms *bms,
                                  struct VoltstepBmsState *state,
                                  const struct VoltstepRecord *record,
                                  uint32_t timed,
                                  uint32_t now_s,
                                  float temperature_c);

// Says what is asked for, from now on.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `request` is set.
VoltstepStatus voltstep_bms_request(const struct VoltstepBms *bms,
                                    struct VoltstepBmsState *state,
                                    const struct VoltstepBmsRequest *request);

// All of it in the order of a single loop, once every `sheet.tick_s`: `voltstep_bms_fast`, then
// either a sample or a slice. `outputs` is what the hardware is told from now on.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `inputs` is set.
VoltstepStatus voltstep_bms_tick(const struct VoltstepBms *bms,
                                 struct VoltstepBmsState *state,
                                 const struct VoltstepBmsInputs *inputs,
                                 struct VoltstepBmsOutputs *outputs);

// Reads, judges every row, moves the contactors: every `sheet.tick_s`. Waits for nothing.
//
// # Safety
// As for `voltstep_bms_tick`.
VoltstepStatus voltstep_bms_fast(const struct VoltstepBms *bms,
                                 struct VoltstepBmsState *state,
                                 const struct VoltstepBmsInputs *inputs,
                                 struct VoltstepBmsOutputs *outputs);

// One sample of the estimators, every `sample_s`: limits follow, and the bleed switches. Of the
// inputs only `balancing_c` is read.
//
// # Safety
// As for `voltstep_bms_tick`.
VoltstepStatus voltstep_bms_filter(const struct VoltstepBms *bms,
                                   struct VoltstepBmsState *state,
                                   const struct VoltstepBmsInputs *inputs,
                                   struct VoltstepBmsOutputs *outputs);

// One slice of what is worked out once a second, some 23 times a second, when there is time. `left`
// may be null; it says whether there is more to do in this second.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call.
VoltstepStatus voltstep_bms_slow(const struct VoltstepBms *bms,
                                 struct VoltstepBmsState *state,
                                 bool *left);

// What is known now.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else writes during the call.
VoltstepStatus voltstep_bms_report(const struct VoltstepBms *bms,
                                   const struct VoltstepBmsState *state,
                                   struct VoltstepBmsReport *report);

// What should be stored now (`voltstep_record_encode`), where it is worth a write: `worth` says so,
// and `record` is written only then, which counts as stored. Ask after every tick. `now_s` is the
// product's clock, where `timed` is other than 0.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call.
VoltstepStatus voltstep_bms_record(const struct VoltstepBms *bms,
                                   struct VoltstepBmsState *state,
                                   uint32_t timed,
                                   uint32_t now_s,
                                   struct VoltstepRecord *record,
                                   bool *worth);

// All that a record holds, before the power goes.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else writes during the call.
VoltstepStatus voltstep_bms_worth_keeping(const struct VoltstepBms *bms,
                                          const struct VoltstepBmsState *state,
                                          uint32_t timed,
                                          uint32_t now_s,
                                          struct VoltstepRecord *record);

// Starts the counter from a state of charge and its standard deviation (ratios 0..1).
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_counter_start(const struct VoltstepEstimators *estimators,
                                      struct VoltstepCounterState *state,
                                      float soc,
                                      float soc_sd);

// Starts the counter from the voltage of a rested battery in V; where it says nothing, with nothing
// known.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_counter_start_rested(const struct VoltstepEstimators *estimators,
                                             struct VoltstepCounterState *state,
                                             float voltage_v);

// Starts the counter from a record that is `elapsed_s` seconds old (NaN: nobody knows). It takes
// over the health.
//
// # Safety
// Each pointer is null or points to an object of its type; `record` is set.
VoltstepStatus voltstep_counter_resume(const struct VoltstepEstimators *estimators,
                                       struct VoltstepCounterState *state,
                                       const struct VoltstepRecord *record,
                                       float elapsed_s);

// Counts one sample of the current in A, positive when discharging; NaN where there is no usable
// reading.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call.
VoltstepStatus voltstep_counter_step(const struct VoltstepEstimators *estimators,
                                     struct VoltstepCounterState *state,
                                     float current_a);

// Takes stock, about once a second: puts the count right where the battery has rested and
// `voltage_v` (in V; NaN where there is no usable reading) knows better. `outputs` may be null.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call.
VoltstepStatus voltstep_counter_review(const struct VoltstepEstimators *estimators,
                                       struct VoltstepCounterState *state,
                                       float voltage_v,
                                       struct VoltstepCounterOutputs *outputs);

// Starts the filter from a state of charge that is known from elsewhere, and its standard deviation
// (ratios 0..1), at a temperature in degC (-100..200). The battery need not be rested.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_filter_start(const struct VoltstepEstimators *estimators,
                                     struct VoltstepFilterState *state,
                                     float soc,
                                     float soc_sd,
                                     float temperature_c);

// Starts the filter with nothing known of the state of charge, at a temperature in degC
// (-100..200).
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_filter_start_unknown(const struct VoltstepEstimators *estimators,
                                             struct VoltstepFilterState *state,
                                             float temperature_c);

// Starts the filter from the voltage of a rested battery in V, at a temperature in degC
// (-100..200).
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_filter_start_rested(const struct VoltstepEstimators *estimators,
                                            struct VoltstepFilterState *state,
                                            float voltage_v,
                                            float temperature_c);

// Starts the filter from a record that is `elapsed_s` seconds old (NaN: nobody knows), at a
// temperature in degC (-100..200). It takes over the health.
//
// # Safety
// Each pointer is null or points to an object of its type; `record` is set.
VoltstepStatus voltstep_filter_resume(const struct VoltstepEstimators *estimators,
                                      struct VoltstepFilterState *state,
                                      const struct VoltstepRecord *record,
                                      float elapsed_s,
                                      float temperature_c);

// One sample. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that current or voltage
// was missing or absurd: the estimate is held, its uncertainty grows, the outputs are written all
// the same. Any other error leaves everything as it was.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `input` is set.
VoltstepStatus voltstep_filter_step(const struct VoltstepEstimators *estimators,
                                    struct VoltstepFilterState *state,
                                    const struct VoltstepFilterInput *input,
                                    struct VoltstepFilterOutputs *outputs);

// The filter takes over what was learnt of the health, where it is known better than was declared.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `health` is set.
VoltstepStatus voltstep_filter_adopt(const struct VoltstepEstimators *estimators,
                                     struct VoltstepFilterState *state,
                                     const struct VoltstepHealth *health);

// Fills `record` with what is worth keeping of the filter and the health; throughput, time and what
// follows are left at 0.
//
// # Safety
// Each pointer is null or points to an object of its type; `health` is set.
VoltstepStatus voltstep_filter_record(const struct VoltstepEstimators *estimators,
                                      const struct VoltstepFilterState *state,
                                      const struct VoltstepHealth *health,
                                      struct VoltstepRecord *record);

// Fills `params` with one of `VoltstepCellPreset`.
//
// # Safety
// `params` is null, or points to memory of its type that may be written.
VoltstepStatus voltstep_estimator_params_preset(uint32_t preset,
                                                struct VoltstepEstimatorParams *params);

// Checks `params` and discretises them for samples every `dt_s` seconds. Writes `estimators` only
// if they are good; a bad one is named by the code. The object has to stay where it is: a copy of
// it is refused by `VOLTSTEP_STATUS_ESTIMATORS_MOVED`.
//
// # Safety
// Each pointer is null or points to an object of its type; `params` is set.
VoltstepStatus voltstep_estimators_init(struct VoltstepEstimators *estimators,
                                        const struct VoltstepEstimatorParams *params,
                                        float dt_s);

// Sets `health` to what the parameters say before anything was learnt.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_health_unlearnt(const struct VoltstepEstimators *estimators,
                                        struct VoltstepHealth *health);

// Starts the resistance from what is known of the health; what of it is not finite or out of range
// is not taken.
//
// # Safety
// Each pointer is null or points to an object of its type; `health` is set.
VoltstepStatus voltstep_resistance_start(const struct VoltstepEstimators *estimators,
                                         struct VoltstepResistanceState *state,
                                         const struct VoltstepHealth *health);

// Looks at one sample: voltage in V, current in A, positive when discharging, what is believed to
// be in the cell. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that an input was
// not finite or absurd; the factor is unchanged, the outputs are written all the same.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `estimate` is set.
VoltstepStatus voltstep_resistance_step(const struct VoltstepEstimators *estimators,
                                        struct VoltstepResistanceState *state,
                                        float voltage_v,
                                        float current_a,
                                        const struct VoltstepEstimate *estimate,
                                        struct VoltstepResistanceOutputs *outputs);

// Starts the capacity from what is known of the health; what of it is not finite or out of range is
// not taken.
//
// # Safety
// Each pointer is null or points to an object of its type; `health` is set.
VoltstepStatus voltstep_capacity_start(const struct VoltstepEstimators *estimators,
                                       struct VoltstepCapacityState *state,
                                       const struct VoltstepHealth *health);

// Looks at one pair of instants. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that
// an input was not finite or absurd; nothing changed, the outputs are written all the same.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `input` is set.
VoltstepStatus voltstep_capacity_step(const struct VoltstepEstimators *estimators,
                                      struct VoltstepCapacityState *state,
                                      const struct VoltstepCapacityInput *input,
                                      struct VoltstepCapacityOutputs *outputs);

// What may be drawn and charged from now on: fills `limits`, an array of `VOLTSTEP_HORIZONS`, for
// each length of time. Without a finite estimate, nothing. A matter for once a second:
// `voltstep_power_walk` does the same in six shorter calls.
//
// # Safety
// Each pointer is null or points to an object of its type; `estimate` and `health` are set.
VoltstepStatus voltstep_power_ahead(const struct VoltstepEstimators *estimators,
                                    const struct VoltstepEstimate *estimate,
                                    const struct VoltstepHealth *health,
                                    struct VoltstepPowerAhead *limits);

// Begins to work out the power limits.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_power_walk_start(const struct VoltstepEstimators *estimators,
                                         struct VoltstepPowerWalk *walk);

// One length of time and direction at a time. The last of six calls fills `limits`, an array of
// `VOLTSTEP_HORIZONS`, and sets `done`; the next one begins again.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `estimate` and `health` are set.
VoltstepStatus voltstep_power_walk(const struct VoltstepEstimators *estimators,
                                   struct VoltstepPowerWalk *walk,
                                   const struct VoltstepEstimate *estimate,
                                   const struct VoltstepHealth *health,
                                   struct VoltstepPowerAhead *limits,
                                   bool *done);

// Starts the averages behind the energy left, at rest.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_energy_start(const struct VoltstepEstimators *estimators,
                                     struct VoltstepEnergyState *state);

// Averages one sample: current in A, positive when discharging, voltage in V.
// `VOLTSTEP_STATUS_INPUT_REJECTED` says that one was not finite or absurd, and was left out.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call.
VoltstepStatus voltstep_energy_step(const struct VoltstepEstimators *estimators,
                                    struct VoltstepEnergyState *state,
                                    float current_a,
                                    float voltage_v);

// Says what is left, about once a second. `VOLTSTEP_STATUS_INPUT_REJECTED` says that the estimate
// or the health was not finite or absurd; the report is not written then.
//
// # Safety
// Each pointer is null or points to an object of its type; `estimate` and `health` are set.
VoltstepStatus voltstep_energy_report(const struct VoltstepEstimators *estimators,
                                      const struct VoltstepEnergyState *state,
                                      const struct VoltstepEstimate *estimate,
                                      const struct VoltstepHealth *health,
                                      struct VoltstepEnergyReport *report);

// The bytes of a slot that holds `record` under a sequence number: `bytes` is an array of
// `VOLTSTEP_RECORD_BYTES`. A field that is out of range is named by the code.
//
// # Safety
// Each pointer is null or points to an object of its type; `record` is set.
VoltstepStatus voltstep_record_encode(const struct VoltstepRecord *record,
                                      uint32_t sequence,
                                      uint8_t *bytes);

// What a slot of `VOLTSTEP_RECORD_BYTES` holds: a record and its sequence number, or the code that
// says why there is none.
//
// # Safety
// Each pointer is null or points to an object of its type; `bytes` is set.
VoltstepStatus voltstep_record_decode(const uint8_t *bytes,
                                      struct VoltstepRecord *record,
                                      uint32_t *sequence);

// What two slots of `VOLTSTEP_RECORD_BYTES` hold. `VOLTSTEP_STATUS_RECORD_BLANK` says that there is
// no record in either; `stored` is written all the same, its record then all zero.
//
// # Safety
// Each pointer is null or points to an object of its type; `first` and `second` are set.
VoltstepStatus voltstep_record_newest(const uint8_t *first,
                                      const uint8_t *second,
                                      struct VoltstepStored *stored);

// Starts the estimators of cells in series, 1, 4, 12, 18 or 96 of them, in `memory`: an array of
// `words`, at least `VOLTSTEP_SERIES_WORDS + cells * VOLTSTEP_SERIES_WORDS_PER_CELL`, which a copy
// of it may take the place of. `record` is what was remembered `elapsed_s` seconds ago (NaN: nobody
// knows); null: nothing is known. At a temperature in degC (-100..200).
//
// # Safety
// Each pointer is null or points to an object of its type; `record` is set.
VoltstepStatus voltstep_series_start(const struct VoltstepEstimators *estimators,
                                     uint64_t *memory,
                                     uint32_t words,
                                     uint32_t cells,
                                     const struct VoltstepRecord *record,
                                     float elapsed_s,
                                     float temperature_c);

// One sample of cells in series: `cell_v` is an array of `cells` voltages in V, as many as at the
// start; NaN where there is no usable reading. `outputs` may be null. Once a second it takes
// longer: every cell, the counter's review, what was learnt goes where it is used.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call;
// `input` and `cell_v` are set.
VoltstepStatus voltstep_series_step(const struct VoltstepEstimators *estimators,
                                    uint64_t *memory,
                                    const struct VoltstepSeriesInput *input,
                                    const float *cell_v,
                                    uint32_t cells,
                                    struct VoltstepSeriesOutputs *outputs);

// What is believed of one of the cells in series, the first of them 0.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call.
VoltstepStatus voltstep_series_cell(uint64_t *memory,
                                    uint32_t index,
                                    struct VoltstepSeriesCell *cell);

// What the cells in series allow, for the limits of one cell: fills `limits`, an array of
// `VOLTSTEP_HORIZONS`; current as it is, power of one cell. A matter for once a second:
// `voltstep_series_power_walk` does the same in shorter calls.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call.
VoltstepStatus voltstep_series_power(const struct VoltstepEstimators *estimators,
                                     uint64_t *memory,
                                     struct VoltstepPowerAhead *limits);

// The same in `VOLTSTEP_SERIES_SLICES` calls, from what is believed at each of them. The last one
// fills `limits`, an array of `VOLTSTEP_HORIZONS`, and sets `done`; the next one begins again.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call.
VoltstepStatus voltstep_series_power_walk(const struct VoltstepEstimators *estimators,
                                          uint64_t *memory,
                                          struct VoltstepPowerWalk *walk,
                                          struct VoltstepPowerAhead *limits,
                                          bool *done);

// What is left in the mean of cells in series, in the units of one cell.
// `VOLTSTEP_STATUS_INPUT_REJECTED` says that the estimate was not finite; the report is not written
// then.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call.
VoltstepStatus voltstep_series_energy(const struct VoltstepEstimators *estimators,
                                      uint64_t *memory,
                                      struct VoltstepEnergyReport *report);

// Fills `record` with what is worth keeping of cells in series; throughput, time and what follows
// are left at 0.
//
// # Safety
// Each pointer is null or points to objects of its type that nobody else uses during the call.
VoltstepStatus voltstep_series_record(const struct VoltstepEstimators *estimators,
                                      uint64_t *memory,
                                      struct VoltstepRecord *record);

// The words of a code: for a parameter, its field and the rule that it broke. The text is static
// and ends with a zero; for a number that is no code it is "unknown code". Never null.
const char *voltstep_error_message(uint32_t code);

// Fills `params` with one of `VoltstepPreset`.
//
// # Safety
// `params` is null, or points to memory of its type that may be written.
VoltstepStatus voltstep_params_preset(uint32_t preset, struct VoltstepParams *params);

// Checks `params` and discretises them for steps of `dt_s` seconds. Writes `plant` only if they
// are good; a bad one is named by the code.
//
// # Safety
// Each pointer is null or points to an object of its type; `params` is set.
VoltstepStatus voltstep_plant_init(struct VoltstepPlant *plant,
                                   const struct VoltstepParams *params,
                                   float dt_s);

// A rested plant with its battery at `soc` (a ratio 0..1) that rolls at `speed_m_s` (0: it stands
// still) without current, its driver fresh.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_state_init(const struct VoltstepPlant *plant,
                                   struct VoltstepState *state,
                                   float soc,
                                   float speed_m_s);

// Sets `inputs` to a flat road without wind, brake and auxiliary load, reference 0, gates off.
//
// # Safety
// `inputs` is null or points to an object of its type.
VoltstepStatus voltstep_inputs_default(struct VoltstepInputs *inputs);

// Advances `state` by one step: the driver (if the plant has one) decides on what the last step
// left, then the plant moves. `outputs` may be null. `VOLTSTEP_STATUS_INPUT_REJECTED` says that an
// input was bad; the outputs are written all the same. Any other error leaves everything as it
// was.
//
// # Safety
// Each pointer is null or points to an object of its type that nobody else uses during the call;
// `inputs` is set.
VoltstepStatus voltstep_step(const struct VoltstepPlant *plant,
                             struct VoltstepState *state,
                             const struct VoltstepInputs *inputs,
                             struct VoltstepOutputs *outputs);

// Says every bit that the plant remembers.
//
// # Safety
// Each pointer is null or points to an object of its type.
VoltstepStatus voltstep_state_snapshot(const struct VoltstepState *state,
                                       struct VoltstepSnapshot *snapshot);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* VOLTSTEP_H */
