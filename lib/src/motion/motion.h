/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, steps 1 and 2: the camera's motion F_t from frame t to frame t-1 (Qu & Song, section 2).
 *
 * Shi-Tomasi corners with a minimum distance are selected every 10 frames, or when too few tracks are left, and tracked
 * by pyramidal Lucas-Kanade with a backward check. static_overlay.c excludes what stands still while the camera moves,
 * track_weights.c prefers the background to subjects, ransac.c fits, and model_selection.c decides which model the
 * tracks support. shot_cut.c and shot_dissolve.c find where another shot begins.
 *
 * Points and F_t are in diagonals of the frame as it is shown, with the origin at its center, x right and y down.
 */
#ifndef L1L2_MOTION_MOTION_H
#define L1L2_MOTION_MOTION_H

#include <stddef.h>
#include <stdint.h>

#include "common/geom.h"
#include "image/format.h"
#include "motion/measured_area.h"
#include "motion/motion_bridge.h"
#include "motion/parameters.h"
#include "rolling_shutter/model.h"

typedef struct L1L2Motion L1L2Motion;

typedef struct L1L2MotionConfig {
    const L1L2FormatInfo *format;
    int width, height;         /* of the frames, pixels */
    int analysis_size;         /* longer side of the downscaled picture that is tracked, pixels */
    L1L2StabMotionModel model; /* the highest that is fitted */
    uint64_t seed;             /* of RANSAC */
    const L1L2StabLogger *log; /* must outlive the object */
    L1L2StabRollingShutter rolling_shutter; /* model of the residual that F_t leaves; NONE: it is not fitted */
    double pixel_aspect;       /* a pixel's width by its height; 0: 1 */
    const L1L2MeasuredArea *area; /* that is measured; NULL: the whole frame. Read by create() only */
    const L1L2MotionParameters *parameters; /* must outlive the object; NULL: l1l2_motion_defaults */
} L1L2MotionConfig;

typedef struct L1L2MotionResult {
    L1L2Mat F;                  /* frame t to frame t-1; finite, invertible */
    L1L2StabMotionSource model; /* NONE: a path starts, because the caller said so or another shot begins */
    int tracks, inliers;
    double quality;             /* [0, 1], as in L1L2StabInfo */
    int bridged;                /* frames before this one whose motions a bridge changed; 0: none */
    L1L2Mat bridged_F[L1L2_BRIDGE_MAX_FRAMES]; /* these, the oldest first; each frame's to the one before it */
    bool has_residual;          /* the rolling-shutter residual was measured */
    L1L2ShutterMeasurement residual;   /* of F */
    int64_t scale_ns, track_ns, fit_ns;
} L1L2MotionResult;

/* On error *out is NULL. ERR_ARGUMENT: the area is too small; the reason was logged. */
L1L2StabResult l1l2_motion_create(L1L2Motion **out, const L1L2MotionConfig *cfg);
void l1l2_motion_free(L1L2Motion *m);

/* Forgets all that was learned and the previous picture, as if new; memory is kept. */
void l1l2_motion_reset(L1L2Motion *m);

/* Measures the motion into the next frame from its first plane, which is read during the call only. starts_path: there
 * is no motion into this frame (model NONE, F the identity). Without a previous picture, after a reset, nothing can be
 * measured: model IDENTITY. An error (no memory, or one of OpenCV) leaves the object as l1l2_motion_reset() does. */
L1L2StabResult l1l2_motion_push(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride, bool starts_path,
                                L1L2MotionResult *out);

#endif
