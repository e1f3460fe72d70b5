/* SPDX-License-Identifier: MIT */
/*
 * How much of a stabilized frame no frame shows, by the motions alone.
 *
 * With border=fill the whole frame is shown, and what it lacks comes from its neighbors (border/border.h). Where a pan
 * ends with the clip, or at a cut, there are none on one side, and a part of the output would have to be made up. The
 * path then gives way: its frame gets less room (path.c).
 *
 * The output is sampled by a lattice. A point is covered if B_t takes it inside frame t, or if chained motions take it
 * on to the inside of a neighbor (chain.h). Unit: the frame's diagonal.
 */
#ifndef L1L2_PATH_COVERAGE_H
#define L1L2_PATH_COVERAGE_H

#include "path/chain.h"

/* A frame and what its neighbors may show. */
typedef struct L1L2Coverage {
    double half_w, half_h; /* of the frame */
    double margin;         /* at the sides of neighbors, not relied on */
    int count;
    L1L2PathLink neighbor[2 * L1L2_PATH_MAX_REACH];
} L1L2Coverage;

/* The part of the output, [0, 1], that neither the frame nor a neighbor shows if its update transform is B. */
double l1l2_coverage_lack(const L1L2Coverage *coverage, const L1L2Mat *B);

/* The least crop ratio, at least `ratio`, whose window can be moved so far toward B, on the straight line from the
 * identity, that no more than `limit` of the output is lacking. At most `most`. */
double l1l2_coverage_ratio(const L1L2Coverage *coverage, const L1L2Mat *B, double ratio, double limit, double most);

#endif
