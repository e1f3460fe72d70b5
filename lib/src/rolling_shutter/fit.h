/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, from frame to frame: what the similarity does not explain of the points' motions.
 *
 * Robust (reweighted least squares, each scale narrower than the last) and regularised towards none: where there are no
 * points, the rows do as their neighbours, and a few points alone bend nothing.
 */
#ifndef L1L2_ROLLING_SHUTTER_FIT_H
#define L1L2_ROLLING_SHUTTER_FIT_H

#include "fit/ransac.h"
#include "rolling_shutter/model.h"

/* inlier: in, the pairs that agree with F; out, those within `threshold` diagonals of the fit, and their number is
 * returned. 0, *step zero and `inlier` as it was: the inliers lie too close together. */
int l1l2_shutter_fit(const L1L2ShutterModel *shape, const L1L2Pair *pairs, int count, double threshold,
                             bool *inlier, const L1L2Mat *F, L1L2ShutterMeasurement *step);

#endif
