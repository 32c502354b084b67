/*
 * The coupled plant with its PID in plain C, semi-implicit, hand-written for this one vehicle: one
 * linear solve of winding and vehicle, friction projected, compensated sums, battery limits on the
 * duty, inputs and results checked.
 */
#include "semi_implicit.h"

#include <stdbool.h>

#include "vehicle.h"

#define H 1e-3f

/* Everything seen from the road. */
#define K (1.0f / RADIUS_M)
#define KE_ROAD (KE * K)
#define KT_ROAD (KT * K)
#define VISCOUS_ROAD (ROTOR_VISCOUS * K * K)
#define INERTIA_PER_H ((MASS_KG + ROTOR_KG_M2 * K * K) / H)
#define INDUCTANCE_PER_H (WINDING_H / H)
#define RC_STEPS (H / RC_OHM / RC_F)
#define RC_GAIN (RC_STEPS / (1.0f + RC_STEPS))
#define SOURCE_OHM (SERIES_OHM + RC_GAIN * RC_OHM)
#define SOC_PER_A (H / CAPACITY_C)
#define SMOOTHING_STEPS (H * PID_SMOOTHING_PER_S)
#define SMOOTHING_GAIN (SMOOTHING_STEPS / (1.0f + SMOOTHING_STEPS))

typedef enum { STUCK, FORWARD, BACKWARD } Slip;

/* What a step starts from. */
typedef struct {
    float emf_v, current_a, speed_m_s, force_n, slope, friction_n;
} Start;

/* What a duty leads to. */
typedef struct {
    float speed_increment, current_increment, battery_a, battery_v;
    Slip slip;
} Solution;

static inline float magnitude(float x)
{
    return __builtin_fabsf(x);
}

/* The PID: from the speed error to the duty. */
static inline float control(Pid *pid, float reference, float speed, float applied, bool *good)
{
    float error = reference - speed;
    float sum = magnitude(reference) + magnitude(speed) + magnitude(pid->integral.value) +
                magnitude(applied);
    if (!(sum <= LARGEST)) {
        *good = false;
        return pid->output.value;
    }
    float raw = PID_P * error + pid->integral.value;
    if (magnitude(raw) >= PID_DEAD_ZONE) {
        if (magnitude(raw) < __builtin_inff()) {
            add(&pid->integral, PID_I_PER_S * H * error);
        }
    } else {
        raw = 0.0f;
    }
    add(&pid->output, SMOOTHING_GAIN * (raw - pid->output.value));
    return pid->output.value;
}

/* Winding and vehicle at once for a duty. */
static inline Solution solve(const Start *start, float duty)
{
    float emf_v = duty * start->emf_v;
    float ohm = WINDING_OHM + duty * duty * SOURCE_OHM;
    float admittance = 1.0f / (INDUCTANCE_PER_H + ohm);
    float free_a = admittance * (emf_v - ohm * start->current_a - KE_ROAD * start->speed_m_s);
    float force_n = start->force_n + KT_ROAD * (start->current_a + free_a);
    float mobility = 1.0f / (start->slope + KT_ROAD * KE_ROAD * admittance);
    float free = force_n * mobility, grip = start->friction_n * mobility;
    float reached = start->speed_m_s + free;
    Solution found;
    if (magnitude(reached) <= grip) {
        found.speed_increment = -start->speed_m_s;
        found.slip = STUCK;
    } else if (reached < 0.0f) {
        found.speed_increment = free + grip;
        found.slip = BACKWARD;
    } else {
        found.speed_increment = free - grip;
        found.slip = FORWARD;
    }
    found.current_increment = free_a - KE_ROAD * admittance * found.speed_increment;
    found.battery_a = duty * (start->current_a + found.current_increment);
    found.battery_v = start->emf_v - SOURCE_OHM * found.battery_a;
    return found;
}

/* The duty at which the battery is at its limit, and what it leads to. */
static __attribute__((noinline, cold)) float hold(const Start *start, float commanded, float most_a,
                                                  float least_a, Solution *found)
{
    float duty = commanded;
    float limit_a = found->battery_a > most_a ? most_a : found->battery_a < least_a ? least_a : 0.0f;
    if (found->battery_a <= most_a && found->battery_a >= least_a) {
        return duty;
    }
    for (int tries = 0; tries < 3; tries++) {
        Slip slip = found->slip;
        float beta = INDUCTANCE_PER_H * start->current_a;
        float rho = INDUCTANCE_PER_H + WINDING_OHM;
        if (slip != STUCK) {
            float mobility = 1.0f / start->slope;
            float friction_n = slip == FORWARD ? start->friction_n : -start->friction_n;
            beta -= KE_ROAD * (start->speed_m_s + (start->force_n - friction_n) * mobility);
            rho += KE_ROAD * KT_ROAD * mobility;
        }
        float a = start->emf_v - SOURCE_OHM * limit_a;
        float discriminant = beta * beta + 4.0f * a * rho * limit_a;
        if (discriminant < 0.0f) {
            duty = limit_a < 0.0f ? -beta / start->emf_v : commanded;
        } else {
            float root = __builtin_sqrtf(discriminant);
            if (limit_a < 0.0f) {
                duty = (beta > 0.0f ? -beta - root : root - beta) / (2.0f * a);
            } else {
                root = commanded < 0.0f ? -root : root;
                if (beta * root > 0.0f) {
                    duty = 2.0f * rho * limit_a / (beta + root);
                } else if (a > 0.0f) {
                    duty = (root - beta) / (2.0f * a);
                }
            }
        }
        *found = solve(start, duty);
        if (found->slip == slip) {
            break;
        }
    }
    return duty;
}

void semi_implicit_start(Plant *plant)
{
    *plant = (Plant){ .soc.value = INITIAL_SOC,
                      .battery_v = EMPTY_V + (FULL_V - EMPTY_V) * INITIAL_SOC };
}

void semi_implicit_step(Plant *plant, const float *reference_m_s)
{
    bool good = true;
    float v = plant->speed_m_s.value, i = plant->current_a.value, soc = plant->soc.value;
    float duty = control(&plant->pid, *reference_m_s, v, plant->duty, &good);

    float drag = DRAG_N_S2_PER_M2 * magnitude(v);
    float rc_v = plant->rc_v.value;
    Start start = {
        .emf_v = EMPTY_V + (FULL_V - EMPTY_V) * soc - (rc_v - RC_GAIN * rc_v),
        .current_a = i,
        .speed_m_s = v,
        .force_n = -(drag * v + VISCOUS_ROAD * v),
        .slope = INERTIA_PER_H + VISCOUS_ROAD + drag,
        .friction_n = ROLLING_N,
    };
    Solution found = solve(&start, duty);
    Sum soc_sum = plant->soc, rc_sum = plant->rc_v;
    add(&rc_sum, RC_GAIN * (RC_OHM * found.battery_a - rc_v));
    add(&soc_sum, -(found.battery_a * SOC_PER_A));
    bool limited = false;
    if (!(found.battery_a <= LIMIT_A && found.battery_a >= -LIMIT_A && soc_sum.value >= 0.0f &&
          soc_sum.value <= 1.0f)) {
        float left_a = soc * (CAPACITY_C / H), room_a = (1.0f - soc) * (CAPACITY_C / H);
        /* Copies, so that the usual step keeps both in registers. */
        Start again = start;
        Solution held = found;
        duty = hold(&again, duty, left_a < LIMIT_A ? left_a : LIMIT_A,
                    -(room_a < LIMIT_A ? room_a : LIMIT_A), &held);
        found = held;
        limited = true;
        soc_sum = plant->soc, rc_sum = plant->rc_v;
        add(&rc_sum, RC_GAIN * (RC_OHM * found.battery_a - rc_v));
        add(&soc_sum, -(found.battery_a * SOC_PER_A));
        if (soc_sum.value < 0.0f) {
            soc_sum = (Sum){ 0.0f, 0.0f };
        } else if (soc_sum.value > 1.0f) {
            soc_sum = (Sum){ 1.0f, 0.0f };
        }
    }

    float sum = magnitude(i + found.current_increment) + magnitude(v + found.speed_increment) +
                magnitude(found.battery_a) + magnitude(rc_sum.value);
    if (!(sum <= LARGEST)) {
        plant->rejected = true;
        return;
    }
    add(&plant->current_a, found.current_increment);
    if (found.slip == STUCK) {
        plant->speed_m_s = (Sum){ 0.0f, 0.0f };
    } else {
        add(&plant->speed_m_s, found.speed_increment);
        add(&plant->distance_m, plant->speed_m_s.value * H);
    }
    plant->soc = soc_sum;
    plant->rc_v = rc_sum;
    plant->battery_a = found.battery_a;
    plant->battery_v = found.battery_v;
    plant->duty = duty;
    plant->limited = limited;
    plant->rejected = !good;
}
