/* SPDX-License-Identifier: MIT */
/* The frames of the queue that may fill the border of the oldest one, with the motions to them (border/border.h). */
#ifndef L1L2_NEIGHBORS_OF_H
#define L1L2_NEIGHBORS_OF_H

#include "border/neighbors.h"
#include "frame_queue.h"

/* The frames shown, in samples. */
typedef struct L1L2Geometry {
    double diagonal_px;  /* of the frame as it is shown */
    double pixel_aspect;
} L1L2Geometry;

/* Writes the neighbors of the oldest held frame, at most `reach` frames before and after it, and returns how many there
 * are: room for 2 reach is needed (path/chain.h). known_end: frames from this number on have no motion yet. */
int l1l2_neighbors_of_oldest(const L1L2FrameQueue *queue, int reach, int64_t known_end, const L1L2Geometry *geometry,
                             L1L2BorderNeighbor *neighbors);

#endif
