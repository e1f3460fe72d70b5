/* SPDX-License-Identifier: MIT */
/*
 * Which frames fill the border: the neighbors, and the choice among them.
 *
 * The choice is by geometry alone. The parts of the output that the frame itself does not show are sampled by a lattice
 * of points. A neighbor covers a point if the chained motions take it inside the neighbor's frame. What was seen long
 * ago was seen from elsewhere, and chained motions drift. So a point costs as many frames as the nearest chosen
 * neighbor that covers it is away, and more than any distance if none does. Neighbors are chosen one after the other,
 * each time the one with which the sum of the costs falls most. It is the greedy way to place facilities (Nemhauser,
 * Wolsey and Fisher, "An analysis of approximations for maximizing submodular set functions", 1978). Each neighbor has
 * to be rendered only around the points that it is shown at.
 *
 * The choice has no memory, so rendering can start at any frame. A penalty for changing the source from frame to frame
 * was tried: the filled border changed as much from frame to frame as without it, and it was less exact.
 *
 * Convention: maps are in samples, with the origins at the frames' centers.
 */
#ifndef L1L2_BORDER_NEIGHBORS_H
#define L1L2_BORDER_NEIGHBORS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/geom.h"
#include "warp/warp.h"

enum {
    L1L2_BORDER_MAX_FRAMES = 120, /* from the frame that is filled, either way */
    L1L2_BORDER_MAX_SOURCES = 8, /* that one frame is filled from */
    L1L2_BORDER_STRIPS = L1L2_WARP_MAX_PARTS, /* what lies outside all of them shows the frame alone */
    L1L2_BORDER_MARGIN_PX = 2,   /* a neighbor's outermost pixels are not relied on */
    L1L2_BORDER_ALIGN = 4        /* strips begin at multiples of so many pixels: at whole samples of any plane */
};

/* A frame that may fill the border of frame t. */
typedef struct L1L2BorderNeighbor {
    int64_t t;                   /* its number */
    L1L2Mat map;                 /* positions of the frame that is filled -> positions of this one */
    const uint8_t *const *data;  /* planes */
    const ptrdiff_t *stride;
} L1L2BorderNeighbor;

typedef struct L1L2BorderChoice {
    int count;
    int neighbor[L1L2_BORDER_MAX_SOURCES]; /* indices, the nearest one first */
    L1L2WarpParts part[L1L2_BORDER_MAX_SOURCES]; /* of the strips: where each of them may be shown */
} L1L2BorderChoice;

/* A frame whose border is to be filled. */
typedef struct L1L2BorderNeed {
    int64_t t;                /* its number */
    const L1L2Mat *map;       /* output pixel -> source pixel */
    int width, height;        /* of output and source, pixels */
    L1L2WarpParts strips;
} L1L2BorderNeed;

/* Memory for a choice: too much for the stack of some threads. */
typedef struct L1L2BorderMissing L1L2BorderMissing;

/* NULL when out of memory. */
L1L2BorderMissing *l1l2_border_missing_new(void);
void l1l2_border_missing_free(L1L2BorderMissing *missing);

L1L2BorderChoice l1l2_border_choose(L1L2BorderMissing *missing, const L1L2BorderNeed *need,
                                    const L1L2BorderNeighbor *neighbors, int count);

static inline bool l1l2_border_is_empty(const L1L2WarpRect *rect)
{
    return rect->left >= rect->right || rect->top >= rect->bottom;
}

#endif
