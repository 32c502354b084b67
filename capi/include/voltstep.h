/*
 * Voltstep for C: an EV powertrain (battery, converter, DC motor, gearbox, wheels, body) with its
 * driver, in fixed steps, single precision, without allocation; bit for bit the same on a
 * Cortex-M4F and on a PC.
 *
 *   VoltstepParams params;
 *   voltstep_params_preset(VOLTSTEP_PRESET_BMW_I3_CONSTANT, &params);
 *   static VoltstepPlant plant;                        // read only from here on
 *   voltstep_plant_init(&plant, &params, 0.001f);      // names a bad parameter by its code
 *   static VoltstepState state;                        // a snapshot is a copy of it
 *   voltstep_state_init(&plant, &state, 0.8f, 0.0f);
 *   every millisecond: voltstep_step(&plant, &state, &inputs, &outputs);
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

// Words (4 bytes) of a `VoltstepPlant`.
#define VOLTSTEP_PLANT_WORDS 192

// Words (4 bytes) of a `VoltstepState`.
#define VOLTSTEP_STATE_WORDS 48

// Version of this interface. `VoltstepParams.abi` must hold it, so that a header and a library
// that do not belong together are noticed.
#define VOLTSTEP_ABI 1

// Points of an open-circuit table: at state of charge i/64, i = 0..64.
#define VOLTSTEP_SOC_POINTS 65

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
  // Plant and state share memory.
  VOLTSTEP_STATUS_OVERLAP = 3,
  // The plant was not initialised: `voltstep_plant_init`.
  VOLTSTEP_STATUS_PLANT_NOT_INITIALISED = 4,
  // The state was not initialised: `voltstep_state_init`.
  VOLTSTEP_STATUS_STATE_NOT_INITIALISED = 5,
  // `VoltstepParams.abi` is not `VOLTSTEP_ABI`: not set, or header and library differ.
  VOLTSTEP_STATUS_ABI_MISMATCH = 6,
  // An input of the step was not finite or absurd. The outputs say whether the plant or only the
  // driver refused it; what refused it left its state as it was.
  VOLTSTEP_STATUS_INPUT_REJECTED = 10,
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
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum VoltstepPreset VoltstepPreset;
#else
typedef uint32_t VoltstepPreset;
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
  // Nobody: the inputs say duty and brake.
  VOLTSTEP_DRIVER_KIND_NONE = 0,
  // A PID from the speed error straight to the duty.
  VOLTSTEP_DRIVER_KIND_DUTY = 1,
  // Speed, torque, limits, current, duty; the friction brake takes the rest.
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
  // Voltage drop against the output current, in V; zero or above.
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

// What is known about the gearbox.
typedef struct VoltstepGearboxParams {
  // Motor turns per wheel turn; above zero.
  float ratio;
  // Share of the torque that gets through; above 0, up to 1.
  float efficiency;
  // Inertia at the motor's side in kg m^2; zero or above.
  float inertia_kg_m2;
} VoltstepGearboxParams;

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
  // The converter.
  struct VoltstepConverterParams converter;
  // The motor.
  struct VoltstepMotorParams motor;
  // The gearbox.
  struct VoltstepGearboxParams gearbox;
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
  uint32_t opaque[VOLTSTEP_PLANT_WORDS];
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
  // Without a driver: duty of the converter, a ratio -1..1; NaN, the default, for gates off.
  float duty;
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

// What one step says. Discharge current, traction torque and forward speed are positive.
typedef struct VoltstepOutputs {
  // The duty applied, a ratio; with gates off +-1 while the diodes conduct, else 0.
  float duty;
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
  // Winding current in A.
  float motor_a;
  // Air-gap torque of the motor in N m.
  float motor_nm;
  // Motor speed in rad/s.
  float motor_rad_s;
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

// Every bit that the plant remembers: to compare two runs bit for bit.
typedef struct VoltstepSnapshot {
  // Winding current in A.
  struct VoltstepSum current_a;
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
  // The duty that was last applied, a ratio.
  float duty;
} VoltstepSnapshot;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

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

// Sets `inputs` to a flat road without wind, brake and auxiliary load, reference and duty 0.
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
