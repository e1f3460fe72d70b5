/* SPDX-License-Identifier: MIT */
/*
 * Background, not subject: how much each track has to say when the camera's motion is decided.
 *
 *   Coverage   the frame is 8x6 cells, and the tracks of a cell share one vote: a textured walker has no more than
 *              the cells that it covers, however many corners it has.
 *   Place      towards the sides and the top, cells count more: what surrounds the rest is the background.
 *   Time       tracks that have moved with the camera before count more, and so do cells in which they did.
 */
#ifndef L1L2_MOTION_VOTES_H
#define L1L2_MOTION_VOTES_H

#include <stdbool.h>

#include "ransac.h"

enum { L1L2_VOTE_CELLS_X = 8, L1L2_VOTE_CELLS_Y = 6, L1L2_VOTE_CELLS = L1L2_VOTE_CELLS_X * L1L2_VOTE_CELLS_Y };

typedef struct L1L2Votes {
    double half_w, half_h;          /* of the frame, in the pairs' unit */
    double trust[L1L2_VOTE_CELLS];  /* part of the cell's tracks that moved with the camera lately, [0, 1] */
} L1L2Votes;

/* Forget: all cells are alike. */
void l1l2_votes_reset(L1L2Votes *v);

/* votes, weights: `count` out each, > 0; the weights are of time alone. age[i]: frames that track i has moved with the
 * camera. */
void l1l2_votes_cast(const L1L2Votes *v, const L1L2Pair *pairs, const int *age, int count, double *votes,
                     double *weights);

/* Which of them moved with the camera this time. */
void l1l2_votes_learn(L1L2Votes *v, const L1L2Pair *pairs, const bool *inlier, int count);

/* What the cell of a point is trusted, [0, 1]. */
double l1l2_votes_trust(const L1L2Votes *v, L1L2Point p);

/* Part of the frame's cells in which an inlier lies, [0, 1]. */
double l1l2_votes_coverage(double half_w, double half_h, const L1L2Pair *pairs, const bool *inlier, int count);

#endif
