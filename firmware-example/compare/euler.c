/*
 * The coupled plant with its PID in plain C, explicit Euler: what is quickly written. Its RC branch
 * (1 ns) would need a step of 2 ns and the controller's smoothing (1 µs) one of 2 µs, so both count
 * as settled: their resistance and their target. No compensated sums, no refused inputs; a current
 * beyond the limit is clipped at the battery alone, as it is often done.
 */
#include "euler.h"

#include "vehicle.h"

#define H (1e-3f / EULER_STEPS)
#define K (1.0f / RADIUS_M)
#define MASS (MASS_KG + ROTOR_KG_M2 * K * K)

void euler_start(EulerPlant *plant)
{
    *plant = (EulerPlant){ .soc = INITIAL_SOC };
}

void euler_step(EulerPlant *plant, const float *reference_m_s)
{
    float v = plant->speed_m_s, i = plant->current_a;
    float error = *reference_m_s - v;
    float duty = PID_P * error + plant->integral;
    plant->integral += PID_I_PER_S * H * error;

    float battery_a = duty * i;
    battery_a = battery_a > LIMIT_A ? LIMIT_A : battery_a < -LIMIT_A ? -LIMIT_A : battery_a;
    float battery_v =
        EMPTY_V + (FULL_V - EMPTY_V) * plant->soc - (SERIES_OHM + RC_OHM) * battery_a;
    float slip = v > 0.0f ? 1.0f : v < 0.0f ? -1.0f : 0.0f;
    float force_n = KT * K * i - (DRAG_N_S2_PER_M2 * __builtin_fabsf(v) + ROTOR_VISCOUS * K * K) * v -
                    ROLLING_N * slip;
    plant->current_a = i + (H / WINDING_H) * (duty * battery_v - WINDING_OHM * i - KE * K * v);
    plant->speed_m_s = v + (H / MASS) * force_n;
    plant->distance_m += H * v;
    float soc = plant->soc - (H / CAPACITY_C) * battery_a;
    plant->soc = soc > 1.0f ? 1.0f : soc < 0.0f ? 0.0f : soc;
    plant->battery_v = battery_v;
}
