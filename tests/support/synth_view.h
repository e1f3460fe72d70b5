/* SPDX-License-Identifier: MIT */
/*
 * The picture behind the lens: the layers of a scene and the movers in front of them, averaged over the time that the
 * shutter is open and over the aperture.
 */
#ifndef SYNTH_VIEW_H
#define SYNTH_VIEW_H

#include "synth_mover.h"
#include "synth_scene.h"

enum { SYNTH_MAX_VIEWPOINTS = 24 };

/* The camera at one instant of the exposure, through one point of its aperture. */
typedef struct SynthViewpoint {
    double M[9];
    SynthMover mover[SYNTH_MAX_MOVERS];
    int movers;
} SynthViewpoint;

typedef struct SynthView {
    double parallax;
    SynthViewpoint viewpoint[SYNTH_MAX_VIEWPOINTS]; /* the picture is the mean over all */
    int viewpoints;
} SynthView;

/* Sets the viewpoints of the camera's path at a time in frames. blur: diameter of a point out of focus, px. */
void synth_view_aim(SynthView *view, const SynthConfig *cfg, double frames, double blur);

/* Sets one viewpoint, M, without movers. */
void synth_view_aim_at(SynthView *view, const SynthConfig *cfg, const double M[9]);

void synth_view_draw(const SynthView *view, const SynthScene *scene, const SynthSpan *span, uint16_t *deep);

#endif
