/* The coupled plant with its PID in plain C, explicit Euler. */
#ifndef EULER_H
#define EULER_H

/* Steps per millisecond. */
#ifndef EULER_STEPS
#define EULER_STEPS 1
#endif

typedef struct {
    float integral, soc, current_a, speed_m_s, distance_m, battery_v;
} EulerPlant;

void euler_start(EulerPlant *plant);
void euler_step(EulerPlant *plant, const float *reference_m_s);

#endif
