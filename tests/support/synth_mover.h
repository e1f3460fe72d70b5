/* SPDX-License-Identifier: MIT */
/* Moving subjects: textured ellipses in front of the scene. They move over the frame and do not rotate. */
#ifndef SYNTH_MOVER_H
#define SYNTH_MOVER_H

#include "synth.h"

typedef struct SynthMover {
    double x, y;               /* center in the frame, px */
    double half_w, half_h;     /* semi-axes, px; nothing if 0 */
    double texture_x, texture_y; /* of its center in the scene's tile, px */
} SynthMover;

/* Sets the movers for a camera at M, at a time in frames. Returns their number. */
int synth_movers_at(const SynthConfig *cfg, double frames, const double M[9], SynthMover mover[SYNTH_MAX_MOVERS]);

#endif
