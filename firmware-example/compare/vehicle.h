/*
 * The vehicle `epowertrain-udds` (plant-core/src/presets/mod.rs) with its PID, as a firmware engineer
 * would write it down: constants, folded by the compiler.
 */
#ifndef VEHICLE_H
#define VEHICLE_H

#define INITIAL_SOC 0.80f
#define EMPTY_V 500.0f
#define FULL_V 600.0f
#define CAPACITY_C (3600.0f * 30.0f)
#define SERIES_OHM 0.06f
#define RC_OHM 1e-3f
#define RC_F 1e-6f
#define LIMIT_A 400.0f

#define WINDING_OHM 0.025f
#define WINDING_H 1e-3f
#define KE 1.4f
#define KT 1.4f
#define ROTOR_KG_M2 3.87e-7f
#define ROTOR_VISCOUS 4.21e-6f

#define RADIUS_M 0.25f
#define MASS_KG 1500.0f
#define DRAG_N_S2_PER_M2 (0.5f * 1.2f * 0.29f * 2.2f)
#define ROLLING_N (0.009f * MASS_KG * 9.80665f)

#define PID_P 20.0f
#define PID_I_PER_S 0.1f
#define PID_DEAD_ZONE 1e-9f
#define PID_SMOOTHING_PER_S 1e6f

/* Larger than this is absurd. */
#define LARGEST 1e9f

#endif
