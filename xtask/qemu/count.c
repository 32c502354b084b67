/*
 * A plugin for QEMU (system emulation, plugin API version 1) that counts instructions, exactly.
 *
 * Arguments:
 *   item=NAME@ADDRESS   count from each `bl` to this address until it returns; any number of these
 *   profile=on          also say how often every instruction ran
 *
 * Writes at the end, to QEMU's plugin log (-d plugin -D FILE):
 *   count NAME CALLS SUM MIN MAX CALL_OF_MAX
 *   run ADDRESS TIMES
 *
 * An instruction in an IT block whose condition fails counts, as it takes its cycle on hardware.
 */
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is used of qemu-plugin.h; Debian ships no header. */
typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef void (*tb_translated)(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void (*insn_executed)(unsigned int, void *);
typedef void (*at_exit)(qemu_plugin_id_t, void *);
enum { CB_NO_REGS = 0, INLINE_ADD_U64 = 0 };
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, tb_translated);
void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *, insn_executed, int, void *);
void qemu_plugin_register_vcpu_insn_exec_inline(struct qemu_plugin_insn *, int, void *, uint64_t);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, at_exit, void *);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *, size_t);
const void *qemu_plugin_insn_data(const struct qemu_plugin_insn *);
size_t qemu_plugin_insn_size(const struct qemu_plugin_insn *);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *);
void qemu_plugin_outs(const char *);

#define EXPORT __attribute__((visibility("default")))
EXPORT int qemu_plugin_version = 1;

#define ITEMS 128
#define SITES 1024
#define CODE_BYTES (1u << 20)

struct item {
    char name[64];
    uint64_t address, calls, sum, min, max, call_of_max;
};

/* Where an item is called, and where it returns to. */
struct site {
    uint64_t returns_to;
    struct item *item;
};

static struct item items[ITEMS];
static struct site sites[SITES];
static unsigned item_count, site_count;
static uint64_t executed, started_at;
static struct item *running;
static bool profile;
static uint64_t runs[CODE_BYTES / 2];

static void fail(const char *what)
{
    fprintf(stderr, "count plugin: %s\n", what);
    exit(3);
}

/* Both callbacks see `executed` at the same point of their instruction, so what lies between is
 * the `bl` itself and what ran after it. */
static void called(unsigned int cpu, void *site)
{
    (void)cpu;
    if (running) {
        fail("an item called while another runs, or a return was missed");
    }
    running = ((struct site *)site)->item;
    started_at = executed;
}

static void returned(unsigned int cpu, void *data)
{
    (void)cpu;
    struct site *site = data;
    if (running != site->item) {
        fail("a return without its call");
    }
    uint64_t count = executed - started_at - 1;
    struct item *item = running;
    if (item->calls == 0 || count < item->min) {
        item->min = count;
    }
    if (count > item->max) {
        item->max = count;
        item->call_of_max = item->calls;
    }
    item->calls++;
    item->sum += count;
    running = NULL;
}

/* The target of a `bl` (encoding T1) at `address`, 0 for anything else. */
static uint64_t bl_target(const struct qemu_plugin_insn *insn, uint64_t address)
{
    if (qemu_plugin_insn_size(insn) != 4) {
        return 0;
    }
    const uint8_t *b = qemu_plugin_insn_data(insn);
    uint32_t high = b[0] | (uint32_t)b[1] << 8, low = b[2] | (uint32_t)b[3] << 8;
    if ((high & 0xf800) != 0xf000 || (low & 0xd000) != 0xd000) {
        return 0;
    }
    uint32_t s = high >> 10 & 1, i1 = ~((low >> 13) ^ s) & 1, i2 = ~((low >> 11) ^ s) & 1;
    uint32_t offset = s << 24 | i1 << 23 | i2 << 22 | (high & 0x3ff) << 12 | (low & 0x7ff) << 1;
    int32_t signed_offset = (int32_t)(offset << 7) >> 7;
    return (uint32_t)(address + 4 + signed_offset);
}

static struct item *item_at(uint64_t address)
{
    for (unsigned i = 0; i < item_count; i++) {
        if (items[i].address == address) {
            return &items[i];
        }
    }
    return NULL;
}

static struct site *site_for(uint64_t returns_to, struct item *item)
{
    for (unsigned i = 0; i < site_count; i++) {
        if (sites[i].returns_to == returns_to) {
            return &sites[i];
        }
    }
    if (site_count == SITES) {
        fail("too many call sites");
    }
    sites[site_count] = (struct site){ returns_to, item };
    return &sites[site_count++];
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    size_t n = qemu_plugin_tb_n_insns(tb);
    for (size_t i = 0; i < n; i++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        uint64_t address = qemu_plugin_insn_vaddr(insn);
        struct item *item = item_at(bl_target(insn, address));
        if (item) {
            struct site *site = site_for(address + 4, item);
            qemu_plugin_register_vcpu_insn_exec_cb(insn, called, CB_NO_REGS, site);
        }
        for (unsigned k = 0; k < site_count; k++) {
            if (sites[k].returns_to == address) {
                qemu_plugin_register_vcpu_insn_exec_cb(insn, returned, CB_NO_REGS, &sites[k]);
            }
        }
        qemu_plugin_register_vcpu_insn_exec_inline(insn, INLINE_ADD_U64, &executed, 1);
        if (profile && address < CODE_BYTES) {
            uint64_t *run = &runs[address / 2];
            qemu_plugin_register_vcpu_insn_exec_inline(insn, INLINE_ADD_U64, run, 1);
        }
    }
}

static void finished(qemu_plugin_id_t id, void *data)
{
    (void)id, (void)data;
    char line[256];
    for (unsigned i = 0; i < item_count; i++) {
        const struct item *t = &items[i];
        snprintf(line, sizeof line,
                 "count %.63s %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", t->name,
                 t->calls, t->sum, t->min, t->max, t->call_of_max);
        qemu_plugin_outs(line);
    }
    for (unsigned i = 0; profile && i < CODE_BYTES / 2; i++) {
        if (runs[i]) {
            snprintf(line, sizeof line, "run %x %" PRIu64 "\n", 2 * i, runs[i]);
            qemu_plugin_outs(line);
        }
    }
}

EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        struct item *item = &items[item_count];
        if (!strcmp(argv[i], "profile=on")) {
            profile = true;
        } else if (item_count < ITEMS &&
                   sscanf(argv[i], "item=%63[^@]@%" SCNx64, item->name, &item->address) == 2) {
            item->address &= ~(uint64_t)1;
            item_count++;
        } else {
            fprintf(stderr, "count plugin: cannot use the argument %s\n", argv[i]);
            return -1;
        }
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, finished, NULL);
    return 0;
}
