/*
 * Drives both C plants and the library's along UDDS, side by side, and says how far apart they are.
 * The three steps are what xtask counts.
 */
#include "cycle.h"
#include "euler.h"
#include "platform.h"
#include "semi_implicit.h"
#include "voltstep.h"

/* For the counter to find itself right: it counts as the one instruction that it is. */
__attribute__((noinline)) void nothing(void)
{
    __asm__ volatile("");
}

/* The largest of something. */
static void largest(float *most, float x)
{
    x = __builtin_fabsf(x);
    if (!(x <= *most)) {
        *most = x;
    }
}

static void say_number(const char *name, unsigned long long n)
{
    char digits[24];
    int at = sizeof digits - 1;
    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + n % 10);
        n /= 10;
    } while (n > 0);
    say(name);
    say(" ");
    say(&digits[at]);
    say("\n");
}

/* A ratio in parts per billion, which needs no library to print. */
static void say_ppb(const char *name, float x)
{
    say_number(name, x < 1e9f ? (unsigned long long)((double)x * 1e9) : 1000000000000000000u);
}

int main(void)
{
    static VoltstepPlant model;
    static VoltstepState state;
    static Plant plant;
    static EulerPlant euler;
    VoltstepParams params;
    VoltstepInputs inputs;
    VoltstepOutputs out = { 0 };
    voltstep_params_preset(VOLTSTEP_PRESET_EPOWERTRAIN_UDDS, &params);
    if (voltstep_plant_init(&model, &params, CYCLE_DT_S) != VOLTSTEP_STATUS_OK ||
        voltstep_state_init(&model, &state, params.initial_soc, 0.0f) != VOLTSTEP_STATUS_OK) {
        say("no plant\n");
        return 1;
    }
    voltstep_inputs_default(&inputs);
    semi_implicit_start(&plant);
    euler_start(&euler);
    float soc = 0.0f, speed = 0.0f, battery_v = 0.0f, current = 0.0f, euler_soc = 0.0f,
          euler_speed = 0.0f;
    Cycle cycle = { 0 };
    for (long n = 0; n < CYCLE_STEPS; n++) {
        nothing();
        /* No counted call may stand where another returns to. */
        __asm__ volatile("nop");
        cycle_step(&cycle, &inputs.reference_m_s, &inputs.reference_m_s2);
        if (voltstep_step(&model, &state, &inputs, &out) != VOLTSTEP_STATUS_OK) {
            say("refused\n");
            return 1;
        }
        semi_implicit_step(&plant, &inputs.reference_m_s);
        for (int k = 0; k < EULER_STEPS; k++) {
            euler_step(&euler, &inputs.reference_m_s);
        }
        /* Relative to what each quantity comes to. */
        largest(&soc, plant.soc.value - out.soc);
        largest(&speed, (plant.speed_m_s.value - out.speed_m_s) / 25.0f);
        largest(&battery_v, (plant.battery_v - out.battery_v) / 600.0f);
        largest(&current, (plant.current_a.value - out.drives[0].motor_a) / 1000.0f);
        largest(&euler_soc, euler.soc - out.soc);
        largest(&euler_speed, (euler.speed_m_s - out.speed_m_s) / 25.0f);
    }
    say_ppb("semi soc", soc);
    say_ppb("semi speed", speed);
    say_ppb("semi battery_v", battery_v);
    say_ppb("semi current", current);
    say_ppb("euler soc", euler_soc);
    say_ppb("euler speed", euler_speed);
    say_number("state semi_implicit_step", sizeof plant);
    say_number("state euler_step", sizeof euler);
    say_number("state voltstep_step", sizeof state);
    return 0;
}
