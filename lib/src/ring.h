/* SPDX-License-Identifier: MIT */
/* The frames that are held: a queue of fixed capacity that gives each frame back to its owner exactly once. */
#ifndef L1L2_RING_H
#define L1L2_RING_H

#include <stdbool.h>

#include "motion.h"

typedef struct L1L2Held {
    L1L2StabFrame frame;
    L1L2MotionResult motion;
    double F_px[9]; /* the motion in pixels */
    double lambda, crop_ratio; /* as they were when the frame was pushed */
    int64_t solve_ns;
} L1L2Held;

typedef struct L1L2Ring {
    L1L2Held *items;
    int capacity, oldest, count;
} L1L2Ring;

/* False when out of memory. */
bool l1l2_ring_init(L1L2Ring *ring, int capacity);

/* Releases what is held and frees the memory; fine on a zeroed ring. */
void l1l2_ring_clear(L1L2Ring *ring);

/* Releases what is held. */
void l1l2_ring_drop_all(L1L2Ring *ring);

/* The new last item, to be filled in by the caller; the ring must not be full. */
L1L2Held *l1l2_ring_append(L1L2Ring *ring);

/* index 0: the oldest. */
L1L2Held *l1l2_ring_at(const L1L2Ring *ring, int index);

/* Releases the oldest frame. */
void l1l2_ring_drop_oldest(L1L2Ring *ring);

#endif
