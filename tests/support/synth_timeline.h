/* SPDX-License-Identifier: MIT */
/* What a frame of the clip shows: the time at which it was taken, its shot, and the events that apply to it. */
#ifndef SYNTH_TIMELINE_H
#define SYNTH_TIMELINE_H

#include "synth.h"

typedef struct SynthMoment {
    double time;  /* at which the camera took it, frames */
    int taken;    /* the number of the frame that this one repeats, or its own */
    int shot;
    double mix;   /* part of the next shot in the picture, [0, 1) */
    double gain;
    double white, black; /* part of white or black in the picture, [0, 1] */
    double cover; /* part of the lens that is covered, [0, 1] */
    double blur;  /* px */
} SynthMoment;

SynthMoment synth_timeline_at(const SynthConfig *cfg, int t);

/* Whether the clip has a second scene. */
bool synth_timeline_cuts(const SynthConfig *cfg);

#endif
