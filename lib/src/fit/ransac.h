/* SPDX-License-Identifier: MIT */
/*
 * Robust fit of a map to point pairs: RANSAC (Fischler & Bolles 1981) with a seeded generator, then iteratively
 * reweighted least squares on the inliers until they settle. No allocation.
 */
#ifndef L1L2_FIT_RANSAC_H
#define L1L2_FIT_RANSAC_H

#include <l1l2stab/l1l2stab.h>

#include "common/rng.h"
#include "fit/point_pairs.h"

/* The map `from` -> `to` whose inliers, the pairs within `threshold` of it, have the most votes together, refitted on
 * them. inlier: `count` flags out. Any unit. Returns the number of inliers; 0, and *fit the identity, where no map
 * exists: fewer pairs than it takes, all points in one place or in one line, nothing finite. */
int l1l2_ransac(L1L2StabMotionModel model, const L1L2Pair *pairs, L1L2PairWeights say, int count, double threshold,
                L1L2Rng *rng, bool *inlier, L1L2Mat *fit);

#endif
