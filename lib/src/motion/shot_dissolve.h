/* SPDX-License-Identifier: MIT */
/*
 * Detection of dissolves, in which one shot turns into another: the current picture and an older one differ, and the
 * picture halfway between them is a mixture of the two. An object that passes before the camera hides a part of the
 * picture, but mixes nothing. The pictures are thumbnails, aligned by the measured motion.
 */
#ifndef L1L2_MOTION_SHOT_DISSOLVE_H
#define L1L2_MOTION_SHOT_DISSOLVE_H

#include "common/geom.h"
#include "image/thumbnail.h"
#include "motion/parameters.h"

enum { L1L2_DISSOLVE_FRAMES = 49 }; /* the longest distance of two compared frames, and one */

typedef struct L1L2ShotDissolve {
    const L1L2MotionParameters *parameters;
    struct {
        L1L2Thumbnail thumbnail;
        double x, y;       /* position of the picture's center along the camera path, thumbnail pixels */
    } frame[L1L2_DISSOLVE_FRAMES];
    int count, newest;
} L1L2ShotDissolve;

/* Forgets all frames but this one, the first of a shot. */
void l1l2_motion_dissolve_start(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail);

/* Takes the next frame and its motion F, from frame t to t-1, with (half_w, half_h) half of the frame's size in F's
 * unit. True if the frame belongs to another shot than those before; the caller then starts a shot with it. */
bool l1l2_motion_dissolve_push(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail, const L1L2Mat *F, double half_w,
                                 double half_h);

#endif
