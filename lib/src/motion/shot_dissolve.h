/* SPDX-License-Identifier: MIT */
/*
 * One shot dissolving into another: the picture now and the one some time ago differ, and the one in between is a mix
 * of the two. Something that passes before the camera hides a part of the picture, and mixes nothing.
 *
 * Works on thumbnails, laid over each other by the measured motion. A leaf.
 */
#ifndef L1L2_MOTION_SHOT_DISSOLVE_H
#define L1L2_MOTION_SHOT_DISSOLVE_H

#include "common/geom.h"
#include "motion/shot_cut.h"

enum { L1L2_DISSOLVE_FRAMES = 49 }; /* the longest dissolve that is seen, and one */

typedef struct L1L2ShotDissolve {
    struct {
        L1L2Thumbnail thumbnail;
        double x, y;       /* what lies at the picture's centre, in thumbnail pixels of the path */
    } frame[L1L2_DISSOLVE_FRAMES];
    int count, newest;
} L1L2ShotDissolve;

/* The first frame of a shot. */
void l1l2_motion_dissolve_start(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail);

/* The next one, and its motion: frame t to t-1, with (half_w, half_h) half of the frame's size in the same unit.
 * True where it belongs to another shot than the frames before; then the caller starts anew with it. */
bool l1l2_motion_dissolve_push(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail, const L1L2Mat *F, double half_w,
                        double half_h);

#endif
