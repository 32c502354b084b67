/* A compensated sum (Kahan), as the library has it. */
#ifndef SUM_H
#define SUM_H

typedef struct {
    float value, lost;
} Sum;

static inline void add(Sum *sum, float increment)
{
    float wanted = increment - sum->lost;
    float value = sum->value + wanted;
    sum->lost = (value - sum->value) - wanted;
    sum->value = value;
}

#endif
