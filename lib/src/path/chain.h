/* SPDX-License-Identifier: MIT */
/*
 * Chained motions: where the points of a frame lie in the frames around it. F_t maps frame t to frame t - 1, so
 * F_{k+1} ... F_t maps it to frame k, and the inverses lead to later frames.
 */
#ifndef L1L2_PATH_CHAIN_H
#define L1L2_PATH_CHAIN_H

#include <stdint.h>

#include "common/frame_column.h"
#include "common/geom.h"

enum { L1L2_PATH_MAX_REACH = 120 };

typedef struct L1L2PathLink {
    int64_t t;   /* the number of the other frame */
    L1L2Mat map; /* positions in the frame -> positions in the other one, diagonals */
} L1L2PathLink;

/* The links of frame t with the frames k, begin <= k < end, that are at most `reach` away: first the earlier ones, then
 * the later ones, the nearest first. They end where a path starts and where a motion is not known, since nothing says
 * how the frames beyond lie. Returns how many there are; room for 2 reach is needed.
 * frames: of L1L2PathFrame. reach: at most L1L2_PATH_MAX_REACH. */
int l1l2_path_chain(L1L2FrameColumn frames, int64_t t, int64_t begin, int64_t end, int reach, L1L2PathLink *links);

#endif
