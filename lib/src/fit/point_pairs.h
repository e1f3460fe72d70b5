/* SPDX-License-Identifier: MIT */
/* Point pairs, what they weigh, and how much of the frame they cover: what every fit of this folder works on. */
#ifndef L1L2_FIT_POINT_PAIRS_H
#define L1L2_FIT_POINT_PAIRS_H

#include "common/geom.h"

/* A point of frame t and where the same point lies in frame t-1. */
typedef struct L1L2Pair {
    L1L2Point from, to;
} L1L2Pair;

/* What the pairs count, one number each, >= 0; NULL: each counts 1. */
typedef struct L1L2PairWeights {
    const double *votes;   /* when it is decided whose map it is */
    const double *weights; /* in the least squares after that */
} L1L2PairWeights;

/* The frame in 8x6 cells: what coverage and track weights count by. */
enum { L1L2_FIT_CELLS_X = 8, L1L2_FIT_CELLS_Y = 6, L1L2_FIT_CELLS = L1L2_FIT_CELLS_X * L1L2_FIT_CELLS_Y };

/* The part of the frame's cells in which an inlier lies, [0, 1]. half_w, half_h: half of the frame's size in the
 * pairs' unit. */
double l1l2_fit_coverage(double half_w, double half_h, const L1L2Pair *pairs, const bool *inlier, int count);

#endif
