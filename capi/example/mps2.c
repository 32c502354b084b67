/*
 * The machine mps2-an386 of QEMU (Cortex-M4F), without a C library: reset, memory, semihosting.
 */
#include <stddef.h>
#include <stdint.h>

#include "platform.h"

extern uint32_t stack_top, data_start, data_end, data_load, bss_start, bss_end;
int main(void);
void reset(void);

/* A call of semihosting: the debugger, here QEMU, does it. */
static uint32_t semihost(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_EXIT = 0x18 };
enum { OPEN_TO_WRITE = 4, EXIT_GOOD = 0x20026, EXIT_BAD = 0x20023 };

/* To standard output: the console of semihosting is standard error. */
void say(const char *text)
{
    static const char console[] = ":tt";
    static uint32_t handle;
    if (handle == 0) {
        const uint32_t open[] = { (uint32_t)console, OPEN_TO_WRITE, sizeof console - 1 };
        handle = semihost(SYS_OPEN, open);
    }
    uint32_t length = 0;
    while (text[length] != 0) {
        length++;
    }
    const uint32_t write[] = { handle, (uint32_t)text, length };
    semihost(SYS_WRITE, write);
}

__attribute__((noreturn)) static void leave(int status)
{
    for (;;) {
        semihost(SYS_EXIT, (const void *)(uintptr_t)(status == 0 ? EXIT_GOOD : EXIT_BAD));
    }
}

__attribute__((noreturn)) static void fault(void)
{
    say("fault\n");
    leave(1);
}

/* Where the stack begins, then reset, NMI and the faults. */
__attribute__((section(".vectors"), used)) static const struct {
    const void *stack;
    void (*handlers[15])(void);
} vectors = { &stack_top, { reset, fault, fault, fault, fault, fault } };

/* No library call may stand for these loops: there is no library yet. */
__attribute__((noreturn, optimize("no-tree-loop-distribute-patterns"))) void reset(void)
{
    /* Access to the floating-point unit, before anything uses it. */
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    const uint32_t *from = &data_load;
    for (uint32_t *to = &data_start; to < &data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end;) {
        *to++ = 0;
    }
    leave(main());
}

/* What a compiler calls by itself. */
__attribute__((weak, optimize("no-tree-loop-distribute-patterns"))) void *
memcpy(void *restrict to, const void *restrict from, size_t count)
{
    unsigned char *t = to;
    for (const unsigned char *f = from; count > 0; count--) {
        *t++ = *f++;
    }
    return to;
}

__attribute__((weak, optimize("no-tree-loop-distribute-patterns"))) void *
memset(void *to, int byte, size_t count)
{
    for (unsigned char *t = to; count > 0; count--) {
        *t++ = (unsigned char)byte;
    }
    return to;
}
