/* SPDX-License-Identifier: MIT */
/*
 * What the lens shows of a scene: its layers and what moves before them, averaged over the time that the shutter is
 * open and over the lens's aperture.
 */
#ifndef SYNTH_VIEW_H
#define SYNTH_VIEW_H

#include "synth_mover.h"
#include "synth_scene.h"

enum { SYNTH_VIEW_MAX_EYES = 24 };

/* The camera at one instant. */
typedef struct SynthEye {
    double M[9];
    SynthMover mover[SYNTH_MAX_MOVERS];
    int movers;
} SynthEye;

typedef struct SynthView {
    double parallax;
    SynthEye eye[SYNTH_VIEW_MAX_EYES]; /* their mean is seen */
    int eyes;
} SynthView;

/* From the camera's path at a time in frames; blur: diameter of a point out of focus, px. */
void synth_view_aim(SynthView *view, const SynthConfig *cfg, double frames, double blur);

/* From M, and nothing moves before the scene. */
void synth_view_aim_at(SynthView *view, const SynthConfig *cfg, const double M[9]);

void synth_view_draw(const SynthView *view, const SynthScene *scene, const SynthSpan *span, uint16_t *deep);

#endif
