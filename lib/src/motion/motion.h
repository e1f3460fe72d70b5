/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, steps 1 and 2: from one frame to the next, the camera's motion F_t.
 *
 * Features are Shi-Tomasi corners with a minimum distance, re-selected every 10 frames or when too few are left,
 * followed by pyramidal Lucas-Kanade with a backward check. motion_overlay.c knows what never moves, motion_votes.c
 * whose word counts how much, ransac.c fits, and motion_ladder.c says what can be believed.
 */
#ifndef L1L2_MOTION_MOTION_H
#define L1L2_MOTION_MOTION_H

#include <stddef.h>
#include <stdint.h>

#include "common/geom.h"
#include "image/format.h"
#include "rolling_shutter/model.h"

typedef struct L1L2Motion L1L2Motion;

typedef struct L1L2MotionConfig {
    const L1L2FormatInfo *format;
    int width, height;  /* of the frames, pixels */
    int analysis_size;  /* longer side of the tracked picture, pixels */
    L1L2StabMotionModel model; /* the highest that is fitted */
    uint64_t seed;
    const L1L2StabLogger *log;
    L1L2StabRollingShutter rolling_shutter; /* how what F leaves is fitted; NONE: not at all */
} L1L2MotionConfig;

typedef struct L1L2MotionResult {
    L1L2Mat F;          /* frame t to frame t-1, unit: the frame's diagonal; finite, invertible */
    /* NONE: a path starts, because the caller said so or because a cut was seen. */
    L1L2StabMotionSource model;
    int tracks, inliers;
    double quality;     /* [0, 1], as in L1L2StabInfo */
    bool has_residual;  /* it was measured */
    L1L2ShutterMeasurement residual; /* of F */
    int64_t scale_ns, track_ns, fit_ns;
} L1L2MotionResult;

/* On error *out is NULL. cfg->log must outlive the object. */
L1L2StabResult l1l2_motion_create(L1L2Motion **out, const L1L2MotionConfig *cfg);
void l1l2_motion_free(L1L2Motion *m);

/* As new, with its memory kept. */
void l1l2_motion_reset(L1L2Motion *m);

/* Take the next frame's first plane; it is read during the call only. starts_path: there is no motion into this frame
 * (model NONE, F the identity). An error leaves the object as reset. */
L1L2StabResult l1l2_motion_push(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride, bool starts_path,
                                L1L2MotionResult *out);

#endif
