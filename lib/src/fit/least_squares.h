/* SPDX-License-Identifier: MIT */
/*
 * Weighted least-squares fit of a translation, a similarity or an affine map to point pairs, in closed form (Umeyama,
 * "Least-squares estimation of transformation parameters", 1991). Maps go from a pair's `from` to its `to`.
 */
#ifndef L1L2_FIT_LEAST_SQUARES_H
#define L1L2_FIT_LEAST_SQUARES_H

#include "fit/point_pairs.h"

enum { L1L2_FIT_MAX_SIZE = 3 }; /* pairs in a minimal set, at most */

/* Pairs in a minimal set, which determines the map exactly: 1 for a translation, 2 for a similarity, 3 for affine. */
int l1l2_fit_size(L1L2StabMotionModel model);

/* How well a minimal set determines its map: the distance of its two points (similarity) or the least height of its
 * triangle (affine), in the pairs' unit; infinite for a translation. */
double l1l2_fit_extent(L1L2StabMotionModel model, const L1L2Pair *set);

/* weights: one per pair, >= 0; NULL: all 1. Pairs of weight 0 need not be finite. False, with *fit undefined, if the
 * weighted points do not determine an invertible map. */
bool l1l2_fit(L1L2StabMotionModel model, const L1L2Pair *pairs, const double *weights, int count, L1L2Mat *fit);

#endif
