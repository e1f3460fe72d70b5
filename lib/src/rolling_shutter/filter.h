/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, over time: from the residuals between frames to the residual of each frame.
 *
 * The camera path, and with it B_t, is one similarity a frame. What each frame has beyond it, e_t, is what the warp
 * takes away. Known are the differences m_t = e_t - e_{t-1} (motion_residual.c), not e_t itself: what all frames have
 * in common cannot be seen. So e_t minimises
 *
 *     sum w_t |m_t - (e_t - e_{t-1})|^2 + leak sum |e_t - k_t|^2,
 *
 * in which k_t is the best guess without them. G2011 (section 5) chains the differences between key frames, at which
 * e is nothing, and mixes by distance: that leaves each key frame its own skew. The leak leaves none (measured: the
 * rows' own error is 3 to 7 times smaller), and has no key frames to choose.
 *
 * Noise is no wobble, nor is what moves by itself: as far as the differences of many frames do not explain points that
 * were left out of their fits, or do not follow from the camera's motions, the changes of k_t stand for them.
 *
 * k_t is nothing for a homography. For a mixture it is the skew that the camera's speed makes, the camera path between
 * the frames' times, by the rows' readout: the one thing that m_t cannot tell and the path can. The readout, one number
 * a camera, is where the skew's changes agree with the camera's accelerations.
 */
#ifndef L1L2_ROLLING_SHUTTER_FILTER_H
#define L1L2_ROLLING_SHUTTER_FILTER_H

#include "rolling_shutter/model.h"
#include "warp/mesh.h"

typedef struct L1L2ShutterFilter L1L2ShutterFilter;

typedef struct L1L2ShutterFilterConfig {
    L1L2StabRollingShutter model;
    int in_width, in_height;      /* pixels */
    int out_width, out_height;    /* pixels */
    int capacity;                 /* frames that may wait */
} L1L2ShutterFilterConfig;

/* *out is NULL on error, and with model NONE. All functions below take NULL: then no frame has a residual. */
L1L2StabResult l1l2_shutter_filter_create(L1L2ShutterFilter **out, const L1L2ShutterFilterConfig *cfg);
void l1l2_shutter_filter_free(L1L2ShutterFilter *w);

/* As new, with its memory kept. */
void l1l2_shutter_filter_reset(L1L2ShutterFilter *w);

/* The next frame: its motion F, and the residual of F; NULL where that was not measured. */
void l1l2_shutter_filter_push(L1L2ShutterFilter *w, const L1L2Mat *F, const L1L2ShutterMeasurement *step,
                              bool starts_path);

/* The residual of the oldest frame, from those that have been pushed; there must be one. It is kept for bend(). */
const L1L2ShutterResidual *l1l2_shutter_filter_pull(L1L2ShutterFilter *w);

/* The map of the frame pulled last: `map` and `part` of its residual. NULL where there is none: `map` is all.
 * map: output pixel -> source pixel; part: [0, 1]; reach_px: how far a sample is moved by it, at most. */
const L1L2WarpMesh *l1l2_shutter_filter_mesh(L1L2ShutterFilter *w, const L1L2Mat *map, double part, double *reach_px);

/* From the first row's time to the last row's in frames, negative from below; 0 where it is not known. */
double l1l2_shutter_filter_readout(const L1L2ShutterFilter *w);

#endif
