/* SPDX-License-Identifier: MIT */
/* Small frames of synthetic clips, and how they compare. */
#ifndef SYNTH_FIXTURE_H
#define SYNTH_FIXTURE_H

#include <string.h>

#include "checkx.h"
#include "synth.h"

enum { WIDTH = 320, HEIGHT = 180, PIXELS = WIDTH * HEIGHT };

static inline SynthConfig small_clip(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH, cfg.height = HEIGHT;
    return cfg;
}

/* Frame t in gray. */
static inline void gray(const Synth *s, int t, uint8_t picture[PIXELS])
{
    synth_render_gray(s, t, picture, WIDTH);
}

/* Frame t of a clip of which no other is needed. */
static inline void gray_once(const SynthConfig *cfg, int t, uint8_t picture[PIXELS])
{
    Synth *s = synth_new(cfg);
    gray(s, t, picture);
    synth_free(s);
}

static inline double mean_level(const uint8_t *p)
{
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        sum += p[i];
    return sum / PIXELS;
}

static inline double deviation(const uint8_t *p)
{
    const double mean = mean_level(p);
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        sum += (p[i] - mean) * (p[i] - mean);
    return sqrt(sum / PIXELS);
}

static inline double mean_difference(const uint8_t *a, const uint8_t *b)
{
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        sum += abs(a[i] - b[i]);
    return sum / PIXELS;
}

static inline int worst_difference(const uint8_t *a, const uint8_t *b)
{
    int worst = 0;
    for (int i = 0; i < PIXELS; i++)
        worst = abs(a[i] - b[i]) > worst ? abs(a[i] - b[i]) : worst;
    return worst;
}

#endif
