/* SPDX-License-Identifier: MIT */
#include "synth_timeline.h"

#include <math.h>

static double clamp01(double v)
{
    return fmin(fmax(v, 0.0), 1.0);
}

/* The part of the lens that a hand covers. It comes from one side, stays, and goes back. */
static double covered(int i, int frames)
{
    const int slide = frames / 4 < 4 ? frames / 4 : 4;
    const int from_end = i < frames - 1 - i ? i : frames - 1 - i;
    return clamp01((from_end + 1.0) / (slide + 1.0));
}

/* Applies one event; events are applied in their order. i: frames since the event's first one. */
static void apply(const SynthConfig *cfg, const SynthEvent *e, int i, SynthMoment *m)
{
    const bool during = i >= 0 && i < e->frames, after = i >= e->frames;
    const double progress = clamp01((i + 1.0) / (e->frames + 1.0));
    switch (e->kind) {
    case SYNTH_NONE: break;
    case SYNTH_CUT: m->shot += i >= 0; break;
    case SYNTH_DISSOLVE:
        m->shot += after;
        m->mix = during ? progress : m->mix;
        break;
    case SYNTH_FADE_OUT: m->black = i < 0 ? m->black : after ? 1.0 : progress; break;
    case SYNTH_FADE_IN: m->black = i < 0 ? m->black : after ? 0.0 : 1.0 - progress; break;
    case SYNTH_BLACK: m->black = during ? 1.0 : m->black; break;
    case SYNTH_FLASH: m->white = during ? e->amount : m->white; break;
    case SYNTH_COVER: m->cover = during ? covered(i, e->frames) : m->cover; break;
    case SYNTH_GAIN: m->gain *= during ? e->amount : 1.0; break;
    case SYNTH_RAMP: m->gain *= i < 0 ? 1.0 : after ? e->amount : 1.0 + (e->amount - 1.0) * progress; break;
    case SYNTH_FLICKER: m->gain *= during ? 1.0 + e->amount * sin(6.283185307179586 * 6.0 * i / cfg->fps) : 1.0; break;
    case SYNTH_BLUR: m->blur = during ? e->amount : m->blur; break;
    case SYNTH_FREEZE: break; /* before all others */
    }
}

SynthMoment synth_timeline_at(const SynthConfig *cfg, int t)
{
    SynthMoment m = {.gain = 1.0, .taken = t};
    for (int k = 0; k < SYNTH_MAX_EVENTS; k++) {
        const SynthEvent *e = &cfg->event[k];
        if (e->kind == SYNTH_FREEZE && t >= e->from && t < e->from + e->frames)
            m.taken = e->from > 0 ? e->from - 1 : 0;
    }
    m.time = m.taken;
    if (cfg->repeat_every > 1) { /* n - 1 frames in the time of n, the last of them twice */
        const int n = cfg->repeat_every, phase = m.taken % n, shown = phase < n - 1 ? phase : n - 2;
        m.taken += shown - phase;
        m.time = m.taken - shown + shown * n / (n - 1.0);
    }
    for (int k = 0; k < SYNTH_MAX_EVENTS; k++)
        apply(cfg, &cfg->event[k], t - cfg->event[k].from, &m);
    return m;
}

bool synth_timeline_cuts(const SynthConfig *cfg)
{
    for (int k = 0; k < SYNTH_MAX_EVENTS; k++)
        if (cfg->event[k].kind == SYNTH_CUT || cfg->event[k].kind == SYNTH_DISSOLVE)
            return true;
    return false;
}
