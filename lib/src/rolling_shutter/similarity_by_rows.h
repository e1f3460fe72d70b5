/* SPDX-License-Identifier: MIT */
/*
 * Motion of a rolling shutter that shakes within a frame: the rows of the picture moved differently, and no similarity
 * has many inliers. It is not a subject that moves: what is left of the tracks' motion depends on their row, smoothly,
 * and on nothing else. The frame's motion is then that of all of them.
 */
#ifndef L1L2_ROLLING_SHUTTER_SIMILARITY_BY_ROWS_H
#define L1L2_ROLLING_SHUTTER_SIMILARITY_BY_ROWS_H

#include "fit/ransac.h"

/* Do the pairs, by their votes, follow a similarity and a shift that depends on the row alone? Then *fit is the
 * similarity (with the mean shift), inlier[i] tells which pairs, and their number is returned; else 0, and nothing
 * is written. half_h: half of the frame's height in the pairs' unit. */
int l1l2_shutter_similarity_by_rows(const L1L2Pair *pairs, const double *votes, int count, double half_h,
                                    double threshold, bool *inlier, L1L2Mat *fit);

#endif
