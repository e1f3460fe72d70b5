/* SPDX-License-Identifier: MIT */
/*
 * The similarity of a frame whose rows moved so differently that no similarity has many inliers: a rolling shutter that
 * shakes within a frame. It is distinguished from a subject that moves by itself: what a similarity leaves of the
 * tracks' motion depends on their row, smoothly, and on nothing else. Convention: any unit, origin at the frame's
 * center.
 */
#ifndef L1L2_ROLLING_SHUTTER_SIMILARITY_BY_ROWS_H
#define L1L2_ROLLING_SHUTTER_SIMILARITY_BY_ROWS_H

#include <stdbool.h>

#include "fit/point_pairs.h"
#include "rolling_shutter/parameters.h"

/* The most pairs that l1l2_shutter_similarity_by_rows() takes. */
enum { L1L2_SHUTTER_ROWS_MAX_PAIRS = 512 };

/* The tracks of a frame. Not owned. */
typedef struct L1L2ShutterRowTracks {
    const L1L2Pair *pairs;
    const double *consensus_weights; /* of each pair in the acceptance test, >= 0 */
    int count;           /* 0 to L1L2_SHUTTER_ROWS_MAX_PAIRS */
    double half_h;       /* half of the frame's height, > 0 */
    double threshold;    /* of an inlier, > 0 */
    const L1L2ShutterParameters *parameters; /* NULL: the defaults */
} L1L2ShutterRowTracks;

/* Fits a similarity and a shift per row. If the shifts explain the pairs, sets *fit to the similarity (which includes
 * the mean shift), sets `count` flags of inlier to the pairs within reach of their row's shift, and returns their
 * number. Returns 0, and writes nothing, if they do not, if a band of rows has too few pairs, if the shift jumps from
 * one band to the next, or if there are more pairs than it takes. */
int l1l2_shutter_similarity_by_rows(const L1L2ShutterRowTracks *tracks, bool *inlier, L1L2Mat *fit);

#endif
