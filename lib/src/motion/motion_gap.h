/* SPDX-License-Identifier: MIT */
/*
 * A gap: frames whose tracks yielded no motion, such as blurred ones, since the last picture from which points could be
 * followed. That picture, the reference, is kept. A later picture that can be aligned with it bridges the gap: the
 * product of the motions has to be the one found, whatever was measured for the frames between.
 */
#ifndef L1L2_MOTION_MOTION_GAP_H
#define L1L2_MOTION_MOTION_GAP_H

#include "motion/motion_bridge.h"

typedef struct L1L2MotionGap {
    int frames; /* since the reference; 0: there is no gap */
    L1L2Mat F[L1L2_BRIDGE_MAX_FRAMES];
    double weight[L1L2_BRIDGE_MAX_FRAMES]; /* 0: not measured */
} L1L2MotionGap;

void l1l2_motion_gap_close(L1L2MotionGap *gap);

/* A frame of the gap; the first one opens it. weight: 1 if F was measured, 0 if not. False: the gap is too long, and is
 * closed. */
bool l1l2_motion_gap_add(L1L2MotionGap *gap, const L1L2Mat *F, double weight);

/* The motion from the newest frame to the reference, by the frames' own motions. */
L1L2Mat l1l2_motion_gap_product(const L1L2MotionGap *gap);

/* G is the motion from the newest frame to the reference: the motions of all frames of the gap are changed so that G is
 * their product. */
void l1l2_motion_gap_bridge(L1L2MotionGap *gap, const L1L2Mat *G);

#endif
