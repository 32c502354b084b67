/*
 * Eighteen cells in series, driven, rested, cut off and driven again, seen through noisy sensors: what
 * the estimators believe of them. Says the hash of all that they say, which is the same on a PC, on a
 * Cortex-M4F and from Rust (examples/estimators.rs, the same profile line by line).
 */
#include "hash.h"
#include "platform.h"
#include "voltstep.h"

enum { CELLS = 18, PER_SECOND = 10, DRIVEN_S = 1500, RESTED_S = 2400 };
enum { WORDS = VOLTSTEP_SERIES_WORDS + CELLS * VOLTSTEP_SERIES_WORDS_PER_CELL };
#define DT_S 0.1f
/* Not a number. */
#define NO_READING_V (0.0f / 0.0f)

static VoltstepEstimatorParams params;
static VoltstepEstimators estimators;
static uint64_t pack[WORDS];

/* What the cells are, and what the sensors show of them. */
static float soc = 0.9f;
static uint32_t noise = 1;

/* The next of a sequence that looks random, in -1..1: xorshift. */
static float draw(void)
{
    noise ^= noise << 13;
    noise ^= noise >> 17;
    noise ^= noise << 5;
    return (float)(noise >> 8) / 8388608.0f - 1.0f;
}

/* The open-circuit voltage between the points of the table. */
static float open_circuit_v(void)
{
    int32_t i = (int32_t)(soc * 64.0f);
    const float *point = &params.cell.open_circuit_v[i < 63 ? i : 63];
    return point[0] + (point[1] - point[0]) * (soc * 64.0f - (float)i);
}

/* One sample: the current takes turns every five seconds, or there is none. */
static void sample(uint32_t n, int driven, VoltstepSeriesInput *input, float *cell_v)
{
    static const float AMPS[8] = { 3.0f, 7.0f, 0.0f, -2.0f, 5.0f, 1.0f, 9.0f, -4.0f };
    float current_a = driven ? AMPS[n / (5 * PER_SECOND) % 8] : 0.0f;
    soc = soc - current_a * (DT_S / 3600.0f) / params.cell.capacity_ah;
    float rest_v = open_circuit_v();
    for (int i = 0; i < CELLS; i++) {
        float ohm = 0.035f + 0.001f * (float)i;
        float off_v = 0.0005f * (float)(i - 9);
        cell_v[i] = rest_v + off_v - ohm * current_a + 0.001f * draw();
    }
    if (n % 97 == 0) {
        cell_v[3] = NO_READING_V;
    }
    input->current_a = current_a + 0.01f * draw();
    input->temperature_c = 25.0f;
    input->contactors_open = 0;
}

static void hash_believed(const VoltstepSeriesOutputs *out)
{
    const VoltstepEstimate *e = &out->estimate;
    const VoltstepHealth *h = &out->health;
    const float values[] = {
        e->soc, e->soc_sd, e->polarisation_v[0], e->polarisation_v[1], e->hysteresis, e->offset_v,
        e->temperature_c, h->capacity_ah, h->capacity_sd_ah, h->resistance_factor,
        h->resistance_factor_sd, out->counted_soc, out->counted_soc_sd, out->soc_min, out->soc_max,
    };
    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        hash_float(values[i]);
    }
    hash_byte((uint8_t)out->soc_min_index);
    hash_byte((uint8_t)out->soc_max_index);
    hash_byte(out->converged);
    hash_byte(out->consistent);
}

/* What may be drawn and charged, and what is left. */
static VoltstepStatus hash_ahead(void)
{
    VoltstepPowerAhead limits[VOLTSTEP_HORIZONS];
    VoltstepEnergyReport left;
    VoltstepStatus status = voltstep_series_power(&estimators, pack, limits);
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_series_energy(&estimators, pack, &left);
    }
    for (int i = 0; i < VOLTSTEP_HORIZONS; i++) {
        hash_float(limits[i].discharge.current_a);
        hash_float(limits[i].discharge.power_w);
        hash_float(limits[i].charge.current_a);
        hash_float(limits[i].charge.power_w);
    }
    hash_float(left.remaining_energy_wh);
    hash_float(left.remaining_energy_sd_wh);
    return status;
}

/* Runs for so many seconds. */
static VoltstepStatus run(uint32_t seconds, int driven)
{
    VoltstepStatus status = VOLTSTEP_STATUS_OK;
    for (uint32_t n = 0; n < seconds * PER_SECOND && status == VOLTSTEP_STATUS_OK; n++) {
        VoltstepSeriesInput input;
        VoltstepSeriesOutputs out;
        float cell_v[CELLS];
        sample(n, driven, &input, cell_v);
        status = voltstep_series_step(&estimators, pack, &input, cell_v, CELLS, &out);
        hash_believed(&out);
        if (n % (60 * PER_SECOND) == 0 && status == VOLTSTEP_STATUS_OK) {
            status = hash_ahead();
        }
    }
    return status;
}

/* The power goes, and comes again after ten minutes: what was worth keeping, through its bytes. */
static VoltstepStatus cut_off(void)
{
    VoltstepRecord record;
    uint8_t bytes[VOLTSTEP_RECORD_BYTES];
    uint32_t sequence = 0;
    VoltstepStatus status = voltstep_series_record(&estimators, pack, &record);
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_record_encode(&record, 1, bytes);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_record_decode(bytes, &record, &sequence);
    }
    for (int i = 0; i < VOLTSTEP_RECORD_BYTES && status == VOLTSTEP_STATUS_OK; i++) {
        hash_byte(bytes[i]);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_series_start(&estimators, pack, WORDS, CELLS, &record, 600.0f, 25.0f);
    }
    return status;
}

static VoltstepStatus hash_cells(void)
{
    VoltstepStatus status = VOLTSTEP_STATUS_OK;
    for (uint32_t i = 0; i < CELLS && status == VOLTSTEP_STATUS_OK; i++) {
        VoltstepSeriesCell cell;
        status = voltstep_series_cell(pack, i, &cell);
        hash_float(cell.soc);
        hash_float(cell.soc_sd);
        hash_float(cell.resistance_ratio);
        hash_float(cell.resistance_ratio_sd);
        hash_byte(cell.held);
    }
    return status;
}

/* Mistakes get their code. */
static int mistakes(void)
{
    float cell_v[CELLS] = { 0 };
    VoltstepSeriesInput input = { 0 };
    return voltstep_series_step(&estimators, pack, &input, cell_v, CELLS, 0) !=
               VOLTSTEP_STATUS_ESTIMATORS_NOT_INITIALISED ||
           voltstep_estimator_params_preset(99, &params) != VOLTSTEP_STATUS_UNKNOWN_CELL_PRESET;
}

int main(void)
{
    if (mistakes()) {
        say("a mistake did not get its code\n");
        return 1;
    }
    VoltstepStatus status =
        voltstep_estimator_params_preset(VOLTSTEP_CELL_PRESET_PANASONIC_NCR18650_PF, &params);
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_estimators_init(&estimators, &params, DT_S);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_series_start(&estimators, pack, WORDS, CELLS, 0, 0.0f, 25.0f);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(DRIVEN_S, 1);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(RESTED_S, 0);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(DRIVEN_S, 1);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(RESTED_S, 0);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = cut_off();
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(60, 1);
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = hash_cells();
    }
    if (status != VOLTSTEP_STATUS_OK) {
        say(voltstep_error_message(status));
        say("\n");
        return 1;
    }
    say_hash("estimators");
    return 0;
}
