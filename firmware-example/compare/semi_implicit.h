/* The coupled plant with its PID in plain C, semi-implicit: the library's work but for gates that open
 * and limits that are asked for. */
#ifndef SEMI_IMPLICIT_H
#define SEMI_IMPLICIT_H

#include <stdint.h>

#include "sum.h"

typedef struct {
    Sum integral, output;
} Pid;

typedef struct {
    Pid pid;
    Sum soc, rc_v, current_a, speed_m_s, distance_m;
    float battery_a, battery_v, duty;
    uint8_t limited, rejected;
} Plant;

void semi_implicit_start(Plant *plant);
void semi_implicit_step(Plant *plant, const float *reference_m_s);

#endif
