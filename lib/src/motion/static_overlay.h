/* SPDX-License-Identifier: MIT */
/*
 * What never moves though the camera does: logos, burnt-in text and clocks. The places where such tracks were seen are
 * remembered for some time; no corner is looked for there.
 */
#ifndef L1L2_MOTION_STATIC_OVERLAY_H
#define L1L2_MOTION_STATIC_OVERLAY_H

#include <stdbool.h>

#include "fit/ransac.h"
#include "motion/vision.h"

typedef struct L1L2StaticOverlay {
    double half_w, half_h;       /* of the frame, in the pairs' unit */
    double pixel;                /* of the tracked picture, ditto */
    int score[L1L2_MASK_CELLS];  /* how often something stood still here, less how often it did not */
} L1L2StaticOverlay;

void l1l2_motion_overlay_reset(L1L2StaticOverlay *o);

/* After a frame: F is the camera's motion, the pairs are all that was tracked. */
void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2Pair *pairs, const bool *inlier, int count,
                               const L1L2Mat *F);

/* Is p in a place where something stands still? */
bool l1l2_motion_overlay_covers(const L1L2StaticOverlay *o, L1L2Point p);

/* All such places. Time passes: what is masked is not seen to stand still any more, so it is let go of after some
 * 200 frames, and found again within a few if it is still there. */
void l1l2_motion_overlay_mask(L1L2StaticOverlay *o, L1L2Mask *mask);

#endif
