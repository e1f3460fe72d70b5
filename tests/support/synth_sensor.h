/* SPDX-License-Identifier: MIT */
/* Turns the picture behind the lens into code values: exposure, fades, a covered lens, rounding, noise, coding. */
#ifndef SYNTH_SENSOR_H
#define SYNTH_SENSOR_H

#include "synth_span.h"
#include "synth_timeline.h"

typedef struct SynthSensor {
    double noise;    /* sigma, gray levels */
    double coding;   /* step, gray levels */
    int8_t *coarse;  /* the noise in gray levels; NULL without noise */
    int16_t *fine;   /* the same noise in 1/256 gray levels */
} SynthSensor;

void synth_sensor_init(SynthSensor *sensor, const SynthConfig *cfg);
void synth_sensor_clear(SynthSensor *sensor);

/* Applies the moment's events to the light, in place. */
void synth_sensor_expose(const SynthMoment *m, int width, const SynthSpan *span, uint16_t *deep);

/* Writes the code values of `depth` bits, 8..16, of frame t. grain: number of the frame whose noise is used. */
void synth_sensor_read(const SynthSensor *sensor, int t, int grain, int depth, const SynthSpan *span,
                       const uint16_t *deep, uint16_t *code);

#endif
