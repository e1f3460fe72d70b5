/* SPDX-License-Identifier: MIT */
/*
 * Robust fit of a map to point pairs: RANSAC (Fischler & Bolles, 1981) with a seeded generator, then iteratively
 * reweighted least squares (Tukey's weights) on the inliers until map and inliers no longer change. No allocation.
 */
#ifndef L1L2_FIT_RANSAC_H
#define L1L2_FIT_RANSAC_H

#include <l1l2stab/l1l2stab.h>

#include "common/rng.h"
#include "fit/point_pairs.h"

/* Fits the map `from` -> `to` whose inliers have the largest sum of consensus weights, then refits it on them. inlier:
 * tracks->count flags, written. The unit is the pairs'. Returns the number of inliers. Returns 0 and the identity if no
 * map exists: too few pairs, all points in one place or on one line, or none that is finite. */
int l1l2_ransac(L1L2StabMotionModel model, const L1L2TrackSet *tracks, bool *inlier, L1L2Mat *fit);

#endif
