/* SPDX-License-Identifier: MIT */
/*
 * Static overlays: logos, burnt-in text and clocks, dirt on the lens, which stand still while the camera moves.
 *
 * Each pixel of the picture at half size collects evidence. Where the current picture looks like the previous one at
 * the same place, and unlike the previous one at the place from which the camera's motion would have brought it,
 * something stands still. Where it changed, the scene is seen. Flat places tell nothing. The places found are excluded
 * from corners, tracks and whole-picture alignment.
 *
 * What the caller excludes from measuring (measured_area.h) is treated as such a place that is never forgotten.
 */
#ifndef L1L2_MOTION_STATIC_OVERLAY_H
#define L1L2_MOTION_STATIC_OVERLAY_H

#include <stdbool.h>

#include "common/geom.h"
#include "motion/measured_area.h"
#include "motion/parameters.h"
#include "motion/vision.h"

typedef struct L1L2StaticOverlay {
    const L1L2MotionParameters *parameters;
    double half_w, half_h; /* of the frame, diagonals */
    int width, height;     /* of the pictures, pixels */
    uint8_t *score;        /* evidence of each pixel, row by row */
    int8_t *told;          /* what the newest frame told of it */
    uint8_t *excluded;     /* 1: not to be measured; NULL: all is measured */
    uint8_t *covered;      /* 1: an overlay, or near one, or excluded */
    bool any;              /* some pixel is covered */
    bool stale;            /* `covered` is older than `score` */
} L1L2StaticOverlay;

/* width, height: of the pictures that l1l2_motion_overlay_learn() will be given, pixels. False: out of memory. */
bool l1l2_motion_overlay_init(L1L2StaticOverlay *o, int width, int height);
void l1l2_motion_overlay_clear(L1L2StaticOverlay *o);

/* Excludes all but an area, for good. Nothing is learned from what is excluded. *share: the part that is left, [0, 1].
 * False: out of memory. */
bool l1l2_motion_overlay_exclude(L1L2StaticOverlay *o, const L1L2MeasuredArea *area, double *share);

/* Forgets what was learned. */
void l1l2_motion_overlay_reset(L1L2StaticOverlay *o);

/* Learns from two pictures and the camera's motion F from the current one to the previous one. */
void l1l2_motion_overlay_learn(L1L2StaticOverlay *o, const L1L2GrayPicture *now, const L1L2GrayPicture *previous,
                               const L1L2Mat *F);

/* True if p lies on an overlay, or where nothing is measured. */
bool l1l2_motion_overlay_covers(L1L2StaticOverlay *o, L1L2Point p);

/* The covered pixels. blocked is NULL if there are none. Valid until o is changed. */
L1L2Mask l1l2_motion_overlay_mask(L1L2StaticOverlay *o);

/* Lets the evidence age, by one selection of corners. Where nothing is seen that tells, an overlay is forgotten after
 * 20 selections, about 200 frames. */
void l1l2_motion_overlay_age(L1L2StaticOverlay *o);

#endif
