/* SPDX-License-Identifier: MIT */
#include "synth_sensor.h"

#include <math.h>
#include <stdlib.h>

#include "synth_scene.h"

enum { NOISE_SIZE = 1 << 16, BLOCK = 8 };

static const double black_level = 16.0, white_level = 235.0, neutral_level = 128.0, hand_level = 22.0;

void synth_sensor_init(SynthSensor *sensor, const SynthConfig *cfg)
{
    *sensor = (SynthSensor){.coding = cfg->coding};
    if (cfg->noise <= 0.0)
        return;
    sensor->coarse = synth_alloc(NOISE_SIZE + SYNTH_SPAN, sizeof *sensor->coarse);
    sensor->fine = synth_alloc(NOISE_SIZE + SYNTH_SPAN, sizeof *sensor->fine);
    for (uint64_t i = 0; i < NOISE_SIZE; i++) { /* Box-Muller transform */
        const double radius = sqrt(-2.0 * log(1.0 - synth_fraction(cfg->seed + 2 * i)));
        const double v = cfg->noise * radius * cos(6.283185307179586 * synth_fraction(cfg->seed + 2 * i + 1));
        sensor->coarse[i] = (int8_t)lrint(fmin(fmax(v, -127.0), 127.0));
        sensor->fine[i] = (int16_t)lrint(256.0 * fmin(fmax(v, -127.0), 127.0));
    }
    for (int i = 0; i < SYNTH_SPAN; i++) { /* so that a span's noise is contiguous wherever it starts */
        sensor->coarse[NOISE_SIZE + i] = sensor->coarse[i];
        sensor->fine[NOISE_SIZE + i] = sensor->fine[i];
    }
}

void synth_sensor_clear(SynthSensor *sensor)
{
    free(sensor->coarse);
    free(sensor->fine);
}

static uint16_t clamp(double v)
{
    return (uint16_t)fmin(fmax(v + 0.5, 0.0), 255.0 * SYNTH_DEEP);
}

/* Covers the lens from the right, with an edge that is far out of focus. */
static void cover(const SynthMoment *m, int width, const SynthSpan *span, uint16_t *deep)
{
    const double softness = 0.3;
    for (int i = 0; i < span->count; i++) {
        const double u = (span->x + i * span->step) / width + 0.5;
        const double alpha = fmin(fmax((u - 1.0 + m->cover * (1.0 + softness)) / softness, 0.0), 1.0);
        const double level = span->component ? neutral_level : hand_level + 6.0 * u;
        deep[i] = clamp(deep[i] + alpha * (level * SYNTH_DEEP - deep[i]));
    }
}

void synth_sensor_expose(const SynthMoment *m, int width, const SynthSpan *span, uint16_t *deep)
{
    if (m->cover > 0.0)
        cover(m, width, span, deep);
    if (m->gain == 1.0 && m->white == 0.0 && m->black == 0.0)
        return;
    /* level -> contrast * level + brightness: the gain, then towards white, then towards black; chroma fades to gray */
    const double fade = (1.0 - m->white) * (1.0 - m->black), contrast = m->gain * fade;
    const double brightness = span->component ? neutral_level * (1.0 - contrast)
                              : white_level * m->white * (1.0 - m->black) + black_level * m->black;
    for (int i = 0; i < span->count; i++)
        deep[i] = clamp(contrast * deep[i] + brightness * SYNTH_DEEP);
}

/* Like a coder that codes each block anew: levels are rounded to steps, with another offset in each block and frame. */
static void code_levels(const SynthSensor *sensor, int t, int depth, const SynthSpan *span, int *level)
{
    const double step = sensor->coding * (1 << (depth - 8));
    const uint64_t row = ((uint64_t)t << 40) + ((uint64_t)(span->j / BLOCK) << 20);
    for (int i = 0; i < span->count; i++) {
        const uint64_t key = synth_hash(row + (uint64_t)((span->i + i) / BLOCK)) + (uint64_t)span->component;
        const double offset = step * synth_fraction(key);
        level[i] = (int)lrint(floor((level[i] + offset) / step + 0.5) * step - offset);
    }
}

static void add_noise(const SynthSensor *sensor, int grain, int depth, const SynthSpan *span, int *level)
{
    const uint64_t start = synth_hash(((uint64_t)grain << 20) + (uint64_t)span->j) + (uint64_t)span->i;
    const int8_t *coarse = sensor->coarse + start % NOISE_SIZE;
    const int16_t *fine = sensor->fine + start % NOISE_SIZE;
    const int scale = 1 << (depth - 8);
    if (depth == 8)
        for (int i = 0; i < span->count; i++)
            level[i] += coarse[i];
    else
        for (int i = 0; i < span->count; i++)
            level[i] += (fine[i] * scale + 128) >> 8;
}

void synth_sensor_read(const SynthSensor *sensor, int t, int grain, int depth, const SynthSpan *span,
                       const uint16_t *deep, uint16_t *code)
{
    const int full = (256 << (depth - 8)) - 1, down = depth < 14 ? 14 - depth : 0, up = depth > 14 ? depth - 14 : 0;
    int level[SYNTH_SPAN];
    for (int i = 0; i < span->count; i++)
        level[i] = (deep[i] + (1 << down >> 1)) >> down << up;
    if (span->component == 0 && sensor->coarse)
        add_noise(sensor, grain, depth, span, level);
    if (sensor->coding > 0.0)
        code_levels(sensor, t, depth, span, level);
    for (int i = 0; i < span->count; i++)
        code[i] = (uint16_t)(level[i] < 0 ? 0 : level[i] > full ? full : level[i]);
}
