/* SPDX-License-Identifier: MIT */
/* The synthetic clips by which the motion and the whole library are judged: one of each kind of footage. */
#ifndef SYNTH_CASES_H
#define SYNTH_CASES_H

#include "synth.h"

/* What a clip is there to show. */
typedef enum SynthCaseKind {
    SYNTH_CASE_PLANAR, /* nothing but camera motion and noise of sigma 5 */
    SYNTH_CASE_HOLD,   /* who holds the camera: spectra, depth, blur, rolling shutter */
    SYNTH_CASE_MOVER,  /* moving subjects */
    SYNTH_CASE_EVENT,  /* cuts, light, what hides the scene; all after frame 40 and over by frame 130 */
    SYNTH_CASE_REPEAT, /* repeated and coded frames */
    SYNTH_CASE_OVERLAY /* what never moves */
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

/* The clip's config at another size of the same proportions: all that is measured in pixels goes with it. */
SynthConfig synth_case_at(const SynthCase *c, int width);

#endif
