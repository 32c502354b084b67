/*
 * A driving cycle in steps of 1 ms: its points, the line between them.
 *
 * The time within a segment is a compensated sum, as in the library's own table, so that the
 * reference has the same bits there and here.
 */
#ifndef CYCLE_H
#define CYCLE_H

#include <stddef.h>

#include "sum.h"

/* Time in s, speed in m/s; made from data/cycles/udds.csv. */
#include "udds.h"

enum { CYCLE_POINTS = sizeof UDDS / sizeof UDDS[0], CYCLE_STEPS = (CYCLE_POINTS - 1) * 1000 };
#define CYCLE_DT_S 1e-3f

typedef struct {
    size_t segment;
    Sum elapsed_s;
} Cycle;

/* The speed now in m/s, and how fast it changes in m/s^2; then time moves on. */
static inline void cycle_step(Cycle *cycle, float *speed, float *rate)
{
    if (cycle->segment + 1 >= CYCLE_POINTS) {
        *speed = UDDS[CYCLE_POINTS - 1][1];
        *rate = 0.0f;
        return;
    }
    const float *from = UDDS[cycle->segment], *to = UDDS[cycle->segment + 1];
    float length_s = to[0] - from[0];
    *rate = (to[1] - from[1]) / length_s;
    *speed = from[1] + *rate * cycle->elapsed_s.value;
    add(&cycle->elapsed_s, CYCLE_DT_S);
    if ((cycle->elapsed_s.value - length_s) - cycle->elapsed_s.lost >= 0.0f) {
        float kept_s = 0.0f - cycle->elapsed_s.lost;
        cycle->elapsed_s.lost = 0.0f;
        add(&cycle->elapsed_s, -length_s);
        add(&cycle->elapsed_s, kept_s);
        cycle->segment++;
    }
}

#endif
