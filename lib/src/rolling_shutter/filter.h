/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, over time: from the residuals between frames to the residual e_t of each frame, which the warp
 * removes.
 *
 * The camera path, and with it B_t, is one similarity a frame. e_t is what the frame has beyond it (model.h). The fit
 * (fit.c) measures the changes m_t = e_t - e_{t-1}, not e_t itself, because what all frames have in common is
 * invisible. So the e_t of a path minimize
 *
 *     sum_t w_t |m_t - (e_t - e_{t-1})|^2 + leak sum_t |e_t - k_t|^2,
 *
 * where k_t is the predicted residual. With a homography k_t is zero. With a mixture it is the skew that the camera's
 * velocity and acceleration make of a frame at the estimated readout (readout.h). That skew is the part of e_t that m_t
 * cannot show, but that follows from the camera's motion.
 *
 * This replaces the key frames of G2011 (section 5). There the changes are chained between key frames, at which e is
 * zero, and mixed by distance. So each key frame keeps its own skew. Here none does: on simulated tracks with 0.1 px of
 * noise the skew was 3 to 7 times smaller than with key frames 10 or 30 frames apart, for the same wobble.
 *
 * Measured changes that fail the validation tests, because they are noise or do not follow from the camera's motion,
 * are replaced by the predicted changes k_t - k_{t-1}.
 */
#ifndef L1L2_ROLLING_SHUTTER_FILTER_H
#define L1L2_ROLLING_SHUTTER_FILTER_H

#include "common/frame_column.h"
#include "rolling_shutter/model.h"
#include "warp/mesh.h"

typedef struct L1L2ShutterFilter L1L2ShutterFilter;

/* The filter's part of a frame's record. Only the filter writes it. */
typedef struct L1L2ShutterFrame {
    L1L2ShutterMeasurement measurement; /* zero where there is none */
    bool measured;
    double weight; /* w_t: 0 where a path starts, 1 where measured, unmeasured_weight elsewhere */
} L1L2ShutterFrame;

/* Frames before the newest one that the filter still reads, even if they have been pulled. */
enum { L1L2_SHUTTER_FILTER_PAST = 8 };

typedef struct L1L2ShutterFilterConfig {
    L1L2StabRollingShutter model;
    int in_width, in_height;   /* of the source frames, pixels */
    int out_width, out_height; /* of the output frames, pixels */
    int capacity;              /* frames between push and pull, at most */
    const L1L2ShutterParameters *parameters; /* NULL: the defaults. Must outlive the filter */
    /* The records, with at least capacity + L1L2_SHUTTER_FILTER_PAST rows, which must outlive the filter: */
    L1L2FrameColumn motions; /* of L1L2Mat: the motion F of each frame, unit the frame's diagonal; only read */
    L1L2FrameColumn frames;  /* of L1L2ShutterFrame */
    double pixel_aspect;     /* a source pixel's width by its height as it is shown; 0: 1 */
    bool may_leave;          /* the warp may read outside the source frame: its border is filled afterwards */
} L1L2ShutterFilterConfig;

/* Creates a filter; free it with l1l2_shutter_filter_free(). *out is NULL on error (NOMEM), and with model NONE, which
 * is no error. All functions below take NULL: then no frame has a residual. */
L1L2StabResult l1l2_shutter_filter_create(L1L2ShutterFilter **out, const L1L2ShutterFilterConfig *cfg);
void l1l2_shutter_filter_free(L1L2ShutterFilter *filter);

/* Forgets all frames. The memory is kept. */
void l1l2_shutter_filter_reset(L1L2ShutterFilter *filter);

/* Takes the next frame; the first one after create or reset is number 0. Its motion is in its row already: the identity
 * where a path starts. measurement: the residual of that motion; NULL where it was not measured; numbers that are not
 * finite count as not measured. starts_path: there is no motion, and the measurement means nothing. At most `capacity`
 * frames may wait. */
void l1l2_shutter_filter_push(L1L2ShutterFilter *filter, const L1L2ShutterMeasurement *measurement, bool starts_path);

/* Returns the residual of the oldest frame, estimated from all frames that have been pushed. There must be one. It is
 * finite, valid until the next pull or reset, and what l1l2_shutter_filter_mesh() uses. */
const L1L2ShutterResidual *l1l2_shutter_filter_pull(L1L2ShutterFilter *filter);

/* Returns the warp of the frame that was pulled last: `map`, and `part` of its residual. map: output pixel -> source
 * pixel. part: [0, 1]. *reach_px: how far the residual moves a sample, at most, in pixels. Returns NULL, and sets
 * *reach_px to 0, where there is no residual: then `map` is the whole warp. The mesh belongs to the filter and is valid
 * until the next call. */
const L1L2WarpMesh *l1l2_shutter_filter_mesh(L1L2ShutterFilter *filter, const L1L2Mat *map, double part,
                                             double *reach_px);

/* The estimated readout in frames, as in readout.h; 0 where it is not known. */
double l1l2_shutter_filter_readout(const L1L2ShutterFilter *filter);

#endif
