/* SPDX-License-Identifier: MIT */
/* The synthetic clips on which the motion and the whole library are tested: one for each kind of footage. */
#ifndef SYNTH_CASES_H
#define SYNTH_CASES_H

#include "synth.h"

/* What a clip tests. */
typedef enum SynthCaseKind {
    SYNTH_CASE_PLANAR, /* nothing but camera motion and noise of sigma 5 */
    SYNTH_CASE_HOLD,   /* how the camera is held: spectra, depth, blur, rolling shutter */
    SYNTH_CASE_MOVER,  /* moving subjects */
    SYNTH_CASE_EVENT,  /* cuts, changes of light, a hidden scene; all between frames 40 and 130 */
    SYNTH_CASE_REPEAT, /* repeated and coded frames */
    SYNTH_CASE_OVERLAY /* overlays that never move */
} SynthCaseKind;

typedef struct SynthCase {
    const char *name;
    SynthCaseKind kind;
    SynthConfig cfg;   /* 1280x720, 30 frames/s */
} SynthCase;

extern const SynthCase synth_cases[];
extern const int synth_case_count;

/* Aborts where there is none. */
const SynthCase *synth_case_named(const char *name);

/* The clip's config at another width, with the same proportions. All lengths in pixels are scaled with it. */
SynthConfig synth_case_at(const SynthCase *c, int width);

#endif
