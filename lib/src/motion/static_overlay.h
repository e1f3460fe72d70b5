/* SPDX-License-Identifier: MIT */
/*
 * Static overlays: logos, burnt-in text and clocks, which stand still while the camera moves. The places where such
 * tracks were seen are remembered for some time, and no corner is selected there.
 */
#ifndef L1L2_MOTION_STATIC_OVERLAY_H
#define L1L2_MOTION_STATIC_OVERLAY_H

#include <stdbool.h>

#include "fit/point_pairs.h"
#include "motion/parameters.h"
#include "motion/vision.h"

typedef struct L1L2StaticOverlay {
    const L1L2MotionParameters *parameters;
    double half_w, half_h;         /* of the frame, in the pairs' unit */
    double pixel;                  /* of the downscaled picture, in the pairs' unit */
    double score[L1L2_MASK_CELLS]; /* tracks that stood still in the cell, less those that did not */
} L1L2StaticOverlay;

void l1l2_motion_overlay_reset(L1L2StaticOverlay *o);

/* Learns from a frame: F is the camera's motion, the pairs are all tracks, inlier marks those that follow it. */
void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2Pair *pairs, const bool *inlier, int count,
                               const L1L2Mat *F);

/* True if p lies on an overlay. */
bool l1l2_motion_overlay_covers(const L1L2StaticOverlay *o, L1L2Point p);

/* Marks the cells of all overlays, and lets them age by one selection of corners. Nothing is tracked on a masked
 * overlay, so it is forgotten after 15 selections (about 150 frames), and found again
 * within a few frames if it is still there. */
void l1l2_motion_overlay_mask(L1L2StaticOverlay *o, L1L2Mask *mask);

#endif
