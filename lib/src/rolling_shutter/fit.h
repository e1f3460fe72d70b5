/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, between two frames: the fit of the rolling-shutter residual to the tracks' displacements, and
 * its validation by splits of the tracks. Source: G2011, section 5, for the homography, and Grundmann et al., ICCP
 * 2012, for the mixture and its regularization (see model.h). Convention: as in model.h.
 */
#ifndef L1L2_ROLLING_SHUTTER_FIT_H
#define L1L2_ROLLING_SHUTTER_FIT_H

#include "fit/point_pairs.h"
#include "rolling_shutter/model.h"

/* Fits what F does not explain of the pairs' motion, by robust regularized least squares.
 *
 * pairs, count: the tracks, finite; any number, not kept. threshold: of an inlier, diagonals, > 0. F: the motion, frame
 * t to frame t-1. inlier: `count` flags; in, the pairs that agree with F, from which the fit starts; out, the pairs
 * within the threshold of F and the residual together.
 *
 * Returns the number of inliers. Returns 0 if the inliers cover too little of the frame or a number is not finite: then
 * *measurement is zero and the flags are unchanged. On success *measurement holds the residual and the three splits'
 * sums; those of the camera test are 0 (camera_gate.h). */
int l1l2_shutter_fit(const L1L2ShutterModel *model, const L1L2Pair *pairs, int count, double threshold, bool *inlier,
                     const L1L2Mat *F, L1L2ShutterMeasurement *measurement);

#endif
