/* SPDX-License-Identifier: MIT */
/*
 * The time from frame to frame, in nominal frames, from the timestamps (L1L2StabFrame.pts).
 *
 * A nominal frame lasts 1 / frame_rate. Where one of the two timestamps or the frame rate is missing, a step counts as
 * one frame. The limits are in frame_time.c.
 *
 * Direction. Timestamps fall in reverse playback. In normal playback a step back is an error of the source, and its
 * length means nothing. So a step counts by its length where it has the direction of the step before it, or where it
 * goes forward and no direction is known yet. The first step back counts as one frame, and so does the first step
 * forward after it.
 */
#ifndef L1L2_FRAME_TIME_H
#define L1L2_FRAME_TIME_H

#include <stdbool.h>
#include <stdint.h>

typedef struct L1L2FrameTime {
    double nominal_ns; /* 0: unknown */
    int64_t pts;       /* of the frame before */
    int direction;     /* of the step before: 1 forward, -1 back, 0 unknown */
} L1L2FrameTime;

/* frame_rate: frames a second; 0: unknown. */
L1L2FrameTime l1l2_frame_time_start(double frame_rate);

/* The step to the next frame. starts_path: the frame does not belong to the one before, and the step is 1. */
double l1l2_frame_time_step(L1L2FrameTime *time, int64_t pts, bool starts_path);

#endif
