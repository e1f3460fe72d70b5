/* SPDX-License-Identifier: MIT */
/*
 * Robust fit of a similarity or a translation to point pairs: RANSAC (Fischler & Bolles 1981) with a seeded generator,
 * then least squares on the inliers until they settle. No allocation.
 */
#ifndef L1L2_RANSAC_H
#define L1L2_RANSAC_H

#include "geom.h"
#include "rng.h"

/* A point of frame t and where the same point lies in frame t-1. */
typedef struct L1L2Pair {
    L1L2Point from, to;
} L1L2Pair;

/* The map `from` -> `to` with the most pairs within `threshold` of it, refitted on them.
 * inlier: `count` flags out. Any unit. Returns the number of inliers; 0, and *fit the identity, where no model exists:
 * fewer than two pairs, all points in one place, nothing finite. */
int l1l2_ransac_similarity(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, bool *inlier,
                           L1L2Mat *fit);

/* The same for translations; one pair suffices. */
int l1l2_ransac_translation(const L1L2Pair *pairs, int count, double threshold, L1L2Rng *rng, bool *inlier,
                            L1L2Mat *fit);

#endif
