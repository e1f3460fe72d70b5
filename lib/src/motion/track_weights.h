/* SPDX-License-Identifier: MIT */
/*
 * Weights of the tracks when the camera's motion is decided: the background counts more than subjects.
 *
 *   Coverage   The frame is divided into 8x6 cells, and the tracks of a cell share one weight. A textured subject has
 *              no more weight than the cells that it covers, however many corners it has.
 *   Place      Cells near the left, right and upper side of the frame count more, because subjects are in the middle or
 *              at the bottom.
 *   History    Tracks that have followed the camera before count more, and so do cells in which tracks did.
 */
#ifndef L1L2_MOTION_TRACK_WEIGHTS_H
#define L1L2_MOTION_TRACK_WEIGHTS_H

#include <stdbool.h>

#include "fit/point_pairs.h"
#include "motion/parameters.h"

typedef struct L1L2TrackWeights {
    const L1L2MotionParameters *parameters;
    double half_w, half_h;            /* of the frame, in the pairs' unit */
    double agreement[L1L2_FIT_CELLS]; /* part of the cell's tracks that followed the camera lately, [0, 1] */
} L1L2TrackWeights;

/* Forgets the history: all cells are alike. */
void l1l2_motion_weights_reset(L1L2TrackWeights *w);

/* Writes `count` weights each, > 0. fit: from history alone; consensus: from coverage, place and history.
 * age[i]: frames for which track i has followed the camera. */
void l1l2_motion_weights_assign(const L1L2TrackWeights *w, const L1L2Pair *pairs, const int *age, int count,
                                double *consensus, double *fit);

/* Learns which of the tracks followed the camera in this frame. */
void l1l2_motion_weights_learn(L1L2TrackWeights *w, const L1L2Pair *pairs, const bool *inlier, int count);

/* The agreement of the cell in which a point lies, [0, 1]. */
double l1l2_motion_weights_agreement(const L1L2TrackWeights *w, L1L2Point p);

#endif
