/*
 * The whole BMS of an own pack, eighteen groups of twenty cells: it starts knowing nothing, drives, one
 * reading drifts until the contactors open, the power goes, a workshop clears the fault and it drives
 * again. Says the hash of all that it said, which is the same on a PC, on a Cortex-M4F and from Rust
 * (examples/bms.rs, the same pack line by line).
 */
#include "hash.h"
#include "platform.h"
#include "voltstep.h"

enum { CELLS = 18, SENSORS = 4, DRIVEN_MS = 16000, AGAIN_MS = 6000 };
#define PARALLEL 20.0f
#define PRECHARGE_OHM 33.0f
#define LINK_F 0.0012f
#define BLEEDER_OHM 5000.0f
#define DT_S 0.001f

static VoltstepEstimatorParams known;
static VoltstepBmsParams params;
static VoltstepBms bms;
static VoltstepBmsState state;
static VoltstepBmsInputs in;
static VoltstepBmsOutputs told;
static VoltstepBmsReport report;

/* What is behind the sensors. */
static float soc = 0.6f, link_v = 0.0f;
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
    const float *point = &known.cell.open_circuit_v[i < 63 ? i : 63];
    return point[0] + (point[1] - point[0]) * (soc * 64.0f - (float)i);
}

/* What is drawn, within what is allowed. */
static float load_a(uint32_t ms)
{
    static const float AMPS[4] = { 80.0f, 20.0f, -20.0f, 0.0f };
    float wanted_a = AMPS[ms / 2000 % 4];
    if (wanted_a > report.discharge_limit_a) {
        return report.discharge_limit_a;
    }
    return wanted_a < -report.charge_limit_a ? -report.charge_limit_a : wanted_a;
}

/* A millisecond of cells, link and sensors, contactors as they were told. */
static void measure(uint32_t ms, float drift_v)
{
    float rest_v = open_circuit_v(), pack_v = 0.0f, current_a = 0.0f;
    int closed = told.minus && told.plus;
    if (closed) {
        current_a = load_a(ms);
    } else if (told.minus && told.precharge) {
        current_a = ((float)CELLS * rest_v - link_v) / PRECHARGE_OHM;
    }
    float cell_a = current_a / PARALLEL;
    soc = soc - cell_a * (DT_S / 3600.0f) / known.cell.capacity_ah;
    in.cells_new = in.temperatures_new = ms % 20 == 0;
    for (int i = 0; i < CELLS; i++) {
        float ohm = 0.035f + 0.001f * (float)i;
        float off_v = 0.0005f * (float)(i - 9);
        float cell_v = rest_v + off_v - ohm * cell_a;
        pack_v = pack_v + cell_v;
        float seen_v = cell_v + (i == 9 ? drift_v : -drift_v / 17.0f);
        in.cell_v[i] = seen_v + 0.0005f * draw();
    }
    if (closed) {
        link_v = pack_v;
    } else {
        link_v = link_v + (current_a / LINK_F - link_v / (BLEEDER_OHM * LINK_F)) * DT_S;
    }
    for (int i = 0; i < SENSORS; i++) {
        in.temperature_c[i] = 25.0f + 0.05f * draw();
    }
    in.current_new = in.pack_new = in.link_new = 1;
    in.current_a = current_a + 0.2f * draw();
    in.pack_v = pack_v + 0.02f * draw();
    in.link_v = link_v + 0.02f * draw();
    in.feedback[0] = told.minus ? VOLTSTEP_BMS_FEEDBACK_CLOSED : VOLTSTEP_BMS_FEEDBACK_OPEN;
    in.feedback[1] = told.precharge ? VOLTSTEP_BMS_FEEDBACK_CLOSED : VOLTSTEP_BMS_FEEDBACK_OPEN;
    in.feedback[2] = told.plus ? VOLTSTEP_BMS_FEEDBACK_CLOSED : VOLTSTEP_BMS_FEEDBACK_OPEN;
    in.uptime_us = in.uptime_us + 1000;
}

static void hash_word(uint32_t word)
{
    for (int i = 0; i < 4; i++) {
        hash_byte(word >> 8 * i & 0xff);
    }
}

static void hash_known(void)
{
    hash_float(report.soc);
    hash_float(report.soc_sd);
    hash_float(report.soc_min);
    hash_float(report.soc_max);
    hash_float(report.health.resistance_factor);
    hash_float(report.discharge_limit_a);
    hash_float(report.charge_limit_a);
    hash_float(report.energy.remaining_energy_wh);
    hash_float(report.current_a);
    hash_float(report.link_v);
    for (int i = 0; i < 3; i++) {
        hash_word(report.tripped[i]);
        hash_word(report.latched[i]);
    }
    hash_byte((uint8_t)report.phase);
    hash_byte((uint8_t)report.cause);
    hash_byte(told.minus);
    hash_byte(told.precharge);
    hash_byte(told.plus);
    for (int i = 0; i < CELLS; i++) {
        hash_byte(told.bleed[i]);
    }
}

/* So many milliseconds; one reading drifts by so much in each after the first twelve seconds. */
static VoltstepStatus run(uint32_t duration_ms, float drift_v_per_ms, uint32_t clear)
{
    VoltstepBmsRequest request = { .vehicle = VOLTSTEP_BMS_WISH_OFF, .clear = clear };
    VoltstepStatus status = VOLTSTEP_STATUS_OK;
    for (uint32_t ms = 0; ms < duration_ms && status == VOLTSTEP_STATUS_OK; ms++) {
        VoltstepRecord record;
        bool worth;
        measure(ms, ms > 12000 ? drift_v_per_ms * (float)(ms - 12000) : 0.0f);
        status = voltstep_bms_request(&bms, &state, &request);
        request.vehicle = ms >= 500 ? VOLTSTEP_BMS_WISH_DRIVE : VOLTSTEP_BMS_WISH_OFF;
        request.clear = VOLTSTEP_BMS_CLEAR_NO;
        if (status == VOLTSTEP_STATUS_OK) {
            status = voltstep_bms_tick(&bms, &state, &in, &told);
        }
        if (status == VOLTSTEP_STATUS_OK) {
            status = voltstep_bms_report(&bms, &state, &report);
        }
        if (status == VOLTSTEP_STATUS_OK) {
            status = voltstep_bms_record(&bms, &state, 1, ms, &record, &worth);
        }
        hash_known();
        if (worth) {
            hash_float(record.soc);
            hash_float(record.resistor_heat_j);
        }
    }
    return status;
}

/* The power goes, and comes again after ten minutes: what is worth keeping, through its bytes. */
static VoltstepStatus cut_off(void)
{
    VoltstepRecord record;
    uint8_t bytes[VOLTSTEP_RECORD_BYTES];
    uint32_t sequence = 0;
    VoltstepStatus status = voltstep_bms_worth_keeping(&bms, &state, 1, 100, &record);
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
        status = voltstep_bms_start(&bms, &state, &record, 1, 700, 25.0f);
    }
    told = (VoltstepBmsOutputs){ 0 };
    return status;
}

static int same(const char *a, const char *b)
{
    while (*a == *b && *a != 0) {
        a++, b++;
    }
    return *a == *b;
}

/* Mistakes get their code and their words. */
static int mistakes(void)
{
    const char *refused = 0;
    VoltstepBmsParams bad = params;
    int wrong = voltstep_bms_tick(&bms, &state, &in, &told) != VOLTSTEP_STATUS_BMS_NOT_INITIALISED;
    bad.sheet.cell.voltage.absolute_min_v = 1.0f;
    wrong |= voltstep_bms_init(&bms, &bad, &refused) != VOLTSTEP_STATUS_PARAMETER || refused == 0 ||
             !same(refused, "sheet.voltage.absolute_min_v must lie above the field that limits it "
                            "from below");
    bad.sheet.layout.series = 14;
    wrong |= voltstep_bms_init(&bms, &bad, &refused) != VOLTSTEP_STATUS_CELL_COUNT;
    return wrong;
}

int main(void)
{
    VoltstepBmsSheet sheet;
    voltstep_estimator_params_preset(VOLTSTEP_CELL_PRESET_PANASONIC_NCR18650_PF, &known);
    voltstep_bms_sheet_example(&sheet);
    /* From the data sheets; here only some figures are one's own. */
    sheet.layout.series = CELLS;
    sheet.cell.discharge = (VoltstepBmsCurrents){ 5.8f, 8.7f };
    sheet.cell.charge = (VoltstepBmsCurrents){ 1.5f, 3.0f };
    sheet.cell.capacity_ah = 2.9f;
    VoltstepStatus status =
        voltstep_bms_params_typical(&sheet, &known.cell, PRECHARGE_OHM, &params);
    if (status != VOLTSTEP_STATUS_OK || mistakes()) {
        say("a mistake did not get its code\n");
        return 1;
    }
    const char *refused = 0;
    status = voltstep_bms_init(&bms, &params, &refused);
    if (status == VOLTSTEP_STATUS_OK) {
        status = voltstep_bms_start(&bms, &state, 0, 0, 0, 25.0f);
    }
    in.balancing_c = 25.0f;
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(DRIVEN_MS, 2e-4f, VOLTSTEP_BMS_CLEAR_NO);
    }
    if (status == VOLTSTEP_STATUS_OK && report.phase != VOLTSTEP_BMS_PHASE_FAULT) {
        say("the reading that drifted did not open the contactors\n");
        return 1;
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = cut_off();
    }
    if (status == VOLTSTEP_STATUS_OK) {
        status = run(AGAIN_MS, 0.0f, VOLTSTEP_BMS_CLEAR_SERVICE);
    }
    if (status != VOLTSTEP_STATUS_OK) {
        say(refused != 0 ? refused : voltstep_error_message(status));
        say("\n");
        return 1;
    }
    if (report.phase != VOLTSTEP_BMS_PHASE_CLOSED) {
        say("it does not drive again\n");
        return 1;
    }
    say_hash("bms");
    return 0;
}
