/* SPDX-License-Identifier: MIT */
/* What a frame of the clip shows: when it was taken, of which shot, and what was done to it. */
#ifndef SYNTH_TIMELINE_H
#define SYNTH_TIMELINE_H

#include "synth.h"

typedef struct SynthMoment {
    double time;  /* of the camera, frames */
    int taken;    /* the number of the frame that this one repeats, or its own */
    int shot;
    double mix;   /* part of the next shot in the picture, [0, 1) */
    double gain;
    double white, black; /* how far towards these, [0, 1] */
    double cover; /* part of the lens that is covered, [0, 1] */
    double blur;  /* px */
} SynthMoment;

SynthMoment synth_timeline_at(const SynthConfig *cfg, int t);

/* Whether the clip has a second scene. */
bool synth_timeline_cuts(const SynthConfig *cfg);

#endif
