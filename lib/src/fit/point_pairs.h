/* SPDX-License-Identifier: MIT */
/* Point pairs of two frames with their weights: the data that every fit of this folder works on. */
#ifndef L1L2_FIT_POINT_PAIRS_H
#define L1L2_FIT_POINT_PAIRS_H

#include "common/geom.h"
#include "common/rng.h"

enum { L1L2_RANSAC_MAX_PAIRS = 512 }; /* in a track set */

/* A point of frame t and where the same point lies in frame t-1. */
typedef struct L1L2Pair {
    L1L2Point from, to;
} L1L2Pair;

/* The tracks of one frame, to which a map is fitted. */
typedef struct L1L2TrackSet {
    const L1L2Pair *pairs;
    const double *consensus_weights; /* >= 0: the map with the largest sum over its inliers wins; NULL: all 1 */
    const double *fit_weights;       /* >= 0: for the least squares fit to the inliers; NULL: all 1 */
    int count;                       /* of pairs and weights, at most L1L2_RANSAC_MAX_PAIRS */
    double threshold;                /* largest distance of an inlier, in the pairs' unit */
    L1L2Rng *rng;                    /* of RANSAC's draws */
} L1L2TrackSet;

/* The weight of pair i. NULL: all 1. */
static inline double l1l2_fit_weight(const double *weights, int i)
{
    return weights ? weights[i] : 1.0;
}

/* The frame is divided into 8x6 cells, for coverage and for track weights. */
enum { L1L2_FIT_CELLS_X = 8, L1L2_FIT_CELLS_Y = 6, L1L2_FIT_CELLS = L1L2_FIT_CELLS_X * L1L2_FIT_CELLS_Y };

/* The part of the frame's cells in which an inlier lies, [0, 1]. half_w, half_h: half of the frame's size in the
 * pairs' unit. */
double l1l2_fit_coverage(double half_w, double half_h, const L1L2Pair *pairs, const bool *inlier, int count);

#endif
