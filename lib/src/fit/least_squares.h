/* SPDX-License-Identifier: MIT */
/* Weighted least squares of a translation, a similarity or an affine map to point pairs, in closed form. */
#ifndef L1L2_FIT_LEAST_SQUARES_H
#define L1L2_FIT_LEAST_SQUARES_H

#include "fit/point_pairs.h"

enum {
    L1L2_FIT_MAX_SIZE = 3,      /* of a smallest set */
    L1L2_RANSAC_MAX_PAIRS = 512 /* for l1l2_ransac() */
};

/* Pairs in a smallest set: 1, 2, 3. */
int l1l2_fit_size(L1L2StabMotionModel model);

/* How far a smallest set's points are apart (similarity) or off one line (affine); infinite for a translation. */
double l1l2_fit_extent(L1L2StabMotionModel model, const L1L2Pair *set);

/* weights: one a pair, >= 0; NULL: all 1. False where the weighted points do not determine an invertible map. */
bool l1l2_fit(L1L2StabMotionModel model, const L1L2Pair *pairs, const double *weights, int count, L1L2Mat *fit);

#endif
