/* Nanoseconds a step of a monitor in C, all of whose inputs are new in each step.
 * fill.h has fill_world and fill_object, which draw every field, TYPE and the monitor's own names. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static unsigned int seed = 1;
static unsigned int drawn(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return seed >> 4;
}

#include "fill.h"

#define INPUTS 64
#define OBJECTS 16

static OBJECT objects[INPUTS][OBJECTS];
static INPUT inputs[INPUTS];
static STATE monitor;
static VERDICT verdict;

int main(int n_arguments, char **arguments)
{
    const long steps = n_arguments > 1 ? atol(arguments[1]) : 20000;
    struct timespec from, to;
    unsigned long said = 0;
    int n = 0;
    while (n < INPUTS) {
        inputs[n].objects = objects[n];
        inputs[n].n_objects = OBJECTS;
        fill_world(&inputs[n]);
        for (int one = 0; one < OBJECTS; one++) {
            UNKNOWN_OBJECT(&objects[n][one], 100u + (unsigned int)one, TYPE);
            fill_object(&objects[n][one]);
        }
        INIT(&monitor);
        /* What facts exclude is drawn again. */
        n += STEP(&monitor, &inputs[n], &verdict) == 0;
    }
    INIT(&monitor);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    for (long step = 0; step < steps; step++) {
        said += STEP(&monitor, &inputs[step % INPUTS], &verdict);
        said += verdict.book.best;
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    const double taken = (double)(to.tv_sec - from.tv_sec) * 1e9 + (double)(to.tv_nsec - from.tv_nsec);
    printf("%f %lu\n", taken / (double)steps, said);
    return 0;
}
