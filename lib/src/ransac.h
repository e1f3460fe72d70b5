/* SPDX-License-Identifier: MIT */
/*
 * Robust fit of a map to point pairs: RANSAC (Fischler & Bolles 1981) with a seeded generator, then iteratively
 * reweighted least squares on the inliers until they settle. No allocation.
 */
#ifndef L1L2_RANSAC_H
#define L1L2_RANSAC_H

#include <l1l2stab/l1l2stab.h>

#include "geom.h"
#include "rng.h"

/* A point of frame t and where the same point lies in frame t-1. */
typedef struct L1L2Pair {
    L1L2Point from, to;
} L1L2Pair;

/* What the pairs count, one number each, >= 0; NULL: each counts 1. */
typedef struct L1L2Say {
    const double *votes;   /* when it is decided whose map it is */
    const double *weights; /* in the least squares after that */
} L1L2Say;

/* The map `from` -> `to` whose inliers, the pairs within `threshold` of it, have the most votes together, refitted on
 * them. inlier: `count` flags out. Any unit. Returns the number of inliers; 0, and *fit the identity, where no map
 * exists: fewer pairs than it takes, all points in one place or in one line, nothing finite. */
int l1l2_ransac(L1L2StabMotionModel model, const L1L2Pair *pairs, L1L2Say say, int count, double threshold,
                L1L2Rng *rng, bool *inlier, L1L2Mat *fit);

#endif
