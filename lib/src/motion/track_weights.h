/* SPDX-License-Identifier: MIT */
/*
 * Background, not subject: how much each track has to say when the camera's motion is decided.
 *
 *   Coverage   the frame is 8x6 cells, and the tracks of a cell share one vote: a textured walker has no more than
 *              the cells that it covers, however many corners it has.
 *   Place      towards the sides and the top, cells count more: what surrounds the rest is the background.
 *   Time       tracks that have moved with the camera before count more, and so do cells in which they did.
 */
#ifndef L1L2_MOTION_TRACK_WEIGHTS_H
#define L1L2_MOTION_TRACK_WEIGHTS_H

#include <stdbool.h>

#include "fit/point_pairs.h"

typedef struct L1L2TrackWeights {
    double half_w, half_h;          /* of the frame, in the pairs' unit */
    double trust[L1L2_FIT_CELLS];  /* part of the cell's tracks that moved with the camera lately, [0, 1] */
} L1L2TrackWeights;

/* Forget: all cells are alike. */
void l1l2_motion_weights_reset(L1L2TrackWeights *v);

/* votes, weights: `count` out each, > 0; the weights are of time alone. age[i]: frames that track i has moved with the
 * camera. */
void l1l2_motion_weights_assign(const L1L2TrackWeights *v, const L1L2Pair *pairs, const int *age, int count,
                                double *votes, double *weights);

/* Which of them moved with the camera this time. */
void l1l2_motion_weights_learn(L1L2TrackWeights *v, const L1L2Pair *pairs, const bool *inlier, int count);

/* What the cell of a point is trusted, [0, 1]. */
double l1l2_motion_weights_trust(const L1L2TrackWeights *v, L1L2Point p);

#endif
