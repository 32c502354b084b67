/* FNV-1a, 64 bits, over the four bytes of a float, the lowest first. */
#ifndef HASH_H
#define HASH_H

#include <stdint.h>

#include "platform.h"

#define HASH_START 0xcbf29ce484222325u
static uint64_t hash = HASH_START;

static inline void hash_byte(uint8_t byte)
{
    hash = (hash ^ byte) * 0x100000001b3u;
}

static inline void hash_float(float value)
{
    union {
        float value;
        uint32_t word;
    } bits = { value };
    for (int i = 0; i < 4; i++) {
        hash_byte(bits.word >> 8 * i & 0xff);
    }
}

static inline void say_hash(const char *name)
{
    char text[] = " hash 0000000000000000\n";
    for (int i = 0; i < 16; i++) {
        text[21 - i] = "0123456789abcdef"[hash >> 4 * i & 0xf];
    }
    say(name);
    say(text);
}

#endif
