/* SPDX-License-Identifier: MIT */
/* The frames that are held: a queue of fixed capacity that gives each frame back to its owner exactly once. */
#ifndef L1L2_FRAME_QUEUE_H
#define L1L2_FRAME_QUEUE_H

#include <stdbool.h>

#include "motion/motion.h"

typedef struct L1L2QueuedFrame {
    L1L2StabFrame frame;
    L1L2MotionResult motion;
    double F_px[9]; /* the motion in pixels */
    double lambda, crop_ratio; /* as they were when the frame was pushed */
    int64_t solve_ns;
    bool failed; /* its motion could not be measured, by an error */
} L1L2QueuedFrame;

typedef struct L1L2FrameQueue {
    L1L2QueuedFrame *items;
    int capacity, oldest, count;
} L1L2FrameQueue;

/* False when out of memory. */
bool l1l2_frame_queue_init(L1L2FrameQueue *ring, int capacity);

/* Releases what is held and frees the memory; fine on a zeroed ring. */
void l1l2_frame_queue_clear(L1L2FrameQueue *ring);

/* Releases what is held. */
void l1l2_frame_queue_drop_all(L1L2FrameQueue *ring);

/* The new last item, to be filled in by the caller; the ring must not be full. */
L1L2QueuedFrame *l1l2_frame_queue_append(L1L2FrameQueue *ring);

/* index 0: the oldest. */
L1L2QueuedFrame *l1l2_frame_queue_at(const L1L2FrameQueue *ring, int index);

/* Releases the oldest frame. */
void l1l2_frame_queue_drop_oldest(L1L2FrameQueue *ring);

#endif
