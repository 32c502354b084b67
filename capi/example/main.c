/*
 * Drives vehicles along UDDS at 1 kHz through the C interface and says the hash of every bit of
 * their state after every step: the same as the firmware and the PC say (golden.toml). Checks on the
 * way that mistakes get their code.
 */
#include <stdint.h>

#include "cycle.h"
#include "hash.h"
#include "platform.h"
#include "voltstep.h"

static void hash_sum(VoltstepSum sum)
{
    hash_float(sum.value);
    hash_float(sum.lost);
}

static void hash_drive(const VoltstepDriveParams *drive, const VoltstepDriveSnapshot *now)
{
    if (drive->machine == VOLTSTEP_MACHINE_PMSM) {
        hash_sum(now->d_a);
        hash_sum(now->q_a);
    } else {
        hash_sum(now->current_a);
    }
    if (drive->thermal.heated) {
        hash_sum(now->machine_above_k);
        hash_sum(now->inverter_above_k);
    }
}

/* Says what went wrong, in the library's words. */
static int failed(const char *what, VoltstepStatus status)
{
    say(what);
    say(": ");
    say(voltstep_error_message(status));
    say("\n");
    return 1;
}

static int expect(VoltstepStatus found, VoltstepStatus expected)
{
    return found == expected ? 0 : failed("not the expected code", found);
}

static int same(const char *a, const char *b)
{
    while (*a == *b && *a != 0) {
        a++, b++;
    }
    return *a == *b;
}

/* Mistakes get their code and change nothing. */
static int mistakes(void)
{
    static VoltstepPlant plant;
    static VoltstepState state;
    VoltstepParams params;
    VoltstepInputs inputs;
    int wrong = 0;
    wrong += expect(voltstep_params_preset(99, &params), VOLTSTEP_STATUS_UNKNOWN_PRESET);
    wrong += expect(voltstep_params_preset(VOLTSTEP_PRESET_BMW_I3_CONSTANT, 0), VOLTSTEP_STATUS_NULL_POINTER);
    voltstep_params_preset(VOLTSTEP_PRESET_BMW_I3_CONSTANT, &params);
    voltstep_inputs_default(&inputs);
    wrong += expect(voltstep_step(&plant, &state, &inputs, 0),
                    VOLTSTEP_STATUS_PLANT_NOT_INITIALISED);
    wrong += expect(voltstep_plant_init((VoltstepPlant *)((uintptr_t)&plant + 1), &params, 1e-3f),
                    VOLTSTEP_STATUS_MISALIGNED);
    wrong += expect(voltstep_plant_init(&plant, &params, -1.0f), VOLTSTEP_STATUS_DT_S);
    params.drives[0].motor.inductance_h = 0.0f;
    VoltstepStatus status = voltstep_plant_init(&plant, &params, 1e-3f);
    wrong += expect(status, VOLTSTEP_STATUS_MOTOR_INDUCTANCE_H);
    if (!same(voltstep_error_message(status),
              "motor.inductance_h must be finite and between 1e-12 and 1e12")) {
        wrong += failed("not the expected words", status);
    }
    return wrong;
}

static int drive(const char *name, VoltstepPreset preset)
{
    static VoltstepPlant plant;
    static VoltstepState state;
    VoltstepParams params;
    VoltstepInputs inputs;
    VoltstepStatus status = voltstep_params_preset(preset, &params);
    if (status == VOLTSTEP_STATUS_NOT_BUILT_IN) {
        failed(name, status);
        return 0; /* a smaller library, on purpose */
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_plant_init(&plant, &params, CYCLE_DT_S);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_state_init(&plant, &state, params.initial_soc, 0.0f);
    }
    voltstep_inputs_default(&inputs);
    Cycle cycle = { 0 };
    hash = HASH_START;
    for (long n = 0; n < CYCLE_STEPS && status == VOLTSTEP_STATUS_OK; n++) {
        VoltstepSnapshot now;
        cycle_step(&cycle, &inputs.reference_m_s, &inputs.reference_m_s2);
        status = voltstep_step(&plant, &state, &inputs, 0);
        voltstep_state_snapshot(&state, &now);
        for (uint32_t k = 0; k < params.drive_count; k++) {
            hash_drive(&params.drives[k], &now.drives[k]);
        }
        hash_sum(now.speed_m_s);
        hash_sum(now.distance_m);
        hash_sum(now.soc);
        hash_sum(now.rc_v);
        hash_float(now.battery_v);
        hash_float(now.duty);
    }
    if (status != VOLTSTEP_STATUS_OK) {
        return failed(name, status);
    }
    say_hash(name);
    return 0;
}

int main(void)
{
    return mistakes() + drive("epowertrain-udds", VOLTSTEP_PRESET_EPOWERTRAIN_UDDS) +
           drive("bmw-i3-60ah-constant", VOLTSTEP_PRESET_BMW_I3_CONSTANT) +
           drive("bmw-i3-60ah-pmsm", VOLTSTEP_PRESET_BMW_I3_PMSM) +
           drive("bmw-i3-60ah-thermal", VOLTSTEP_PRESET_BMW_I3_THERMAL) +
           drive("two-axles", VOLTSTEP_PRESET_TWO_AXLES);
}
