/* SPDX-License-Identifier: MIT */
/*
 * Bridges: frames whose motion is measured badly or not at all, between two frames whose motion to each other is
 * known.
 *
 * A blurred frame k is hard to align with the sharp frame before it, but frame k + 1 is sharp again and aligns well
 * with frame k - 1. That motion G from frame k + 1 to frame k - 1 tells what F_k F_{k+1} has to be, so that the path
 * behind the gap is where the camera is. Sharing out finds the motions in between: as close to what was measured for
 * each frame as their weights ask, with the product G exactly.
 */
#ifndef L1L2_MOTION_MOTION_BRIDGE_H
#define L1L2_MOTION_MOTION_BRIDGE_H

#include <stdbool.h>

#include "common/geom.h"

/* Frames that a bridge may span: its first one is aligned with the last good picture so many frames before the one
 * behind the gap. */
enum { L1L2_BRIDGE_MAX_FRAMES = 8 };

/* A similarity by its logarithm: F = exp [zoom -turn x; turn zoom y; 0 0 0]. Unit of x and y: F's. */
typedef struct L1L2SimilarityLog {
    double zoom, turn, x, y;
} L1L2SimilarityLog;

/* F is a similarity that turns by less than half a circle. */
L1L2SimilarityLog l1l2_motion_log(const L1L2Mat *F);
L1L2Mat l1l2_motion_exp(const L1L2SimilarityLog *log);

/*
 * The motions F[0] ... F[frames - 1], each from a frame to the one before it, whose product F[0] F[1] ... is G: the
 * motion from the last of these frames to the picture before the first. On input F[i] is what was measured for the
 * frame, and weight[i] >= 0 how firmly it is held: the reciprocal of its variance, any unit. Weight 0: nothing was
 * measured, F[i] is not read, and what is left of G is shared evenly among these frames.
 *
 * duration[i] > 0: the time of each frame, any unit; NULL: all the same. What is shared is shared in proportion to it.
 */
void l1l2_motion_share_out(const L1L2Mat *G, L1L2Mat *F, const double *weight, const double *duration, int frames);

#endif
